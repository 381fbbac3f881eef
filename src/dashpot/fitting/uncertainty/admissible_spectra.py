r"""All the spectra that tests cannot reject.

A spectrum is :math:`s = (k_\infty, b, k_1, \ldots) \ge 0` on a grid of relaxation times. With A
and y the whitened columns and data, all that leave

.. math:: |A s - y|^2 \le \min_{s \ge 0} |A s - y|^2 + c

stand. A quantity linear in s, such as K'(omega), K''(omega) or k(t), reaches over them from its
smallest to its largest value: the strict bounds of Rust and Burrus (*Mathematical Programming and
the Numerical Solution of Linear Equations*, 1972) and of Stark (*J. Geophys. Res.* 97, 1992). At
the quantile of chi-square with one degree of freedom their coverage was long conjectured to be
that of one quantity without the bounds at zero; it is not (P. Batlle et al., arXiv:2310.02461,
2023). On simulated seals that cut is up to six points short of 95 %, and 5.0 for 3.84 mends it.

The grid is refined where the best spectrum has weight, since what an active arm cannot reach
between two grid points is paid in chi-square: an error of a limit, in standard errors, that grows
with the square of the gap over the noise.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from copy import copy
from typing import Protocol

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.errors import FitError
from dashpot.base.student_t import t_quantile
from dashpot.fitting.relaxation_data import RelaxationRows
from dashpot.numerics.least_squares.nonnegative_confidence_region import NonnegativeConfidenceRegion

#: the best of all spectra leaves no more than so many times what the fit does
FAR = 2.0
#: of the grid before it is refined
PER_DECADE = 16
# the grid ends this far, as a factor, beyond what frequencies and tests could tell apart
BEYOND = 10.0
# a gap of ln tau is refined by so many points, until it is as small as this
POINTS, FINEST = 3, float(np.log(10)) / 400
ROUNDS = 5
# refinement ends when it gains no more of the sum of squares
GAIN = 0.05
#: what the quantile of chi-square must be multiplied by to cover what it says: 5.0 for 3.84
CALIBRATION = 5.0 / 3.841
# rows with no more of any unit column are rounding
ROUNDING = 1e-9
# a column below this part of the largest is nothing
UNSEEN = 1e-12
# a ratio is found when one more step would move its numerator by this part of a standard error
CLOSE = 1e-3
STEPS = 40
#: a search that need not be exact ends at this gain, in standard deviations of the noise
ROUGH = 1e-3
REMEMBERED = 16


def deviance_limit(level: float, dof: float) -> float:
    """Return how far above the best the sum of squares of a spectrum may lie.

    Parameters
    ----------
    level : float
        Coverage of each limit.
    dof : float
        Degrees of freedom of the noise; fewer than one count as one, the widest limit that there
        is, where too few arms leave what is no noise.
    """
    return CALIBRATION * t_quantile(level, max(dof, 1.0)) ** 2


class SpectralData(Protocol):
    """A test or a curve whose rows are linear in a spectrum, each of unit noise."""

    @property
    def window(self) -> tuple[float, float]:
        """Shortest and longest relaxation time that it could tell, s."""
        ...

    def rows(self, log_tau: FloatArray, *, slopes: bool) -> RelaxationRows:
        """Everything that depends on the solid."""
        ...


class AdmissibleSpectra:
    """The non-negative spectra of some tests, at a deviance limit.

    Columns are k_inf, b, then arms at `tau`; of creep the glass compliance, the flow, then
    retardations.

    Parameters
    ----------
    tests : sequence of SpectralData
    fastest : float
        The highest frequency to be asked about, rad/s.
    limit : float
        Of the deviance, :func:`deviance_limit`.
    further : array, shape (n,), optional
        Relaxation times that the grid holds besides, s: those of the fit.
    """

    def __init__(
        self,
        tests: Sequence[SpectralData],
        *,
        fastest: float,
        limit: float,
        extra: Sequence[float] = (),
    ) -> None:
        self.limit = limit
        shortest = min(test.window[0] for test in tests)
        longest = max(test.window[1] for test in tests)
        low = np.log(min(shortest, 1 / (BEYOND * fastest)))
        high = np.log(longest)
        count = int(np.ceil((high - low) / np.log(10) * PER_DECADE)) + 1
        logs = np.log(np.asarray(extra, dtype=float))
        log_tau = _merge_grids(np.linspace(low, high, count), logs)
        # the fit is no bad spectrum: a plateau and its own arms
        remainder, weight = np.inf, np.zeros(len(log_tau) + 2)
        weight[0], weight[2 + np.searchsorted(log_tau, logs)] = 1.0, 1.0
        for _ in range(ROUNDS):
            before, remainder = remainder, self._solve_on_grid(tests, log_tau, weight)
            finer = _refine_grid(log_tau, self.best[2:] > 0)
            if before - remainder < GAIN or len(finer) == len(log_tau):
                break
            weight = np.zeros(len(finer) + 2)
            weight[:2], weight[2 + np.searchsorted(finer, log_tau)] = np.split(
                self.best / self.scale, [2]
            )
            log_tau = finer
        # all of one convex set: whatever is asked next, the best of them for it is a start
        self.met = deque([self.best], maxlen=REMEMBERED)

    def _solve_on_grid(
        self, tests: Sequence[SpectralData], log_tau: FloatArray, start: FloatArray
    ) -> float:
        """Take a grid, find the best spectrum on it from a start, N/m; return what it leaves."""
        order = _spread(len(log_tau))
        parts = []
        for test in tests:
            part = test.rows(log_tau[order], slopes=False)
            arms = np.empty_like(part.arms)
            arms[:, order] = part.arms
            parts.append(np.column_stack((part.target, part.spring, part.dashpot, arms)))
        rows = np.vstack(parts)
        self.tau = np.exp(log_tau)
        norm = np.linalg.norm(rows[:, 1:], axis=0)
        # what the record does not show at all is limited by nothing
        self.shown = norm > UNSEEN * norm.max()
        self.scale = np.where(self.shown, norm, 1.0)
        columns = np.where(self.shown, rows[:, 1:] / self.scale, 0.0)
        text = np.linalg.norm(columns, axis=1) > ROUNDING
        aside, self.target = float(rows[~text, 0] @ rows[~text, 0]), rows[text, 0].copy()
        # a column is asked for as a row: laid out so, none is copied for it
        self.columns = np.asfortranarray(columns[text][:, self.shown])
        self.best = np.zeros(len(norm))
        self._ball = NonnegativeConfidenceRegion(self.columns, self.target)
        self.best[self.shown] = self._ball.least((start * self.scale)[self.shown])
        self.least = self.compute_misfit(self.best)
        self.total = self.least + aside
        return self.total

    def reduce_grid(self, decades: float) -> AdmissibleSpectra:
        """Return the same set on fewer relaxation times, at least so many decades apart.

        All that carry weight in a spectrum that was met stay, and so does the best. A search ends
        at a gain of `ROUGH` of a standard deviation of the noise. A limit is then narrower by up to
        a tenth of its distance from the fit, and found in a fifth of the time.
        """
        keep: BoolArray = np.any(np.array(self.met) > 0, axis=0)
        keep[:2] = keep[-1] = True
        last = -np.inf
        for row, place in enumerate(np.log10(self.tau).tolist(), start=2):
            if place - last >= decades:
                keep[row], last = True, place
        spectra = copy(self)
        spectra.tau, spectra.scale = self.tau[keep[2:]], self.scale[keep]
        spectra.columns = np.asfortranarray(self.columns[:, keep[self.shown]])
        spectra.shown, spectra.best = self.shown[keep], self.best[keep]
        spectra._ball = NonnegativeConfidenceRegion(spectra.columns, self.target, ROUGH)
        spectra.met = deque((values[keep] for values in self.met), maxlen=REMEMBERED)
        return spectra

    def validate_misfit(self, misfit: float, floor: float) -> None:
        """Refuse a set whose best spectrum is far worse than the fit, which is one of them.

        Parameters
        ----------
        misfit : float
            Sum of squares that the fit leaves of every sample.
        floor : float
            What of it no spectrum can remove, and the rows do not hold.

        Raises
        ------
        FitError
            If rounding has spoilt the rows.
        """
        times = (self.total + floor) / max(misfit, 1e-300)
        if times > FAR:
            raise FitError(
                f"the best spectrum leaves {times:.3g} times what the fit does, though the fit is "
                "one of them: rounding has spoilt the limits of this record; thin its rows, or "
                "give it in fewer digits"
            )

    def compute_misfit(self, s: FloatArray) -> float:
        """Sum of squares that a spectrum, in unit columns, leaves."""
        misfit = self.columns @ s[self.shown] - self.target
        return float(misfit @ misfit)

    # -- quantities -------------------------------------------------------------------------------

    def stiffness_at(self, omega: float) -> tuple[FloatArray, FloatArray]:
        """Storage and loss of unit columns at omega, rad/s: shapes (m,)."""
        x = omega * self.tau
        storage = np.concatenate(([1.0, 0.0], x * x / (1 + x * x)))
        loss = np.concatenate(([0.0, omega], x / (1 + x * x)))
        return storage, loss

    def compliance_at(self, omega: float) -> tuple[FloatArray, FloatArray]:
        """Storage and loss compliance J', J'' of unit columns at omega, rad/s: shapes (m,)."""
        x = omega * self.tau
        storage = np.concatenate(([1.0, 0.0], 1 / (1 + x * x)))
        loss = np.concatenate(([0.0, 1 / omega], x / (1 + x * x)))
        return storage, loss

    def relaxed_to(self, time: float) -> FloatArray:
        r"""Relaxation :math:`k_\infty + \sum_j k_j e^{-t/\tau_j}` of unit columns, shape (m,)."""
        return np.concatenate(([1.0, 0.0], np.exp(-time / self.tau)))

    def falling_at(self, time: float) -> FloatArray:
        r"""Its slope :math:`-dk/d\ln t` of unit columns, shape (m,)."""
        x = time / self.tau
        return np.concatenate(([0.0, 0.0], x * np.exp(-x)))

    def crept_to(self, time: float) -> FloatArray:
        r"""Compliance :math:`D_g + D_f t + \sum_i D_i (1 - e^{-t/\lambda_i})` of unit columns."""
        return np.concatenate(([1.0, time], -np.expm1(-time / self.tau)))

    def creeping_at(self, time: float) -> FloatArray:
        r"""Its slope :math:`dJ/d\ln t` of unit columns, shape (m,)."""
        slope = self.falling_at(time)
        slope[1] = time
        return slope

    def value(self, v: FloatArray) -> float:
        """V . k of the best spectrum."""
        return float(v @ (self.best / self.scale))

    # -- reaches ----------------------------------------------------------------------------------

    def find_extreme_spectrum(self, v: FloatArray) -> FloatArray:
        """The spectrum of the largest v . k, N/m, shape (m,)."""
        aim, on = v / self.scale, self.shown
        start = self.met[int((np.array(self.met) @ aim).argmax())]
        values = np.zeros(len(aim))
        values[on] = self._ball.find_farthest_point(aim[on], self.least + self.limit, start[on])
        self.met.append(values)
        stiffness = values / self.scale
        return stiffness if on.all() else np.where(~on & (aim > 0), np.inf, stiffness)

    def reach(self, v: FloatArray) -> tuple[float, float]:
        """Smallest and largest v . k that the tests do not reject."""
        return _project_spectrum(v, self.find_extreme_spectrum(-v)), _project_spectrum(
            v, self.find_extreme_spectrum(v)
        )

    def ratio_reach(self, above: FloatArray, below: FloatArray) -> tuple[float, float]:
        """Smallest and largest (above . k) / (below . k), below . k > 0 (Dinkelbach 1967)."""
        return -self._largest_ratio(-above, below), self._largest_ratio(above, below)

    def _largest_ratio(self, above: FloatArray, below: FloatArray) -> float:
        if (above[~self.shown] > 0).any():
            return np.inf
        a, b = above / self.scale, below / self.scale
        values = [float(a @ s) / float(b @ s) for s in self.met if float(b @ s) > 0]
        if not values:  # the record knows of no stiffness at all, and so of no ratio
            return np.inf if (above > 0).any() else 0.0
        ratio = max(values)
        for _ in range(STEPS):
            result = self.find_extreme_spectrum(above - ratio * below)
            if not float(below @ result) > 0:
                break
            gain = float(above @ result) - ratio * float(below @ result)
            larger = float(above @ result) / float(below @ result)
            if gain <= CLOSE * abs(larger - ratio) or larger <= ratio:
                break
            ratio = larger
        return ratio


def _project_spectrum(v: FloatArray, spectrum: FloatArray) -> float:
    """V . k, of what v asks for."""
    request = v != 0
    return float(v[request] @ spectrum[request])


def _spread(count: int) -> IndexArray:
    """Indices in an order that halves the largest gap again and again.

    Columns of a triangular factor in this order leave all that they have in common in its first
    rows, and rounding in the others.
    """
    bits = max(count - 1, 1).bit_length()
    reversed_ = np.zeros(2**bits, dtype=np.intp)
    for bit in range(bits):
        reversed_ = 2 * reversed_ + (np.arange(2**bits) >> bit & 1)
    return reversed_[reversed_ < count]


def _merge_grids(first: FloatArray, second: FloatArray) -> FloatArray:
    """The points of both grids; `numpy.union1d` says the same and imports masked arrays."""
    both = np.sort(np.concatenate((first, second)))
    return np.asarray(both[np.append(True, np.diff(both) > 0)])


def _refine_grid(log_tau: FloatArray, active: BoolArray) -> FloatArray:
    """The grid with points put into the gaps on both sides of every active arm."""
    gaps = np.diff(log_tau)
    parallel = (active[1:] | active[:-1]) & (gaps > FINEST)
    steps = np.arange(1, POINTS + 1) / (POINTS + 1)
    new = log_tau[:-1][parallel, None] + gaps[parallel, None] * steps
    return _merge_grids(log_tau, new.ravel())
