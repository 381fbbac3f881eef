r"""The space of all relaxation kernels of a window.

With K fixed relaxation times, the kernels at them sampled at some 300 lags as the columns of
:math:`E = U S V'`, and :math:`e(\tau)` any other sampled at the same lags,

.. math:: e^{-t/\tau} = \sum_k c_k(\tau)\, e^{-t/\tau_k} + O(\epsilon), \qquad
    c(\tau) = V S^{-1} U' e(\tau)

A column that is a linear image of its kernel is then the same sum of the images at the fixed times,
computed once:

.. math:: \varphi(\tau) = \Phi V S^{-1} U' e(\tau)

Over all relaxation times of a window the kernels span, to rounding, about sixty dimensions, so that
any long record, whatever its clock, weights and history, is a block of some seventy rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.numerics.design_matrices.block import Columns, DataBlock, Rows, design_rows
from dashpot.numerics.design_matrices.data_compression import ACCURACY

LAGS = 300
TIMES_PER_FOLD = 9.5
RANK = 1e-15
#: the same where a few digits do
FEW_TIMES_PER_FOLD, FEW_RANK, FEW_DIGITS = 5.0, 1e-9, 1e-7
AT_ONCE = 16
ROWS_AT_ONCE = 2048


class Kernels(NamedTuple):
    """Fixed relaxation times and what turns their columns into any other's.

    Attributes
    ----------
    tau : array, shape (K,)
        s.
    lags : array, shape (L,)
        s.
    right : array, shape (K, r)
        V: the columns at the fixed times times this span all others.
    left : array, shape (r, L)
        S^-1 U': turns e(tau) into coordinates of that span.
    """

    tau: FloatArray
    lags: FloatArray
    right: FloatArray
    left: FloatArray

    @classmethod
    def from_window(cls, window: tuple[float, float], *, per_fold: float, rank: float) -> Kernels:
        """For relaxation times in `window`, s.

        `per_fold` fixed times per factor e; directions weaker than `rank` of the strongest are
        left out.
        """
        shortest, longest = window
        # kernels scale with the clock: they are made for a window that starts at one
        folds = round(float(np.log(longest / shortest)) + 0.05, 1)
        tau, lags, right, left = _make_unit_kernels(folds, per_fold, rank)
        return cls(tau * shortest, lags * shortest, right, left)

    def space(
        self, exact: DataBlock, change: Callable[[FloatArray], FloatArray] = np.asarray
    ) -> FloatArray:
        r"""The space :math:`\Phi V` of a block that has every sample as a row, shape (n, r).

        `change` is a linear one of the rows.
        """
        out = np.zeros(())
        for first in range(0, len(self.tau), AT_ONCE):
            part = slice(first, first + AT_ONCE)
            arms = change(exact.evaluate(np.log(self.tau[part]), False).arms)
            out = out + arms @ self.right[part]
        return out

    def columns(self, operator: FloatArray) -> Columns:
        r"""Columns :math:`A\, S^{-1} U' e(\tau)` and their slopes, for A of shape (n, r)."""
        full = operator @ self.left

        def columns(at: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
            x = self.lags[:, None] / at
            decay = np.exp(-x)
            arms = full @ decay
            return (arms, full @ (x * decay)) if derivative else (arms, arms)

        return columns

    def rows(self, factor: FloatArray) -> Rows:
        """Rows from the triangular factor of columns in this space, fixed columns and target."""
        rank = self.right.shape[1]
        columns = self.columns(factor[:-1, :rank])
        return design_rows(factor[:-1, -1], factor[:-1, rank:-1], columns)


@lru_cache(maxsize=8)
def _make_unit_kernels(folds: float, per_fold: float, rank: float) -> Kernels:
    tau = np.exp(np.linspace(-0.3, folds + 0.3, round(per_fold * folds)))
    lags = np.concatenate(([0.0], np.exp(np.linspace(np.log(0.25), folds, LAGS))))
    u, s, vt = np.linalg.svd(np.exp(-lags[:, None] / tau), full_matrices=False)
    keep = s > rank * s[0]
    return Kernels(tau, lags, vt[keep].T, u[:, keep].T / s[keep, None])


def reduced_block(exact: DataBlock, *, reach: tuple[float, float] | None = None) -> DataBlock:
    r"""The same data in orthogonal coordinates, one row per dimension of the kernels' space.

    One triangular factor of :math:`[\Phi V, G, y]` turns every later trial into a product of small
    matrices.

    Parameters
    ----------
    exact : DataBlock
        Every sample as a row; its window's upper end is at least the record's span.
    reach : (float, float), optional
        Relaxation times to be evaluated, s; those of the window, if left out.
    """
    kernels = Kernels.from_window(reach or exact.window, per_fold=TIMES_PER_FOLD, rank=RANK)
    target, fixed, *_ = exact.evaluate(np.zeros(0), False)
    every = np.concatenate((kernels.space(exact), fixed, target[:, None]), axis=1)
    factor = every[:0]
    for first in range(0, len(every), ROWS_AT_ONCE):
        rows = np.concatenate((factor, every[first : first + ROWS_AT_ONCE]))
        factor = np.asarray(np.linalg.qr(rows, mode="r"))
    factor = _to_its_floor(factor)
    return replace(
        exact,
        rows=kernels.rows(factor),
        floor=float(factor[-1, -1] ** 2),
        accuracy=ACCURACY,
        full=lambda: exact,
        widen=lambda name, column: reduced_block(exact.with_column(name, column), reach=reach),
    )


def _to_its_floor(factor: FloatArray) -> FloatArray:
    """The factor whose last row is what no column reaches: nothing, where rows are few."""
    rows, columns = factor.shape
    return np.concatenate((factor, np.zeros((1, columns)))) if rows < columns else factor


def compact_block(block: DataBlock, *, excess: float) -> DataBlock:
    r"""A block in as few rows as its kernels span, for many trials that need few digits.

    The columns at fixed relaxation times come from the block itself, whatever its form, and all
    others from theirs.

    Parameters
    ----------
    block : DataBlock
        Of any rows, compressed or not.
    excess : float
        Relaxation times up to this factor outside the window are to be evaluated.
    """
    shortest, longest = block.window
    kernels = Kernels.from_window(
        (shortest / excess, longest * excess), per_fold=FEW_TIMES_PER_FOLD, rank=FEW_RANK
    )
    evaluation = block.evaluate(np.log(kernels.tau), False)
    every = (evaluation.arms @ kernels.right, evaluation.fixed, evaluation.target[:, None])
    factor = _to_its_floor(np.asarray(np.linalg.qr(np.concatenate(every, axis=1), mode="r")))
    return replace(
        block,
        rows=kernels.rows(factor),
        floor=block.floor + float(factor[-1, -1] ** 2),
        accuracy=FEW_DIGITS,
        rotated_basis=False,
        sampling=None,
        full=None,
        widen=None,
    )
