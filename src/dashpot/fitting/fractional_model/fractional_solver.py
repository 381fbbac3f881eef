r"""The best fractional element in a stack of blocks, without a guess.

At fixed relaxation times tau_i, even in ln tau, the column of an element is a sum of columns of
arms (:func:`~dashpot.solids.fractional.weights_at`),

.. math:: c(\tau, \alpha) = \sum_i w(\ln\tau_i - \ln\tau;\, \alpha)\, \varphi(\tau_i)

so the rows of a stack are asked once, and any trial of tau and alpha is a product with weights.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.log_tau_descent import Stack
from dashpot.numerics.exponential_fit.variable_projection import Jacobian, Solution
from dashpot.numerics.least_squares.levenberg_marquardt import triangle
from dashpot.numerics.least_squares.problem import (
    Optimum,
    Parameter,
    Problem,
    Rows,
    require_optimum,
)
from dashpot.solids.fractional import Weights, weights_at

# step of ln tau of the columns, and how far beyond the window of a stack they stand: an arm that
# far out is a spring or nothing
STEP, BEYOND = 0.2, float(np.log(1e3))
# slopes between which elements are sought: nearly a spring, and nearly an arm
ALPHA = (0.05, 0.92)
# relaxation times are sought this far beyond the window
SOUGHT = float(np.log(100.0))
_SLOPES, _PER_FOLD = (0.2, 0.4, 0.6, 0.8), 1.0
_STARTS = 3
# sizes of steps of ln tau and alpha
_SIZES = (1.0, 0.13)
# columns evaluated on every sample at once
_AT_ONCE = 16


class ArmColumns:
    """The rows of a stack, reduced, with columns of arms at fixed relaxation times."""

    def __init__(self, blocks: Sequence[DataBlock]) -> None:
        self.stack = stack = Stack(blocks)
        low, high = stack.bounds
        count = int(np.ceil((high - low + 2 * BEYOND) / STEP))
        self.log_tau = low - BEYOND + STEP * np.arange(count + 1.0)
        rows = stack.evaluate(self.log_tau, derivative=False)
        factor = triangle(rows.columns)
        q = len(stack.names)
        self.fixed, self.arms, self.target = factor[:, :q], factor[:, q:-1], factor[:, -1]
        self.restricted = stack.get_nonnegative_mask(1, signed=False)
        self.bounds = (
            np.array([low - SOUGHT, ALPHA[0]]),
            np.array([high + SOUGHT, ALPHA[1]]),
        )

    def weights(self, at: FloatArray) -> Weights:
        """Weights of the arms that stand for an element."""
        return weights_at(self.log_tau - at[0], float(at[1]))

    @cached_property
    def problem(self) -> Problem:
        """The rows at ln tau and alpha; beta is the fixed coefficients, then k, N/m."""
        low, high = self.bounds

        def model(theta: FloatArray) -> Rows:
            column, *by = (self.arms @ part for part in self.weights(theta))
            A = np.concatenate((self.fixed, column[:, None]), axis=1)
            return Rows(self.target, A, lambda beta: beta[-1] * np.column_stack(by))

        return Problem(model, [*map(Parameter, low, high, _SIZES)], self.restricted)

    def best(self) -> Optimum:
        """The element that leaves least, from the best of a grid of starts."""
        return require_optimum(self.problem, [start.theta for start in self.starts(_STARTS)])

    def starts(self, count: int) -> list[Optimum]:
        """The best points of a grid, no two of nearly the same relaxation time."""
        low, high = self.bounds
        times = np.arange(low[0], high[0], 1 / _PER_FOLD)
        tried = [self.problem.at(np.array([t, slope])) for t in times for slope in _SLOPES]
        optima: list[Optimum] = []
        for near in sorted(tried, key=lambda optimum: optimum.cost):
            if all(abs(near.theta[0] - optimum.theta[0]) > 2 / _PER_FOLD for optimum in optima):
                optima.append(near)
            if len(optima) == count:
                break
        return optima

    def solution(self, best: Optimum) -> Solution:
        """An element as the arms that stand for it, in the engine's own terms."""
        arms = best.beta[-1] * self.weights(best.theta).value
        low, high = self.bounds
        # an edge of tau or of alpha is one of all its arms
        edge = bool(((best.theta <= low + 1e-9) | (best.theta >= high - 1e-9)).any())
        return Solution(
            log_tau=self.log_tau,
            groups=self.stack.groups,
            arms=arms[None],
            fixed_names=self.stack.names,
            fixed=best.beta[:-1],
            sse=self.stack.floor + best.sse,
            samples=self.stack.samples,
            requested=len(arms),
            evaluations=0,
            converged=best.stationary and not edge,
            relative_offset=0.0 if best.stationary else 1.0,
            at_bound=np.full(len(arms), edge),
            bounds=self.stack.bounds,
        )


def element_jacobian(blocks: Sequence[DataBlock], columns: ArmColumns, best: Optimum) -> Jacobian:
    """Residual and derivative by fixed coefficients, k, ln tau and alpha, in the blocks' rows."""
    stack, weights = Stack(blocks), columns.weights(best.theta)
    matrix = np.stack(weights, axis=1)
    values = None
    for first in range(0, len(columns.log_tau), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        rows = stack.evaluate(columns.log_tau[part], derivative=False)
        q = len(stack.names)
        if values is None:
            target, fixed = rows.target, rows.phi[:, :q]
            values = np.zeros((len(target), 3))
        values += rows.phi[:, q:] @ matrix[part]
    assert values is not None  # noqa: S101  # a window holds times
    jacobian = np.concatenate((fixed, values * [1.0, best.beta[-1], best.beta[-1]]), axis=1)
    model = jacobian[:, : q + 1] @ best.beta
    return Jacobian((*stack.names, "k", "ln_tau", "alpha"), jacobian, target - model)
