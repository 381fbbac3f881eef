"""Fit of arms, sliders and a cubic spring to FRFs at several amplitudes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.base.value_ranges import SIZES, format_quantity_short
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.amplitude.checks import (
    MAX_RESIDUAL_SHARE,
    SIGNIFICANT_DEVIANCE,
    amplitude_dependence_detected,
    amplitudes_spread,
    levels_controlled,
    levels_residual_small,
)
from dashpot.extensions.amplitude.level_results import LevelFit, Parts
from dashpot.extensions.amplitude.response import stiffness_at, with_third_harmonic
from dashpot.numerics.least_squares import stack_real_rows
from dashpot.numerics.nonnegative_least_squares import solve_linear
from dashpot.solids.jenkins import Jenkins, jenkins_reduction
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.vibration.modal.pole_fit import MIN_LINE_ERROR

_PER_DECADE = 10
_FINE_GRID_POINTS = 8
"""Points to either side of each slider in a finer grid; without it the error is up to 0.05 %."""
_ROUNDING = 1e-9
_THIRD_DIFFERENCE_RATIO = float(np.sqrt(20 * np.log(2)))
"""Median size of a third difference over the rms size of complex noise (Rayleigh)."""
_NEIGHBOUR_LINES = 20
"""Number of neighbouring lines with equal errors."""
_DRAWS = 60
_PASSES = 2
_STEP = 1e-4
_MIN_LINES = 8
"""Lines at a level."""

Term = Literal["friction", "a cubic spring"]
_TERMS: tuple[tuple[Term, ...], ...] = (
    (),
    ("friction",),
    ("a cubic spring",),
    ("friction", "a cubic spring"),
)


def fit_levels(
    frfs: Sequence[FRF],
    levels: Sequence[Quantity],
    *,
    mass: Quantity,
    seals: float = 1.0,
    band: Range | None = None,
    seed: int = 0,
) -> LevelFit:
    r"""Fit one solid, its friction and its stiffening to FRFs of one mass at several amplitudes.

    Each line is a measured stiffness at a measured amplitude, and every unknown is linear in it:

    .. math:: \frac{F_i}{X_i} + m\omega_i^2 = k_\infty
        + \sum_j k_j \frac{j\omega_i\tau_j}{1 + j\omega_i\tau_j}
        + \sum_s k_s\, J(|X_i|; x_s) + \tfrac34 k_3 |X_i|^2, \qquad k \ge 0

    over grids of tau and of yield displacements (J of a Jenkins element), weighted by X over F;
    k_3 of a cubic spring has either sign. Friction, the spring, or both are taken where each
    explains what is left without it by 2 ln L > 20. No balance of harmonics is needed, but for the
    third one of the spring; noise of the amplitude does no harm (5 %: 0.4 % of the stiffness).

    Parameters
    ----------
    frfs : sequence of FRF
        Per force, or transmissibilities.
    levels : sequence of str or float
        Amplitude of the force at each, N, constant over the lines; of a transmissibility that of
        the ground's acceleration, m/s^2.
    mass : str or float
        kg.
    seals : float
        That carry it.
    band : str or (float, float), optional
        Hz.
    seed : int
        Seed of the draws that say how well all is known.

    Raises
    ------
    DataError
        If the levels do not belong to the FRFs, or a level has too few lines.
    """
    if len(frfs) != len(levels) or not frfs:
        raise DataError(
            f"{len(frfs)} FRFs and {len(levels)} amplitudes; expected one amplitude for each FRF"
        )
    kilograms = convert_to_si(mass, "mass")
    sizes = [_get_level(frf, level) for frf, level in zip(frfs, levels, strict=True)]
    rows = [
        compute_level_rows(frf, size, kilograms, seals, si_range(band, "frequency"))
        for frf, size in zip(frfs, sizes, strict=True)
    ]
    omega, X, K, weight = (np.concatenate(group) for group in zip(*rows, strict=True))
    low, high = float(X.min()) / 2, float(X.max())
    SIZES["amplitude"].refuse(
        high,
        f"at these amplitudes a seal would move by {format_quantity_short(high, 'm')}",
        remedy="Check the amplitudes and their unit, such as --amplitude 20mN, and the mass.",
    )
    count = max(round(_PER_DECADE * np.log10(high / low)), 2)
    inertia, yield_displacements = kilograms / seals, np.geomspace(low, high, count + 1)[:-1]
    values = weight * np.abs(K - inertia * omega**2)
    problem = _LineData(omega, X, weight, values, inertia, yield_displacements)
    candidates = [problem.fit_terms(K, terms) for terms in _TERMS]
    linear_fit, best = (
        candidates[0],
        min(
            candidates,
            key=lambda optimum: optimum.deviance + SIGNIFICANT_DEVIANCE * len(optimum.terms),
        ),
    )
    draws = _redraw_fits(problem, K, best, seed)
    solid, elements = best.parts
    range_ = (float(X.min()), high)
    row_stops = np.cumsum([len(row[0]) for row in rows])[:-1]
    residual_check = levels_residual_small(best.residual, _estimate_noise(problem, K, row_stops))
    gains = {
        " and ".join(optimum.terms): linear_fit.deviance - optimum.deviance
        for optimum in candidates[1:]
    }
    terms_text = " and ".join(best.terms)
    return LevelFit(
        solid,
        elements,
        range_,
        (float(omega.min() / 2 / np.pi), float(omega.max() / 2 / np.pi)),
        best.residual,
        linear_fit.residual,
        draws,
        kilograms,
        seals,
        tuple(sizes),
        (
            levels_controlled(
                [_get_frf_name(frf, i) for i, frf in enumerate(frfs, 1) if frf.is_from_hits]
            ),
            amplitude_dependence_detected(
                gains.get(terms_text) or max(gains[arg] for arg in get_args(Term)),
                range_,
                "m",
                terms_text,
                is_explained=bool(residual_check.passed),
            ),
            amplitudes_spread(range_[1] / range_[0], "m"),
            residual_check,
        ),
        tuple(source for frf in frfs for source in frf.source),
        tuple(gains.items()),
    )


def _get_frf_name(frf: FRF, number: int) -> str:
    return ", ".join(source.file for source in frf.source) or f"FRF {number}"


def _redraw_fits(
    problem: _LineData, K: ComplexArray, best: _TermsOptimum, seed: int
) -> tuple[Parts, ...]:
    """Return the same fit of randomly perturbed records."""
    rng, inertia = np.random.default_rng(seed), problem.inertia * problem.omega**2
    direct = K + best.residuals / best.problem.weight - inertia  # F/X of the fit itself
    scatter = best.residual / np.sqrt(2)
    data = replace(
        problem, weight=best.problem.weight, harmonic_factor=best.problem.harmonic_factor
    )
    pairs = []
    for _ in range(_DRAWS):
        # one error of the FRF is in the stiffness and in the amplitude
        random_factors = (
            1
            + scatter
            * (rng.normal(size=len(K)) + 1j * rng.normal(size=len(K)))
            / problem.reliability
        )
        simulated_data = replace(data, amplitude=problem.amplitude / np.abs(random_factors))
        pairs.append(
            simulated_data.fit_terms(
                direct * random_factors + inertia, best.terms, iterations=0
            ).parts
        )
    return tuple(pairs)


@dataclass(frozen=True, eq=False)
class _TermsOptimum:
    """Coefficients >= 0 of one set of terms, and the weighted residual."""

    problem: _LineData
    terms: tuple[Term, ...]
    coefficients: FloatArray
    residuals: ComplexArray

    @property
    def residual(self) -> float:
        """Rms of the residual of F/X."""
        return float(np.sqrt((np.abs(self.residuals) ** 2).mean()))

    @property
    def deviance(self) -> float:
        """Minus twice the log likelihood, but for a constant."""
        rss = 2 * len(self.residuals) * float(np.log(max(self.residual**2, 1e-20)))
        return rss - 4 * float(np.log(self.problem.weight).sum())

    @property
    def parts(self) -> Parts:
        """The solid and the parts parallel to it that are not zero."""
        problem, k = self.problem, self.coefficients
        min_stiffness = _ROUNDING * float(k.sum())
        arms, yield_stiffness = k[1 : 1 + len(problem.tau)], k[1 + len(problem.tau) :]
        solid = GeneralizedMaxwell(
            float(k[0]), tuple(arms[arms > min_stiffness]), tuple(problem.tau[arms > min_stiffness])
        )
        parallel: list[Jenkins | Cubic] = []
        if "friction" in self.terms:
            parallel += [
                Jenkins(float(value), float(value * yield_displacement))
                for value, yield_displacement in zip(
                    yield_stiffness, problem.yield_displacements, strict=False
                )
                if value > min_stiffness
            ]
        if "a cubic spring" in self.terms and yield_stiffness[-2] != yield_stiffness[-1]:
            parallel.append(
                Cubic(
                    float(yield_stiffness[-2] - yield_stiffness[-1]) / problem.amplitude.max() ** 2
                )
            )
        return solid, tuple(parallel)


@dataclass(frozen=True, eq=False)
class _LineData:
    """Measured lines of the FRFs at their amplitudes."""

    omega: FloatArray
    amplitude: FloatArray
    weight: FloatArray
    #: of each line, beside most: at most 1
    reliability: FloatArray
    #: of one seal, kg
    inertia: float
    #: yield displacements, m: beyond the largest amplitude a slider is a spring
    yield_displacements: FloatArray
    #: what the third harmonic makes of the stiffness of a cubic spring
    harmonic_factor: ComplexArray | float = 1.0

    @property
    def tau(self) -> FloatArray:
        """Relaxation times that the band can distinguish from a spring and a dashpot, s."""
        low, high = 1 / self.omega.max() / 30, 1 / self.omega.min() * 30
        return np.geomspace(low, high, round(_PER_DECADE / 2 * np.log10(high / low)) + 1)

    def fit_terms(
        self, K: ComplexArray, terms: tuple[Term, ...], *, iterations: int = _PASSES
    ) -> _TermsOptimum:
        """Solved; sliders on a coarse grid, then on a finer one about those found there."""
        optimum = self._solve(K, terms)
        count = len(self.tau) + 1
        sliders = (
            optimum.coefficients[count : count + len(self.yield_displacements)]
            if "friction" in terms
            else np.zeros(0)
        )
        active = np.flatnonzero(sliders > _ROUNDING * float(optimum.coefficients.sum()))
        if len(active):
            step = self.yield_displacements[1] / self.yield_displacements[0]
            factors = step ** (
                np.arange(-_FINE_GRID_POINTS, _FINE_GRID_POINTS + 1) / _FINE_GRID_POINTS
            )
            finer = np.unique((self.yield_displacements[active, None] * factors).round(15))
            optimum = replace(self, yield_displacements=finer)._solve(K, terms)
        for _ in range(iterations if terms else 0):
            optimum = optimum.problem.weight_at_solution(optimum.parts, K)._solve(K, terms)
        return optimum

    def weight_at_solution(self, parts: Parts, K: ComplexArray) -> _LineData:
        r"""Return the data weighted by a solution: its third harmonic and amplitude errors.

        A relative error e of the FRF is an error :math:`-e F/X` of K and, through the amplitude
        at which it is taken to be, :math:`-\mathrm{Re}(e)\, dK/d\ln X`.
        """
        X, h = self.amplitude, _STEP
        up, down = (
            stiffness_at(parts, self.omega, X * scale, self.inertia) for scale in (1 + h, 1 - h)
        )
        slope, direct = (up - down) / (2 * h), K - self.inertia * self.omega**2
        magnitude = np.abs(direct) ** 2 + np.abs(slope) ** 2 / 2 + (direct * slope.conj()).real
        harmonic_factor = with_third_harmonic(parts, self.omega, X, self.inertia)
        return replace(
            self, weight=self.reliability / np.sqrt(magnitude), harmonic_factor=harmonic_factor
        )

    def _columns(self, terms: tuple[Term, ...]) -> ComplexArray:
        product = 1j * self.omega[:, None] * self.tau
        arrays = [np.ones((len(self.amplitude), 1), dtype=complex), product / (1 + product)]
        if "friction" in terms:
            arrays.append(jenkins_reduction(self.amplitude[:, None], self.yield_displacements))
        if "a cubic spring" in terms:  # it stiffens, or it softens
            square = 0.75 * (self.amplitude / self.amplitude.max()) ** 2 * self.harmonic_factor
            arrays.append(square[:, None] * np.array([1.0, -1.0]))
        return np.hstack(arrays)

    def _solve(self, K: ComplexArray, terms: tuple[Term, ...]) -> _TermsOptimum:
        A = self._columns(terms) * self.weight[:, None]
        y = K * self.weight
        k, _ = solve_linear(stack_real_rows(A), stack_real_rows(y), positive=True)
        return _TermsOptimum(self, terms, k, np.asarray(A @ k - y))


def _get_level(frf: FRF, level: Quantity) -> float:
    """Return amplitude of the force, N, or of the ground's acceleration, m/s^2."""
    size = convert_to_si(level, "acceleration" if frf.quantity.over_base else "force")
    if not size > 0:
        raise DataError(f"level = {level!r}; expected an amplitude > 0")
    return size


def compute_level_rows(
    frf: FRF, level: float, mass: float, seals: float, band: tuple[float, float] | None = None
) -> tuple[FloatArray, FloatArray, ComplexArray, FloatArray]:
    """Return frequencies rad/s, amplitudes m, stiffness of one seal N/m, weights: usable lines.

    Raises
    ------
    DataError
        If they are too few.
    """
    lines = frf.only(frf.usable)
    lines = lines if band is None else lines.band(*band)
    if len(lines.value) < _MIN_LINES:
        raise DataError(
            f"{len(lines.value)} usable lines at the amplitude {level:g}; expected {_MIN_LINES} "
            "or more"
        )
    bands = mass * level if lines.quantity.over_base else level
    receptance = lines.to(Kind.RECEPTANCE, mass=mass)
    direct = 1 / receptance.value
    K = (direct + mass * lines.omega**2) / seals
    weight = seals / np.abs(direct) * _compute_reliability(lines)
    return lines.omega, np.abs(receptance.value) * bands, K, np.asarray(weight)


def _compute_reliability(lines: FRF) -> FloatArray:
    """Return the weights of lines by the stated error of the FRF, at most 1."""
    if lines.line_scatter is None:
        return np.ones(len(lines.value))
    relative = np.maximum(lines.line_scatter / np.abs(lines.value), MIN_LINE_ERROR)
    return np.asarray(np.minimum(np.median(relative) / relative, 1.0))


def _estimate_noise(problem: _LineData, K: ComplexArray, parts: IndexArray) -> float | None:
    """Return the relative scatter of F/X from line to line.

    By third differences within a level (which begin at `parts`), sqrt(20) times the scatter: an
    FRF need not state its error; of neighbours, as lines beside a resonance are often worse known
    than those on it, and at most what leaves nothing explained. None with too few lines.
    """
    residuals = [
        np.diff(k, 3) * (weight[1:-2] + weight[2:-1]) / 2
        for k, weight in zip(np.split(K, parts), np.split(problem.weight, parts), strict=True)
        if len(k) >= _MIN_LINES
    ]
    if not residuals:
        return None
    group_residuals = [
        values
        for residual in residuals
        for values in np.array_split(np.abs(residual), max(len(residual) // _NEIGHBOUR_LINES, 1))
    ]
    size = [
        min(float(np.median(values)) / _THIRD_DIFFERENCE_RATIO, MAX_RESIDUAL_SHARE)
        for values in group_residuals
    ]
    rms = np.sqrt(np.average(np.square(size), weights=[len(values) for values in group_residuals]))
    return max(float(rms), MIN_LINE_ERROR)
