r"""Descents of many small reduced least-squares problems, side by side.

Each is of a few ln tau, everything linear solved. Gauss and Newton's curvature J'J leaves out what
the residual adds, :math:`\sum_i r_i \nabla^2 r_i`, and descends slowly where the residual is no
noise. That part changes little from one problem of a profile to the next, so it is learnt from the
gradients as they change, by the symmetric update of rank one, and believed where it is moderate.
Source: J. E. Dennis, D. M. Gay and R. E. Welsch, ACM Trans. Math. Softw. 7 (1981) 348.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray

_ITERATIONS = 8
_FARTHEST = 1.5
_RIDGE = 1e-13
#: the curvature of the residual that is believed, as parts of J'J
_BENT = -0.8, 1.0
#: a change of gradient along a move, as a part of the whole, that tells of curvature
_TOLD = 1e-4
#: an SSE whose fall is foretold to so many tolerances is taken as fallen
_FORETOLD = 5.0


class Solved(NamedTuple):
    """Trials of ln tau with everything linear solved.

    SSE (A,), linear parameters (A, p), gradient J'r (A, N) and curvature J'J (A, N, N) of the
    reduced residual by the free ln tau.
    """

    sse: FloatArray
    beta: FloatArray
    gradient: FloatArray
    curvature: FloatArray


class Descents:
    """Where each of A descents stands, and where it goes next.

    Parameters
    ----------
    start : array, shape (A, N)
        ln tau.
    linear : int
        Linear parameters p.
    tolerance : array, shape (A,)
        A change of the SSE that does not matter.
    """

    def __init__(self, start: FloatArray, linear: int, tolerance: FloatArray) -> None:
        count, arms = start.shape
        self.here, self.tolerance = start.copy(), tolerance
        self.known = Solved(
            np.full(count, np.inf),
            np.zeros((count, linear)),
            np.zeros((count, arms)),
            np.zeros((count, arms, arms)),
        )
        self.move, self.bent = np.zeros_like(start), np.zeros((count, arms, arms))
        self.promised, self.damping = np.zeros(count), np.full(count, 1e-6)
        self.tried = np.zeros(count, int)

    def start(self, i: int, log_tau: FloatArray) -> None:
        """Begin another problem like the last, or the same elsewhere."""
        self.here[i], self.move[i], self.known.sse[i] = log_tau, 0.0, np.inf
        self.damping[i], self.tried[i] = 1e-6, 0

    def least(self, i: int) -> float:
        """The least SSE of one descent, with what it was about to fall by if that is little."""
        promised = float(self.promised[i])
        little = promised < _FORETOLD * self.tolerance[i]
        return float(self.known.sse[i]) - (promised if little else 0.0)

    def take(self, trial: FloatArray, found: Solved, on: IndexArray) -> BoolArray:
        """Learn from one trial each of the descents `on`; True where that is enough."""
        known = self.known
        gain = known.sse[on] - found.sse
        better = gain > 0
        self.bent[on] = self._bent(trial, found, on, better)
        kept = on[better]
        self.here[kept] = trial[better]
        for mine, new in zip(known, found, strict=True):
            mine[kept] = new[better]
        damping = self.damping[on]
        self.damping[on] = np.where(better, np.maximum(0.1 * damping, 1e-9), 10 * damping)
        self.tried[on] += 1
        self.move[on], self.promised[on] = self._step(on)
        return np.asarray(
            (np.abs(gain) < self.tolerance[on])
            | (self.promised[on] < _FORETOLD * self.tolerance[on])
            | (self.damping[on] > 1e6)
            | (self.tried[on] >= _ITERATIONS)
        )

    def _bent(
        self, trial: FloatArray, found: Solved, on: IndexArray, better: BoolArray
    ) -> FloatArray:
        """What the residual adds to J'J, so that it explains the last move; none if that failed."""
        moved, bent = trial - self.here[on], self.bent[on]
        change = self.known.gradient[on] - found.gradient
        missed = change - ((found.curvature + bent) @ moved[:, :, None])[..., 0]
        along = np.vecdot(missed, moved)
        # the first trial of a problem has no move to explain
        told = np.isfinite(self.known.sse[on]) & (
            np.abs(along) > _TOLD * np.linalg.norm(missed, axis=1) * np.linalg.norm(moved, axis=1)
        )
        missed /= np.sqrt(np.where(told, np.abs(along), np.inf))[:, None]
        learnt = bent + np.sign(along)[:, None, None] * missed[:, :, None] * missed[:, None, :]
        return np.where(better[:, None, None], learnt, 0.0)

    def _step(self, on: IndexArray) -> tuple[FloatArray, FloatArray]:
        """The next move (A, N), and by how much the SSE would fall if it were parabolic."""
        curvature, gradient = self.known.curvature[on], self.known.gradient[on]
        if not curvature.shape[1]:
            return gradient, np.zeros(len(on))
        arms = np.arange(curvature.shape[1])
        size = curvature[:, arms, arms]
        stretch = np.where(size > 0, size, 1.0)
        curvature[:, arms, arms] = size + stretch * _RIDGE + (size <= 0)
        bent = self.bent[on]
        share = np.linalg.eigvals(np.linalg.solve(curvature, bent)).real
        believed = (share.min(axis=1) > _BENT[0]) & (share.max(axis=1) < _BENT[1])
        curvature += np.where(believed[:, None, None], bent, 0.0)
        curvature[:, arms, arms] += stretch * self.damping[on][:, None]
        move = np.linalg.solve(curvature, gradient[:, :, None])[..., 0]
        longest = np.abs(move).max(axis=1, keepdims=True)
        move = move * np.minimum(1.0, _FARTHEST / np.maximum(longest, 1e-300))
        return move, np.vecdot(move, gradient)
