"""Ramps and holds, found in a recorded displacement."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby
from operator import itemgetter
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.preparation.noise import median_of_three, usual_scatter
from dashpot.records.relaxation import quantum

_LEAST_MOVE = 0.05
"""A move smaller than this part of the whole travel is settling, not a ramp."""


_Kind: TypeAlias = Literal["hold", "load", "unload"]
_Side: TypeAlias = tuple[_Kind, int, int]


class Segment(NamedTuple):
    """A stretch of one motion.

    Attributes
    ----------
    kind : str
        ``"hold"``, ``"load"`` (displacement rises) or ``"unload"``.
    first, last : int
        Its first and last sample; neighbours share a sample.
    start, end : float
        Their times, s.
    origin, level : float
        Displacement at start and end, m; of a hold, the median twice.
    """

    kind: _Kind
    first: int
    last: int
    start: float
    end: float
    origin: float
    level: float

    @property
    def duration(self) -> float:
        """Time from start to end, s."""
        return self.end - self.start


def find_segments(time: FloatArray, displacement: FloatArray) -> tuple[Segment, ...]:
    """Split a record into loading, unloading and holding.

    A polygon is laid through the record, with a corner wherever a straight line would miss it
    by more than the grain of the channel or 1 % of the travel. Its sides are moves where they
    are fast or long, else holds; sides of one kind join; a move below 5 % of the travel
    (overshoot, settling) belongs to the hold beside it, and so does ringing of up to 30 % of the
    ramp right before it. Any sampling will do.

    Parameters
    ----------
    time, displacement : array, shape (n,)
        s and m; the sign as it is.
    """
    x = median_of_three(displacement)
    travel = float(np.ptp(x))
    grain = grain_of(time, displacement)
    if travel <= 4 * grain:
        return (_segment("hold", time, x, 0, len(x) - 1),)
    corners = _polygon(time, x, max(2 * grain, 0.01 * travel))
    kinds = _kinds(time[corners], x[corners], travel)
    sides = _joined(zip(kinds, corners, corners[1:], strict=False))
    sides = _settled(sides, time, x, travel)
    return tuple(_segment(kind, time, x, first, last) for kind, first, last in sides)


def grain_of(time: FloatArray, displacement: FloatArray) -> float:
    """What a displacement can differ by without having moved, m: 4 sigma, and half a quantum."""
    return 4 * usual_scatter(time, displacement) + 0.5 * quantum(displacement)


def _segment(
    kind: _Kind,
    time: FloatArray,
    x: FloatArray,
    first: int,
    last: int,
) -> Segment:
    origin, level = float(x[first]), float(x[last])
    if kind == "hold":
        origin = level = median(x[first : last + 1])
    return Segment(kind, first, last, float(time[first]), float(time[last]), origin, level)


def _polygon(time: FloatArray, x: FloatArray, tolerance: float) -> list[int]:
    """Corners of the coarsest polygon within `tolerance` (Ramer, Douglas and Peucker)."""
    corners = {0, len(x) - 1}
    stack = [(0, len(x) - 1)]
    while stack:
        a, b = stack.pop()
        if b - a < 2:
            continue
        line = x[a] + (x[b] - x[a]) * (time[a : b + 1] - time[a]) / (time[b] - time[a])
        miss = np.abs(x[a : b + 1] - line)
        worst = int(np.argmax(miss))
        if miss[worst] > tolerance:
            corners.add(a + worst)
            stack += [(a, a + worst), (a + worst, b)]
    return sorted(corners)


def _kinds(time: FloatArray, x: FloatArray, travel: float) -> list[_Kind]:
    moved = np.diff(x)
    speed = np.abs(moved) / np.diff(time)
    long = np.abs(moved) > _LEAST_MOVE * travel
    fastest = speed[long].max() if long.any() else speed.max()
    moving = (speed > 0.02 * fastest) | (np.abs(moved) > 0.25 * travel)
    return [
        "hold" if not moves else "load" if step > 0 else "unload"
        for moves, step in zip(moving, moved, strict=True)
    ]


def _joined(sides: Iterable[_Side]) -> list[_Side]:
    """Make one side of neighbours of one kind."""
    runs = [list(run) for _, run in groupby(sides, key=itemgetter(0))]
    return [(run[0][0], run[0][1], run[-1][2]) for run in runs]


def _settled(sides: list[_Side], time: FloatArray, x: FloatArray, travel: float) -> list[_Side]:
    """Give small moves to the hold beside them, then bridge stutters within a ramp."""
    sides = _joined(_rung_out(sides, x))
    sides = _joined(
        [
            ("hold" if abs(x[last] - x[first]) < _LEAST_MOVE * travel else kind, first, last)
            for kind, first, last in sides
        ]
    )
    bridged = list(sides)
    for i in range(1, len(sides) - 1):
        (before, start, _), (kind, first, last), (after, _, end) = sides[i - 1 : i + 2]
        brief = time[last] - time[first] < 0.05 * (time[end] - time[start])
        if kind == "hold" and brief and before == after:
            bridged[i] = (before, first, last)
    return _joined(bridged)


def _rung_out(sides: list[_Side], x: FloatArray) -> list[_Side]:
    """Call ringing a hold: to and fro right after a ramp, by less than 30 % of it."""
    settled: list[_Side] = []
    ramp = 0.0
    for kind, first, last in sides:
        moved = abs(x[last] - x[first])
        ringing = kind != "hold" and 0 < moved < 0.3 * ramp
        settled.append(("hold" if ringing else kind, first, last))
        if not ringing:
            ramp = 0.0 if kind == "hold" else moved
    return settled
