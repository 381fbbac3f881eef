"""What one cell of a text table is: a number, a missing value or a word."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from typing import Literal, TypeAlias

from dashpot.reading.columns.header_names import remove_quotes

Mark: TypeAlias = Literal[".", ",", ".,"]
"""Decimal mark; ``".,"`` is a file that uses both, one per cell."""

_WRITTEN: dict[Mark, str] = {
    ".": r"[+-]?(?:\d++\.?\d*+|\.\d++)",
    ",": r"[+-]?(?:\d++(?:,\d++)?|,\d++)",
    ".,": r"[+-]?(?:\d++[.,]?\d*+|[.,]\d++)",
}
_EXPONENT = r"(?:[eEdD][+-]?\d{1,4})?"
_PLAIN = {mark: re.compile(rf"\A{name}{_EXPONENT}\Z") for mark, name in _WRITTEN.items()}
_ALL_PLAIN = {
    mark: re.compile(rf"\A(?:{name}{_EXPONENT}\n)++\Z") for mark, name in _WRITTEN.items()
}
# a group that gives nothing back (`)++`) is lost in Python 3.11.2 from the second match on
GROUPS: dict[Mark, str] = {
    ".": r"(?:[,'\u2019 \u00a0\u2009\u202f]\d{3})+",
    ",": r"(?:[.'\u2019 \u00a0\u2009\u202f]\d{3})+",
}
"""The thousands behind the first digits of a number, by its decimal mark."""
_GROUPED = {
    mark: re.compile(rf"\A[+-]?[1-9]\d{{0,2}}{groups}(?:{re.escape(mark)}\d*+)?\Z")
    for mark, groups in GROUPS.items()
}
EITHER_WAY = re.compile(r"\A[+-]?[1-9]\d{0,2}([.,])\d{3}\Z")
"""``1,234``: a thousand or one and a bit."""

MISSING = re.compile(
    r"\A(?:nan|n\.?/?a\.?|na|null|nil|none|-+|\.+|_+|\*+|\?+|#.*|[<>]+|—|–|[+-]?inf(?:inity)?"
    r"|[+-]?(?:over|under)\w*|[+-]?ov[rfl]\w*|[+-]?ol|sat\w*|[+-]?1[.,]#\w+|nv|err\w*|invalid|bad)\Z",
    re.IGNORECASE,
)
_BEGINS = frozenset("0123456789+-.,")
_BLANKS = re.compile(r"\"([^\"]*)\"|(\S+)")


def number(cell: str, mark: Mark) -> float | None:
    """Return the number in a cell, or None."""
    if _PLAIN[mark].match(cell):
        return float(cell.replace(",", ".").replace("d", "e").replace("D", "e"))
    if _is_grouped(cell, mark):
        whole, _, part = cell.partition("." if mark == "." else ",")
        return float(re.sub(r"[^\d+-]", "", whole) + "." + part)
    return None


def is_number(cell: str, mark: Mark) -> bool:
    """Whether :func:`number` finds one in a cell."""
    if cell[:1] not in _BEGINS and cell[:1].isascii():  # most cells that are none, soon
        return False
    return _PLAIN[mark].match(cell) is not None or _is_grouped(cell, mark)


def _is_grouped(cell: str, mark: Mark) -> bool:
    grouped = _GROUPED.get(mark)
    return grouped is not None and grouped.match(cell) is not None


def is_missing(cell: str) -> bool:
    """Whether a cell is blank or a word for "no value", such as NaN, n/a, OVER or ----."""
    return not cell or MISSING.match(cell) is not None


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
        cells = _split_fixed_width(line, [int(place) for place in delimiter[6:].split(",")])
    elif '"' in line:
        cells = _split_quoted_cells(line, delimiter)
    else:
        cells = [cell.strip() for cell in line.split(delimiter)]
    return drop_trailing_blanks(cells) if trim else cells


def drop_trailing_blanks(cells: list[str]) -> list[str]:
    """Return the cells, without blank ones at the end any more."""
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _split_fixed_width(line: str, breaks: Sequence[int]) -> list[str]:
    """The cells between the breaks; by blanks, so too many or few, if a word crosses one."""
    if any(len(line[place - 1 : place + 1].strip()) == 2 for place in breaks):
        return line.split()
    return [line[a:b].strip() for a, b in itertools.pairwise([0, *breaks, None])]


def split_by_alignment(line: str, like: str) -> list[str]:
    """Return the cells of a line under those of a full row `like` it, blank where one is missing.

    Returns no cells unless each stands under one cell of the row, the last under its last: only
    then do the gaps tell which is missing.
    """
    places = [match.span() for match in re.finditer(r"\S+", like)]
    cells = [""] * len(places)
    last = -1
    for match in re.finditer(r"\S+", line):
        under = [i for i, (a, b) in enumerate(places) if match.start() < b and a < match.end()]
        if len(under) != 1 or under[0] <= last:
            return []
        last = under[0]
        cells[last] = match[0]
    return cells if last == len(places) - 1 else []


def _split_quoted_cells(line: str, delimiter: str) -> list[str]:
    import csv

    try:
        rows = list(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error:
        rows = [line.split(delimiter)]
    return [remove_quotes(cell) for cell in rows[0]] if rows else []


def numeric(cells: Sequence[str], mark: Mark) -> list[bool]:
    """Which cells hold a number."""
    if are_plain(cells, mark):
        return [True] * len(cells)
    return [is_number(cell, mark) for cell in cells]


def are_plain(cells: Sequence[str], mark: Mark) -> bool:
    """Whether there are cells, and each is a number without marks of thousands: one look at all."""
    return _ALL_PLAIN[mark].match("\n".join([*cells, ""])) is not None
