"""Consistent unit systems of solvers, and their numbers with a decimal point."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from types import MappingProxyType
from typing import TypeVar

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ExportError
from dashpot.base.number_format import ascii_only
from dashpot.base.units import parse_unit

_Values = TypeVar("_Values", float, FloatArray)


@dataclass(frozen=True)
class UnitSystem:
    """Consistent unit system.

    Attributes
    ----------
    name : str
        ``"SI"``, ``"mm-t-s"``, ``"mm-kg-ms"`` or ``"in-lbf-s"``.
    words : tuple of str
        Names of the units of length, mass, time, force and stress.
    """

    name: str
    words: tuple[str, str, str, str, str]

    @property
    def length(self) -> float:
        """Size of the unit of length, m."""
        return parse_unit(self.words[0], "length").factor

    @property
    def mass(self) -> float:
        """Size of the unit of mass, kg."""
        return parse_unit(self.words[1], "mass").factor

    @property
    def time(self) -> float:
        """Size of the unit of time, s."""
        return parse_unit(self.words[2], "time").factor

    @property
    def force(self) -> float:
        """Size of the unit of force, N."""
        return self.mass * self.length / self.time**2

    def stiffness(self, si: _Values) -> _Values:
        """N/m in this system."""
        return si * self.length / self.force

    def damping(self, si: _Values) -> _Values:
        """N s/m in this system."""
        return si * self.length / (self.force * self.time)

    def stress(self, si: _Values) -> _Values:
        """Pa in this system."""
        return si * self.length**2 / self.force

    def density(self, si: _Values) -> _Values:
        """kg/m^3 in this system."""
        return si * self.length**3 / self.mass

    def frequency(self, si: _Values) -> _Values:
        """Hz in cycles per unit of time: solvers count frequency in their own unit of time."""
        return si * self.time

    @property
    def frequency_word(self) -> str:
        """Name of the unit of frequency."""
        return "Hz" if self.time == 1 else "kHz"

    @property
    def stiffness_word(self) -> str:
        """Name of the unit of stiffness."""
        return f"{self.words[3]}/{self.words[0]}"

    @property
    def damping_word(self) -> str:
        """Name of the unit of damping."""
        return f"{self.words[3]} {self.words[2]}/{self.words[0]}"


UNIT_SYSTEMS = MappingProxyType(
    {
        "SI": UnitSystem("SI", ("m", "kg", "s", "N", "Pa")),
        "mm-t-s": UnitSystem("mm-t-s", ("mm", "t", "s", "N", "MPa")),
        "mm-kg-ms": UnitSystem("mm-kg-ms", ("mm", "kg", "ms", "kN", "GPa")),
        "in-lbf-s": UnitSystem("in-lbf-s", ("in", "lbf*s^2/in", "s", "lbf", "psi")),
    }
)
"""The unit systems a deck can be written in."""


_UNITS_ASKED = f"add --unit-system, one of {', '.join(UNIT_SYSTEMS)}"
NO_UNITS = f"no unit system is given; {_UNITS_ASKED}"
"""Message if no unit system was chosen, with all other missing choices."""


def unit_system(name: str | None) -> UnitSystem:
    """Return the unit system of a name, or SI until one is chosen.

    Raises
    ------
    ExportError
        If it is unknown.
    """
    if name is None:
        return UNIT_SYSTEMS["SI"]
    systems_by_name = {word.lower(): system for word, system in UNIT_SYSTEMS.items()}
    if name.lower() not in systems_by_name:
        raise ExportError(f"'{name}' is no unit system; {_UNITS_ASKED}")
    return systems_by_name[name.lower()]


def text(value: float) -> str:
    """A number as decks print it: ten digits and always a point, without which it is an integer.

    Raises
    ------
    ExportError
        If it is not finite, which no solver reads.

    >>> text(2e-05), text(196.5), text(3.0)
    ('2.e-05', '196.5', '3.')
    """
    mantissa, exponent, power = f"{_finite(value):.10g}".partition("e")
    return mantissa + ("" if "." in mantissa else ".") + exponent + power


def format_fixed_width(value: float, width: int) -> str:
    """Return a number in at most `width` columns, with as many digits as they hold, always a point.

    >>> format_fixed_width(0.50212766, 10), format_fixed_width(3.68393e-05, 10), format_fixed_width(
    ...     -120.0, 8)
    ('0.50212766', '3.68393E-5', '-120.')
    """
    if _finite(value) == 0:
        return "0."
    for digits in range(min(17, width), 0, -1):
        rounded_text = f"{value:.{digits - 1}E}"
        mantissa, _, power = rounded_text.partition("E")
        fixed_point = f"{value:.{max(digits - 1 - int(power), 0)}f}" if abs(int(power)) < 17 else ""
        for candidate in (
            _ensure_decimal_point(fixed_point),
            re.sub(r"^(-?)0(?=\.)", r"\1", _ensure_decimal_point(fixed_point)),
            f"{_ensure_decimal_point(mantissa)}E{int(power)}",
        ):
            if candidate and len(candidate) <= width and float(candidate) == float(rounded_text):
                return candidate
    raise ExportError(f"{value!r} does not fit into {width} columns")


def format_fields(*values: object) -> str:
    """Return a line of fields of ten columns, as LS-DYNA reads its cards."""
    words = (
        format_fixed_width(value, 9) if isinstance(value, float) else str(value) for value in values
    )
    return "".join(f"{word:>10}" for word in words)


def format_tbdata(values: Sequence[float]) -> list[str]:
    """Return the rows of an Ansys table, six numbers a row."""
    return [
        f"TBDATA,{start + 1}," + ",".join(map(text, values[start : start + 6]))
        for start in range(0, len(values), 6)
    ]


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise ExportError(
            f"a number of the deck is {value} in its units; expected a finite one: look at the "
            "stiffnesses, the relaxation times and --unit-system"
        )
    return value


def _ensure_decimal_point(number: str) -> str:
    """Trailing zeros gone, a decimal point there."""
    if not number:
        return ""
    return number.rstrip("0") if "." in number else number + "."


def convert_to_printable_ascii(line: str) -> str:
    """Printable ASCII: a file name can contain any character, a solver reads only these.

    >>> convert_to_printable_ascii("known to ±1 %, up to 1.2·10⁶ Hz")
    'known to +/-1 %, up to 1.2e6 Hz'
    """
    ascii_text = ascii_only(line.translate(_SPELT))
    return "".join(sign if " " <= sign <= "~" else "?" for sign in ascii_text)


_SPELT = str.maketrans({"±": "+/-", "²": "^2", "°": "deg"})
"""ASCII spelling of the signs in sentences of a verdict, for comments of a deck."""
