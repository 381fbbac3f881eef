r"""Non-negative least squares of many columns, many of them entering and leaving at once.

At the optimum of :math:`x'Gx/2 - m'x`, x >= 0, every coefficient is either free with zero slope
or zero with slope :math:`m - Gx \le 0`. A few rounds exchange all that violate this together (block
principal pivoting: L. F. Portugal, J. J. Judice, L. N. Vicente, *Math. Comp.* 63, 1994), which
finds most of the support of a spectrum of a hundred columns in three solves; from there the
active-set method of Lawson and Hanson, which cannot cycle, needs some ten or twenty more.
"""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray

_ROUNDS = 3
_NOTHING = 1e-11


def pivoted(gram: FloatArray, moment: FloatArray) -> FloatArray:
    """Return the x >= 0 that minimises x'Gx/2 - m'x, shape (n,).

    Parameters
    ----------
    gram : array, shape (n, n)
        A'A, columns of A of comparable norm.
    moment : array, shape (n,)
        A'y.
    """
    problem = _Problem(gram, moment)
    free: BoolArray = moment > 0
    for _ in range(_ROUNDS):
        x = problem.solved(free)
        wrong = np.where(free, x < 0, moment - gram @ x > problem.nothing)
        if not wrong.any():
            return x
        free = free ^ wrong
    return problem.finished(free)


class _Problem:
    def __init__(self, gram: FloatArray, moment: FloatArray) -> None:
        self.gram, self.moment = gram, moment
        self.ridge = 1e-14 * float(np.trace(gram)) / max(len(moment), 1)
        self.nothing = _NOTHING * float(np.abs(moment).max(initial=0.0))

    def solved(self, free: BoolArray) -> FloatArray:
        """The minimum over the free coefficients, of either sign, the others zero."""
        index = np.flatnonzero(free)
        part = self.gram[np.ix_(index, index)]
        part.ravel()[:: len(index) + 1] += self.ridge
        x = np.zeros(len(self.moment))
        x[index] = np.linalg.solve(part, self.moment[index])
        return x

    def finished(self, free: BoolArray) -> FloatArray:
        """The optimum, from a guess of which coefficients are free."""
        x = self.solved(free)
        while (x[free] <= 0).any():
            free = free & (x > 0)
            x = self.solved(free)
        for _ in range(3 * len(x)):
            slope = np.where(free, -np.inf, self.moment - self.gram @ x)
            enter = int(np.argmax(slope))
            if slope[enter] <= self.nothing:
                break
            free[enter] = True
            x = self.reached(x, free)
        return x

    def reached(self, x: FloatArray, free: BoolArray) -> FloatArray:
        """Walk from x to the minimum over `free`; what reaches zero on the way leaves it."""
        while True:
            trial = self.solved(free)
            fall = free & (trial <= 0)
            if not fall.any():
                return trial
            shares = x[fall] / np.maximum(x[fall] - trial[fall], 1e-300)
            x = x + float(shares.min()) * (trial - x)
            leaving = fall & (x <= 1e-14 * np.abs(x).max(initial=0.0))
            x[leaving] = 0.0
            free &= ~leaving
