r"""The farthest non-negative coefficients that data do not reject.

All :math:`s \ge 0` with :math:`|As - y|^2 \le \rho^2` are a convex set; a linear :math:`c's` is
largest at its edge. With P the columns that carry weight, :math:`A_P = QR`,
:math:`a = R^{-1}Q'y` and :math:`h = R^{-T}c_P`, the farthest point of that face is

.. math:: s_P = a + \lambda R^{-1} h, \qquad \lambda^2 = (\rho^2 - |y - A_P a|^2) / h'h

A primal active set walks towards it: a coefficient that would become negative leaves P, and the
column of the largest :math:`w = A'(y - As) + \lambda c` enters, until no w is positive, which are
the conditions of the optimum. Every point on the way is feasible and none is worse than the one
before, so any earlier answer of the same set is a start. With c = 0 and no ball it is the method of
Lawson and Hanson (*Solving Least Squares Problems*, ch. 23).

The factor is that of the columns, never of their Gram matrix: neighbours on a fine grid of
relaxation times are parallel to six digits.
"""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import FitError
from dashpot.engine.least_squares.descent import triangle

#: a gain below this part of the data is rounding
NOTHING = 1e-13
#: walks per column, at most
PATIENCE = 3
#: columns from one that may enter to the next, at first; later every fourth and every one
STRIDE = 16


def nonnegative_least_squares(
    columns: FloatArray, target: FloatArray, start: FloatArray | None = None
) -> FloatArray:
    """Return the s >= 0 that minimises |A s - y|, shape (m,).

    Parameters
    ----------
    columns : array, shape (n, m)
        A, of unit columns.
    target : array, shape (n,)
        y.
    start : array, shape (m,), optional
        Non-negative; the columns where it is not zero are tried first.
    """
    begin = np.zeros(columns.shape[1]) if start is None else start
    return _walked(columns, target, None, 0.0, begin)


def farthest(
    columns: FloatArray, target: FloatArray, aim: FloatArray, squared: float, start: FloatArray
) -> FloatArray:
    """Return the s >= 0 with |A s - y|^2 <= `squared` that maximises c's, shape (m,).

    Parameters
    ----------
    columns : array, shape (n, m)
        A, of unit columns.
    target : array, shape (n,)
        y.
    aim : array, shape (m,)
        c; only its direction counts.
    squared : float
        The square of the ball's radius.
    start : array, shape (m,)
        Any point of the set.

    Raises
    ------
    FitError
        If there are fewer rows than the answer has terms, or no finite one.
    """
    length = float(np.sqrt(aim @ aim))
    if length == 0.0:
        return start
    return _walked(columns, target, aim / length, squared, start)


def _walked(
    columns: FloatArray, target: FloatArray, aim: FloatArray | None, squared: float, s: FloatArray
) -> FloatArray:
    # a column is a row: so they are picked and factored
    s, rows = s.copy(), np.ascontiguousarray(columns.T)
    active = np.flatnonzero(s > 0)
    nothing = NOTHING * float(np.sqrt(target @ target))
    barred: list[int] = []
    entered, stride = -1, STRIDE
    for _ in range(PATIENCE * columns.shape[1]):
        face = rows[active]
        goal, multiplier = _face(face, target, None if aim is None else aim[active], squared)
        if not np.isfinite(goal.sum()):
            raise FitError(
                "the data bound nothing: they do not follow the motion that they are fitted to; "
                "look whether each column is what it is taken for"
            )
        if goal.min(initial=1.0) <= 0:
            s[active], kept = _as_far_as_allowed(s[active], goal)
            # rounding let it enter: it would leave at once for ever
            if entered >= 0 and s[entered] == 0.0:
                barred.append(entered)
            active = active[kept]
            continue
        s[active] = goal
        gain = _gain(rows, target - goal @ face, aim, multiplier)
        gain[active] = gain[barred] = -np.inf
        # neighbours are alike: a face gets where it belongs sooner by every sixteenth
        entered = stride * int(np.argmax(gain[::stride]))
        while stride > 1 and not gain[entered] > nothing:
            stride //= 4
            entered = stride * int(np.argmax(gain[::stride]))
        if not gain[entered] > nothing:
            break
        if len(active) == len(target):
            raise FitError("the record has too few samples to say what it leaves open; record more")
        active = np.append(active, entered)
    return s


def _gain(
    rows: FloatArray, residual: FloatArray, aim: FloatArray | None, multiplier: float
) -> FloatArray:
    """Return what each column would add; any of the aim is a gain to a face that has none."""
    if np.isinf(multiplier) and aim is not None:
        return aim.copy()
    gain = np.asarray(rows @ residual)
    return gain if aim is None else gain + multiplier * aim


def _face(
    rows: FloatArray, target: FloatArray, aim: FloatArray | None, squared: float
) -> tuple[FloatArray, float]:
    """Return the farthest point of a face, and its multiplier; inf if the face has no aim."""
    count = len(rows)
    if not count:
        return np.zeros(0), 0.0 if aim is None else np.inf
    factor = triangle(np.concatenate((rows, target[None])))
    inverse, along = np.linalg.inv(factor[:count, :count]), factor[:count, -1]
    if aim is None:
        return np.asarray(inverse @ along), 0.0
    h = aim @ inverse
    power = float(h @ h)
    if power == 0.0:
        return np.asarray(inverse @ along), np.inf
    rest = factor[count:, -1]
    multiplier = float(np.sqrt(max(squared - float(rest @ rest), 0.0) / power))
    with np.errstate(invalid="ignore", over="ignore"):  # who asks refuses what is not finite
        return np.asarray(inverse @ (along + multiplier * h)), multiplier


def _as_far_as_allowed(s: FloatArray, goal: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the point on the way to `goal` where a first coefficient vanishes, and the others."""
    falls = np.flatnonzero(goal <= 0)
    left = s[falls]
    share = left / np.where(left > 0, left - goal[falls], 1.0)
    least = share.min()
    kept = np.ones(len(s), dtype=bool)
    kept[falls[share <= least]] = False
    return np.where(kept, s + least * (goal - s), 0.0), kept
