"""A ramp and a hold on the virtual rig."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.validators import require_positive
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.simulation.motion import simulate_path
from dashpot.simulation.rig import Climate, Rig, RigTruth, prepare_specimen
from dashpot.solids.maxwell import GeneralizedMaxwell


@dataclass(frozen=True, eq=False)
class RelaxationTruth(RigTruth):
    """What really happened on the virtual rig.

    Attributes
    ----------
    depth, ramp_time, hold_time : float
        As commanded from first contact, m and s.
    onset, ramp_end : float
        The straight part of the true ramp extended to first contact and to the held depth, s
        on the clock of the record: the ideal ramp that the robot made.
    contact : float
        Plate position at first contact, m.
    """

    kind: ClassVar[str] = "relaxation"

    depth: float
    ramp_time: float
    hold_time: float
    onset: float
    ramp_end: float
    contact: float


@dataclass(frozen=True)
class SimulatedRelaxation:
    """A simulated test and its truth."""

    test: RelaxationTest
    truth: RelaxationTruth


def simulate_relaxation(
    model: GeneralizedMaxwell,
    *,
    depth: Quantity = 8e-3,
    ramp_time: Quantity = 1.0,
    hold_time: Quantity = 40.0,
    rig: Rig | None = None,
    seed: int = 0,
    climate: Climate | None = None,
) -> SimulatedRelaxation:
    """A ramp to `depth` in `ramp_time`, held for `hold_time`, on a virtual rig.

    Parameters
    ----------
    model : GeneralizedMaxwell
        One piece of seal; with a `climate`, at the reference of its law.
    depth : float
        Compression from first contact, m; the plate crosses ``rig.gap`` on its way, at the
        same speed.
    ramp_time, hold_time : float
        s.
    rig : Rig, optional
        ``Rig()`` if not given.
    seed : int
        Of the noise.
    climate : Climate, optional
        Makes the seal that of its temperature, which the record's specimen then states.

    Raises
    ------
    DataError
        If depth or a time is not positive, or the law knows nothing of the temperature.
    """
    depth, ramp_time, hold_time = (
        convert_to_si(depth, "length"),
        convert_to_si(ramp_time, "time"),
        convert_to_si(hold_time, "time"),
    )
    rig = Rig() if rig is None else rig
    require_positive(depth=depth, ramp_time=ramp_time, hold_time=hold_time)
    model, specimen = prepare_specimen(model, rig, climate)
    travel = rig.gap + depth
    duration = ramp_time * travel / depth
    test, position, force = simulate_path(
        model,
        path=((duration, travel), (duration + hold_time, travel)),
        rig=rig,
        seed=seed,
        specimen=specimen,
    )
    onset, ramp_end = _ideal_ramp(test.time, position, contact=rig.gap, travel=travel)
    truth = RelaxationTruth(
        model=model, depth=depth, ramp_time=ramp_time, hold_time=hold_time, onset=onset,
        ramp_end=ramp_end, contact=rig.gap, rig=rig, seed=seed, displacement=position, force=force,
        climate=climate,
    )  # fmt: skip
    return SimulatedRelaxation(test=test, truth=truth)


def _ideal_ramp(
    time: FloatArray, position: FloatArray, *, contact: float, travel: float
) -> tuple[float, float]:
    middle = (position > 0.3 * travel) & (position < 0.7 * travel) & (np.arange(len(time)) > 0)
    middle &= np.arange(len(time)) <= int(np.argmax(position >= 0.7 * travel))
    if np.count_nonzero(middle) < 2:
        crossing = np.interp([contact, travel * (1 - 1e-6)], np.maximum.accumulate(position), time)
        return float(crossing[0]), float(crossing[1])
    speed, offset = np.polyfit(time[middle] - time[0], position[middle], 1)
    return (
        float(time[0] + (contact - offset) / speed),
        float(time[0] + (travel - offset) / speed),
    )
