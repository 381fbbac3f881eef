"""dashpot inspect: what is in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dashpot.cli._reading import reading
from dashpot.cli._shell import Outcome, reports, write

if TYPE_CHECKING:
    from dashpot.io.options import ReadOptions


@click.command("inspect", short_help="What is in a file: columns, units, sampling, segments.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--save-profile", metavar="FILE", help="Keep the options given here as a profile.")
@reading
@reports
def command(*, files: tuple[str, ...], save_profile: str | None, options: ReadOptions) -> Outcome:
    """Show what dashpot understands of each FILE, and what it needs to be told.

    \b
    dashpot inspect seal_8mm.csv
    dashpot inspect raw.txt --force Kraft --units "force=N" --save-profile lab.toml
    """
    from dashpot.cli._inspection import document, text
    from dashpot.io.options import dump_profile
    from dashpot.io.read import inspect_file

    found = [inspect_file(path, options=options) for path in files]
    if save_profile:
        write(save_profile, dump_profile(options))
    documents = [document(item) for item in found]
    return Outcome(
        {"schema": "dashpot/inspection@1", "files": documents},
        "\n\n".join(text(item) for item in found),
        tuple(check for item in found for check in _checks(item)),
    )
