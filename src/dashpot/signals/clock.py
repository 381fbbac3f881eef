"""Where a sampled clock goes on by far more than on either side: it jumped, or rows are missing."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median

# how much longer than the usual of so many steps on either side one is a leap
LEAP, BESIDE = 10.0, 5
# steps before and after, of one rate each
_LASTING = 20
# steps that are looked at for one, or for how even they are
_LOOKED_AT = 1000
# how much longer than the usual of the steps around it one is odd, and the share of such
_ODD, _UNEVEN = 3.0, 0.03


class Leap(NamedTuple):
    """A step of a clock, the sample it goes on from, and the usual of the steps beside it, s."""

    at: int
    step: float
    beside: float


def find_clock_jumps(time: FloatArray) -> list[Leap]:
    """Return the steps that are ten times the usual on either side; at an end, of one side."""
    steps = np.diff(time)
    if len(steps) < 2 * BESIDE or not steps.max() > LEAP * steps.min():
        return []
    least = np.minimum(np.append(np.inf, steps[:-1]), np.append(steps[1:], np.inf))
    longest = np.flatnonzero(steps > LEAP * least)[:_LOOKED_AT]
    leaps = (Leap(i, float(steps[i]), _compute_neighbour_step(steps, i)) for i in longest.tolist())
    return [leap for leap in leaps if leap.step > LEAP * leap.beside]


def lasting_change(time: FloatArray) -> Leap | None:
    """Return where steps change most, if at once and for twenty to either side, else None.

    `step` is then the usual of those behind, `beside` of those before. Less than tenfold is none.
    """
    steps = np.diff(time)
    if len(steps) < 2 * _LASTING or steps.min() <= 0 or not steps.max() > LEAP * steps.min():
        return None
    change = np.abs(np.diff(np.log(steps)))[_LASTING - 1 : len(steps) - _LASTING]
    at = int(change.argmax()) + _LASTING
    before, after = median(steps[at - _LASTING : at]), median(steps[at : at + _LASTING])
    # steps that grow by and by do so everywhere
    sudden = change[at - _LASTING] > 0.5 * abs(np.log(after / before)) > 0
    return Leap(at, after, before) if sudden else None


def ticks_evenly(time: FloatArray) -> bool:
    """True if few steps are far longer than those around them: none waits for a reading to change.

    Such a machine pauses as often as its reading rests; a clock that jumps does so a few times.
    """
    steps = np.diff(time)
    if len(steps) < 2 * BESIDE:
        return False
    around = np.lib.stride_tricks.sliding_window_view(steps, 2 * BESIDE + 1)
    around = around[:: max(1, len(around) // _LOOKED_AT)]
    usual = np.partition(around, BESIDE, axis=1)[:, BESIDE]
    odd = around[:, BESIDE] > _ODD * usual
    return bool(np.mean(odd) <= _UNEVEN)


def _compute_neighbour_step(steps: FloatArray, i: int) -> float:
    """The larger of the usual steps before and after one, s; at an end that of its one side."""
    sides = steps[max(i - BESIDE, 0) : i], steps[i + 1 : i + 1 + BESIDE]
    return max(median(side) for side in sides if len(side))
