"""Doors of many cars, as text."""

from __future__ import annotations

from dashpot.base.number_format import round_to_error
from dashpot.base.units import format_quantity
from dashpot.extensions.systems.door.population import (
    MIN_SD,
    DoorPopulation,
    DoorQuantity,
    format_limit,
    format_share,
)
from dashpot.text_output.layout import Text, table

_HEAD = ("", "median door", "95 % of the cars", "SD, %", "unit")
_SHARES = ("", "share of the cars", "95 % interval")


def render_population(population: DoorPopulation) -> Text:
    """Return the range of each quantity over the cars, and the share beyond each limit."""
    scattered = [quantity for quantity in population.quantities if quantity.between_sd > MIN_SD]
    constant_quantities = [
        quantity for quantity in population.quantities if quantity.between_sd <= MIN_SD
    ]
    lines = table([_HEAD, *map(_format_range, scattered)])
    if constant_quantities:
        names = ", ".join(
            f"{quantity.label} ({format_quantity(quantity.value, quantity.unit)})"
            for quantity in constant_quantities
        )
        lines.append(f"  not on the seal: {names}")
    limited = [
        quantity for quantity in population.quantities if quantity.nonconforming_share is not None
    ]
    if limited:
        lines += table([_SHARES, *map(_format_share_row, limited)])
    return Text(lines)


def _format_range(quantity: DoorQuantity) -> tuple[str, ...]:
    error = (quantity.high - quantity.low) / 4
    low, value, high = (
        round_to_error(number, error) for number in (quantity.low, quantity.value, quantity.high)
    )
    return quantity.label, value, f"{low} to {high}", f"{100 * quantity.sd:.2g}", quantity.unit


def _format_share_row(quantity: DoorQuantity) -> tuple[str, ...]:
    low, high = format_share(quantity.share_low), format_share(quantity.share_high)
    return (
        f"{quantity.label} {format_limit(quantity)}",
        f"{format_share(quantity.nonconforming_share)} %",
        low if low == high else f"{low} to {high}",
    )
