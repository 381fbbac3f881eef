"""Channels stuck at one value: a hung converter, or a lost link."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, erf, log, sqrt

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray, median
from dashpot.datamodel.relaxation import find_quantum

# Stuck channels: a hung converter, or a lost link.
#
# Equal readings are no fault by themselves. A coarse converter repeats a count until the signal has
# moved by one, and a simulation without noise repeats what has come to rest. So a run of equal
# readings is taken for a fault only where what stands beside it rules that out:
#
# * *noise*: the other readings scatter over three counts and more. Of independent readings with
#   standard deviation :math:`\sigma` and counts of q, one is the same as the one before with
#   probability :math:`p \le \mathrm{erf}(q / 2\sqrt2\sigma)`; n of them hold a run of m with
#   probability below :math:`n p^{m-1}`. How often readings turn back by three counts bounds
#   :math:`\sigma` from below.
# * *a leap*: the channel goes on from another value, several counts off, and stays there.
# * *a stop*: it changes by counts from sample to sample, always the same way, and then not at all.
# * *an end too soon*: of an arm that relaxes by N counts less than one is left only after it has
#   relaxed by :math:`\sqrt N` or less in the later half of the time since it was loaded, since
#   :math:`(N e^{-t/2\tau})^2 / N < 1`. What relaxed by far more does not then stand still for as
#   long
#   again.


# smallest number of samples for a decision
MIN_SAMPLES = 60
# equal readings that are looked at
MIN_RUN = 8
# probability of a false alarm
FALSE_ALARM_RATE = 1e-6
# second differences of noise, in counts: two levels in turn make 2
MIN_NOISE_BEND = 2.5
# readings that turn back by that much, at least, and their part of all that differ, by which the
# noise is at least so many counts (simulated, whatever the drift)
MIN_TURNS = 10
TURN_SCATTER = ((0.01, 0.25), (0.08, 0.4), (0.25, 0.6), (0.4, 0.9))
# counts of a leap, times the usual step, and readings after it that stay there
JUMP_COUNTS, JUMP_STEP_RATIO, SAMPLES_AFTER = 4.0, 6.0, 7
# samples in which a channel changes by so many counts before it stops
SAMPLES_BEFORE, MIN_CHANGE_COUNTS = 10, 10.0
# of an end too soon, in counts: so many times the root of what relaxed, and so many more
RELAXED_ROOT_FACTOR, EXTRA_COUNTS = 2.0, 4.0
# what arithmetic leaves of equal readings, and of a change that is one
EQUALITY_TOLERANCE, CHANGE_TOLERANCE = 1e-13, 1e-11


def find_stuck_runs(
    values: FloatArray,
    *,
    is_at_rest: BoolArray | None = None,
    leaps: bool = True,
    time_since_ramp: FloatArray | None = None,
    other_stretches: Sequence[FloatArray] = (),
) -> IndexArray:
    """Return first and last sample of every run of equal readings that is a fault, shape (n, 2).

    Parameters
    ----------
    values : array, shape (m,)
        The readings as they stand in the file.
    is_at_rest : array of bool, shape (m,), optional
        Samples without excitation: only there are jumps and stops faults.
    leaps : bool
        Whether a jump is a fault; it is none at the onset of a hit.
    time_since_ramp : array, shape (m,), optional
        For a channel that falls as it relaxes: time since it was loaded, s.
    other_stretches : sequence of array
        Other stretches of the channel: noise that each of them shows, this one has, too.
    """
    no_runs = np.zeros((0, 2), dtype=np.intp)
    largest_reading = float(np.abs(values).max(initial=0.0))
    if len(values) < MIN_SAMPLES or largest_reading == 0.0:
        return no_runs
    starts = np.concatenate(
        ([0], np.flatnonzero(np.abs(np.diff(values)) > EQUALITY_TOLERANCE * largest_reading) + 1)
    )
    stops = np.append(starts[1:], len(values))
    long_runs = np.flatnonzero(stops - starts >= MIN_RUN)
    if not len(long_runs):
        return no_runs
    levels, count = values[starts], find_quantum(values)
    noise_level = max(count, CHANGE_TOLERANCE * largest_reading)
    shortest = _compute_shortest_fault(levels, count, noise_level, len(values))
    if other_stretches:
        shortest_of_others = [
            _compute_shortest_fault(
                _select_changed_readings(row), count, noise_level, len(values), turns=False
            )
            for row in other_stretches
            if len(row) >= MIN_SAMPLES
        ]
        if len(shortest_of_others) == len(other_stretches):
            shortest = min(shortest, max(shortest_of_others))
    is_free = np.ones(len(values), dtype=bool) if is_at_rest is None else is_at_rest
    usual_change = median(np.abs(np.diff(levels))) if len(levels) > 1 else 0.0
    least_jump = max(JUMP_COUNTS * count, JUMP_STEP_RATIO * usual_change)

    def is_fault(run: slice) -> bool:
        return (
            run.stop - run.start >= shortest
            or (leaps and _has_jump(values, run, is_free, least_jump))
            or _has_stop(values, run, is_free, noise_level)
            or (
                time_since_ramp is not None
                and _has_early_end(values, run, time_since_ramp, noise_level)
            )
        )

    runs = [slice(int(starts[i]), int(stops[i])) for i in long_runs]
    results = [(run.start, run.stop - 1) for run in runs if is_fault(run)]
    return np.array(results, dtype=np.intp).reshape(-1, 2)


def _select_changed_readings(values: FloatArray) -> FloatArray:
    """Return the readings that differ from the one before."""
    changed = np.append(True, np.diff(values) != 0)
    return np.asarray(values[changed])


def _compute_shortest_fault(
    levels: FloatArray, count: float, noise_level: float, samples: int, *, turns: bool = True
) -> float:
    """Return how many equal readings the noise of the others rules out; infinity if they show none.

    Without `turns` readings need not turn back, but their steps: a ramp climbs by more than noise.
    """
    steps = np.diff(levels)
    second_differences = np.diff(steps)
    noisy = np.abs(second_differences) > MIN_NOISE_BEND * noise_level
    # the crests of a wave turn back, too, but bend one way
    noisy[1:] &= second_differences[:-1] * second_differences[1:] < 0
    if turns:
        noisy &= steps[:-1] * steps[1:] < 0
    second_differences = np.abs(second_differences)
    noisy_fraction = float(np.mean(noisy)) if len(noisy) else 0.0
    if np.count_nonzero(noisy) < MIN_TURNS or noisy_fraction < TURN_SCATTER[0][0]:
        return np.inf
    if count == 0.0:
        return MIN_RUN
    scatter = max(counts for min_share, counts in TURN_SCATTER if noisy_fraction >= min_share)
    if noisy_fraction >= TURN_SCATTER[-1][0]:
        # readings that repeat are left out, so what is left scatters by more
        scatter = max(scatter, 0.7 * 1.4826 * median(second_differences) / sqrt(6.0) / count)
    same_reading_chance = erf(1 / (2 * sqrt(2.0) * scatter))
    return max(MIN_RUN, ceil(1 + log(FALSE_ALARM_RATE / samples) / log(same_reading_chance)))


def _has_jump(values: FloatArray, run: slice, is_at_rest: BoolArray, min_leap: float) -> bool:
    """Return whether a channel jumps to another value after standing still, and stays there."""
    values_after = values[run.stop : run.stop + SAMPLES_AFTER]
    if (
        len(values_after) < SAMPLES_AFTER
        or not is_at_rest[max(run.start - 1, 0) : run.stop + SAMPLES_AFTER].all()
    ):
        return False
    jump_threshold, lasting_leap = (
        abs(values_after[0] - values[run.start]),
        abs(median(values_after) - values[run.start]),
    )
    return bool(min(jump_threshold, lasting_leap) > min_leap > 0.0)


def _has_stop(values: FloatArray, run: slice, is_at_rest: BoolArray, count: float) -> bool:
    """Return whether a channel that changes by counts a sample, all one way, changes no more."""
    start, first = run.start, run.start - SAMPLES_BEFORE
    if first < 0 or run.stop - start < SAMPLES_BEFORE or not is_at_rest[first : run.stop].all():
        return False
    steps = np.diff(values[first : start + 1])
    one_way = (steps >= 0).all() or (steps <= 0).all()
    return bool(one_way and abs(values[start] - values[first]) > MIN_CHANGE_COUNTS * count)


def _has_early_end(
    values: FloatArray, run: slice, time_since_ramp: FloatArray, count: float
) -> bool:
    """Return whether a channel that falls stands still long before its slowest arm has relaxed."""
    start = run.start
    if not 0 < time_since_ramp[start] < time_since_ramp[run.stop - 1] / 2:
        return False
    load_index = int(np.searchsorted(time_since_ramp, 0.0))
    half_index = int(np.searchsorted(time_since_ramp, time_since_ramp[start] / 2))
    if half_index - load_index < SAMPLES_BEFORE:
        return False
    slope, late_slope = (float(values[i] - values[start]) / count for i in (load_index, half_index))
    return bool(late_slope > RELAXED_ROOT_FACTOR * sqrt(max(slope, 0.0)) + EXTRA_COUNTS)
