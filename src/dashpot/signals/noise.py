"""Noise of a channel: scatter, spikes and resolution."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, median

# Scatter and resolution of a channel.


# Largest number of samples of a noise estimate; its error is then 0.2 %.
_MAX_SAMPLES = 200_000


def scatter(time: FloatArray, values: FloatArray) -> float:
    r"""Standard deviation of the sample-to-sample scatter, for any trend and sampling.

    The residual of each sample from the straight line between its neighbours,
    :math:`r_i = y_i - w y_{i-1} - (1 - w) y_{i+1}`, has variance
    :math:`\sigma^2 (1 + w^2 + (1 - w)^2)` for white noise. The largest 2 % are omitted, for
    corners and glitches are no scatter; 0.935 is what that takes from a normal deviation.
    """
    if len(values) < 5:
        return 0.0
    squares = _compute_line_residuals(time, values, len(values) // _MAX_SAMPLES or 1) ** 2
    count = max(3, int(0.98 * len(squares)))
    smallest_squares = np.partition(squares, count - 1)[:count]
    return float(np.sqrt(smallest_squares.mean())) / (0.935 if count < len(squares) else 1.0)


def estimate_robust_scatter(time: FloatArray, values: FloatArray) -> float:
    """Return the same by the median: blind to corners and glitches, and to half of all samples."""
    if len(values) < 5:
        return 0.0
    return 1.4826 * median(np.abs(_compute_line_residuals(time, values)))


def _compute_line_residuals(time: FloatArray, values: FloatArray, count: int = 1) -> FloatArray:
    """Return residuals of samples from the line between their neighbours, of variance sigma^2."""
    before, middle, after = (slice(i, len(values) - 2 + i, count) for i in range(3))
    w = (time[after] - time[middle]) / (time[after] - time[before])
    r = values[middle] - w * values[before] - (1 - w) * values[after]
    return np.asarray(r / np.sqrt(1 + w**2 + (1 - w) ** 2))


def spikes(time: FloatArray, values: FloatArray) -> BoolArray:
    """Return a mask of samples that deviate from two neighbours that agree."""
    magnitude = np.abs(values - median_of_three(values))
    is_confirmed = np.zeros(len(values), dtype=bool)
    limit = 0.02 * float(np.ptp(values))
    if not (magnitude > limit).any():  # of most records no more need be known
        return is_confirmed
    limit = max(10 * scatter(time, values), limit)
    is_confirmed[1:-1] = np.abs(values[2:] - values[:-2]) < 0.3 * magnitude[1:-1]
    return np.asarray(is_confirmed & (magnitude > limit))


def remove_spikes(time: FloatArray, values: FloatArray) -> FloatArray:
    """Return the channel with every spike replaced by the nearer of its neighbours."""
    mask = spikes(time, values)
    return np.where(mask, median_of_three(values), values) if mask.any() else values


def median_of_three(values: FloatArray) -> FloatArray:
    """Removes a lone glitch, keeps every edge where it is."""
    result = values.copy()
    inner = result[1:-1]  # in place: new memory takes most of the time
    larger = np.maximum(values[:-2], inner)
    np.minimum(larger, values[2:], out=larger)
    np.minimum(values[:-2], inner, out=inner)
    np.maximum(inner, larger, out=inner)
    return result
