r"""Nonlinear springs: cubic, and in stages."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ComplexArray, FloatArray, increasing, same_length, samples
from dashpot.base.errors import DataError
from dashpot.solids.rate_independent import RateIndependent, amplitudes


class _Elastic(RateIndependent):
    """A spring: its force is that of its place, whatever the way there."""

    def at(self, x: FloatArray) -> FloatArray:
        """Force, N, at displacements, m."""
        raise NotImplementedError

    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:  # noqa: ARG002
        """Force, N: the same up and down."""
        return self.at(np.asarray(x, dtype=float))

    def start(self) -> None:
        """A spring remembers nothing."""

    def step(self, state: None, x: float) -> tuple[float, None]:  # noqa: ARG002
        """Force, N."""
        return float(self.at(np.asarray(x))), None


@dataclass(frozen=True)
class Cubic(_Elastic):
    r"""Cubic spring :math:`F = k_3 x^3`; :math:`N = \tfrac34 k_3 X^2`.

    Attributes
    ----------
    k3 : float
        N/m^3; negative where it softens.
    """

    k3: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.k3) and self.k3 != 0):
            raise DataError(f"Cubic: k3 = {self.k3!r}; expected a number other than 0")

    def at(self, x: FloatArray) -> FloatArray:
        """Force, N."""
        return self.k3 * x**3

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness, N/m, in closed form."""
        return np.asarray(0.75 * self.k3 * amplitudes(amplitude) ** 2 + 0j)

    def __mul__(self, count: float) -> Cubic:
        """`count` in parallel."""
        return Cubic(count * self.k3)


@dataclass(frozen=True)
class StagedSpring(_Elastic):
    r"""Spring of several stages, symmetric in both directions: stops, clutch hubs.

    .. math:: N = k_1 + \sum_i (k_{i+1} - k_i) \left[1 - \frac2\pi
        \left(\arcsin r_i + r_i \sqrt{1 - r_i^2}\right)\right], \quad
        r_i = \min(x_i / X, 1)

    Attributes
    ----------
    k : tuple of float
        Tangent stiffness of each stage, N/m, >= 0.
    until : tuple of float
        Where all stages but the last end, m, rising from above 0.
    """

    k: tuple[float, ...]
    until: tuple[float, ...]

    def __post_init__(self) -> None:
        k, until = samples("k", self.k), increasing("until", samples("until", self.until))
        same_length(until=until, k=k[1:])
        if (k < 0).any() or until[0] <= 0:
            raise DataError(
                f"StagedSpring: k = {self.k!r}, until = {self.until!r}; expected stiffnesses >= 0 "
                "and ends > 0"
            )

    def at(self, x: FloatArray) -> FloatArray:
        """Force, N."""
        size, ends = np.abs(x), np.asarray(self.until)
        excess = np.maximum(size[..., None] - ends, 0.0)
        return np.asarray(np.copysign(self.k[0] * size + excess @ np.diff(self.k), x))

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness, N/m, in closed form."""
        r = np.minimum(np.asarray(self.until) / amplitudes(amplitude)[..., None], 1.0)
        saturated = 2 / np.pi * (np.arcsin(r) + r * np.sqrt(1 - r**2))
        return np.asarray(self.k[0] + (1 - saturated) @ np.diff(self.k) + 0j)

    def __mul__(self, count: float) -> StagedSpring:
        """`count` in parallel."""
        return replace(self, k=tuple(count * value for value in self.k))
