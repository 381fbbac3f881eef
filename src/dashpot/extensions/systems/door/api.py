"""Public Python functions for doors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.extensions.systems.door.closing_result import ClosingResult
from dashpot.extensions.systems.door.door_model import Door
from dashpot.extensions.systems.door.leak_result import LeakResult
from dashpot.extensions.systems.door.result import DoorResult

if TYPE_CHECKING:
    from dashpot.extensions.systems.door.population import DoorPopulation


def predict_door(
    door: Door,
    *,
    band: Range | None = None,
    close: Quantity | None = None,
    leak: bool = False,
    temperature: Quantity | None = None,
    lot: Any = None,
    spread: Quantity | None = None,
    limits: Sequence[str] = (),
) -> DoorResult | ClosingResult | LeakResult | DoorPopulation:
    """Predict how a door vibrates on its seal, how it closes, or at which speed its seal lifts.

    With a `lot` of its seals, or their `spread`, it is doors of many cars, as
    :func:`~dashpot.extensions.systems.door.population.predict_population` predicts them.
    """
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
    if lot is not None or spread is not None or limits:
        from dashpot.extensions.systems.door.population import predict_population

        return predict_population(
            door, lot=lot, spread=spread, limits=limits, band=si_range(band, "frequency"),
            temperature=kelvin,
        )  # fmt: skip
    if close is not None:
        return close_file(door, convert_to_si(close, "velocity"), temperature=kelvin)
    return door_file(door, band=si_range(band, "frequency"), temperature=kelvin)
