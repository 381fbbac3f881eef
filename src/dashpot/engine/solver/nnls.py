"""Least squares with coefficients that must not be negative."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray


def nonnegative(gram: FloatArray, moment: FloatArray, *, limit: int = 0) -> FloatArray:
    r"""Return the x >= 0 that minimises :math:`x'Gx/2 - m'x`, shape (n,).

    The active-set method of Lawson and Hanson (*Solving Least Squares Problems*, ch. 23) on
    the normal equations: for starts and certificates, not for final digits.

    Parameters
    ----------
    gram : array, shape (n, n)
        A'A, columns of A of comparable norm.
    moment : array, shape (n,)
        A'y.
    limit : int
        Largest number of coefficients that enter; 0 for 3 n.
    """
    n = len(moment)
    x = np.zeros(n)
    passive = np.zeros(n, dtype=bool)
    ridge = 1e-14 * float(np.trace(gram)) / max(n, 1)
    tolerance = 1e-11 * float(np.abs(moment).max(initial=0.0))
    slope = moment.copy()
    for _ in range(limit or 3 * n):
        enter = int(np.argmax(np.where(passive, -np.inf, slope)))
        if passive[enter] or slope[enter] <= tolerance:
            break
        passive[enter] = True
        while True:
            index = np.flatnonzero(passive)
            part = gram[np.ix_(index, index)]
            part[np.diag_indices(len(index))] += ridge
            trial = np.linalg.solve(part, moment[index])
            if trial.min() > 0:
                break
            # walk towards the trial until the first coefficient reaches zero
            fall = trial <= 0
            old = x[index]
            step = (old[fall] / (old[fall] - trial[fall])).min() if old[fall].min() > 0 else 0.0
            x[index] = old + step * (trial - old)
            leaving = index[fall & (x[index] <= 1e-14 * np.abs(x).max(initial=0.0))]
            x[leaving] = 0.0
            passive[leaving] = False
            if not passive.any():
                return x
        x[:] = 0.0
        x[index] = trial
        slope = moment - gram @ x
    return x


def nonnegative_columns(phi: FloatArray, y: FloatArray, restricted: BoolArray) -> BoolArray:
    """Return which columns carry weight in the least squares of y with `restricted` >= 0.

    Active set on the columns themselves: few columns, full accuracy, shape (p,).
    """
    scale = np.linalg.norm(phi, axis=0)
    active: BoolArray = np.asarray(scale > 0)
    for _ in range(4 * len(active)):
        index = np.flatnonzero(active)
        beta = np.linalg.lstsq(phi[:, index], y, rcond=None)[0]
        worst = np.where(restricted[index], beta * scale[index], np.inf)
        if len(worst) and worst.min() <= 0:
            active[index[int(np.argmin(worst))]] = False
            continue
        dropped = np.flatnonzero(~active & restricted & (scale > 0))
        if not len(dropped):
            break
        gain = phi[:, dropped].T @ (y - phi[:, index] @ beta) / scale[dropped]
        if gain.max() <= 1e-10 * np.linalg.norm(y):
            break
        active[dropped[int(np.argmax(gain))]] = True
    return active
