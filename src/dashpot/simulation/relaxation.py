"""Simulated motion on the virtual rig: a ramp and hold, or any other."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, sample_count
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.relaxation import RelaxationTest, Trajectory
from dashpot.datamodel.specimen import Specimen
from dashpot.simulation.rig_errors import Climate, Rig, RigTruth, prepare_specimen, round_to_quantum
from dashpot.simulation.robot import setpoints
from dashpot.solids.maxwell import GeneralizedMaxwell

# Any motion of the plate: corners, or set-points recorded or planned.


_CYCLES = 1.5
"""Cycles in which Mullins' softening falls to a part 1/e."""
_PRESSED, _RELEASED = 0.5, 0.05
"""Parts of the most so far between which a cycle goes."""


class MotionTruth(RigTruth):
    """Truth of a simulated motion on the virtual rig."""

    kind: ClassVar[str] = "motion"


@dataclass(frozen=True)
class SimulatedMotion:
    """Simulated record of a motion and its truth."""

    test: RelaxationTest
    truth: MotionTruth


def simulate_path(
    model: GeneralizedMaxwell,
    *,
    path: tuple[tuple[float, float], ...],
    rig: Rig | None = None,
    seed: int = 0,
    specimen: Specimen | None = None,
) -> tuple[RelaxationTest, FloatArray, FloatArray]:
    """Any path of a plate that is glued to the seal: staircases, cycles, unloading.

    Parameters
    ----------
    path : pair of array
        Corners that the plate is sent through, s after the baseline and m; it starts at (0, 0).
    specimen : Specimen, optional
        Specimen stated in the record.

    Returns
    -------
    test : RelaxationTest
        The record.
    position, force : array, shape (n,)
        The truth at its samples.
    """
    rig = Rig() if rig is None else rig
    end = rig.baseline + path[-1][0]
    sample_count(end, max(rig.axis.rate, rig.rate))
    clock = np.arange(round(end * rig.axis.rate) + 1) / rig.axis.rate
    reference = _staircase(clock, path, rig)
    return _simulate_record(
        model, clock, rig.axis.follow(reference), rig=rig, seed=seed, end=end, is_bonded=True,
        specimen=specimen or prepare_specimen(model, rig, None)[1],
    )  # fmt: skip


def simulate_motion(
    model: GeneralizedMaxwell,
    motion: Trajectory,
    *,
    rig: Rig | None = None,
    seed: int = 0,
    climate: Climate | None = None,
) -> SimulatedMotion:
    """Return a recorded or planned motion sent to the robot as its set-points, on a virtual rig.

    The seal is not glued to the plate: it never pulls.

    Parameters
    ----------
    model : GeneralizedMaxwell
        One piece of seal.
    motion : Trajectory
        At the time of a set-point the next one is sent; the plate begins at the first.
    rig : Rig, optional
        ``Rig()`` if not given; its own rest before the motion is omitted.
    seed : int
        Seed of the noise.
    climate : Climate, optional
        Makes the seal that of its temperature, which the record's specimen then states.
    """
    rig = Rig() if rig is None else rig
    model, specimen = prepare_specimen(model, rig, climate)
    elapsed = motion.time - motion.time[0]
    sample_count(elapsed[-1], max(rig.axis.rate, rig.rate))
    clock = np.arange(round(elapsed[-1] * rig.axis.rate) + 1) / rig.axis.rate
    sent = np.searchsorted(elapsed, clock + 1e-9, side="right")
    reference = motion.displacement[np.minimum(sent, len(elapsed) - 1)]
    test, position, force = _simulate_record(
        model,
        clock,
        rig.axis.follow(reference),
        rig=rig,
        seed=seed,
        end=float(elapsed[-1]),
        is_bonded=False,
        specimen=specimen,
    )
    truth = MotionTruth(
        model=model, rig=rig, seed=seed, displacement=position, force=force, climate=climate
    )
    return SimulatedMotion(test, truth)


def _simulate_record(
    model: GeneralizedMaxwell,
    clock: FloatArray,
    motion: FloatArray,
    *,
    rig: Rig,
    seed: int,
    end: float,
    is_bonded: bool,
    specimen: Specimen,
) -> tuple[RelaxationTest, FloatArray, FloatArray]:
    """Return the record of a true motion at the control instants, and the truth at its samples."""
    random = np.random.default_rng(seed)
    # the motion is laid on a grid at least as fine as the record
    oversampling = max(1, int(np.ceil(rig.rate / rig.axis.rate)))
    if oversampling > 1:
        dense = np.arange((len(clock) - 1) * oversampling + 1) / (rig.axis.rate * oversampling)
        motion, clock = _interpolate_motion(dense, clock, motion), dense
    compression = rig.compression(motion)
    answer = model.force(clock, compression)
    if not is_bonded:
        answer = np.maximum(answer, 0.0)
    if rig.softening:
        answer *= soften_motion(compression, rig.softening)
    time = np.arange(int(np.floor(end * rig.rate * (1 + 1e-12))) + 1) / rig.rate
    position, force = np.interp(time, clock, motion), np.interp(time, clock, answer)
    measured = position + rig.position_noise * random.standard_normal(len(time))
    test = RelaxationTest(
        time=time,
        displacement=round_to_quantum(measured, rig.encoder),
        force=rig.read(time, force, random),
        specimen=specimen,
        units="SI",
    )
    return test, position, force


def soften_motion(compression: FloatArray, share: float) -> FloatArray:
    r"""Return the force relative to the first cycle of a seal that softens with each cycle.

    :math:`1 - s (1 - e^{-(n-1)/1.5})` in cycle n. A cycle ends where a seal that was pressed by
    half of the most so far is let go to a twentieth of it.
    """
    max_so_far = np.maximum.accumulate(compression)
    released_indices = np.flatnonzero(compression < _RELEASED * max_so_far)
    pressed_indices = np.flatnonzero(compression > _PRESSED * max_so_far)
    softened, at = np.zeros(len(compression)), 0
    while (next_pressed := pressed_indices[pressed_indices >= at]).size and (
        ended := released_indices[released_indices > next_pressed[0]]
    ).size:
        at = int(ended[0])
        softened[at:] += 1
    return np.asarray(1 + share * np.expm1(-softened / _CYCLES))


def _staircase(clock: FloatArray, path: tuple[tuple[float, float], ...], rig: Rig) -> FloatArray:
    """Return the set-point in force at every control instant."""
    points, last, step_start = [np.zeros(1)], 0.0, 0.0
    for at, position in path:
        leg = setpoints(last, position, duration=at - step_start, interval=rig.setpoint_interval)
        points.append(leg[1:])
        last, step_start = position, at
    # a set-point is sent at the start of its interval: the staircase leads the straight line
    sent = np.concatenate(points)
    count = np.floor((clock - rig.baseline) / rig.setpoint_interval + 1e-9).astype(int) + 1
    return np.asarray(sent[np.clip(count, 0, len(sent) - 1)])


def _interpolate_motion(
    dense_time: FloatArray, clock: FloatArray, motion: FloatArray
) -> FloatArray:
    """Smooth motion between control instants."""
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(clock, motion)(dense_time))


# Ramp and hold.


@dataclass(frozen=True, eq=False)
class RelaxationTruth(RigTruth):
    """Truth of a simulated relaxation test.

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
    """Simulated relaxation test and its truth."""

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
    """Return a ramp to `depth` in `ramp_time`, held for `hold_time`, on a virtual rig.

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
        Seed of the noise.
    climate : Climate, optional
        Makes the seal that of its temperature, which the record's specimen then states.

    Raises
    ------
    DataError
        If depth or a time is not positive, or the law is not valid at the temperature.
    """
    depth = convert_to_si(depth, "length")
    ramp_time = convert_to_si(ramp_time, "time")
    hold_time = convert_to_si(hold_time, "time")
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
