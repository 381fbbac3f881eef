r"""Springs that stiffen with deflection: cubic, and in stages."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    ComplexArray,
    FloatArray,
    require_increasing,
    require_same_length,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import RateIndependent, amplitudes

__all__ = ["Cubic", "StagedSpring"]


@dataclass(frozen=True)
class StagedSpring(RateIndependent):
    r"""Spring of several stages, the same either way: stops, clutch hubs.

    .. math:: N = k_1 + \sum_i (k_{i+1} - k_i) \left[1 - \frac2\pi
        \left(\arcsin r_i + r_i \sqrt{1 - r_i^2}\right)\right], \quad
        r_i = \min(x_i / X, 1)

    Attributes
    ----------
    k : tuple of float
        Tangent stiffness of each stage, N/m, >= 0.
    until : tuple of float
        Upper ends of all stages but the last, m, > 0 and rising.
    """

    k: tuple[float, ...]
    until: tuple[float, ...]

    def __post_init__(self) -> None:
        k, limits = (
            validate_samples("k", self.k),
            require_increasing("until", validate_samples("until", self.until)),
        )
        require_same_length(until=limits, k=k[1:])
        if (k < 0).any() or limits[0] <= 0:
            raise DataError(
                f"StagedSpring: k = {self.k!r}, until = {self.until!r}; expected stiffnesses >= 0 "
                "and ends > 0"
            )

    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:  # noqa: ARG002
        """Return the force, N: the same up and down."""
        magnitude, limits = np.abs(x), np.asarray(self.until)
        excess = np.maximum(magnitude[..., None] - limits, 0.0)
        return np.asarray(np.copysign(self.k[0] * magnitude + excess @ np.diff(self.k), x))

    def start(self) -> None:
        """Return an empty state: a spring has no history."""

    def step(self, state: None, x: float) -> tuple[float, None]:  # noqa: ARG002
        """Return the force, N."""
        return float(self.unloading(np.asarray(x), np.abs(x))), None

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Return the equivalent stiffness, N/m, in closed form."""
        r = np.minimum(np.asarray(self.until) / amplitudes(amplitude)[..., None], 1.0)
        saturation_factor = 2 / np.pi * (np.arcsin(r) + r * np.sqrt(1 - r**2))
        return np.asarray(self.k[0] + (1 - saturation_factor) @ np.diff(self.k) + 0j)

    def __mul__(self, count: float) -> StagedSpring:
        """Return `count` in parallel."""
        return replace(self, k=tuple(count * value for value in self.k))
