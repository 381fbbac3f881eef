"""Quantities of a lot: table column, name, unit and number format."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

from dashpot.base.errors import DataError
from dashpot.base.number_format import format_cell
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import (
    Dimension,
    column,
    convert_to_unit,
    find_unit,
    get_display_unit,
)

_WORDS = {
    "k_end": "stiffness at the end of the hold", "k_0": "instantaneous stiffness",
    "k_inf": "equilibrium stiffness", "frequency": "frequency of the mass",
    "damping_ratio": "damping ratio of the mass", "E_end": "modulus at the end",
    "E_0": "instantaneous modulus", "E_inf": "equilibrium modulus",
    "cld_at": "nominal compression", "cld_force": "force at nominal",
    "cld_per_100mm": "force at nominal per 100 mm", "cld_slope": "slope at nominal",
    "cld_hysteresis": "hysteresis", "cld_softening": "softening", "cld_set": "set",
    "loop_frequency": "frequency of the loops", "loop_amplitude": "largest amplitude of the loops",
    "loop_storage": "storage of the loops", "loop_loss": "loss of the loops",
    "loop_loss_factor": "loss factor of the loops", "loop_softening": "softening with amplitude",
    "indent_modulus": "modulus under the indenter", "restitution": "restitution",
}  # fmt: skip
_KINDS = {"storage": "storage stiffness", "loss": "loss stiffness", "loss_factor": "loss factor"}

_COLUMN_UNITS = ("N/m", "Hz", "Pa", "s", "m", "N", "kg")
"""Units that a column may end in, the longer ones first."""


def parse_column_title(title: str) -> tuple[str, str]:
    """Return the name of a column of a lot, and its unit.

    >>> parse_column_title("k_inf_N_per_m"), parse_column_title("tau_1_s"), parse_column_title(
    ...     "damping_ratio")
    (('k_inf', 'N/m'), ('tau_1', 's'), ('damping_ratio', ''))
    """
    unit = next((name for name in _COLUMN_UNITS if title.endswith(column("", name))), "")
    return (title.removesuffix(column("", unit)) if unit else title), unit


class Quantity(NamedTuple):
    """Numeric column of a lot.

    Attributes
    ----------
    name, column : str
        Name without its unit, as typed by a user, and with it: ``"k_end"``, ``"k_end_N_per_m"``.
    words : str
    unit : str
        Display unit; empty for a dimensionless number.
    """

    name: str
    column: str
    words: str
    unit: str

    @property
    def scale(self) -> float:
        """Factor from SI to the unit of the quantity."""
        return convert_to_unit(1.0, self.unit) if self.unit else 1.0

    @property
    def dimension(self) -> Dimension | None:
        """Dimension of the quantity; None for a plain number."""
        unit = find_unit(self.unit)
        return None if unit is None else unit.dimension

    @property
    def title(self) -> str:
        """Name of the quantity with its unit."""
        return f"{self.words}, {self.unit}" if self.unit else self.words

    def fact(
        self, name: str, value: float, interval: tuple[float, float] | None = None
    ) -> ReportedValue:
        """Return a number of this quantity, SI, and its 95 % interval."""
        low, high = interval or (math.nan, math.nan)
        return ReportedValue(
            name, value, low, high, parse_column_title(self.column)[1], read=self.unit
        )

    def format_value(self, value: float | None, *, digits: int = 4) -> str:
        """Return a value, SI, in that unit without its word; empty if there is none."""
        return format_cell(value, self.unit or "1", digits=digits)

    def read(self, value: float, *, digits: int = 4) -> str:
        """Return a value, SI, with its unit."""
        return f"{self.format_value(value, digits=digits)} {self.unit}".strip()


def quantity(name: str, columns: Sequence[str]) -> Quantity:
    """Return the quantity by its name or column; if several have the name, the first column.

    Raises
    ------
    DataError
        If no column is called so.
    """
    quantities = [_parse_column(column) for column in columns]
    resolved_quantities = {quantity.name: quantity for quantity in reversed(quantities)} | {
        quantity.column: quantity for quantity in quantities
    }
    if name not in resolved_quantities:
        available_names = ", ".join(sorted({quantity.name for quantity in quantities}))
        raise DataError(
            f"'{name}' is no column of numbers of the table; there are {available_names}"
        )
    return resolved_quantities[name]


def _parse_column(column: str) -> Quantity:
    name, unit = parse_column_title(column)
    return Quantity(name, column, _format_quantity_words(name), get_display_unit(unit))


def _format_quantity_words(name: str) -> str:
    kind, _, position_text = name.partition("_at_")
    if not position_text:
        return _WORDS.get(name, name.replace("_", " "))
    position_words = [
        re.sub(r"(?<=[0-9])(?=Hz|mm)", " ", part) for part in position_text.split("_")
    ]
    text = _KINDS.get(kind) or _WORDS.get(kind, kind)
    return " at ".join([text, *position_words])


def make_natural_sort_key(text: str) -> tuple[tuple[int, str], ...]:
    """Return a key for natural sorting: seal 2 before seal 10."""
    parts = re.split(r"(\d+)", text)
    return tuple((int(part), "") if part.isdecimal() else (-1, part) for part in parts)
