"""dashpot identify: Maxwell parameters from vibration, alone or with a relaxation test."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._lines_text import sensitive
from dashpot.cli._options import over_profile
from dashpot.cli._shell import (
    File,
    Outcome,
    Output,
    is_json,
    printed,
    reports,
    typed,
    write,
)
from dashpot.cli._terminal import Text
from dashpot.io.options import ReadOptions
from dashpot.workflow.job import Job

_ROWS = 3
"""Lines of a transmissibility that are shown: both ends of its band, and between."""
_A_DECK = ("--to", "nastran", "--units", "mm-t-s", "-o", "seal.bdf")


@click.command("identify")
@click.argument("measured", type=File(), nargs=-1, required=True, metavar="IMPACT|FRF...")
@click.option(
    "--with", "together", type=File(), metavar="FIT|RELAXATION", multiple=True, help="Fit together."
)
@click.option(
    "--with-profile", type=File(), metavar="FILE", help="Saved answers for the relaxation tests."
)
@options.weighed
@options.filled(dp.HammerRig, "rig", leave=("gain_sd", "delay_sd"))
@options.carried
@options.of(Job, "impact_temperature", "arms", "family")
@options.filled(dp.KnownSolid, "known")
@options.of(Job, "band", help="Lines fitted, e.g. 5:40Hz.")
@click.option(
    "--direct",
    type=Output([".csv"]),
    metavar="FILE",
    help="Write k(f), c(f) and loss factor as CSV.",
)
@options.fit_output
@options.overwrite
@reports
@options.machine
@options.specimens
@options.hammer
@options.reading
def command(
    *,
    measured: tuple[str, ...],
    together: tuple[str, ...],
    with_profile: str | None,
    options: ReadOptions,
    direct: str | None,
    output: str | None,
    **choices: Any,
) -> Outcome:
    """Identify the solid under a mass from the hits or the FRF in IMPACT|FRF.

    Stiffness k(f), damping c(f) and loss factor come straight from the FRF, with what 1 % of mass
    and 1 degree of phase do to them; then a solid with arms, or by --family a fractional one, is
    fitted to the FRF itself.

    With a relaxation test (or its fit) both speak at once: the test tells the slow arms, the
    hammer the fast ones, and the result says which parameters moved.

    \b
    dashpot identify hammer.csv --mass 104g --seals 2 --arms 2
    dashpot identify hammer.csv --with seal_8mm.csv --mass 104g --seals 2 -o joint.json
    dashpot identify hammer.csv --with seal_8mm.csv --mass 104g --seals 2 --family auto
    dashpot identify hammer.csv --with warm.csv --with cold.csv --mass 104g --seals 2
    """
    fits = [path for path in together if is_json(path)]
    found = workflow.identify_files(
        measured,
        fits=[workflow.read_fit(path) for path in fits],
        tests=[path for path in together if path not in fits],
        options=options.without(options.of_bench),
        options_with=over_profile(options.only(("units", *options.of_bench)), with_profile),
        **choices,
    )
    if direct:
        write(direct, found.direct.table)
    if output:
        write(output, printed(found.fit) + "\n")
    (named, *lines), details = _text.fit(found.fit)
    first, straight = [named], found.direct.of
    if straight.over_base:
        errors = ("phase", "mass")
        first += sensitive(straight, errors=errors, unit="N/mm", scale=1e-3, shown=_ROWS)
    text = Text([*first, *lines, *([str(found.at_rest)] if str(found.at_rest) else [])], details)
    return Outcome(
        found,
        text,
        found.checks,
        verdict=found.verdict,
        follow=_follow(measured, output, found.fit),
    )


def _follow(measured: tuple[str, ...], output: str | None, found: dp.Fit) -> str:
    if output == "-":
        return ""
    if output:
        return typed("export", output, *_deck(found))
    again = options.given(but=("as_json", "strict", "verbose", "overwrite", "direct"))
    return typed("identify", *measured, *again, "-o", "joint.json", why="keeps it for export")


def _deck(found: dp.Fit) -> list[str]:
    """The options of a deck, with what the fit does not know of its piece to be filled in."""
    piece = found.specimen
    asked = (("--temperature", piece.temperature), ("--length", piece.length))
    missing = [name for name, known in asked if known is None]
    return [*_A_DECK, *(word for name in missing for word in (name, name[2:].upper()))]
