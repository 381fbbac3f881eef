r"""Sandwich covariance of an optimum, and of quantities derived from it.

With J the derivative of the model by :math:`\theta` and :math:`\beta`, and
:math:`\Gamma` the autocovariance of the residuals of each record
(:mod:`dashpot.numerics.inference.correlated_noise`),

.. math:: C = (J'J)^{-1} J'\Gamma J\,(J'J)^{-1}, \qquad
          C_f = G\,C\,G', \quad G = \partial f / \partial(\theta, \beta)

A coefficient that rests at zero is held there and has no error unless its bound is requested.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.student_t import t_quantile
from dashpot.numerics.inference.correlated_noise import (
    Noise,
    estimate_noise,
    make_directions,
    sandwich,
)
from dashpot.numerics.inference.model_order import bic
from dashpot.numerics.least_squares import Optimum

#: profile intervals: steps on each side, largest number of trials, tolerance of the ends in
#: quantiles
_SLICES, _TRIALS, _END_TOLERANCE = 3, 40, 1e-2


class DerivedQuantity(NamedTuple):
    """Quantity derived from an estimate.

    Attributes
    ----------
    values : array, shape (m,)
    covariance : array, shape (m, m)
    gradient : array, shape (m, p + q)
        By theta, then beta.
    """

    values: FloatArray
    covariance: FloatArray
    gradient: FloatArray

    @property
    def standard_error(self) -> FloatArray:
        """Standard error of each value."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


@dataclass(frozen=True, eq=False)
class Estimate:
    """Optimum with the covariance of theta and beta.

    Attributes
    ----------
    optimum : Optimum
    covariance : array, shape (p + q, p + q)
        Zero for parameters at a bound, infinite for undetermined ones.
    noises : tuple of Noise
        Noises of each record.
    prior_variance : float or None
        Variance of the rows of priors, where it is not the mean power of the noises.
    """

    optimum: Optimum
    covariance: FloatArray
    noises: tuple[Noise, ...]
    prior_variance: float | None = None

    @property
    def effective(self) -> float:
        """Effective number of independent residuals."""
        return sum(noise.effective for noise in self.noises)

    @property
    def kappa(self) -> float:
        """Number of residuals for each independent one."""
        return len(self.optimum.residual) / self.effective

    @property
    def dof(self) -> float:
        """Degrees of freedom left, at least one."""
        return max(self.effective - len(self.covariance), 1.0)

    @property
    def standard_error(self) -> FloatArray:
        """Standard errors of theta, then beta."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    def quantile(self, level: float = 0.95) -> float:
        """Return standard errors in half a two-sided interval: Student's t."""
        return t_quantile(level, self.dof)

    def derive_quantity(self, function: Callable[[FloatArray], FloatArray]) -> DerivedQuantity:
        """Return a quantity derived from theta and beta, by its gradient (delta method)."""
        optimum_values, steps = self.optimum.values, self.optimum.steps
        values = np.asarray(function(optimum_values))
        G = np.zeros((len(values), len(optimum_values)))
        for i in np.flatnonzero(np.diag(self.covariance) > 0):
            shifted_down, shifted_up = optimum_values.copy(), optimum_values.copy()
            shifted_down[i], shifted_up[i] = optimum_values[i] + np.array(steps[i])
            G[:, i] = (function(shifted_up) - function(shifted_down)) / (
                shifted_up[i] - shifted_down[i]
            )
        return DerivedQuantity(values, propagate_covariance(self.covariance, G), G)

    def add_parameter_error(self, error: FloatArray) -> Estimate:
        """Return the estimate with one more error, which changes theta and beta by so much."""
        return replace(self, covariance=self.covariance + np.outer(error, error))

    def profile(self, index: int, *, level: float = 0.95) -> list[ProfileSlice]:
        r"""Return the problem with one theta fixed, all others optimal, across its interval.

        .. math:: S(\theta_i) - S_{\min} \le t^2\, \gamma

        with the power :math:`\gamma` of the noise, from the low end to the high. What is normal at
        each value that is held, but not over all, has the interval of all slices together. An end
        beyond which nothing is worse is that of the parameter's range. Source: D. M. Bates and
        D. G. Watts, Nonlinear Regression Analysis (1988), ch. 6.
        """
        best, parameter = self.optimum, self.optimum.problem.parameters[index]
        sample_counts = [noise.samples for noise in self.noises]
        power = float(np.average([noise.power for noise in self.noises], weights=sample_counts))
        half_width, optimum_value = self.quantile(level), float(best.theta[index])
        width = float(self.standard_error[index])
        has_width = 0 < width < np.inf
        nuisances = np.delete(best.theta, index)
        direction = self.covariance[: len(best.theta), index]
        tangent = np.delete(direction, index) / width**2 if has_width else np.zeros(len(nuisances))
        first_step = half_width * width / _SLICES if has_width else parameter.scale

        def solve_slice(value: float, start: FloatArray) -> ProfileSlice | None:
            """Return the slice at a value of theta; None where the model is not defined."""
            try:
                optimum = best.problem.fix_parameter(index, value).solve(
                    [start], cost_tolerance=_END_TOLERANCE / sum(sample_counts)
                )
                return None if optimum is None else slice_of(value, optimum)
            except DataError:
                return None

        def slice_of(value: float, new_optimum: Optimum) -> ProfileSlice:
            covariance = estimate(
                new_optimum,
                parts=sample_counts,
                noises=self.noises,
                prior_variance=self.prior_variance,
            ).covariance
            covariance = np.insert(np.insert(covariance, index, 0.0, axis=0), index, 0.0, axis=1)
            optimum = best.problem.solve_linear(np.insert(new_optimum.theta, index, value))
            root = float(np.sqrt(max(new_optimum.cost - best.cost, 0.0) / power))
            return ProfileSlice(root, replace(self, optimum=optimum, covariance=covariance))

        def side(sign: float, limit: float) -> list[ProfileSlice]:
            slices: list[ProfileSlice] = []
            before_last, (value_here, nuisances_here, root) = (
                (optimum_value - first_step, nuisances - first_step * tangent),
                (optimum_value, nuisances, 0.0),
            )
            step, value_beyond, root_beyond = first_step, np.nan, np.inf
            for _ in range(_TRIALS):
                is_at_target = (
                    root > half_width * (1 - _END_TOLERANCE)
                    or abs(value_beyond - value_here) < _END_TOLERANCE * first_step
                )
                if is_at_target or value_here == limit:
                    break
                # the root of a parabola's deviance is straight: a secant, kept off the ends
                fraction = (
                    (half_width - root) / (root_beyond - root) if root_beyond < np.inf else 0.5
                )
                step_length = min(step, abs(limit - value_here))
                step_length = (
                    step_length
                    if np.isnan(value_beyond)
                    else min(max(fraction, 0.1), 0.9) * abs(value_beyond - value_here)
                )
                value = value_here + sign * step_length
                # the others begin where the last two lead
                start = nuisances_here + (nuisances_here - before_last[1]) * (
                    (value - value_here) / (value_here - before_last[0])
                )
                new = solve_slice(value, start)
                if new is None or new.root > half_width * (1 + _END_TOLERANCE):
                    value_beyond, root_beyond = value, np.inf if new is None else new.root
                    continue
                slices.append(new)
                step *= min(max(half_width / _SLICES / max(new.root - root, 1e-9), 0.5), 2.0)
                before_last, (value_here, nuisances_here, root) = (
                    (value_here, nuisances_here),
                    (value, np.delete(new.estimate.optimum.theta, index), new.root),
                )
            return slices

        centre = slice_of(
            optimum_value, best.problem.fix_parameter(index, optimum_value).solve_linear(nuisances)
        )
        return [*side(-1.0, parameter.low)[::-1], centre, *side(1.0, parameter.high)]


def propagate_covariance(covariance: FloatArray, gradient: FloatArray) -> FloatArray:
    """Return the covariance of quantities with this gradient by the parameters, shape (m, m).

    A quantity that depends on an undetermined parameter is undetermined as well.
    """
    finite = np.isfinite(np.diag(covariance))
    values = gradient[:, finite] @ covariance[np.ix_(finite, finite)] @ gradient[:, finite].T
    is_undetermined = (gradient[:, ~finite] != 0).any(axis=1)
    values[is_undetermined], values[:, is_undetermined] = 0.0, 0.0
    values[is_undetermined, is_undetermined] = np.inf
    return np.asarray(values)


class ProfileSlice(NamedTuple):
    """Estimate with one theta held at a value other than its optimum.

    Attributes
    ----------
    root : float
        Root of the deviance: how many standard errors away that is.
    estimate : Estimate
    """

    root: float
    estimate: Estimate


def estimate(
    optimum: Optimum,
    *,
    parts: Sequence[int] = (),
    rounding: float = 0.0,
    noises: Sequence[Noise] = (),
    is_bounded: BoolArray | None = None,
    is_fixed: BoolArray | None = None,
    prior_variance: float | None = None,
    with_fine_scales: bool = False,
) -> Estimate:
    """Return the covariance estimate of an optimum, by the residuals of each record.

    Parameters
    ----------
    optimum : Optimum
    parts : sequence of int
        Rows of each record, in order; by default there is one record.
    rounding : float
        Rms that rounding alone leaves.
    noises : sequence of Noise
        Noises of each record, if known otherwise (:func:`white_noise`).
    is_bounded : array, shape (q,), optional
        Coefficients whose error is wanted, as a bound, where they rest at zero, too.
    is_fixed : array, shape (p,), optional
        Thetas that have no error: such as those at a physical bound.
    prior_variance : float, optional
        Variance of the rows of priors; by default the mean power of the noises.
    with_fine_scales : bool
        As :func:`~dashpot.numerics.inference.correlated_noise.make_directions` has it.
    """
    free, count = optimum.free, optimum.problem.priors
    if is_fixed is not None:
        free[: len(is_fixed)] &= ~is_fixed
    row_counts = [*(parts or [len(optimum.residual)]), *([count] if count else [])]
    record_edges = np.cumsum(row_counts)[:-1]
    jacobians = np.split(optimum.jacobian[:, free], record_edges)
    information = make_directions(
        jacobians, is_shared=len(record_edges) > 0, with_fine_scales=with_fine_scales
    )
    # rows of priors are no record
    records = list(
        zip(np.split(optimum.all_residuals, record_edges), information.columns, strict=True)
    )
    noises = tuple(noises) or tuple(
        estimate_noise(residual, columns, rounding=rounding)
        for residual, columns in (records[:-1] if count else records)
    )
    if is_bounded is not None:
        free = free | np.concatenate((np.zeros(len(optimum.theta), dtype=bool), is_bounded))
        information = make_directions(np.split(optimum.jacobian[:, free], record_edges))
    weights = [*noises]
    if count:
        power = np.mean([noise.power for noise in noises])
        variance = power if prior_variance is None else prior_variance
        weights.append(Noise(count, np.array([variance]), 1.0, 2.0))
    covariance = np.zeros((len(free), len(free)))
    covariance[np.ix_(free, free)] = sandwich(information, weights)
    return Estimate(optimum, covariance, noises, prior_variance)


def white_noise(optimum: Optimum, variance: float | None = None) -> Noise:
    """Return the noise of independent residuals, of the variance that they show or that is known.

    What they show is their sum of squares over n less the free parameters.
    """
    n = len(optimum.residual)
    dof = max(n - int(optimum.free.sum()), 1)
    return Noise(n, np.array([optimum.sse / dof if variance is None else variance]), 1.0, 2.0)


def score(optimum: Optimum, effective: float, *, rounding_sse: float = 0.0) -> float:
    """Return the BIC of an optimum, theta and beta counted, in so many independent residuals.

    Of noise that is known :func:`~dashpot.numerics.inference.model_order.bic_of_deviance`.

    Parameters
    ----------
    optimum : Optimum
    effective : float
        Effective number of samples of the model that leaves least, for what another leaves more is
        no noise.
    rounding_sse : float
        Sum of squares that rounding alone leaves.
    """
    count = len(optimum.values)
    return bic(
        optimum.sse, effective=max(effective, 2.0), parameters=count, rounding_sse=rounding_sse
    )
