"""Sheets of a workbook as text, read in the child process with calamine alone."""

from __future__ import annotations

import datetime as dt
import os
import re
import zipfile
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any, BinaryIO

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.hidden_cells import list_hidden_cells
from dashpot.extensions.formats.unread import refuse_archive
from dashpot.extensions.formats.workbook_formulas import scan_formulas
from dashpot.reading.raw_file import RawFile, import_extra
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits

HIDDEN = "hidden/"
FORMULAS = "formulas/"
"""Prefix of a path that no sheet name has."""
_MAX_SIZE = 1 << 31
"""Bytes of an unpacked workbook."""
_MIN_CELL_BYTES = 4
"""Smallest size of a filled cell in a workbook, bytes."""
_FIRST_YEARS = {1899, 1900, 1904}
"""The years in which the calendars of spreadsheets begin: who counts time by them means no date."""
_ZERO = dt.datetime(1899, 12, 31)
_DAY = dt.timedelta(days=1)
_REPEATED_DAY = dt.timedelta(days=59)
"""The count of the day that calamine returns twice."""
_MAX_HOURS = 10_000
_DURATION = re.compile(r"\APT(?:(\d{1,9})H)?(?:(\d{1,9})M)?(?:(\d{1,9}(?:[.,]\d{1,12})?)S)?\Z")
"""A length of time by ISO 8601, as OpenDocument writes it."""
_BLANK = 1 << 16
"""Cells that may be blank beyond all that could be filled: a lone cell far out makes millions."""


def sheets(raw: RawFile, options: ReadOptions) -> dict[str, bytes]:
    """Return the sheet named, or every sheet, as lines of cells between tabs.

    Under :data:`HIDDEN` and the name of a sheet stands what is hidden in it, if anything is; under
    :data:`FORMULAS` the questions about its formulas and errors.

    Raises
    ------
    ReadError
        If there is no such sheet, or the cells are more than a test needs.
    """
    calamine = import_extra("python_calamine", "python-calamine", "spreadsheets")
    with raw.open() as stream:
        size = _get_unpacked_size(stream)
        hidden_cells = list_hidden_cells(stream)
        formulas = scan_formulas(stream)
        stream.seek(0)
        workbook = calamine.CalamineWorkbook.from_filelike(stream)
    names = workbook.sheet_names
    if options.sheet is not None and options.sheet not in names:
        raise ReadError(
            f"--file-part sheet={options.sheet}: the sheets are {format_sheet_names(names)}"
        )
    entries = {HIDDEN + name: text.encode() for name, text in hidden_cells.items()}
    entries |= {FORMULAS + name: "\n".join(notes).encode() for name, notes in formulas.items()}
    cells = 0
    for name in names if options.sheet is None else [options.sheet]:
        sheet = workbook.get_sheet_by_name(name)
        rows, columns = (1 + last for last in sheet.end or (-1, -1))
        cells += rows * columns
        limits.check_value_count(cells, "the sheets hold")
        if cells - size // _MIN_CELL_BYTES > _BLANK:
            raise ReadError(
                f"sheet '{name}' reaches to row {rows} and column {columns}, and hardly any of its "
                "cells is filled: delete what stands far off the test, or export the test as text"
            )
        entries[name] = "\n".join(_lines(sheet.to_python(skip_empty_area=False))).encode()
    return entries


def _get_unpacked_size(stream: BinaryIO) -> int:
    """Return the bytes of a workbook, unpacked; refuse one that has more than any test needs."""
    if stream.read(2) == b"PK":
        with zipfile.ZipFile(stream) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            names = archive.namelist()
        if not any(name == "content.xml" or name.startswith("xl/") for name in names):
            refuse_archive(names)
        if size > _MAX_SIZE:
            raise ReadError(f"unpacks to {size / 1e9:.1f} GB; export it as text instead")
    else:
        size = stream.seek(0, os.SEEK_END)
    stream.seek(0)
    return size


def _lines(rows: list[list[Any]]) -> Iterator[str]:
    """The rows as text; a date alone among instants is one at midnight.

    Times of the day and dates of the year in which a spreadsheet's calendar begins, in one column,
    are one count of days: a clock that went on past 24 hours.
    """
    instants = {j for row in rows for j, value in enumerate(row) if type(value) is dt.datetime}
    clocks = {j: _DayCount() for j in _columns_of_days(rows)}
    for row in rows:
        if not any(value != "" for value in row):  # of a far row there are thousands above it
            yield ""
            continue
        yield "\t".join(
            _cell(clocks[j].since(value) if j in clocks else value, instant=j in instants)
            for j, value in enumerate(row)
        )


def _columns_of_days(rows: list[list[Any]]) -> set[int]:
    """Return the columns of day counts, in which calamine takes some cells for dates."""
    kinds: dict[int, set[str]] = {}
    for row in rows:
        for j, value in enumerate(row):
            if isinstance(value, dt.time | dt.date):
                is_day_count = isinstance(value, dt.time) or value.year in _FIRST_YEARS
                name = "time" if isinstance(value, dt.time) else "day" if is_day_count else "date"
                kinds.setdefault(j, set()).add(name)
    return {j for j, kind in kinds.items() if kind == {"time", "day"}}


class _DayCount:
    """One column that counts days by the dates of a calendar's first year, row by row.

    Excel has a 29th of February 1900, its day 60. Its count is one more from March on, and
    calamine returns that day as the 28th a second time: it is that if the clock would run
    backwards, or its step would change more, otherwise.
    """

    def __init__(self) -> None:
        self._last_time: dt.timedelta | None = None
        self._time_step = dt.timedelta(0)

    def since(self, value: Any) -> Any:
        """Return a date or a time of the day as the time since the zero of the count."""
        if isinstance(value, dt.time):
            return self._register_time(value, dt.datetime.combine(_ZERO, value) - _ZERO)
        if not isinstance(value, dt.date):
            return value
        at = (
            value
            if isinstance(value, dt.datetime)
            else dt.datetime(value.year, value.month, value.day)
        )
        if at.year == 1904:
            return at - dt.datetime(1904, 1, 1)
        count = at - _ZERO
        if at >= dt.datetime(1900, 3, 1) or (count >= _REPEATED_DAY and self._is_second(count)):
            count += _DAY
        return self._register_time(count, count)

    def _is_second(self, count: dt.timedelta) -> bool:
        if self._last_time is None:
            return False
        step = count - self._last_time
        return step < dt.timedelta(0) or abs(step + _DAY - self._time_step) < abs(
            step - self._time_step
        )

    def _register_time(self, cell: Any, count: dt.timedelta) -> Any:
        if self._last_time is not None:
            self._time_step = count - self._last_time
        self._last_time = count
        return cell


def _cell(value: Any, *, instant: bool) -> str:
    if instant and type(value) is dt.date:
        value = dt.datetime(value.year, value.month, value.day)
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, float):
        return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    if isinstance(value, dt.timedelta):
        return _clock(value.total_seconds())
    if isinstance(value, dt.datetime | dt.date | dt.time):
        return value.isoformat(sep=" ") if isinstance(value, dt.datetime) else value.isoformat()
    text = " ".join(str(value).split())
    duration = _DURATION.match(text) if text[:2] == "PT" else None
    if duration and text != "PT":
        hours, minutes, seconds = (
            float((group or "0").replace(",", ".")) for group in duration.groups()
        )
        return _clock(3600 * hours + 60 * minutes + seconds)
    return text.replace('"', "''")  # a quote would open a cell


def _clock(seconds: float) -> str:
    """A length of time as a clock shows it, hours beyond 24 counted on; seconds if it cannot."""
    micro = round(1e6 * seconds)
    if not 0 <= micro < _MAX_HOURS * 3_600_000_000:
        return repr(seconds)
    whole_seconds, part = divmod(micro, 1_000_000)
    clock = f"{whole_seconds // 3600:02d}:{whole_seconds // 60 % 60:02d}:{whole_seconds % 60:02d}"
    return f"{clock}.{part:06d}" if part else clock


def format_sheet_names(names: Iterable[str]) -> str:
    """Name the first sheets.

    >>> format_sheet_names(["Data", "Info"])
    "'Data', 'Info'"
    """
    return ", ".join(f"'{name}'" for name in islice(names, 8))
