r"""Harmonic balance of a linear system with friction in some of its mounts.

The linear rest is exact: with C the compliance that the mounts with friction see, and e_0 how the
excitation would stretch them without it,

.. math:: e_h + C(h\omega) f_h = \delta_{h1} e_0, \qquad f_1 = N(\omega, |e_1|)\, e_1

for the harmonics h of their stretch e and friction f: one harmonic by the equivalent stiffness,
several by alternating between frequency and time (AFT), the friction marched until its loop
closes. Source: M. Krack and J. Gross, *Harmonic Balance for Nonlinear Vibration Problems*, 2019.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.extensions.systems.multibody import Point, System
from dashpot.numerics.harmonic_balance import AlternatingFrequencyTime, find_root_by_newton
from dashpot.solids.rate_independent import AmplitudeDependent

_SEARCH_GRID = np.log(10) * np.linspace(-7, 7, 1401)
"""Search grid of answers: ln of the stretch over that without friction."""
_SAMPLES = 256
"""Samples of a cycle in time; half as many are wrong by 0.03 %."""
_MAX_CYCLES, _CLOSURE_TOLERANCE = 200, 1e-8
"""Largest number of cycles until a loop closes, and its relative tolerance."""


def with_friction(system: System) -> list[int]:
    """Return which mounts have friction.

    Raises
    ------
    DataError
        If none has.
    """
    friction_mounts = [i for i, mount in enumerate(system.mounts) if mount.friction is not None]
    if not friction_mounts:
        raise DataError(
            "no mount of the system has friction: its response does not depend on the amplitude; "
            "take system.frf"
        )
    return friction_mounts


def with_slope(
    part: AmplitudeDependent, omega: FloatArray, X: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Stiffness, N/m, and its derivative by ln X."""
    h = 1e-5
    stiffer, softer = (part.equivalent(omega, X * np.exp(step)) for step in (h, -h))
    return part.equivalent(omega, X), np.asarray((stiffer - softer) / (2 * h))


class LinearSubsystem:
    """Linear part of a system, condensed to its friction elements."""

    def __init__(self, system: System, *, force: str | Point | None, base: str | None) -> None:
        if (force is None) == (base is None):
            raise DataError(
                "a force or a base that moves drives the system, one of the two (Python: force= or "
                "base=)"
            )
        if base is not None and base not in system.base_dofs:
            raise DataError(f"'{base}' is no ground motion; known: {', '.join(system.base_dofs)}")
        without_friction = with_friction(system)
        self.friction = [
            dependent
            for i in without_friction
            if (dependent := system.mounts[i].friction) is not None
        ]
        self.linear = replace(
            system, mounts=tuple(replace(mount, friction=None) for mount in system.mounts)
        )
        self.E = system.stretch[without_friction]
        self.push = None if force is None else system.participation(force)
        if base is not None:
            self.G = system.base_stretch[:, system.base_dofs.index(base)]
            self.ground = self.G[without_friction]

    def compliance(self, omega: float) -> ComplexArray:
        """Stretch of the mounts with friction per force of theirs, m/N, shape (p, p)."""
        return np.asarray(self.E @ self.linear.receptance(1j * omega) @ self.E.T)

    def line(self, omega: float, level: float) -> BalanceEquation:
        """Return the problem of one frequency and level."""
        R = self.linear.receptance(1j * omega)
        if self.push is not None:
            drive, change = self.push.astype(complex), np.zeros(len(self.E))
        else:
            K = self.linear.spring_stiffness(1j * omega)
            drive, change = -(K * self.G) @ self.linear.stretch, self.ground
        frictionless_stretch, spread_matrix = level * (R @ drive), R @ self.E.T
        stretch = self.E @ frictionless_stretch + level * change
        return BalanceEquation(
            self.friction,
            omega,
            stretch,
            np.asarray(self.E @ spread_matrix),
            frictionless_stretch,
            spread_matrix,
        )


@dataclass(frozen=True)
class BalanceEquation:
    """Balance equation e + C f(e) = e_0 at one frequency and level."""

    friction: list[AmplitudeDependent]
    omega: float
    stretch: ComplexArray
    compliance: ComplexArray
    frictionless_motion: ComplexArray
    motion_per_force: ComplexArray

    def compute_friction_force(self, e: ComplexArray) -> ComplexArray:
        """First harmonic of the friction forces, N; what holds a stuck one still."""
        if not e.any():
            return np.asarray(np.linalg.solve(self.compliance, self.stretch))
        forces = [
            complex(part.equivalent(self.omega, max(abs(value), 1e-300))) * value
            for part, value in zip(self.friction, e, strict=True)
        ]
        return np.array(forces)

    def solve_from_previous(self, previous_stretch: ComplexArray | None) -> ComplexArray:
        """Return the stable answer next to that of the line before; the smallest to begin with."""
        if len(self.stretch) > 1:
            return self._newton(previous_stretch)
        answers = [answer for answer in self.find_all_solutions() if self.is_stable(answer)]
        if previous_stretch is None or not previous_stretch.any():
            return answers[0]
        return min(
            answers, key=lambda e: abs(np.log(max(abs(e[0]), 1e-300) / abs(previous_stretch[0])))
        )

    def find_all_solutions(self) -> list[ComplexArray]:
        """Return every stretch, the smallest first: |1 + C N(X)| X = |e_0| for the one mount."""
        from scipy.optimize import brentq  # costs an import that few need

        C, e0 = complex(self.compliance[0, 0]), complex(self.stretch[0])
        (part,) = self.friction

        def evaluate_balance(u: npt.ArrayLike) -> FloatArray:
            X = abs(e0) * np.exp(u)
            return np.asarray(u + np.log(np.abs(1 + C * part.equivalent(self.omega, X))))

        value = evaluate_balance(_SEARCH_GRID)
        if value[0] > 0:  # even the smallest motion asks for more force than there is: it sticks
            return [np.zeros(1, dtype=complex)]
        turns = np.flatnonzero((value[:-1] <= 0) != (value[1:] <= 0))
        roots = [
            brentq(
                lambda u: float(evaluate_balance(u)),
                _SEARCH_GRID[i],
                _SEARCH_GRID[i + 1],
                xtol=1e-14,
            )
            for i in turns
        ]
        values = [abs(e0) * float(np.exp(u)) for u in roots]
        return [np.array([e0 / (1 + C * complex(part.equivalent(self.omega, X)))]) for X in values]

    def is_stable(self, e: ComplexArray) -> bool:
        """Return whether more force gives more motion at this frequency (one mount)."""
        if len(e) > 1 or not e.any():
            return True
        N, slope = with_slope(self.friction[0], np.asarray(self.omega), np.abs(e))
        total = 1 + complex(self.compliance[0, 0]) * N[0]
        return bool(
            (total.conjugate() * (total + complex(self.compliance[0, 0]) * slope[0])).real > 0
        )

    def _newton(self, previous_stretch: ComplexArray | None) -> ComplexArray:
        starts = [self._solve_stuck(), self.stretch]
        for start in starts if previous_stretch is None else [previous_stretch, *starts]:
            values = self._descend(np.array(start, dtype=complex))
            if values is not None:
                return values
        raise DataError(
            f"no answer was reached at {self.omega / 2 / np.pi:.5g} Hz from the line before; take "
            "finer steps of frequency or amplitude"
        )

    def _solve_stuck(self) -> ComplexArray:
        """Return the stretches before anything slips."""
        tiny = max(float(np.abs(self.stretch).max()), 1e-300) * 1e-6
        N = np.array([complex(part.equivalent(self.omega, tiny)) for part in self.friction])
        return np.asarray(np.linalg.solve(np.eye(len(N)) + self.compliance * N, self.stretch))

    def _descend(self, e: ComplexArray) -> ComplexArray | None:
        def residual(e: ComplexArray) -> ComplexArray:
            return np.asarray(e + self.compliance @ self.compute_friction_force(e) - self.stretch)

        size = float(np.abs(self.stretch).max())
        return find_root_by_newton(residual, self._newton_step, e, size=size)

    def _newton_step(self, e: ComplexArray, r: ComplexArray) -> ComplexArray:
        """Step of e whose linearised residual is r: d(N e) = N de + (dN/dlnX) e Re(e* de) / X^2."""
        X = np.maximum(np.abs(e), 1e-300)
        results = [
            with_slope(part, np.asarray(self.omega), np.asarray(item))
            for part, item in zip(self.friction, X, strict=True)
        ]
        N, slope = (np.array([complex(pair[i]) for pair in results]) for i in (0, 1))
        u = e / X
        # columns for a real and for an imaginary part of de
        real = self.compliance * (N + slope * u * u.real) + np.eye(len(e))
        imaginary = self.compliance * (1j * N + slope * u * u.imag) + 1j * np.eye(len(e))
        J = np.block([[real.real, imaginary.real], [real.imag, imaginary.imag]])
        step = np.linalg.solve(J, np.concatenate((r.real, r.imag)))
        return np.asarray(step[: len(e)] + 1j * step[len(e) :])


def solve_several_harmonics(
    subsystem: LinearSubsystem,
    line: BalanceEquation,
    first: ComplexArray,
    harmonics: tuple[int, ...],
) -> tuple[ComplexArray, ComplexArray, float]:
    """First harmonics of stretch and pull, and the largest higher one over the first (AFT)."""
    from scipy.optimize import root  # costs an import that few need

    C = [subsystem.compliance(h * line.omega) for h in harmonics]
    size, p = float(np.abs(first).max()), len(first)
    transform = AlternatingFrequencyTime(harmonics, _SAMPLES)

    def pulls(e: ComplexArray) -> ComplexArray:
        dt, path = 2 * np.pi / line.omega / _SAMPLES, transform.path(e)
        loops = [
            _compute_steady_cycle(part, dt, item)
            for part, item in zip(line.friction, path, strict=True)
        ]
        return transform.harmonics_of(np.array(loops))

    def stretches(z: FloatArray) -> ComplexArray:
        real, imaginary = z.reshape(2, len(harmonics), p)
        return np.asarray(size * (real + 1j * imaginary))

    def residual(z: FloatArray) -> FloatArray:
        e = stretches(z)
        r = e + np.array([c @ f for c, f in zip(C, pulls(e), strict=True)])
        r[0] -= line.stretch
        return np.concatenate((r.real.ravel(), r.imag.ravel())) / size

    start = np.zeros((len(harmonics), p), dtype=complex)
    start[0] = first / size
    solution = root(residual, np.concatenate((start.real.ravel(), start.imag.ravel())), tol=1e-10)
    if float(np.abs(residual(solution.x)).max()) > 1e-6:
        raise DataError(
            f"harmonics {harmonics} found no balance at {line.omega / 2 / np.pi:.5g} Hz: take "
            "finer steps, or one harmonic"
        )
    e = stretches(solution.x)
    ratio = float(np.abs(e[1:]).max() / np.abs(e[0]).max())
    return e[0], pulls(e)[0], ratio


def _compute_steady_cycle(part: AmplitudeDependent, dt: float, path: FloatArray) -> FloatArray:
    """Return force over a cycle once the loop has closed, N, shape (samples,)."""
    state, last = part.start(), np.full(len(path), np.inf)
    for _ in range(_MAX_CYCLES):
        force = np.empty(len(path))
        for i, x in enumerate(path.tolist()):
            force[i], state = part.advance(state, dt, x)
        if np.abs(force - last).max() <= _CLOSURE_TOLERANCE * np.abs(force).max():
            return force
        last = force
    raise DataError(
        f"a loop does not close within {_MAX_CYCLES} cycles, so small is its motion for its "
        "friction; ask for one harmonic"
    )
