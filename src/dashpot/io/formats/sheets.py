"""The sheets of a workbook as text, for the child: it needs calamine and no numbers."""

from __future__ import annotations

import datetime as dt
import os
import zipfile
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any, BinaryIO

from dashpot.base.errors import ReadError
from dashpot.io.child import limits
from dashpot.io.formats.hidden import hidden
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw, extra

HIDDEN = "hidden/"
"""What no name of a sheet begins with."""
_LARGEST = 1 << 31
"""Bytes of an unpacked workbook."""
_LEAST = 4
"""Bytes of a workbook that no filled cell is without."""
_BLANK = 1 << 16
"""Cells that may be blank beyond all that could be filled: a lone cell far out makes millions."""


def sheets(raw: Raw, options: ReadOptions) -> dict[str, bytes]:
    """Return the sheet named, or every sheet, as lines of cells between tabs.

    Under :data:`HIDDEN` and the name of a sheet stands what is hidden in it, if anything is.

    Raises
    ------
    ReadError
        If there is no such sheet, or the cells are more than a test needs.
    """
    calamine = extra("python_calamine", "python-calamine", "spreadsheets")
    with raw.open() as stream:
        size = _unpacked(stream)
        unseen = hidden(stream)
        stream.seek(0)
        book = calamine.CalamineWorkbook.from_filelike(stream)
    names = book.sheet_names
    if options.sheet is not None and options.sheet not in names:
        raise ReadError(f"--part sheet={options.sheet}: the sheets are {listed(names)}")
    found, cells = {HIDDEN + name: told.encode() for name, told in unseen.items()}, 0
    for name in names if options.sheet is None else [options.sheet]:
        sheet = book.get_sheet_by_name(name)
        rows, columns = (1 + last for last in sheet.end or (-1, -1))
        cells += rows * columns
        limits.within(cells, "the sheets hold")
        if cells - size // _LEAST > _BLANK:
            raise ReadError(
                f"sheet '{name}' reaches to row {rows} and column {columns}, and hardly any of its "
                "cells is filled: delete what stands far off the test, or export the test as text"
            )
        found[name] = "\n".join(_lines(sheet.to_python(skip_empty_area=False))).encode()
    return found


def _unpacked(stream: BinaryIO) -> int:
    """The bytes of a workbook, unpacked; refuse one that has more than any test needs."""
    if stream.read(2) == b"PK":
        with zipfile.ZipFile(stream) as packed:
            size = sum(entry.file_size for entry in packed.infolist())
        if size > _LARGEST:
            raise ReadError(f"unpacks to {size / 1e9:.1f} GB; export it as text instead")
    else:
        size = stream.seek(0, os.SEEK_END)
    stream.seek(0)
    return size


def _lines(rows: list[list[Any]]) -> Iterator[str]:
    """The rows as text; a date alone among instants is one at midnight."""
    instants = {j for row in rows for j, value in enumerate(row) if type(value) is dt.datetime}
    for row in rows:
        if not any(value != "" for value in row):  # of a far row there are thousands above it
            yield ""
            continue
        yield "\t".join(_cell(value, instant=j in instants) for j, value in enumerate(row))


def _cell(value: Any, *, instant: bool) -> str:
    if instant and type(value) is dt.date:
        value = dt.datetime(value.year, value.month, value.day)
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, float):
        return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    if isinstance(value, dt.timedelta):
        return repr(value.total_seconds())
    if isinstance(value, dt.datetime | dt.date | dt.time):
        return value.isoformat(sep=" ") if isinstance(value, dt.datetime) else value.isoformat()
    return " ".join(str(value).split()).replace('"', "''")  # a quote would open a cell


def listed(names: Iterable[str]) -> str:
    """Name the first sheets.

    >>> listed(["Data", "Info"])
    "'Data', 'Info'"
    """
    return ", ".join(f"'{name}'" for name in islice(names, 8))
