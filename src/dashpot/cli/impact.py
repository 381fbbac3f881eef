"""dashpot impact: hammer hits to an FRF one can trust."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.checks import verdict
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._echo import to_stderr
from dashpot.cli._shell import File, Outcome, grams, reports, typed, write, write_figure
from dashpot.workflow.job import Job


@click.command("impact")
@click.argument("files", type=File(), nargs=-1, required=True, metavar="FILE...")
@options.of(Job, "mass", help="Block mass: checks the mass line.")
@options.of(Job, "band", help="Where to look for modes, e.g. 5:40Hz.")
@options.picture
@options.output("Write the FRF: .csv, .uff, or - for stdout.", ".csv", ".uff", ".unv")
@options.overwrite
@reports
@options.hammer
@options.reading
def command(
    *, files: tuple[str, ...], picture: str | None, output: str | None, **choices: Any
) -> Outcome:
    """Cut the records in FILE into hits, judge each, and average them into an FRF.

    \b
    dashpot impact hammer.csv
    dashpot impact hit1.csv hit2.csv hit3.csv --estimator Hv --combine weighted -o frf.uff
    dashpot impact hammer.csv --reject 3 --window exponential --mass 104g
    """
    found, reason = workflow.impact_files(files, file=output, **choices)
    if reason:
        to_stderr(f"no mode: {reason}")
    if output:
        _write(found.frf, output)
    if picture:
        named = dp.plot.stamp(found.frf.source, mass=choices["mass"])
        write_figure(picture, dp.plot.frf(found.frf, labels=("measured",), stamp=named))
    return Outcome(
        found,
        _text.impact(found),
        found.frf.checks,
        verdict=verdict(found.frf.checks),
        follow=typed(
            "compare",
            "fit.json",
            *files,
            "--mass",
            _mass(choices),
            "--seals",
            2,
            *options.given("options", "profile", "hammer"),
        ),
    )


def _mass(choices: dict[str, Any]) -> str:
    return "MASS" if choices["mass"] is None else grams(choices["mass"])


def _write(frf: dp.FRF, path: str) -> None:
    """Write an FRF as CSV, or as UFF 58 where the file's name ends in .uff or .unv."""
    from dashpot.io.write import frf_uff, write_frf

    write(path, frf_uff(frf) if path.lower().endswith((".uff", ".unv")) else write_frf(frf))
