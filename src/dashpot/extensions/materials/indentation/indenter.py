"""Indenter: mass and shape of the body that hits."""

from __future__ import annotations

import math
from typing import Literal, TypeAlias

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import option
from dashpot.base.units import GRAVITY, si_fields
from dashpot.base.value_ranges import SIZES, require_positive


@dataclass(frozen=True)
class Indenter:
    """Indenter; each number may be given with its unit, ``"5g"``.

    Attributes
    ----------
    mass : float or None
        kg; all that moves with the indenter.
    radius : float or None
        Radius of its spherical tip, m.
    radius_error : float
        Its standard deviation, relative; a tip that is worn, or a radius that is nominal.
    drop_height : float or None
        From rest to the surface, m: it falls, and gravity pulls on.
    impact_velocity : float or None
        Velocity of approach, m/s, if measured separately.
    """

    mass: float | None = option(
        None, "Mass of all that moves with the indenter, e.g. 5g.", unit="mass", size=SIZES["mass"]
    )
    radius: float | None = option(
        None, "Radius of the spherical tip, e.g. 5mm.", unit="length", size=SIZES["radius"]
    )
    radius_error: float = option(0.025, "Error of the radius, e.g. 1%.", unit="strain")
    drop_height: float | None = option(
        None, "Height from rest to the surface, e.g. 50mm.", unit="length"
    )
    impact_velocity: float | None = option(
        None, "Approach velocity, measured separately.", unit="velocity"
    )

    def __post_init__(self) -> None:
        si_fields(self)
        entries = {name: value for name, value in vars(self).items() if name != "radius_error"}
        require_positive(**entries, expected="a number > 0 in SI units", optional=True)
        if not 0 <= self.radius_error < 1:
            raise DataError(
                f"radius_error = {self.radius_error:g}; expected a fraction from 0 to below 1"
            )

    @property
    def gravity(self) -> float:
        """Acceleration besides the contact's, m/s^2: gravity for a fall."""
        return GRAVITY if self.drop_height is not None else 0.0

    @property
    def stated_velocity(self) -> float | None:
        """Stated velocity of approach, or that of a free fall from the stated height, m/s."""
        if self.impact_velocity is not None or self.drop_height is None:
            return self.impact_velocity
        return math.sqrt(2 * GRAVITY * self.drop_height)


ImpactLaw: TypeAlias = Literal["kelvin-voigt", "hertz", "hertz-kelvin-voigt", "hertz-maxwell"]
ImpactLawOption: TypeAlias = Literal["auto", ImpactLaw]
