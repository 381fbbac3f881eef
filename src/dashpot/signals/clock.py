"""Clock of a record: even steps, jumps, changes of rate, pauses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median

# Recording faults: a channel stuck at one value, and a clock that jumps.


# Jumps of a clock, or missing rows.


# Ratio of a step to the median of its neighbours above which it is a jump, and number of
# neighbours.
JUMP_RATIO, NEIGHBOUR_STEPS = 10.0, 5
# steps before and after, of one rate each
_MIN_STEPS_PER_RATE = 20
# steps that are looked at for one, or for how even they are
_MAX_STEPS = 1000
# how much longer than the usual of the steps around it one is odd, and the share of such
_PAUSE_RATIO, _MAX_PAUSE_SHARE = 3.0, 0.03


class ClockJump(NamedTuple):
    """Jump of a clock: its size, the sample after it, and the usual step there, s."""

    at: int
    step: float
    expected_step: float


def find_clock_jumps(time: FloatArray) -> list[ClockJump]:
    """Return the steps that are ten times the usual on either side; at an end, of one side."""
    steps = np.diff(time)
    if len(steps) < 2 * NEIGHBOUR_STEPS or not steps.max() > JUMP_RATIO * steps.min():
        return []
    smaller_neighbour = np.minimum(np.append(np.inf, steps[:-1]), np.append(steps[1:], np.inf))
    longest = np.flatnonzero(steps > JUMP_RATIO * smaller_neighbour)[:_MAX_STEPS]
    jumps = (
        ClockJump(i, float(steps[i]), _compute_neighbour_step(steps, i)) for i in longest.tolist()
    )
    return [jump for jump in jumps if jump.step > JUMP_RATIO * jump.expected_step]


def find_rate_change(time: FloatArray) -> ClockJump | None:
    """Return the largest change of the sampling rate, if the rate is even on both sides; else None.

    `step` is then the usual step after it, `expected_step` the one before. Less than tenfold is
    none.
    """
    steps = np.diff(time)
    if (
        len(steps) < 2 * _MIN_STEPS_PER_RATE
        or steps.min() <= 0
        or not steps.max() > JUMP_RATIO * steps.min()
    ):
        return None
    change = np.abs(np.diff(np.log(steps)))[
        _MIN_STEPS_PER_RATE - 1 : len(steps) - _MIN_STEPS_PER_RATE
    ]
    jump = int(change.argmax()) + _MIN_STEPS_PER_RATE
    step_before = median(steps[jump - _MIN_STEPS_PER_RATE : jump])
    median_after = median(steps[jump : jump + _MIN_STEPS_PER_RATE])
    # steps that grow by and by do so everywhere
    sudden = change[jump - _MIN_STEPS_PER_RATE] > 0.5 * abs(np.log(median_after / step_before)) > 0
    return ClockJump(jump, median_after, step_before) if sudden else None


def has_few_pauses(time: FloatArray) -> bool:
    """True if few steps are far longer than those around them: none waits for a reading to change.

    Such a machine pauses as often as its reading rests; a clock that jumps does so a few times.
    """
    steps = np.diff(time)
    if len(steps) < 2 * NEIGHBOUR_STEPS:
        return False
    neighbour_steps = np.lib.stride_tricks.sliding_window_view(steps, 2 * NEIGHBOUR_STEPS + 1)
    neighbour_steps = neighbour_steps[:: max(1, len(neighbour_steps) // _MAX_STEPS)]
    usual_step = np.partition(neighbour_steps, NEIGHBOUR_STEPS, axis=1)[:, NEIGHBOUR_STEPS]
    is_pause = neighbour_steps[:, NEIGHBOUR_STEPS] > _PAUSE_RATIO * usual_step
    return bool(np.mean(is_pause) <= _MAX_PAUSE_SHARE)


def _compute_neighbour_step(steps: FloatArray, i: int) -> float:
    """The larger of the usual steps before and after a step, s; at an end the only one."""
    sides = steps[max(i - NEIGHBOUR_STEPS, 0) : i], steps[i + 1 : i + 1 + NEIGHBOUR_STEPS]
    return max(median(side_values) for side_values in sides if len(side_values))


# relative difference below which steps of a clock count as even
_EVEN_TOLERANCE = 0.2


def is_evenly_sampled(time: FloatArray) -> bool:
    """Return whether the steps of a clock differ by no more than a fifth of their mean."""
    steps = np.diff(time)
    return len(steps) > 1 and bool(np.ptp(steps) <= _EVEN_TOLERANCE * steps.mean())
