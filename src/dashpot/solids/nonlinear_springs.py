r"""Springs that stiffen with deflection."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, FloatArray, to_float
from dashpot.base.errors import DataError
from dashpot.solids.rate_independent import RateIndependent, amplitudes


@dataclass(frozen=True)
class Cubic(RateIndependent):
    r"""A spring with :math:`F = k_3 x^3`; :math:`N = \tfrac34 k_3 X^2`.

    Attributes
    ----------
    k3 : float
        N/m^3; negative if it softens.
    """

    k3: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.k3) and self.k3 != 0):
            raise DataError(f"Cubic: k3 = {self.k3!r}; expected a number other than 0")

    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:  # noqa: ARG002
        """Force, N: the same up and down."""
        return self.k3 * to_float(x) ** 3

    def start(self) -> None:
        """A spring has no state."""

    def step(self, state: None, x: float) -> tuple[float, None]:  # noqa: ARG002
        """Force, N."""
        return float(self.k3 * to_float(x) ** 3), None

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness, N/m, in closed form."""
        return np.asarray(0.75 * self.k3 * amplitudes(amplitude) ** 2 + 0j)

    def __mul__(self, count: float) -> Cubic:
        """`count` in parallel."""
        return Cubic(count * self.k3)
