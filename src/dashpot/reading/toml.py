"""TOML documents as validated tables: quantities with units, no unknown keys."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

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

    def number(self, name: str) -> float | None:
        """Return a plain number."""
        value = self.entries.get(name)
        if value is not None and not is_plain_number(value):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected a number")
        return None if value is None else float(value)

    def word(self, name: str) -> str | None:
        """Return a text."""
        value = self.entries.get(name)
        if value is not None and not (isinstance(value, str) and value):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected a text")
        return value

    def _quantity(self, name: str, value: object, dimension: Dimension) -> float:
        try:
            return parse_quantity(str(value), dimension)
        except DataError as error:
            raise ReadError(f"{self.location}: {name} = {error}") from None


def is_plain_number(value: object) -> bool:
    """Return whether a value is a number without a unit that is not huge."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15
