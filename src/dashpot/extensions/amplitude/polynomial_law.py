"""Elastic law as a polynomial of the depth."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, validate_samples
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_positive


@dataclass(frozen=True)
class PolynomialLaw:
    r"""Relaxed force as a polynomial of compression.

    .. math:: F_e(x) = \sum_{i \ge 1} a_i x^i

    Attributes
    ----------
    coefficients : tuple of float
        :math:`a_i`, N/m, N/m^2, N/m^3 and so on.
    depth : float or None
        To which compression it was measured, m.

    >>> PolynomialLaw((120.0, 1e4, 8e5)).tangent(3e-3).round(3)
    np.float64(201.6)
    """

    coefficients: tuple[float, ...]
    depth: float | None = None

    def __post_init__(self) -> None:
        a = validate_samples("coefficients", self.coefficients)
        require_positive("PolynomialLaw: ", depth=self.depth, optional=True)
        if not a.any():
            raise DataError(
                f"PolynomialLaw: coefficients = {self.coefficients!r}; expected one other than 0"
            )

    @property
    def _powers(self) -> npt.NDArray[np.intp]:
        return np.arange(1, len(self.coefficients) + 1)

    def force(self, x: npt.ArrayLike) -> FloatArray:
        """Relaxed force, N, at compressions x, m."""
        return np.asarray(np.asarray(x, dtype=float)[..., None] ** self._powers @ self.coefficients)

    def tangent(self, x: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness, N/m."""
        powers, position = self._powers, np.asarray(x, dtype=float)[..., None]
        return np.asarray(position ** (powers - 1) @ (powers * self.coefficients))

    def rests(self, force: float) -> tuple[float, ...]:
        """Return every compression under a relaxed force, N, the least first.

        Raises
        ------
        DataError
            If no compression carries the force.
        """
        roots = np.roots([*self.coefficients[::-1], -force])
        real = roots.real[(abs(roots.imag) <= 1e-9 * abs(roots)) & (roots.real > 0)]
        if not real.size:
            raise DataError(
                f"no compression carries {force:.4g} N: expected a law that rises as far, or a "
                "force that presses"
            )
        return tuple(np.sort(real).tolist())

    def __mul__(self, count: float) -> PolynomialLaw:
        """Return `count` such elements in parallel."""
        return replace(
            self, coefficients=tuple(count * coefficient for coefficient in self.coefficients)
        )

    __rmul__ = __mul__
