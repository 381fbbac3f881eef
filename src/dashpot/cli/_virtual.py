"""Simulated tests as the text of their files, and the truth beside them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dashpot.solids.maxwell import GeneralizedMaxwell


def seal(name: str) -> tuple[GeneralizedMaxwell, float | None]:
    """Return a demonstration seal and its block's mass, or the model of a fit's JSON file."""
    from dashpot.cli._inputs import read_model
    from dashpot.solids.table_1 import SEALS

    if name in SEALS:
        return SEALS[name]
    return read_model(name), None


def relaxation(
    name: str,
    *,
    depth: float,
    ramp: float,
    hold: float,
    rate: float | None,
    noise_free: bool,
    seed: int,
) -> tuple[str, str]:
    """Return a simulated relaxation test as CSV, and its truth as JSON."""
    from dashpot.io.writers.text import write_relaxation
    from dashpot.simulation.relaxation import Rig, simulate_relaxation
    from dashpot.simulation.truth import stamp, truth_json

    model, _ = seal(name)
    rig = Rig() if rate is None else replace(Rig(), rate=rate)
    made = simulate_relaxation(
        model,
        depth=depth,
        ramp_time=ramp,
        hold_time=hold,
        rig=rig.noise_free() if noise_free else rig,
        seed=seed,
    )
    return write_relaxation(made.test, comments=stamp(made.truth)), truth_json(made.truth)


def impact(
    name: str,
    *,
    mass: float | None,
    seals: float,
    hits: int,
    record: float | None,
    rate: float | None,
    noise_free: bool,
    seed: int,
) -> tuple[str, str]:
    """Return a simulated hammer test as CSV, and its truth as JSON."""
    from dashpot.base.errors import DataError
    from dashpot.io.writers.text import write_impact
    from dashpot.simulation.impact import Hammer, simulate_impact
    from dashpot.simulation.truth import stamp, truth_json

    model, known = seal(name)
    block = mass if mass is not None else known
    if block is None:
        raise DataError(f"the mass under the hammer is not known for {name}; add --mass")
    hammer = Hammer()
    if record is not None:
        hammer = replace(hammer, record=record)
    if rate is not None:
        hammer = replace(hammer, rate=rate)
    made = simulate_impact(
        model,
        mass=block,
        seals=seals,
        hits=hits,
        rig=hammer.noise_free() if noise_free else hammer,
        seed=seed,
    )
    return write_impact(made.test, comments=stamp(made.truth)), truth_json(made.truth)
