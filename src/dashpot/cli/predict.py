"""dashpot predict: the FRF of a mass on the fitted seal."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._shell import File, Outcome, grams, reports, typed, write, write_figure
from dashpot.records.frf import OF_FORCE
from dashpot.workflow.job import HammerChoices, Job, LevelChoices
from dashpot.workflow.part import PartChoices


@click.command("predict")
@click.argument("fit", type=File())
@options.weighed
@options.carried
@options.temperature
@options.of(Job, "band", default="1:50Hz", help="Frequencies.")
@click.option("--lines", type=click.IntRange(2), default=2001, show_default=True)
@click.option(
    "--kind",
    type=click.Choice(OF_FORCE),
    default="accelerance",
    show_default=True,
    help="Of the mass and a force on it.",
)
@click.option(
    "--base", is_flag=True, help="The base moves instead: the transmissibility to the mass."
)
@options.of(HammerChoices, "motion", help="Of the mass over that base.")
@click.option(
    "--base-psd",
    type=File(),
    metavar="FILE|DENSITY",
    help="The base shakes at random: a file of frequency and g^2/Hz, or white noise as 0.01g^2/Hz.",
)
@click.option(
    "--with",
    "records",
    type=File(),
    metavar="FILE",
    multiple=True,
    help="The relaxation record(s).",
)
@options.picture
@options.output("Write the FRF as CSV; - is stdout.", ".csv")
@options.overwrite
@reports
@options.filled(PartChoices, "part")
@options.filled(LevelChoices, "at_level")
@options.machine
@options.reading
def command(
    *, fit: str, picture: str | None, output: str | None, base: bool, motion: str, **choices: Any
) -> Outcome:
    """Predict the frequency response of a mass on the seal of FIT (a fit's JSON file).

    The standard errors of the fit become limits of the accelerance, or of the transmissibility
    (--base); with the record that was fitted (--with) so does the bound over unresolved arms.

    Of a material's modulus (a DMA sweep, a master curve) a shape makes a part; one measured
    resonance (--resonance 85Hz --resonance-mass 150g) tells the geometry of all that follow. An
    amplitude sweep of it (--sweep) tells the resonance at a level.

    \b
    dashpot predict fit.json --mass 104g --seals 2
    dashpot predict fit.json --mass 104g --seals 2 --band 1:50Hz -o frf.csv
    dashpot predict fit.json --mass 104g --seals 2 --base
    dashpot predict fit.json --mass 104g --seals 2 --base-psd 0.01g^2/Hz
    dashpot predict fit.json --mass 104g --seals 2 --with seal_8mm.csv --plot frf.png
    dashpot predict moving.json --mass 104g --seals 2 --temperature -10degC
    dashpot predict dma.json --disc 20mm,20mm --mass 400g --seals 2 --base
    dashpot predict dma.json --disc 20mm,20mm --mass 400g --seals 2 --base --sweep strain.csv
        --level 0.5m/s^2 --level 5m/s^2
    """
    fitted = workflow.read_fit(fit)
    base = base or choices["base_psd"] is not None
    if base:
        _no_other_kind()
        over = {"absolute": "transmissibility", "relative": "relative_transmissibility"}
        choices["kind"] = over[motion]
    elif motion == "relative":
        raise click.UsageError("--motion relative is of the mass over a base: add --base")
    if output and len(choices["at_level"].levels) > 1:
        raise click.UsageError("-o holds the FRF at one level: ask one --level, or leave -o out")
    found = workflow.predict_files(fitted, **choices)
    if picture:
        rig = {"mass": choices["mass"], "seals": choices["seals"]}
        named = dp.plot.stamp(fitted.source, fitted.specimen, **rig)
        write_figure(picture, _figure(found, named))
    if output:
        from dashpot.io.write import write_frf

        write(output, write_frf(found.levels[0].frf if found.levels else found.frf))
    text = _text.prediction(found, mass=choices["mass"], seals=choices["seals"])
    return Outcome(
        found,
        text,
        found.checks,
        verdict=found.verdict,
        follow="" if found.of_part else _follow(fit, choices["mass"], choices["seals"]),
    )


def _figure(found: workflow.Prediction, stamp: str) -> dp.plot.Picture:
    still = "predicted at a vanishing level" if found.levels else "predicted"
    return dp.plot.frf(
        found.frf,
        *(one.frf for one in found.levels),
        labels=(still, *(f"at {one.level:.4g} {one.unit}" for one in found.levels)),
        band=found.limits,
        interval=found.interval,
        ordered=bool(found.levels),
        stamp=stamp,
    )


def _follow(fit: str, mass: float, seals: float) -> str:
    rig = ("--mass", grams(mass), "--seals", f"{seals:g}")
    return typed("compare", fit, "HAMMER", *rig, why="tests it with a hammer")


def _no_other_kind() -> None:
    """Refuse the transmissibility and another kind together."""
    source = click.get_current_context().get_parameter_source("kind")
    if source is click.core.ParameterSource.COMMANDLINE:
        raise click.UsageError("--kind is of a force on the mass, --base of none: leave one out")
