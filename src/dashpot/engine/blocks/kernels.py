r"""The space of all relaxation kernels of a window.

With K fixed relaxation times, the kernels at them sampled at some 300 lags as the columns of
:math:`E = U S V'`, and :math:`e(\tau)` any other sampled at the same lags,

.. math:: e^{-t/\tau} = \sum_k c_k(\tau)\, e^{-t/\tau_k} + O(\epsilon), \qquad
    c(\tau) = V S^{-1} U' e(\tau)

A column that is a linear image of its kernel is then the same sum of the images at the fixed times.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.blocks.block import Columns

LAGS = 300


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
    def over(cls, window: tuple[float, float], *, per_fold: float, rank: float) -> Kernels:
        """For relaxation times in `window`, s.

        `per_fold` fixed times per factor e; directions weaker than `rank` of the strongest are
        left out.
        """
        shortest, longest = window
        # kernels scale with the clock: they are made for a window that starts at one
        folds = round(float(np.log(longest / shortest)) + 0.05, 1)
        tau, lags, right, left = _from_one(folds, per_fold, rank)
        return cls(tau * shortest, lags * shortest, right, left)

    def columns(self, operator: FloatArray) -> Columns:
        r"""Columns :math:`A\, e(\tau)` and their slopes, for A of shape (n, L)."""

        def columns(at: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
            x = self.lags[:, None] / at
            decay = np.exp(-x)
            arms = operator @ decay
            return (arms, operator @ (x * decay)) if derivative else (arms, arms)

        return columns


@lru_cache(maxsize=8)
def _from_one(folds: float, per_fold: float, rank: float) -> Kernels:
    tau = np.exp(np.linspace(-0.3, folds + 0.3, round(per_fold * folds)))
    lags = np.concatenate(([0.0], np.exp(np.linspace(np.log(0.25), folds, LAGS))))
    u, s, vt = np.linalg.svd(np.exp(-lags[:, None] / tau), full_matrices=False)
    keep = s > rank * s[0]
    return Kernels(tau, lags, vt[keep].T, u[:, keep].T / s[keep, None])
