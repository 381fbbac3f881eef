r"""One positive spectrum of many isotherms, and their shifts, by variable projection.

At given shifts the spectrum is the convex problem of
:func:`~dashpot.engine.least_squares.nnls.nonnegative` on a grid of reduced relaxation times. Its
derivative in a shift is Kaufman's: that of the isotherm's rows at a fixed spectrum, less what the
active columns can take over. Nothing smooths the spectrum; smoothing doubles the errors. Each step
between neighbours has a prior as wide as their window: flat isotherms, of a glass or a plateau,
would else be thrown decades apart for a hundredth of a standard deviation.
Source: L. Kaufman, *BIT* 15 (1975) 49.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.engine.least_squares.nnls import nonnegative
from dashpot.fitting.superposition.isotherms import Isotherm

_LN10 = float(np.log(10.0))
# relaxation times per decade: fewer make the errors of shifts too small; the last descent has more,
# so that one sharp arm is followed too
COARSE, FINE = 4, 8
# of the grid beyond the data: the shifts are to be free of where it ends
BEYOND = _LN10
# a retardation so far beyond the data is a flow
FLOWS = 4 * _LN10
_MOST_LN_A, _MOST_LN_B = 0.5, 0.3
_ITERATIONS, _GRIDS = 60, 4
_STILL, _LEAST_GAIN, _STUCK = 1e-4, 1e-8, 1e6
# of ln a, from which the grid no longer fits
_REGRID = 0.2 * _LN10


@dataclass(frozen=True, eq=False)
class Shifted:
    """Isotherms on one spectrum.

    Attributes
    ----------
    ln_a, ln_b : array, shape (n,)
        Of each isotherm; 0 at the reference.
    ln_tau : array, shape (k,)
        The grid, of relaxation times at the reference, s.
    spectrum : array, shape (1 + k,)
        Plateau and arms, >= 0.
    residual : array, shape (m,)
        Relative, of all isotherms one after another.
    gram : array, shape (p, p)
        Curvature in the shifts that were free, ln a, then ln b, with what the spectrum can take
        over taken out.
    doubt : float
        What the prior of the steps adds to the sum of squares.
    """

    ln_a: FloatArray
    ln_b: FloatArray
    ln_tau: FloatArray
    spectrum: FloatArray
    residual: FloatArray
    gram: FloatArray
    doubt: float

    @property
    def sse(self) -> float:
        """Sum of squared relative residuals."""
        return float(self.residual @ self.residual)

    @property
    def support(self) -> int:
        """How many coefficients are above zero."""
        return int((self.spectrum > 0).sum())

    @property
    def parameters(self) -> int:
        """Support and free shifts."""
        return self.support + len(self.gram)

    @property
    def variance(self) -> float:
        """Mean square of the residuals per degree of freedom."""
        return self.sse / max(len(self.residual) - self.parameters, 1)

    @property
    def bic(self) -> float:
        """N ln SSE + k ln N."""
        n = len(self.residual)
        return float(n * np.log(max(self.sse + self.doubt, 1e-300)) + self.parameters * np.log(n))

    @property
    def covariance(self) -> FloatArray:
        """Of the free shifts, natural logarithms."""
        return np.asarray(self.variance * np.linalg.pinv(self.gram, hermitian=True))


def grid_of(
    isotherms: Sequence[Isotherm],
    ln_a: FloatArray,
    beyond: float = BEYOND,
    per_decade: int = COARSE,
) -> FloatArray:
    """Return the even grid of ln tau at the reference, `beyond` all that was measured."""
    windows = np.array([one.window for one in isotherms]) - np.asarray(ln_a)[:, None]
    low, high = float(windows[:, 0].min()) - beyond, float(windows[:, 1].max()) + beyond
    count = int(np.ceil((high - low) / _LN10 * per_decade)) + 1
    grid = np.linspace(low, high, count)
    return np.append(grid, high + FLOWS) if isotherms[0].domain == "creep" else grid


def spectrum_at(
    isotherms: Sequence[Isotherm],
    ln_a: FloatArray,
    ln_b: FloatArray,
    ln_tau: FloatArray,
    near: BoolArray | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the spectrum at given shifts, its columns and its residuals."""
    columns = np.concatenate(
        [
            one.vertical(float(b)) * one.columns(ln_tau, float(a))
            for one, a, b in zip(isotherms, ln_a, ln_b, strict=True)
        ]
    )
    target = np.concatenate([one.value for one in isotherms])
    length = np.linalg.norm(columns, axis=0)
    length = np.where(length > 0, length, 1.0)
    unit = columns / length
    h = nonnegative(unit.T @ unit, unit.T @ target, near) / length
    return h, columns, columns @ h - target


@dataclass(frozen=True, eq=False)
class _Problem:
    """What is shifted, and what may move."""

    isotherms: Sequence[Isotherm]
    ln_tau: FloatArray
    free: IndexArray
    prior: FloatArray
    """Of the steps between neighbours, in units of the residuals, shape (n - 1, n)."""
    free_b: bool = False

    def at(self, ln_a: FloatArray, ln_b: FloatArray, near: BoolArray | None = None) -> _Point:
        h, columns, residual = spectrum_at(self.isotherms, ln_a, ln_b, self.ln_tau, near)
        ends = np.cumsum([0, *(len(one.value) for one in self.isotherms)])
        jacobian = np.zeros((len(residual), len(self.free) * (1 + self.free_b)))
        for j, i in enumerate(self.free):
            rows = slice(ends[i], ends[i + 1])
            slope = self.isotherms[i].slope(self.ln_tau, float(ln_a[i]), h[1:])
            jacobian[rows, j] = self.isotherms[i].vertical(float(ln_b[i])) * slope
            if self.free_b:
                sign = np.sign(np.log(self.isotherms[i].vertical(1.0)))
                jacobian[rows, len(self.free) + j] = sign * (columns[rows] @ h)
        if len(self.free):
            q = np.linalg.qr(columns[:, h > 0])[0]
            jacobian -= q @ (q.T @ jacobian)
        held = np.zeros((len(self.prior), jacobian.shape[1]))
        held[:, : len(self.free)] = self.prior[:, self.free]
        doubt = self.prior @ ln_a if len(self.free) else self.prior[:, 0] * 0.0
        gram = jacobian.T @ jacobian + held.T @ held
        found = Shifted(ln_a, ln_b, self.ln_tau, h, residual, gram, float(doubt @ doubt))
        return _Point(found, jacobian.T @ residual + held.T @ doubt)

    def moved(self, at: Shifted, step: FloatArray) -> tuple[FloatArray, FloatArray]:
        ln_a, ln_b, count = at.ln_a.copy(), at.ln_b.copy(), len(self.free)
        ln_a[self.free] += step[:count]
        if self.free_b:
            ln_b[self.free] += step[count:]
        return ln_a, ln_b


class _Point(NamedTuple):
    shifted: Shifted
    gradient: FloatArray

    @property
    def objective(self) -> float:
        return self.shifted.sse + self.shifted.doubt


def shifted(
    isotherms: Sequence[Isotherm],
    ln_a: FloatArray,
    ln_b: FloatArray,
    *,
    reference: int,
    noise: float = 0.0,
    held: bool = False,
) -> Shifted:
    """Return the shifts from a start, all isotherms at once, the grid laid anew as they move.

    Parameters
    ----------
    isotherms : sequence of Isotherm
        By rising temperature.
    ln_a, ln_b : array, shape (n,)
        Where the search starts; ln b stays.
    reference : int
        The isotherm that does not move.
    noise : float
        Relative standard deviation of the values, the unit of the prior.
    held : bool
        Nothing moves: the spectrum alone is sought.
    """
    free = _free(len(isotherms), reference)[: 0 if held else None]
    prior = _prior(isotherms, noise)
    for _ in range(_GRIDS):
        problem = _Problem(isotherms, grid_of(isotherms, ln_a), free, prior)
        found = _descended(problem, ln_a, ln_b)
        far = float(np.abs(found.ln_a - ln_a).max(initial=0.0))
        ln_a = found.ln_a
        if far < _REGRID:
            break
    return found


def refined(
    isotherms: Sequence[Isotherm],
    found: Shifted,
    *,
    reference: int,
    noise: float = 0.0,
    free_b: bool = False,
) -> Shifted:
    """Return the shifts from those found, on a finer grid; with `free_b`, ln b moves too."""
    fine = grid_of(isotherms, found.ln_a, per_decade=FINE)
    free = _free(len(isotherms), reference)
    problem = _Problem(isotherms, fine, free, _prior(isotherms, noise), free_b)
    return _descended(problem, found.ln_a, found.ln_b)


def vertical_step(
    isotherms: Sequence[Isotherm], best: Shifted, *, reference: int, noise: float
) -> tuple[FloatArray, float]:
    """Return by how much ln b_T would move if it could, (n,), and the fall of chi-square: a score.

    One step of Gauss and Newton from the shifts found; the fall is about chi-square with n - 1
    degrees of freedom where the rule of b_T holds.
    """
    free = _free(len(isotherms), reference)
    problem = _Problem(isotherms, best.ln_tau, free, _prior(isotherms, noise), free_b=True)
    point = problem.at(best.ln_a, best.ln_b, best.spectrum > 0)
    step = -np.linalg.pinv(point.shifted.gram, hermitian=True) @ point.gradient
    moved = np.zeros(len(isotherms))
    moved[free] = step[len(free) :]
    return moved, float(-step @ point.gradient / max(best.variance, 1e-300))


def _free(count: int, reference: int) -> IndexArray:
    return np.delete(np.arange(count), reference)


def _prior(isotherms: Sequence[Isotherm], noise: float) -> FloatArray:
    step = np.diff(np.eye(len(isotherms)), axis=0)
    return np.asarray(noise * step / windows(isotherms)[:, None])


def windows(isotherms: Sequence[Isotherm]) -> FloatArray:
    """Return the shorter window of each pair of neighbours, natural logarithm, (n - 1,)."""
    length = np.array([one.window[1] - one.window[0] for one in isotherms])
    return np.asarray(np.minimum(length[1:], length[:-1]))


def _descended(problem: _Problem, ln_a: FloatArray, ln_b: FloatArray) -> Shifted:
    """Levenberg and Marquardt on the shifts that are free."""
    best, damping = problem.at(ln_a, ln_b), 1e-3
    most = np.repeat([_MOST_LN_A, _MOST_LN_B], len(problem.free))[: len(best.gradient)]
    for _ in range(_ITERATIONS if len(best.gradient) else 0):
        gram = best.shifted.gram
        scale = np.maximum(np.diag(gram), 1e-12 * max(float(gram.diagonal().max()), 1e-300))
        step = -np.linalg.solve(gram + damping * np.diag(scale), best.gradient)
        step = np.clip(step, -most, most)
        near = best.shifted.spectrum > 0
        trial = problem.at(*problem.moved(best.shifted, step), near)
        gain = 1 - trial.objective / max(best.objective, 1e-300)
        if gain > 0:
            best, damping = trial, max(damping / 5, 1e-9)
        else:
            damping *= 4
        if 0 < gain < _LEAST_GAIN or float(np.abs(step).max()) < _STILL or damping > _STUCK:
            break
    return best.shifted
