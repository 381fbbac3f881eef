"""Cycles of a harmonic motion: when each begins, and whether a record is made of them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial

from dashpot.base.arrays import FloatArray, median

_CROSSING_SD = 5.0
"""SD of the displacement's noise beyond which its sign is sure."""
_PASSES = 3
_MIN_COUNT = 2
"""Cycles: a creep that its drift is taken off looks like one."""
_MIN_SAMPLES, _MANY = 7, 32
"""Fewest samples per cycle that distinguish sine from triangle, and noise from misfit."""
_MAX_DISTORTION = 0.04
"""Rms deviation from a sine beyond noise, over the amplitude; a triangle has 0.08."""
_MIN_HARMONIC_SHARE = 0.65
"""Fraction of the time between first and last harmonic cycle that consists of such cycles."""
_MIN_SPAN_SHARE = 0.4
"""Smallest fraction of this time in the record, which may start with a ramp and a rest."""


def is_harmonic(time: FloatArray, motion: FloatArray, _: FloatArray) -> bool:
    r"""Return whether a record is of harmonic cycles, at one amplitude and frequency or several.

    A cycle is harmonic where :math:`x_0 + \mathrm{Re}\,X e^{j\omega t}` misses its samples,
    beyond their noise, by less than 4 % of the amplitude.

    Parameters
    ----------
    time, motion : array, shape (n,)
        s, and displacement or strain in any unit. A third array, the force, is not checked.
    """
    rise_starts, fall_starts = find_cycle_starts(time, motion), find_cycle_starts(time, -motion)
    starts = max(rise_starts, fall_starts, key=len)
    cycles = [pair for pair in pairwise(starts.tolist()) if _is_sine(time, motion, *pair)]
    if len(cycles) < _MIN_COUNT:
        return False
    harmonic_duration = sum(end - begin for begin, end in cycles)
    span = cycles[-1][1] - cycles[0][0]
    return bool(
        harmonic_duration >= _MIN_HARMONIC_SHARE * span
        and span >= _MIN_SPAN_SHARE * float(np.ptp(time))
    )


def _is_sine(time: FloatArray, motion: FloatArray, begin: float, end: float) -> bool:
    in_cycle = (time >= begin) & (time < end)
    count = np.count_nonzero(in_cycle)
    if count < _MIN_SAMPLES:
        return False
    t, x = time[in_cycle] - begin, motion[in_cycle]
    omega = 2 * np.pi / (end - begin)
    A = np.column_stack((np.ones_like(t), np.cos(omega * t), np.sin(omega * t)))
    factors = np.linalg.lstsq(A, x, rcond=None)[0]
    residual = x - A @ factors
    noise = estimate_scatter(residual) if count >= _MANY else 0.0
    mean_square = max(float(np.mean(residual**2)) - noise**2, 0.0)
    return mean_square < (_MAX_DISTORTION * float(np.hypot(*factors[1:]))) ** 2


def find_cycle_starts(t: FloatArray, x: FloatArray) -> FloatArray:
    """Return times at which a motion, less its drift, rises through its middle, s."""
    drift = Polynomial.fit(t, x, 1)
    noise = estimate_scatter(x)
    for _ in range(_PASSES):
        level = x - drift(t)
        tolerance, level_sd = _CROSSING_SD * noise, float(np.std(level))
        # of few samples a cycle a motion looks like noise, but of less than half its size
        starts = _find_rises(
            t, level, min(tolerance, level_sd) if 2 * noise < level_sd else tolerance
        )
        if len(starts) < 3:
            break
        rows = np.searchsorted(t, starts)
        count = np.diff(rows)
        means = np.add.reduceat(np.column_stack((t, x)), rows)[:-1] / count[:, None]
        # of whole cycles: a sine itself has a slope
        drift = Polynomial.fit(means[:, 0], means[:, 1], 1)
    return starts


def estimate_scatter(x: FloatArray) -> float:
    """Return the SD of the noise of samples, by their second differences."""
    return float(1.4826 * median(np.abs(np.diff(x, 2))) / np.sqrt(6))


def _find_rises(t: FloatArray, x: FloatArray, tolerance: float) -> FloatArray:
    """Times at which x rises through its median; noise at a slow crossing is no cycle."""
    # a loop may stand on a preload, and small ones follow large ones about the same middle
    deviation = x - median(x)
    is_clear = np.abs(deviation) > tolerance
    t, deviation = t[is_clear], deviation[is_clear]
    turns = np.flatnonzero((deviation[:-1] < 0) & (deviation[1:] > 0))
    ratio = deviation[turns] / (deviation[turns] - deviation[turns + 1])
    return np.asarray(t[turns] + ratio * (t[turns + 1] - t[turns]))
