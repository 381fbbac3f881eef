"""Fewer points for the eye, with none of the noise hidden."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray


def downsample_to_extremes(
    x: FloatArray, y: FloatArray, *, bins: int = 500, log: bool = False
) -> tuple[FloatArray, FloatArray]:
    """The lowest and the highest sample of every bin of x, in the order they were recorded.

    A line through them covers the same paper as a line through every sample, once a bin is
    narrower than the line is wide. Bins are even in x, or in ln x (then only x > 0 is kept).
    Returns the samples untouched where there are few.
    """
    x, y = _positive(x, y) if log else (x, y)
    if len(x) <= 2 * bins:
        return x, y
    label, starts = _assign_bins(x, bins, log)
    low = _first_equal(y, np.minimum.reduceat(y, starts), label)
    high = _first_equal(y, np.maximum.reduceat(y, starts), label)
    retained = np.union1d(low, high)
    return x[retained], y[retained]


def downsample_to_means(
    x: FloatArray, y: FloatArray, *, bins: int = 120, log: bool = False
) -> tuple[FloatArray, FloatArray]:
    """The mean of x and of y over every bin that holds a sample."""
    x, y = _positive(x, y) if log else (x, y)
    if len(x) == 0:
        return x, y
    _, starts = _assign_bins(x, bins, log)
    count = np.diff(np.append(starts, len(x)))
    return np.add.reduceat(x, starts) / count, np.add.reduceat(y, starts) / count


def _positive(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    first = int(np.searchsorted(x, 0.0, side="right"))
    return x[first:], y[first:]


def _assign_bins(x: FloatArray, bins: int, log: bool) -> tuple[IndexArray, IndexArray]:
    """Number the bin of every sample 0, 1, 2..., empty bins left out; where each bin starts."""
    scale = np.log(x) if log else x
    span = scale[-1] - scale[0] or 1.0
    raw = np.minimum((scale - scale[0]) / span * bins, bins - 1).astype(np.intp)
    fresh = np.concatenate(([True], np.diff(raw) > 0))
    return np.cumsum(fresh) - 1, np.flatnonzero(fresh)


def _first_equal(y: FloatArray, extreme: FloatArray, label: IndexArray) -> IndexArray:
    hits = np.flatnonzero(y == extreme[label])
    _, first = np.unique(label[hits], return_index=True)
    return hits[first]
