"""Lot as a spreadsheet workbook: its tests, seals and statistics."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterable, Iterator
from copy import copy
from io import BytesIO
from shutil import copyfileobj
from typing import TYPE_CHECKING, Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

from dashpot.base.errors import ExportError
from dashpot.base.plain_text import escape_formula
from dashpot.base.version import byline
from dashpot.extensions.batch.lot import Lot
from dashpot.extensions.batch.parquet_parts import import_polars
from dashpot.extensions.batch.summary import Summary
from dashpot.registry import format_install_command

if TYPE_CHECKING:
    import polars as pl


_WORKBOOK_DATE = dt.datetime(1980, 1, 1)
"""Date in a workbook: the same lot gives the same bytes."""
_SHEET_ROWS = 1_048_575
"""Rows of a sheet below its header."""
_FORMATS = {"Float64": "#,##0.000000", "Int64": "#,##0"}


def workbook(summary: Summary) -> bytes:
    """Return a lot as XLSX with the sheets tests, seals, scatter, capability and checks.

    SI units, as in the table; no text is a formula.

    Raises
    ------
    ExportError
        If xlsxwriter is not installed.
    """
    try:
        from xlsxwriter import Workbook
    except ImportError:
        advice = format_install_command("batch")
        raise ExportError(
            f"a workbook needs xlsxwriter, which is not installed; install it with: {advice}"
        ) from None
    buffer = BytesIO()
    # a row of the largest sheets is on disk when the next one is made
    workbook_options = {
        "constant_memory": True,
        "strings_to_formulas": False,
        "strings_to_urls": False,
    }
    with Workbook(buffer, workbook_options) as workbook_file:
        workbook_file.set_properties({"comments": byline("lot"), "created": _WORKBOOK_DATE})
        for name, frame in (("tests", _make_test_rows(summary.lot)), *_make_sheets(summary)):
            if frame.height:
                _write(workbook_file, name, frame)
    return _put_byline_first(buffer)


def _make_test_rows(lot: Lot) -> pl.DataFrame:
    if lot.table.height <= _SHEET_ROWS:
        return lot.written_table()
    message = f"{lot.table.height} are more than a sheet has rows: they are in lot.csv"
    return _make_frame([{"tests": message}])


def _write(workbook_file: Any, name: str, frame: pl.DataFrame) -> None:
    sheet = workbook_file.add_worksheet(name)
    sheet.freeze_panes(1, 0)
    sheet.autofilter(0, 0, frame.height, frame.width - 1)
    kinds = [_FORMATS.get(str(kind)) for kind in frame.dtypes]
    formats = [kind and workbook_file.add_format({"num_format": kind}) for kind in kinds]
    sheet.write_row(0, 0, frame.columns, workbook_file.add_format({"bold": True}))
    for i, row in enumerate(frame.iter_rows(), start=1):
        for j, value in enumerate(row):
            if value is not None:
                sheet.write(i, j, value, formats[j])


_CORE = "docProps/core.xml"


def _put_byline_first(workbook: BytesIO) -> bytes:
    """The archive with its properties first and plain: a file of ours is known by its head."""
    buffer = BytesIO()
    with ZipFile(workbook) as old, ZipFile(buffer, "w") as new:
        for item in sorted(old.infolist(), key=lambda member: member.filename != _CORE):
            new_item = copy(item)
            new_item.compress_type = ZIP_STORED if item.filename == _CORE else ZIP_DEFLATED
            with old.open(item) as source, new.open(new_item, "w") as target:
                copyfileobj(source, target)
    return buffer.getvalue()


_SHEETS = {
    "seals": ("seals", "lot seal tests mean repeats_sd"),
    "limits": ("judged", "lot seal decision value guard"),
    "scatter": ("components", "source variance interval_from interval_to share"),
    "gauge": ("variations", "name deviation interval_from interval_to share"),
    "capability": (
        "capability",
        "lot count mean deviation lower upper cp cpk cpk_interval_from cpk_interval_to outside",
    ),
}
"""Sheets: the part of the document of each quantity, and its entries."""
_HEADS = {
    "name": "source", "deviation": "sd", "count": "seals", "interval_from": "from",
    "interval_to": "to", "cpk_interval_from": "cpk_from", "cpk_interval_to": "cpk_to",
}  # fmt: skip


def _make_sheets(summary: Summary) -> Iterator[tuple[str, pl.DataFrame]]:
    document = summary.to_dict()
    for sheet, (part, names) in _SHEETS.items():
        rows = (
            {"quantity": statistics["quantity"]}
            | {_HEADS.get(name, name): row.get(name) for name in names.split()}
            for statistics in document["statistics"]
            for row in map(
                _flatten_intervals, (statistics | (statistics["gauge"] or {})).get(part, ())
            )
        )
        yield sheet, _make_frame(rows)
    yield "flags", _make_frame(document["flags"])
    checks = (
        {"check": check.name, "passed": check.passed, "message": check.message}
        for check in summary.checks
    )
    yield "checks", _make_frame(checks)


def _flatten_intervals(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row whose intervals are two cells each."""
    for name in [name for name, value in row.items() if isinstance(value, list)]:
        row[f"{name}_from"], row[f"{name}_to"] = row.pop(name)
    return row


def _make_frame(rows: Iterable[dict[str, Any]]) -> pl.DataFrame:
    """Return a table of rows, in which no text is a formula."""
    cells = [
        {name: escape_formula(v) if isinstance(v, str) else v for name, v in row.items()}
        for row in rows
    ]
    frame: pl.DataFrame = import_polars().DataFrame(cells, infer_schema_length=None)
    return frame
