"""Simulated creep test: the virtual rig under force control."""

from __future__ import annotations

from math import cos, exp, sin, sqrt
from typing import ClassVar

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, sample_count
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_nonnegative, require_positive
from dashpot.extensions.curves.datamodel.creep import CreepTest
from dashpot.simulation.rig_errors import Climate, Rig, RigTruth, prepare_specimen, round_to_quantum
from dashpot.solids.maxwell import GeneralizedMaxwell

# Damping ratio of the control loop; higher values do not oscillate and follow equally well.
_LARGEST_DAMPING = 0.999


@dataclass(frozen=True, eq=False)
class CreepTruth(RigTruth):
    """Truth of a simulated creep test.

    Attributes
    ----------
    load : float
        As commanded, N.
    ramp_time, hold_time, recovery_time : float
        As commanded, s.
    """

    kind: ClassVar[str] = "creep"

    load: float
    ramp_time: float
    hold_time: float
    recovery_time: float


@dataclass(frozen=True)
class SimulatedCreep:
    """Simulated creep test and its truth."""

    test: CreepTest
    truth: CreepTruth


def simulate_creep(
    model: GeneralizedMaxwell,
    *,
    load: Quantity = 1.0,
    ramp_time: Quantity = 1.0,
    hold_time: Quantity = 40.0,
    recovery_time: Quantity = 0.0,
    rig: Rig | None = None,
    seed: int = 0,
    climate: Climate | None = None,
) -> SimulatedCreep:
    r"""A load reached in `ramp_time`, held for `hold_time`, and taken off as fast if requested.

    The force follows its command as a loop of second order with the natural frequency and the
    damping of the rig's axis; the seal answers by its creep, exactly.

    Parameters
    ----------
    model : GeneralizedMaxwell
        One specimen of seal; with a `climate`, at the reference of its law.
    load : float
        N.
    ramp_time, hold_time : float
        s.
    recovery_time : float
        Time of the record after unloading, s; with 0 the load is not taken off.
    rig : Rig, optional
        ``Rig()`` if not given.
    seed : int
        Seed of the noise.
    climate : Climate, optional
        Makes the seal that of its temperature, which the record's specimen then states.

    Raises
    ------
    DataError
        If the load or a time is not positive.
    """
    load, ramp_time, hold_time = (
        convert_to_si(load, "force"),
        convert_to_si(ramp_time, "time"),
        convert_to_si(hold_time, "time"),
    )
    recovery_time, rig = convert_to_si(recovery_time, "time"), Rig() if rig is None else rig
    require_positive(load=load, ramp_time=ramp_time, hold_time=hold_time)
    require_nonnegative(recovery_time=recovery_time)
    model, specimen = prepare_specimen(model, rig, climate)
    duration = ramp_time + hold_time
    corners, heights = [0.0, ramp_time, duration], [0.0, load, load]
    if recovery_time:
        corners += [duration + ramp_time, duration + ramp_time + recovery_time]
        heights += [0.0, 0.0]
    end = rig.baseline + corners[-1]
    sample_count(end, rig.rate)
    time = np.arange(int(np.floor(end * rig.rate * (1 + 1e-12))) + 1) / rig.rate
    force = _simulate_force_loop(np.interp(time - rig.baseline, corners, heights), rig)
    position = rig.gap + model.displacement(time, force)
    random = np.random.default_rng(seed)
    measured = position + rig.position_noise * random.standard_normal(len(time))
    displacement, recorded_force = (
        round_to_quantum(measured, rig.encoder),
        rig.read(time, force, random),
    )
    test = CreepTest(time, displacement, recorded_force, specimen=specimen, units="SI")
    truth = CreepTruth(
        load, ramp_time, hold_time, recovery_time, model=model, rig=rig, seed=seed,
        displacement=position, force=force, climate=climate,
    )  # fmt: skip
    return SimulatedCreep(test, truth)


def _simulate_force_loop(command: FloatArray, rig: Rig) -> FloatArray:
    """Return the force that a loop of second order makes of its command, held between samples."""
    damping = min(rig.axis.damping, _LARGEST_DAMPING)
    omega, step = 2 * np.pi * rig.axis.frequency, 1 / rig.rate
    damped_omega = omega * sqrt(1 - damping**2)
    decay_factor, c, s = (
        exp(-damping * omega * step),
        cos(damped_omega * step),
        sin(damped_omega * step),
    )
    damping_ratio = damping * omega / damped_omega
    transition = decay_factor * np.array(
        [
            [c + damping_ratio * s, s / damped_omega],
            [-(omega**2) * s / damped_omega, c - damping_ratio * s],
        ]
    )
    state, followed_load = np.zeros(2), np.empty(len(command))
    for i, target_load in enumerate(command):
        followed_load[i] = state[0]
        state = np.array([target_load, 0.0]) + transition @ (state - [target_load, 0.0])
    return followed_load
