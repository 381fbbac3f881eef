"""The ideal ramp in a recorded one: straight, with two corners."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.preparation.segments import Segment


class IdealRamp(NamedTuple):
    """A straight ramp: ``x = level + speed * (t - at)``.

    Attributes
    ----------
    speed : float
        m/s.
    at, level : float
        One point of it, s and m.
    first, last : int
        The samples it was fitted to.
    """

    speed: float
    at: float
    level: float
    first: int
    last: int

    def time_of(self, displacement: float) -> float:
        """When the line passes `displacement`, s."""
        return self.at + (displacement - self.level) / self.speed


def ideal_ramp(
    time: FloatArray, displacement: FloatArray, ramp: Segment, *, origin: float, level: float
) -> IdealRamp:
    """The straight line through the middle of a ramp, from `origin` to `level`, m.

    A real axis starts late and rounds both corners; between 20 % and 80 % of the rise it runs
    straight, and there a line is fitted. Extended to `origin` and to `level` it gives the
    ramp of equal speed that eq. 5 asks for, with the lag of the axis taken out and the encoder's
    count averaged away. With fewer than 3 samples there, the line joins the crossings of 20 %
    and 80 %.
    """
    # one sample beyond the segment on either side holds the corners of a coarse record
    start, stop = max(ramp.first - 1, 0), min(ramp.last + 2, len(time))
    t, x = time[start:stop], displacement[start:stop]
    low, high = origin + 0.2 * (level - origin), origin + 0.8 * (level - origin)
    first = _last_below(x, low)
    last = first + int(np.argmax(x[first:] >= high))
    inside = slice(first + 1, last)
    if last - first - 1 >= 3:
        tm, xm = float(t[inside].mean()), float(x[inside].mean())
        moved = t[inside] - tm
        speed = float(moved @ (x[inside] - xm) / (moved @ moved))
        return IdealRamp(speed, tm, xm, start + first + 1, start + last - 1)
    t_low = _crossing(t, x, first, low)
    t_high = max(_crossing(t, x, last - 1, high), np.nextafter(t_low, np.inf))
    return IdealRamp((high - low) / (t_high - t_low), t_low, low, start + first, start + last)


def _last_below(x: FloatArray, level: float) -> int:
    """The last sample below `level` before the record first stands at its highest."""
    top = int(np.argmax(x))
    below = np.flatnonzero(x[:top] < level)
    return int(below[-1]) if below.size else 0


def _crossing(t: FloatArray, x: FloatArray, i: int, level: float) -> float:
    """Where the straight line from sample `i` to the next passes `level`."""
    rise = x[i + 1] - x[i]
    part = (level - x[i]) / rise if rise > 0 else 0.0
    return float(t[i] + min(max(part, 0.0), 1.0) * (t[i + 1] - t[i]))
