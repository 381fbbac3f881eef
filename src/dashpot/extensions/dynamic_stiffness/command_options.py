"""Options of ``dashpot predict`` for stiffness at a frequency."""

from __future__ import annotations

import re
from itertools import chain
from typing import Any

import click

from dashpot.base.errors import DashpotError, DataError
from dashpot.base.units import parse_quantity
from dashpot.cli._command import CommandOption, opt

_SEPARATOR = re.compile(r"\s*[,;]\s*")
_SINGLE_READINGS = (
    (re.compile(r"\d+,\d+\s*[^\d\s,;.]*"), "."),
    (re.compile(r"\d{1,3}(?:,\d{3})+\s*[^\d\s,;.]*"), ""),
)
"""Lists that may also be one number, and what its commas then stand for."""


def parse_frequencies(text: str) -> tuple[float, ...]:
    """Return the frequencies of a list, Hz; the unit of the last applies to those without one.

    >>> parse_frequencies("1,5,10,44Hz"), parse_frequencies("12.71Hz")
    ((1.0, 5.0, 10.0, 44.0), (12.71,))

    Raises
    ------
    DataError
        If one is no frequency, or a comma may also be a decimal mark or between thousands.
    """
    parts = _SEPARATOR.split(text.strip())
    if len(parts) == 1:
        return (parse_quantity(text, "frequency"),)
    unit = parts[-1].lstrip("+-.eE0123456789").strip()
    words = [part if part[-1:].isalpha() else f"{part}{unit}" for part in parts]
    single_readings = [
        text.strip().replace(",", mark)
        for pattern, mark in _SINGLE_READINGS
        if pattern.fullmatch(text.strip())
    ]
    if single_readings:
        raise DataError(
            f"'{text}' may be one frequency or a list; write {' or '.join(single_readings)}, or a "
            "unit after each, such as 1Hz,5Hz"
        )
    return tuple(parse_quantity(word, "frequency") for word in words)


class FrequencyList(click.ParamType[Any]):
    """One frequency or several with commas between, ``1,5,10Hz``, in Hz."""

    name = "frequency"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the typed frequencies."""
        if not isinstance(value, str):
            return value
        try:
            return parse_frequencies(value)
        except DashpotError as error:
            self.fail(str(error), param, ctx)


def join_lists(_: object, __: object, lists: tuple[tuple[float, ...], ...]) -> tuple[float, ...]:
    """Return the frequencies of a repeated option."""
    return tuple(chain.from_iterable(lists))


def list_options(kinds: str) -> list[CommandOption]:
    """Return the options of stiffness without a mass."""
    return [
        opt(
            "--frequency",
            type=FrequencyList(),
            callback=join_lists,
            multiple=True,
            metavar="FREQUENCY",
            kinds=kinds,
            help="K', K'', loss factor; no mass needed: 1,5,10Hz.",
        )
    ]
