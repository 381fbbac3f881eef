"""Uncertainty of fitted parameters: covariance, rig and encoder terms, profiles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.student_t import t_quantile
from dashpot.datamodel.parameter_estimate import Profile, Residual
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.nuisance_priors import build_delay_prior, get_column_kind
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.data_compression import compact_block
from dashpot.numerics.exponential_fit import Jacobian, Solution, compute_full_jacobian
from dashpot.numerics.inference.correlated_noise import (
    JacobianColumns,
    Noise,
    ResidualSeries,
    estimate_noise,
    make_directions,
    nearly_white,
    noise_gain_differs,
    noise_gain_ratio,
)
from dashpot.numerics.inference.model_order import bic, significant
from dashpot.numerics.inference.profile_likelihood import WINDOW_FACTOR, Coordinate, ProfileTarget
from dashpot.numerics.inference.profile_likelihood import compute_profiles as walk_profiles
from dashpot.numerics.log_tau_descent import Stack
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

if TYPE_CHECKING:
    from dashpot.numerics.inference.correlated_noise import NoiseGain


# Effect of encoder resolution.
#
# While a reading is constant, so is its error :math:`e`, uniform within one step q. To first order
# it shifts the parameters by :math:`(J^T J)^{-1} J^T \delta`, with the response of the model to the
# pulse of motion that was not there,
#
# .. math:: \delta(t) = e\,[K(t - t_a) - K(t - t_b)], \qquad
#           K(t) = k_\infty + \sum_j k_j e^{-t/\tau_j} \; (t \ge 0), \qquad
#           \mathrm{Var}(e) = q^2/12
#
# from the run's first reading to the next one. Over a short run that is e k_0. All runs are
# independent, so :math:`\sum J^T\delta\,\delta^T J` is added to the middle of the sandwich: the
# error of the held depth, which scales every stiffness, and that of each step of the ramp; and the
# error of a contact behind an air gap, which shifts all motion after it.


# Share of the record; a longer run of equal readings is a hold, during which the seal relaxes.
_MIN_REST_SHARE = 1.0 / 20.0


class Encoder(NamedTuple):
    """Encoder readings of one record, their step and the error of the contact.

    Attributes
    ----------
    time : array, shape (n,)
        s.
    readings : array, shape (n,)
        m.
    step : float
        Step q of the readings, m; 0 if they show none.
    onset, contact_error : float
        First contact, s, and the standard deviation of its position, m.
    """

    time: FloatArray
    readings: FloatArray
    step: float
    onset: float = 0.0
    contact_error: float = 0.0

    @classmethod
    def from_record(cls, record: RampHold) -> Encoder:
        """Return the encoder of a prepared record, up to the end of its hold."""
        used_samples = slice(0, record.hold.stop)
        return cls(
            record.time[used_samples],
            record.travel[used_samples],
            record.encoder_step,
            record.onset,
            record.contact_error,
        )


class Kernel(NamedTuple):
    """Relaxation function of a model: k_inf, N/m, and k, N/m, and tau, s, of every arm."""

    k_inf: float
    k: FloatArray
    tau: FloatArray

    def __call__(self, time: FloatArray) -> FloatArray:
        """Return K at times >= 0."""
        return np.asarray(self.k_inf + np.exp(-time[:, None] / self.tau) @ self.k)


def encoder_rows(columns: FloatArray, encoder: Encoder, kernel: Kernel) -> FloatArray:
    """Return J' delta of every independent error of an encoder, of unit variance, shape (n, p).

    `columns` are J, or J times a matrix, with a row per sample, or from some sample on only.
    """
    first_row = len(encoder.time) - len(columns)
    contact = _compute_contact_row(columns, first_row, encoder, kernel)
    if encoder.step == 0.0:
        return contact
    return np.concatenate((contact, _compute_step_rows(columns, first_row, encoder, kernel)))


def _compute_contact_row(
    columns: FloatArray, first_row: int, encoder: Encoder, kernel: Kernel
) -> FloatArray:
    """Return the row of an error of the contact: a step of motion at contact."""
    if encoder.contact_error == 0.0:
        return np.zeros((0, columns.shape[1]))
    start = max(int(np.searchsorted(encoder.time, encoder.onset)), first_row)
    change = kernel(encoder.time[start:] - encoder.onset) @ columns[start - first_row :]
    return encoder.contact_error * change[None]


def _compute_step_rows(
    columns: FloatArray, first_row: int, encoder: Encoder, kernel: Kernel
) -> FloatArray:
    time, readings = encoder.time, encoder.readings
    starts = np.concatenate(([0], np.flatnonzero(np.diff(readings)) + 1))
    stops = np.concatenate((starts[1:], [len(readings)]))
    is_rest = stops - starts > _MIN_REST_SHARE * len(readings)
    is_rest[0] = True  # all motion is measured from the first reading
    pulses = [
        _compute_pulse_row(columns, first_row, time, kernel, (int(a), int(b)))
        for a, b in zip(starts[is_rest], stops[is_rest], strict=True)
    ]
    is_recorded = stops > first_row
    k_0 = kernel.k_inf + float(kernel.k.sum())
    short_runs = np.add.reduceat(columns, np.maximum(starts[is_recorded] - first_row, 0), axis=0)[
        ~is_rest[is_recorded]
    ]
    return (
        encoder.step / float(np.sqrt(12.0)) * np.concatenate((k_0 * short_runs, np.array(pulses)))
    )


def _compute_pulse_row(
    columns: FloatArray, first_row: int, time: FloatArray, kernel: Kernel, run: tuple[int, int]
) -> FloatArray:
    """Return J' delta for a unit error over a run of samples.

    The record measures motion from its first reading, so an error of the first run is a step
    at the run's end.
    """
    values = np.zeros(columns.shape[1])
    for sign, sample in zip((1.0, -1.0), run, strict=True):
        first_sample = max(sample, first_row)
        if 0 < sample < len(time):
            values += sign * (
                kernel(time[first_sample:] - time[sample]) @ columns[first_sample - first_row :]
            )
    return values


# Uncertainty of a solution, from residuals in order of time.


# Relative residual caused by rounding of the data.
_ROUNDING = 1e-10


@dataclass(frozen=True, eq=False)
class ParameterCovariance:
    """Covariance of parameters, with the residuals it was estimated from.

    Attributes
    ----------
    names : tuple of str
        Rows of `covariance`.
    covariance : array, shape (p, p)
    residuals : tuple of arrays
        One per record, N.
    noises : tuple of Noise
    """

    names: tuple[str, ...]
    covariance: FloatArray
    residuals: tuple[FloatArray, ...]
    noises: tuple[Noise, ...]

    @property
    def effective(self) -> float:
        """Effective number of independent residuals."""
        return sum(noise.effective for noise in self.noises)

    @property
    def dof(self) -> float:
        """Degrees of freedom: effective number of residuals less that of parameters."""
        return self.effective - len(self.names)

    @property
    def sse(self) -> float:
        """Sum of squared residuals over every sample, N^2."""
        return float(sum(residual @ residual for residual in self.residuals))

    @property
    def samples(self) -> int:
        """Number of residuals."""
        return sum(noise.samples for noise in self.noises)

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, N."""
        return float(np.sqrt(self.sse / self.samples))

    @property
    def kappa(self) -> float:
        """Samples per independent residual, over all records."""
        return self.samples / self.effective

    def statistics(self, weights: Sequence[float]) -> Residual:
        """Return statistics of the residuals; records are weighted in that of Durbin and Watson."""
        watson = [noise.durbin_watson for noise in self.noises]
        mean = float(np.average(watson, weights=weights)) if sum(weights) > 0 else 2.0
        return Residual(self.samples, self.sse, self.rms, self.kappa, mean)

    def standard_error(self, name: str) -> float:
        """Return the standard error of a parameter."""
        row = self.names.index(name)
        return float(np.sqrt(self.covariance[row, row]))


@dataclass(frozen=True, eq=False)
class SolutionEstimate(ParameterCovariance):
    """Covariance of a solution.

    Attributes
    ----------
    solution : Solution
        The rows of `covariance` are its fixed columns, stiffnesses group by group, then ln tau.
    directions : array, shape (p, r)
        D, with D D' the inverse of J'J of all samples.
    noise_gain : float
        Largest over smallest noise gain of these directions.
    """

    solution: Solution
    directions: FloatArray
    noise_gain: float

    @property
    def residual_sd(self) -> float:
        """Standard deviation of one independent residual, N: the rms times root kappa."""
        return float(np.sqrt(self.sse / self.effective))

    def add_depth_error(
        self, depth_errors: Sequence[float], stiffnesses: Mapping[str, float]
    ) -> SolutionEstimate:
        r"""Return the estimate with the error of each depth by the step of the encoder.

        A relative error :math:`\epsilon` of a depth scales every stiffness of its test, so that n
        tests that share them add :math:`\overline{\epsilon^2} k k^T / n` to the covariance;
        `stiffnesses` holds each by its row.
        """
        error = float(np.sqrt(np.mean(np.square(depth_errors)) / len(depth_errors)))
        change = np.array([error * stiffnesses.get(name, 0.0) for name in self.names])
        return replace(self, covariance=self.covariance + np.outer(change, change))


class Score(NamedTuple):
    """Score of one number of arms."""

    solution: Solution
    bic: float
    significant: bool


def estimate_covariance(
    solution: Solution,
    every_sample: Sequence[DataBlock],
    *,
    peak: float,
    priors: Sequence[DataBlock] = (),
    encoders: Sequence[Encoder] | None = None,
    error_rows: Sequence[Callable[[FloatArray], FloatArray]] = (),
    jacobian: Jacobian | None = None,
    series: Sequence[ResidualSeries] = (),
) -> SolutionEstimate:
    """Return the covariance of a solution from one block per record with a row per sample.

    Parameters
    ----------
    solution : Solution
    every_sample : sequence of DataBlock
    peak : float
        The largest force, N; it sets the residual by rounding.
    encoders : sequence of Encoder, optional
        Encoders of each record, where the recorded motion is fitted.
    priors : sequence of DataBlock
        Priors of nuisance parameters.
    error_rows : sequence of callable, optional
        Error rows of each record that has no encoder, as
        :func:`~dashpot.numerics.inference.correlated_noise.sandwich` takes errors that are not
        constant in time.
    jacobian : Jacobian, optional
        Jacobian of every sample and then of the priors, if computed already.
    series : sequence of ResidualSeries, optional
        The residual of each record, if computed already.
    """
    jacobian = jacobian or compute_full_jacobian([*every_sample, *priors], solution)
    every_residual, every_jacobian = split_by_record(jacobian, [*every_sample, *priors])
    count = len(every_sample)
    series = series or [*map(ResidualSeries, every_residual[:count])]
    information = make_directions(every_jacobian)
    noises = estimate_noises(series, information.columns[:count], peak=peak)
    error_rows = error_rows or [
        partial(encoder_rows, encoder=encoder, kernel=_build_relaxation_kernel(solution, block))
        for encoder, block in zip(encoders or (), every_sample, strict=False)
    ]
    prior_noises = [Noise(block.samples, np.array([block.variance]), 1.0, 2.0) for block in priors]
    gains = [
        *map(information.compute_record_gain, range(len(every_jacobian)), [*noises, *prior_noises])
    ]
    covariance = information.covariance(np.sum(gains, axis=0), other_columns=error_rows)
    residuals = tuple(residual_series.values for residual_series in series)
    return SolutionEstimate(
        jacobian.names, covariance, residuals, noises, solution, information.parameter_directions,
        noise_gain_ratio(information, gains[:count]),
    )  # fmt: skip


def split_by_record(
    jacobian: Jacobian, every_sample: Sequence[DataBlock]
) -> tuple[tuple[FloatArray, ...], list[FloatArray]]:
    """Return residual and Jacobian of each record."""
    row_limits = np.cumsum([block.samples for block in every_sample])[:-1]
    return tuple(np.split(jacobian.residual, row_limits)), np.split(jacobian.matrix, row_limits)


def estimate_noises(
    residuals: Sequence[FloatArray | ResidualSeries],
    jacobians: Sequence[FloatArray | JacobianColumns],
    *,
    peak: float,
) -> tuple[Noise, ...]:
    """Return the noise of each record, estimated from its residuals."""
    return tuple(
        estimate_noise(residual, jacobian, rounding=rounding_rms(peak))
        for residual, jacobian in zip(residuals, jacobians, strict=True)
    )


def rounding_rms(peak: float) -> float:
    """Return the rms residual, N, by rounding of data with this largest force."""
    return _ROUNDING * peak


def _build_relaxation_kernel(solution: Solution, block: DataBlock) -> Kernel:
    """Return the relaxation function of one record."""
    spring_names = [name for name in block.fixed_names if name.partition("@")[0] == "k_inf"]
    return Kernel(
        sum(solution.coefficient(name) for name in spring_names),
        solution.arms[solution.groups.index(block.arm_group)],
        solution.tau,
    )


def compute_residual(solution: Solution, block: DataBlock) -> FloatArray:
    """Return the residual of one record, a value per sample."""
    rows = block.evaluate(solution.log_tau, False)
    fixed = np.array([solution.coefficient(name) for name in block.fixed_names])
    arms = solution.arms[solution.groups.index(block.arm_group)]
    return np.asarray(rows.target - rows.fixed @ fixed - rows.arms @ arms)


def score_solution(
    solution: Solution,
    blocks: Sequence[DataBlock],
    every_sample: Sequence[DataBlock],
    *,
    effective: float,
    peak: float,
    priors: Sequence[DataBlock] = (),
) -> Score:
    """Return the score of one number of arms: its BIC, and whether all arms are significant.

    Parameters
    ----------
    solution : Solution
    blocks, every_sample : sequences of DataBlock
        The compressed data, and the same with a row per sample.
    effective : float
        Effective number of residuals, from the largest model tried.
    peak : float
        The largest force, N; it sets the residual by rounding.
    priors : sequence of DataBlock
        Priors of nuisance parameters.
    """
    rounding_sse = max(solution.samples * rounding_rms(peak) ** 2, Stack(blocks).rounding_floor)
    parameters = len(solution.fixed) + solution.arms.size + solution.order
    criterion = bic(
        solution.sse, effective=effective, parameters=parameters, rounding_sse=rounding_sse
    )
    if not solution.order:
        return Score(solution, criterion, True)
    information = make_directions([compute_full_jacobian([*blocks, *priors], solution).matrix])

    def is_significant(independent: float) -> bool:
        variance = (solution.sse + rounding_sse) / max(independent - parameters, 1.0)
        return _are_arms_significant(solution, information.covariance(variance * information.gram))

    # the sandwich lies between full weight of every sample and the weight by the slowest
    # correlation: it is needed only where these two disagree
    is_significant_order = is_significant(solution.samples) and (
        is_significant(effective)
        or _are_arms_significant(
            solution,
            estimate_covariance(solution, every_sample, peak=peak, priors=priors).covariance,
        )
    )
    return Score(solution, criterion, is_significant_order)


def _are_arms_significant(solution: Solution, covariance: FloatArray) -> bool:
    fixed_count, arms = len(solution.fixed_names), solution.order
    error = np.sqrt(np.diag(covariance))
    k, se_k = solution.arms.ravel(), error[fixed_count : fixed_count + arms]
    return significant(k, se_k, error[fixed_count + arms :])


# Profile likelihoods where standard errors are inadequate.


# SE(ln tau) below which the likelihood is close enough to Gaussian for intervals.
MAX_WALD_SE = 0.05
# confidence level that a stored profile covers; with few effective residuals, where that needs a
# deviance above this limit, the usual level: wider intervals are then open
_WIDEST_LEVEL, _USUAL_LEVEL, _MAX_DEVIANCE = 0.999, 0.95, 30.0


def compute_profiles(
    blocks: Sequence[DataBlock],
    estimate: SolutionEstimate,
    *,
    every_sample: Sequence[DataBlock] | None = None,
) -> tuple[Profile, ...]:
    """Return the profiles of tau, k and b of every arm with SE(ln tau) >= 0.05, and of k_inf.

    Parameters
    ----------
    blocks : sequence of DataBlock
        The compressed data.
    estimate : SolutionEstimate
    every_sample : sequence of DataBlock, optional
        The data with a row per sample, in the order of time: the gain of correlated noise is then
        computed along each profile.
    """
    solution = estimate.solution
    if not solution.order or estimate.dof < 1.0:
        return ()
    k = solution.arms[solution.groups.index("k")]
    uncertain_arms = [
        (number, int(j))
        for number, j in enumerate(np.flatnonzero(k > 0), start=1)
        if not estimate.standard_error(f"ln_tau_{j + 1}") < MAX_WALD_SE
    ]
    if not uncertain_arms:
        return ()
    noise_gain = None if every_sample is None else _compute_noise_gain(every_sample, estimate)
    scaling = _ProfileScaling(estimate, noise_gain)
    fixed = len(solution.fixed_names)
    targets = {}
    if solution.coefficient("k_inf") > 0:
        targets["k_inf"] = scaling.linear("k_inf")
    for number, j in uncertain_arms:
        row = f"k_{j + 1}"
        targets[f"k_{number}"] = scaling.linear(row)
        targets[f"ln_tau_{number}"] = scaling.log_tau(j)
        targets[f"ln_b_{number}"] = scaling.log_b(j, row, float(k[j]), fixed=fixed)
    # a prior is a few rows already
    stack = Stack(
        [
            compact_block(block, excess=WINDOW_FACTOR) if block.variance is None else block
            for block in blocks
        ]
    )
    widest, usual = (
        t_quantile(value, estimate.dof) ** 2 for value in (_WIDEST_LEVEL, _USUAL_LEVEL)
    )
    limit = min(widest, max(1.1 * usual, _MAX_DEVIANCE))
    results = walk_profiles(stack, solution, list(targets.values()), limit=limit)
    return tuple(Profile(name, *result) for name, result in zip(targets, results, strict=True))


def _compute_noise_gain(
    every_sample: Sequence[DataBlock], estimate: SolutionEstimate
) -> NoiseGain | None:
    """Return the noise gain of changes of the model; None if it is about the same for all."""
    if nearly_white(estimate.noises) or not noise_gain_differs(estimate.noise_gain):
        return None
    from dashpot.numerics.inference.correlated_noise import NoiseGain

    return NoiseGain(every_sample, estimate.noises, estimate.solution)


class _ProfileScaling:
    """Steps and scales of profiles, from the covariance."""

    def __init__(self, estimate: SolutionEstimate, noise_gain: NoiseGain | None) -> None:
        self.estimate = estimate
        self.noise_gain = noise_gain

    def linear(self, row: str) -> ProfileTarget:
        index = self.estimate.names.index(row)
        return self._scale_direction(Coordinate.LINEAR, index, self._make_unit_gradient(index))

    def log_tau(self, arm: int) -> ProfileTarget:
        index = self.estimate.names.index(f"ln_tau_{arm + 1}")
        return self._scale_direction(Coordinate.LOG_TAU, arm, self._make_unit_gradient(index))

    def log_b(self, arm: int, row: str, k: float, *, fixed: int) -> ProfileTarget:
        gradient = self._make_unit_gradient(self.estimate.names.index(f"ln_tau_{arm + 1}"))
        index = self.estimate.names.index(row)
        gradient[index] = 1.0 / k
        # the index is that among the linear parameters, as b contains the stiffness of the arm
        return self._scale_direction(Coordinate.LOG_B, index - fixed, gradient)

    def _make_unit_gradient(self, index: int) -> FloatArray:
        unit = np.zeros(len(self.estimate.names))
        unit[index] = 1.0
        return unit

    def _scale_direction(
        self, coordinate: Coordinate, index: int, gradient: FloatArray
    ) -> ProfileTarget:
        is_used = gradient != 0.0
        block = self.estimate.covariance[np.ix_(is_used, is_used)]
        directions = self.estimate.directions
        inverse = directions @ (directions.T @ gradient)
        unit_variance = float(gradient @ inverse)
        if np.all(np.isfinite(block)):
            variance = float(gradient[is_used] @ block @ gradient[is_used])
        else:
            variance = unit_variance * self.estimate.residual_sd**2
        error = float(np.sqrt(variance))
        scale = variance / unit_variance if unit_variance > 0 else self.estimate.residual_sd**2
        step = 0.7 * error
        if coordinate is not Coordinate.LINEAR:
            step = min(step, 0.5)
        return ProfileTarget(
            coordinate,
            index,
            step=max(step, 1e-9),
            scale=max(scale, 1e-300),
            relative_gain=self._make_relative_gain(inverse),
        )

    def _make_relative_gain(
        self, first: FloatArray
    ) -> Callable[[FloatArray, FloatArray], float] | None:
        noise_gain = self.noise_gain
        if noise_gain is None:
            return None
        at_optimum = noise_gain.compute_step_gain(first)
        return lambda beta, log_tau: noise_gain.evaluate(beta, log_tau) / at_optimum


# Sensitivity of the parameters to unmeasured effects of the rig.
#
# A fit assumes an ideal rig; its errors include those of a real one. A force c that is no column of
# the fit, such as that of a creeping crosshead, changes its parameters by
#
# .. math:: \delta\theta = (J'J)^{-1} J' c
#
# with J the rows of the records and of the priors of offset, drift and delay. With c the column of
# one effect times its standard deviation, :math:`\delta\theta\,\delta\theta'` is its part of the
# covariance.


class _TestColumns(NamedTuple):
    """Design matrix of one test in units of its noise.

    Columns are derivatives by the model's parameters (`solid`) and by the test's own coefficients
    (`private`), rows of their priors, and unmeasured effects of the rig.
    """

    solid: FloatArray
    private: FloatArray
    prior: FloatArray
    unmeasured: FloatArray


def compute_rig_sensitivity(
    relaxations: Sequence[RelaxationData], solid: Solid, *, separate: bool = False
) -> FloatArray:
    """Return the change of the parameters by each unmeasured effect of each rig.

    Parameters
    ----------
    relaxations : sequence of RelaxationData
        The fitted data, with the effects of their rigs (`RelaxationData.unseen`).
    solid : Solid
        Its parameters are k_inf, every k, every ln tau, or those of a fractional model; N/m and s.
    separate : bool
        Each test has its own stiffnesses, in rows one test after another; the relaxation times
        are common.

    Returns
    -------
    array, shape (p, d)
        Each column is one standard deviation of an independent effect.
    """
    all_columns = [_evaluate_test_columns(data, solid) for data in relaxations]
    parameter_count = all_columns[0].solid.shape[1]
    own_count = 1 + solid.maxwell.arms if separate else 0
    total_count = parameter_count + own_count * (len(all_columns) - 1)
    shared = np.arange(total_count - parameter_count + own_count, total_count)
    column_count = total_count + sum(column.private.shape[1] for column in all_columns)
    jacobians, next_column = [], total_count
    for i, columns_of_test in enumerate(all_columns):
        rows, own_columns = (
            len(columns_of_test.solid),
            slice(next_column, next_column + columns_of_test.private.shape[1]),
        )
        J = np.zeros((rows + len(columns_of_test.prior), column_count))
        J[:rows, np.r_[i * own_count : (i + 1) * own_count, shared]] = columns_of_test.solid
        J[:rows, own_columns], J[rows:, own_columns] = (
            columns_of_test.private,
            columns_of_test.prior,
        )
        jacobians.append(J)
        next_column = own_columns.stop
    information = make_directions(jacobians)
    shifts = [
        information.parameter_directions
        @ (columns.matrix[: len(column.unmeasured)].T @ column.unmeasured)
        for column, columns in zip(all_columns, information.columns, strict=True)
    ]
    return np.hstack(shifts)[:total_count]


def _evaluate_test_columns(data: RelaxationData, solid: Solid) -> _TestColumns:
    model, rig_effects = solid.maxwell, data.unmeasured_effects
    log_tau = np.zeros(0) if rig_effects is None else rig_effects.log_tau
    # arms of a fractional model beyond the range of a record have one effect at its limit
    base, arms = np.unique(
        np.clip(np.log(model.tau), *np.log(data.block.window)), return_inverse=True
    )
    # coordinates may differ between calls, so one call evaluates all columns
    evaluation = data.block.evaluate(np.concatenate((base, log_tau)))
    kinds = [get_column_kind(name) for name in data.block.fixed_names]
    spring = kinds.index("k_inf")
    columns = np.column_stack(
        (
            evaluation.fixed[:, spring],
            evaluation.arms[:, arms],
            evaluation.d_arms[:, arms] * model.k,
        )
    )
    if isinstance(solid, FractionalZener):
        columns = columns @ solid.arm_gradient()
    private = [i for i in range(len(kinds)) if i != spring]
    prior_terms = replace(data.terms, priors={**data.terms.priors, "drift": data.drift})
    rows = prior_terms.build_rows(data.block, 1 / data.weight)
    matrix = np.zeros((rows.samples, len(kinds)))
    matrix[:, [data.block.fixed_names.index(name) for name in rows.fixed_names]] = rows.evaluate(
        np.zeros(0)
    ).fixed
    effect_columns = np.zeros((len(columns), 0))
    if rig_effects is not None:
        effect_columns = rig_effects.columns(evaluation.fixed, evaluation.arms[:, len(base) :])
    if "drift" in kinds:
        # the part of the drift that the prior of the fit excludes
        remaining_drift = data.terms.priors["drift"].compute_remainder(data.drift)
        drift = replace(data.terms, priors={"drift": remaining_drift})
        effect_columns = np.hstack(
            (effect_columns, drift.build_prior_columns(evaluation.fixed, data.block.fixed_names)[0])
        )
    return _TestColumns(
        data.weight * columns,
        data.weight * evaluation.fixed[:, private],
        data.weight * matrix[:, private],
        data.weight * effect_columns,
    )


def compute_clock_sensitivity(tests: Sequence[RampHold], model: GeneralizedMaxwell) -> FloatArray:
    r"""Return the change of the parameters by a delay of the force, of holds, shape (p, 1).

    A hold that begins :math:`\delta` late has arms of :math:`k\,e^{\delta/\tau}`. The error of the
    end of a ramp is that of the clocks and of the step of the encoder.
    """
    delay_errors = [
        np.hypot(
            build_delay_prior(test).sd,
            test.encoder_step / np.sqrt(12) * test.ramp_time / test.depth,
        )
        for test in tests
    ]
    k, tau = np.asarray(model.k), np.asarray(model.tau)
    change = np.concatenate(([0.0], k / tau, np.zeros(len(k))))
    return np.asarray(np.sqrt(np.mean(np.square(delay_errors)) / len(tests)) * change)[:, None]
