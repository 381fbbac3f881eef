"""Resistances of a closing door besides its seal, and their tolerances."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import format_quantity
from dashpot.base.value_ranges import require_nonnegative, require_positive, select_fields

Vector: TypeAlias = tuple[float, float, float]

DISCHARGE = 0.62
"""Discharge coefficient of a sharp-edged hole."""
ADIABATIC, ISOTHERMAL = 1.4, 1.0
"""Exponents n of p ~ density^n."""


class DoorPosition(NamedTuple):
    """Position of a door at an angle.

    Attributes
    ----------
    angle : float
        From closed, rad.
    pressed, gap : array, shape (doors, stations)
        Compression of the seal, and its gap to the counterpart, m, >= 0.
    length : array, shape (stations,)
        Length of seal that each station represents, m.
    lever : array, shape (stations,)
        By how much the gap grows with the angle, m.
    """

    angle: float
    pressed: FloatArray
    gap: FloatArray
    length: FloatArray
    lever: FloatArray


@dataclass(frozen=True)
class Air:
    r"""Air that the door displaces through holes and gaps.

    Attributes
    ----------
    discharge : float
        Coefficient of the openings.
    exponent : float
        n of :math:`p \sim \rho^n`: 1.4 adiabatic, 1 isothermal.
    """

    discharge: float = DISCHARGE
    exponent: float = ADIABATIC

    def __post_init__(self) -> None:
        if not 0 < self.discharge <= 1 or self.exponent not in {ADIABATIC, ISOTHERMAL}:
            raise DataError(
                f"a discharge coefficient of {self.discharge:g}, an exponent of "
                f"{self.exponent:g}; expected > 0 and at most 1, and 1.4 or 1"
            )

    def chambers(self, door: DoorPosition) -> tuple[FloatArray, FloatArray]:
        """Volumes, m^3, and openings, m^2, each of shape (doors, chambers)."""
        raise NotImplementedError


@dataclass(frozen=True)
class Vents(Air):
    """Vent holes in the bulb of the seal: one chamber at every station.

    Attributes
    ----------
    width : float
        Width of the compressed bulb, m.
    section : float
        Area of the free bulb's hollow, m^2.
    opening : float
        Opening of the holes of one metre of seal, m^2/m; 0 is a sealed bulb.
    """

    width: float = 0.0
    section: float = 0.0
    opening: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive("the vents: ", width=self.width, section=self.section)
        require_nonnegative("the vents: ", opening=self.opening)

    def chambers(self, door: DoorPosition) -> tuple[FloatArray, FloatArray]:
        """Return the free volume of the hollow under compression."""
        hollow = self.section - self.width * door.pressed
        if (hollow <= 0).any():
            raise DataError(
                f"a bulb of {format_quantity(self.section, 'mm^2')} that is "
                f"{format_quantity(self.width, 'mm')} "
                "wide has no air left when pressed by "
                f"{format_quantity(door.pressed.max(), 'mm')}; give "
                "the area of its hollow and the width over which it is pressed"
            )
        return door.length * hollow, np.broadcast_to(door.length * self.opening, hollow.shape)


@dataclass(frozen=True)
class InterSealAir(Air):
    """Air between two seals, which escapes past the one that is not yet in contact.

    Attributes
    ----------
    width : float
        Distance of the two seals, m.
    depth : float
        Depth of the space between them with the door closed, m.
    opening : float
        Opening of drains and leaks of one metre, m^2/m.
    """

    width: float = 0.0
    depth: float = 0.0
    opening: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive("the air between the seals: ", width=self.width, depth=self.depth)
        require_nonnegative("the air between the seals: ", opening=self.opening)

    def chambers(self, door: DoorPosition) -> tuple[FloatArray, FloatArray]:
        """Return the space between the seals, and its leaks with the gap that is still open."""
        depth = self.depth + np.maximum(door.lever, 0.0) * door.angle
        volume = np.broadcast_to(door.length * self.width * depth, door.gap.shape)
        return volume, door.length * (self.opening + door.gap)


@dataclass(frozen=True)
class Cabin(Air):
    """Air of the cabin, which the closing door compresses.

    Attributes
    ----------
    volume : float
        m^3.
    area : float
        Area of the door, m^2.
    lever : float
        Lever arm of its middle about the hinges, m.
    opening : float
        Opening of exhaust vents, open windows and leaks, m^2.
    """

    volume: float = 0.0
    area: float = 0.0
    lever: float = 0.0
    opening: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive("the cabin: ", volume=self.volume, area=self.area, lever=self.lever)
        require_nonnegative("the cabin: ", opening=self.opening)

    def chambers(self, door: DoorPosition) -> tuple[FloatArray, FloatArray]:
        """Return the cabin with the volume behind the door, and its vents with the open gap."""
        volume = self.volume + self.area * self.lever * door.angle
        opening = self.opening + (door.gap @ door.length)[:, None]
        return np.full_like(opening, volume), opening


@dataclass(frozen=True)
class Latch:
    """Latch force over the remaining travel.

    Attributes
    ----------
    travel, force : tuple of float
        m left to fully latched, rising from 0, and N against closing.
    lever : float
        m about the hinges.
    overtravel : float
        How far the door must go beyond closed for the pawl to drop, m.
    """

    travel: tuple[float, ...]
    force: tuple[float, ...]
    lever: float
    overtravel: float = 0.0

    def __post_init__(self) -> None:
        require_positive("the latch: ", lever=self.lever)
        require_nonnegative("the latch: ", overtravel=self.overtravel)
        _validate_table("the latch", self.travel, self.force, from_zero=True)

    def moment(self, angle: FloatArray) -> FloatArray:
        """N m against closing, at angles from fully latched, rad; none beyond its travel."""
        remaining_travel = self.lever * np.asarray(angle)
        return self.lever * np.interp(remaining_travel, self.travel, self.force, right=0.0)


@dataclass(frozen=True)
class CheckStrap:
    """Check strap: moment over angle.

    Attributes
    ----------
    angle, moment : tuple of float
        From closed, rad, rising; N m against closing, negative if it helps.
    """

    angle: tuple[float, ...]
    moment: tuple[float, ...]

    def __post_init__(self) -> None:
        _validate_table("the check strap", self.angle, self.moment)

    def moment_at(self, angle: FloatArray) -> FloatArray:
        """N m against closing; none outside the table."""
        return np.interp(angle, self.angle, self.moment, left=0.0, right=0.0)


@dataclass(frozen=True)
class Tolerances:
    """Tolerances of doors.

    Attributes
    ----------
    gap : float
        Tolerance of the gap, m: three standard deviations of a normal distribution.
    load : float
        Tolerance of the seal's force, a part of it: likewise.
    correlation : float or None
        Correlation length of the gap along the line, m; None: the gap varies as a whole.
    count : int
        Doors drawn.
    seed : int
    limit : float or None
        Largest allowed closing speed, m/s.
    """

    gap: float = 0.0
    load: float = 0.0
    correlation: float | None = None
    count: int = 200
    seed: int = 0
    limit: float | None = None

    def __post_init__(self) -> None:
        require_nonnegative("the variation: ", gap=self.gap, load=self.load)
        if self.load >= 1 or not 2 <= self.count <= 100_000:
            raise DataError(
                f"a tolerance of {self.load:g} of the seal's force in {self.count} doors; expected "
                "below 1 and 2 to 100000 doors"
            )


@dataclass(frozen=True)
class ClosingSetup:
    """Resistances of a closing door besides its seal; None or 0 if absent.

    Attributes
    ----------
    edge : float or None
        Distance from the hinge axis at which the speed is meant, m; None is the door's width.
    inertia : float or None
        About the hinge axis, kg m^2; None follows from the door's mass, centre and inertia.
    axis : (float, float, float) or None
        Direction of the hinge axis; None runs through the hinges.
    start : float or None
        Angle at which the door has its speed, rad; None is where the seal first touches.
    friction : float
        Moment of the hinges, N m.
    gravity : (float, float, float) or None
        Direction in which weight pulls.
    check, latch, vents, inter_seal_air, cabin : resistance or None
    variation : Tolerances or None
    """

    edge: float | None = None
    inertia: float | None = None
    axis: Vector | None = None
    start: float | None = None
    friction: float = 0.0
    gravity: Vector | None = None
    check: CheckStrap | None = None
    latch: Latch | None = None
    vents: Vents | None = None
    inter_seal_air: InterSealAir | None = None
    cabin: Cabin | None = None
    variation: Tolerances | None = None
    air_terms: tuple[tuple[str, Air], ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_nonnegative("closing: ", friction=self.friction)
        require_positive(
            "closing: ", **select_fields(self, "edge", "inertia", "start"), optional=True
        )
        named_parts = (
            ("vents", self.vents), ("air between seals", self.inter_seal_air),
            ("cabin air", self.cabin),
        )  # fmt: skip
        named_air_parts = tuple((name, air) for name, air in named_parts if air is not None)
        object.__setattr__(self, "air_terms", named_air_parts)


def _validate_table(
    owner: str, x: tuple[float, ...], y: tuple[float, ...], *, from_zero: bool = False
) -> None:
    is_rising = len(x) >= 2 and bool((np.diff(x) > 0).all()) and (x[0] == 0 or not from_zero)
    if len(x) != len(y) or not is_rising or not np.isfinite([*x, *y]).all():
        begins = "from 0 " if from_zero else ""
        raise DataError(
            f"{owner}: {len(x)} positions and {len(y)} values; expected as many of both, at least "
            f"two, the positions rising {begins}and all finite"
        )
