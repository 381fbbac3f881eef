"""dashpot identify: Maxwell parameters from vibration, alone or with a relaxation test."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import click

from dashpot.cli._hammer import hammer
from dashpot.cli._reading import reading
from dashpot.cli._shell import (
    Arms,
    Outcome,
    Quantity,
    Range,
    failed,
    finite,
    printed,
    reports,
    write,
)

if TYPE_CHECKING:
    from dashpot.base.checks import Check
    from dashpot.io.options import ReadOptions
    from dashpot.records.fit import Fit
    from dashpot.records.relaxation import RampHold
    from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness
    from dashpot.workflow.job import HammerChoices


@click.command("identify", short_help="Maxwell parameters from vibration, alone or jointly.")
@click.argument("measured", nargs=-1, required=True, metavar="IMPACT|FRF...")
@click.option("--with", "together", metavar="FIT|RELAXATION", multiple=True, help="Fit together.")
@click.option("--mass", type=Quantity("mass"), required=True, help="Block mass, e.g. 104g.")
@click.option("--mass-sd", type=Quantity("mass"), help="How well the mass is known.")
@click.option("--seal-mass", type=Quantity("mass"), help="Of one seal; a third moves along.")
@click.option("--seals", type=float, default=1.0, show_default=True, help="Seals in parallel.")
@click.option("--arms", type=Arms(), default="auto", show_default=True, help="Maxwell arms.")
@click.option("--parallel-dashpot", is_flag=True, help="A dashpot b beside the arms.")
@click.option("--static-stiffness", type=Quantity("stiffness"), help="One seal, known.")
@click.option("--natural-frequency", type=Quantity("frequency"), help="Known; constrains the fit.")
@click.option("--damping-ratio", type=float, help="Known; constrains the fit.")
@click.option("--band", type=Range("frequency"), help="Lines fitted, e.g. 5:40Hz.")
@click.option("--direct", metavar="FILE", help="Write k(f), c(f) and loss factor as CSV.")
@click.option("-o", "--output", metavar="FILE", help="Write the fit as JSON; - is stdout.")
@reports
@hammer
@reading
def command(
    *,
    measured: tuple[str, ...],
    together: tuple[str, ...],
    mass: float,
    mass_sd: float | None,
    seal_mass: float | None,
    seals: float,
    arms: int | Literal["auto"],
    parallel_dashpot: bool,
    static_stiffness: float | None,
    natural_frequency: float | None,
    damping_ratio: float | None,
    band: tuple[float, float] | None,
    direct: str | None,
    output: str | None,
    hammer: HammerChoices,
    options: ReadOptions,
) -> Outcome:
    """Identify the solid under a mass from the hits or the FRF in IMPACT|FRF.

    Stiffness k(f), damping c(f) and loss factor come straight from the FRF, with what 1 % of mass
    and 1 degree of phase do to them; then a Maxwell solid is fitted to the FRF itself.

    With a relaxation test (or its fit) both speak at once: the test tells the slow arms, the
    hammer the fast ones, and the result says which parameters moved.

    \b
    dashpot identify hammer.csv --mass 104g --seals 2 --arms 2
    dashpot identify hammer.csv --with seal_8mm.csv --mass 104g --seals 2 -o joint.json
    """
    from dashpot.cli import _text as _words
    from dashpot.fitting.identification.identify import identify
    from dashpot.io.options import ReadOptions
    from dashpot.vibration.modal.dynamic_stiffness import dynamic_stiffness
    from dashpot.vibration.systems.prediction import moving_mass
    from dashpot.workflow.archive import document
    from dashpot.workflow.job import read_measured

    _, frf = read_measured(measured, choices=hammer, options=options, mass=mass)
    noted: tuple[Check, ...] = ()
    if seal_mass is not None:
        mass, check = moving_mass(mass, seal=seal_mass, seals=seals)
        noted = (check,)
    tests, fits = _partners(together, ReadOptions(units=options.units))
    straight = dynamic_stiffness(frf, mass, seals=seals)
    if direct:
        write(direct, _table(straight))
    found = identify(
        frf.band(*band) if band else frf,
        tests=tests,
        fit=fits[0] if fits else None,
        mass=mass,
        mass_sd=mass_sd,
        seals=seals,
        arms=arms,
        parallel_dashpot=parallel_dashpot,
        static_stiffness=static_stiffness,
        natural_frequency=natural_frequency,
        damping_ratio=damping_ratio,
    )
    if output:
        write(output, printed(document(found)) + "\n")
    text = "" if output == "-" else "\n".join([_words.fit(found), *failed(noted)])
    return Outcome(
        lambda: document(found) | {"direct": _plain(straight)}, text, (*found.checks, *noted)
    )


def _plain(straight: DynamicStiffness) -> dict[str, Any]:
    """Return stiffness and damping straight from the FRF, each with all its errors."""
    return {
        "frequency_hz": straight.frequency.tolist(),
        "stiffness": straight.storage.tolist(),
        "stiffness_sd": straight.storage_sd.tolist(),
        "damping": straight.damping.tolist(),
        "loss_factor": straight.loss_factor.tolist(),
        "loss_factor_sd": straight.loss_factor_sd.tolist(),
        "stiffness_band_hz": [finite(end) for end in straight.storage_band],
        "loss_band_hz": [finite(end) for end in straight.loss_band],
    }


def _table(straight: DynamicStiffness) -> str:
    """Return them as CSV, with the bands where they are good in the head."""
    head = (
        f"# stiffness good to 10 % from {straight.storage_band[0]:.4g} to "
        f"{straight.storage_band[1]:.4g} Hz, loss to 30 % from {straight.loss_band[0]:.4g} to "
        f"{straight.loss_band[1]:.4g} Hz\n"
        "frequency [Hz],stiffness [N/m],sd of stiffness [N/m],damping [N*s/m],loss factor [1],"
        "sd of loss factor [1]\n"
    )
    columns = (
        straight.frequency,
        straight.storage,
        straight.storage_sd,
        straight.damping,
        straight.loss_factor,
        straight.loss_factor_sd,
    )
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return head + "".join(",".join(map(repr, row)) + "\n" for row in rows)


def _partners(paths: tuple[str, ...], options: ReadOptions) -> tuple[list[RampHold], list[Fit]]:
    """Return the relaxation tests and the fits among the files given with ``--with``."""
    from dashpot.base.errors import ReadError
    from dashpot.cli._inputs import looks_like_json, read_fit
    from dashpot.io.read import read_relaxation
    from dashpot.preparation.prepare import prepare

    fits = [read_fit(path) for path in paths if looks_like_json(path)]
    tests = [
        prepare(read_relaxation(path, options=options))
        for path in paths
        if not looks_like_json(path)
    ]
    if len(fits) > 1 or (fits and tests):
        raise ReadError("--with takes relaxation tests or one fit, not both: leave the fit out")
    return tests, fits
