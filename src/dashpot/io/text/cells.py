"""What one cell of a text table is: a number, a clock time, a missing value or a word."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from typing import Literal, TypeAlias

Mark: TypeAlias = Literal[".", ",", ".,"]
"""Decimal mark; ``".,"`` is a file that uses both, one per cell."""

_EXPONENT = r"(?:[eEdD][+-]?\d{1,4})?\Z"
_PLAIN = {
    ".": re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)" + _EXPONENT),
    ",": re.compile(r"[+-]?(?:\d+(?:,\d+)?|,\d+)" + _EXPONENT),
    ".,": re.compile(r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)" + _EXPONENT),
}
_GROUPED = {
    ".": re.compile(r"[+-]?[1-9]\d{0,2}(?:[,' \u00a0\u202f]\d{3})+(?:\.\d*)?\Z"),
    ",": re.compile(r"[+-]?[1-9]\d{0,2}(?:[.' \u00a0\u202f]\d{3})+(?:,\d*)?\Z"),
}
EITHER_WAY = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}\Z")
"""``1,234``: a thousand or one and a bit."""

MISSING = re.compile(
    r"(?:nan|n\.?/?a\.?|na|null|nil|none|-+|\.+|_+|\*+|\?+|#.*|[<>]+|—|–|[+-]?inf(?:inity)?"
    r"|[+-]?(?:over|under)\w*|[+-]?ov[rfl]\w*|[+-]?ol|sat\w*|[+-]?1[.,]#\w+|nv|err\w*|invalid|bad)\Z",
    re.IGNORECASE,
)
_CLOCK = re.compile(
    r"(?:(\d{4}-\d\d?-\d\d?|\d\d?[./]\d\d?[./]\d{4}|\d{4}[./]\d\d?[./]\d\d?)[ T_]\s*)?"
    r"(\d{1,4}):(\d\d)(?::(\d\d)([.,]\d+)?)?Z?\Z"
)
_BLANKS = re.compile(r"\"([^\"]*)\"|(\S+)")


def number(cell: str, mark: Mark) -> float | None:
    """Return the number in a cell, or None."""
    if _PLAIN[mark].match(cell):
        return float(cell.replace(",", ".").replace("d", "e").replace("D", "e"))
    grouped = _GROUPED.get(mark)
    if grouped is not None and grouped.match(cell):
        whole, _, part = cell.partition("." if mark == "." else ",")
        return float(re.sub(r"[^\d+-]", "", whole) + "." + part)
    return None


def is_missing(cell: str) -> bool:
    """Whether a cell is blank or a word for "no value", such as NaN, n/a, OVER or ----."""
    return not cell or MISSING.match(cell) is not None


def clock(cell: str) -> float | None:
    """Return seconds for ``09:18:09.717`` (since midnight) or a date with it (since 1970)."""
    match = _CLOCK.match(cell)
    if match is None:
        return None
    date, hours, minutes, seconds, part = match.groups()
    total = 60.0 * (60 * int(hours) + int(minutes)) + int(seconds or 0)
    total += float(part.replace(",", ".")) if part else 0.0
    return total + 86400.0 * _day(date) if date else total


def _day(date: str) -> int:
    from datetime import date as day  # rare, and costs time to import

    numbers = [int(part) for part in re.split(r"[-./]", date)]
    year_first = numbers[0] > 31
    order = numbers if year_first else numbers[::-1]
    try:
        return (day(*order) - day(1970, 1, 1)).days
    except ValueError:  # month and day the other way round
        try:
            return (day(order[0], order[2], order[1]) - day(1970, 1, 1)).days
        except ValueError:
            return 0


def split(line: str, delimiter: str, *, trim: bool = True) -> list[str]:
    """Return the cells of a line, without trailing blank cells if `trim`.

    A delimiter of one blank stands for any run of blanks; a longer one holds the column
    breaks of a fixed-width table, as ``"fixed:9,18"``.
    """
    if delimiter == " ":
        if '"' not in line:
            return line.split()
        return [quoted or plain for quoted, plain in _BLANKS.findall(line)]
    if delimiter.startswith("fixed:"):
        breaks = [0, *map(int, delimiter[6:].split(",")), None]
        pairs = itertools.pairwise(breaks)
        cells = [line[a:b].strip() for a, b in pairs]
    elif '"' in line:
        cells = _quoted(line, delimiter)
    else:
        cells = [cell.strip() for cell in line.split(delimiter)]
    while trim and cells and not cells[-1]:
        cells.pop()
    return cells


def _quoted(line: str, delimiter: str) -> list[str]:
    import csv

    try:
        rows = list(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error:
        rows = [line.split(delimiter)]
    return [cell.strip().strip('"').strip() for cell in rows[0]] if rows else []


def numeric(cells: Sequence[str], mark: Mark) -> list[bool]:
    """Which cells hold a number."""
    return [number(cell, mark) is not None for cell in cells]
