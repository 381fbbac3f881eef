r"""Least squares with coefficients that must not be negative.

At the optimum of :math:`x'Gx/2 - m'x`, x >= 0, every coefficient is either free with zero slope
or zero with slope :math:`m - Gx \le 0`. A few rounds exchange all that violate this together (block
principal pivoting: L. F. Portugal, J. J. Judice, L. N. Vicente, *Math. Comp.* 63, 1994), which
finds most of the support of a spectrum of a hundred columns in three solves; from there the
active-set method of Lawson and Hanson (*Solving Least Squares Problems*, ch. 23), which cannot
cycle, needs some ten or twenty more. `scipy.optimize.nnls` saves half a millisecond of the one that
this takes, and its import costs a hundred fits.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray

ROUNDS = 3
NOTHING = 1e-11
#: columns that are dependent; and so many that must not be negative, of which most carry nothing
DEPENDENT, MANY = 1e-13, 8


def solve_linear(
    A: FloatArray,
    y: FloatArray,
    positive: bool | BoolArray = False,
    near: BoolArray | None = None,
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
    near : array, shape (q,), optional
        Which coefficients are likely above zero: of many it spares most solves.

    Returns
    -------
    beta : array, shape (q,)
    basis : callable
        ``basis()``, orthonormal, shape (n, r): found when asked for.
    """
    size = np.sqrt(np.einsum("ij,ij->j", A, A))
    size[size == 0] = 1.0
    unit, must = A / size, np.zeros(A.shape[1], dtype=bool) | positive
    if int(must.sum()) > MANY:
        beta = _solve_mixed_sign(unit, y, must, near)
        carries = (beta > 0) | ~must
        return beta / size, lambda: _solve_unit_columns(unit[:, carries], y)[1]
    used, beta, sought = np.ones(len(must), dtype=bool), np.zeros(len(must)), False
    while True:
        beta[:] = 0.0
        beta[used], basis = _solve_unit_columns(unit[:, used], y)
        wrong = (beta < 0) & must
        if not wrong.any():
            break
        used = used & ~wrong if sought else nonnegative_columns(unit, y, must)
        sought = True
    return beta / size, lambda: basis


def _solve_mixed_sign(
    unit: FloatArray, y: FloatArray, must: BoolArray, near: BoolArray | None
) -> FloatArray:
    """The beta of many columns that must not be negative, the free ones taken off."""
    if must.all():
        return nonnegative(unit.T @ unit, unit.T @ y, near)
    Q, factor = np.linalg.qr(unit[:, ~must])
    A, beta = unit[:, must], np.zeros(len(must))
    aside, along = Q.T @ A, Q.T @ y
    A, residual = A - Q @ aside, y - Q @ along
    beta[must] = nonnegative(A.T @ A, A.T @ residual, None if near is None else near[must])
    beta[~must] = np.linalg.lstsq(factor, along - aside @ beta[must], rcond=DEPENDENT)[0]
    return beta


def _solve_unit_columns(A: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least squares by columns of unit length, and a basis of those that carry weight."""
    basis, factor = np.linalg.qr(A)
    lost = np.ones(A.shape[1], dtype=bool)
    lost[: len(factor)] = np.abs(factor.diagonal()) <= DEPENDENT
    if not lost.any():
        along = basis.T @ y
        return np.linalg.solve(factor, along) if len(along) else along, basis
    beta = np.zeros(A.shape[1])
    beta[~lost], basis = _solve_unit_columns(A[:, ~lost], y)
    return beta, basis


def nonnegative(gram: FloatArray, moment: FloatArray, near: BoolArray | None = None) -> FloatArray:
    """Return the x >= 0 that minimises x'Gx/2 - m'x, shape (n,).

    On the normal equations: for starts, certificates and tables, not for final digits.

    Parameters
    ----------
    gram : array, shape (n, n)
        A'A, columns of A of comparable norm.
    moment : array, shape (n,)
        A'y.
    near : array, shape (n,), optional
        Which coefficients are likely above zero: it spares most solves.
    """
    count = len(moment)
    ridged = gram + 1e-14 * float(np.trace(gram)) / max(count, 1) * np.eye(count)
    nothing = NOTHING * float(np.abs(moment).max(initial=0.0))

    def solve_free_coefficients(free: BoolArray) -> FloatArray:
        """The minimum over the free coefficients, of either sign, the others zero."""
        index = np.flatnonzero(free)
        x = np.zeros(count)
        x[index] = np.linalg.solve(ridged[index[:, None], index], moment[index])
        return x

    free: BoolArray = moment > 0 if near is None else near.copy()
    for _ in range(ROUNDS if near is None else 0):
        x = solve_free_coefficients(free)
        wrong = np.where(free, x < 0, moment - gram @ x > nothing)
        if not wrong.any():
            return x
        free = free ^ wrong
    x = solve_free_coefficients(free)
    while (x[free] <= 0).any():
        free = free & (x > 0)
        x = solve_free_coefficients(free)
    for _ in range(3 * count):
        slope = np.where(free, -np.inf, moment - gram @ x)
        enter = int(np.argmax(slope))
        if slope[enter] <= nothing:
            break
        free[enter] = True
        trial = solve_free_coefficients(free)
        while (fall := free & (trial <= 0)).any():
            # walk towards the trial until the first coefficient reaches zero
            share = float((x[fall] / np.maximum(x[fall] - trial[fall], 1e-300)).min())
            x = x + share * (trial - x)
            leaving = fall & (x <= 1e-14 * np.abs(x).max(initial=0.0))
            x[leaving] = 0.0
            free &= ~leaving
            trial = solve_free_coefficients(free)
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
