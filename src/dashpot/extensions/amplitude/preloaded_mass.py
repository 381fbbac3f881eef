r"""Steady motion of a mass on a preloaded nonlinear seal that it may leave, by harmonics.

With x the compression, P what presses at rest and F a force on the mass,

.. math:: m \ddot x = P + F \cos\omega t - f, \qquad
    f = \max(0, G * F_e(x)), \qquad G(s) = K(s)/K(0), \qquad F_e(x \le 0) = 0

All arms answer the path :math:`F_e(x(t))` of the relaxed force (Fung), and go on relaxing while the
mass is off the seal. The steady answer :math:`x = c_0 + \operatorname{Re}\sum c_h e^{jh\omega t}`
solves, for h = 0 to H,

.. math:: f_h - (h\omega)^2 m\, c_h = P\,\delta_{h0} + F\,\delta_{h1}

by alternating between frequency and time: :math:`G(jh\omega)` acts on every harmonic of
:math:`F_e(x)`, as 1 on the mean, for the mean is relaxed, and contact ends after it. The answer is
followed from rest as the level rises. Whether it lasts, its Floquet multipliers show: harmonic
balance finds orbits that do not as readily. Source: M. Krack and J. Gross, *Harmonic Balance for
Nonlinear Vibration Problems*, 2019, chapters 2 to 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, ComplexArray, EqualByValue, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import GRAVITY, Quantity, convert_to_si, format_quantity
from dashpot.base.value_ranges import SIZES, format_quantity_short, require_positive
from dashpot.extensions.amplitude.polynomial_law import PolynomialLaw
from dashpot.numerics.harmonic_balance import AlternatingFrequencyTime, find_root_by_newton
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import Solid

BendingLaw: TypeAlias = ElasticLaw | PolynomialLaw

HARMONICS = 10
"""Number of harmonics of the lines of a sweep; one orbit takes as many as it needs."""
REPORTED_HARMONICS = 5
"""Harmonics that are reported."""
_MAX_HARMONICS, _HARMONIC_TOLERANCE = 80, 1e-7
"""Harmonics at most, and what twice as many may change of those shown, of the largest."""
_PER_HARMONIC, _MIN_COUNT = 32, 256
"""Samples per cycle for each harmonic, and their smallest number."""
_FLOQUET_STEPS = 256
_JUMP_RATIO, _MAX_HALVINGS, _STEP = 0.2, 8, 1e-5
"""Part of the first harmonic by which neighbours differ that may be two answers, and how often the
last step along one is halved to find where it ends; step of frequency for a slope."""
_MAX_STEPS, _MIN_STEP, _WIDEST = 400, 1e-5, 0.5
"""Steps of the level at most, the least of them, and how far an answer may lie from where the
tangent points, in steps."""
_STEPS_OF_SWEEP = 450
"""Steps of the level at most along all lines of a sweep: some 2 s. A mass that keeps to its seal
takes 30, one that leaves it for most of the cycle 400."""


@dataclass(frozen=True, eq=False)
class Orbit(EqualByValue):
    """Steady response of a preloaded mass to a force at one frequency.

    Attributes
    ----------
    frequency, level : float
        Hz; amplitude of the force, N.
    rest : float
        Compression without the force, m.
    harmonics : complex array, shape (H + 1,)
        Harmonics of the compression, m, the mean first: the real part of each turns with the
        force's phase.
    multiplier : complex
        The largest Floquet multiplier: by how much a small disturbance grows in a period.
    lost_contact : float
        Fraction of the cycle without contact.
    least, most : float
        Compressions between which it swings, m; a seal that has not recovered separates above 0.
    """

    frequency: float
    level: float
    rest: float
    harmonics: ComplexArray
    multiplier: complex
    lost_contact: float
    least: float
    most: float

    @property
    def amplitudes(self) -> FloatArray:
        """Amplitudes of the harmonics, m; the mean with its sign."""
        return np.abs(self.harmonics)

    @property
    def harmonic_amplitudes(self) -> FloatArray:
        """Amplitudes of the mean and of the first :data:`REPORTED_HARMONICS` harmonics, m."""
        return self.amplitudes[: REPORTED_HARMONICS + 1]

    @property
    def phases(self) -> FloatArray:
        """Phases of the harmonics against the force, rad."""
        return np.angle(self.harmonics[: REPORTED_HARMONICS + 1])

    @property
    def shift(self) -> float:
        """Mean compression less that at rest, m: below 0 the seal opens when shaken."""
        return float(self.harmonics[0].real) - self.rest

    @property
    def growth(self) -> float:
        """Size of the largest multiplier; below 1 the answer lasts."""
        return abs(self.multiplier)

    @property
    def stable(self) -> bool:
        """Whether a small disturbance dies away."""
        return self.growth < 1

    def refuse_unstable(self) -> None:
        """Refuse an answer that no test would show.

        Raises
        ------
        DataError
        """
        if self.stable:
            return
        explanation = (
            "it answers at twice the period, or without one"
            if self.multiplier.real < 0
            else "it jumps to another answer, or has none"
        )
        raise DataError(
            f"at {self.level:.4g} N and {self.frequency:.5g} Hz the steady answer at the drive's "
            f"period is unstable: a disturbance grows by {self.growth:.4g} in a period, so "
            f"{explanation}. Ask for a lower amplitude, or another frequency"
        )


class Jump(NamedTuple):
    """Last response of a branch before its end, and the one to which a sweep then jumps."""

    before: Orbit
    after: Orbit


class BalancedState(NamedTuple):
    """Solution of the harmonic balance, with the state of contact at each sample."""

    unknowns: FloatArray
    in_contact: BoolArray
    path: FloatArray


@dataclass(frozen=True)
class PreloadedMass:
    """Mass preloaded on a seal.

    Attributes
    ----------
    mass : float
        kg.
    law : ElasticLaw or PolynomialLaw
        Relaxed force of all that carries it.
    solid : Solid
        Its arms relax that force; its equilibrium stiffness is not used.
    preload : float or None
        N; by default the weight.

    Raises
    ------
    DataError
        If the preload is tensile, or is in equilibrium at no compression or at several.

    Examples
    --------
    >>> from dashpot.extensions.amplitude.polynomial_law import PolynomialLaw
    >>> from dashpot.solids.demo_seals import PAPER
    >>> law = PolynomialLaw((120.0, 1e4, 8e5))
    >>> shaken = PreloadedMass(0.1040426, 2 * law, PAPER).shaken(level="0.6N", frequency=9.5)
    >>> round(1e3 * float(shaken.shift), 3), (1e3 * shaken.amplitudes[:3]).round(3).tolist()
    (-0.251, [2.937, 2.032, 0.209])
    """

    mass: float
    law: BendingLaw
    solid: Solid
    preload: float | None = None

    def __post_init__(self) -> None:
        require_positive("PreloadedMass: ", mass=self.mass)
        if not self.static_force > 0:
            raise DataError(
                f"a preload of {self.static_force:.4g} N pulls: nothing holds the mass at rest; "
                "expected a force that presses, > 0"
            )
        if not self.solid.k_inf > 0:
            raise DataError(
                "the model relaxes to zero force: no compression carries a mass at rest; expected "
                "one with k_inf > 0"
            )
        if len(self._rest_positions) > 1:
            rest_positions = ", ".join(
                format_quantity(rest, "mm", ".4g") for rest in self._rest_positions
            )
            raise DataError(
                f"the elastic law is not monotone: {self.static_force:.4g} N rests at "
                f"{rest_positions}; expected a law that rises over all the compressions meant, or "
                "another preload"
            )

    @property
    def static_force(self) -> float:
        """Static force, N."""
        return self.mass * GRAVITY if self.preload is None else self.preload

    @cached_property
    def _rest_positions(self) -> tuple[float, ...]:
        return self.law.rests(self.static_force)

    @property
    def rest(self) -> float:
        """Compression at rest, m."""
        return self._rest_positions[0]

    def shaken(self, *, level: Quantity, frequency: Quantity) -> Orbit:
        """Return the steady response to a harmonic force, with as many harmonics as necessary.

        Parameters
        ----------
        level : str or float
            Amplitude of the force, N.
        frequency : str or float
            Hz.

        Raises
        ------
        DataError
            If the answer at the drive's period is unstable, none is reached (the last level that
            has one is said), or the mass would move farther than in any test.
        """
        F, hz = convert_to_si(level, "force"), convert_to_si(frequency, "frequency")
        require_positive("shaken: ", level=F, frequency=hz)
        line = _PressedBalance(self, hz, F, HARMONICS)
        state = line.solve_by_continuation()
        while 2 * line.most <= _MAX_HARMONICS:
            finer = _PressedBalance(self, hz, F, 2 * line.most)
            finer_state = finer.solve_from(line.extend_harmonics(state.unknowns, finer.most))
            if finer_state is None:
                break
            coarse_harmonics, fine_harmonics = (
                line.harmonics(state.unknowns),
                finer.harmonics(finer_state.unknowns),
            )
            change = np.abs(
                fine_harmonics[: REPORTED_HARMONICS + 1]
                - coarse_harmonics[: REPORTED_HARMONICS + 1]
            ).max()
            line, state = finer, finer_state
            if change <= _HARMONIC_TOLERANCE * np.abs(fine_harmonics).max():
                break
        orbit = line.orbit(state)
        orbit.refuse_unstable()
        return orbit

    def sweep(
        self, *, level: float, frequency: FloatArray, start: Orbit | None = None
    ) -> tuple[Orbit, ...]:
        """The answers to a force, N, over frequencies, Hz, in their order, :data:`HARMONICS` each.

        Each goes on from the one before, the first from `start`, where that leads to one that
        lasts, else it is followed from rest. Unstable ones are included; lines without one are
        omitted.

        Raises
        ------
        DataError
            If its answers change so often along the frequencies that no sweep follows them.
        """
        orbits: list[Orbit] = []
        previous, steps = start, 0
        for hz in np.asarray(frequency, dtype=float).tolist():
            orbit = None if previous is None else self._solve_near_orbit(previous, hz, level)
            if orbit is None or not orbit.stable:
                line = _PressedBalance(self, hz, level, HARMONICS)
                try:
                    states = line.solve_by_continuation()
                except DataError:
                    previous = None
                    continue
                finally:
                    steps += line.steps
                    if steps > _STEPS_OF_SWEEP:
                        self._refuse_bouncing(level, hz)
                orbit = line.orbit(states)
            previous = orbit if orbit.stable else None
            orbits.append(orbit)
        return tuple(orbits)

    def _refuse_bouncing(self, level: float, hz: float) -> None:
        raise DataError(
            f"at {level:.4g} N the mass, which {self.static_force:.4g} N presses, bounces on the "
            f"seal: up to {hz:.4g} Hz its answers change from line to line; expected an amplitude "
            "that leaves it on the seal. Ask for a lower amplitude"
        )

    def jumps(self, swept: Sequence[Orbit]) -> tuple[Jump, ...]:
        """Return the jumps of a sweep from one stable response to another.

        Beyond the jump both last, so that a sweep the other way meets the other one.
        """
        found_jumps = []
        for last, next_orbit in pairwise(swept):
            if not (
                last.stable
                and next_orbit.stable
                and _compare_orbits(next_orbit, last) > _JUMP_RATIO
            ):
                continue
            orbit_back = self._solve_near_orbit(next_orbit, last.frequency, next_orbit.level)
            if (
                orbit_back is None
                or not orbit_back.stable
                or _compare_orbits(orbit_back, last) <= _SAME_SOLUTION
            ):
                continue
            previous, excess = last, next_orbit.frequency
            for _ in range(_MAX_HALVINGS):
                midpoint = 0.5 * (previous.frequency + excess)
                middle_orbit = self._solve_near_orbit(previous, midpoint, previous.level)
                if (
                    middle_orbit is None
                    or not middle_orbit.stable
                    or _compare_orbits(middle_orbit, previous) > _JUMP_RATIO
                ):
                    excess = midpoint
                else:
                    previous = middle_orbit
            orbit_at_jump = (
                self._solve_near_orbit(next_orbit, excess, next_orbit.level) or next_orbit
            )
            found_jumps.append(Jump(previous, orbit_at_jump))
        return tuple(found_jumps)

    def changes(self, orbit: Orbit, others: Sequence[PreloadedMass]) -> ComplexArray:
        r"""Return by how much its harmonics would change on others instead, to first order.

        .. math:: \Delta z = -\left(\frac{\partial R}{\partial z}\right)^{-1} R'(z)

        with R' what the balance of the other leaves. Shape (others, H + 1), m.
        """
        line = _PressedBalance(self, orbit.frequency, orbit.level, len(orbit.harmonics) - 1)
        z = line.to_real(orbit.harmonics)
        residuals = [
            _PressedBalance(mass, orbit.frequency, orbit.level, line.most).balance(z, 1.0)
            for mass in others
        ]
        change = -np.linalg.solve(line.jacobian(z), np.reshape(residuals, (-1, len(z))).T).T
        return np.array([line.harmonics(item) for item in change]).reshape(-1, line.most + 1)

    def end_changes(self, orbit: Orbit, others: Sequence[PreloadedMass]) -> FloatArray:
        r"""Return the change of the end of its branch for other masses, Hz, shape (others,).

        .. math:: \Delta f = -\frac{w \cdot R'}{w \cdot \partial R/\partial f}

        with w what the slope of the balance no longer reaches there, its left null vector.
        """
        line = _PressedBalance(self, orbit.frequency, orbit.level, len(orbit.harmonics) - 1)
        z = line.to_real(orbit.harmonics)
        w = np.linalg.svd(line.jacobian(z))[0][:, -1]

        def evaluate_balance(preloaded_mass: PreloadedMass, hz: float) -> float:
            return float(
                w @ _PressedBalance(preloaded_mass, hz, orbit.level, line.most).balance(z, 1.0)
            )

        frequency, step = orbit.frequency, _STEP * orbit.frequency
        by_frequency = (
            evaluate_balance(self, frequency + step) - evaluate_balance(self, frequency - step)
        ) / (2 * step)
        return np.array([-evaluate_balance(mass, frequency) / by_frequency for mass in others])

    def _solve_near_orbit(self, orbit: Orbit, hz: float, level: float) -> Orbit | None:
        """Return the answer at a frequency to which that at another leads."""
        line = _PressedBalance(self, hz, level, len(orbit.harmonics) - 1)
        state = line.solve_from(line.to_real(orbit.harmonics))
        return None if state is None else line.orbit(state)


_SAME_SOLUTION = 1e-5
"""Part of the first harmonic within which two answers are one."""


def _compare_orbits(orbit: Orbit, other: Orbit) -> float:
    """Return the relative difference of two orbits, of the larger first harmonic."""
    first = max(abs(orbit.harmonics[1]), abs(other.harmonics[1]))
    return float(np.abs(orbit.harmonics[:3] - other.harmonics[:3]).max() / first)


@lru_cache(maxsize=8)
def _make_transforms(harmonic_count: int) -> tuple[AlternatingFrequencyTime, FloatArray]:
    """Return the transform between harmonics and samples, and the samples of each real unknown."""
    cycle = AlternatingFrequencyTime(
        range(harmonic_count + 1), max(_MIN_COUNT, _PER_HARMONIC * harmonic_count)
    )
    turn = cycle.turn.T
    return cycle, np.hstack((turn.real, -turn.imag[:, 1:]))


@lru_cache(maxsize=8)
def _make_gauss_points(harmonic_count: int) -> tuple[float, FloatArray, ComplexArray]:
    """Return the step of phase, two points in each, shape (steps, 2), and the harmonics there."""
    width = 2 * np.pi / _FLOQUET_STEPS
    first = np.arange(_FLOQUET_STEPS)[:, None] + 0.5
    phase = width * (first + np.array([-1, 1]) / np.sqrt(12))
    return width, phase, np.exp(1j * phase[..., None] * np.arange(harmonic_count + 1))


class _PressedBalance:
    """The balance of one frequency and level, in real unknowns.

    They are the mean, then the real and then the imaginary parts of the harmonics 1 to H, m.
    """

    def __init__(
        self, preloaded_mass: PreloadedMass, hz: float, level: float, harmonic_count: int
    ) -> None:
        self.of, self.hz, self.level, self.most = preloaded_mass, hz, level, harmonic_count
        h, omega = np.arange(harmonic_count + 1), 2 * np.pi * hz
        self.cycle, self.basis = _make_transforms(harmonic_count)
        self.samples = len(self.basis)
        self.inertia = -preloaded_mass.mass * (h * omega) ** 2
        s = 1j * omega * np.arange(self.samples // 2 + 1)
        self.arms = np.asarray(preloaded_mass.solid.stiffness_at(s) / preloaded_mass.solid.k_inf)
        self.arms[0] = 1.0  # the mean is relaxed
        self.size = preloaded_mass.static_force + level
        self.steps = 0

    def harmonics(self, z: FloatArray) -> ComplexArray:
        """Complex, of the real unknowns."""
        return np.asarray(z[: self.most + 1] + 1j * np.append(0.0, z[self.most + 1 :]))

    def extend_harmonics(self, z: FloatArray, harmonic_count: int) -> FloatArray:
        """Return the unknowns with more harmonics, of 0."""
        padding = np.zeros(harmonic_count - self.most)
        return np.concatenate((z[: self.most + 1], padding, z[self.most + 1 :], padding))

    def to_real(self, value: ComplexArray) -> FloatArray:
        """Return the real unknowns, of complex ones."""
        return np.concatenate((value.real, value.imag[1:]))

    def _apply_arms(self, path: FloatArray) -> FloatArray:
        """Return a relaxed force over a cycle with the arms, samples first."""
        shape = (-1,) + (1,) * (path.ndim - 1)
        value = np.fft.rfft(path, axis=0) * self.arms.reshape(shape)
        return np.asarray(np.fft.irfft(value, self.samples, axis=0))

    def pressing(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Compression, m, and the force of a seal that cannot separate, N, over a cycle."""
        x = self.basis @ z
        return x, self._apply_arms(self.of.law.force(np.maximum(x, 0.0)))

    def balance(self, z: FloatArray, share: float) -> FloatArray:
        """Return the residual of the force balance, N, at a share of the level."""
        force = np.maximum(self.pressing(z)[1], 0.0)
        residual = self.cycle.harmonics_of(force) + self.inertia * self.harmonics(z)
        residual[0] -= self.of.static_force
        residual[1] -= share * self.level
        return self.to_real(residual)

    def jacobian(self, z: FloatArray) -> FloatArray:
        """Return the derivative of the balance by the unknowns, N/m."""
        x, bonded_force = self.pressing(z)
        tangent = np.where(x > 0, self.of.law.tangent(np.maximum(x, 0.0)), 0.0)
        force = np.where(bonded_force > 0, self._apply_arms((tangent * self.basis.T).T).T, 0.0)
        # samples last
        harmonics = self.cycle.harmonics_of(force)
        H = self.most
        indices = np.arange(H + 1)
        harmonics[indices, indices] += self.inertia
        harmonics[indices[1:], H + indices[1:]] += 1j * self.inertia[1:]
        return np.concatenate((harmonics.real, harmonics.imag[1:]))

    def build_rest_state(self) -> FloatArray:
        z = np.zeros(2 * self.most + 1)
        z[0] = self.of.rest
        return z

    def solve_from(self, z: FloatArray) -> BalancedState | None:
        """Return the answer near some unknowns."""
        values = find_root_by_newton(
            lambda z: self.balance(z, 1.0),
            lambda z, r: np.asarray(np.linalg.solve(self.jacobian(z), r)),
            z,
            size=self.size,
            max_steps=15,
        )
        return None if values is None else self._build_balanced_state(values)

    def _build_balanced_state(self, z: FloatArray) -> BalancedState:
        x, bonded_force = self.pressing(z)
        return BalancedState(z, bonded_force > 0, x)

    def solve_by_continuation(self) -> BalancedState:
        """Return the answer that rest becomes as the level rises: by arc length, past every fold.

        Raises
        ------
        DataError
            If none is reached.
        """
        z, fraction, max_fraction, n = self.build_rest_state(), 0.0, 0.0, 2 * self.most + 1
        alternating_signs = (-1.0) ** np.arange(self.most + 1)
        half_cycle_row = np.concatenate((alternating_signs, alternating_signs[1:], [-1.0]))
        direction = self._compute_tangent(z, np.append(np.zeros(n), 1.0))
        # lengths over those of the linear answer, and of the level
        scale, step = np.append(np.full(n, np.abs(direction[1:n]).max()), 1.0), 2.0
        tangent = direction / np.linalg.norm(direction / scale)
        for _ in range(_MAX_STEPS):
            ratio = float((1 - fraction) / tangent[n]) if tangent[n] > 0 else np.inf
            is_last_step = ratio <= step
            length = min(ratio, step)
            self.steps += 1
            arclength_step = self._solve_arclength_step(
                z, fraction, tangent, length, scale, last=is_last_step
            )
            if arclength_step is None:
                step = length / 2
                if step < _MIN_STEP:
                    break
                continue
            if is_last_step:
                return self._build_balanced_state(arclength_step[:n])
            if arclength_step[n] > 1:  # the level lies between, and is met from below
                step = length / 2
                continue
            if (
                arclength_step[n] < 0
            ):  # the same motion half a period later: light arms turn it in one step
                arclength_step, tangent = half_cycle_row * arclength_step, half_cycle_row * tangent
            z, fraction = arclength_step[:n], float(arclength_step[n])
            max_fraction = max(max_fraction, fraction)
            direction = self._compute_tangent(z, tangent / scale**2)
            tangent = direction / np.linalg.norm(direction / scale)
            step = 1.5 * length
        raise DataError(
            f"at {self.hz:.5g} Hz no steady answer at the drive's period is reached above "
            f"{max_fraction * self.level:.4g} N, and {self.level:.4g} N was asked for; ask for a "
            "lower amplitude, or another frequency"
        )

    def _compute_tangent(self, z: FloatArray, previous_tangent: FloatArray) -> FloatArray:
        """Direction of the curve of unknowns and share; its product with the last one is 1."""
        n = len(z)
        border = np.zeros((n + 1, n + 1))
        border[:n, :n], border[1, n], border[n] = self.jacobian(z), -self.level, previous_tangent
        return np.asarray(np.linalg.solve(border, np.append(np.zeros(n), 1.0)))

    def _solve_arclength_step(
        self,
        z: FloatArray,
        fraction: float,
        tangent: FloatArray,
        length: float,
        scale: FloatArray,
        *,
        last: bool,
    ) -> FloatArray | None:
        """Return the answer a step along the curve, at the whole level if it is the last."""
        n = len(z)
        predicted = np.append(z, fraction) + length * tangent
        normal = tangent / scale**2
        if last:
            normal, predicted[n] = np.append(np.zeros(n), 1.0), 1.0

        def residual(u: FloatArray) -> FloatArray:
            return np.append(self.balance(u[:n], float(u[n])) / self.size, normal @ (u - predicted))

        def step(u: FloatArray, r: FloatArray) -> FloatArray:
            border = np.zeros((n + 1, n + 1))
            border[:n, :n], border[1, n], border[n] = self.jacobian(u[:n]), -self.level, normal
            border[:n] /= self.size
            return np.asarray(np.linalg.solve(border, r))

        values = find_root_by_newton(residual, step, predicted, size=1.0, max_steps=10)
        if values is None:
            return None
        step_distance = float(np.linalg.norm((values - predicted) / scale))
        return values if step_distance <= _WIDEST * length else None

    def orbit(self, state: BalancedState) -> Orbit:
        """Return the public value of a balanced state.

        Raises
        ------
        DataError
            If it moves farther than in any test.
        """
        amplitude = float(np.abs(self.harmonics(state.unknowns)[1:]).max())
        SIZES["amplitude"].refuse(
            max(amplitude, SIZES["amplitude"].hard[0]),
            f"at an amplitude of {format_quantity_short(self.level, 'N')} the mass would move by "
            f"{format_quantity_short(amplitude, 'm')}",
            remedy="Check the amplitude and its unit, and the mass.",
        )
        return Orbit(
            self.hz,
            self.level,
            self.of.rest,
            self.harmonics(state.unknowns),
            self._multiplier(state.unknowns),
            float((~state.in_contact).mean()),
            float(state.path.min()),
            float(state.path.max()),
        )

    def _multiplier(self, z: FloatArray) -> complex:
        r"""Return the largest Floquet multiplier.

        Of place, speed and what each arm remembers, :math:`\tau \dot y = F_e(x) - y`, by Magnus
        steps of fourth order, each a Padé fraction that damps however fast an arm is.
        """
        solid, law = self.of.solid.maxwell, self.of.law
        omega, n = 2 * np.pi * self.hz, _FLOQUET_STEPS
        g, tau = (np.asarray(pair) for pair in (solid.k, solid.tau))
        g = g / solid.k_inf
        at_once, dash = 1 + g.sum(), solid.b / solid.k_inf
        width, phase, turn = _make_gauss_points(self.most)
        x = (turn @ self.harmonics(z)).real
        compression = np.maximum(x, 0.0)
        tangent = np.where(x > 0, law.tangent(compression), 0.0)
        samples = 2 * np.pi * np.arange(self.samples) / self.samples
        is_pressed = np.interp(phase, samples, self.pressing(z)[1], period=2 * np.pi) > 0
        slope = np.gradient(tangent.ravel(), phase.ravel()).reshape(x.shape)  # dF_e'/dphase
        K = float(law.tangent(self.of.rest))
        m = self.of.mass * omega**2
        A = np.zeros((n, 2, 2 + len(g), 2 + len(g)))
        A[..., 0, 1] = 1.0
        A[..., 1, 0] = -1.0 * is_pressed * (at_once * tangent + dash * omega * slope) / m
        A[..., 1, 1] = -1.0 * is_pressed * dash * omega * tangent / m
        A[..., 1, 2:] = is_pressed[..., None] * g * K / m
        A[..., 2:, 0] = tangent[..., None] / K / (omega * tau)
        A[..., range(2, 2 + len(g)), range(2, 2 + len(g))] = -1 / (omega * tau)
        first, second = A[:, 0], A[:, 1]
        magnus_exponent = width / 2 * (first + second) + np.sqrt(3) / 12 * width**2 * (
            second @ first - first @ second
        )
        square, values = magnus_exponent @ magnus_exponent / 12, np.eye(2 + len(g))
        steps = np.linalg.solve(
            values - magnus_exponent / 2 + square, values + magnus_exponent / 2 + square
        )
        while len(steps) > 1:  # a power of two of them, the later on the left
            steps = steps[1::2] @ steps[::2]
        result = np.linalg.eigvals(steps[0])
        return complex(result[np.abs(result).argmax()])


def find_largest_orbit(orbits: Sequence[Orbit], harmonic: int = 1) -> Orbit:
    """Return the orbit of a sweep that lasts and has the most of a harmonic."""
    return max(
        (orbit for orbit in orbits if orbit.stable), key=lambda orbit: orbit.amplitudes[harmonic]
    )
