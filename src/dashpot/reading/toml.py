"""TOML documents as validated tables: quantities with units, no unknown keys."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

from dashpot.base import dataclass
from dashpot.base.errors import DataError, ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.base.units import Dimension, parse_quantity
from dashpot.reading.raw_file import RawFile, open_raw

# TOML documents.


_DEEP = compile_on_use(r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){64}""")
"""A key of more parts than anyone writes."""


def parsed_toml(content: bytes) -> dict[str, Any]:
    """Return the tables of a TOML document.

    Raises
    ------
    ReadError
        If it is not TOML in UTF-8, or nested too deeply.
    """
    import tomllib  # few need it, and it costs time to import

    try:
        text = content.decode("utf-8-sig")
        if _DEEP.search(text):  # the parser's time grows with the square of their number
            raise RecursionError
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ReadError(f"not TOML in UTF-8: {error}") from None
    except RecursionError:
        raise ReadError("not TOML that a person wrote: it is nested too deeply") from None


# Validated tables.


Vector: TypeAlias = tuple[float, float, float]

_MAX_SIZE = 1 << 24
"""Largest size of a file, bytes."""


def read_tables(path: str | Path) -> tuple[RawFile, dict[str, Any]]:
    """Return a TOML file and its tables.

    Raises
    ------
    ReadError
        If it cannot be read, or is not TOML in UTF-8.
    """
    raw = open_raw(path)
    try:
        return raw, parsed_toml(raw.head(_MAX_SIZE))
    except ReadError as error:
        raise ReadError(f"{path}: {error}") from None


@dataclass(frozen=True)
class Section:
    """Table of a TOML file.

    Attributes
    ----------
    location : str
        How to name it: ``"door.toml, [seal]"``.
    entries : mapping
    known_names : tuple of str
        Allowed keys; any other is refused.
    """

    location: str
    entries: Mapping[str, Any]
    known_names: tuple[str, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.entries, Mapping):
            raise ReadError(
                f"{self.location} is {self.entries!r}; expected a table of keys, such as "
                f"{self.known_names[0]} = ..."
            )
        for name in self.entries:
            if name not in self.known_names:
                names_text = ", ".join(self.known_names)
                raise ReadError(f"{self.location}: '{name}' is unknown; known are {names_text}")

    def __contains__(self, name: str) -> bool:
        return name in self.entries

    def quantity(self, name: str, dimension: Dimension) -> float | None:
        """Return a quantity in SI units, such as ``"25kg"``; None if the key is missing."""
        value = self.entries.get(name)
        return None if value is None else self._quantity(name, value, dimension)

    def quantities(self, name: str, dimension: Dimension) -> tuple[float, ...] | None:
        """Return quantities: ``["5mm", "6mm"]``, or ``"5, 6, 7 mm"`` with one unit for all."""
        value = self.entries.get(name)
        if value is None:
            return None
        if isinstance(value, str):
            *first, last = value.split(",")
            unit = last.lstrip("+-0123456789.eE ")
            value = [text if text.lstrip("+-0123456789.eE ") else text + unit for text in first]
            value.append(last)
        if not isinstance(value, list):
            value = [value]
        return tuple(self._quantity(name, item, dimension) for item in value)

    def direction(self, name: str) -> Vector | None:
        """Return three plain numbers: ``[0, 0, 1]``."""
        value = self.entries.get(name)
        if value is None:
            return None
        is_vector = isinstance(value, list) and len(value) == 3
        if not is_vector or not all(_is_number(item) for item in value) or not any(value):
            raise ReadError(
                f"{self.location}: {name} = {value!r}; expected a direction, three numbers such as "
                "[0, 0, 1]"
            )
        return float(value[0]), float(value[1]), float(value[2])

    def number(self, name: str) -> float | None:
        """Return a plain number."""
        value = self.entries.get(name)
        if value is not None and not _is_number(value):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected a number")
        return None if value is None else float(value)

    def word(self, name: str) -> str | None:
        """Return a text."""
        value = self.entries.get(name)
        if value is not None and not (isinstance(value, str) and value):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected a text")
        return value

    def words(self, name: str) -> tuple[str, ...] | None:
        """Return texts."""
        value = self.entries.get(name)
        if value is not None and not (
            isinstance(value, list) and all(isinstance(item, str) for item in value)
        ):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected a list of texts")
        return None if value is None else tuple(value)

    def flag(self, name: str) -> bool:
        """Return true or false; false if it is not there."""
        value = self.entries.get(name, False)
        if not isinstance(value, bool):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected true or false")
        return value

    def _quantity(self, name: str, value: object, dimension: Dimension) -> float:
        try:
            return parse_quantity(str(value), dimension)
        except DataError as error:
            raise ReadError(f"{self.location}: {name} = {error}") from None


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15
