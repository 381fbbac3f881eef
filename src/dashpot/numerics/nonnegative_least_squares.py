"""Non-negative least squares and its confidence region."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from functools import partial
from math import isfinite, isinf, sqrt
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.errors import FitError

# Non-negative least squares.
#
# At the optimum of :math:`x'Gx/2 - m'x`, x >= 0, every coefficient is either free with zero slope
# or zero with slope :math:`m - Gx \le 0`. A few rounds exchange all that violate this together
# (block principal pivoting: L. F. Portugal, J. J. Judice, L. N. Vicente, *Math. Comp.* 63, 1994),
# which finds most of the support of a spectrum of a hundred columns in three solves; from there the
# active-set method of Lawson and Hanson (*Solving Least Squares Problems*, ch. 23), which cannot
# cycle, needs some ten or twenty more. `scipy.optimize.nnls` saves half a millisecond of the one
# that this takes, and its import costs a hundred fits.


ITERATIONS = 3
ZERO_SLOPE = 1e-11
#: columns that are dependent; and so many that must not be negative, of which most carry nothing
DEPENDENT_COLUMN, MANY_COLUMNS = 1e-13, 8


def solve_linear(
    A: FloatArray,
    y: FloatArray,
    positive: bool | BoolArray = False,
    likely_positive: BoolArray | None = None,
) -> tuple[FloatArray, Callable[[], FloatArray]]:
    r"""Return the beta that minimises |y - A beta|, and a basis of the columns that carry weight.

    Which of the coefficients that must not be negative are zero is asked first where there are
    many, else only if one of them is negative without. Of few the digits are those of a QR factor
    of the others. Many are mostly so nearly dependent that such digits are rounding, down to their
    signs, and to leave out what turns negative costs the optimum: theirs are those of the normal
    equations, which leave as little. Of dependent columns the first carry the weight.

    Parameters
    ----------
    A : array, shape (n, q)
    y : array, shape (n,)
    positive : bool or array, shape (q,)
        Which coefficients must not be negative.
    likely_positive : array, shape (q,), optional
        Which coefficients are likely above zero: of many it spares most solves.

    Returns
    -------
    beta : array, shape (q,)
    basis : callable
        ``basis()``, orthonormal, shape (n, r), computed when called.
    """
    column_norms = np.sqrt(np.einsum("ij,ij->j", A, A))
    column_norms[column_norms == 0] = 1.0
    unit, is_nonnegative = A / column_norms, np.zeros(A.shape[1], dtype=bool) | positive
    if int(is_nonnegative.sum()) > MANY_COLUMNS:
        beta = _solve_mixed_sign(unit, y, is_nonnegative, likely_positive)
        is_positive = (beta > 0) | ~is_nonnegative
        return beta / column_norms, lambda: _solve_unit_columns(unit[:, is_positive], y)[1]
    is_used, beta, has_searched = (
        np.ones(len(is_nonnegative), dtype=bool),
        np.zeros(len(is_nonnegative)),
        False,
    )
    while True:
        beta[:] = 0.0
        beta[is_used], basis = _solve_unit_columns(unit[:, is_used], y)
        is_negative = (beta < 0) & is_nonnegative
        if not is_negative.any():
            break
        is_used = (
            is_used & ~is_negative if has_searched else nonnegative_columns(unit, y, is_nonnegative)
        )
        has_searched = True
    return beta / column_norms, lambda: basis


def _solve_mixed_sign(
    unit: FloatArray, y: FloatArray, is_nonnegative: BoolArray, likely_positive: BoolArray | None
) -> FloatArray:
    """Return the beta of many columns that must not be negative, the free ones taken off."""
    if is_nonnegative.all():
        return solve_nonnegative(unit.T @ unit, unit.T @ y, likely_positive)
    Q, factor = np.linalg.qr(unit[:, ~is_nonnegative])
    A, beta = unit[:, is_nonnegative], np.zeros(len(is_nonnegative))
    columns_in_free, target_in_free = Q.T @ A, Q.T @ y
    A, residual = A - Q @ columns_in_free, y - Q @ target_in_free
    beta[is_nonnegative] = solve_nonnegative(
        A.T @ A,
        A.T @ residual,
        None if likely_positive is None else likely_positive[is_nonnegative],
    )
    beta[~is_nonnegative] = np.linalg.lstsq(
        factor, target_in_free - columns_in_free @ beta[is_nonnegative], rcond=DEPENDENT_COLUMN
    )[0]
    return beta


def _solve_unit_columns(A: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least squares by columns of unit length, and a basis of those that carry weight."""
    basis, factor = np.linalg.qr(A)
    is_dependent = np.ones(A.shape[1], dtype=bool)
    is_dependent[: len(factor)] = np.abs(factor.diagonal()) <= DEPENDENT_COLUMN
    if not is_dependent.any():
        coefficients = basis.T @ y
        return np.linalg.solve(factor, coefficients) if len(coefficients) else coefficients, basis
    beta = np.zeros(A.shape[1])
    beta[~is_dependent], basis = _solve_unit_columns(A[:, ~is_dependent], y)
    return beta, basis


def solve_nonnegative(
    gram: FloatArray, moment: FloatArray, likely_positive: BoolArray | None = None
) -> FloatArray:
    """Return the x >= 0 that minimises x'Gx/2 - m'x, shape (n,).

    On the normal equations: for starts, certificates and tables, not for final digits.

    Parameters
    ----------
    gram : array, shape (n, n)
        A'A, columns of A of comparable norm.
    moment : array, shape (n,)
        A'y.
    likely_positive : array, shape (n,), optional
        Which coefficients are likely above zero: it spares most solves.
    """
    count = len(moment)
    regularised = gram + 1e-14 * float(np.trace(gram)) / max(count, 1) * np.eye(count)
    zero_slope = ZERO_SLOPE * float(np.abs(moment).max(initial=0.0))

    def solve_free_coefficients(is_free: BoolArray) -> FloatArray:
        """Return the minimum over the free coefficients, of either sign, the others zero."""
        index = np.flatnonzero(is_free)
        x = np.zeros(count)
        x[index] = np.linalg.solve(regularised[index[:, None], index], moment[index])
        return x

    is_free: BoolArray = moment > 0 if likely_positive is None else likely_positive.copy()
    for _ in range(ITERATIONS if likely_positive is None else 0):
        x = solve_free_coefficients(is_free)
        is_wrong = np.where(is_free, x < 0, moment - gram @ x > zero_slope)
        if not is_wrong.any():
            return x
        is_free = is_free ^ is_wrong
    x = solve_free_coefficients(is_free)
    while (x[is_free] <= 0).any():
        is_free = is_free & (x > 0)
        x = solve_free_coefficients(is_free)
    for _ in range(3 * count):
        slope = np.where(is_free, -np.inf, moment - gram @ x)
        entering = int(np.argmax(slope))
        if slope[entering] <= zero_slope:
            break
        is_free[entering] = True
        trial = solve_free_coefficients(is_free)
        while (is_falling := is_free & (trial <= 0)).any():
            # walk towards the trial until the first coefficient reaches zero
            step_fraction = float(
                (x[is_falling] / np.maximum(x[is_falling] - trial[is_falling], 1e-300)).min()
            )
            x = x + step_fraction * (trial - x)
            leaving = is_falling & (x <= 1e-14 * np.abs(x).max(initial=0.0))
            x[leaving] = 0.0
            is_free &= ~leaving
            trial = solve_free_coefficients(is_free)
        x = trial
    return x


def nonnegative_columns(phi: FloatArray, y: FloatArray, restricted: BoolArray) -> BoolArray:
    """Return which columns carry weight in the least squares of y with `restricted` >= 0.

    Active set on the triangular factor of the columns: full accuracy however many rows, shape (p,).
    """
    if len(phi) > phi.shape[1] + 1:
        factor = np.asarray(np.linalg.qr(np.column_stack((phi, y)), mode="r"))
        phi, y = factor[:, :-1], factor[:, -1]
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


# Confidence region: extreme non-negative coefficients that data do not reject.
#
# All :math:`s \ge 0` with :math:`|As - y|^2 \le \rho^2` are a convex set; a linear :math:`c's` is
# largest at its edge. With P the columns that carry weight, :math:`A_P = QR`,
# :math:`a = R^{-1}Q'y` and :math:`h = R^{-T}c_P`, the farthest point of that face is
#
# .. math:: s_P = a + \lambda R^{-1} h, \qquad \lambda^2 = (\rho^2 - |y - A_P a|^2) / h'h
#
# A primal active set walks towards it: a coefficient that would become negative leaves P, and the
# column of the largest :math:`w = A'(y - As) + \lambda c` enters, until no w is positive, which are
# the conditions of the optimum. Every point on the way is feasible and none is worse than the one
# before, so any earlier answer of the same set is a start. With c = 0 and no ball it is the method
# of Lawson and Hanson (*Solving Least Squares Problems*, ch. 23).
#
# The factor is that of the columns, never of their Gram matrix: neighbours on a fine grid of
# relaxation times are parallel to six digits. A face does not hang on what is asked, and questions
# of
# neighbouring times or frequencies end on the same ones: each is factored once, and a column that
# enters is made orthogonal to those that are there (twice: Daniel, Gragg, Kaufman and Stewart,
# *Math. Comp.* 30, 1976, 772).


#: relative gain below which an improvement is rounding
ZERO_GAIN = 1e-13
#: walks per column, at most
MAX_WALKS = 3
#: what is left of a unit column that enters, below which its digits are rounding
DEPENDENT_DIRECTION = 1e-9
#: square of what a column may lose when another leaves by a reflection
DEPENDENCE_TOLERANCE = 1e-26
#: faces that are remembered
MAX_CACHED_FACES = 512


class ActiveSet(NamedTuple):
    """Columns with positive coefficients, A_P = QR.

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
    projection : array, shape (k,)
        Q'y.
    residual : array, shape (n,)
        Residual of y.
    residual_square : float
        Its square.
    """

    active: IndexArray
    basis: FloatArray
    factor: FloatArray
    inverse: FloatArray
    projection: FloatArray
    residual: FloatArray
    residual_square: float

    def find_farthest_point(
        self, objective: FloatArray | None, squared: float
    ) -> tuple[FloatArray, float, FloatArray]:
        """Return its farthest point, the multiplier (inf without an aim), and what is left of y."""
        if objective is None or not len(self.active):
            free = 0.0 if objective is None else np.inf
            return np.asarray(self.inverse @ self.projection), free, self.residual
        h = objective[self.active] @ self.inverse
        power = float(h @ h)
        if power == 0.0:
            return np.asarray(self.inverse @ self.projection), np.inf, self.residual
        multiplier = sqrt(max(squared - self.residual_square, 0.0) / power)
        step = multiplier * h
        return (
            self.inverse @ (self.projection + step),
            multiplier,
            self.residual - step @ self.basis,
        )


class NonnegativeConfidenceRegion:
    """Confidence region of non-negative coefficients s of columns A of unit length and data y.

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
        self._least_gain = max(ZERO_GAIN * sqrt(target @ target), least_gain)
        self._cached_faces: OrderedDict[bytes, ActiveSet] = OrderedDict()

    def least(self, start: FloatArray | None = None) -> FloatArray:
        """Return the s >= 0 that minimises |A s - y|, shape (m,).

        Parameters
        ----------
        start : array, shape (m,), optional
            Non-negative; its non-zero columns are tried first.
        """
        return self._search_active_sets(
            None, 0.0, np.zeros(len(self._rows)) if start is None else start
        )

    def find_farthest_point(
        self, objective: FloatArray, squared: float, start: FloatArray
    ) -> FloatArray:
        """Return the s >= 0 with |A s - y|^2 <= `squared` that maximises c's, shape (m,).

        Parameters
        ----------
        objective : array, shape (m,)
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
        length = sqrt(objective @ objective)
        if length == 0.0:
            return start
        with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is refused
            return self._search_active_sets(objective / length, squared, start)

    def _search_active_sets(
        self, objective: FloatArray | None, squared: float, start: FloatArray
    ) -> FloatArray:
        s, barred = start.copy(), list[int]()
        face, entered = self._get_face(np.flatnonzero(s > 0)), -1
        for _ in range(MAX_WALKS * len(self._rows)):
            active = face.active
            farthest_point, multiplier, residual = face.find_farthest_point(objective, squared)
            if len(active) and farthest_point.min() <= 0:
                s[active], mask = _clip_step(s[active], farthest_point)
                # rounding let it enter: it would leave at once for ever
                if entered >= 0 and s[entered] == 0.0:
                    barred.append(entered)
                face = self._get_cached_face(
                    active[mask], partial(self._remove_columns, face, mask)
                )
                continue
            s[active] = farthest_point
            gain = self._compute_gain(residual, objective, multiplier)
            gain[active] = gain[barred] = -np.inf
            entered = int(gain.argmax())
            if not gain[entered] > self._least_gain:
                break
            if len(active) == len(self._target):
                raise FitError(
                    "the record has too few samples to say what it leaves open; record more"
                )
            extended_set = np.concatenate((active, [entered]))
            face = self._get_cached_face(
                extended_set, partial(self._append_column, face, extended_set)
            )
        if not isfinite(s.sum()):
            raise FitError(
                "the data bound nothing: they do not follow the motion that they are fitted "
                "to; look whether each column is what it is taken for"
            )
        return s

    def _compute_gain(
        self, residual: FloatArray, objective: FloatArray | None, multiplier: float
    ) -> FloatArray:
        """Return the gain of each column; any of the aim is a gain to a face that has none."""
        if objective is not None and isinf(multiplier):
            return objective.copy()
        gain = np.asarray(self._rows @ residual)
        return gain if objective is None else gain + multiplier * objective

    def _get_cached_face(self, active: IndexArray, factored: Callable[[], ActiveSet]) -> ActiveSet:
        """Return the face of these columns, factored unless cached."""
        key = np.sort(active).tobytes()
        face = self._cached_faces.get(key)
        if face is not None:
            self._cached_faces.move_to_end(key)
            return face
        face = self._cached_faces[key] = factored()
        if len(self._cached_faces) > MAX_CACHED_FACES:
            self._cached_faces.popitem(last=False)
        return face

    def _get_face(self, active: IndexArray) -> ActiveSet:
        return self._get_cached_face(active, partial(self._build_face, active))

    def _build_face(self, active: IndexArray) -> ActiveSet:
        basis, factor = np.linalg.qr(self._rows[active].T)
        return self._compute_face(active, np.ascontiguousarray(basis.T), factor)

    def _compute_face(self, active: IndexArray, basis: FloatArray, factor: FloatArray) -> ActiveSet:
        coefficients: FloatArray = basis @ self._target
        residual: FloatArray = self._target - coefficients @ basis
        inverse = np.asarray(np.linalg.inv(factor))
        return ActiveSet(
            active, basis, factor, inverse, coefficients, residual, float(residual @ residual)
        )

    def _remove_columns(self, face: ActiveSet, mask: BoolArray) -> ActiveSet:
        """Return a face with fewer columns."""
        active, factor = face.active[mask], face.factor[:, mask]
        if len(active) == len(mask) - 1:
            # what only the one that leaves could add is turned to the last direction
            mirror = face.inverse[int(mask.argmin())]
            mirror = mirror / sqrt(mirror @ mirror)
            mirror[-1] += 1.0 if mirror[-1] > 0 else -1.0
            mirror *= sqrt(2.0 / (mirror @ mirror))
            reflected = factor - np.multiply.outer(mirror, mirror @ factor)
            if reflected[-1] @ reflected[-1] <= DEPENDENCE_TOLERANCE:
                basis = face.basis - np.multiply.outer(mirror, mirror @ face.basis)
                return self._compute_face(active, basis[:-1], reflected[:-1])
        rotation, factor = np.linalg.qr(factor)
        return self._compute_face(active, rotation.T @ face.basis, factor)

    def _append_column(self, face: ActiveSet, active: IndexArray) -> ActiveSet:
        """Return a face with one column more, the last."""
        column, count = self._rows[active[-1]], len(face.active)
        first_projection = face.basis @ column
        unit_column = column - first_projection @ face.basis
        second_projection = face.basis @ unit_column
        unit_column -= second_projection @ face.basis
        length = sqrt(unit_column @ unit_column)
        if not length > DEPENDENT_DIRECTION:
            return self._build_face(active)
        unit_column /= length
        basis = np.empty((count + 1, len(unit_column)))
        basis[:-1], basis[-1] = face.basis, unit_column
        factor, inverse = np.zeros((2, count + 1, count + 1))
        factor[:-1, :-1], factor[:-1, -1], factor[-1, -1] = (
            face.factor,
            first_projection + second_projection,
            length,
        )
        inverse[:-1, :-1], inverse[-1, -1] = face.inverse, 1 / length
        inverse[:-1, -1] = face.inverse @ factor[:-1, -1] / -length
        coefficient = float(unit_column @ face.residual)
        residual = face.residual - coefficient * unit_column
        extended = np.concatenate((face.projection, [coefficient]))
        return ActiveSet(
            active, basis, factor, inverse, extended, residual, float(residual @ residual)
        )


def _clip_step(s: FloatArray, target_point: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the point towards `target_point` where a coefficient first vanishes, and the rest."""
    pairs = zip(s.tolist(), target_point.tolist(), strict=True)  # so few are faster one by one
    fractions = [
        (old / (old - new) if old > 0 else 0.0) if new <= 0 else np.inf for old, new in pairs
    ]
    smallest_share = min(fractions)
    mask = np.array(fractions) > smallest_share
    return np.where(mask, s + smallest_share * (target_point - s), 0.0), mask
