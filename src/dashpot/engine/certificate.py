"""How far an optimum can be from the best positive spectrum with any number of arms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import Block
from dashpot.engine.descent import Stack
from dashpot.engine.nnls import nonnegative
from dashpot.engine.separable import Solution

GRID = 240
CERTAIN = 1e-9


@dataclass(frozen=True)
class Optimality:
    r"""What one more arm, or any number of arms, could still gain.

    Attributes
    ----------
    optimal : bool
        No positive spectrum whatever, in the window, has an SSE lower by 1e-9 of it.
    gap : float
        (SSE - SSE of the best positive spectrum with any number of arms) / SSE, >= 0.
    lean : float
        :math:`\max_\tau D(\tau)/|r|`, the cosine between the residual and the best further
        column, what is already fitted swept out; <= 0 proves that the gap is zero.
    tau : float or None
        Where that maximum lies, s; None if no further arm would gain anything.
    """

    optimal: bool
    gap: float
    lean: float
    tau: float | None


def certificate(blocks: Sequence[Block], solution: Solution) -> Optimality:
    r"""Compare a solution with the best spectrum of non-negative arms of any number.

    If :math:`D(\tau) = \hat\varphi(\tau)' r \le 0` for all tau, the residual r satisfies the
    optimality conditions of the convex problem over all positive measures, so no positive
    model with any number of arms has a smaller SSE (section 4.3 of N. Boyd, G. Schiebinger,
    B. Recht, *SIAM J. Optim.* 27, 2017). Otherwise the convex problem is solved on a grid of
    ln tau that holds the solution's own arms and is refined where the residual leans.
    """
    stack = Stack(blocks)
    q = len(stack.names)
    base = stack.evaluate(solution.log_tau, derivative=False)
    beta = np.concatenate((solution.fixed, solution.arms.ravel()))
    residual = base.target - base.phi @ beta
    sse = stack.floor + float(residual @ residual)
    grid = np.unique(np.concatenate((np.linspace(*stack.bounds, GRID), solution.log_tau)))
    fixed = base.phi[:, :q]
    # k_inf resting at zero is no free direction; its column then cannot be swept out
    loose = ~(stack.restricted(0, signed=False) & (solution.fixed == 0))
    basis = np.linalg.qr(fixed[:, loose])[0]
    target = base.target - basis @ (basis.T @ base.target)
    best = np.inf
    lean, place = -np.inf, 0.0
    for round_ in range(4):
        columns = stack.evaluate(grid, derivative=False).phi[:, q:]
        swept = columns - basis @ (basis.T @ columns)
        length = np.linalg.norm(swept, axis=0)
        length = np.where(length > 1e-7 * np.linalg.norm(columns, axis=0), length, np.inf)
        swept = swept / length
        if round_ == 0:
            towards = (swept.T @ residual).reshape(len(stack.groups), -1).max(axis=0)
            lean, place = float(towards.max()), float(grid[np.argmax(towards)])
        x = nonnegative(swept.T @ swept, swept.T @ target, limit=200)
        rest = target - swept @ x
        best = min(best, float(rest @ rest))
        grid = _refined(grid, x.reshape(len(stack.groups), -1).sum(axis=0), round_)
    norm = np.sqrt(sse) if sse > 0 else 1.0
    gap = max(0.0, (stack.floor + float(residual @ residual)) - stack.floor - best) / (sse or 1.0)
    nothing = float(residual @ residual) <= stack.grain
    gap = 0.0 if nothing else gap
    optimal = gap <= CERTAIN
    return Optimality(
        optimal=optimal,
        gap=gap,
        lean=float(lean / norm),
        tau=None if optimal else float(np.exp(place)),
    )


def _refined(grid: FloatArray, weight: FloatArray, round_: int) -> FloatArray:
    """The support of the spectrum, and a finer grid around each of its points."""
    support = np.flatnonzero(weight > 0)
    step = (grid[-1] - grid[0]) / GRID / 8.0**round_
    near = grid[support][:, None] + step * np.arange(-8, 9) / 8
    near = np.clip(near, grid[0], grid[-1]).ravel()
    return np.unique(np.concatenate((near, grid[[0, -1]], grid[support])))
