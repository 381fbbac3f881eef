r"""Descents of many small reduced least-squares problems, side by side.

Each is of a few ln tau, everything linear solved. Gauss and Newton's curvature J'J leaves out what
the residual adds, :math:`\sum_i r_i \nabla^2 r_i`, and descends slowly where the residual is no
noise. With it the step is Newton's; it is believed where it is a moderate part of J'J, so that the
sum is a parabola that opens upward.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray

_ITERATIONS = 8
#: the longest move, and after one that failed, as a part of that
_FARTHEST, _NEARER = 1.5, 0.25
RIDGE = 1e-13
#: the curvature of the residual that is believed, as parts of J'J
_BENT = -0.9, 4.0
#: an SSE whose fall is foretold to so many tolerances is taken as fallen: Newton is right to a few
#: hundredths of it
_FORETOLD = 50.0


class SolvedTrials(NamedTuple):
    """Trials of ln tau with everything linear solved.

    SSE (A,), linear parameters (A, p), gradient J'r (A, N) and curvature J'J (A, N, N) of the
    reduced residual by the free ln tau, and what the residual adds to the curvature (A, N, N).
    """

    sse: FloatArray
    beta: FloatArray
    gradient: FloatArray
    curvature: FloatArray
    bent: FloatArray


class BatchedDescent:
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
        self.known = SolvedTrials(
            np.full(count, np.inf),
            np.zeros((count, linear)),
            np.zeros((count, arms)),
            np.zeros((count, arms, arms)),
            np.zeros((count, arms, arms)),
        )
        self.move = np.zeros_like(start)
        self.promised, self.damping = np.zeros(count), np.full(count, 1e-6)
        self.tried, self.reach = np.zeros(count, int), np.full(count, _FARTHEST)

    def start(self, i: int, log_tau: FloatArray) -> None:
        """Begin another problem like the last, or the same elsewhere."""
        self.here[i], self.move[i], self.known.sse[i] = log_tau, 0.0, np.inf
        self.damping[i], self.tried[i], self.reach[i] = 1e-6, 0, _FARTHEST

    def best(self, i: int) -> tuple[float, FloatArray]:
        """The least SSE of one descent and its ln tau, a last move foretold if that is little."""
        sse, promised = float(self.known.sse[i]), float(self.promised[i])
        if promised < _FORETOLD * self.tolerance[i]:
            return sse - promised, self.here[i] + self.move[i]
        return sse, self.here[i]

    def take(self, trial: FloatArray, trials: SolvedTrials, on: IndexArray) -> BoolArray:
        """Learn from one trial each of the descents `on`; True where that is enough."""
        solved_trials = self.known
        gain = solved_trials.sse[on] - trials.sse
        better = gain > 0
        retained = on[better]
        self.here[retained] = trial[better]
        for mine, new in zip(solved_trials, trials, strict=True):
            mine[retained] = new[better]
        damping = self.damping[on]
        self.damping[on] = np.where(better, np.maximum(0.1 * damping, 1e-9), 10 * damping)
        # where the parabola has failed it is believed nearby only
        gone = np.abs(self.move[on]).max(axis=1, initial=0.0)
        self.reach[on] = np.where(
            better, np.minimum(2.0 * np.maximum(gone, self.reach[on]), _FARTHEST), _NEARER * gone
        )
        self.tried[on] += 1
        self.move[on], self.promised[on] = self._step(on)
        return np.asarray(
            (np.abs(gain) < self.tolerance[on])
            | (self.promised[on] < _FORETOLD * self.tolerance[on])
            | (self.damping[on] > 1e6)
            | (self.tried[on] >= _ITERATIONS)
        )

    def _step(self, on: IndexArray) -> tuple[FloatArray, FloatArray]:
        """The next move (A, N), and by how much the SSE would fall if it were parabolic."""
        curvature, gradient = self.known.curvature[on], self.known.gradient[on]
        if not curvature.shape[1]:
            return gradient, np.zeros(len(on))
        arms = np.arange(curvature.shape[1])
        size = curvature[:, arms, arms]
        stretch = np.where(size > 0, size, 1.0)
        curvature[:, arms, arms] = size + stretch * RIDGE + (size <= 0)
        both = np.concatenate((self.known.bent[on], gradient[:, :, None]), axis=2)
        solved = np.linalg.solve(curvature, both)
        share, first = solved[..., :-1], solved[..., -1]
        # what the move takes off the residual bends nothing where it leads
        taken = np.vecdot(first, gradient) / np.maximum(self.known.sse[on], 1e-300)
        remainder = np.maximum(1.0 - taken * taken, 0.0)[:, None, None]
        believed = _moderate(remainder * share)[:, None, None]
        curvature += np.where(believed, remainder, 0.0) * self.known.bent[on]
        curvature[:, arms, arms] += stretch * self.damping[on][:, None]
        move = np.linalg.solve(curvature, gradient[:, :, None])[..., 0]
        longest = np.abs(move).max(axis=1, keepdims=True)
        move = move * np.minimum(1.0, self.reach[on][:, None] / np.maximum(longest, 1e-300))
        return move, np.vecdot(move, gradient)


def _moderate(share: FloatArray) -> BoolArray:
    """Which of some curvatures of residuals, in parts of J'J, are moderate."""
    # the eigenvalues of the ratio are real, and none is larger than the root of their squares
    least, most = _BENT
    believed = (share * share.swapaxes(1, 2)).sum(axis=(1, 2)) < min(-least, most) ** 2
    if not believed.all():
        doubted = np.linalg.eigvals(share[~believed]).real
        believed[~believed] = (doubted.min(axis=1) > least) & (doubted.max(axis=1) < most)
    return np.asarray(believed)
