"""Approach of a mass to a seal: impact speed, or drop height."""

from __future__ import annotations

import math

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.units import GRAVITY, Quantity, parse_quantity
from dashpot.base.value_ranges import require_positive


@dataclass(frozen=True)
class Approach:
    """Approach of a mass to a specimen.

    Attributes
    ----------
    speed : float
        Impact speed, m/s.
    gravity : float
        Acceleration of the free mass, m/s^2: gravity after a fall, else 0.
    """

    speed: float
    gravity: float = 0.0

    def __post_init__(self) -> None:
        require_positive("drop: ", speed=self.speed, unit=" m/s")

    @classmethod
    def from_quantity(cls, item: Quantity) -> Approach:
        r"""Return the approach by speed, m/s or ``"0.6m/s"``, or a drop height, ``"18.4mm"``.

        After a fall from rest :math:`v = \sqrt{2 g h}`, and gravity acts on.

        Raises
        ------
        DataError
            If it is neither.
        """
        if not isinstance(item, str):
            return cls(float(item))
        for dimension in ("velocity", "length"):
            try:
                value = parse_quantity(item, dimension)
            except DataError:
                continue
            if dimension == "velocity":
                return cls(value)
            require_positive("drop: ", fall=value, unit=" m")
            return cls(math.sqrt(2 * GRAVITY * value), GRAVITY)
        raise DataError(
            f"--drop {item}: expected the speed at the touch with its unit, 0.6m/s, or the height "
            "of the fall, 18mm"
        )
