r"""Equations (1) to (7) as the paper prints them, computed without dashpot's own solids.

Coefficients are those of Table 1 in SI: k_inf and k_j in N/m, b_j in N s/m, tau_j = b_j / k_j.
"""

from __future__ import annotations

import math

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, FloatArray

NODES = 40
"""Nodes of the quadrature of the hereditary integral; a ramp lasts a few time constants."""


@dataclass(frozen=True)
class Coefficients:
    """Two-arm solid of the paper, in its symbols.

    Attributes
    ----------
    k_inf : float
        N/m.
    k, b : tuple of float
        N/m and N s/m.
    """

    k_inf: float
    k: tuple[float, float]
    b: tuple[float, float]

    @property
    def tau(self) -> tuple[float, float]:
        """Time constants, b_j / k_j, s."""
        return self.b[0] / self.k[0], self.b[1] / self.k[1]

    def times(self, seals: float) -> Coefficients:
        """Return the coefficients of several seals in parallel."""
        (k1, k2), (b1, b2) = self.k, self.b
        return Coefficients(seals * self.k_inf, (seals * k1, seals * k2), (seals * b1, seals * b2))

    # -- relaxation -------------------------------------------------------------------------------

    def z(self, t: FloatArray) -> FloatArray:
        r"""Eq. (2): :math:`z(t) = k_\infty t + \sum_j b_j (1 - e^{-t/\tau_j})`, N s/m."""
        return self.k_inf * t + sum(
            b * (1 - np.exp(-t / tau)) for b, tau in zip(self.b, self.tau, strict=True)
        )

    def eq_1(self, t: FloatArray, *, speed: float, c: float) -> FloatArray:
        r"""Eq. (1): :math:`A [z(t) - z(t - c) u(t - c)]`, N; speed A in m/s, ramp time c in s."""
        time_after_ramp = np.maximum(t - c, 0.0)
        return speed * (self.z(t) - self.z(time_after_ramp) * (t >= c))

    def eq_3(self, t: FloatArray, *, speed: float, c: float) -> FloatArray:
        r"""Eq. (3), for t > c: :math:`A [z(t) - z(t - c)]`, N."""
        return speed * (self.z(t) - self.z(t - c))

    def eq_5(self, t: FloatArray, *, speed: float, c: float) -> FloatArray:
        r"""Eqs. (4) and (5), for t > c: the same sum, in stress and in force.

        .. math:: A [k_\infty c - \sum_j b_j e^{-t/\tau_j} (1 - e^{c/\tau_j})]
        """
        arms = sum(
            b * np.exp(-t / tau) * (1 - math.exp(c / tau))
            for b, tau in zip(self.b, self.tau, strict=True)
        )
        return np.asarray(speed * (self.k_inf * c - arms))

    def hereditary(self, t: float, *, speed: float, c: float) -> float:
        r"""Return the hereditary integral of eqs. (1) to (5), by Gauss-Legendre quadrature, N.

        .. math:: \int_0^{\min(t, c)} A \Big[k_\infty + \sum_j k_j e^{-(t - s)/\tau_j}\Big] ds
        """
        end = min(t, c)
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        quadrature_time = t - 0.5 * end * (nodes + 1)
        arms = zip(self.k, self.tau, strict=True)
        kernel = self.k_inf + sum(k * np.exp(-quadrature_time / tau) for k, tau in arms)
        return float(speed * 0.5 * end * (weights @ kernel))

    # -- mass on seals ----------------------------------------------------------------------------

    def _polynomials(self, m: float) -> tuple[FloatArray, FloatArray]:
        """Numerator and denominator of eq. (6), highest power of s first."""
        k0, (k1, k2), (b1, b2) = self.k_inf, self.k, self.b
        numerator = np.array([b1 * b2, b1 * k2 + b2 * k1, k1 * k2])
        denominator = np.array([
            m * b1 * b2,
            m * b1 * k2 + m * b2 * k1,
            m * k1 * k2 + k0 * b1 * b2 + b1 * b2 * k1 + b1 * b2 * k2,
            k0 * (b1 * k2 + b2 * k1) + b1 * k1 * k2 + b2 * k1 * k2,
            k0 * k1 * k2,
        ])  # fmt: skip
        return numerator, denominator

    def eq_6(self, s: ComplexArray, *, mass: float) -> ComplexArray:
        """Eq. (6): X(s) / F(s) of a mass, kg, on this solid, m/N."""
        numerator, denominator = self._polynomials(mass)
        return np.asarray(np.polyval(numerator, s) / np.polyval(denominator, s))

    def poles(self, *, mass: float) -> ComplexArray:
        """Return the zeros of the denominator of eq. (6), 1/s."""
        return np.asarray(np.roots(self._polynomials(mass)[1]), dtype=complex)

    def eq_7(self, omega: FloatArray, *, mass: float) -> FloatArray:
        """Eq. (7) without its sign: magnitude of the accelerance, 1/kg."""
        k0, (k1, k2), (b1, b2), (t1, t2) = self.k_inf, self.k, self.b, self.tau
        w = omega
        numerator = np.sqrt((1 - t1 * t2 * w**2) ** 2 + (t1 + t2) ** 2 * w**2)
        even_part = (
            mass * t1 * t2 * w**4 - (mass + k0 * t1 * t2 + t1 * t2 * k1 + t1 * t2 * k2) * w**2 + k0
        )
        odd = (k0 * (t1 + t2) + b1 + b2) * w - mass * (t1 + t2) * w**3
        return np.asarray(w**2 * numerator / np.sqrt(even_part**2 + odd**2))
