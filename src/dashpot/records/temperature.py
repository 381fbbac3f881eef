"""What tests at several temperatures say of how a solid moves with temperature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, frozen
from dashpot.base.errors import DataError
from dashpot.solids.temperature import TemperatureLaw


@dataclass(frozen=True)
class Shift:
    """Where one temperature lies against the reference.

    Attributes
    ----------
    temperature : float
        K.
    log10_a_t, se : float
        Decadic logarithm of the shift factor of time, and its standard error.
    b_t, b_t_se : float
        Factor of every stiffness, and its standard error; 0 where it was held.
    """

    temperature: float
    log10_a_t: float
    se: float
    b_t: float = 1.0
    b_t_se: float = 0.0


@dataclass(frozen=True, eq=False)
class TemperatureShifts(ByValue):
    """The shifts of several temperatures, and the law laid through them.

    Attributes
    ----------
    law : TemperatureLaw
        Of the shift factor of time.
    shifts : tuple of Shift
        By rising temperature; the reference is among them, with no shift and no error.
    covariance : array, shape (2 n, 2 n)
        Of log10 a_T of every shift, then of ln b_T of every shift; zero rows at the reference.
    law_parameters : tuple of str
        Names of the rows of `law_covariance`: ``("c1", "c2")``, ``("energy",)`` or none.
    law_covariance : array, shape (p, p)
    vertical : str
        How stiffnesses follow the temperature: ``"free"``, ``"T/T_r"`` or ``"1"``.
    """

    law: TemperatureLaw
    shifts: tuple[Shift, ...]
    covariance: FloatArray
    law_parameters: tuple[str, ...] = ()
    law_covariance: FloatArray = ()  # type: ignore[assignment]
    vertical: str = "free"

    def __post_init__(self) -> None:
        for name, rows in (
            ("covariance", 2 * len(self.shifts)),
            ("law_covariance", len(self.law_parameters)),
        ):
            found = np.asarray(getattr(self, name), dtype=float).reshape(-1)
            if found.size != rows * rows:
                raise DataError(f"{name} has {found.size} values, expected {rows} x {rows}")
            object.__setattr__(self, name, frozen(found.reshape(rows, rows)))
        rising = [shift.temperature for shift in self.shifts]
        if rising != sorted(set(rising)) or self.law.reference not in rising:
            raise DataError(
                f"shifts at {rising} K; expected rising temperatures with the reference of "
                f"{self.law.reference:g} K among them"
            )

    @property
    def reference(self) -> float:
        """T_r, K: the temperature of the fit's solid."""
        return self.law.reference

    @property
    def tested(self) -> tuple[float, float]:
        """The coldest and the warmest test, K."""
        return self.shifts[0].temperature, self.shifts[-1].temperature

    def b_t(self, temperature: float) -> float:
        """Factor of every stiffness at T, K: ln b straight in T between tests and beyond."""
        if self.vertical == "1":
            return 1.0
        if self.vertical == "T/T_r":
            return temperature / self.reference
        at = np.array([shift.temperature for shift in self.shifts])
        b = np.log([shift.b_t for shift in self.shifts])
        if len(at) == 1:
            return 1.0
        i = int(np.clip(np.searchsorted(at, temperature) - 1, 0, len(at) - 2))
        slope = (b[i + 1] - b[i]) / (at[i + 1] - at[i])
        return float(np.exp(b[i] + slope * (temperature - at[i])))
