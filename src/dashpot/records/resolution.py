"""The step in which a channel was read."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray


def quantum(values: FloatArray) -> float:
    """The step of which all differences are whole multiples; 0 if there is none to be seen.

    Quantised readings repeat; where every second reading is a new one, no quantum is claimed.
    """
    levels = np.sort(values)
    gaps = np.diff(levels)
    gaps = gaps[gaps > 0]
    if not 1 <= len(gaps) <= 0.5 * len(values) - 1:
        return 0.0
    # what arithmetic leaves between two equal readings is no quantum
    gaps = gaps[gaps > 1e-9 * max(abs(levels[0]), abs(levels[-1]))]
    if len(gaps) == 0:
        return 0.0
    step = float(gaps.min())
    counts = np.round(gaps / step)
    off = np.abs(gaps / step - counts) / counts
    step = float(gaps.sum() / counts.sum())
    return 0.0 if np.mean(off < 0.02) < 0.98 or _evenly_climbed(values, step) else step


def _evenly_climbed(values: FloatArray, step: float) -> bool:
    """True if the steps are those of a perfect ramp between perfect rests, not of a converter."""
    moved = np.abs(np.diff(values))
    moving = moved > 0.5 * step
    # a converter that counts a ramp in single steps also pauses on it
    lone = moving[1:-1] & ~(moving[:-2] & moving[2:])
    single = np.mean(np.abs(moved[moving] / step - 1) < 0.02) > 0.9
    return bool(single and np.count_nonzero(lone) < 0.1 * np.count_nonzero(moving) + 4)
