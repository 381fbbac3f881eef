"""Uncertainty of a fit to a curve: admissible solids, limits, and valid band."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.datamodel.bounds import BandError, Ended, EndOfHold
from dashpot.datamodel.parameter_estimate import Interval
from dashpot.fitting.admissible_spectra import (
    AdmissibleSpectra,
    compute_nonnegative_limits,
    compute_upper_limit,
    deviance_limit,
)
from dashpot.fitting.data_blocks import build_solid, find_largest_target, max_determinable_arms
from dashpot.fitting.marginal_relaxation import RelaxationRows
from dashpot.fitting.nuisance_priors import ROUNDING, NuisanceTerms
from dashpot.fitting.parameter_errors import estimate_covariance
from dashpot.fitting.valid_band import (
    ErrorFunction,
    SolidErrors,
    find_loss_factor_band,
    has_loss_band,
)
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit import solve_orders
from dashpot.numerics.inference.correlated_noise import (
    JacobianColumns,
    ResidualSeries,
    estimate_noise,
    marginalise,
)
from dashpot.numerics.log_tau_descent import Stack
from dashpot.numerics.nonnegative_least_squares import solve_linear
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# A curve, or a creep test, as data to be explained by all the spectra that it does not reject.
#
# A published curve states no errors. They are
#
# .. math:: \sigma_i^2 = S, \qquad
#     \mathrm{cov}_{ij} = c^2 s_i s_j \sum_n h_n(\lg t_i)\, h_n(\lg t_j)
#
# with S the power of what the nearest non-negative spectrum leaves, by the rule of noise of every
# fit (:func:`~dashpot.numerics.inference.correlated_noise.estimate_noise`), s the size of that
# spectrum, and h_n straight lines between knots a quarter of a decade apart: what neighbours have
# in common - a load cell, a thermostat, grips, smoothing - does not show in a residual.


#: common error of neighbouring values, relative, one standard deviation
COMMON_ERROR = 2e-3
# knots per decade of the common error
KNOTS_PER_DECADE = 4
# relative rounding of a value with four digits
DIGITS_ERROR = 1e-4
# points per decade of the grid of the nearest spectrum
PER_DECADE = 12
_SPRINGS, _DASHPOTS = {"k_inf", "glass"}, {"b", "flow"}


@dataclass(frozen=True, eq=False)
class CurveData:
    """Rows in units of their noise, with further uncertainties.

    Attributes
    ----------
    block : DataBlock
        A spring and a dashpot among its fixed columns, of stiffness or of compliance.
    window : (float, float)
        Shortest and longest relaxation time of the spectra, s.
    dof : float
        Degrees of freedom of the noise.
    common_errors : array, shape (n, d)
        Common errors of the rows, in units of the noise.
    terms : NuisanceTerms
        Priors of the other fixed columns, and unmeasured effects in those of the solid.
    """

    block: DataBlock
    window: tuple[float, float]
    dof: float
    common_errors: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    terms: NuisanceTerms = field(default_factory=lambda: NuisanceTerms({}))

    def rows(self, log_tau: FloatArray, *, with_slopes: bool = True) -> RelaxationRows:
        """Return the rows that depend on the solid, whitened by the priors and common errors."""
        evaluation = self.block.evaluate(log_tau, with_slopes)
        names = self.block.fixed_names
        prior_columns, mean = self.terms.build_prior_columns(evaluation.fixed, names)
        error_columns = (
            np.hstack((prior_columns, self.common_errors))
            if self.common_errors.size
            else prior_columns
        )
        white = marginalise(np.zeros((len(mean), 0)), error_columns)

        def column(kinds: set[str]) -> FloatArray:
            indices = [i for i, name in enumerate(names) if name in kinds]
            return white(evaluation.fixed[:, indices].sum(axis=1))

        return RelaxationRows(
            target=white(evaluation.target - mean),
            spring=column(_SPRINGS),
            dashpot=column(_DASHPOTS),
            arms=white(evaluation.arms),
            slopes=white(evaluation.d_arms),
        )


def weight_curve(
    block: DataBlock,
    abscissa: FloatArray,
    *,
    window: tuple[float, float],
    common_error: float = COMMON_ERROR,
) -> CurveData | None:
    """Weight a curve by its residual about the nearest non-negative spectrum.

    None where so few values follow some spectrum exactly: they show no scatter.

    Parameters
    ----------
    block : DataBlock
        A row a value, in units in which the errors of each part of it are alike.
    abscissa : array, shape (n,)
        Times or frequencies, > 0, of each of its parts: one, or storage and loss.
    window : (float, float)
        Shortest and longest relaxation time of the spectra, s.
    common_error : float
        Common error of neighbouring values, relative, one standard deviation.
    """
    n, low, high = len(abscissa), *np.log(window)
    grid = np.linspace(low, high, int(np.ceil((high - low) / np.log(10) * PER_DECADE)) + 1)
    rows = block.evaluate(grid, False)
    columns = np.concatenate((rows.fixed, rows.arms), axis=1)
    best, _ = solve_linear(columns, rows.target, positive=True)
    fitted_curve = columns @ best
    if np.linalg.matrix_rank(columns[:, best > 0]) >= len(fitted_curve):
        return None
    active = np.linalg.qr(columns[:, best > 0])[0]
    weight, effective = np.empty(len(fitted_curve)), 0.0
    for start in range(0, len(fitted_curve), n):
        part = slice(start, start + n)
        # a spring has no loss
        size = fitted_curve[part] if fitted_curve[part].any() else fitted_curve
        rounding_limit = DIGITS_ERROR * float(np.sqrt(np.mean(size**2)))
        series = ResidualSeries(rows.target[part] - fitted_curve[part])
        noise = estimate_noise(
            series, JacobianColumns(active[part], is_shared=True), rounding=rounding_limit
        )
        weight[part] = 1 / np.sqrt(max(noise.power, rounding_limit**2))
        effective += noise.effective
    common_errors = common_error * np.kron(
        np.eye(len(fitted_curve) // n), _make_hat_functions(np.log10(abscissa))
    )
    return CurveData(
        block.transform_rows(lambda part: (weight * part.T).T),
        window,
        effective - np.count_nonzero(best),
        common_errors * (weight * fitted_curve)[:, None],
    )


def _make_hat_functions(abscissa: FloatArray) -> FloatArray:
    """Straight lines from 1 at each knot to 0 at its neighbours, shape (n, m)."""
    count = int(np.ceil(KNOTS_PER_DECADE * float(np.ptp(abscissa)))) + 1
    knots = float(abscissa.min()) + np.arange(count) / KNOTS_PER_DECADE
    return np.asarray(np.maximum(1 - KNOTS_PER_DECADE * np.abs(abscissa[:, None] - knots), 0.0))


# Where stiffness and loss factor are known, over every spectrum that a test does not reject.
#
# At a line :math:`\omega` the limits of the loss factor :math:`\eta = K''/K'` follow by
# Dinkelbach's iteration (*Management Science* 13, 1967), which starts from that of the fit. Those
# of :math:`|K^*|` are of its part along that of the fit,
#
# .. math:: |K^*| \cos(\phi - \phi_0) = K'\cos\phi_0 + K''\sin\phi_0,
#
# which is linear in the spectrum, over the cosine of the widest angle that the loss factor allows.
# Of creep :math:`J^* = 1/K^*` takes the place of K*: its angle and its size are as well known.
#
# The valid band ends where the loss factor is not known to 30 %, above or below a gap of the data,
# too: there an arm may stand that nothing shows.


#: lines over the band of a curve, at least
MIN_LINES = 3
#: lines to a decade of a curve, which may have gaps
LINES_PER_DECADE = 3
#: fastest arm, as a fraction of the first time of a curve
FASTEST_ARM = 0.1
#: least relaxation before the first time of a curve, over its modulus there
MIN_EARLY_RELAXATION = 0.01
#: weight of a dashpot relative to an arm at the first time of a curve
DASHPOT_WEIGHT = 100.0


def find_valid_band(
    spectra: AdmissibleSpectra,
    solid: Solid,
    band: tuple[float, float],
    *,
    creep: bool = False,
    add_errors: Callable[[Solid, ErrorFunction], ErrorFunction] | None = None,
) -> tuple[tuple[float, float], BandError | None]:
    """Return the valid band of a curve, which ends at a gap, and how well its solid is known there.

    The parameters are those of :func:`find_hold_band`; `creep` where the spectra are of compliance,
    `add_errors` adds those of shifts, or of a rig, to the errors of a solid. No errors where so few
    values limit nothing.
    """
    if not has_loss_band(solid, band):
        return band, None
    count = int(np.ceil(LINES_PER_DECADE * np.log10(band[1] / band[0]))) + 1
    lines = np.geomspace(*band, max(count, MIN_LINES)).tolist()
    errors: ErrorFunction = (ComplianceErrors if creep else SolidErrors)(
        spectra.reduce_grid(0.0), solid
    )
    if add_errors is not None:
        errors = add_errors(solid, errors)
    try:
        return find_loss_factor_band(errors, band, {line: errors(line) for line in lines})
    except FitError:
        return band, None


@dataclass(frozen=True, eq=False)
class ComplianceErrors(SolidErrors):
    """Relative errors of a fitted solid over spectra of compliance.

    :math:`J^* = 1/K^*` takes the place of the stiffness: its angle and its size are as well known.
    """

    def evaluate(self, omega: float) -> tuple[complex, FloatArray, FloatArray]:
        """Return the compliance at omega, rad/s, and storage and loss of unit columns there."""
        x = omega * self.spectra.tau
        storage = np.concatenate(([1.0, 0.0], 1 / (1 + x * x)))
        loss = np.concatenate(([0.0, 1 / omega], x / (1 + x * x)))
        compliance = 1 / complex(self.solid.complex_stiffness(omega=omega))
        return compliance.conjugate(), storage, loss


def is_limited(
    end: EndOfHold | None, error: BandError | None, solid: Solid, band: tuple[float, float]
) -> bool:
    """Return whether the values of a curve limit its end, and its solid in a band."""
    return end is not None and (error is not None or not has_loss_band(solid, band))


@dataclass(frozen=True, eq=False)
class BeforeCurve:
    """Relaxation modulus, with the possible relaxation before its first value.

    No value shows an arm that is faster than the first time. All of them together are as stiff as
    what the curve shows of its first decade, one standard deviation; a part of
    `MIN_EARLY_RELAXATION` at least.

    Attributes
    ----------
    data : CurveData
    first_time : float
        The first time after the step, s.
    solid : GeneralizedMaxwell
        The fit.
    """

    data: CurveData
    first_time: float
    solid: GeneralizedMaxwell

    @property
    def window(self) -> tuple[float, float]:
        """Shortest and longest relaxation time of the spectra, s."""
        return FASTEST_ARM * self.first_time, self.data.window[1]

    @property
    def dof(self) -> float:
        """Degrees of freedom of the noise."""
        return self.data.dof

    def rows(self, log_tau: FloatArray, *, with_slopes: bool = True) -> RelaxationRows:
        """Return those of the curve, and one of what may relax before it."""
        rows = self.data.rows(log_tau, with_slopes=with_slopes)
        start, relaxed_later = (
            float(self.solid.relaxation(n * self.first_time)) for n in (1.0, 10.0)
        )
        weight = 1 / max(start - relaxed_later, MIN_EARLY_RELAXATION * start)
        # how much of an arm is gone at the first time
        relaxed_before = -np.expm1(-self.first_time / np.exp(log_tau)) * weight
        total_change = float(self.solid.relaxation(0.0)) - start
        return rows._replace(
            target=np.append(rows.target, total_change * weight),
            spring=np.append(rows.spring, 0.0),
            # a dashpot is no arm that a curve can show
            dashpot=np.append(rows.dashpot, DASHPOT_WEIGHT * weight / self.first_time),
            arms=np.vstack((rows.arms, relaxed_before)),
            slopes=np.vstack((rows.slopes, np.zeros(len(log_tau)))) if with_slopes else rows.slopes,
        )


# What a test says of the stiffness when it ends, and of where that ends.
#
# An arm slower than every hold is a spring there: no record bounds k_inf from below. What it knows
# is
#
# .. math:: k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}
#
# at the time T that it was held, and less and less of it at 3 T, and how steeply it still falls,
# :math:`-dk/d\ln t`: all over every spectrum that the tests do not reject
# (:mod:`dashpot.fitting.admissible_spectra`). Of a sweep it knows the storage at its
# lowest line, and less of it below; of creep the compliance.


# multiple of T at which the equilibrium stiffness is evaluated, as flow is unlimited
AT_REST = 100.0


def find_admissible_spectra(
    data: CurveData | BeforeCurve, *, time: float, extra: Sequence[float], level: float = 0.95
) -> AdmissibleSpectra:
    """Return the spectra that a curve does not reject; parameters as :func:`limit_end_of_curve`."""
    return AdmissibleSpectra(
        [data], fastest=1 / time, limit=deviance_limit(level, data.dof), extra=extra
    )


def limit_end_of_curve(
    data: CurveData,
    curve_kind: Ended,
    *,
    time: float,
    model: GeneralizedMaxwell,
    extra: Sequence[float],
    level: float = 0.95,
    spectra: AdmissibleSpectra | None = None,
) -> EndOfHold | None:
    """Return the limits of a curve at its end, at 3 and 10 times that time, and of its plateau.

    The limits contain the fit. None where so few values limit nothing.

    Parameters
    ----------
    data : CurveData
    curve_kind : str
        Kind of curve: a modulus over time, storage and loss, or a compliance.
    time : float
        T, s; of a sweep 1/omega of its lowest line.
    model : GeneralizedMaxwell
        The fit.
    extra : sequence of float
        Its relaxation times, of creep its retardation times, s.
    level : float
        Coverage of each limit, nearly.
    spectra : AdmissibleSpectra, optional
        Those of :func:`find_admissible_spectra`, where they are known already.
    """
    try:
        if spectra is None:
            spectra = find_admissible_spectra(data, time=time, extra=extra, level=level)

        def compute_limits(times: float) -> Interval:
            return _compute_curve_limits(spectra, curve_kind, times * time)

        k_end, k_rest = (
            compute_limits(1),
            compute_limits(AT_REST if curve_kind == "creep" else np.inf),
        )
        if curve_kind == "creep":
            # k = 1/J falls by J'/J^2
            slope_limit = (
                compute_upper_limit(spectra, _compute_creep_slope(spectra, time)) * k_end[1] ** 2
            )
        else:
            slope_limit = compute_upper_limit(spectra, spectra.slope_at(time))
        end = EndOfHold(
            end_time=time,
            k_end=k_end,
            k_3end=compute_limits(3),
            k_10end=compute_limits(10),
            k_inf=(0.0, k_rest[1]),
            slope_limit=slope_limit,
            test_kind=curve_kind,
        )
    except FitError:
        return None
    return end.widen_to_contain(model)


def _compute_creep(spectra: AdmissibleSpectra, time: float) -> FloatArray:
    r"""Return the compliance of unit columns, shape (m,).

    It is :math:`D_g + D_f t + \sum_i D_i (1 - e^{-t/\lambda_i})`.
    """
    return np.concatenate(([1.0, time], -np.expm1(-time / spectra.tau)))


def _compute_creep_slope(spectra: AdmissibleSpectra, time: float) -> FloatArray:
    r"""Return its slope :math:`dJ/d\ln t` of unit columns, shape (m,)."""
    slope = spectra.slope_at(time)
    slope[1] = time
    return slope


def _compute_curve_limits(spectra: AdmissibleSpectra, curve_kind: Ended, time: float) -> Interval:
    """Return limits of k(t), K'(1/t) or 1/J(t)."""
    if curve_kind == "sweep":
        return compute_nonnegative_limits(spectra, spectra.stiffness_at(1 / time)[0])
    if curve_kind == "creep":
        lower, upper = compute_nonnegative_limits(spectra, _compute_creep(spectra, time))
        return (1 / upper if upper > 0 else np.inf), (1 / lower if lower > 0 else np.inf)
    return compute_nonnegative_limits(spectra, spectra.relaxed_to(time))


# fraction of a value that the fit must reach for its weight to be used
MIN_FITTED_SHARE = 0.1


# -- data weighted by their own scatter -----------------------------------------------------------


class SingleTestFit(NamedTuple):
    """Best fit of a single test: its solid, and the residual scatter of its records.

    Attributes
    ----------
    model : GeneralizedMaxwell
    scatter : tuple of float
        Spread of one independent residual (rms times root kappa) of each record, for the freedom
        that the fit took; never below the rounding of the data.
    record_dof : tuple of float
        Degrees of freedom of each record after the fit.
    """

    model: GeneralizedMaxwell
    scatter: tuple[float, ...]
    record_dof: tuple[float, ...]


def fit_single_test(
    blocks: Sequence[DataBlock], samples: Sequence[DataBlock], max_arms: int
) -> SingleTestFit:
    """Fit one test with as many arms as it supports, up to `max_arms`."""
    # half of the values are left to show their scatter
    value_count = sum(len(block.evaluate(np.zeros(0), False).target) for block in samples)
    max_arms = min(max_arms, max_determinable_arms(blocks), max((value_count // 2 - 1) // 2, 1))
    best = solve_orders(blocks, max_arms)[-1]
    peaks = [find_largest_target(block) for block in samples]
    estimate = estimate_covariance(best, samples, peak=max(peaks))
    # thirteen parameters of 32 values leave a third less than their scatter
    model = build_solid(best)
    count = sum(len(residual) for residual in estimate.residuals)
    parameter_count = len(Stack(blocks).names) + 2 * int(np.count_nonzero(model.k))
    ratio = max(count - parameter_count, 1) / count
    spreads = [
        float(np.sqrt(np.mean(residual**2) * noise.kappa / ratio))
        for residual, noise in zip(estimate.residuals, estimate.noises, strict=True)
    ]
    return SingleTestFit(
        model,
        tuple(
            max(residual_sd, ROUNDING * (peak or 1.0))
            for residual_sd, peak in zip(spreads, peaks, strict=True)
        ),
        tuple(ratio * len(residual) for residual in estimate.residuals),
    )
