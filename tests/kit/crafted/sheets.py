"""Workbooks: dates at midnight, hidden rows and columns."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import datetime as dt
import io

import openpyxl
from openpyxl.utils import get_column_letter

from kit.crafted.row import COLD, ISOTHERMS, LOSS, STORAGE, WARMTH, F, Row
from kit.instruments import ods, ods_rows
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
HEAD = ["Time (s)", "Position (mm)", "Load (N)"]


def book(
    head: list[str], rows: list[list[object]], *, rows_hidden: tuple[int, ...] = (),
    columns_hidden: tuple[int, ...] = (), form: str = "",
) -> bytes:  # fmt: skip
    """An xlsx file of one sheet."""
    made = openpyxl.Workbook()
    sheet = made.active
    assert sheet is not None
    sheet.title = "Data"
    for row in [head, *rows]:
        sheet.append(row)
    for number in rows_hidden:
        sheet.row_dimensions[number].hidden = True
    for number in columns_hidden:
        sheet.column_dimensions[get_column_letter(number)].hidden = True
    for number in range(2, len(rows) + 2) if form else ():
        sheet.cell(number, 1).number_format = form
    content = io.BytesIO()
    made.save(content)
    return content.getvalue()


def instants() -> list[list[object]]:
    """The truth on a clock that meets midnight at one of its samples."""
    start = dt.datetime(2024, 4, 5, 23, 59, 57)
    return [
        [start + dt.timedelta(milliseconds=round(1e3 * t)), x, f]
        for t, x, f in zip(TIME.tolist(), DISPLACEMENT.tolist(), FORCE.tolist(), strict=True)
    ]


def list_rows() -> list[list[object]]:
    return [
        list(row) for row in zip(TIME.tolist(), DISPLACEMENT.tolist(), FORCE.tolist(), strict=True)
    ]


def list_merged_rows() -> list[list[object]]:
    """Two isotherms whose temperature stands in the first row of each, as merged cells leave it."""
    return [
        [warm if i == 0 else None, f, factor * a / 1e6, factor * b / 1e6]
        for warm, factor in zip(WARMTH, (COLD, 1.0), strict=True)
        for i, (f, a, b) in enumerate(zip(F.tolist(), STORAGE.tolist(), LOSS.tolist(), strict=True))
    ]


def encode_hidden_row(row: int) -> bytes:
    """An OpenDocument workbook of which a row is not seen."""
    content = io.BytesIO()
    before, *rows = ods_rows([HEAD, *list_rows()]).split("<table:table-row>")
    marks = ["", *([""] * row), ' table:visibility="collapse"', *([""] * len(rows))]
    marked = (f"<table:table-row{mark}>{row}" for mark, row in zip(marks[1:], rows, strict=False))
    ods(content, before + "".join(marked))  # type: ignore[arg-type]
    return content.getvalue()


SHEETS = [
    Row("an OpenDocument workbook with a hidden row", encode_hidden_row(20), "noted", ("hidden in sheet 'One' and read: row 21",)),
    Row("a workbook with a sample at midnight", book(["Time", *HEAD[1:]], instants(), form="dd.mm.yyyy hh:mm:ss.000")),
    Row("a workbook with hidden rows", book(HEAD, list_rows(), rows_hidden=(20, 21, 40)), "noted", ("rows 20, 21, 40",)),
    Row("a workbook with a hidden column", book([*HEAD, "Temp (C)"], [[*row, 23.0] for row in list_rows()], columns_hidden=(4,)), "noted", ("column D",)),
    Row("a workbook with both", book(HEAD, list_rows(), rows_hidden=(9,), columns_hidden=(2,)), "noted", ("row 9 and column B",)),
    Row("a workbook with a temperature once for each block", book(["Temp [°C]", "f [Hz]", "E' [MPa]", "E'' [MPa]"], list_merged_rows()), "noted", ("the temperature stands in 2 of 26 rows",), ISOTHERMS),
]  # fmt: skip
