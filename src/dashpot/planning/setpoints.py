"""The planned test as discrete set-points, for a controller that has its own list."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import sample_count
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.trajectory import Trajectory
from dashpot.simulation.kinematics import Point, setpoints, unit


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
        s; the rest before the ramp is what the zero of the force is read from.
    interval : float
        Between set-points, s.
    along : (float, float, float)
        Where the plate goes in the controller's own axes; of any length.

    Raises
    ------
    DataError
        If a time is no whole number of intervals, or not positive.
    """
    step = convert_to_si(interval, "time")
    if not (np.isfinite(step) and step > 0):
        raise DataError(f"a set-point each {step!r} s; expected a time > 0, such as 10ms")
    stated = {"rest": baseline, "ramp": ramp_time, "hold": hold_time}
    counts = {
        name: _steps(name, convert_to_si(value, "time"), step) for name, value in stated.items()
    }
    if not counts["ramp"]:
        raise DataError("the ramp takes no time; a controller needs one set-point in it at least")
    stop = tuple(convert_to_si(depth, "length") * unit(along))
    line = setpoints((0, 0, 0), stop, duration=counts["ramp"] * step, interval=step)
    rest, held = np.zeros((counts["rest"], 3)), np.tile(stop, (counts["hold"], 1))
    share = np.arange(counts["ramp"] + 1) / counts["ramp"]
    pressed = convert_to_si(depth, "length") * np.concatenate(
        [rest[:, 0], share, np.ones(counts["hold"])]
    )
    points = np.vstack([rest, line, held])
    # a count times a decimal interval is not that decimal
    time = np.round(np.arange(len(points)) * step, 12)
    return Trajectory(time, pressed, points)


def _steps(name: str, duration: float, step: float) -> int:
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
