"""How far an optimum can be from the best positive spectrum with any number of arms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.log_tau_descent import Stack, descend
from dashpot.numerics.exponential_fit.starting_points import Grid
from dashpot.numerics.exponential_fit.variable_projection import Solution

GRID = 96
ROUNDS = 3
ONE_ARM = 0.1
CERTAIN = 1e-6


@dataclass(frozen=True)
class OptimalityCertificate:
    r"""What one more arm, or any number of arms, could still gain.

    Attributes
    ----------
    optimal : bool
        No positive spectrum whatever, in the window, has an SSE lower by 1e-6 of it.
    gap : float
        (SSE - SSE of the best positive spectrum with any number of arms) / SSE, >= 0.
    dual_gradient : float
        :math:`\max_\tau D(\tau)/|r|`, the cosine between the residual and the best further
        column, what is already fitted swept out; <= 0 proves that the gap is zero.
    tau : float or None
        Where that maximum lies, s; None if no further arm would gain anything.
    """

    optimal: bool
    gap: float
    dual_gradient: float
    tau: float | None


def certificate(blocks: Sequence[DataBlock], solution: Solution) -> OptimalityCertificate:
    r"""Compare a solution with the best spectrum of non-negative arms of any number.

    If :math:`D(\tau) = \hat\varphi(\tau)' r \le 0` for all tau, the residual r satisfies the
    optimality conditions of the convex problem over all positive measures, so no positive
    model with any number of arms has a smaller SSE (section 4.3 of N. Boyd, G. Schiebinger,
    B. Recht, *SIAM J. Optim.* 27, 2017). Otherwise the convex problem is solved on a grid of
    ln tau that holds the solution's own arms, refined around its support, and polished off it.
    """
    stack = Stack(blocks)
    groups = len(stack.groups)
    # k_inf resting at zero is no free direction: its column then is not swept out
    loose = ~(stack.get_nonnegative_mask(0, signed=False) & (solution.fixed == 0))
    grid, support = np.linspace(*stack.bounds, GRID), solution.log_tau
    best, remainder, dual_gradient, place = np.inf, 0.0, -np.inf, 0.0
    for round_ in range(ROUNDS):
        together = np.concatenate((solution.log_tau, grid))
        near = np.append(np.ones(solution.order, bool), np.isin(grid, support))
        offered = Grid(stack, log_tau=together, loose=loose, near=near)
        if round_ == 0:
            length = offered.length.reshape(groups, -1)[:, : solution.order]
            values = np.zeros((groups, len(together)))
            values[:, : solution.order] = solution.arms * np.where(np.isfinite(length), length, 0.0)
            residual = offered.aim - offered.columns @ values.ravel()
            remainder = float(residual @ residual)
            towards = (offered.columns.T @ residual).reshape(groups, -1).max(axis=0)
            dual_gradient, place = float(towards.max()), float(together[np.argmax(towards)])
        best = min(best, offered.residual_sse)
        weight = offered.spectrum.sum(axis=0)
        support = together[weight > 0]
        grid = _make_refined_grid(support, round_, stack.bounds)
    sse = stack.floor + remainder
    # of a gap that is seen a few digits will do
    flat = 1e-3 * max(CERTAIN, (remainder - best) / sse if sse > 0 else 0.0)
    best = min(best, _compute_merged_sse(stack, together, weight, flat))
    gap = 0.0 if remainder <= stack.nothing else max(0.0, remainder - best) / sse
    optimal = gap <= CERTAIN
    return OptimalityCertificate(
        optimal=optimal,
        gap=float(gap),
        dual_gradient=float(dual_gradient / np.sqrt(sse)) if sse > 0 else 0.0,
        tau=None if optimal else float(np.exp(place)),
    )


def _make_refined_grid(support: FloatArray, round_: int, bounds: tuple[float, float]) -> FloatArray:
    """The support of a spectrum, and a finer grid around each of its points."""
    step = (bounds[1] - bounds[0]) / GRID / 8.0**round_
    near = support[:, None] + step * np.arange(-8, 9) / 8
    return np.array(sorted({*np.clip(near, *bounds).flat, *bounds}))


def _compute_merged_sse(stack: Stack, grid: FloatArray, weight: FloatArray, flat: float) -> float:
    """SSE after the spectrum's arms, neighbours merged, have moved off the grid together.

    To `flat`, a part of it.
    """
    order = np.flatnonzero(weight > 0)
    order = order[np.argsort(grid[order], kind="stable")]
    if not len(order):
        return np.inf
    runs = np.split(order, np.flatnonzero(np.diff(grid[order]) > ONE_ARM) + 1)
    start = np.array([weight[run] @ grid[run] / weight[run].sum() for run in runs])
    restricted = stack.get_nonnegative_mask(len(start), signed=False)
    local = descend(stack, start, restricted=restricted, flat=flat)
    return np.inf if local is None else local.point.sse
