"""dashpot fit: the solid behind one or several relaxation tests."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.choices import Method
from dashpot.base.errors import FitError
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._shell import File, Outcome, Output, printed, reports, typed, write, write_figure
from dashpot.workflow.job import Job
from dashpot.workflow.shifting import ShiftChoices


@click.command("fit")
@click.argument("files", type=File(), nargs=-1, required=True, metavar="FILE...")
@options.of(Job, "arms", "method", "law", "family")
@click.option("--depth-law", is_flag=True, help="Several depths: shared times, k for each depth.")
@click.option("--thorough", is_flag=True, help="Add quasi-random starts.")
@options.of(Job, "filter")
@options.cuts
@click.option(
    "--save-shifts",
    type=Output([".csv"]),
    metavar="FILE",
    help="Keep the shift factors of several temperatures as a table.",
)
@options.picture
@options.fit_output
@options.overwrite
@reports
@options.machine
@options.specimens
@options.filled(ShiftChoices, "shifting")
@options.reading
def command(
    *,
    files: tuple[str, ...],
    picture: str | None,
    output: str | None,
    save_shifts: str | None,
    **choices: Any,
) -> Outcome:
    """Fit a generalized Maxwell solid to the ramp and hold in FILE; several files fit together.

    FILE may also be a dynamic (DMA) sweep, storage and loss against frequency; a creep test, a
    force held, or a creep compliance over time; or, with --modulus, a relaxation modulus over time.
    Sweeps or moduli at several temperatures are shifted to one master curve; ramps and holds at
    several temperatures share one solid, shifts and all in one fit.

    \b
    dashpot fit seal_8mm.csv
    dashpot fit seal_8mm.csv --arms 2 --method hold -o fit.json --plot fit.png
    dashpot fit seal_4mm.csv seal_8mm.csv --depth-law
    dashpot fit warm.csv cold.csv --temperature 23degC --temperature 0degC
    dashpot fit curve.csv --modulus "E(t)"
    dashpot fit seal_8mm.csv --family auto
    dashpot fit creep.csv
    dashpot fit sweeps.csv --reference 20degC --plot master.png
    """
    found, records = workflow.fit_files(files, **choices)
    if picture:
        write_figure(picture, _figure(found, records))
    if save_shifts:
        write(save_shifts, _shift_table(found))
    if output:
        write(output, printed(found) + "\n")
    return Outcome(
        found,
        _text.fit(found, asked=choices["arms"]),
        found.checks,
        verdict=found.verdict,
        follow=_follow(files, output, found),
    )


def _shift_table(found: dp.Fit) -> str:
    from dashpot.io.write import write_shifts

    if found.temperatures is None:
        raise FitError("one temperature has no shift factors; leave out --save-shifts")
    stamp = ["simulated"] if any(source.simulated for source in found.source) else []
    return write_shifts(found.temperatures, comments=stamp)


def _follow(files: tuple[str, ...], output: str | None, found: dp.Fit) -> str:
    if not output:
        again = options.given(but=("as_json", "strict", "verbose", "picture", "overwrite", "open"))
        why = "keeps it for predict, compare, export"
        return typed("fit", *files, *again, "-o", "fit.json", why=why)
    if output == "-":
        return ""
    if found.unit == "Pa":  # no mass rests on a material
        deck = ("export", output, "--to", "abaqus", "--form", "prony", "--units", "mm-t-s")
        missing = ("--temperature", "TEMPERATURE") if found.specimen.temperature is None else ()
        return typed(*deck, *missing)
    return typed("predict", output, "--mass", "MASS", "--seals", 2)


def _figure(found: dp.Fit, records: tuple[Any, ...]) -> dp.plot.Picture:
    others: list[dp.Fit] = []
    if len(records) == 1 and isinstance(records[0], dp.RampHold):
        method: Method = "hold" if found.method == "hold" else "full"
        others = [dp.fit(records, arms=n, method=method, intervals=False) for n in (1, 2)]  # Fig. 4
    return dp.plot.bench(found, records, alternatives=others)
