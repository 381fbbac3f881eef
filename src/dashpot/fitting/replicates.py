r"""Whether several tests are different records, and of one seal.

A record given twice makes every standard error smaller by :math:`\sqrt 2` and tells nothing; two
lots fitted as one seal give a seal that does not exist.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray, median
from dashpot.base.errors import FitError
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.nuisance_priors import priors

# tests whose depths differ by less than this part are of one depth
SAME_DEPTH = 0.02
# noise correlates by 1/sqrt(n) in two records, and by 0.5 where one keeps a quarter of the other
COPIED = 0.3
_FEWEST = 400
# samples to a mean: enough to outlive interpolation between other samples
_TO_A_MEAN = 4
_SMOOTH = 9
# a line of hum counts for no more than this many times the usual amplitude
_CLIPPED = 3.0
_LAGS = 3
# what is left of a record without noise is its course, which two tests of one seal share
_COURSE = 3.0


class EndStiffness(NamedTuple):
    """Stiffness of one test at one time after its ramp, N/m, and its standard error."""

    value: float
    sd: float
    depth: float
    temperature: float | None


def refuse_copies(records: Sequence[RampHold]) -> None:
    """Refuse a record that is given twice, as it is or resampled.

    Raises
    ------
    FitError
        If two records are of one part of one file, hold equal samples, or scatter alike: the
        noise of two tests is not correlated, whatever the seal.
    """
    for (i, record), (j, other) in combinations(enumerate(records, start=1), 2):
        reason = _describe_copy(record, other)
        if reason:
            raise FitError(
                f"tests {i} and {j} are one record, {reason}: counted twice it would make every "
                "error look smaller by a factor 1.4; give each record once"
            )


def _describe_copy(first: RampHold, second: RampHold) -> str:
    if first.source is not None and second.source is not None:
        change = max(abs(first.onset - second.onset), abs(first.hold_end - second.hold_end))
        if first.source.sha256 == second.source.sha256 and change < 0.1 * first.ramp_time:
            return f"the same part of {first.source.file}"
    if np.array_equal(first.force, second.force):
        return "sample for sample"
    if abs(first.depth / second.depth - 1) > SAME_DEPTH:
        return ""
    alike = noise_correlation(first, second)
    return f"resampled (their noise correlates by {alike:.2f})" if alike > COPIED else ""


def noise_correlation(ramp_hold: RampHold, other: RampHold) -> float:
    """Return the correlation of what two holds scatter about their smooth course, -1 to 1.

    Means over a few samples at equal times after the onset, less their running mean; lines of hum,
    which correlate by their phases alone, are clipped to the usual amplitude. The largest within
    three means of each other's clock; 0 where fewer than 400 means are common, or what is left is
    no noise.
    """
    step = _TO_A_MEAN * max(ramp_hold.step, other.step)
    start = max(record.ramp_time for record in (ramp_hold, other)) + _SMOOTH * step
    stop = min(record.hold_end - record.onset for record in (ramp_hold, other))
    if (stop - start) / step < _FEWEST:
        return 0.0
    edges = np.arange(start, stop, step)
    residuals = [_scatter(record, edges) for record in (ramp_hold, other)]
    if any(
        part.std() > _COURSE * record.force_noise
        for part, record in zip(residuals, (ramp_hold, other), strict=True)
    ):
        return 0.0
    first, second = (_clipped_spectrum(part) for part in residuals)
    products = np.array([first * second.conj(), np.abs(first) ** 2, np.abs(second) ** 2])
    cross, pair, others = np.fft.irfft(products)
    power = float(np.sqrt(pair[0] * others[0]))
    near = np.concatenate((cross[: _LAGS + 1], cross[-_LAGS:]))
    return float(near.max()) / power if power > 0 else 0.0


def _scatter(record: RampHold, edges: FloatArray) -> FloatArray:
    """Means of the force between edges, s after the onset, less their running mean."""
    sums = np.concatenate(([0.0], np.cumsum(record.force)))
    at = np.searchsorted(record.time - record.onset, edges)
    means = np.diff(sums[at]) / np.maximum(np.diff(at), 1)
    course = np.convolve(means, np.full(_SMOOTH, 1 / _SMOOTH), mode="same")
    inner = slice(_SMOOTH, -_SMOOTH)
    return np.asarray(means[inner] - course[inner])


def _clipped_spectrum(values: FloatArray) -> ComplexArray:
    # tapered, so that a line of hum stays within a few lines
    spectrum = np.fft.rfft(values * np.hanning(len(values)))
    size = np.abs(spectrum)
    most = _CLIPPED * median(size)
    return np.asarray(spectrum * np.minimum(1.0, most / np.maximum(size, 1e-300)))


def end_stiffnesses(records: Sequence[RampHold]) -> tuple[EndStiffness, ...]:
    r"""Return the stiffness of each test where the shortest hold ends.

    .. math:: k = \frac{F - F_0 - \dot F t}{x_h}

    over the last twentieth of that time, with what offset, drift, depth and noise leave open
    (:func:`~dashpot.fitting.nuisance_priors.priors`).
    """
    at = min(record.hold_time for record in records)
    return tuple(_end_stiffness(record, at) for record in records)


def _end_stiffness(record: RampHold, at: float) -> EndStiffness:
    since = record.time - record.ramp_end
    last = (since >= 0.95 * at) & (since <= at)
    last[int(np.searchsorted(since, at)) - 1] = True
    cell_priors = priors(record)
    later = record.ramp_end + 0.975 * at - record.time[0] - cell_priors.at
    force = (
        float(record.force[last].mean()) - cell_priors.offset.mean - cell_priors.drift.mean * later
    )
    doubt = (
        cell_priors.offset.sd,
        cell_priors.drift.sd * later,
        record.force_noise / np.sqrt(last.sum()),
    )
    depth = float(np.hypot(record.depth_doubt, record.contact_error / record.depth))
    value = force / record.depth
    sd = float(np.hypot(np.linalg.norm(doubt) / record.depth, value * depth))
    return EndStiffness(value, sd, record.depth, record.specimen.temperature)
