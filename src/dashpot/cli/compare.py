"""dashpot compare: predicted against measured."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.units import written
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._options import given
from dashpot.cli._shell import File, Outcome, grams, reports, typed, write_figure
from dashpot.cli._terminal import Text
from dashpot.io.options import ReadOptions
from dashpot.workflow.job import Job


@click.command("compare")
@click.argument("fit", type=File())
@click.argument("measured", type=File(), nargs=-1, required=True, metavar="IMPACT|FRF...")
@click.option(
    "--with",
    "records",
    type=File(),
    metavar="FILE",
    multiple=True,
    help="The relaxation record(s) behind FIT, for the bound.",
)
@options.of(Job, "mass")
@options.carried
@options.of(Job, "band")
@options.picture
@options.overwrite
@reports
@options.hammer
@options.reading
def command(
    *,
    fit: str,
    measured: tuple[str, ...],
    seals: float,
    picture: str | None,
    options: ReadOptions,
    **choices: Any,
) -> Outcome:
    """Hold the prediction of FIT against the hits or the FRF in IMPACT|FRF.

    The figure shows the limits by the standard errors of the fit; with the record that was fitted
    (--with) the bound over unresolved arms, too.

    \b
    dashpot compare fit.json hammer.csv --mass 104g --seals 2
    dashpot compare fit.json frf.uff --mass 104g --seals 2 --json
    dashpot compare fit.json hammer.csv --mass 104g --seals 2 --with seal_8mm.csv --plot frf.png
    """
    fitted = workflow.read_fit(fit)
    found = workflow.compare_files(
        fitted,
        measured,
        seals=seals,
        options=options.without(options.of_bench),
        options_with=options.only(("units", *options.of_bench)),
        **choices,
    )
    if picture:
        sources = (*fitted.source, *found.comparison.measured.source)
        named = dp.plot.stamp(sources, fitted.specimen, mass=found.mass, seals=seals)
        drawn = dp.plot.comparison(
            found.comparison, band=found.limits, interval=found.interval, stamp=named
        )
        write_figure(picture, drawn)
    lines = _text.comparison(found.comparison)
    if str(found.at_rest):
        lines.append(str(found.at_rest))
    inferred = found.mass_inferred
    if inferred:
        lines.append(
            f"  mass        {written(found.mass, 'g', '.5g')}, inferred from the measured FRF: the "
            "agreement in frequency then proves nothing; give --mass to test it"
        )
    alone = fitted.method in ("full", "hold")
    with_tests = [word for source in fitted.source for word in ("--with", source.file)]
    if fitted.alternative is not None:
        with_tests += ["--family", "auto"]
    return Outcome(
        found,
        Text(lines, [f"  {arm}" for arm in found.comparison.arms]),
        found.checks,
        verdict=found.verdict,
        follow=typed(
            "identify",
            *measured,
            *with_tests,
            "--mass",
            "MASS" if inferred else grams(found.mass),
            "--seals",
            f"{seals:g}",
            *given("options", "profile", "hammer"),
            why="fits both tests together",
        )
        if alone
        else "",
    )
