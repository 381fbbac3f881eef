"""Robot of the virtual rig: motor axes, set-points and plate position."""

from __future__ import annotations

from math import exp, pi
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, sample_count
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_nonnegative, require_positive, select_fields
from dashpot.datamodel.relaxation import Trajectory

# Motor axis: a discrete PID, drag, dry friction.


@dataclass(frozen=True)
class Axis:
    r"""Motor axis under a discrete PID controller.

    .. math:: \ddot x = u - d\,\dot x - f\,\mathrm{sign}\,\dot x, \qquad
        U = k_p E + \frac{k_i}{s} E - \frac{k_d s}{1 + s T_f} X

    with :math:`k_p = \omega_n^2` and :math:`k_d = 2\zeta\omega_n - d`: without friction and
    without the integrator the closed loop is of second order with these :math:`\omega_n, \zeta`.
    The derivative acts on the position and is filtered. The integrator works where the error lies
    inside its zone or the axis, by the controller's own rate, stands still: it then brings an axis
    home that dry friction stopped far away, :math:`f / k_p` short, within some :math:`k_p / k_i`.
    It rests while the axis travels or the output is limited (anti-windup). Between control
    instants u is held and the motion is integrated exactly.

    Attributes
    ----------
    frequency, damping : float
        Natural frequency, Hz, and damping ratio of the closed loop.
    rate : float
        Control rate, Hz.
    drag : float
        Viscous drag d of the motor, 1/s.
    friction : float
        Dry friction f, m/s^2 (force over moving mass): above 0 the axis sticks and slips.
    integral : float
        k_i, 1/s^3.
    integral_zone : float
        The integrator works while the error is smaller than this, m,
    standstill : float
        or while the filtered rate is, m/s.
    filter_time : float
        T_f, s.
    limit : float
        Largest u, m/s^2.
    """

    frequency: float = 6.0
    damping: float = 0.6
    rate: float = 1000.0
    drag: float = 30.0
    friction: float = 0.0
    integral: float = 600.0
    integral_zone: float = 0.1e-3
    standstill: float = 0.2e-3
    filter_time: float = 2e-3
    limit: float = 20.0

    def __post_init__(self) -> None:
        positive_names = ("frequency", "damping", "rate", "drag", "filter_time", "limit")
        require_positive("axis ", **select_fields(self, *positive_names))
        nonnegative_names = ("friction", "integral", "integral_zone", "standstill")
        require_nonnegative("axis ", **select_fields(self, *nonnegative_names))
        if self.frequency > self.rate / 20:
            raise DataError(
                f"a loop of {self.frequency:g} Hz needs a control rate of at least "
                f"{20 * self.frequency:g} Hz, found {self.rate:g} Hz"
            )

    def follow(self, reference: npt.ArrayLike) -> FloatArray:
        """Return the position, m, at each control instant, started at rest on the first one.

        Parameters
        ----------
        reference : array_like, shape (n,)
            Set-point in force at each control instant, m.
        """
        target = np.asarray(reference, dtype=float).tolist()
        step = 1 / self.rate
        omega = 2 * pi * self.frequency
        kp, kd = omega**2, 2 * self.damping * omega - self.drag
        # exact motion over one step of constant drive: v -> a v + g u, x -> x + g v + w u
        a = exp(-self.drag * step)
        g = (1 - a) / self.drag
        w = (step - g) / self.drag
        filter_factor = 1 - exp(-step / self.filter_time)
        x = target[0]
        v = integral = rate = 0.0
        last = x
        path = []
        for target_position in target:
            path.append(x)
            error = target_position - x
            rate += filter_factor * ((x - last) / step - rate)
            last = x
            drive = kp * error + integral - kd * rate
            limited = min(max(drive, -self.limit), self.limit)
            is_near_target = abs(error) < self.integral_zone or abs(rate) < self.standstill
            if limited == drive and is_near_target:
                integral += self.integral * error * step
            if v == 0.0 and abs(limited) <= self.friction:
                continue
            direction = v if v != 0.0 else limited
            push = limited - (self.friction if direction > 0 else -self.friction)
            next_speed = a * v + g * push
            x += g * v + w * push
            # dry friction stops a motion; it never turns it round
            v = 0.0 if self.friction > 0 and v * next_speed < 0 else next_speed
        return np.array(path)


# Position of the plate: set-points in space, three axes, depth along its normal.


Point: TypeAlias = tuple[float, float, float]
"""x, y, z, m; or a direction."""


def setpoints(
    start: float | Point, stop: float | Point, *, duration: float, interval: float
) -> FloatArray:
    """Positions that a robot is sent through, evenly spaced in time, both ends exact.

    >>> len(setpoints(0.0, -8e-3, duration=1.0, interval=10e-3))
    101
    >>> setpoints((0, 0, 0), (0, 0, -8e-3), duration=1.0, interval=10e-3)[-1].tolist()
    [0.0, 0.0, -0.008]
    """
    first, last = np.asarray(start, dtype=float), np.asarray(stop, dtype=float)
    count = max(1, round(duration / interval))
    points = np.asarray(first + np.multiply.outer(np.arange(count + 1), last - first) / count)
    points[-1] = last
    return points


def unit(direction: npt.ArrayLike) -> FloatArray:
    """Return a direction as a vector of length 1.

    Raises
    ------
    DataError
        If it is not three numbers, or has no length.
    """
    vector = np.asarray(direction, dtype=float)
    length = float(np.linalg.norm(vector)) if vector.shape == (3,) else 0.0
    if not (np.isfinite(length) and length > 0):
        raise DataError(f"{direction!r} is no direction; expected three numbers, not all zero")
    return np.asarray(vector / length)


# Planned test as discrete set-points, for a controller with a position list.


def planned_trajectory(
    *,
    depth: Quantity,
    ramp_time: Quantity,
    hold_time: Quantity,
    baseline: Quantity = 1.0,
    interval: Quantity = 10e-3,
    along: Point = (0.0, 0.0, -1.0),
) -> Trajectory:
    """Return the set-points of a rest, a ramp and a hold, one each `interval`.

    The plate begins at the origin and is sent along a straight line; the ends of the ramp are
    exact.

    Parameters
    ----------
    depth : float
        Travel, m.
    ramp_time, hold_time, baseline : float
        s; the baseline before the ramp gives the zero of the force.
    interval : float
        Between set-points, s.
    along : (float, float, float)
        Direction of the motion in the controller's axes; of any length.

    Raises
    ------
    DataError
        If a time is no whole number of intervals, or not positive.
    """
    step = convert_to_si(interval, "time")
    if not (np.isfinite(step) and step > 0):
        raise DataError(f"a set-point each {step!r} s; expected a time > 0, such as 10ms")
    durations = {"rest": baseline, "ramp": ramp_time, "hold": hold_time}
    counts = {
        name: _count_setpoints(name, convert_to_si(value, "time"), step)
        for name, value in durations.items()
    }
    if not counts["ramp"]:
        raise DataError("the ramp takes no time; a controller needs one set-point in it at least")
    stop = tuple(convert_to_si(depth, "length") * unit(along))
    line = setpoints((0, 0, 0), stop, duration=counts["ramp"] * step, interval=step)
    rest, hold_positions = np.zeros((counts["rest"], 3)), np.tile(stop, (counts["hold"], 1))
    ratio = np.arange(counts["ramp"] + 1) / counts["ramp"]
    compression = convert_to_si(depth, "length") * np.concatenate(
        [rest[:, 0], ratio, np.ones(counts["hold"])]
    )
    points = np.vstack([rest, line, hold_positions])
    # a count times a decimal interval is not that decimal
    time = np.round(np.arange(len(points)) * step, 12)
    return Trajectory(time, compression, points)


def _count_setpoints(name: str, duration: float, step: float) -> int:
    if not (np.isfinite(duration) and duration >= 0):
        raise DataError(f"the {name} takes {duration!r} s; expected a time >= 0")
    count = round(duration / step)
    if abs(duration / step - count) > 1e-6:
        raise DataError(
            f"the {name} of {duration:g} s is no whole number of set-points {step:g} s apart; "
            f"make it {max(count, 1) * step:g} s, or the interval another"
        )
    if count:
        sample_count(duration, 1 / step)
    return count
