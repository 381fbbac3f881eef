"""Reported values: name, value, uncertainty, unit and text, stated once for all outputs."""

from __future__ import annotations

import math
from typing import NamedTuple, Self

from dashpot.base import dataclass
from dashpot.base.checks import HasChecks
from dashpot.base.lazy import compile_on_use
from dashpot.base.number_format import ascii_only, format_interval, round_to_error, symbol
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import convert_to_unit, get_display_unit

FIXED, UNKNOWN = "held", "not identified"
"""Texts for an error of 0, and for one without limit."""
_WORD = compile_on_use(r"_(?=[a-z]{4})")
NORMAL = 1.96
"""Standard errors to either end of a 95 % interval."""
INTERVAL_LEVELS = (0.025, 0.975)
"""Probabilities at the ends of a 95 % interval of draws."""
AT_MOST = "at most"
"""Text before a one-sided upper limit."""
ASYMMETRY_LIMIT = 0.1
"""Ratio of the shorter to the longer part of an interval up to which it is asymmetric."""
END_AT_VALUE_SHARE = 1e-2
"""Ratio of the two up to which the nearer end counts as the value itself."""


class TableCells(NamedTuple):
    """Row of a table as texts, in display units."""

    name: str
    value: str
    error: str
    interval: str
    unit: str

    @property
    def ascii(self) -> TableCells:
        """Return the row in ASCII, which every terminal has."""
        return TableCells(*map(ascii_only, self))

    @property
    def with_error(self) -> str:
        """Value and standard error in one cell."""
        if self.error in {"", FIXED, UNKNOWN}:
            return ", ".join(filter(None, (self.value, self.error)))
        return f"{self.value} ± {self.error}"

    @property
    def with_limit(self) -> str:
        """Value and standard error, or in place of the error an upper limit, in one cell."""
        if self.interval.startswith(AT_MOST):
            return f"{self.value}, {self.interval}"
        return self.with_error

    @property
    def with_unit(self) -> str:
        """Value, standard error and unit in one cell."""
        return f"{self.with_error} {self.unit}".rstrip()


@dataclass(frozen=True)
class ReportedValue(Serialisable):
    """Value determined by a test, with its uncertainty.

    Attributes
    ----------
    name : str
        Identifier, the same in every face: ``"k_1"``, ``"tau_1"``.
    value : float
        SI; nan where only a bound is known.
    low, high : float
        95 % interval, SI; nan where none is known, `low` 0 where `high` is a bound alone, and nan
        of a value that is at most `high`; `high` infinite where `low` is a bound alone.
    unit : str
        Unit of SI; empty for a plain number.
    error : float or None
        Standard error: 0 of a fixed parameter, infinite if not identified, None of a stated value
        or one that has only an interval.
    read : str
        The unit in which people read it; by default as
        :func:`~dashpot.base.units.get_display_unit`.
    words : str
        How a table calls it; by default its name, in words where it is not a symbol.
    """

    _keys = ("name", "value", "low", "high", "unit")

    name: str
    value: float
    low: float = math.nan
    high: float = math.nan
    unit: str = ""
    error: float | None = None
    read: str = ""
    words: str = ""

    @classmethod
    def from_error(
        cls,
        name: str,
        value: float,
        error: float | None,
        times: float = NORMAL,
        *,
        of_log: bool = False,
        unit: str = "",
        read: str = "",
        words: str = "",
    ) -> Self:
        """Return a value with an interval of so many standard errors; none if the error is inf.

        That of a positive one whose logarithm has the error, ``of_log``, is a factor either way. An
        error of nan or None is unknown.
        """
        if error is None or math.isnan(error) or (of_log and math.isinf(error)):
            return cls(name, value, unit=unit, read=read, words=words)
        half_width = times * error if math.isfinite(error) else math.nan
        if not of_log:
            return cls(
                name, value, value - half_width, value + half_width, unit, error, read, words
            )
        factor = math.exp(min(half_width, 50.0))
        return cls(name, value, value / factor, value * factor, unit, value * error, read, words)

    @property
    def reading(self) -> str:
        """The unit in which people read it."""
        return self.read or get_display_unit(self.unit)

    @property
    def has_interval(self) -> bool:
        """Whether it has an interval."""
        return not (math.isnan(self.low) and math.isnan(self.high))

    @property
    def is_upper_bound(self) -> bool:
        """Whether only an upper limit is known."""
        return self.low == 0 and self.error is None

    @property
    def is_at_most(self) -> bool:
        """Whether the value has no lower limit."""
        return math.isnan(self.low) and not math.isnan(self.high)

    @property
    def is_lower_bound(self) -> bool:
        """Whether only a lower limit is known."""
        return math.isnan(self.value) and self.high == math.inf

    @property
    def label(self) -> str:
        """Label of the value in tables."""
        return self.words or _WORD.sub(" ", self.name)

    @property
    def symbol(self) -> str:
        """Symbol of the value on a page."""
        return symbol(self.label)

    @property
    def word(self) -> str:
        """The unit in which people read it, as it is printed."""
        return "" if self.reading == "1" else self.reading.replace("*", "·").replace("um", "µm")

    def to_display_unit(self, value: float) -> float:
        """Return a value of this fact, SI, in the unit that people read."""
        return value if self.reading == self.unit else convert_to_unit(value, self.reading)

    @property
    def scale(self) -> float:
        """Size of an SI difference of 1 in the display unit."""
        return self.to_display_unit(1.0) - self.to_display_unit(0.0)

    @property
    def size(self) -> float:
        """Standard error in the display unit; else a quarter of the interval.

        Of a value that is at most so much half of what lies between, and a thousandth at least.
        """
        if self.error is not None:
            return self.error * self.scale
        if self.is_at_most:
            return max((self.high - self.value) / 2, 1e-3 * self.high) * self.scale
        return (self.high - self.low) / 4 * self.scale

    @property
    def cells(self) -> TableCells:
        """The row that every table of it has: to two digits of its error, or of its interval."""
        value, low, high = map(self.to_display_unit, (self.value, self.low, self.high))
        if self.is_upper_bound:
            return TableCells(self.label, "", "", f"below {round_to_error(high)}", self.word)
        if self.is_lower_bound:
            return TableCells(self.label, "", "", f"at least {round_to_error(low)}", self.word)
        if self.is_at_most:
            text, high_text = round_to_error(value, self.size), round_to_error(high, self.size)
            return TableCells(self.label, text, "", f"{AT_MOST} {high_text}", self.word)
        error = "" if self.error is None else _error(self.size)
        interval_text = ""
        if self.has_interval and error not in (FIXED, UNKNOWN):
            interval_text = format_interval(value, low, high, self.size)
        text = round_to_error(value, self.size, digits=4)
        return TableCells(self.label, text, error, interval_text, self.word)

    @property
    def cell_texts(self) -> tuple[str, str, str]:
        """Value and both ends of the interval, each in a cell, to two digits of half of it."""
        value, low, high = map(self.to_display_unit, (self.value, self.low, self.high))
        if self.is_lower_bound:
            return "unknown", round_to_error(low), "no limit"
        error_below, error_above = value - low, high - value
        smaller_error, larger_error = sorted((error_below, error_above))
        if math.isfinite(larger_error) and smaller_error <= END_AT_VALUE_SHARE * larger_error:
            # an end that is the value itself says nothing of its digits
            return round_to_error(value), round_to_error(low), round_to_error(high)
        # of a lopsided interval each end has the digits of its own distance
        if min(error_below, error_above) > ASYMMETRY_LIMIT * max(error_below, error_above):
            error_below = error_above = (high - low) / 2
        else:
            error_below, error_above = error_below or error_above, error_above or error_below
        reference = min(filter(math.isfinite, (error_below, error_above)), default=None)
        return (
            round_to_error(value, reference),
            round_to_error(low, error_below) if math.isfinite(low) else "unknown",
            round_to_error(high, error_above) if math.isfinite(high) else "no limit",
        )

    @property
    def text(self) -> str:
        """Value as text, with its interval."""
        cells = self.cells
        if self.is_upper_bound or self.is_lower_bound:
            return f"{self.label} {cells.interval} {cells.unit}".rstrip()
        if self.is_at_most:
            return f"{self.label} {cells.with_unit}, {cells.interval}"
        name = f"{self.label} {cells.with_unit}"
        return f"{name}, 95 % {cells.interval}" if cells.interval else name


class HasReportedValues(HasChecks):
    """Result of named numbers, `reported_values`, with checks."""

    reported_values: tuple[ReportedValue, ...]

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """The numbers that it shows."""
        return self.reported_values

    def __getitem__(self, name: str) -> ReportedValue:
        """Return a reported value by its name."""
        return next(
            reported_value for reported_value in self.reported_values if reported_value.name == name
        )


def _error(size: float) -> str:
    if math.isinf(size):
        return UNKNOWN
    return FIXED if size <= 0 else round_to_error(size, size)
