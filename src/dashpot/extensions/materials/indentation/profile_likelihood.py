"""Profile likelihood of one parameter of a least-squares problem."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base import replace
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.numerics.inference.covariance_estimate import Estimate, estimate
from dashpot.numerics.least_squares import Optimum

_SLICES, _TRIALS, _END_TOLERANCE = 3, 40, 1e-2
"""Slices to a side, trials at most, and how close the ends of an interval come in quantiles."""


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


def compute_profile(
    best_estimate: Estimate, index: int, *, level: float = 0.95
) -> list[ProfileSlice]:
    r"""Return the problem with one theta fixed, all others optimal, across its interval.

    .. math:: S(\theta_i) - S_{\min} \le t^2\, \gamma

    with the power :math:`\gamma` of the noise, from the low end to the high. What is normal at
    each value that is held, but not over all, has the interval of all slices together. An end
    beyond which nothing is worse is that of the parameter's range. Source: D. M. Bates and
    D. G. Watts, Nonlinear Regression Analysis (1988), ch. 6.
    """
    best, parameter = best_estimate.optimum, best_estimate.optimum.problem.parameters[index]
    sample_counts = [noise.samples for noise in best_estimate.noises]
    power = float(
        np.average([noise.power for noise in best_estimate.noises], weights=sample_counts)
    )
    half_width, optimum_value = best_estimate.quantile(level), float(best.theta[index])
    width = float(best_estimate.standard_error[index])
    has_width = 0 < width < np.inf
    nuisances = np.delete(best.theta, index)
    direction = best_estimate.covariance[: len(best.theta), index]
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
            noises=best_estimate.noises,
            prior_variance=best_estimate.prior_variance,
        ).covariance
        covariance = np.insert(np.insert(covariance, index, 0.0, axis=0), index, 0.0, axis=1)
        optimum = best.problem.solve_linear(np.insert(new_optimum.theta, index, value))
        root = float(np.sqrt(max(new_optimum.cost - best.cost, 0.0) / power))
        return ProfileSlice(root, replace(best_estimate, optimum=optimum, covariance=covariance))

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
            fraction = (half_width - root) / (root_beyond - root) if root_beyond < np.inf else 0.5
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
