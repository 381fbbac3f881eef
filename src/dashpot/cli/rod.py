"""dashpot rod: the modulus of a rod's material from the motion of a mass on it."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.errors import ReadError
from dashpot.cli import _options as options
from dashpot.cli import _rod_text as text
from dashpot.cli._shell import (
    File,
    Outcome,
    grams,
    printed,
    reports,
    typed,
    write,
    write_figure,
)
from dashpot.records.specimen import Specimen
from dashpot.workflow.job import Job
from dashpot.workflow.rods import RodChoices

_OTHERS = ("length", "height", "notes", "name", "lot", "operator", "date")


@click.command("rod")
@click.argument("files", type=File(), nargs=-1, required=True, metavar="FRF|RECORD...")
@options.filled(RodChoices, "rod")
@options.weighed
@click.option("--density", type=float, required=True, help="Of the rod, kg/m^3.")
@options.of(Job, "band", help="Lines to use, e.g. 50:400Hz.")
@options.of(Job, "arms", "family")
@options.fit_output
@options.picture
@options.overwrite
@reports
@options.filled(Specimen, "specimen", leave=_OTHERS)
@options.hammer
@options.reading
def command(
    *, files: tuple[str, ...], output: str | None, picture: str | None, **choices: Any
) -> Outcome:
    """Find the modulus and the loss factor of a rod's material from the motion of a mass on it.

    A cylinder stands on a base that is shaken and bears a mass; FRF is the transmissibility from
    base to mass, RECORD both accelerations in time. The rod's own mass is counted: its wave
    equation is solved for the modulus, line by line, and the band is said in which storage and
    loss factor are known to 10 %. A solid is fitted to that band. FRF may also be that of a force
    on the mass, above a base that rests.

    \b
    dashpot rod rod.csv --disc 20mm,20mm --density 1000 --mass 31.4g --plot rod.png
    dashpot rod rod.csv --disc 20mm,20mm --density 1000 --mass 31.4g -o rod.json
    dashpot rod shaken.csv --base-acceleration ch1 --disc 20mm,20mm --density 1000 --mass 31.4g
    """
    found = workflow.rod_files(files, **choices)
    if output:
        if found.fit is None:
            raise ReadError(f"-o writes a fit, and there is none: {found.reason}")
        write(output, printed(found.fit) + "\n")
    if picture:
        stamp = dp.plot.stamp(found.frf.source, mass=found.mass)
        write_figure(picture, dp.plot.rod(found.modulus, fit=found.fit, stamp=stamp))
    return Outcome(
        found,
        text.rod(found),
        found.checks,
        verdict=found.verdict,
        follow=_follow(found, output),
    )


def _follow(found: workflow.Rod, output: str | None) -> str:
    if found.fit is None or not output or output == "-":
        return ""
    return typed("predict", output, "--disc", "20mm,10mm", "--mass", grams(found.mass), "--base")
