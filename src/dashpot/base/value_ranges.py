"""Ranges of single values: valid ranges, and plausible ranges in tests of seals."""

from __future__ import annotations

import math
from functools import cache
from numbers import Real
from types import MappingProxyType
from typing import Any, NamedTuple

from dashpot.base.errors import DataError

# Ranges of single numbers; need no NumPy, as ``--help`` does not.


def require_positive(
    owner: str = "",
    /,
    *,
    unit: str = "",
    expected: str = "a number > 0",
    optional: bool = False,
    **values: float | None,
) -> None:
    """Refuse the first of the named numbers that is not finite and > 0.

    Parameters
    ----------
    owner : str
        Text before the name.
    unit : str
        Text after the number.
    expected : str
        The expected value, as text.
    optional : bool
        None is passed over.
    values : float

    >>> require_positive("axis ", rate=0.0, unit=" Hz")
    Traceback (most recent call last):
    dashpot.base.errors.DataError: axis rate = 0.0 Hz; expected a number > 0
    """
    for name, value in values.items():
        given_value: Any = value
        is_number = isinstance(given_value, Real)
        if not (optional and given_value is None) and not (
            is_number and math.isfinite(given_value) and given_value > 0
        ):
            raise DataError(f"{owner}{name} = {given_value!r}{unit}; expected {expected}")


def require_nonnegative(
    owner: str = "", /, *, expected: str = "a number >= 0", **values: Any
) -> None:
    """Refuse the first number that is not finite and >= 0, as :func:`require_positive` does."""
    require_positive(
        owner, expected=expected, **{name: value for name, value in values.items() if value != 0}
    )


def select_fields(result: object, *names: str) -> dict[str, Any]:
    """Return some of the fields of a record by name."""
    return {name: getattr(result, name) for name in names}


# Sizes that tests of seals have: one table of what is doubted, and of what no one means.
#
# A soft range holds nearly every test. What lies outside is a note where a unit was said, for large
# and small ones do exist. Outside a hard range no test of rubber lies: whoever said it is asked
# again, in a file, an option or an array alike, and where a result would imply it. Needs no NumPy.


Span = tuple[float, float]


class PlausibleRange(NamedTuple):
    """Plausible range of one kind of quantity, in SI.

    Attributes
    ----------
    description : str
        As a sentence calls it.
    unit : str
    soft, hard : (float, float)
        Nearly every test lies in the one, every test in the other.
    """

    description: str
    unit: str
    soft: Span
    hard: Span

    def absurd(self, size: float) -> bool:
        """Whether a value is impossible; not for nan and 0, which other checks refuse."""
        low, high = self.hard
        return not (size == 0 or low <= abs(size) <= high or math.isnan(size))

    def unusual(self, size: float) -> bool:
        """Return whether hardly any test has it."""
        low, high = self.soft
        return not (size == 0 or low <= abs(size) <= high or math.isnan(size))

    def refuse(self, size: float, text: str = "", *, remedy: str = "Check its unit.") -> None:
        """Refuse a size that no test has.

        Parameters
        ----------
        size : float
            SI.
        text : str
            The beginning of the sentence; by default what the quantity is, and the size.
        remedy : str
            Its end.

        Raises
        ------
        DataError

        >>> SIZES["mass"].refuse(0.104)
        >>> SIZES["mass"].refuse(5000.0)
        Traceback (most recent call last):
        dashpot.base.errors.DataError: the mass is 5 t; expected 1 ug to 1 t. Check its unit.
        """
        if self.absurd(size):
            low, high = (format_quantity_short(value, self.unit) for value in self.hard)
            subject = text or f"{self.description} is {format_quantity_short(size, self.unit)}"
            raise DataError(f"{subject}; expected {low} to {high}. {remedy}")


SIZES = MappingProxyType(
    {
        "travel": PlausibleRange("the travel", "m", (2e-5, 0.2), (1e-9, 0.5)),
        "force": PlausibleRange("the force", "N", (1e-2, 1e3), (1e-13, 2e5)),
        "stiffness": PlausibleRange("the stiffness", "N/m", (10.0, 1e7), (0.05, 1e9)),
        "ramp": PlausibleRange("the time of the ramp", "s", (1e-3, 200.0), (1e-4, 900.0)),
        "record": PlausibleRange("the length of the record", "s", (0.1, 1e6), (1e-3, 3e7)),
        "amplitude": PlausibleRange("the amplitude", "m", (1e-9, 5e-3), (1e-12, 0.2)),
        "modulus": PlausibleRange("the modulus", "Pa", (1e3, 1e9), (10.0, 2e9)),
        "contact pressure": PlausibleRange("the mean pressure", "Pa", (0.0, 5e7), (0.0, 2e8)),
        "radius": PlausibleRange("the radius", "m", (1e-7, 0.1), (1e-9, 1.0)),
        "part": PlausibleRange("the length of the part", "m", (1e-3, 3.0), (1e-4, 30.0)),
        "delay": PlausibleRange("the delay", "s", (1e-6, 0.1), (0.0, 10.0)),
        "door": PlausibleRange("the largest length of the door", "m", (0.1, 3.0), (0.02, 30.0)),
        "seal length": PlausibleRange("the length of the seal", "m", (1e-3, 1.0), (1e-4, 5.0)),
        "seal height": PlausibleRange("the height of the seal", "m", (1e-3, 0.1), (1e-4, 0.5)),
        "shear": PlausibleRange(
            "stiffness sideways over that where it is pressed", "", (0.0, 1.5), (0.0, 3.0)
        ),
        "sag": PlausibleRange("the sag under the mass", "m", (0.0, 0.02), (0.0, 0.2)),
        "resonance": PlausibleRange("the resonance", "Hz", (1.0, 2e3), (0.2, 2e4)),
        "acceleration": PlausibleRange("the acceleration", "m/s^2", (1e-3, 1e4), (0.0, 1e7)),
        "mass": PlausibleRange("the mass", "kg", (1e-3, 200.0), (1e-9, 1e3)),
        "density": PlausibleRange("the density", "kg/m^3", (50.0, 3e3), (5.0, 2e4)),
    }
)
"""By the kind of quantity. The hard ranges are our choice, and hold every public record that we
read: forces to 40 kN, ramps of 315 s, travels of 401 mm, holds of a day, creep of 1000 h."""


def refuse_absurd_record(result: Any) -> None:
    """Refuse a record of force over displacement that no one means; its time may be None.

    Raises
    ------
    DataError
    """
    remedy = 'Check the unit: units="s, mm, N" in Python, --units {} in a shell.'
    largest = float(abs(result.force).max())
    SIZES["force"].refuse(largest, remedy=remedy.format("force=N"))
    for name, size, unit in (("displacement", "travel", "mm"), ("time", "record", "s")):
        values = getattr(result, name)
        if values is not None:
            span = float(values.max() - values.min())
            SIZES[size].refuse(span, remedy=remedy.format(f"{name}={unit}"))


_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"))
_NAMED_RANGES = {
    "kg": ((1e3, "t"), (1.0, "kg"), (1e-3, "g"), (1e-6, "mg"), (1e-9, "ug")),
    "s": ((86400.0, "days"), (3600.0, "h"), (1.0, "s"), (1e-3, "ms"), (1e-6, "us")),
}  # fmt: skip
_UNPREFIXED_UNITS = frozenset({"m/s^2", "kg/m^3"})


def format_quantity_short(value: float, unit: str) -> str:
    """Return an SI size as people say it.

    >>> format_quantity_short(2100.0, "N"), format_quantity_short(0.041,
    ...     "s"), format_quantity_short(0.104, "kg"), format_quantity_short(259200.0, "s")
    ('2.1 kN', '41 ms', '104 g', '3 days')
    """
    steps = _NAMED_RANGES.get(unit, () if unit in _UNPREFIXED_UNITS else _build_prefix_steps(unit))
    for factor, word in steps:
        if abs(value) >= factor * (1 - 1e-12):
            return f"{value / factor:.3g} {word}"
    return f"{value:.3g} {unit}"


@cache
def _build_prefix_steps(unit: str) -> tuple[tuple[float, str], ...]:
    # metres above 1 are said in metres
    return tuple((by, f"{word}{unit}") for by, word in _PREFIXES if by <= 1 or unit != "m")
