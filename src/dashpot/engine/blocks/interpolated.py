r"""Any long record as some seventy rows, whatever its clock, weights and history.

An arm's column is a linear image of its kernel :math:`e^{-t/\tau}`, and over all relaxation times
of the window those kernels span, to rounding, about sixty dimensions
(:mod:`dashpot.engine.blocks.kernels`): :math:`\varphi(\tau) = \Phi V S^{-1} U' e(\tau)` with Phi
the columns at fixed times, computed once. One triangular factor of :math:`[\Phi V, G, y]` then
turns every later trial into a product of small matrices.
"""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.blocks.block import DesignBlock
from dashpot.engine.blocks.kernels import Kernels

TIMES_PER_FOLD = 9.5
RANK = 1e-15
AT_ONCE = 40
ROWS_AT_ONCE = 2048


def reduced_block(exact: DesignBlock) -> DesignBlock:
    """The same data in orthogonal coordinates, one row per dimension of the kernels' space.

    `exact` has every sample as a row, and a window whose upper end is at least the record's span.
    """
    kernels = Kernels.over(exact.window, per_fold=TIMES_PER_FOLD, rank=RANK)
    count, rank = len(exact.target), kernels.right.shape[1]
    space = np.zeros((count, rank))
    for first in range(0, len(kernels.tau), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        space += exact.columns(kernels.tau[part], False)[0] @ kernels.right[part]
    factor = np.zeros((0, rank + exact.fixed.shape[1] + 1))
    for first in range(0, count, ROWS_AT_ONCE):
        rows = slice(first, first + ROWS_AT_ONCE)
        fresh = (space[rows], exact.fixed[rows], exact.target[rows, None])
        factor = _triangle(np.concatenate((factor, np.concatenate(fresh, axis=1))))
    return DesignBlock(
        target=factor[:-1, -1],
        fixed=factor[:-1, rank:-1],
        fixed_names=exact.fixed_names,
        columns=kernels.columns(factor[:-1, :rank] @ kernels.left),
        window=exact.window,
        floor=float(factor[-1, -1] ** 2),
        samples=exact.samples,
        arm_group=exact.arm_group,
        accuracy=1e-11,
        full=lambda: exact,
    )


def _triangle(rows: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.qr(rows, mode="r"))


NODES = 128


def reduced(block: DesignBlock, *, shortest: float, longest: float) -> DesignBlock:
    """Return the block for relaxation times from `shortest` to `longest`, s, in few rows."""
    low, high = np.log(shortest), np.log(longest)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    u = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    at_nodes = block.columns(np.exp(middle + half * u), False)[0]
    every = np.column_stack((block.fixed, at_nodes))
    basis = np.linalg.qr(every / np.linalg.norm(every, axis=0))[0]
    target = basis.T @ block.target
    rest = block.target - basis @ target
    series = np.linalg.solve(np.polynomial.chebyshev.chebvander(u, NODES - 1), at_nodes.T @ basis)
    slope = np.polynomial.chebyshev.chebder(series) / half

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        place = (np.log(tau) - middle) / half
        powers = np.polynomial.chebyshev.chebvander(place, NODES - 1)
        arms = (powers @ series).T
        return arms, (powers[:, :-1] @ slope).T if derivative else arms

    return DesignBlock(
        target=target,
        fixed=basis.T @ block.fixed,
        fixed_names=block.fixed_names,
        columns=columns,
        window=block.window,
        floor=block.floor + float(rest @ rest),
        samples=block.samples,
        arm_group=block.arm_group,
    )
