"""dashpot compare: predicted against measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dashpot.cli._hammer import hammer
from dashpot.cli._reading import reading
from dashpot.cli._shell import Outcome, Quantity, Range, failed, reports

if TYPE_CHECKING:
    from dashpot.base.checks import Check
    from dashpot.io.options import ReadOptions
    from dashpot.workflow.job import HammerChoices


@click.command("compare", short_help="The predicted FRF against a measured one.")
@click.argument("fit")
@click.argument("measured", nargs=-1, required=True, metavar="IMPACT|FRF...")
@click.option(
    "--mass", type=Quantity("mass"), help="Block mass; inferred, and said so, if missing."
)
@click.option("--seal-mass", type=Quantity("mass"), help="Of one seal; a third moves along.")
@click.option("--seals", type=float, default=1.0, show_default=True, help="Seals in parallel.")
@click.option("--band", type=Range("frequency"), help="Lines compared, e.g. 5:40Hz.")
@click.option("--plot", "picture", metavar="FILE", help="Save the figure (png, svg, pdf).")
@reports
@hammer
@reading
def command(
    *,
    fit: str,
    measured: tuple[str, ...],
    mass: float | None,
    seal_mass: float | None,
    seals: float,
    band: tuple[float, float] | None,
    picture: str | None,
    hammer: HammerChoices,
    options: ReadOptions,
) -> Outcome:
    """Hold the prediction of FIT against the hits or the FRF in IMPACT|FRF.

    \b
    dashpot compare fit.json hammer.csv --mass 104g --seals 2
    dashpot compare fit.json frf.uff --mass 104g --seals 2 --json
    """
    from dashpot.cli._inputs import read_fit
    from dashpot.vibration.comparison.compare import compare
    from dashpot.vibration.modal.mass import infer_mass
    from dashpot.vibration.systems.prediction import moving_mass, predict_frf
    from dashpot.workflow.archive import document
    from dashpot.workflow.job import read_measured

    found = read_fit(fit)
    _, frf = read_measured(measured, choices=hammer, options=options, mass=mass)
    noted: tuple[Check, ...] = ()
    if mass is not None and seal_mass is not None:
        mass, check = moving_mass(mass, seal=seal_mass, seals=seals)
        noted = (check,)
    inferred = mass is None
    if mass is None:
        mass, _ = infer_mass(seals * found.model, frf)
    predicted = predict_frf(
        seals * found.model,
        mass=mass,
        frequency=frf.frequency,
        kind=frf.kind,
        shift=frf.shift,
    )
    result = compare(predicted, frf, fit=found, mass=mass, seals=seals, band=band)
    if picture:
        from dashpot import plot

        plot.save(plot.comparison(result), picture)
    lines = [str(result)]
    if inferred:
        lines.append(
            f"  mass        {mass * 1e3:.5g} g, inferred from the measured FRF: the agreement in "
            "frequency then proves nothing; give --mass to test it"
        )
    checks = (*result.checks, *frf.checks, *noted)
    given = {"mass": mass, "mass_inferred": inferred, "seals": seals}
    return Outcome(
        lambda: document(result) | given, "\n".join(lines + failed((*frf.checks, *noted))), checks
    )
