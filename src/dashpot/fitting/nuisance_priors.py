r"""Priors of the nuisance terms: load cell and clocks.

The force that the solid gives comes with an offset, a drift and a delay,

.. math:: F(t) = F_\mathrm{solid}(t) + F_0 + \dot F\,t - \delta\,\dot F_\mathrm{solid}(t)

An offset or a drift that is free takes what a wrong model leaves, and k_inf with it; each is
bound by what the record, or the data sheet, says of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, block_means, cache_on_record
from dashpot.datamodel.machine import USUAL, Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.numerics.design_matrices.block import DataBlock, prior_block
from dashpot.numerics.inference.correlated_noise import Noise, noise_of
from dashpot.signals.noise import scatter

# fewer samples have no scatter, and none a slope, to speak of
_FEWEST = 5
# a force that rises at this part of its mean rate on the ramp is no drift
_LOADED = 0.05
# part of the ramp for which a plate may move before its encoder shows it
_UNSEEN = 0.02
# nothing of a record is known better than this part of its largest value: the rest is rounding
ROUNDING = 1e-9
# arms whose sum follows any hold, and the means of one that they follow
_ARMS, _MEANS = 12, 1024
# a dozen arms miss others by this part of the force at most; by chance the scatter of n readings is
# off by no more than this over their root
_MISSED, _BY_CHANCE = 2e-4, 4.0
# standard deviation of a prior, in those of a row, that is as good as zero
_TIGHTEST = 1e-5
# an equality is a prior of this relative width
_EXACT = 1e-6
# a force that is later than this does not change in proportion, s
LINEAR_DELAY = 2e-3
# a force off by this part of itself at the end of the hold takes the stiffness off by as much
MATERIAL = 0.01


class Prior(NamedTuple):
    """Prior of a quantity in SI units: mean and standard deviation, 0 if exact."""

    mean: float
    sd: float = 0.0

    def standardise(self, value: float, slope: FloatArray) -> tuple[float, FloatArray]:
        """Return how far `value` is from it, in standard deviations; an equality has a narrow one.

        With the derivative, `slope` being that of `value`.
        """
        sd = max(self.sd, _EXACT * abs(self.mean))
        return (value - self.mean) / sd, slope / sd

    def compute_remainder(self, held: Prior) -> Prior:
        """Return what it leaves open that a fit which holds the other does not, about 0."""
        more = self.sd**2 + (self.mean - held.mean) ** 2 - held.sd**2
        return Prior(0.0, float(np.sqrt(max(more, 0.0))))


@dataclass(frozen=True)
class NuisanceTerms:
    """Priors of the linear terms that a rig adds to a record.

    Attributes
    ----------
    known : mapping of str to Prior
        Of the coefficient of a column, by its kind: ``"offset"``, ``"drift"``, ``"delay"``...
    since : float
        From the moment at which the offset is known to that from which the drift's column counts,
        s.
    least : float
        Nothing is known better, in the unit of the record.
    """

    priors: Mapping[str, Prior]
    drift_start: float = 0.0
    least_error: float = 0.0

    def add_terms(self, **more: Prior) -> NuisanceTerms:
        """Return the terms and further ones."""
        return replace(self, priors={**self.priors, **more})

    def build_rows(self, block: DataBlock, spread: float) -> DataBlock:
        """Return rows beside those of a block, of which one independent one has this `spread`."""
        names = tuple(name for name in block.fixed_names if get_column_kind(name) in self.priors)
        kinds = [get_column_kind(name) for name in names]
        rows = np.eye(len(names))
        if "offset" in kinds and "drift" in kinds:
            rows[kinds.index("offset"), kinds.index("drift")] = -self.drift_start
        mean, sd = np.array([self.priors[kind] for kind in kinds]).reshape(-1, 2).T
        # a prior tighter than this only spoils the conditioning
        tightest = max(self.least_error, _TIGHTEST * spread)
        unit = max(spread, self.least_error)
        return prior_block(block, names, rows, mean, np.maximum(sd, tightest), unit=unit)

    def build_prior_columns(self, fixed: FloatArray, names: Sequence[str]) -> tuple[FloatArray, FloatArray]:
        """The known ones of these columns times their standard deviation, and what they expect."""
        kinds = [get_column_kind(name) for name in names]
        columns, mean = [], np.zeros(len(fixed))
        for i, kind in enumerate(kinds):
            if kind in self.priors:
                column, prior = fixed[:, i], self.priors[kind]
                if kind == "drift" and self.drift_start:
                    column = column + self.drift_start * fixed[:, kinds.index("offset")]
                columns.append(prior.sd * column)
                mean = mean + prior.mean * column
        return np.reshape(columns, (-1, len(fixed))).T, mean


def get_column_kind(name: str) -> str:
    """Return what a column is: ``"offset"`` of ``"offset@0"``."""
    return name.partition("@")[0]


WARMING = Prior(0.0, USUAL["warming in a chamber"].size)
"""Of the seal over its record, K, where several temperatures are tested."""
# how well a recorded rise of temperature is that of the seal, K
_RECORDED = 0.1


class LoadCellPriors(NamedTuple):
    """Priors of the nuisance terms of one record.

    Attributes
    ----------
    offset : Prior
        Of the load cell at the time `offset_time`, N.
    at : float
        Where the offset is known, s after the first sample.
    drift : Prior
        N/s.
    delay : Prior
        Of the force behind the displacement, s.
    first : int
        The first sample that the fit may use: those before contact are spent on the priors.
    slope : Prior
        As the baseline alone shows the drift, N/s; of an infinite error where there is none.
    conflict : float
        Above 1 baseline and load cell contradict each other.
    doubt : Prior
        Of the drift, N/s, for whatever is claimed as a limit. A fit whose own drift were as free
        would trade slow arms for it.
    """

    offset: Prior
    offset_time: float
    drift: Prior
    delay: Prior
    first_sample: int
    baseline_drift: Prior
    conflict: float
    limit_drift: Prior


@cache_on_record
def build_load_cell_priors(record: RampHold) -> LoadCellPriors:
    r"""Return what the record and its machine say of offset, drift and delay.

    The offset is the mean of the samples before contact, with standard error
    :math:`s\sqrt{\kappa/n}`; of a record that begins on the ramp it is the first reading, with
    the force that the first compression may have given. The drift is what the slope of those
    samples and the cell say together (:meth:`~dashpot.datamodel.machine.Machine.combine_drift`).
    The delay is 0 with the larger of one sample, `Machine.sync` and 1/(2 pi f) of a named filter.
    """
    time, force = record.time - record.time[0], record.force
    first = _find_first_motion(record)
    rest = slice(0, first) if record.loading_start is None else record.baseline_samples
    duration = record.hold_end - record.onset
    final = abs(float(force[select_hold_end(record)].mean()))
    noise = record.force_noise or scatter(time[record.hold], force[record.hold])
    if rest.stop - rest.start >= _FEWEST and not _is_loaded_early(record, rest):
        offset, at, slope = estimate_channel_zero(time[rest], force[rest], noise)
    else:
        offset, at = _estimate_first_reading(record, noise), 0.0
        if record.loading_start is None:
            first = max(first, 1) if record.displacement[0] <= 0 else 0
        slope = Prior(0.0, np.inf)
    machine, values = record.machine, (final, duration)
    if machine.calibration:
        # a contact that is off is a force that stays; beside a sharp zero it would bend the law
        offset = Prior(
            offset.mean, math.hypot(offset.sd, final * record.contact_error / record.depth)
        )
    return LoadCellPriors(
        offset,
        at,
        Prior(*machine.combine_drift(slope, *values)),
        build_delay_prior(record),
        first,
        slope,
        machine.drift_conflict(slope, *values, record.force_noise),
        Prior(*machine.combine_drift(slope, *values, record.force_noise)),
    )


def build_nuisance_terms(record: RampHold, *, claimed: bool = False) -> NuisanceTerms:
    """Return what is known of offset, drift and delay, their columns counting from its start.

    Of what is `claimed` as a limit the drift is as doubtful as it may be.
    """
    cell_priors = build_load_cell_priors(record)
    least = ROUNDING * float(np.abs(record.force).max())
    drift = cell_priors.limit_drift if claimed else cell_priors.drift
    all_priors = {"offset": cell_priors.offset, "drift": drift, "delay": cell_priors.delay}
    return NuisanceTerms(all_priors, -cell_priors.offset_time, least)


@cache_on_record
def estimate_hold_noise(record: RampHold) -> float:
    """Return the standard deviation of one independent residual as the hold shows it unfitted, N.

    It is what a plateau, a drift and a dozen arms leave of means over a thousandth of the hold:
    noise as slow as that is what a prior is weighed against, where the scatter of neighbours may
    be a twentieth of it.
    """
    since, force = record.time[record.hold] - record.ramp_end, record.force[record.hold]
    few = max(len(force) // _MEANS, 1)
    time, means = block_means(since, few), block_means(force, few)
    if len(means) < 4 * _ARMS:
        return record.force_noise
    noise = _compute_hold_noise(time, means)
    # one independent residual is the least that noise leaves of a record; beyond it is misfit
    return float(min(np.sqrt(few * noise.power), record.force_noise * np.sqrt(len(force))))


def _compute_hold_noise(since: FloatArray, values: FloatArray) -> Noise:
    """Return what a plateau, a drift and a dozen arms leave of a hold, as noise."""
    end, rows = float(since[-1]), len(since)
    arms = np.exp(-since[:, None] / np.geomspace(end / (2 * rows), 3 * end, _ARMS))
    basis = np.linalg.qr(np.column_stack((np.ones(rows), since, arms)))[0]
    return noise_of(values - basis @ (basis.T @ values), basis)


class ChannelZero(NamedTuple):
    """Zero and drift of a channel by the samples before a test, and the time of that zero."""

    offset: Prior
    offset_time: float
    drift: Prior


def estimate_channel_zero(time: FloatArray, values: FloatArray, noise: float) -> ChannelZero:
    r"""Return the mean and the slope of a channel at rest, for correlated noise.

    `noise` is the least that its scatter can be.
    """
    residual = values - values.mean()
    # a drift is no noise
    line = _fit_slope(time, residual, 1.0).mean
    noises = noise_of(residual - line * (time - time.mean()))
    error = float(np.sqrt(noises.autocovariance[0] * noises.kappa / len(values)))
    offset = Prior(float(values.mean()), max(error, noise / float(np.sqrt(len(values)))))
    return ChannelZero(offset, float(time.mean()), _fit_slope(time, residual, noises.kappa))


def _find_first_motion(record: RampHold) -> int:
    """The sample from which the plate may move: a fiftieth of the ramp before it is seen to."""
    change = int(np.argmax(record.displacement > 0))
    earlier = record.loading_start is not None
    seen = record.onset if earlier else min(float(record.time[change]), record.onset)
    return int(np.searchsorted(record.time, seen - _UNSEEN * record.ramp_time))


class SignificantDrift(NamedTuple):
    """Drift of a load cell that changes the force at the end of the hold by `MATERIAL`.

    Attributes
    ----------
    offset : float
        N.
    drift : float
        Over the record, N/s.
    """

    offset: float
    drift: float


def compute_significant_drift(record: RampHold) -> SignificantDrift:
    """Return which departures from what is known of the load cell matter to the stiffness."""
    final = MATERIAL * abs(float(record.force[select_hold_end(record)].mean()))
    return SignificantDrift(final, final / (record.hold_end - record.onset))


def select_hold_end(record: RampHold) -> slice:
    """Return the last twentieth of the samples of the hold, one at least."""
    end = record.hold.stop
    return slice(end - max(1, (end - record.hold.start) // 20), end)


class TwoChannels(Protocol):
    """Record of two channels on one nominal clock."""

    @property
    def machine(self) -> Machine:
        """What is known of the machine that made it."""

    @property
    def step(self) -> float:
        """Between two samples, s."""


def build_delay_prior(record: TwoChannels) -> Prior:
    """Return the prior of the delay of the force behind the displacement, s."""
    return Prior(0.0, record.machine.delay_sd(record.step))


def compute_delay_errors(numbers: Callable[[float], FloatArray], delay: Prior) -> FloatArray:
    """Return the standard errors of numbers by a delay that their record does not determine.

    `numbers` gives them for a force that comes so much later than it was recorded, s. The larger
    change of either sign counts: a cosine has no first order.
    """
    if delay.sd == 0:
        return np.zeros(len(numbers(0.0)))
    values = numbers(delay.mean)
    ways = [numbers(delay.mean + way * delay.sd) - values for way in (-1, 1)]
    return np.asarray(np.abs(ways).max(axis=0))


def _is_loaded_early(record: RampHold, rest: slice) -> bool:
    """True if the force before the plate is seen to move rises as on the ramp: it moves already."""
    force = record.force[rest] - record.force[rest].mean()
    prior = _fit_slope(record.time[rest], force, 1.0)
    ramp = float(np.abs(record.force).max()) / record.ramp_time
    return prior.mean > max(_LOADED * ramp, 4 * prior.sd)


def _fit_slope(time: FloatArray, residual: FloatArray, kappa: float) -> Prior:
    t = time - time.mean()
    power = float(t @ t)
    slope = float(t @ residual) / power
    ratio = float(np.sum((residual - slope * t) ** 2)) / max(len(t) - 2, 1)
    return Prior(slope, float(np.sqrt(ratio * kappa / power)))


def _estimate_first_reading(record: RampHold, noise: float) -> Prior:
    """Return the force at the first sample, and what the compression there may have given."""
    x, force = record.displacement, record.force
    noise = _compute_reading_error(record, noise)
    if x[0] <= 0:
        return Prior(float(force[0]), noise)
    peak = int(np.argmax(x >= 0.1 * record.depth)) or len(x) - 1
    slope = abs(float(force[peak] - force[0])) / max(float(x[peak] - x[0]), 1e-300)
    return Prior(0.0, noise + slope * float(x[0]))


def _compute_reading_error(record: RampHold, noise: float) -> float:
    """By how much one reading of the force may be off, N: its scatter, or slow noise if more.

    Neighbours share what is slow and do not show it: behind a filter of 10 Hz, at 1 kHz, they
    differ by a thousandth of it. Readings far apart show it.
    """
    since, force = record.time[record.hold] - record.ramp_end, record.force[record.hold]
    difference = max(len(force) // _MEANS, 1)
    since, force = since[::difference], force[::difference]
    if len(force) < 4 * _ARMS:
        return noise
    slow = float(np.sqrt(_compute_hold_noise(since, force).autocovariance[0]))
    chance = (1 + _BY_CHANCE / float(np.sqrt(len(force)))) * noise
    return slow if slow > max(chance, _MISSED * float(np.abs(force).max())) else noise


def build_recorded_warming_prior(specimen: Specimen) -> Prior:
    """Return by how much the seal may have warmed over its record, K: as recorded, if it was."""
    return WARMING if specimen.warmed is None else Prior(specimen.warmed, _RECORDED)


def build_warming_prior(specimen: Specimen) -> Prior:
    """By how much a seal of one temperature may warm unseen over its record, K.

    A rise that was recorded says how much, but not what it does to the seal.
    """
    if specimen.warmed is None:
        return Prior(0.0, USUAL["warming"].size)
    return Prior(0.0, float(np.hypot(specimen.warmed, _RECORDED)))
