r"""Prepared tests as few rows: every sample near a corner, means of blocks away from it.

A mean of c neighbours of a smooth curve is its value at their mean time, to a relative
:math:`w^2/(24\,\tau^2)` for a block of width w, and it is worth c samples. Blocks widen in
proportion to the time since the corner, as what relaxes after it slows down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray, distinct, median
from dashpot.base.errors import FitError
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.nuisance_priors import LoadCellPriors, priors
from dashpot.preprocessing.denoising import denoise_displacement

# blocks per e-fold of the time since a corner
_IN_RAMP, _IN_HOLD = 64, 26
# the fewest samples that can show a ramp and a hold
_FEWEST_ON_RAMP, _FEWEST = 3, 8
# motion after the ramp, as a part of the depth, that a law of the ramp can bear
_MOST_BY_RAMP_LAW = 0.15
# a force that peaks this part of the hold late, by so many times its scatter and this part of
# itself, had not seen the end of the ramp
_SOON, _CLEAR, _RISEN = 0.1, 6.0, 0.005


@dataclass(frozen=True, eq=False)
class DownsampledRows:
    """Several records as rows on top of each other.

    Attributes
    ----------
    time : array, shape (M,)
        Mean time of the samples of a row since the first sample of its record, s.
    step : array, shape (M,)
        Time since the row before, s; at the first row of a record the sampling interval.
    displacement, force : array, shape (M,)
        Means, m and N.
    count : array, shape (M,)
        Samples in a row.
    record : array of int, shape (M,)
        Which record a row is of.
    ramp : array of bool, shape (M,)
        Rows before the end of the ramp.
    ends : tuple of float
        End of each record's ramp on the clock of `time`, s.
    depths : tuple of float
        Compression held in each record, m.
    noise : tuple of float
        Scatter of each record's force from sample to sample, N.
    known : tuple of Priors
        Of each record's nuisance terms.
    """

    time: FloatArray
    step: FloatArray
    displacement: FloatArray
    force: FloatArray
    count: FloatArray
    record: IndexArray
    ramp: BoolArray
    ends: tuple[float, ...]
    depths: tuple[float, ...]
    noise: tuple[float, ...]
    known: tuple[LoadCellPriors, ...]

    @property
    def depth(self) -> float:
        """The deepest compression held, m."""
        return max(self.depths)

    @cached_property
    def first(self) -> IndexArray:
        """The first row of each record."""
        return np.flatnonzero(np.diff(self.record, prepend=-1))

    def peak(self, record: int) -> float:
        """The largest force of one record, N."""
        return float(np.abs(self.force[self.record == record]).max())

    def held(self, record: int) -> BoolArray:
        """The rows of one record's hold."""
        return np.asarray((self.record == record) & ~self.ramp)


def downsample(tests: Sequence[RampHold]) -> DownsampledRows:
    """Return the rows of prepared tests, from contact to the end of the hold.

    Raises
    ------
    FitError
        If a test has no ramp or no hold to speak of.
    """
    parts, cell_priors = [], []
    for number, test in enumerate(tests):
        cell_priors.append(priors(test))
        parts.append(_rows(test, number, cell_priors[-1].first))
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    time, step, x, force, count, record, ramp = columns
    return DownsampledRows(
        time,
        step,
        x,
        force,
        count,
        record.astype(np.intp),
        ramp > 0,
        tuple(test.ramp_end - float(test.time[0]) for test in tests),
        tuple(test.depth for test in tests),
        tuple(test.force_noise for test in tests),
        tuple(cell_priors),
    )


def ramp_obstacle(test: RampHold) -> str | None:
    """Return why a record shows no elastic law by its ramp, in a sentence; None if it may."""
    corner, end = relaxes_from(test), test.hold.stop
    climbing = corner - int(np.searchsorted(test.time, test.onset))
    if climbing < _FEWEST_ON_RAMP or end - corner < _FEWEST:
        return (
            f"the record has {climbing} samples on the ramp and {end - corner} in the hold; an "
            f"elastic law from the ramp needs at least {_FEWEST_ON_RAMP} and {_FEWEST}: sample "
            "faster"
        )
    ratio = float(np.ptp(test.displacement[corner:end])) / test.depth
    if ratio > _MOST_BY_RAMP_LAW:
        return (
            f"the displacement moves by {100 * ratio:.0f} % of the depth after the first ramp; an "
            "elastic law from the ramp needs one ramp and its hold: cut the record to them"
        )
    return None


def _rows(test: RampHold, number: int, first: int) -> tuple[npt.NDArray[Any], ...]:
    obstacle = ramp_obstacle(test)
    if obstacle is not None:
        raise FitError(obstacle)
    x = denoise_displacement(test)[0]
    time, force = test.time[: len(x)] - test.time[0], test.force[: len(x)]
    corner = relaxes_from(test)
    on = median(np.diff(time[first:corner]))
    after = median(np.diff(time[corner : corner + _FEWEST]))
    cuts = distinct(np.concatenate((
        _ramp_cuts(time[first:corner], on) + first,
        _cuts(time[corner:], after, _IN_HOLD) + corner,
    )))  # fmt: skip
    count = np.diff(np.append(cuts, len(x))).astype(float)
    mean_time, mean_x, mean_force = (
        np.add.reduceat(values, cuts) / count for values in (time, x, force)
    )
    step = np.diff(mean_time, prepend=mean_time[0] - on)
    return mean_time, step, mean_x, mean_force, count, np.full(len(cuts), number), cuts < corner


def relaxes_from(test: RampHold) -> int:
    """The sample from which the force falls: the first of the hold, or the peak behind it.

    A force that rises on after the plate is said to stand belongs to the ramp.
    """
    start = test.hold.start
    window = min(test.ramp_time, _SOON * test.hold_time)
    stop = int(np.searchsorted(test.time, test.ramp_end + window))
    soon = test.force[start : max(stop, start + 1)]
    peak = int(np.argmax(soon))
    rise = float(soon[peak] - soon[0])
    late = rise > _CLEAR * test.force_noise + _RISEN * float(soon[peak])
    return int(start) + peak if late else int(start)


def _ramp_cuts(time: FloatArray, interval: float) -> IndexArray:
    """Where blocks start that widen from both corners of a ramp."""
    half = int(np.searchsorted(time, 0.5 * (time[0] + time[-1])))
    rising = _cuts(time[:half], interval, _IN_RAMP)
    falling = len(time) - _cuts(-time[half:][::-1], interval, _IN_RAMP)[1:]
    return np.concatenate((rising, [half], falling))


def _cuts(time: FloatArray, interval: float, blocks: int) -> IndexArray:
    """Where blocks start that widen with the time since the first sample."""
    span = float(time[-1] - time[0]) if len(time) else 0.0
    last = np.ceil(blocks * np.log1p(span / (blocks * interval)))
    edges = blocks * interval * np.expm1(np.arange(last + 1) / blocks)
    cuts = distinct(np.searchsorted(time - time[0] if len(time) else time, edges))
    return np.asarray(cuts[cuts < len(time)])
