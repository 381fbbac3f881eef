"""Prior knowledge of an identification: on the rig and on the solid."""

from __future__ import annotations

from math import isfinite
from typing import Literal

from dashpot.base import dataclass, replace
from dashpot.base.errors import DataError
from dashpot.base.option_fields import option
from dashpot.base.units import Dimension, Quantity, si_fields, si_range
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES, HAMMER_RIG_FIELDS, Machine

_DIMENSIONS: dict[str, Dimension] = {
    "static_stiffness": "stiffness",
    "natural_frequency": "frequency",
    "damping_ratio": "strain",
}


@dataclass(frozen=True)
class HammerRig:
    """Prior uncertainty of the rig of a vibration test; 0 is exact.

    Attributes
    ----------
    mass_sd : float, optional
        Standard deviation of the mass, kg; 0.1 % by default.
    gain_sd, delay_sd : float
        What acceleration over force may be off by, relative, and late by, s. Of a transmissibility,
        the upper sensor over the lower.
    cable : float, optional
        Standard deviation of the stiffness of its cables over that of the seals; 0 if they hang
        free, 1.5 % by default (``dashpot.datamodel.machine.DEFAULT_UNCERTAINTIES``).
    high_pass : float, optional
        Corner of a first-order high-pass in the channel of the accelerometer alone, Hz; 0 if it has
        none or the hammer the same. By default there is none, and limits of a hammer test alone
        allow for one of 0.16 Hz.

    Raises
    ------
    DataError
        If a standard deviation is below 0.
    """

    mass_sd: float | None = option(None, "Standard deviation of the mass.", unit="mass")
    gain_sd: float = option(0.01, "Of acceleration over force, relative.")
    delay_sd: float = option(1e-4, "Of acceleration behind force.", unit="time")
    cable: float | None = option(None, "Of its cables over the seals.", unit="strain")
    high_pass: float | None = option(None, "Of the accelerometer alone.", unit="frequency")

    @property
    def cable_sd(self) -> float:
        """Error by cables, over the stiffness of the seals."""
        return DEFAULT_UNCERTAINTIES["cable"].size if self.cable is None else self.cable

    @property
    def high_pass_sd(self) -> float:
        """Error of the corner of the high-pass, Hz."""
        if self.high_pass is None:
            return DEFAULT_UNCERTAINTIES["high-pass"].size
        return DEFAULT_UNCERTAINTIES["high-pass, named"].size * self.high_pass

    def with_machine(self, machine: Machine | None) -> HammerRig:
        """Return the rig with what is stated of its cable and channels among the machines."""
        stated = {
            name: value
            for name in HAMMER_RIG_FIELDS
            if (value := getattr(machine, name, None)) is not None
        }
        return replace(self, **stated)

    def __post_init__(self) -> None:
        si_fields(self)
        for name in ("mass_sd", "gain_sd", "delay_sd", "cable", "high_pass"):
            _standard_deviation(name, getattr(self, name) or 0.0)


@dataclass(frozen=True)
class SolidPrior:
    r"""Prior knowledge of the solid under a mass (Zhang and Richards 2007).

    Each of the three is a value, which is exact, or a value and its standard deviation; the fields
    hold pairs in SI units.

    Attributes
    ----------
    static_stiffness : float or (float, float), optional
        k_inf of one seal, N/m.
    natural_frequency : float or (float, float), optional
        :math:`|p|/2\pi` of the mass on the seals, Hz.
    damping_ratio : float or (float, float), optional
        :math:`-\mathrm{Re}\,p/|p|`.
    parallel_dashpot : bool or "auto"
        A dashpot beside the arms: with no arm a Voigt solid, with one a Maxwell-Voigt solid;
        ``"auto"`` takes it where BIC prefers it.

    Raises
    ------
    DataError
        If a value is not positive, a standard deviation below 0, or the damping not below the
        critical.
    """

    parallel_dashpot: bool | Literal["auto"] = option(
        False, "Add a dashpot beside the arms.", is_flag=True, flag="dashpot"
    )
    static_stiffness: float | tuple[float, float] | None = option(
        None,
        "Static stiffness of one seal.",
        unit="stiffness",
        keyed_flag="prior",
        hidden_alias="known",
        key="stiffness",
    )
    natural_frequency: float | tuple[float, float] | None = option(
        None,
        "Natural frequency.",
        unit="frequency",
        keyed_flag="prior",
        hidden_alias="known",
        key="frequency",
    )
    damping_ratio: float | tuple[float, float] | None = option(
        None,
        "Damping ratio.",
        exclusive_minimum=0.0,
        keyed_flag="prior",
        hidden_alias="known",
        key="damping",
    )

    def __post_init__(self) -> None:
        for name in _DIMENSIONS:
            object.__setattr__(self, name, self.pair(name))

    def pair(self, name: str) -> tuple[float, float] | None:
        """Return a quantity with its standard deviation, SI units; None if it is not known."""
        return _pair(name, getattr(self, name), _DIMENSIONS[name])


def _pair(
    name: str, given_values: Quantity | tuple[Quantity, Quantity] | None, dimension: Dimension
) -> tuple[float, float] | None:
    if given_values is None:
        return None
    value, sd = si_range(
        given_values if isinstance(given_values, tuple) else (given_values, 0.0), dimension
    )
    if not (isfinite(value) and value > 0):
        raise DataError(f"{name} = {value!r}; expected a number > 0")
    if name == "damping_ratio" and value >= 1:
        raise DataError(
            f"damping_ratio = {value:g}; expected a part of the critical damping, < 1: if it is "
            f"in per cent, give {value / 100:g}"
        )
    _standard_deviation(name, sd)
    return float(value), float(sd)


def _standard_deviation(name: str, value: float) -> None:
    if not (isfinite(value) and value >= 0):
        raise DataError(f"{name} = {value!r}; expected a standard deviation >= 0")
