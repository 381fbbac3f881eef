"""Public Python functions for doors."""

from __future__ import annotations

from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.extensions.systems.door.closing_result import ClosingResult
from dashpot.extensions.systems.door.door_model import Door
from dashpot.extensions.systems.door.leak_result import LeakResult
from dashpot.extensions.systems.door.result import DoorResult


def predict_door(
    door: Door,
    *,
    band: Range | None = None,
    close: Quantity | None = None,
    leak: bool = False,
    temperature: Quantity | None = None,
) -> DoorResult | ClosingResult | LeakResult:
    """Predict how a door vibrates on its seal, how it closes, or at which speed its seal lifts."""
    from dashpot.extensions.systems.door.analyse_file import door_file
    from dashpot.extensions.systems.door.closing_from_file import close_file
    from dashpot.extensions.systems.door.leak_from_file import find_leak_speeds

    kelvin = convert_to_si(temperature, "temperature")
    if leak:
        if close is not None or band is not None:
            raise DataError(
                "a leak speed is asked by itself: leave out the closing speed and the band"
            )
        return find_leak_speeds(door, temperature=kelvin)
    if close is not None:
        return close_file(door, convert_to_si(close, "velocity"), temperature=kelvin)
    return door_file(door, band=si_range(band, "frequency"), temperature=kelvin)
