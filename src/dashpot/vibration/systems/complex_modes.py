"""Complex modes of a system, two ways that must agree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import ComplexArray, FrozenArrays
from dashpot.vibration.systems.state_space import state_space
from dashpot.vibration.systems.system import System

_RIGID = 1e-6
"""Relative square of a pole below which it counts as 0: a double pole is only known to the root
of rounding."""


_THERE, _ASIDE = 1e-9, 1e-3
"""Part of a pole found already within which a search stands on it, and by which it steps aside."""


@dataclass(frozen=True, eq=False)
class ComplexMode(FrozenArrays):
    r"""One pole of a system and how it moves there.

    Scaled so that :math:`\phi^T D'(s) \phi = 1` with the dynamic stiffness D(s): then

    .. math:: H(s) = \sum_r \frac{\phi_r \phi_r^T}{s - s_r}

    over all poles, conjugates included, is the receptance, exactly.

    Attributes
    ----------
    pole : complex
        1/s, imaginary part >= 0.
    shape : complex array, shape (n,)
        One number per degree of freedom.
    converged : bool
        False if an iteration ended before the pole stood still.
    """

    pole: complex
    shape: ComplexArray
    converged: bool = True

    @property
    def frequency(self) -> float:
        """Undamped natural frequency abs(s) / 2 pi, Hz."""
        return abs(self.pole) / (2 * np.pi)

    @property
    def damping_ratio(self) -> float:
        """Of the pole s, -Re s / abs(s); 1 for one that does not oscillate."""
        return -self.pole.real / abs(self.pole) if self.pole else 1.0

    @property
    def oscillates(self) -> bool:
        """False for a real pole, a relaxation."""
        return self.pole.imag > 0


def complex_modes(system: System) -> tuple[ComplexMode, ...]:
    """Every mode of a system by the eigenvalues of its exact first-order form.

    Oscillations first, by rising frequency, then relaxations, by falling rate. Rigid-body motions
    of a system that nothing holds, double poles at 0, are left out.
    """
    poles, vectors = np.linalg.eig(state_space(system).A)
    n = len(system.dofs)
    # rounding may leave a hair of an imaginary part on a real pole
    hair = 1e-9 * np.abs(poles) + 1e-13 * np.abs(poles).max()
    poles = np.where(np.abs(poles.imag) <= hair, poles.real, poles)
    rigid = _rigid_below(system)
    indices = np.flatnonzero((poles.imag >= 0) & (np.abs(poles) > rigid))
    with np.errstate(all="ignore"):  # the slope of an arm at its own rate
        slopes = system.spring_slope(poles[indices])
    modes = [
        ComplexMode(
            complex(poles[i]), _normalise_shape(system, complex(poles[i]), vectors[:n, i], slope)
        )
        for i, slope in zip(indices.tolist(), slopes, strict=True)
    ]
    return tuple(sorted(modes, key=lambda m: (not m.oscillates, abs(m.pole) * _sign(m))))


def newton_modes(system: System, *, iterations: int = 100) -> tuple[ComplexMode, ...]:
    r"""The oscillating modes by the nonlinear eigenproblem :math:`D(s)\phi = 0` itself.

    Newton's method on det D, whose logarithmic derivative is :math:`\mathrm{tr}(D^{-1} D')`,
    started near the poles by iterating :math:`s^2 = -\mathrm{eig}(M^{-1} E^T K(s) E)` from the
    glassy modes. Poles found already are divided out (Maehly), so no two starts end at the same
    one. No state of an arm appears: agreement with :func:`complex_modes` checks both. A mode so
    heavily damped that it does not oscillate may come out as one of its real poles.
    """
    results: list[complex] = []
    modes = []
    for start in _starts(system):
        s, near = _newton(system, start, results, iterations, 1e-6)
        s, there = _newton(system, s, results, iterations, 1e-14)
        s = s if s.imag >= 0 else s.conjugate()
        results.append(s)
        vector = np.linalg.svd(system.dynamic_stiffness(s))[2][-1].conj()
        shape = _normalise_shape(system, s, vector, system.spring_slope(s))
        modes.append(ComplexMode(s, shape, converged=near and there))
    return tuple(sorted(modes, key=lambda mode: mode.frequency))


def _starts(system: System) -> list[complex]:
    """Where to look for each mode: the stiffness at its own frequency, not the glassy one."""
    E = system.stretch
    inverse = np.linalg.inv(system.mass_matrix)
    glass = np.array([spring.felt.k_0 for spring in system.springs])
    squared = np.sort(np.linalg.eigvals(inverse @ (E.T * glass) @ E).real)
    starts = []
    for rank, value in enumerate(squared):
        if value <= _RIGID * squared[-1]:
            continue
        s = 1j * np.sqrt(value)
        for _ in range(20):
            K = system.spring_stiffness(s)
            around = np.linalg.eigvals(inverse @ (E.T * K) @ E)
            s = 1j * np.sqrt(around[np.argsort(np.abs(around))[rank]])
        starts.append(complex(s))
    return starts


def _newton(
    system: System, s: complex, results: list[complex], iterations: int, tolerance: float
) -> tuple[complex, bool]:
    best = np.inf
    for _ in range(iterations):
        if any(min(abs(s - p), abs(s - p.conjugate())) < _THERE * abs(s) for p in results):
            s += _ASIDE * abs(s)
        try:
            derivative = _derivative(system, s, system.spring_slope(s))
            change = np.linalg.solve(system.dynamic_stiffness(s), derivative)
        except np.linalg.LinAlgError:  # singular to the last digit: this is the pole
            return s, True
        slope = np.trace(change) - sum(1 / (s - p) + 1 / (s - p.conjugate()) for p in results)
        step = complex(1 / slope)
        s -= step
        size = abs(step) / abs(s)
        # at the floor of rounding the steps stop shrinking: the pole stands still
        if not np.isfinite(size):
            return s, False
        if size <= tolerance or (size < 1e-11 and size >= best):
            return s, True
        best = min(best, size)
    return s, False


def _derivative(system: System, s: complex, slopes: ComplexArray) -> ComplexArray:
    """dD/ds: 2 s M + E^T K'(s) E."""
    E = system.stretch
    return np.asarray(2 * s * system.mass_matrix + (E.T * slopes) @ E)


def _normalise_shape(
    system: System, s: complex, vector: ComplexArray, slopes: ComplexArray
) -> ComplexArray:
    """The shape; 0 of a relaxation so near that of its arm that nothing moves."""
    with np.errstate(all="ignore"):
        size = complex(vector @ _derivative(system, s, slopes) @ vector)
        shape = np.asarray(vector / np.sqrt(size))
    return shape if np.isfinite(shape).all() else np.zeros_like(vector)


def _rigid_below(system: System) -> float:
    """Size of a pole, 1/s, below which it is 0, if the system has motions that stretch no spring.

    Otherwise less than any.
    """
    stretch = system.stretch  # of no spring at all NumPy before 2.1 knows no rank
    if len(system.dofs) <= (np.linalg.matrix_rank(stretch) if stretch.size else 0):
        return -1.0
    inertia = float(np.trace(system.mass_matrix))
    glass = float(sum(spring.felt.k_0 for spring in system.springs))
    return float(np.sqrt(_RIGID * glass / inertia))


def _sign(mode: ComplexMode) -> int:
    return 1 if mode.oscillates else -1
