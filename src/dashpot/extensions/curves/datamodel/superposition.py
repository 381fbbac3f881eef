"""Superposition of sweeps or moduli at several temperatures: a master curve."""

from __future__ import annotations

from typing import NamedTuple

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray, require_same_length, validate_samples
from dashpot.base.checks import Check
from dashpot.base.provenance import Source, Step
from dashpot.base.result_mixins import Plottable, Series
from dashpot.base.units import celsius
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.extensions.curves.datamodel.creep import CreepCompliance
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.solids.maxwell import GeneralizedMaxwell


class UnshiftedCurve(NamedTuple):
    """Curve that was not shifted, with the interface of a master curve."""

    sources: tuple[Source, ...]
    checks: tuple[Check, ...] = ()
    steps: tuple[Step, ...] = ()
    temperatures: None = None


@dataclass(frozen=True, eq=False, repr=False)
class Superposition(EqualByValue, Plottable):
    """Master curve of tests at several temperatures by time-temperature superposition.

    Attributes
    ----------
    curve : DynamicTest, RelaxationModulus or CreepCompliance
        The master curve: every sample where it lies at the reference, in reduced frequency or
        time, rising; moduli over b_T, compliances times b_T.
    temperature : array, shape (n,)
        At which each of its samples was measured, K.
    temperatures : TemperatureShifts
    solid : GeneralizedMaxwell
        The positive spectrum of all temperatures at the reference; its single arms mean nothing.
    rms : float
        Its rms residual, relative to the magnitude of the modulus.
    checks : tuple of Check
    sources : tuple of Source
    steps : tuple of Step
    """

    curve: DynamicTest | RelaxationModulus | CreepCompliance
    temperature: FloatArray
    temperatures: TemperatureShifts
    solid: GeneralizedMaxwell
    rms: float
    checks: tuple[Check, ...] = ()
    sources: tuple[Source, ...] = ()
    steps: tuple[Step, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "temperature", validate_samples("temperature", self.temperature))
        abscissa = self.curve.frequency if isinstance(self.curve, DynamicTest) else self.curve.time
        require_same_length(curve=abscissa, temperature=self.temperature)

    @property
    def model(self) -> GeneralizedMaxwell:
        """The spectrum, as a fit names it."""
        return self.solid

    @property
    def _table_columns(self) -> Series:
        """The master curve, and the temperature that each of its samples was measured at."""
        return {**self.curve._table_columns, "temperature": (self.temperature, "K")}

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the shifted curves, the shifts, the law and its residual."""
        shifts = self.temperatures
        largest_shift = max(abs(shift.log10_a_t) for shift in shifts.shifts)
        count, (cold, hottest) = len(shifts.tested_shifts), shifts.tested_range
        return (
            (
                f"{count} temperatures, {celsius(cold)} to {celsius(hottest)}, at "
                f"{celsius(shifts.reference)}"
            ),
            *self.curve._summary_lines[1:],
            (
                f"shifted by up to {largest_shift:.3g} decades, {shifts.law.kind} law, b_T = "
                f"{shifts.vertical}"
            ),
            f"{self.solid.arms} arms leave {100 * self.rms:.2g} % rms",
            *(check.message for check in self.checks if check.failed),
        )
