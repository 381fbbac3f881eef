"""Public Python functions for doors."""

from __future__ import annotations

from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.extensions.systems.door.closing_result import ClosingResult
from dashpot.extensions.systems.door.door_model import Door
from dashpot.extensions.systems.door.result import DoorResult


def predict_door(
    door: Door,
    *,
    band: Range | None = None,
    close: Quantity | None = None,
    temperature: Quantity | None = None,
) -> DoorResult | ClosingResult:
    """Predict how a door vibrates on its seal, or how it closes at a speed of its edge."""
    from dashpot.extensions.systems.door.analyse_file import door_file
    from dashpot.extensions.systems.door.closing_from_file import close_file

    kelvin = convert_to_si(temperature, "temperature")
    if close is not None:
        return close_file(door, convert_to_si(close, "velocity"), temperature=kelvin)
    return door_file(door, band=si_range(band, "frequency"), temperature=kelvin)
