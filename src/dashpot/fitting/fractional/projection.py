r"""The best fractional element in a stack of blocks, without a guess.

At fixed relaxation times tau_i, even in ln tau, the column of an element is a sum of columns of
arms (:func:`~dashpot.solids.fractional.weights_at`),

.. math:: c(\tau, \alpha) = \sum_i w(\ln\tau_i - \ln\tau;\, \alpha)\, \varphi(\tau_i)

so the rows of a stack are asked once, and any trial of tau and alpha is a product with weights.
The linear parameters are solved at each, and the residual is differentiated as for arms (variable
projection, in the form of L. Kaufman, *BIT* 15, 1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.blocks.block import Block
from dashpot.engine.least_squares.descent import triangle
from dashpot.engine.least_squares.nnls import nonnegative_columns
from dashpot.engine.solver.descent import Stack
from dashpot.engine.solver.variable_projection import Jacobian, Solution
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
_STEPS, _SETTLED = 60, 1e-10
_LONGEST = np.array([1.5, 0.2])
# columns evaluated on every sample at once
_AT_ONCE = 16


class Point(NamedTuple):
    """One trial of ln tau and alpha, everything linear solved.

    Attributes
    ----------
    at : array, shape (2,)
        ln tau and alpha.
    fixed : array, shape (q,)
    k : float
        Stiffness of the element, N/m; 0 if the data want none.
    sse : float
        Without the floor of the stack.
    gradient, curvature : arrays, shapes (2,) and (2, 2)
        J'r and J'J of the reduced residual.
    """

    at: FloatArray
    fixed: FloatArray
    k: float
    sse: float
    gradient: FloatArray
    curvature: FloatArray


class Columns:
    """The rows of a stack, reduced, with columns of arms at fixed relaxation times."""

    def __init__(self, blocks: Sequence[Block]) -> None:
        self.stack = stack = Stack(blocks)
        low, high = stack.bounds
        count = int(np.ceil((high - low + 2 * BEYOND) / STEP))
        self.log_tau = low - BEYOND + STEP * np.arange(count + 1.0)
        rows = stack.evaluate(self.log_tau, derivative=False)
        factor = triangle(np.concatenate((rows.phi.T, rows.target[None])))
        q = len(stack.names)
        self.fixed, self.arms, self.target = factor[:, :q], factor[:, q:-1], factor[:, -1]
        self.restricted = stack.restricted(1, signed=False)
        self.bounds = (
            np.array([low - SOUGHT, ALPHA[0]]),
            np.array([high + SOUGHT, ALPHA[1]]),
        )

    def weights(self, at: FloatArray) -> Weights:
        """Weights of the arms that stand for an element."""
        return weights_at(self.log_tau - at[0], float(at[1]))

    def point(self, at: FloatArray) -> Point:
        """Solve the linear parameters at ln tau and alpha."""
        weights = self.weights(at)
        column, by_tau, by_alpha = (self.arms @ part for part in weights)
        phi = np.concatenate((self.fixed, column[:, None]), axis=1)
        active = nonnegative_columns(phi, self.target, self.restricted)
        basis, r = np.linalg.qr(phi[:, active])
        along = basis.T @ self.target
        beta = np.zeros(phi.shape[1])
        beta[active] = np.linalg.lstsq(r, along, rcond=1e-14)[0]
        residual = self.target - basis @ along
        k = float(beta[-1])
        slopes = k * np.column_stack((by_tau, by_alpha))
        outside = slopes - basis @ (basis.T @ slopes)
        return Point(
            at, beta[:-1], k, float(residual @ residual), -outside.T @ residual, outside.T @ outside
        )

    def descend(self, start: FloatArray) -> tuple[Point, bool]:
        """Levenberg-Marquardt in ln tau and alpha; the optimum, and whether it was reached."""
        here, damping = self.point(start), 1e-3
        for _ in range(_STEPS):
            step = self._step(here, damping)
            if np.abs(step).max() <= _SETTLED:
                return here, True
            new = self.point(here.at + step)
            # a point on the flat is as good as its neighbour, to rounding
            if new.sse <= here.sse * (1 + 1e-13):
                if here.sse - new.sse <= 1e-13 * here.sse and np.abs(step).max() < 1e-6:
                    return new, True
                here, damping = new, 0.1 * damping
            else:
                damping = 10 * max(damping, 1e-6)
                if damping > 1e9:
                    return here, True
        return here, False

    def _step(self, here: Point, damping: float) -> FloatArray:
        low, high = self.bounds
        at, scale = here.at, here.curvature.diagonal()
        held = ((at <= low) & (here.gradient > 0)) | ((at >= high) & (here.gradient < 0))
        free = np.flatnonzero(~held & (scale > 0))
        step = np.zeros(2)
        part = here.curvature[np.ix_(free, free)] + np.diag((damping + 1e-15) * scale[free])
        step[free] = -np.linalg.lstsq(part, here.gradient[free], rcond=1e-14)[0]
        step = np.clip(step, -_LONGEST, _LONGEST)
        return np.asarray(np.clip(at + step, low, high) - at)

    def best(self) -> tuple[Point, bool]:
        """The element that leaves least, from the best of a grid of starts."""
        ended = [self.descend(point.at) for point in self.starts(_STARTS)]
        return min(ended, key=lambda pair: pair[0].sse)

    def starts(self, count: int) -> list[Point]:
        """The best points of a grid, no two of nearly the same relaxation time."""
        low, high = self.bounds
        times = np.arange(low[0], high[0], 1 / _PER_FOLD)
        tried = [self.point(np.array([t, slope])) for t in times for slope in _SLOPES]
        found: list[Point] = []
        for point in sorted(tried, key=lambda point: point.sse):
            if all(abs(point.at[0] - one.at[0]) > 2 / _PER_FOLD for one in found):
                found.append(point)
            if len(found) == count:
                break
        return found

    def solution(self, point: Point, *, converged: bool) -> Solution:
        """An element as the arms that stand for it, in the engine's own terms."""
        arms = point.k * self.weights(point.at).value
        low, high = self.bounds
        # an edge of tau or of alpha is one of all its arms
        edge = bool(((point.at <= low + 1e-9) | (point.at >= high - 1e-9)).any())
        return Solution(
            log_tau=self.log_tau,
            groups=self.stack.groups,
            arms=arms[None],
            fixed_names=self.stack.names,
            fixed=point.fixed,
            sse=self.stack.floor + point.sse,
            samples=self.stack.samples,
            requested=len(arms),
            evaluations=0,
            converged=converged and not edge,
            relative_offset=0.0 if converged else 1.0,
            at_bound=np.full(len(arms), edge),
            bounds=self.stack.bounds,
        )


def element_jacobian(blocks: Sequence[Block], columns: Columns, point: Point) -> Jacobian:
    """Residual and derivative by fixed coefficients, k, ln tau and alpha, in the blocks' rows."""
    stack, weights = Stack(blocks), columns.weights(point.at)
    matrix = np.stack(weights, axis=1)
    found = None
    for first in range(0, len(columns.log_tau), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        rows = stack.evaluate(columns.log_tau[part], derivative=False)
        q = len(stack.names)
        if found is None:
            target, fixed = rows.target, rows.phi[:, :q]
            found = np.zeros((len(target), 3))
        found += rows.phi[:, q:] @ matrix[part]
    assert found is not None  # noqa: S101  # a window holds times
    jacobian = np.concatenate((fixed, found * [1.0, point.k, point.k]), axis=1)
    model = jacobian[:, : q + 1] @ np.append(point.fixed, point.k)
    return Jacobian((*stack.names, "k", "ln_tau", "alpha"), jacobian, target - model)
