"""Spreadsheets (xls, xlsx, xlsb, ods) through calamine: the displayed text of each sheet."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import replace

from dashpot.base.errors import ReadError
from dashpot.base.provenance import Caution
from dashpot.extensions.formats.specimens import separate_specimens
from dashpot.extensions.formats.workbook_sheets import FORMULAS, HIDDEN, format_sheet_names, sheets
from dashpot.reading.columns.kind_detection import detect_table_kind
from dashpot.reading.formats import text
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox.parent_process import run_in_child
from dashpot.reading.table import FileTable, Question
from dashpot.reading.text.cells import EITHER_WAY

_COMMA = re.compile(r"\A[+-]?(?:\d{1,3}(?:\.\d{3})+|\d*),\d+(?:[eE][+-]?\d{1,4})?\Z")
"""A number as text with a decimal comma, or with commas of thousands."""
_WITHOUT_RESULT = re.compile(r"(\d+) cells hold formulas .* without a result")
_NO_TEST = {"unclear", "not-a-test"}


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table of the sheet with a test, or of the named sheet.

    Which of several could be meant is a question.

    Raises
    ------
    ReadError
        If no sheet could be meant.
    """
    entries = run_in_child("workbook", sheets, raw, options)
    content = {
        name: cells for name, cells in entries.items() if not name.startswith((HIDDEN, FORMULAS))
    }
    if options.sheet is not None:
        return _sheet(options.sheet, entries, raw, options)
    tables = {}
    for name in content:
        with suppress(ReadError):
            tables[name] = _sheet(name, entries, raw, options)
    if not tables and len(content) == 1:
        return _sheet(next(iter(content)), entries, raw, options)
    if not tables:
        raise ReadError(
            f"no sheet holds a table of numbers; the sheets are {format_sheet_names(content)}"
        )
    sheet_options = replace(options, kind=None)
    names = [n for n, t in tables.items() if detect_table_kind(t, sheet_options)[0] not in _NO_TEST]
    likely_sheets = names or list(tables)
    table = tables[likely_sheets[0]]
    if len(likely_sheets) > 1:
        message = (
            f"sheets {format_sheet_names(likely_sheets)} could each be the test; choose with "
            "--file-part "
            f'sheet="{likely_sheets[0]}", or fit all of them: dashpot batch {raw.name} -o lot'
        )
        answers = tuple((name, f"sheet={name}") for name in likely_sheets)
        question = Question(
            message, "--file-part sheet=NAME", choices=len(likely_sheets), answers=answers
        )
        table = replace(table, questions=(question, *table.questions))
    return table


def _sheet(name: str, entries: dict[str, bytes], raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table of a sheet, with a note on hidden cells, which are read as well."""
    content = entries.get(name, b"")
    if not content.strip():
        raise ReadError("an empty sheet")
    formulas = entries.get(FORMULAS + name, b"").decode().splitlines()
    empty = next(filter(None, map(_WITHOUT_RESULT.match, formulas)), None)
    if empty and 2 * int(empty[1]) >= content.count(b"\n"):
        raise ReadError(f"sheet '{name}': {empty.string}")
    table_options, commas = replace(options, delimiter="\t", encoding="utf-8", sheet=None), 0
    if b"," in content:
        points, commas = _with_points(content.decode(), options.decimal)
        content = points.encode()
    if options.decimal == ",":  # numbers that are no text have points here
        table_options = replace(table_options, decimal=None)
    cells = RawFile(raw.name, None, content)
    table = separate_specimens(text.read(cells, table_options), cells, table_options)
    hidden_text = entries.get(HIDDEN + name, b"").decode()
    message = f"hidden in sheet '{name}' and read: {hidden_text}"
    note = Caution(message) if hidden_text.startswith("row") else message
    notes = [note] if hidden_text else []
    notes += [Caution(f"sheet '{name}': {sentence}") for sentence in formulas]
    if commas:
        notes.append(f"{commas} cells hold numbers as text with a decimal comma, and are read so")
    return replace(
        table, format="workbook", encoding="", delimiter="", decimal="",
        notes=(*table.notes, *notes),
    )  # fmt: skip


def _with_points(content: str, decimal: str | None) -> tuple[str, int]:
    """Return the cells of a sheet, text with decimal commas as numbers with points, and how many.

    Numeric cells have a decimal point here, so a cell with a comma is text. ``1,234`` has a decimal
    comma if others in its column cannot be thousands, or if the user states it; else it is left,
    and requested.
    """
    rows = [line.split("\t") for line in content.split("\n")]
    columns: dict[int, list[list[str]]] = {}
    for row in rows:
        for j, cell in enumerate(row):
            if "," in cell and _COMMA.match(cell):
                columns.setdefault(j, []).append(row)
    count = 0
    for j, column_cells in columns.items():
        is_decimal_comma = decimal == "," or not all(
            EITHER_WAY.match(row[j]) for row in column_cells
        )
        if decimal == "." or not is_decimal_comma:
            continue
        count += len(column_cells)
        for row in column_cells:
            row[j] = repr(float(row[j].replace(".", "").replace(",", ".")))
    return "\n".join("\t".join(row) for row in rows), count
