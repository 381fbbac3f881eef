r"""Joint fit of one non-negative spectrum and the shifts of many isotherms.

At given shifts the spectrum is a convex problem on a grid of reduced relaxation times; the shifts
descend with it (:mod:`dashpot.numerics.least_squares`). Nothing smooths the spectrum;
smoothing doubles the errors. Each step between neighbours has a prior as wide as their window: flat
isotherms, of a glass or a plateau, would else be thrown decades apart for a hundredth of a standard
deviation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.extensions.curves.superposition.isotherms import Isotherm
from dashpot.numerics.inference.correlated_noise import make_directions
from dashpot.numerics.inference.covariance_estimate import white_noise
from dashpot.numerics.inference.model_order import bic, deviance
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows, require_optimum

_LN10 = float(np.log(10.0))
# relaxation times per decade: fewer make the errors of shifts too small; the last descent has more,
# so that one sharp arm is followed too
COARSE_POINTS, FINE_POINTS = 4, 8
# of the grid beyond the data: the shifts are to be free of where it ends
GRID_MARGIN = _LN10
# a retardation so far beyond the data is a flow
FLOW_DISTANCE = 4 * _LN10
# sizes of ln a and ln b: a step is at most half as long again
_STEP_SIZES = 0.3, 0.2
_MAX_STEPS, _MAX_GRIDS, _SHIFT_TOLERANCE, _MIN_GAIN = 60, 4, 1e-5, 1e-8
# of ln a, from which the grid no longer fits
_REGRID = 0.2 * _LN10


@dataclass(frozen=True, eq=False)
class ShiftedSpectrum:
    """Spectrum of several shifted isotherms.

    Attributes
    ----------
    ln_a, ln_b : array, shape (n,)
        Logarithms of the shift factors of each isotherm; 0 at the reference.
    ln_tau : array, shape (k,)
        The grid, of relaxation times at the reference, s.
    optimum : Optimum
        Theta the shifts that were free, ln a, then ln b; beta the spectrum, plateau and arms, >= 0;
        residuals relative, of all isotherms one after another.
    is_loss : array, shape (m,)
        Which residuals are of a loss.
    """

    ln_a: FloatArray
    ln_b: FloatArray
    ln_tau: FloatArray
    optimum: Optimum
    is_loss: BoolArray

    @property
    def sse(self) -> float:
        """Sum of squared relative residuals."""
        return self.optimum.sse

    @property
    def values(self) -> int:
        """Number of residuals."""
        return len(self.optimum.residual)

    @property
    def rms(self) -> float:
        """Root mean square of the relative residuals."""
        return float(np.sqrt(self.sse / self.values))

    @property
    def parameters(self) -> int:
        """Coefficients above zero, and free shifts."""
        return int(self.optimum.free.sum())

    @property
    def variance(self) -> float:
        """Mean square of the residuals per degree of freedom."""
        return white_noise(self.optimum).power

    @property
    def bic(self) -> float:
        """BIC of the spectrum and the shifts, with their priors."""
        return bic(self.optimum.cost, effective=self.values, parameters=self.parameters)

    @property
    def deviance(self) -> float:
        """Deviance of the data alone, as part of a BIC."""
        return deviance(self.sse, effective=self.values)

    @property
    def covariance(self) -> FloatArray:
        r"""Covariance of the free shifts, natural logarithms.

        .. math:: (J^TJ)^{-1} J^T \operatorname{diag}(\sigma_i^2) J (J^TJ)^{-1}

        Storage and loss have a variance each: an instrument that measures both to 1 % of their own
        has a scatter of the loss, over the modulus, that is a fraction of that of the storage.
        """
        jacobian, residual = self.optimum.projected_jacobian, self.optimum.residual
        inflation = self.variance / max(self.sse / self.values, 1e-300)
        variances = np.full(len(jacobian), self.variance)
        for part in (self.is_loss, ~self.is_loss):
            if part.any():
                variances[: self.values][part] = inflation * float(np.mean(residual[part] ** 2))
        information = make_directions([jacobian])
        rows = information.columns[0].matrix
        return information.covariance(rows.T @ (variances[:, None] * rows))


def make_grid(
    isotherms: Sequence[Isotherm],
    ln_a: FloatArray,
    excess: float = GRID_MARGIN,
    per_decade: int = COARSE_POINTS,
) -> FloatArray:
    """Return the even grid of ln tau at the reference, `excess` all that was measured."""
    windows = np.array([isotherm.window for isotherm in isotherms]) - np.asarray(ln_a)[:, None]
    low, high = float(windows[:, 0].min()) - excess, float(windows[:, 1].max()) + excess
    count = int(np.ceil((high - low) / _LN10 * per_decade)) + 1
    grid = np.linspace(low, high, count)
    return np.append(grid, high + FLOW_DISTANCE) if isotherms[0].domain == "creep" else grid


@dataclass(frozen=True, eq=False)
class ShiftSearch:
    """Isotherms to be shifted, and which shifts are free.

    Attributes
    ----------
    isotherms : sequence of Isotherm
        By rising temperature.
    ln_tau : array, shape (k,)
    shifts : array, shape (2 n,)
        Ln a, then ln b: where the search starts, and where the others stay.
    free : array
        Which of them move.
    noise : float
        Relative standard deviation of the values, the unit of the prior.
    """

    isotherms: Sequence[Isotherm]
    ln_tau: FloatArray
    shifts: FloatArray
    free: IndexArray
    noise: float = 0.0

    @property
    def problem(self) -> Problem:
        """The shifts that are free, and the spectrum."""
        n = len(self.isotherms)
        sizes = [Parameter(scale=_STEP_SIZES[i // n]) for i in self.free.tolist()]
        return Problem(self.rows, sizes, positive=True, priors=n - 1)

    def split_shifts(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Ln a and ln b of each isotherm."""
        shifts = self.shifts.copy()
        shifts[self.free] = theta
        ln_a, ln_b = np.split(shifts, 2)
        return ln_a, ln_b

    def rows(self, theta: FloatArray) -> Rows:
        """Return the rows of every isotherm, and of the priors of steps between neighbours."""
        ln_a, ln_b = self.split_shifts(theta)
        n, prior = len(ln_a), _make_prior(self.isotherms, self.noise)
        group = list(zip(self.isotherms, ln_a.tolist(), ln_b.tolist(), strict=True))
        columns = [
            isotherm.vertical(b) * isotherm.columns(self.ln_tau, a) for isotherm, a, b in group
        ]
        A = np.concatenate((*columns, np.zeros((len(prior), 1 + len(self.ln_tau)))))
        y = np.concatenate((*(isotherm.value for isotherm in self.isotherms), -prior @ ln_a))

        def slope(h: FloatArray) -> FloatArray:
            derivative, start = np.zeros((len(y), 2 * n)), 0
            for i, (isotherm, a, b) in enumerate(group):
                rows = slice(start, start := start + len(isotherm.value))
                derivative[rows, i] = isotherm.vertical(b) * isotherm.slope(self.ln_tau, a, h[1:])
                derivative[rows, n + i] = np.log(isotherm.vertical(1.0)) * (columns[i] @ h)
            derivative[start:, :n] = prior
            return derivative[:, self.free]

        return Rows(y, A, slope)

    @property
    def best_spectrum(self) -> ShiftedSpectrum:
        """The best there is from the start."""
        start = self.shifts[self.free]
        best = require_optimum(
            self.problem,
            [start],
            max_steps=_MAX_STEPS,
            step_tolerance=_SHIFT_TOLERANCE,
            cost_tolerance=_MIN_GAIN,
        )
        is_loss = np.concatenate(
            [np.arange(len(item.value)) >= len(item.at) for item in self.isotherms]
        )
        return ShiftedSpectrum(*self.split_shifts(best.theta), self.ln_tau, best, is_loss)


def fit_spectrum(
    isotherms: Sequence[Isotherm], ln_a: FloatArray, ln_b: FloatArray, ln_tau: FloatArray
) -> ShiftedSpectrum:
    """Return the spectrum at given shifts."""
    no_indices = np.zeros(0, dtype=np.intp)
    return ShiftSearch(isotherms, ln_tau, np.concatenate((ln_a, ln_b)), no_indices).best_spectrum


def solve_shifts(
    isotherms: Sequence[Isotherm],
    ln_a: FloatArray,
    ln_b: FloatArray,
    *,
    reference: int,
    noise: float = 0.0,
) -> ShiftedSpectrum:
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
    """
    free = _select_free_shifts(len(isotherms), reference)
    for _ in range(_MAX_GRIDS):
        grid = make_grid(isotherms, ln_a)
        spectrum = ShiftSearch(
            isotherms, grid, np.concatenate((ln_a, ln_b)), free, noise
        ).best_spectrum
        change = float(np.abs(spectrum.ln_a - ln_a).max())
        ln_a = spectrum.ln_a
        if change < _REGRID:
            break
    return spectrum


def refine_shifts(
    isotherms: Sequence[Isotherm],
    spectrum: ShiftedSpectrum,
    *,
    reference: int,
    noise: float = 0.0,
    free_b: bool = False,
) -> ShiftedSpectrum:
    """Return the shifts from those found, on a finer grid; with `free_b`, ln b is free as well."""
    fine_grid = make_grid(isotherms, spectrum.ln_a, per_decade=FINE_POINTS)
    free = _select_free_shifts(len(isotherms), reference, with_vertical=free_b)
    return ShiftSearch(
        isotherms, fine_grid, np.concatenate((spectrum.ln_a, spectrum.ln_b)), free, noise
    ).best_spectrum


def compute_vertical_step(
    isotherms: Sequence[Isotherm], best: ShiftedSpectrum, *, reference: int, noise: float
) -> tuple[FloatArray, float]:
    """Return by how much ln b_T would move if it could, (n,), and the fall of chi-square: a score.

    One step of Gauss and Newton from the shifts found; the fall is about chi-square with n - 1
    degrees of freedom where the rule of b_T holds.
    """
    n, shifts = len(isotherms), np.concatenate((best.ln_a, best.ln_b))
    free = _select_free_shifts(n, reference, with_vertical=True)
    problem = ShiftSearch(isotherms, best.ln_tau, shifts, free, noise).problem
    point = problem.solve_linear(shifts[free], best.optimum.beta > 0)
    step = -np.linalg.lstsq(point.projected_jacobian, point.all_residuals, rcond=None)[0]
    values = np.zeros(2 * n)
    values[free] = step
    return values[n:], float(-step @ point.gradient / max(best.variance, 1e-300))


def _select_free_shifts(count: int, reference: int, *, with_vertical: bool = False) -> IndexArray:
    """Return which of ln a and, with `with_vertical`, ln b move."""
    free_indices = np.delete(np.arange(count), reference)
    return np.concatenate((free_indices, free_indices + count)) if with_vertical else free_indices


def _make_prior(isotherms: Sequence[Isotherm], noise: float) -> FloatArray:
    step = np.diff(np.eye(len(isotherms)), axis=0)
    return np.asarray(noise * step / compute_windows(isotherms)[:, None])


def compute_windows(isotherms: Sequence[Isotherm]) -> FloatArray:
    """Return the shorter window of each pair of neighbours, natural logarithm, (n - 1,)."""
    length = np.array([isotherm.window[1] - isotherm.window[0] for isotherm in isotherms])
    return np.asarray(np.minimum(length[1:], length[:-1]))
