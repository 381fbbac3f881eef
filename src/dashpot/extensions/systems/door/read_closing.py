"""Reader of the table [closing] of a door file."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from dashpot.base.errors import ReadError
from dashpot.base.units import Dimension
from dashpot.extensions.systems.door.closing_setup import (
    ADIABATIC,
    DISCHARGE,
    ISOTHERMAL,
    Cabin,
    CheckStrap,
    ClosingSetup,
    InterSealAir,
    Latch,
    Tolerances,
    Vents,
)
from dashpot.extensions.systems.door.toml_section import DoorSection

T = TypeVar("T")
_AIR_KEYS = ("discharge", "process")


def read_closing(
    location: str, entries: Any, width: float | None = None, height: float | None = None
) -> ClosingSetup:
    """Return the closing setup of a table.

    Parameters
    ----------
    location : str
        How to name it.
    entries : mapping
    width, height : float, optional
        Width and height of the door, m.

    Raises
    ------
    ReadError
        If a key is unknown, missing or cannot be.
    """
    section = DoorSection(
        location,
        entries,
        ("edge", "inertia", "axis", "start", "friction", "gravity", "check", "latch", "vents",
         "between", "cabin", "variation"),
    )  # fmt: skip

    def sub(make: Callable[[DoorSection], T], name: str, *known_keys: str) -> T | None:
        """Return the value built from a subtable, if there is one."""
        table = section.entries.get(name)
        return (
            None
            if table is None
            else make(DoorSection(f"{location[:-1]}.{name}]", table, known_keys))
        )

    area = width * height if width and height else None

    return ClosingSetup(
        section.quantity("edge", "length"),
        section.quantity("inertia", "moment of inertia"),
        section.direction("axis"),
        section.quantity("start", "angle"),
        section.quantity("friction", "torque") or 0.0,
        section.direction("gravity"),
        sub(_check, "check", "angle", "moment"),
        sub(partial(_read_latch, width), "latch", "travel", "force", "lever", "overtravel"),
        sub(_read_vents, "vents", "width", "hollow", "hole", "spacing", *_AIR_KEYS),
        sub(_read_inter_seal_air, "between", "width", "depth", "leak", *_AIR_KEYS),
        sub(
            partial(_read_cabin, width, area),
            "cabin",
            "volume",
            "area",
            "lever",
            "opening",
            *_AIR_KEYS,
        ),
        sub(_read_variation, "variation", "gap", "force", "correlation", "doors", "seed", "limit"),
    )


def _check(table: DoorSection) -> CheckStrap:
    table.require_keys("angle", "moment")
    return CheckStrap(
        table.quantities("angle", "angle") or (), table.quantities("moment", "torque") or ()
    )


def _read_latch(width: float | None, table: DoorSection) -> Latch:
    table.require_keys("travel", "force")
    return Latch(
        table.quantities("travel", "length") or (),
        table.quantities("force", "force") or (),
        _read_or_default(table, "lever", "length", width),
        table.quantity("overtravel", "length") or 0.0,
    )


def _read_vents(table: DoorSection) -> Vents:
    table.require_keys("width", "hollow", "hole", "spacing")
    width, hollow, hole, spacing = (
        table.quantity(name, "length") or 0.0 for name in ("width", "hollow", "hole", "spacing")
    )
    if not spacing > 0:
        raise ReadError(f"{table.location}: spacing = {spacing:g} m; expected a distance > 0")
    return Vents(*_read_air(table), width, width * hollow, math.pi / 4 * hole * abs(hole) / spacing)


def _read_inter_seal_air(table: DoorSection) -> InterSealAir:
    table.require_keys("width", "depth")
    width, depth, leak = (
        table.quantity(name, "length") or 0.0 for name in ("width", "depth", "leak")
    )
    return InterSealAir(*_read_air(table), width, depth, leak)


def _read_cabin(width: float | None, area: float | None, table: DoorSection) -> Cabin:
    table.require_keys("volume", "opening")
    return Cabin(
        *_read_air(table),
        table.quantity("volume", "volume") or 0.0,
        _read_or_default(table, "area", "area", area),
        _read_or_default(table, "lever", "length", 0.5 * width if width else None),
        table.quantity("opening", "area") or 0.0,
    )


def _read_variation(table: DoorSection) -> Tolerances:
    doors, seed = table.number("doors"), table.number("seed") or 0.0
    for name, value in (("doors", doors or 0.0), ("seed", seed)):
        if value != int(value) or value < 0:
            raise ReadError(f"{table.location}: {name} = {value:g}; expected a whole number >= 0")
    return Tolerances(
        table.quantity("gap", "length") or 0.0,
        table.quantity("force", "strain") or 0.0,
        table.quantity("correlation", "length"),
        Tolerances.count if doors is None else int(doors),
        int(seed),
        table.quantity("limit", "velocity"),
    )


def _read_air(table: DoorSection) -> tuple[float, float]:
    """Discharge coefficient and exponent."""
    entries = {"adiabatic": ADIABATIC, "isothermal": ISOTHERMAL}
    process = table.word("process") or "adiabatic"
    if process not in entries:
        raise ReadError(
            f"{table.location}: process = '{process}'; expected adiabatic or isothermal"
        )
    discharge = table.number("discharge")
    return DISCHARGE if discharge is None else discharge, entries[process]


def _read_or_default(
    table: DoorSection, name: str, dimension: Dimension, default: float | None
) -> float:
    value = table.quantity(name, dimension)
    if value is None:
        value = default
    if value is None:
        raise ReadError(f"{table.location}: {name} is missing, and [door] has no width and height")
    return value
