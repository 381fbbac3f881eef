r"""Elements whose response depends on amplitude, alone and in parallel to a solid.

Under x(t) = Re X e^{+j omega t} an element answers with a loop; its first harmonic is the
equivalent stiffness (describing function)

.. math:: N(X) = \frac{1}{\pi X} \int_0^{2\pi} F(\varphi)\, e^{-j\varphi} d\varphi, \qquad
    W = \pi X^2 \operatorname{Im} N

with the energy W lost in a cycle.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import (
    ComplexArray,
    FloatArray,
    require_increasing,
    require_same_length,
    to_float,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_positive, select_fields
from dashpot.solids.maxwell import Solid

_QUADRATURE_NODES = 400
"""Nodes of the quadrature over half a cycle, where an element has no closed first harmonic."""


class AmplitudeDependent(ABC):
    """Element whose complex stiffness depends on frequency and amplitude."""

    @abstractmethod
    def equivalent(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> ComplexArray:
        """First harmonic of the force over X, N/m, at rad/s and amplitudes X > 0, m; broadcasts."""

    def energy_per_cycle(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> FloatArray:
        r"""Energy lost in a cycle, J: :math:`\pi X^2 \operatorname{Im} K(\omega, X)`."""
        X = amplitudes(amplitude)
        return np.asarray(np.pi * X**2 * self.equivalent(omega, X).imag)

    @abstractmethod
    def start(self) -> Any:
        """State of the part at rest, at displacement and force zero."""

    @abstractmethod
    def advance(self, state: Any, dt: float, x: float) -> tuple[float, Any]:
        """Force, N, after a straight step of dt, s, to a displacement, m; the state there."""

    @abstractmethod
    def __mul__(self, count: float) -> AmplitudeDependent:
        """`count` equal parts in parallel."""

    def __rmul__(self, count: float) -> AmplitudeDependent:
        """Return ``part * count``."""
        return self * count

    def __add__(self, other: object) -> InParallel:
        """Two parts in parallel: their forces add."""
        if not isinstance(other, AmplitudeDependent | Solid):
            return NotImplemented
        return InParallel((self, other))

    def __radd__(self, other: object) -> InParallel:
        """Return ``part + other``."""
        return self + other

    def path_force(self, t: npt.ArrayLike, displacement: npt.ArrayLike) -> FloatArray:
        """Force, N, along displacements, m, straight between times, s; from rest at zero."""
        time, x = (
            require_increasing("t", validate_samples("t", t)),
            validate_samples("displacement", displacement),
        )
        require_same_length(t=time, displacement=x)
        state, values = self.start(), []
        for dt, position in zip(np.diff(time, prepend=time[0]).tolist(), x.tolist(), strict=True):
            force, state = self.advance(state, dt, position)
            values.append(force)
        return np.array(values)


class RateIndependent(AmplitudeDependent):
    """Element whose force depends on the path of its displacement, not on time.

    A new element gives :meth:`unloading`, ``start``, :meth:`step` and the product with a
    number; its first harmonic follows, where it has no closed one of its own.
    """

    @abstractmethod
    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:
        """Force, N, on the way from +amplitude to -amplitude of the steady loop, at x, m."""

    @abstractmethod
    def step(self, state: Any, x: float) -> tuple[float, Any]:
        """Force, N, at the next displacement, m, and the state there."""

    @abstractmethod
    def __mul__(self, count: float) -> RateIndependent:
        """`count` equal elements in parallel."""

    def advance(self, state: Any, dt: float, x: float) -> tuple[float, Any]:  # noqa: ARG002
        """Return :meth:`step`: time does not matter."""
        return self.step(state, x)

    def equivalent(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> ComplexArray:
        """Return :meth:`stiffness`, the same at every frequency."""
        return np.asarray(self.stiffness(amplitude) + 0 * np.asarray(omega))

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness N(X), N/m, at amplitudes X > 0, m: the first harmonic over X."""
        X = amplitudes(amplitude)
        phase, weights = _half_cycle()
        force = self.unloading(X[..., None] * np.cos(phase), X[..., None])
        return np.asarray(2 / np.pi * (force * np.exp(-1j * phase)) @ weights / X)

    def energy(self, amplitude: npt.ArrayLike) -> FloatArray:
        """Energy lost in a cycle, J, at every frequency."""
        return self.energy_per_cycle(0.0, amplitude)

    def secant(self, amplitude: npt.ArrayLike) -> FloatArray:
        """Return force over displacement at the tip of the steady loop, N/m."""
        X = amplitudes(amplitude)
        return np.asarray(self.unloading(X, X) / X)

    def force(self, displacement: npt.ArrayLike) -> FloatArray:
        """Force, N, along a path of displacements, m, that starts from rest at zero."""
        state, values = self.start(), []
        for x in validate_samples("displacement", displacement).tolist():
            force, state = self.step(state, x)
            values.append(force)
        return np.array(values)

    def loop(self, amplitude: float, *, points: int = 400) -> tuple[FloatArray, FloatArray]:
        """Return the steady loop: displacement, m, and force, N, once round from +amplitude."""
        X = float(amplitudes(amplitude))
        half_cycle = X * np.cos(np.linspace(0, np.pi, points // 2 + 1))
        unloading_force = self.unloading(half_cycle, np.full_like(half_cycle, X))
        return np.concatenate((half_cycle, -half_cycle[1:])), np.concatenate(
            (unloading_force, -unloading_force[1:])
        )


@dataclass(frozen=True)
class InParallel(AmplitudeDependent):
    """Elements in parallel, linear or not: one displacement, and the sum of their forces.

    Attributes
    ----------
    parts : tuple of Solid or AmplitudeDependent
        At least one; those that are themselves in parallel are laid out side by side.
    """

    parts: tuple[Solid | AmplitudeDependent, ...]

    def __post_init__(self) -> None:
        all_parts = tuple(
            part
            for item in self.parts
            for part in (item.parts if isinstance(item, InParallel) else (item,))
        )
        if not all_parts or not all(
            isinstance(part, Solid | AmplitudeDependent) for part in all_parts
        ):
            raise DataError(
                f"parts = {self.parts!r}; expected solids or elements, at least one of them"
            )
        object.__setattr__(self, "parts", all_parts)

    def equivalent(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> ComplexArray:
        """Return complex stiffness, N/m: the sum of the parts."""
        return np.asarray(sum(equivalent(part, omega, amplitude) for part in self.parts))

    def start(self) -> tuple[Any, ...]:
        """Return the parts at rest."""
        return tuple(part.start() for part in self._stepped_parts)

    def advance(self, state: tuple[Any, ...], dt: float, x: float) -> tuple[float, tuple[Any, ...]]:
        """Force, N, and the states of the parts."""
        pairs = [
            part.advance(item, dt, x) for part, item in zip(self._stepped_parts, state, strict=True)
        ]
        return sum(force for force, _ in pairs), tuple(item for _, item in pairs)

    def __mul__(self, count: float) -> InParallel:
        """`count` of each."""
        return InParallel(tuple(part * count for part in self.parts))

    @cached_property
    def _stepped_parts(self) -> tuple[AmplitudeDependent | _Stepped, ...]:
        return tuple(_make_stepped(part) for part in self.parts)


@dataclass(frozen=True)
class _Stepped:
    """A solid, stepped along a path that is straight between its samples."""

    solid: Solid

    def start(self) -> tuple[float, FloatArray]:
        """Displacement, m, and the elongation of the springs of its arms, m."""
        return 0.0, np.zeros(self.solid.maxwell.arms)

    def advance(
        self, state: tuple[float, FloatArray], dt: float, x: float
    ) -> tuple[float, tuple[float, FloatArray]]:
        """Force, N, exact for a straight step; a step of no time is a jump."""
        maxwell = self.solid.maxwell
        k, tau = np.asarray(maxwell.k), np.asarray(maxwell.tau)
        before, elongation = state
        z = dt / tau
        mean = -np.expm1(-z) / z if dt > 0 else np.ones_like(tau)
        elongation = np.exp(-z) * elongation + mean * (x - before)
        viscous = maxwell.b * (x - before) / dt if dt > 0 else 0.0
        return float(maxwell.k_inf * x + k @ elongation + viscous), (x, elongation)


def equivalent(
    part: Solid | AmplitudeDependent, omega: npt.ArrayLike, amplitude: npt.ArrayLike
) -> ComplexArray:
    """Return complex stiffness, N/m, of a solid or of a part that depends on amplitude."""
    if isinstance(part, AmplitudeDependent):
        return part.equivalent(omega, amplitude)
    return np.asarray(part.complex_stiffness(omega=omega) + 0 * np.asarray(amplitude))


def amplitudes(amplitude: npt.ArrayLike) -> FloatArray:
    """Amplitudes as an array.

    Raises
    ------
    DataError
        If one is not a number above 0.
    """
    X = to_float(amplitude)
    if not (np.isfinite(X) & (X > 0)).all():
        bad_amplitude = X[~(np.isfinite(X) & (X > 0))].flat[0]
        raise DataError(f"amplitude = {bad_amplitude:g}; expected a displacement > 0, in m")
    return X


def require_positive_parameters(element: Any, *names: str) -> None:
    """Refuse an element one of whose numbers is not above 0."""
    require_positive(f"{type(element).__name__}: ", **select_fields(element, *names))


def _make_stepped(part: Solid | AmplitudeDependent) -> AmplitudeDependent | _Stepped:
    return part if isinstance(part, AmplitudeDependent) else _Stepped(part)


def _half_cycle() -> tuple[FloatArray, FloatArray]:
    """Phases of half a cycle and their weights, crowded at both turns, where a branch bends."""
    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE_NODES)
    phase = np.pi / 2 * (1 + np.sin(np.pi / 2 * nodes))
    return phase, weights * np.pi**2 / 4 * np.cos(np.pi / 2 * nodes)
