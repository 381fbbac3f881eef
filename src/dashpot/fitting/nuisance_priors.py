r"""Priors of the nuisance terms: load cell and clocks.

The force that the solid gives comes with an offset, a drift and a delay,

.. math:: F(t) = F_\mathrm{solid}(t) + F_0 + \dot F\,t - \delta\,\dot F_\mathrm{solid}(t)

A free offset or drift absorbs the misfit of a wrong model and biases k_inf. Each is therefore
limited by a prior from the record or the data sheet.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, block_means, cache_on_record
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES, Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.numerics.design_matrices.block import DataBlock, prior_block
from dashpot.numerics.inference.correlated_noise import Noise, estimate_noise
from dashpot.signals.noise import scatter

# Smallest number of samples before contact for noise and drift.
_MIN_REST_SAMPLES = 5
# part of the mean rate on the ramp from which a rising force is no drift
_MIN_RATE_RATIO = 0.05
# rise in the later half of a baseline over that in the first from which the ramp has begun in it
_MIN_RISE_RATIO = 1.5
# part of the ramp for which a plate may move before its encoder shows it
_UNSEEN_RAMP_PART = 0.02
# rounding of a record: part of its largest value below which nothing is known
ROUNDING = 1e-9
# number of arms whose sum fits any hold, and number of block means that they are fitted to
_HOLD_ARMS, _HOLD_MEANS = 12, 1024
# largest misfit of those arms, part of the force; largest relative error of the scatter of n
# readings by chance, times the square root of n
_MAX_ARM_MISFIT, _CHANCE_FACTOR = 2e-4, 4.0
# smallest standard deviation of a prior, over that of a row
_MIN_SD_RATIO = 1e-5
# relative standard deviation of a prior that is an equality
_EQUALITY_SD = 1e-6
# longest delay of the force that its first-order term represents, s
LINEAR_DELAY = 2e-3
# error of the force at the end of the hold that matters to the stiffness, relative
MATERIAL_FORCE_ERROR = 0.01


class Prior(NamedTuple):
    """Prior of a quantity in SI units: mean and standard deviation, 0 if exact."""

    mean: float
    sd: float = 0.0

    def standardise(self, value: float, slope: FloatArray) -> tuple[float, FloatArray]:
        """Return the departure of a value from the mean in standard deviations, and its derivative.

        `slope` is the derivative of `value`.
        """
        sd = max(self.sd, _EQUALITY_SD * abs(self.mean))
        return (value - self.mean) / sd, slope / sd

    def compute_remainder(self, fitted_prior: Prior) -> Prior:
        """Return the prior about 0 of what this one allows beyond the prior that a fit used."""
        variance = self.sd**2 + (self.mean - fitted_prior.mean) ** 2 - fitted_prior.sd**2
        return Prior(0.0, float(np.sqrt(max(variance, 0.0))))


@dataclass(frozen=True)
class NuisanceTerms:
    """Priors of the linear terms that a rig adds to a record.

    Attributes
    ----------
    priors : mapping of str to Prior
        Priors of the coefficients of the columns, by kind: ``"offset"``, ``"drift"``,
        ``"delay"``...
    drift_start : float
        Zero of the drift's column, s after the time at which the offset is known.
    least_error : float
        Smallest standard deviation of a prior, in the unit of the record.
    """

    priors: Mapping[str, Prior]
    drift_start: float = 0.0
    least_error: float = 0.0

    def add_terms(self, **additional_priors: Prior) -> NuisanceTerms:
        """Return the terms and further ones."""
        return replace(self, priors={**self.priors, **additional_priors})

    def build_rows(self, block: DataBlock, noise_sd: float) -> DataBlock:
        """Return the rows of the priors for a block whose independent rows have this `noise_sd`."""
        names = tuple(name for name in block.fixed_names if get_column_kind(name) in self.priors)
        kinds = [get_column_kind(name) for name in names]
        rows = np.eye(len(names))
        if "offset" in kinds and "drift" in kinds:
            rows[kinds.index("offset"), kinds.index("drift")] = -self.drift_start
        mean, sd = np.array([self.priors[kind] for kind in kinds]).reshape(-1, 2).T
        # tighter priors only worsen the conditioning
        least_sd = max(self.least_error, _MIN_SD_RATIO * noise_sd)
        row_sd = max(noise_sd, self.least_error)
        return prior_block(block, names, rows, mean, np.maximum(sd, least_sd), unit=row_sd)

    def build_prior_columns(
        self, fixed: FloatArray, names: Sequence[str]
    ) -> tuple[FloatArray, FloatArray]:
        """Return the columns that have priors, times their SD, and the force of their means."""
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
    """Return the kind in the name of a column: ``"offset"`` of ``"offset@0"``."""
    return name.partition("@")[0]


WARMING_PRIOR = Prior(0.0, DEFAULT_UNCERTAINTIES["warming in a chamber"].size)
"""Prior of the warming of the seal over its record, K, where several temperatures are tested."""
# standard deviation of the warming of the seal about a recorded rise of temperature, K
_WARMING_SD = 0.1


class LoadCellPriors(NamedTuple):
    """Priors of the nuisance terms of one record.

    Attributes
    ----------
    offset : Prior
        Offset of the load cell at the time `offset_time`, N.
    offset_time : float
        At which the offset is known, s after the first sample.
    drift : Prior
        N/s.
    delay : Prior
        Delay of the force behind the displacement, s.
    first_sample : int
        The first that the fit may use: those before contact enter the priors.
    baseline_drift : Prior
        Prior of the drift by the baseline alone, N/s; its SD is infinite without one.
    conflict : float
        Departure of baseline and load cell from each other; above 1 they contradict.
    limit_drift : Prior
        Prior of the drift, N/s, in limits. As free a drift in the fit itself would replace slow
        arms.
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
    r"""Return the priors of offset, drift and delay from a record and its machine.

    The offset is the mean of the samples before contact, with standard error
    :math:`s\sqrt{\kappa/n}`; of a record that begins on the ramp it is the first reading, with
    the force that the first compression may have given. The drift is combined from the slope of
    those
    samples and the data of the cell (:meth:`~dashpot.datamodel.machine.Machine.combine_drift`).
    The delay is 0 with the larger of one sample, `Machine.sync` and 1/(2 pi f) of a named filter.
    """
    time, force = record.time - record.time[0], record.force
    first_sample = _find_first_motion(record)
    rest_samples = (
        slice(0, first_sample) if record.loading_start is None else record.baseline_samples
    )
    duration = record.hold_end - record.onset
    end_force = abs(float(force[select_hold_end(record)].mean()))
    noise = record.force_noise or scatter(time[record.hold], force[record.hold])
    if rest_samples.stop - rest_samples.start >= _MIN_REST_SAMPLES and not _is_loaded_early(
        record, rest_samples
    ):
        offset, offset_time, baseline_drift = estimate_channel_zero(
            time[rest_samples], force[rest_samples], noise
        )
    else:
        offset, offset_time = _estimate_first_reading(record, noise), 0.0
        if record.loading_start is None:
            first_sample = max(first_sample, 1) if record.displacement[0] <= 0 else 0
        baseline_drift = Prior(0.0, np.inf)
    machine, end_of_hold = record.machine, (end_force, duration)
    conflict = machine.drift_conflict(baseline_drift, *end_of_hold, record.force_noise)
    if conflict > 1:
        # what moved is no drift of the cell, and its zero is not known any better
        baseline_move = baseline_drift.mean * float(np.ptp(time[rest_samples]))
        offset = Prior(offset.mean, math.hypot(offset.sd, baseline_move))
    if machine.calibration:
        # an error of contact is a constant force; a tighter offset would distort the elastic law
        offset = Prior(
            offset.mean, math.hypot(offset.sd, end_force * record.contact_error / record.depth)
        )
    return LoadCellPriors(
        offset,
        offset_time,
        Prior(*machine.combine_drift(baseline_drift, *end_of_hold)),
        build_delay_prior(record),
        first_sample,
        baseline_drift,
        conflict,
        Prior(*machine.combine_drift(baseline_drift, *end_of_hold, record.force_noise)),
    )


def build_nuisance_terms(record: RampHold, *, for_limits: bool = False) -> NuisanceTerms:
    """Return the priors of offset, drift and delay for columns that begin with the record.

    With `for_limits` the drift has the wider prior of limits.
    """
    cell_priors = build_load_cell_priors(record)
    min_error = ROUNDING * float(np.abs(record.force).max())
    drift = cell_priors.limit_drift if for_limits else cell_priors.drift
    all_priors = {"offset": cell_priors.offset, "drift": drift, "delay": cell_priors.delay}
    return NuisanceTerms(all_priors, -cell_priors.offset_time, min_error)


@cache_on_record
def estimate_hold_noise(record: RampHold) -> float:
    """Return the standard deviation of one independent residual, estimated before the fit, N.

    It is that of means over a thousandth of the hold about a plateau, a drift and a dozen arms:
    priors are weighted against slow noise, of which the scatter of neighbours may be a
    twentieth.
    """
    time_since_ramp, force = record.time[record.hold] - record.ramp_end, record.force[record.hold]
    group_size = max(len(force) // _HOLD_MEANS, 1)
    time, means = block_means(time_since_ramp, group_size), block_means(force, group_size)
    if len(means) < 4 * _HOLD_ARMS:
        return record.force_noise
    noise = _compute_hold_noise(time, means)
    # noise cannot exceed the scatter of fully correlated samples; what does is misfit
    return float(min(np.sqrt(group_size * noise.power), record.force_noise * np.sqrt(len(force))))


def _compute_hold_noise(time: FloatArray, values: FloatArray) -> Noise:
    """Return the noise of a hold about a plateau, a drift and a dozen arms fitted to it."""
    duration, sample_count = float(time[-1]), len(time)
    arms = np.exp(
        -time[:, None] / np.geomspace(duration / (2 * sample_count), 3 * duration, _HOLD_ARMS)
    )
    basis = np.linalg.qr(np.column_stack((np.ones(sample_count), time, arms)))[0]
    return estimate_noise(values - basis @ (basis.T @ values), basis)


class ChannelZero(NamedTuple):
    """Zero and drift of a channel by the samples before a test, and the time of that zero."""

    offset: Prior
    offset_time: float
    drift: Prior


def estimate_channel_zero(time: FloatArray, values: FloatArray, noise: float) -> ChannelZero:
    r"""Return the mean and the slope of a channel at rest, for correlated noise.

    `noise` is a lower bound of its scatter.
    """
    residual = values - values.mean()
    # a drift is no noise
    slope = _fit_slope(time, residual, 1.0).mean
    correlated_noise = estimate_noise(residual - slope * (time - time.mean()))
    error = float(
        np.sqrt(correlated_noise.autocovariance[0] * correlated_noise.kappa / len(values))
    )
    offset = Prior(float(values.mean()), max(error, noise / float(np.sqrt(len(values)))))
    return ChannelZero(
        offset, float(time.mean()), _fit_slope(time, residual, correlated_noise.kappa)
    )


def _find_first_motion(record: RampHold) -> int:
    """Return the first sample at which the plate may move: a fiftieth of the ramp before seen."""
    first_moved = int(np.argmax(record.displacement > 0))
    is_known = record.loading_start is not None
    visible_onset = record.onset if is_known else min(float(record.time[first_moved]), record.onset)
    return int(np.searchsorted(record.time, visible_onset - _UNSEEN_RAMP_PART * record.ramp_time))


class SignificantDrift(NamedTuple):
    """Drift of a load cell that changes the force at the end of the hold by `MATERIAL_FORCE_ERROR`.

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
    """Return the offset and the drift of the load cell that matter to the stiffness."""
    significant_force = MATERIAL_FORCE_ERROR * abs(
        float(record.force[select_hold_end(record)].mean())
    )
    return SignificantDrift(significant_force, significant_force / (record.hold_end - record.onset))


def select_hold_end(record: RampHold) -> slice:
    """Return the slice of the last twentieth of the hold, at least one sample."""
    end = record.hold.stop
    return slice(end - max(1, (end - record.hold.start) // 20), end)


class TwoChannels(Protocol):
    """Record of two channels on one nominal clock."""

    @property
    def machine(self) -> Machine:
        """Machine of the record."""

    @property
    def step(self) -> float:
        """Time step, s."""


def build_delay_prior(record: TwoChannels) -> Prior:
    """Return the prior of the delay of the force behind the displacement, s."""
    return Prior(0.0, record.machine.delay_sd(record.step))


def compute_delay_errors(
    compute_numbers: Callable[[float], FloatArray], delay: Prior
) -> FloatArray:
    """Return the standard errors of numbers due to a delay that their record does not determine.

    `compute_numbers` takes the additional delay of the force, s. The larger
    change of either sign counts: a cosine has no first order.
    """
    if delay.sd == 0:
        return np.zeros(len(compute_numbers(0.0)))
    values = compute_numbers(delay.mean)
    changes = [compute_numbers(delay.mean + sign * delay.sd) - values for sign in (-1, 1)]
    return np.asarray(np.abs(changes).max(axis=0))


def _is_loaded_early(record: RampHold, rest_samples: slice) -> bool:
    """Return whether the force rises as on the ramp before the plate is seen to move.

    A seal that recovers from earlier loadings raises it, too, but ever slower.
    """
    time = record.time[rest_samples]
    force = record.force[rest_samples] - record.force[rest_samples].mean()
    slope, half = _fit_slope(time, force, 1.0), len(time) // 2
    ramp_rate = float(np.abs(record.force).max()) / record.ramp_time
    if slope.mean <= max(_MIN_RATE_RATIO * ramp_rate, 4 * slope.sd):
        return False
    return bool(np.ptp(force[half:]) > _MIN_RISE_RATIO * np.ptp(force[:half]))


def _fit_slope(time: FloatArray, residual: FloatArray, kappa: float) -> Prior:
    centred_time = time - time.mean()
    sum_of_squares = float(centred_time @ centred_time)
    slope = float(centred_time @ residual) / sum_of_squares
    variance = float(np.sum((residual - slope * centred_time) ** 2)) / max(len(centred_time) - 2, 1)
    return Prior(slope, float(np.sqrt(variance * kappa / sum_of_squares)))


def _estimate_first_reading(record: RampHold, noise: float) -> Prior:
    """Return the prior of the offset by the first sample, widened by its compression."""
    x, force = record.displacement, record.force
    noise = _compute_reading_error(record, noise)
    if x[0] <= 0:
        return Prior(float(force[0]), noise)
    pressed_sample = int(np.argmax(x >= 0.1 * record.depth)) or len(x) - 1
    stiffness = abs(float(force[pressed_sample] - force[0])) / max(
        float(x[pressed_sample] - x[0]), 1e-300
    )
    return Prior(0.0, noise + stiffness * float(x[0]))


def _compute_reading_error(record: RampHold, noise: float) -> float:
    """Return the standard error of one reading of the force, N: scatter, or slow noise if more.

    The scatter of neighbours does not contain slow noise: behind a filter of 10 Hz, at 1 kHz,
    they differ by a thousandth of it. The scatter of readings far apart does.
    """
    time_since_ramp, force = record.time[record.hold] - record.ramp_end, record.force[record.hold]
    stride = max(len(force) // _HOLD_MEANS, 1)
    time_since_ramp, force = time_since_ramp[::stride], force[::stride]
    if len(force) < 4 * _HOLD_ARMS:
        return noise
    slow_noise = float(np.sqrt(_compute_hold_noise(time_since_ramp, force).autocovariance[0]))
    noise_limit = (1 + _CHANCE_FACTOR / float(np.sqrt(len(force)))) * noise
    return (
        slow_noise
        if slow_noise > max(noise_limit, _MAX_ARM_MISFIT * float(np.abs(force).max()))
        else noise
    )


def build_recorded_warming_prior(specimen: Specimen) -> Prior:
    """Return the prior of the warming of the seal over its record, K: as recorded, if it was."""
    return WARMING_PRIOR if specimen.warmed is None else Prior(specimen.warmed, _WARMING_SD)


def build_warming_prior(specimen: Specimen) -> Prior:
    """Return the prior of the unmodelled warming of a seal tested at one temperature, K.

    A recorded rise widens it, as its effect on the seal is unknown.
    """
    if specimen.warmed is None:
        return Prior(0.0, DEFAULT_UNCERTAINTIES["warming"].size)
    return Prior(0.0, float(np.hypot(specimen.warmed, _WARMING_SD)))
