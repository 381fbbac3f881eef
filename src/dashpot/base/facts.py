"""A number that a user sees, stated once: name, value, doubt, unit, words; faces derive theirs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from dashpot.base.numbers import known_between, rounded, symbol
from dashpot.base.units import in_unit, read_in


class Cells(NamedTuple):
    """A fact as a row of a table: texts in the unit that people read."""

    name: str
    value: str
    error: str
    interval: str
    unit: str

    @property
    def with_error(self) -> str:
        """Value and standard error in one cell."""
        if self.error in {"", "held", "not identified"}:
            return ", ".join(filter(None, (self.value, self.error)))
        return f"{self.value} ± {self.error}"


@dataclass(frozen=True)
class Fact:
    """A number that a test shows, and how well it is known.

    Attributes
    ----------
    name : str
        Identifier, the same in every face: ``"k_1"``, ``"tau_1"``.
    value : float
        SI; nan where only the bound `high` is known.
    low, high : float
        95 % interval, SI; nan where none is known, `low` 0 where it is a bound alone.
    unit : str
        Of SI; empty for a plain number.
    error : float or None
        Standard error: 0 of what was held, infinite of what is not identified, None of what was
        given or has an interval alone.
    read : str
        The unit in which people read it; by default as :func:`~dashpot.base.units.read_in`.
    """

    name: str
    value: float
    low: float = math.nan
    high: float = math.nan
    unit: str = ""
    error: float | None = None
    read: str = ""

    @property
    def reading(self) -> str:
        """The unit in which people read it."""
        return self.read or read_in(self.unit)

    @property
    def bounded(self) -> bool:
        """Whether it has an interval."""
        return not (math.isnan(self.low) and math.isnan(self.high))

    @property
    def bound_alone(self) -> bool:
        """Whether all that is known is what it is at most."""
        return self.low == 0 and self.error is None

    @property
    def symbol(self) -> str:
        """Its name as a page prints it."""
        return symbol(self.name)

    def shown(self, value: float) -> float:
        """A value of this fact, SI, in the unit that people read."""
        return in_unit(value, self.reading) if self.reading else value

    @property
    def scale(self) -> float:
        """What a difference of 1 in SI is in the unit that people read."""
        return self.shown(1.0) - self.shown(0.0)

    @property
    def cells(self) -> Cells:
        """The row that every table of it has: to two digits of its error, or of its interval."""
        error = self.error
        if self.bound_alone:
            return Cells(self.name, "", "", f"below {rounded(self.shown(self.high))}", self.reading)
        value, between = self.shown(self.value), ""
        size = math.nan if error is None else error * self.scale
        if self.bounded:
            low, high = self.shown(self.low), self.shown(self.high)
            usual = size if size > 0 and math.isfinite(size) else (high - low) / 4
            between = known_between(value, low, high, usual)
            size = usual if error is None else size
        told = "" if error is None else _error(size)
        return Cells(self.name, rounded(value, size), told, between, self.reading)

    @property
    def says(self) -> str:
        """In words, with its interval."""
        value, error, between, unit = self.cells[1:]
        unit = unit.replace("*", " ")
        if self.bound_alone:
            return f"{self.name} {between} {unit}".rstrip()
        own = f"{self.name} {value}{f' ± {error}' if error else ''} {unit}".rstrip()
        return f"{own}, 95 % {between}" if between else own


def _error(size: float) -> str:
    if math.isinf(size):
        return "not identified"
    return "held" if size <= 0 else rounded(size, size)
