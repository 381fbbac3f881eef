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
@reports
@reading
def command(*, files: tuple[str, ...], save_profile: str | None, options: ReadOptions) -> Outcome:
    """Show what dashpot understands of each FILE, and what it needs to be told.

    \b
    dashpot inspect seal_8mm.csv
    dashpot inspect raw.txt --force Kraft --units "force=N" --save-profile lab.toml
    """
    from dashpot.cli import _inspection
    from dashpot.io.read import inspect_file
    from dashpot.io.reading_profile import dump_profile

    found = [inspect_file(path, options=options) for path in files]
    tests = [
        _inspection.prepared(item, path, options) for item, path in zip(found, files, strict=True)
    ]
    if save_profile:
        write(save_profile, dump_profile(options))
    pairs = list(zip(found, tests, strict=True))
    return Outcome(
        lambda: {
            "schema": "dashpot/inspection@1",
            "files": [_inspection.document(item, test) for item, test in pairs],
        },
        "\n\n".join(_inspection.text(item, test) for item, test in pairs),
        tuple(check for _, test in pairs for check in _inspection.checks(test)),
    )
