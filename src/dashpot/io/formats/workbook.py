"""Spreadsheets (xls, xlsx, xlsb, ods) through calamine: each sheet is read as the text it shows."""

from __future__ import annotations

import datetime as dt
import zipfile
from contextlib import suppress
from dataclasses import replace
from typing import Any, BinaryIO

from dashpot.base.errors import ReadError
from dashpot.io.columns.kinds import kind_of
from dashpot.io.formats import text
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw, extra
from dashpot.io.table import Table

_NO_TEST = {"unclear", "not-a-test"}
_LARGEST = 1 << 31
"""Bytes of an unpacked workbook."""


def read(raw: Raw, options: ReadOptions) -> Table:
    """Return the table of the one sheet that holds a test, or of the sheet named.

    Raises
    ------
    ReadError
        If no sheet or several sheets could be meant.
    """
    calamine = extra("python_calamine", "python-calamine", "spreadsheets")
    with raw.open() as stream:
        _refuse_bomb(stream)
        book = calamine.CalamineWorkbook.from_filelike(stream)
    names = book.sheet_names
    if options.sheet is not None:
        if options.sheet not in names:
            raise ReadError(f"--sheet {options.sheet}: the sheets are {_list(names)}")
        return _sheet(book, options.sheet, raw, options)
    tables = {}
    for name in names:
        with suppress(ReadError):
            tables[name] = _sheet(book, name, raw, options)
    if not tables:
        raise ReadError(f"no sheet holds a table of numbers; the sheets are {_list(names)}")
    known = [n for n, t in tables.items() if kind_of(t, options)[0] not in _NO_TEST]
    likely = known or list(tables)
    if len(likely) > 1:
        raise ReadError(
            f'sheets {_list(likely)} could each be the test; choose with --sheet "{likely[0]}"'
        )
    return tables[likely[0]]


def _refuse_bomb(stream: BinaryIO) -> None:
    """Refuse a zipped workbook that unpacks to more than any test needs."""
    if stream.read(2) == b"PK":
        with zipfile.ZipFile(stream) as packed:
            size = sum(entry.file_size for entry in packed.infolist())
        if size > _LARGEST:
            raise ReadError(f"unpacks to {size / 1e9:.1f} GB; export it as text instead")
    stream.seek(0)


def _sheet(book: Any, name: str, raw: Raw, options: ReadOptions) -> Table:
    rows = book.get_sheet_by_name(name).to_python(skip_empty_area=False)
    content = "\n".join(map(_line, rows)).encode()
    if not content.strip():
        raise ReadError("an empty sheet")
    shown = replace(options, delimiter="\t", encoding="utf-8", sheet=None)
    table = text.read(Raw(raw.name, None, content), shown)
    return replace(table, format="workbook", encoding="", delimiter="", decimal="")


def _line(row: list[Any]) -> str:
    return "\t".join(_cell(value) for value in row)


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, float):
        return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    if isinstance(value, dt.timedelta):
        return repr(value.total_seconds())
    if isinstance(value, dt.datetime | dt.date | dt.time):
        return value.isoformat(sep=" ") if isinstance(value, dt.datetime) else value.isoformat()
    return " ".join(str(value).split())


def _list(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names[:8])
