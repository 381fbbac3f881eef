"""Acceptance limits of the quantities of a lot."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dashpot.base import dataclass
from dashpot.base.errors import DashpotError, DataError, ReadError
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import parse_quantity
from dashpot.extensions.batch.quantities import Quantity, quantity
from dashpot.reading.toml import Section, tables_of

_KNOWN = ("lower", "upper", "cpk")


@dataclass(frozen=True)
class Limits(Serialisable):
    """Acceptance limits of one quantity.

    Attributes
    ----------
    quantity : Quantity
    lower, upper : float or None
        SI.
    cpk : float or None
        The least that is asked.
    """

    _keys = ("lower", "upper", "cpk")

    quantity: Quantity
    lower: float | None = None
    upper: float | None = None
    cpk: float | None = None

    @property
    def ends(self) -> tuple[float, ...]:
        """The limits that there are."""
        return tuple(end for end in (self.lower, self.upper) if end is not None)

    def is_within(self, value: float, guard: float = 0.0) -> bool:
        """Return whether a value keeps to both limits, by so much."""
        low = -math.inf if self.lower is None else self.lower
        high = math.inf if self.upper is None else self.upper
        return low + guard <= value <= high - guard

    @property
    def distance(self) -> float | None:
        """From the lower limit to the upper one; None where one is missing."""
        return None if self.lower is None or self.upper is None else self.upper - self.lower

    def __str__(self) -> str:
        ends = [
            f"{word} {self.quantity.read(end)}"
            for word, end in (("at least", self.lower), ("at most", self.upper))
            if end is not None
        ]
        return " and ".join(ends)


def read_limits(path: str | Path, columns: Sequence[str]) -> tuple[Limits, ...]:
    """Return the limits that a TOML states, each a table named as a quantity of the columns.

    Raises
    ------
    ReadError
        If the file is no such TOML, or names what no column is.
    """
    _, tables = tables_of(path)
    if not tables:
        raise ReadError(f'{path}: no limit is in it; expected such as [k_end] lower = "0.18N/mm"')
    limits = []
    for name, table in tables.items():
        section = Section(f"{path}, [{name}]", table, _KNOWN)
        try:
            limits.append(_parse_limits(name, section.entries, columns))
        except (DashpotError, TypeError, ValueError) as error:
            raise ReadError(f"{section.where}: {error}") from None
    column, times = Counter(limit.quantity.column for limit in limits).most_common(1)[0]
    if times > 1:
        raise ReadError(f"{path}: limits of {column} stand there twice, by two names; keep one")
    return tuple(limits)


def _parse_limits(name: str, table: Mapping[str, Any], columns: Sequence[str]) -> Limits:
    new_quantity = quantity(name, columns)
    lower, upper = (_number(table.get(text), new_quantity) for text in ("lower", "upper"))
    cpk = float(table["cpk"]) if "cpk" in table else None
    made = Limits(new_quantity, lower, upper, cpk)
    if not made.ends:
        raise DataError("it has no limit; give lower, upper, or both")
    if [*made.ends] != sorted(set(made.ends)):
        raise DataError("lower is not below upper; exchange them")
    if cpk is not None and not cpk > 0:
        raise DataError(f"cpk = {cpk:g}; expected a number > 0, such as 1.33")
    return made


def _number(value: object, of: Quantity) -> float | None:
    if value is None:
        return None
    if of.dimension is not None:
        return parse_quantity(str(value), of.dimension)
    number = float(str(value))
    if not math.isfinite(number):
        raise ValueError(f"{value} is no limit; expected a finite number")
    return number
