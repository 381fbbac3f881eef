r"""Any long record as some seventy rows, whatever its clock, weights and history.

An arm's column is a linear image of its kernel :math:`e^{-t/\tau}`, and over all relaxation times
of the window those kernels span, to rounding, about sixty dimensions: with K fixed times,

.. math:: e^{-t/\tau} = \sum_k c_k(\tau)\, e^{-t/\tau_k} + O(10^{-13}), \qquad
    c(\tau) = E^+ e(\tau), \quad E = U S V'

where E and e(tau) are sampled at some 300 lags. So :math:`\varphi(\tau) = \Phi V S^{-1} U' e(\tau)`
with Phi the columns at the fixed times, computed once, and one triangular factor of
:math:`[\Phi V, G, y]` turns every later trial into a product of small matrices.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import DesignBlock

TIMES_PER_FOLD = 9.5
LAGS = 300
RANK = 1e-15
AT_ONCE = 40
ROWS_AT_ONCE = 2048


def reduced_block(exact: DesignBlock) -> DesignBlock:
    """The same data in orthogonal coordinates, one row per dimension of the kernels' space.

    `exact` has every sample as a row, and a window whose upper end is at least the record's span.
    """
    shortest, longest = exact.window
    # kernels scale with the clock: they are made for a window that starts at one
    tau, lags, right, left = _kernels(round(float(np.log(longest / shortest)) + 0.05, 1))
    count, rank = len(exact.target), right.shape[1]
    space = np.zeros((count, rank))
    for first in range(0, len(tau), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        space += exact.columns(tau[part] * shortest, False)[0] @ right[part]
    factor = np.zeros((0, rank + exact.fixed.shape[1] + 1))
    for first in range(0, count, ROWS_AT_ONCE):
        rows = slice(first, first + ROWS_AT_ONCE)
        fresh = (space[rows], exact.fixed[rows], exact.target[rows, None])
        factor = _triangle(np.concatenate((factor, np.concatenate(fresh, axis=1))))
    operator = factor[:-1, :rank] @ left
    lag = lags * shortest

    def columns(at: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        x = lag[:, None] / at
        decay = np.exp(-x)
        arms = operator @ decay
        return (arms, operator @ (x * decay)) if derivative else (arms, arms)

    return DesignBlock(
        target=factor[:-1, -1],
        fixed=factor[:-1, rank:-1],
        fixed_names=exact.fixed_names,
        columns=columns,
        window=exact.window,
        floor=float(factor[-1, -1] ** 2),
        samples=exact.samples,
        arm_group=exact.arm_group,
        accuracy=1e-11,
        full=lambda: exact,
    )


def _triangle(rows: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.qr(rows, mode="r"))


@lru_cache(maxsize=8)
def _kernels(folds: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Fixed times, lags, V and S^-1 U' for a window from one to e**folds."""
    tau = np.exp(np.linspace(-0.3, folds + 0.3, round(TIMES_PER_FOLD * folds)))
    lags = np.concatenate(([0.0], np.exp(np.linspace(np.log(0.25), folds, LAGS))))
    u, s, vt = np.linalg.svd(np.exp(-lags[:, None] / tau), full_matrices=False)
    keep = s > RANK * s[0]
    return tau, lags, vt[keep].T, u[:, keep].T / s[keep, None]
