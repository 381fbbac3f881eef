"""From FRFs at several levels to arms and sliders: linear, with the measured amplitude."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, Range, si, si_range
from dashpot.fitting.level.checks import (
    MATTERS,
    amplitudes_spread,
    level_matters,
    levels_followed,
)
from dashpot.records.frf import FRF, Kind
from dashpot.records.level import LevelFit
from dashpot.solids.friction import Jenkins, slipping_share
from dashpot.solids.maxwell import GeneralizedMaxwell

_PER_DECADE = 10
_FINER = 8
"""A second grid between the neighbours of every slider found: a sharp one leaves 0.05 % without."""
_NOTHING = 1e-9
_THIRD = float(np.sqrt(20 * np.log(2)))
"""Median size of a third difference over the rms size of complex noise (Rayleigh)."""
_FLOOR = 1e-3
"""No line is trusted beyond this part of its value."""
_DRAWS = 60
_LEAST = 8
"""Lines at a level."""


def fit_levels(
    frfs: Sequence[FRF],
    levels: Sequence[Quantity],
    *,
    mass: Quantity,
    seals: float = 1.0,
    band: Range | None = None,
    seed: int = 0,
) -> LevelFit:
    r"""Fit one solid and its friction to FRFs of one mass at several levels.

    Each line is a measured stiffness at a measured amplitude, and every unknown is linear in it:

    .. math:: \frac{F_i}{X_i} + m\omega_i^2 = k_\infty
        + \sum_j k_j \frac{j\omega_i\tau_j}{1 + j\omega_i\tau_j}
        + \sum_s k_s\, J(|X_i|; x_s), \qquad k \ge 0

    over grids of tau and of yield displacements (J of a Jenkins element), weighted by X over F.
    Friction is taken where it explains what arms alone do not by 2 ln L > 20. No balance of
    harmonics is needed; noise of the amplitude does no harm (5 %: 0.4 % of the stiffness).

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
        Of the draws that say how well all is known.

    Raises
    ------
    DataError
        If the levels do not belong to the FRFs, or a level has too few lines.
    """
    if len(frfs) != len(levels) or not frfs:
        raise DataError(
            f"{len(frfs)} FRFs and {len(levels)} levels; expected one level for each FRF"
        )
    kilograms = si(mass, "mass")
    sizes = [_level(frf, level) for frf, level in zip(frfs, levels, strict=True)]
    rows = [
        rows_at_level(frf, size, kilograms, seals, si_range(band, "frequency"))
        for frf, size in zip(frfs, sizes, strict=True)
    ]
    omega, X, K, weight = (np.concatenate(each) for each in zip(*rows, strict=True))
    low, high = float(X.min()) / 2, float(X.max())
    count = max(round(_PER_DECADE * np.log10(high / low)), 2)
    problem = _Problem(omega, X, weight, np.geomspace(low, high, count + 1)[:-1])
    alone, plain = problem.solve(K, friction=False)
    finer, (whole, both) = problem.with_sliders(K)
    n = 2 * len(K)
    floor = n * 1e-20
    rss_plain, rss_both = (max(float((np.abs(r) ** 2).sum()), floor) for r in (plain, both))
    gain = n * float(np.log(rss_plain / rss_both))
    chosen, left = (whole, both) if gain > MATTERS else (alone, plain)
    scatter = float(np.sqrt((np.abs(left) ** 2).mean() / 2))
    rng = np.random.default_rng(seed)
    draws = []
    inertia = kilograms * omega**2 / seals
    direct = K + left / weight - inertia  # F/X of the fit itself
    for _ in range(_DRAWS):
        # one error of the FRF is in the stiffness and in the amplitude
        off = 1 + scatter * (rng.normal(size=len(K)) + 1j * rng.normal(size=len(K)))
        other, again = direct * off + inertia, replace(problem, X=X / np.abs(off))
        if gain > MATTERS:  # where the sliders are found moves, too
            grid, (k, _) = again.with_sliders(other)
            draws.append(grid.parts(k))
        else:
            draws.append(again.parts(again.solve(other, friction=False)[0]))
    solid, sliders = (finer if gain > MATTERS else problem).parts(chosen)
    range_ = (float(X.min()), float(X.max()))
    residual = float(np.sqrt((np.abs(left) ** 2).mean()))
    begins = np.cumsum([len(each[0]) for each in rows])[:-1]
    followed = levels_followed(residual, _noise(problem, K, begins))
    return LevelFit(
        solid,
        sliders,
        range_,
        (float(omega.min() / 2 / np.pi), float(omega.max() / 2 / np.pi)),
        residual,
        float(np.sqrt((np.abs(plain) ** 2).mean())),
        tuple(draws),
        kilograms,
        seals,
        tuple(sizes),
        (
            level_matters(gain, range_, "m", followed=bool(followed.passed)),
            amplitudes_spread(range_[1] / range_[0], "m"),
            followed,
        ),
        tuple(one for frf in frfs for one in frf.source),
    )


@dataclass(frozen=True, eq=False)
class _Problem:
    omega: FloatArray
    X: FloatArray
    weight: FloatArray
    #: yield displacements, m: beyond the largest amplitude a slider is a spring
    yields: FloatArray

    @property
    def tau(self) -> FloatArray:
        """Relaxation times that the band can tell from a spring and a dashpot, s."""
        low, high = 1 / self.omega.max() / 30, 1 / self.omega.min() * 30
        return np.geomspace(low, high, round(_PER_DECADE / 2 * np.log10(high / low)) + 1)

    def with_sliders(self, K: ComplexArray) -> tuple[_Problem, tuple[FloatArray, ComplexArray]]:
        """Solved on a coarse grid, and on a finer one about the sliders found there."""
        k, _ = self.solve(K, friction=True)
        found = np.flatnonzero(k[1 + len(self.tau) :] > _NOTHING * float(k.sum()))
        step = self.yields[1] / self.yields[0]
        near = step ** (np.arange(-_FINER, _FINER + 1) / _FINER)
        finer = np.unique((self.yields[found, None] * near).round(15))
        fine = replace(self, yields=finer) if len(found) else self
        return fine, fine.solve(K, friction=True)

    def _columns(self, friction: bool) -> ComplexArray:
        product = 1j * self.omega[:, None] * self.tau
        found = [np.ones((len(self.X), 1), dtype=complex), product / (1 + product)]
        if friction:
            found.append(slipping_share(self.X[:, None], self.yields))
        return np.hstack(found)

    def solve(self, K: ComplexArray, *, friction: bool) -> tuple[FloatArray, ComplexArray]:
        """Coefficients >= 0 and the weighted residual."""
        from scipy.optimize import nnls  # costs an import that few need

        A = self._columns(friction) * self.weight[:, None]
        y = K * self.weight
        k, _ = nnls(np.vstack((A.real, A.imag)), np.concatenate((y.real, y.imag)))
        return k, np.asarray(A @ k - y)

    def parts(self, k: FloatArray) -> tuple[GeneralizedMaxwell, tuple[Jenkins, ...]]:
        """The solid and the sliders; those that are nothing are left out."""
        arms, sliders = k[1 : 1 + len(self.tau)], k[1 + len(self.tau) :]
        least = _NOTHING * float(k.sum())
        solid = GeneralizedMaxwell(
            float(k[0]), tuple(arms[arms > least]), tuple(self.tau[arms > least])
        )
        return solid, tuple(
            Jenkins(float(each), float(each * at))
            for each, at in zip(sliders, self.yields, strict=False)
            if each > least
        )


def _level(frf: FRF, level: Quantity) -> float:
    """Amplitude of the force, N, or of the ground's acceleration, m/s^2."""
    size = si(level, "acceleration" if frf.kind is Kind.TRANSMISSIBILITY else "force")
    if not size > 0:
        raise DataError(f"level = {level!r}; expected an amplitude > 0")
    return size


def rows_at_level(
    frf: FRF, level: float, mass: float, seals: float, band: tuple[float, float] | None = None
) -> tuple[FloatArray, FloatArray, ComplexArray, FloatArray]:
    """Frequencies rad/s, amplitudes m, stiffness of one seal N/m, weights: usable lines.

    Raises
    ------
    DataError
        If they are too few.
    """
    lines = frf.only(frf.usable)
    lines = lines if band is None else lines.band(*band)
    if len(lines.value) < _LEAST:
        raise DataError(
            f"{len(lines.value)} usable lines at the level {level:g}; expected {_LEAST} or more"
        )
    pull = mass * level if lines.kind is Kind.TRANSMISSIBILITY else level
    receptance = lines.to(Kind.RECEPTANCE, mass=mass)
    direct = 1 / receptance.value
    K = (direct + mass * lines.omega**2) / seals
    weight = seals / np.abs(direct) * _knowledge(lines)
    return lines.omega, np.abs(receptance.value) * pull, K, np.asarray(weight)


def _knowledge(lines: FRF) -> FloatArray:
    """Weights of lines less well known than most, by the error that the FRF states: at most 1."""
    if lines.line_scatter is None:
        return np.ones(len(lines.value))
    relative = np.maximum(lines.line_scatter / np.abs(lines.value), _FLOOR)
    return np.asarray(np.minimum(np.median(relative) / relative, 1.0))


def _noise(problem: _Problem, K: ComplexArray, parts: IndexArray) -> float | None:
    """Relative scatter of F/X from line to line: what no smooth stiffness follows.

    By third differences within a level (which begin at `parts`), sqrt(20) times the scatter: an
    FRF need not state its error. None with too few lines.
    """
    left = [
        np.diff(k, 3) * (weight[1:-2] + weight[2:-1]) / 2
        for k, weight in zip(np.split(K, parts), np.split(problem.weight, parts), strict=True)
        if len(k) >= _LEAST
    ]
    if not left:
        return None
    return max(float(np.median(np.abs(np.concatenate(left)))) / _THIRD, _FLOOR)
