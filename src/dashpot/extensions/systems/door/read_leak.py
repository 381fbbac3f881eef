"""Reader of the table [leak] of a door file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dashpot.base.errors import ReadError
from dashpot.extensions.systems.door.leak_setup import AgingChoice, LeakSetup, LeakState
from dashpot.extensions.systems.door.read_closing import require_keys
from dashpot.reading.toml import Section

_KEYS = (
    "lip", "lip_sd", "pressure_coefficient", "pressure_coefficient_sd", "gap_sd", "force_sd",
    "limit", "state",
)  # fmt: skip
_STATE_KEYS = (
    "name", "gap", "time", "temperature", "retained", "retained_sd", "aging", "aging_time",
    "aging_temperature", "density",
)  # fmt: skip
_MAX_STATES = 50
"""Largest number of states."""


def read_leak_setup(location: str, entries: Any, path: Callable[[str | None], str]) -> LeakSetup:
    """Return the pressure, its errors and the states that a table [leak] gives.

    Parameters
    ----------
    location : str
        Name of the table in messages.
    entries : mapping
    path : callable
        Function from a file name in the door file to its path.

    Raises
    ------
    ReadError
        If a key is unknown or missing, or a value impossible.
    """
    table = Section(location, entries, _KEYS)
    require_keys(table, "lip")
    rows = table.entries.get("state", [])
    rows = [rows] if isinstance(rows, dict) else rows
    if not isinstance(rows, list) or len(rows) > _MAX_STATES:
        raise ReadError(f"{location}: expected at most {_MAX_STATES} tables [[leak.state]]")
    states = tuple(
        _read_state(Section(f"{location[:-1]}.state] {i}", row, _STATE_KEYS), i, path)
        for i, row in enumerate(rows, start=1)
    )
    coefficient = table.number("pressure_coefficient")
    return LeakSetup(
        table.quantity("lip", "length") or 0.0,
        LeakSetup.pressure_coefficient if coefficient is None else coefficient,
        table.quantity("lip_sd", "length") or 0.0,
        table.number("pressure_coefficient_sd") or 0.0,
        table.quantity("gap_sd", "length") or 0.0,
        table.quantity("force_sd", "strain") or 0.0,
        table.quantity("limit", "velocity"),
        states,
    )


def _read_state(row: Section, number: int, path: Callable[[str | None], str]) -> LeakState:
    time, retained_fraction = row.quantity("time", "time"), row.quantity("retained", "strain")
    aging = None
    if "aging" in row:
        require_keys(row, "aging_time", "aging_temperature")
        aging = AgingChoice(
            path(row.word("aging")),
            row.quantity("aging_time", "time") or 0.0,
            row.quantity("aging_temperature", "temperature") or 0.0,
        )
    elif "aging_time" in row or "aging_temperature" in row:
        raise ReadError(f"{row.location}: aging is missing, the file of the aging law")
    return LeakState(
        row.word("name") or f"state {number}",
        row.quantity("gap", "length") or 0.0,
        float("inf") if time is None else time,
        row.quantity("temperature", "temperature"),
        1.0 if retained_fraction is None else retained_fraction,
        row.quantity("retained_sd", "strain") or 0.0,
        aging,
        row.number("density"),
    )
