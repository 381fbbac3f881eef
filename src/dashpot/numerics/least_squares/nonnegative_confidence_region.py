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
relaxation times are parallel to six digits. A face does not hang on what is asked, and questions of
neighbouring times or frequencies end on the same ones: each is factored once, and a column that
enters is made orthogonal to those that are there (twice: Daniel, Gragg, Kaufman and Stewart,
*Math. Comp.* 30, 1976, 772).
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from functools import partial
from math import isfinite, isinf, sqrt
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.errors import FitError

#: a gain below this part of the data is rounding
NOTHING = 1e-13
#: walks per column, at most
PATIENCE = 3
#: what is left of a unit column that enters, below which its digits are rounding
DEPENDENT = 1e-9
#: square of what a column may lose when another leaves by a reflection
LOST = 1e-26
#: faces that are remembered
REMEMBERED = 512


class ActiveSet(NamedTuple):
    """Columns that carry weight, A_P = QR.

    Attributes
    ----------
    active : array, shape (k,)
        Which.
    basis : array, shape (k, n)
        Q'.
    factor : array, shape (k, k)
        R, which need not be triangular.
    inverse : array, shape (k, k)
        R^-1.
    along : array, shape (k,)
        Q'y.
    rest : array, shape (n,)
        What these columns leave of y.
    least : float
        Its square.
    """

    active: IndexArray
    basis: FloatArray
    factor: FloatArray
    inverse: FloatArray
    along: FloatArray
    rest: FloatArray
    least: float

    def find_farthest_point(
        self, aim: FloatArray | None, squared: float
    ) -> tuple[FloatArray, float, FloatArray]:
        """Return its farthest point, the multiplier (inf without an aim), and what is left of y."""
        if aim is None or not len(self.active):
            free = 0.0 if aim is None else np.inf
            return np.asarray(self.inverse @ self.along), free, self.rest
        h = aim[self.active] @ self.inverse
        power = float(h @ h)
        if power == 0.0:
            return np.asarray(self.inverse @ self.along), np.inf, self.rest
        multiplier = sqrt(max(squared - self.least, 0.0) / power)
        step = multiplier * h
        return self.inverse @ (self.along + step), multiplier, self.rest - step @ self.basis


class NonnegativeConfidenceRegion:
    """Columns A of unit length and data y, of which non-negative s are asked.

    Parameters
    ----------
    columns : array, shape (n, m)
        A, of unit columns.
    target : array, shape (n,)
        y.
    least_gain : float
        A walk ends where no column gains more, in the unit of y: 0 walks to the optimum.
    """

    def __init__(self, columns: FloatArray, target: FloatArray, least_gain: float = 0.0) -> None:
        # a column is a row: so they are picked and factored
        self._rows, self._target = np.ascontiguousarray(columns.T), target
        self._nothing = max(NOTHING * sqrt(target @ target), least_gain)
        self._met: OrderedDict[bytes, ActiveSet] = OrderedDict()

    def least(self, start: FloatArray | None = None) -> FloatArray:
        """Return the s >= 0 that minimises |A s - y|, shape (m,).

        Parameters
        ----------
        start : array, shape (m,), optional
            Non-negative; the columns where it is not zero are tried first.
        """
        return self._search_active_sets(
            None, 0.0, np.zeros(len(self._rows)) if start is None else start
        )

    def find_farthest_point(self, aim: FloatArray, squared: float, start: FloatArray) -> FloatArray:
        """Return the s >= 0 with |A s - y|^2 <= `squared` that maximises c's, shape (m,).

        Parameters
        ----------
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
        length = sqrt(aim @ aim)
        if length == 0.0:
            return start
        with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is refused
            return self._search_active_sets(aim / length, squared, start)

    def _search_active_sets(
        self, aim: FloatArray | None, squared: float, start: FloatArray
    ) -> FloatArray:
        s, barred = start.copy(), list[int]()
        face, entered = self._get_face(np.flatnonzero(s > 0)), -1
        for _ in range(PATIENCE * len(self._rows)):
            active = face.active
            goal, multiplier, residual = face.find_farthest_point(aim, squared)
            if len(active) and goal.min() <= 0:
                s[active], mask = _as_far_as_allowed(s[active], goal)
                # rounding let it enter: it would leave at once for ever
                if entered >= 0 and s[entered] == 0.0:
                    barred.append(entered)
                face = self._get_cached_face(
                    active[mask], partial(self._remove_columns, face, mask)
                )
                continue
            s[active] = goal
            gain = self._gain(residual, aim, multiplier)
            gain[active] = gain[barred] = -np.inf
            entered = int(gain.argmax())
            if not gain[entered] > self._nothing:
                break
            if len(active) == len(self._target):
                raise FitError(
                    "the record has too few samples to say what it leaves open; record more"
                )
            more = np.concatenate((active, [entered]))
            face = self._get_cached_face(more, partial(self._append_column, face, more))
        if not isfinite(s.sum()):
            raise FitError(
                "the data bound nothing: they do not follow the motion that they are fitted "
                "to; look whether each column is what it is taken for"
            )
        return s

    def _gain(self, residual: FloatArray, aim: FloatArray | None, multiplier: float) -> FloatArray:
        """Return what each column would add; any of the aim is a gain to a face that has none."""
        if aim is not None and isinf(multiplier):
            return aim.copy()
        gain = np.asarray(self._rows @ residual)
        return gain if aim is None else gain + multiplier * aim

    def _get_cached_face(self, active: IndexArray, factored: Callable[[], ActiveSet]) -> ActiveSet:
        """Return the face of these columns, factored where it was not met before."""
        key = np.sort(active).tobytes()
        face = self._met.get(key)
        if face is not None:
            self._met.move_to_end(key)
            return face
        face = self._met[key] = factored()
        if len(self._met) > REMEMBERED:
            self._met.popitem(last=False)
        return face

    def _get_face(self, active: IndexArray) -> ActiveSet:
        return self._get_cached_face(active, partial(self._build_face, active))

    def _build_face(self, active: IndexArray) -> ActiveSet:
        basis, factor = np.linalg.qr(self._rows[active].T)
        return self._face(active, np.ascontiguousarray(basis.T), factor)

    def _face(self, active: IndexArray, basis: FloatArray, factor: FloatArray) -> ActiveSet:
        along: FloatArray = basis @ self._target
        rest: FloatArray = self._target - along @ basis
        inverse = np.asarray(np.linalg.inv(factor))
        return ActiveSet(active, basis, factor, inverse, along, rest, float(rest @ rest))

    def _remove_columns(self, face: ActiveSet, mask: BoolArray) -> ActiveSet:
        """Return a face with fewer columns."""
        active, factor = face.active[mask], face.factor[:, mask]
        if len(active) == len(mask) - 1:
            # what only the one that leaves could add is turned to the last direction
            mirror = face.inverse[int(mask.argmin())]
            mirror = mirror / sqrt(mirror @ mirror)
            mirror[-1] += 1.0 if mirror[-1] > 0 else -1.0
            mirror *= sqrt(2.0 / (mirror @ mirror))
            turned = factor - np.multiply.outer(mirror, mirror @ factor)
            if turned[-1] @ turned[-1] <= LOST:
                basis = face.basis - np.multiply.outer(mirror, mirror @ face.basis)
                return self._face(active, basis[:-1], turned[:-1])
        turn, factor = np.linalg.qr(factor)
        return self._face(active, turn.T @ face.basis, factor)

    def _append_column(self, face: ActiveSet, active: IndexArray) -> ActiveSet:
        """Return a face with one column more, the last."""
        column, count = self._rows[active[-1]], len(face.active)
        once = face.basis @ column
        new = column - once @ face.basis
        again = face.basis @ new
        new -= again @ face.basis
        length = sqrt(new @ new)
        if not length > DEPENDENT:
            return self._build_face(active)
        new /= length
        basis = np.empty((count + 1, len(new)))
        basis[:-1], basis[-1] = face.basis, new
        factor, inverse = np.zeros((2, count + 1, count + 1))
        factor[:-1, :-1], factor[:-1, -1], factor[-1, -1] = face.factor, once + again, length
        inverse[:-1, :-1], inverse[-1, -1] = face.inverse, 1 / length
        inverse[:-1, -1] = face.inverse @ factor[:-1, -1] / -length
        along = float(new @ face.rest)
        rest = face.rest - along * new
        more = np.concatenate((face.along, [along]))
        return ActiveSet(active, basis, factor, inverse, more, rest, float(rest @ rest))


def _as_far_as_allowed(s: FloatArray, goal: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the point on the way to `goal` where a first coefficient vanishes, and the others."""
    way = zip(s.tolist(), goal.tolist(), strict=True)  # so few are faster one by one
    shares = [(old / (old - new) if old > 0 else 0.0) if new <= 0 else np.inf for old, new in way]
    least = min(shares)
    mask = np.array(shares) > least
    return np.where(mask, s + least * (goal - s), 0.0), mask
