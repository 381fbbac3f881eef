r"""Temperature laws of time-temperature superposition: WLF, Arrhenius, free shifts.

.. math:: K^*(\omega; T) = b_T K^*(a_T\,\omega; T_r), \qquad
          k_j \to b_T k_j, \quad \tau_j \to a_T \tau_j

A solid for which one :math:`a_T` moves every arm is *thermorheologically simple*. Source: J. D.
Ferry, *Viscoelastic Properties of Polymers*, ch. 11.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import log

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import (
    FloatArray,
    require_increasing,
    require_same_length,
    to_float,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.serialisation import Serialisable
from dashpot.base.value_ranges import require_positive
from dashpot.solids.maxwell import GeneralizedMaxwell

GAS_CONSTANT = 8.314462618
"""Molar gas constant R, J/(mol K)."""
_LN10 = log(10.0)
# C_1 and C_2, K, of many polymers at their glass transition
_UNIVERSAL_WLF = 17.44, 51.6


class TemperatureLaw(ABC, Serialisable):
    """Temperature law: shift factor against temperature, 1 at the reference.

    Attributes
    ----------
    reference : float
        T_r, K.
    """

    reference: float

    @property
    @abstractmethod
    def kind(self) -> str:
        """``"wlf"``, ``"arrhenius"`` or ``"free"``."""

    @abstractmethod
    def log10_a_t(self, temperature: npt.ArrayLike) -> FloatArray:
        """Decadic logarithm of the shift factor at temperatures, K."""

    @abstractmethod
    def activation_energy(self, temperature: npt.ArrayLike) -> FloatArray:
        r"""Apparent activation energy :math:`E_a = R\,d\ln a_T/d(1/T)`, J/mol, at T in K."""

    def a_t(self, temperature: npt.ArrayLike) -> FloatArray:
        """Shift factor: relaxation times at T over those at the reference."""
        return np.asarray(10.0 ** self.log10_a_t(temperature))


def shift_to_temperature(
    solid: GeneralizedMaxwell, temperature: float, law: TemperatureLaw
) -> GeneralizedMaxwell:
    r"""Return the solid of the law's reference at T, K, its stiffness that of an ideal rubber.

    .. math:: \tau_j \to a_T \tau_j, \qquad k_j \to b_T k_j, \quad b_T = T / T_r
    """
    return solid.shift_to_temperature(float(law.a_t(temperature)), temperature / law.reference)


@dataclass(frozen=True)
class WLF(TemperatureLaw):
    r"""Law of Williams, Landel and Ferry: free volume, above the glass transition.

    .. math:: \log_{10} a_T = -\frac{C_1 (T - T_r)}{C_2 + T - T_r}, \qquad
              E_a = \ln 10\,R\,\frac{C_1 C_2 T^2}{(C_2 + T - T_r)^2}

    Attributes
    ----------
    c1 : float
        > 0.
    c2 : float
        K, > 0; the law diverges at T_r - C_2.
    reference : float
        T_r, K.

    >>> WLF.universal(glass=218.15, reference=296.15).log10_a_t(273.15).round(6)
    np.float64(1.498172)
    """

    _keys = ("kind", "c1", "c2")

    c1: float
    c2: float
    reference: float

    def __post_init__(self) -> None:
        require_positive("WLF ", c1=self.c1, c2=self.c2, reference=self.reference)

    @classmethod
    def universal(cls, *, glass: float, reference: float) -> WLF:
        """The law of many polymers, C_1 = 17.44 and C_2 = 51.6 K at the glass transition, K."""
        return cls(*_UNIVERSAL_WLF, glass).change_reference(reference)

    @property
    def glass(self) -> float:
        """Glass transition temperature, K, if C_2 there is that of many polymers."""
        return self.reference - self.c2 + _UNIVERSAL_WLF[1]

    @property
    def kind(self) -> str:
        """``"wlf"``."""
        return "wlf"

    def change_reference(self, reference: float) -> WLF:
        r"""Return the law for T_r': :math:`C_2' = C_2 + T_r' - T_r`, :math:`C_1' = C_1 C_2/C_2'`.

        Raises
        ------
        DataError
            If that is below T_r - C_2.
        """
        c2 = self.c2 + reference - self.reference
        if c2 <= 0:
            raise DataError(
                f"reference = {reference:g} K; this WLF law holds above "
                f"{self.reference - self.c2:.4g} K"
            )
        return WLF(self.c1 * self.c2 / c2, c2, reference)

    def log10_a_t(self, temperature: npt.ArrayLike) -> FloatArray:
        """Decadic logarithm of the shift factor at temperatures, K."""
        temperature_difference = to_float(temperature) - self.reference
        if (self.c2 + temperature_difference <= 0).any():
            raise DataError(
                f"{float(np.min(temperature_difference)) + self.reference:.5g} K is at or below "
                f"{self.reference - self.c2:.5g} K, where this WLF law diverges"
            )
        return np.asarray(-self.c1 * temperature_difference / (self.c2 + temperature_difference))

    def activation_energy(self, temperature: npt.ArrayLike) -> FloatArray:
        """Apparent activation energy, J/mol, at temperatures, K."""
        t = to_float(temperature)
        return np.asarray(
            _LN10 * GAS_CONSTANT * self.c1 * self.c2 * t**2 / (self.c2 + t - self.reference) ** 2
        )


@dataclass(frozen=True)
class Arrhenius(TemperatureLaw):
    r"""Arrhenius law: one activated process, below the glass transition or far above it.

    .. math:: \log_{10} a_T = \frac{E_a}{R \ln 10} \Bigl(\frac1T - \frac1{T_r}\Bigr)

    Attributes
    ----------
    energy : float
        E_a, J/mol.
    reference : float
        T_r, K.
    """

    _keys = ("kind", "energy")

    energy: float
    reference: float

    def __post_init__(self) -> None:
        require_positive("Arrhenius ", energy=self.energy, reference=self.reference)

    @property
    def kind(self) -> str:
        """``"arrhenius"``."""
        return "arrhenius"

    def log10_a_t(self, temperature: npt.ArrayLike) -> FloatArray:
        """Decadic logarithm of the shift factor at temperatures, K."""
        t = to_float(temperature)
        return np.asarray(self.energy / (GAS_CONSTANT * _LN10) * (1 / t - 1 / self.reference))

    def activation_energy(self, temperature: npt.ArrayLike) -> FloatArray:
        """E_a, J/mol, whatever the temperature."""
        return np.full_like(to_float(temperature), self.energy)


@dataclass(frozen=True)
class FreeShifts(TemperatureLaw):
    """Free shifts at the tested temperatures, linear in 1/T between them; no law beyond.

    Attributes
    ----------
    temperatures : tuple of float
        K, rising; the reference is among them.
    log10_shifts : tuple of float
        Decadic logarithm of the shift factor at each, 0 at the reference.
    reference : float
        T_r, K.
    """

    _keys = ("kind", "temperatures", "log10_shifts")

    temperatures: tuple[float, ...]
    log10_shifts: tuple[float, ...]
    reference: float

    def __post_init__(self) -> None:
        temperatures = require_increasing(
            "temperatures", validate_samples("temperatures", self.temperatures)
        )
        shifts = validate_samples("log10_shifts", self.log10_shifts)
        require_same_length(temperatures=temperatures, log10_shifts=shifts)
        reference_index = np.flatnonzero(temperatures == self.reference)
        if temperatures[0] <= 0 or not len(reference_index) or shifts[reference_index[0]] != 0:
            raise DataError(
                f"free shifts need temperatures > 0 K with the reference of {self.reference:g} K "
                f"among them and no shift there; found {self.temperatures}"
            )
        object.__setattr__(self, "temperatures", tuple(temperatures.tolist()))
        object.__setattr__(self, "log10_shifts", tuple(shifts.tolist()))

    @property
    def kind(self) -> str:
        """``"free"``."""
        return "free"

    def log10_a_t(self, temperature: npt.ArrayLike) -> FloatArray:
        """Decadic logarithm of the shift factor at temperatures, K, between the tested ones."""
        t = to_float(temperature)
        low, high = self.temperatures[0], self.temperatures[-1]
        outside = t[(t < low) | (t > high)]
        if outside.size:
            raise DataError(
                f"{float(outside.flat[0]):.5g} K is outside the tested {low:.5g} to {high:.5g} K, "
                "and shifts without a law reach no further: test at a third temperature"
            )
        inverse = 1 / np.array(self.temperatures[::-1])
        return np.asarray(np.interp(1 / t, inverse, self.log10_shifts[::-1]))

    def activation_energy(self, temperature: npt.ArrayLike) -> FloatArray:
        """Apparent activation energy between neighbouring tested temperatures, J/mol."""
        if len(self.temperatures) < 2:
            raise DataError("one temperature has no activation energy: test at a second one")
        t = to_float(temperature)
        self.log10_a_t(t)  # refuses what is outside
        inverse, shift = 1 / np.array(self.temperatures), np.array(self.log10_shifts)
        slope = np.diff(shift) / np.diff(inverse)
        interval_index = np.clip(
            np.searchsorted(self.temperatures, t, side="right") - 1, 0, len(slope) - 1
        )
        return np.asarray(_LN10 * GAS_CONSTANT * slope[interval_index])
