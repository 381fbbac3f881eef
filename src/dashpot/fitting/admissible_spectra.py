"""Admissible spectra: all that the tests do not reject, and their limits of stiffness."""

from __future__ import annotations

from bisect import bisect
from cmath import phase
from collections import deque
from collections.abc import Sequence
from copy import copy
from itertools import pairwise, starmap
from math import pi
from typing import Protocol

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.errors import FitError
from dashpot.base.student_t import t_quantile
from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.parameter_estimate import Interval
from dashpot.fitting.marginal_relaxation import RelaxationData, RelaxationRows, misfits
from dashpot.numerics.nonnegative_least_squares import NonnegativeConfidenceRegion
from dashpot.solids.maxwell import GeneralizedMaxwell

# All the spectra that tests cannot reject.
#
# A spectrum is :math:`s = (k_\infty, b, k_1, \ldots) \ge 0` on a grid of relaxation times. With A
# and y the whitened columns and data, all that leave
#
# .. math:: |A s - y|^2 \le \min_{s \ge 0} |A s - y|^2 + c
#
# stand. A quantity linear in s, such as K'(omega), K''(omega) or k(t), reaches over them from its
# smallest to its largest value: the strict bounds of Rust and Burrus (*Mathematical Programming and
# the Numerical Solution of Linear Equations*, 1972) and of Stark (*J. Geophys. Res.* 97, 1992). At
# the quantile of chi-square with one degree of freedom their coverage was long conjectured to be
# that of one quantity without the bounds at zero; it is not (P. Batlle et al., arXiv:2310.02461,
# 2023). On simulated seals that cut is up to six points short of 95 %, and 5.0 for 3.84 mends it.
#
# The grid is refined where the best spectrum has weight, since what an active arm cannot reach
# between two grid points is paid in chi-square: an error of a limit, in standard errors, that grows
# with the square of the gap over the noise.


#: largest ratio of the residuals of the best spectrum and of the fit
MAX_RESIDUAL_RATIO = 2.0
#: of the grid before it is refined
POINTS_PER_DECADE = 16
# the grid ends this far, as a factor, beyond what frequencies and tests could distinguish
GRID_MARGIN = 10.0
# a gap of ln tau is refined by so many points, until it is as small as this
REFINEMENT_POINTS, MIN_GRID_STEP = 3, float(np.log(10)) / 400
MAX_REFINEMENTS = 5
# refinement ends when it gains no more of the sum of squares
MIN_REFINEMENT_GAIN = 0.05
#: what the quantile of chi-square must be multiplied by to cover what it says: 5.0 for 3.84
CALIBRATION = 5.0 / 3.841
# rows with no more of any unit column are rounding
ROUNDING = 1e-9
# relative size below which a column is negligible
MIN_COLUMN_SHARE = 1e-12
# a ratio is found when one more step would move its numerator by this part of a standard error
RATIO_TOLERANCE = 1e-3
MAX_RATIO_STEPS = 40
#: a search that need not be exact ends at this gain, in standard deviations of the noise
ROUGH_TOLERANCE = 1e-3
MAX_CACHED_SPECTRA = 16


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
    """Data linear in a spectrum, as rows of unit noise."""

    @property
    def window(self) -> tuple[float, float]:
        """Shortest and longest relaxation time that it could show, s."""
        ...

    def rows(self, log_tau: FloatArray, *, with_slopes: bool) -> RelaxationRows:
        """Rows of the design matrix, which depend on the solid."""
        ...


class AdmissibleSpectra:
    """Non-negative spectra of some tests within a deviance limit.

    Columns are k_inf, b, then arms at `tau`; of creep the glass compliance, the flow, then
    retardations.

    Parameters
    ----------
    tests : sequence of SpectralData
    fastest : float
        The highest frequency to be asked about, rad/s.
    limit : float
        Limit of the deviance, :func:`deviance_limit`.
    extra : array, shape (n,), optional
        Further relaxation times of the grid, s, usually of the fit.
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
        low = np.log(min(shortest, 1 / (GRID_MARGIN * fastest)))
        high = np.log(longest)
        count = int(np.ceil((high - low) / np.log(10) * POINTS_PER_DECADE)) + 1
        logs = np.log(np.asarray(extra, dtype=float))
        log_tau = _merge_grids(np.linspace(low, high, count), logs)
        # the fit is no bad spectrum: a plateau and its own arms
        remainder, weight = np.inf, np.zeros(len(log_tau) + 2)
        weight[0], weight[2 + np.searchsorted(log_tau, logs)] = 1.0, 1.0
        for _ in range(MAX_REFINEMENTS):
            previous_sse, remainder = remainder, self._solve_on_grid(tests, log_tau, weight)
            refined_grid = _refine_grid(log_tau, self.best[2:] > 0)
            if previous_sse - remainder < MIN_REFINEMENT_GAIN or len(refined_grid) == len(log_tau):
                break
            weight = np.zeros(len(refined_grid) + 2)
            weight[:2], weight[2 + np.searchsorted(refined_grid, log_tau)] = np.split(
                self.best / self.scale, [2]
            )
            log_tau = refined_grid
        # all of one convex set: whatever is asked next, the best of them for it is a start
        self.met = deque([self.best], maxlen=MAX_CACHED_SPECTRA)

    def _solve_on_grid(
        self, tests: Sequence[SpectralData], log_tau: FloatArray, start: FloatArray
    ) -> float:
        """Find the best spectrum on a grid from a start, N/m; return its residual SSE."""
        order = _spread(len(log_tau))
        all_rows = []
        for test in tests:
            test_rows = test.rows(log_tau[order], with_slopes=False)
            arms = np.empty_like(test_rows.arms)
            arms[:, order] = test_rows.arms
            all_rows.append(
                np.column_stack((test_rows.target, test_rows.spring, test_rows.dashpot, arms))
            )
        rows = np.vstack(all_rows)
        self.tau = np.exp(log_tau)
        norm = np.linalg.norm(rows[:, 1:], axis=0)
        # what the record does not show at all is limited by nothing
        # (a dashpot has another unit, and a column of any size)
        self.shown = norm > MIN_COLUMN_SHARE * np.delete(norm, 1).max()
        self.scale = np.where(self.shown, norm, 1.0)
        columns = np.where(self.shown, rows[:, 1:] / self.scale, 0.0)
        text = np.linalg.norm(columns, axis=1) > ROUNDING
        residual_sse, self.target = float(rows[~text, 0] @ rows[~text, 0]), rows[text, 0].copy()
        # a column is asked for as a row: laid out so, none is copied for it
        self.columns = np.asfortranarray(columns[text][:, self.shown])
        self.best = np.zeros(len(norm))
        self._confidence_region = NonnegativeConfidenceRegion(self.columns, self.target)
        self.best[self.shown] = self._confidence_region.least((start * self.scale)[self.shown])
        self.least = self.compute_misfit(self.best)
        self.total = self.least + residual_sse
        return self.total

    def reduce_grid(self, decades: float) -> AdmissibleSpectra:
        """Return the same set on fewer relaxation times, at least `decades` apart.

        All that carry weight in a spectrum that was met stay, and so does the best. A search ends
        at a gain of `ROUGH_TOLERANCE` of a standard deviation of the noise. A limit is then
        narrower by up to a tenth of its distance from the fit, and found in a fifth of the time.
        """
        keep: BoolArray = np.any(np.array(self.met) > 0, axis=0)
        keep[:2] = keep[-1] = True
        last = -np.inf
        for row, log_tau in enumerate(np.log10(self.tau).tolist(), start=2):
            if log_tau - last >= decades:
                keep[row], last = True, log_tau
        spectra = copy(self)
        spectra.tau, spectra.scale = self.tau[keep[2:]], self.scale[keep]
        spectra.columns = np.asfortranarray(self.columns[:, keep[self.shown]])
        spectra.shown, spectra.best = self.shown[keep], self.best[keep]
        spectra._confidence_region = NonnegativeConfidenceRegion(
            spectra.columns, self.target, ROUGH_TOLERANCE
        )
        spectra.met = deque((values[keep] for values in self.met), maxlen=MAX_CACHED_SPECTRA)
        return spectra

    def validate_misfit(self, misfit: float, fixed_misfit: float) -> None:
        """Refuse a set whose best spectrum is far worse than the fit, which is one of them.

        Parameters
        ----------
        misfit : float
            Residual sum of squares of the fit over every sample.
        fixed_misfit : float
            What of it no spectrum can remove, and the rows do not hold.

        Raises
        ------
        FitError
            If the rows hold what no spectrum explains, and the fit does.
        """
        times = (self.total + fixed_misfit) / max(misfit, 1e-300)
        if times > MAX_RESIDUAL_RATIO:
            raise FitError(
                f"the best spectrum leaves {times:.3g} times what the fit does, though the fit is "
                "one of them: the record holds a delay or a motion that its limits leave out, or "
                "rounding has spoilt its rows; correct the delay of the force, or thin the rows"
            )

    def compute_misfit(self, s: FloatArray) -> float:
        """Return the residual sum of squares of a spectrum in unit columns."""
        misfit = self.columns @ s[self.shown] - self.target
        return float(misfit @ misfit)

    # -- quantities -------------------------------------------------------------------------------

    def stiffness_at(self, omega: float) -> tuple[FloatArray, FloatArray]:
        """Return storage and loss of unit columns at omega, rad/s: shapes (m,)."""
        x = omega * self.tau
        storage = np.concatenate(([1.0, 0.0], x * x / (1 + x * x)))
        loss = np.concatenate(([0.0, omega], x / (1 + x * x)))
        return storage, loss

    def relaxed_to(self, time: float) -> FloatArray:
        r"""Relaxation :math:`k_\infty + \sum_j k_j e^{-t/\tau_j}` of unit columns, shape (m,)."""
        return np.concatenate(([1.0, 0.0], np.exp(-time / self.tau)))

    def slope_at(self, time: float) -> FloatArray:
        r"""Return its slope :math:`-dk/d\ln t` of unit columns, shape (m,)."""
        x = time / self.tau
        return np.concatenate(([0.0, 0.0], x * np.exp(-x)))

    def value(self, v: FloatArray) -> float:
        """V . k of the best spectrum."""
        return float(v @ (self.best / self.scale))

    # -- reaches ----------------------------------------------------------------------------------

    def find_extreme_spectrum(self, v: FloatArray) -> FloatArray:
        """Return the spectrum of the largest v . k, N/m, shape (m,)."""
        target_row, is_shown = v / self.scale, self.shown
        start = self.met[int((np.array(self.met) @ target_row).argmax())]
        values = np.zeros(len(target_row))
        values[is_shown] = self._confidence_region.find_farthest_point(
            target_row[is_shown], self.least + self.limit, start[is_shown]
        )
        self.met.append(values)
        stiffness = values / self.scale
        return (
            stiffness
            if is_shown.all()
            else np.where(~is_shown & (target_row > 0), np.inf, stiffness)
        )

    def limit_functional(self, v: FloatArray) -> tuple[float, float]:
        """Return smallest and largest v . k that the tests do not reject."""
        return _project_spectrum(v, self.find_extreme_spectrum(-v)), _project_spectrum(
            v, self.find_extreme_spectrum(v)
        )

    def ratio_reach(self, numerator: FloatArray, denominator: FloatArray) -> tuple[float, float]:
        """Smallest and largest (above . k) / (below . k), below . k > 0 (Dinkelbach 1967)."""
        return -self._largest_ratio(-numerator, denominator), self._largest_ratio(
            numerator, denominator
        )

    def _largest_ratio(self, numerator: FloatArray, denominator: FloatArray) -> float:
        if (numerator[~self.shown] > 0).any():
            return np.inf
        a, b = numerator / self.scale, denominator / self.scale
        values = [float(a @ s) / float(b @ s) for s in self.met if float(b @ s) > 0]
        if not values:  # the record knows of no stiffness at all, and so of no ratio
            return np.inf if (numerator > 0).any() else 0.0
        ratio = max(values)
        for _ in range(MAX_RATIO_STEPS):
            result = self.find_extreme_spectrum(numerator - ratio * denominator)
            if not float(denominator @ result) > 0:
                break
            gain = float(numerator @ result) - ratio * float(denominator @ result)
            larger = float(numerator @ result) / float(denominator @ result)
            if gain <= RATIO_TOLERANCE * abs(larger - ratio) or larger <= ratio:
                break
            ratio = larger
        return ratio


def _project_spectrum(v: FloatArray, spectrum: FloatArray) -> float:
    """V . k for the functional v."""
    is_requested = v != 0
    return float(v[is_requested] @ spectrum[is_requested])


def _spread(count: int) -> IndexArray:
    """Return indices in an order that halves the largest gap again and again.

    Columns of a triangular factor in this order leave all that they have in common in its first
    rows, and rounding in the others.
    """
    bits = max(count - 1, 1).bit_length()
    reversed_ = np.zeros(2**bits, dtype=np.intp)
    for bit in range(bits):
        reversed_ = 2 * reversed_ + (np.arange(2**bits) >> bit & 1)
    return reversed_[reversed_ < count]


def _merge_grids(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the points of both grids; `numpy.union1d` says the same and imports masked arrays."""
    points = np.sort(np.concatenate((first, second)))
    return np.asarray(points[np.append(True, np.diff(points) > 0)])


def _refine_grid(log_tau: FloatArray, active: BoolArray) -> FloatArray:
    """Return the grid with points put into the gaps on both sides of every active arm."""
    gaps = np.diff(log_tau)
    parallel = (active[1:] | active[:-1]) & (gaps > MIN_GRID_STEP)
    steps = np.arange(1, REFINEMENT_POINTS + 1) / (REFINEMENT_POINTS + 1)
    new = log_tau[:-1][parallel, None] + gaps[parallel, None] * steps
    return _merge_grids(log_tau, new.ravel())


# What a test says of the stiffness when it ends, and of where that ends.
#
# An arm slower than every hold is a spring there: no record bounds k_inf from below. What it knows
# is
#
# .. math:: k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}
#
# at the time T that it was held, and less and less of it at 3 T, and how steeply it still falls,
# :math:`-dk/d\ln t`: all over every spectrum that the tests do not reject
# (:mod:`dashpot.fitting.admissible_spectra`). Of a sweep it knows the storage at its
# lowest line, and less of it below; of creep the compliance.


def spectra_of_holds(
    relaxations: Sequence[RelaxationData],
    *,
    time: float,
    model: GeneralizedMaxwell,
    dof: float,
    level: float = 0.95,
) -> AdmissibleSpectra:
    """Return the spectra that some holds do not reject, as :func:`compute_end_limits` asks."""
    spectra = AdmissibleSpectra(
        relaxations, fastest=1 / time, limit=deviance_limit(level, dof), extra=model.tau
    )
    spectra.validate_misfit(*misfits(relaxations))
    return spectra


def compute_end_limits(
    relaxations: Sequence[RelaxationData],
    *,
    time: float,
    model: GeneralizedMaxwell,
    dof: float,
    level: float = 0.95,
    spectra: AdmissibleSpectra | None = None,
) -> EndOfHold:
    """Return the limits of k(T), k(3 T), k_inf, and of the slope at T.

    They hold the fit itself: nothing is printed outside its own interval.

    Parameters
    ----------
    relaxations : sequence of RelaxationData
    time : float
        T, how long the longest of them was held, s.
    model : GeneralizedMaxwell
        The fit.
    dof : float
        Degrees of freedom of the noise.
    level : float
        Coverage of each limit, nearly.
    spectra : AdmissibleSpectra, optional
        Those of :func:`spectra_of_holds`, where they are known already.
    """
    if spectra is None:
        spectra = spectra_of_holds(relaxations, time=time, model=model, dof=dof, level=level)
    slope_limit = spectra.slope_at(time)
    end = EndOfHold(
        end_time=time,
        k_end=compute_nonnegative_limits(spectra, spectra.relaxed_to(time)),
        k_3end=compute_nonnegative_limits(spectra, spectra.relaxed_to(3 * time)),
        k_inf=(0.0, compute_upper_limit(spectra, spectra.relaxed_to(np.inf))),
        slope_limit=compute_upper_limit(spectra, slope_limit),
        if_machine_named=_compute_named_rig_share(relaxations, spectra, time),
    )
    return end.widen_to_contain(model)


def _compute_named_rig_share(
    relaxations: Sequence[RelaxationData], spectra: AdmissibleSpectra, time: float
) -> float:
    """Return the share of the width of k(T) without compliance, settling and drift; else nan.

    About the best spectrum, whose arms are free: to first order.
    """
    if not any(data.unmeasured_effects for data in relaxations):
        return float("nan")
    tau = spectra.tau[spectra.best[2:] > 0]
    target_row = np.append(1.0, np.exp(-time / tau))

    def variance(data: Sequence[RelaxationData]) -> float:
        rows = [relaxation_data.rows(np.log(tau), with_slopes=False) for relaxation_data in data]
        matrix = np.vstack([np.column_stack((row.spring, row.arms)) for row in rows])
        scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        coefficients = np.linalg.lstsq((matrix / scale).T, target_row / scale, rcond=1e-9)[0]
        return float(coefficients @ coefficients)

    return float(np.sqrt(variance([relaxation.on_a_named_rig for relaxation in relaxations])
                         / variance(relaxations)))  # fmt: skip


def compute_nonnegative_limits(spectra: AdmissibleSpectra, v: FloatArray) -> Interval:
    """Return limits of a sum that cannot be negative, freed of rounding."""
    low, high = spectra.limit_functional(v)
    return max(low, 0.0), max(high, 0.0)


def compute_upper_limit(spectra: AdmissibleSpectra, v: FloatArray) -> float:
    """Return the largest value of a linear functional over the admissible spectra."""
    return float(v @ spectra.find_extreme_spectrum(v))


# The set of stiffnesses that tests allow at one frequency, and how a mass on any of them answers.
#
# The set of (K', K'') over all spectra that a test does not reject is convex: it is felt by its
# support in some directions, chosen where they show most.


# Relative tolerance between the inner (points) and the outer (tangents) approximation of the set.
REGION_TOLERANCE = 0.01
# largest number of directions of the support function
MAX_DIRECTIONS = 40
# ratio to the dynamic stiffness of the mass that counts as infinite
INFINITE_STIFFNESS_RATIO = 1e9
_TINY = float(np.finfo(float).tiny)


def compute_distance_range(
    spectra: AdmissibleSpectra, omega: float, inertia: float
) -> tuple[float, float]:
    """Nearest and farthest distance of the convex set of (K', K'') from (inertia, 0), outer."""
    stiffness_set = StiffnessSet(spectra, omega, inertia)
    while True:
        nearest_point, is_inside = stiffness_set.find_hull_point()
        corner = max(stiffness_set.corners(), key=abs)
        if len(stiffness_set) >= MAX_DIRECTIONS:
            break
        gap_near = (
            0.0
            if is_inside
            else 1 - stiffness_set.nearest_distance_bound / max(abs(nearest_point), 1e-300)
        )
        # a set that is one point, where the point is, has no farther one
        gap_far = 1 - stiffness_set.max_distance / abs(corner) if corner else 0.0
        if max(gap_near, gap_far) <= REGION_TOLERANCE:
            break
        stiffness_set.add_direction(-nearest_point if gap_near > gap_far else corner)
    return 0.0 if is_inside else stiffness_set.nearest_distance_bound, abs(corner)


def compute_transmissibility_range(
    spectra: AdmissibleSpectra, omega: float, inertia: float, coupled: float = 0.0
) -> tuple[float, float]:
    r"""Lowest and highest transmissibility :math:`|K| / |K - m\omega^2/n|` over the set, outer.

    `coupled` is what mounts that weigh something add to K above the line, N/m.

    Its logarithm is harmonic but where either distance is none: over a polygon it is extreme on
    the edges. Where it goes beyond 1 upwards, or below 1 downwards, the stiffnesses that go as far
    are a disc, which a straight line parts from the set; else a corner reaches farthest.
    """
    stiffness_set = StiffnessSet(spectra, omega, inertia)
    base = inertia + coupled
    while True:
        outer = [_find_extreme_ratio(stiffness_set.corners(), base, sign) for sign in (1, -1)]
        inner_extremes = [_find_extreme_ratio(stiffness_set.points, base, sign) for sign in (1, -1)]
        (largest, _), (smallest, _) = outer
        # where nothing limits a ratio nothing more can be felt
        gap_sizes = [
            0.0 if inner_extremes[0][0] == largest else 1 - inner_extremes[0][0] / largest,
            0.0 if inner_extremes[1][0] == smallest else 1 - smallest / inner_extremes[1][0],
        ]
        worst_index = int(np.argmax(gap_sizes))
        if gap_sizes[worst_index] <= REGION_TOLERANCE or len(stiffness_set) >= MAX_DIRECTIONS:
            return smallest, largest
        sign, disc = ((1, largest > 1), (-1, smallest < 1))[worst_index]
        frequency = (inner_extremes if disc else outer)[worst_index][1]
        stiffness_set.add_direction(complex(*(sign * _find_steepest_direction(frequency, base))))


class StiffnessSet:
    """Admissible stiffnesses at one frequency by supports in some directions, with a mass.

    Stiffnesses and directions are complex numbers, in the order of the directions from -pi to pi:
    so are the points then, of which each is a corner of their hull.
    """

    def __init__(self, spectra: AdmissibleSpectra, omega: float, inertia: float) -> None:
        self._columns, self._spectra = np.array(spectra.stiffness_at(omega)), spectra
        self._inertia = inertia
        self._angles: list[float] = []
        self._directions: list[complex] = []
        self.points: list[complex] = []
        for direction in (1, -1, 1j, -1j):
            self.add_direction(direction)

    def __len__(self) -> int:
        return len(self.points)

    def add_direction(self, direction: complex) -> None:
        """Feel the set in one more direction."""
        unit = direction / abs(direction)
        storage, loss = self._columns
        spectrum = self._spectra.find_extreme_spectrum(unit.real * storage + unit.imag * loss)
        open_ended = np.isinf(spectrum)
        if open_ended.any():
            # as good as without end, and still a point
            support_limit = INFINITE_STIFFNESS_RATIO * self._inertia / np.hypot(storage, loss)
            spectrum = np.where(open_ended, support_limit, spectrum)
        farthest_point = complex(*(self._columns @ spectrum).tolist())
        place = bisect(self._angles, angle := phase(unit))
        self._angles.insert(place, angle)
        self._directions.insert(place, unit)
        self.points.insert(place, farthest_point - self._inertia)

    @property
    def _supports(self) -> list[float]:
        """Return the largest extent of the set in each direction."""
        return [_dot(*pair) for pair in zip(self._directions, self.points, strict=True)]

    @property
    def nearest_distance_bound(self) -> float:
        """No point of the set is nearer."""
        return max(0.0, -min(self._supports))

    @property
    def max_distance(self) -> float:
        """Largest distance of a point of the set from the origin."""
        return max(map(abs, self.points))

    def find_hull_point(self) -> tuple[complex, bool]:
        """The nearest point of the hull of all points met, and whether the origin is in it."""
        angles = sorted(map(phase, self.points))
        widest = max(b - a for a, b in pairwise((*angles, angles[0] + 2 * pi)))
        nearest_point = min(
            starmap(_find_nearest_point, pairwise((*self.points, self.points[0]))), key=abs
        )
        return nearest_point, widest < pi or nearest_point == 0

    def corners(self) -> list[complex]:
        """Corners of the polygon that the support lines enclose, in their order."""
        lines = [*zip(self._directions, self._supports, strict=True)]
        return [
            complex(h * v.imag - g * u.imag, g * u.real - h * v.real) / cross_product
            for (u, h), (v, g) in pairwise((*lines, lines[0]))
            if (cross_product := (u.conjugate() * v).imag) > 1e-9
        ]


def _dot(first: complex, second: complex) -> float:
    return first.real * second.real + first.imag * second.imag


def _find_nearest_point(start: complex, end: complex) -> complex:
    """Return the point nearest to the origin of the way from one to another."""
    edge = end - start
    length = _dot(edge, edge)
    fraction = -_dot(start, edge) / length if length > 0 else 0.0
    return start + min(max(fraction, 0.0), 1.0) * edge


def _find_extreme_ratio(
    corners: list[complex], offset: float, sign: int
) -> tuple[float, FloatArray]:
    """Return the highest (sign 1) or lowest ratio |d + offset| / |d| over a polygon, and where."""
    start = np.array(corners).view(float).reshape(-1, 2)
    edges = np.roll(start, -1, axis=0) - start
    base = start + np.array([offset, 0.0])
    pole = start if sign > 0 else base
    if _contains_origin(pole, edges):
        return (np.inf if sign > 0 else 0.0), start[0]
    # d over each edge is a + s v: the ratio's square is one of quadratics in s
    v2 = np.vecdot(edges, edges)
    n0, n1 = np.vecdot(base, base), 2 * np.vecdot(base, edges)
    d0, d1 = np.vecdot(start, start), 2 * np.vecdot(start, edges)
    a, b, c = v2 * (d1 - n1), v2 * (d0 - n0), n1 * d0 - n0 * d1
    with np.errstate(divide="ignore", invalid="ignore"):
        half_sum = -(b + np.copysign(np.sqrt(b * b - a * c), b))
        steps = np.array([half_sum / a, c / half_sum, np.zeros_like(a)])
    steps = np.clip(np.nan_to_num(steps, nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
    points = (start + steps[..., None] * edges).reshape(-1, 2)
    with np.errstate(divide="ignore"):
        ratio = np.linalg.norm(points + np.array([offset, 0.0]), axis=1) / np.linalg.norm(
            points, axis=1
        )
    best_index = int(np.argmax(sign * ratio))
    return float(ratio[best_index]), points[best_index]


def _contains_origin(start: FloatArray, edges: FloatArray) -> bool:
    """Return whether the origin lies within a convex polygon, its corners turning to the left."""
    residual = edges[:, 1] * start[:, 0] - edges[:, 0] * start[:, 1]
    return bool((residual >= 0).all() and (residual > 0).any())


def _find_steepest_direction(point: FloatArray, offset: float) -> FloatArray:
    """Return the direction in which ln (|d + offset| / |d|) grows most."""
    base = point + np.array([offset, 0.0])
    return np.asarray(
        base / max(float(base @ base), _TINY) - point / max(float(point @ point), _TINY)
    )
