"""A lot as a workbook: its tests, its seals, its statistics."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator
from copy import copy
from io import BytesIO
from shutil import copyfileobj
from typing import TYPE_CHECKING, Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

from dashpot.base.errors import ExportError
from dashpot.base.version import byline
from dashpot.io.write import neutral
from dashpot.lots.lot import Lot
from dashpot.lots.parts import polars
from dashpot.lots.summary import OfQuantity, Summary, finite

if TYPE_CHECKING:
    import polars as pl

_MADE = dt.datetime(1980, 1, 1)
"""That a workbook says it was made: the same lot is the same bytes."""
_SHEET_ROWS = 1_048_575
"""That a sheet has below its header."""
_FORMATS = {"Float64": "#,##0.000000", "Int64": "#,##0"}


def workbook(found: Summary) -> bytes:
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
        raise ExportError(
            'a workbook needs xlsxwriter, which is not installed: pip install "dashpot[batch]"'
        ) from None
    made = BytesIO()
    # a row of the largest sheets is on disk when the next one is made
    how = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}
    with Workbook(made, how) as book:
        book.set_properties({"comments": byline("lot"), "created": _MADE})
        for name, frame in (("tests", _tests(found.lot)), *_sheets(found)):
            if frame.height:
                _write(book, name, frame)
    return _byline_first(made)


def _tests(lot: Lot) -> pl.DataFrame:
    if lot.table.height <= _SHEET_ROWS:
        return lot.neutral()
    says = f"{lot.table.height} are more than a sheet has rows: they are in lot.csv"
    return _frame(iter([{"tests": says}]))


def _write(book: Any, name: str, frame: pl.DataFrame) -> None:
    sheet = book.add_worksheet(name)
    sheet.freeze_panes(1, 0)
    sheet.autofilter(0, 0, frame.height, frame.width - 1)
    kinds = [_FORMATS.get(str(kind)) for kind in frame.dtypes]
    formats = [kind and book.add_format({"num_format": kind}) for kind in kinds]
    sheet.write_row(0, 0, frame.columns, book.add_format({"bold": True}))
    for i, row in enumerate(frame.iter_rows(), start=1):
        for j, value in enumerate(row):
            if value is not None:
                sheet.write(i, j, value, formats[j])


_CORE = "docProps/core.xml"


def _byline_first(made: BytesIO) -> bytes:
    """The archive with its properties first and plain: a file of ours is known by its head."""
    whole = BytesIO()
    with ZipFile(made) as old, ZipFile(whole, "w") as new:
        for one in sorted(old.infolist(), key=lambda one: one.filename != _CORE):
            again = copy(one)
            again.compress_type = ZIP_STORED if one.filename == _CORE else ZIP_DEFLATED
            with old.open(one) as source, new.open(again, "w") as place:
                copyfileobj(source, place)
    return whole.getvalue()


def _sheets(found: Summary) -> Iterator[tuple[str, pl.DataFrame]]:
    each = found.each
    yield "seals", _frame(
        _seal(of, seal.lot, seal.name) | {
            "tests": len(seal.files), "mean": seal.mean, "repeats_sd": seal.deviation,
        } for of in each for seal in of.seals
    )  # fmt: skip
    yield "limits", _frame(
        _seal(of, one.lot, one.seal)
        | {"decision": one.decision, "value": one.value, "guard": one.guard}
        for of in each for one in of.judged
    )  # fmt: skip
    yield "scatter", _frame(
        {"quantity": of.quantity.name, "source": one.source, "variance": one.variance,
         "from": None if one.interval is None else one.interval[0],
         "to": None if one.interval is None else one.interval[1], "share": one.share}
        for of in each for one in of.components
    )  # fmt: skip
    yield "gauge", _frame(
        {"quantity": of.quantity.name, "source": one.name, "sd": one.deviation,
         "from": one.interval[0], "to": one.interval[1], "share": one.share}
        for of in each if of.gauge is not None for one in of.gauge.variations
    )  # fmt: skip
    yield "capability", _frame(
        {"quantity": of.quantity.name, "lot": neutral(lot), "seals": one.count, "mean": one.mean,
         "sd": one.deviation, "lower": one.lower, "upper": one.upper, "cp": one.cp,
         "cpk": one.cpk, "cpk_from": one.cpk_interval and one.cpk_interval[0],
         "cpk_to": one.cpk_interval and one.cpk_interval[1], "outside": one.outside}
        for of in each for lot, one in of.capability.items()
    )  # fmt: skip
    yield "flags", _frame(
        {name: neutral(value) if isinstance(value, str) else value
         for name, value in one._asdict().items()}
        for one in found.flags
    )  # fmt: skip
    yield (
        "checks",
        _frame(
            {"check": one.name, "passed": one.passed, "says": neutral(one.says)}
            for one in found.checks
        ),
    )


def _seal(of: OfQuantity, lot: str, seal: str) -> dict[str, Any]:
    return {"quantity": of.quantity.name, "lot": neutral(lot), "seal": neutral(seal)}


def _frame(rows: Iterator[dict[str, Any]]) -> pl.DataFrame:
    made: pl.DataFrame = polars().DataFrame(finite(list(rows)), infer_schema_length=None)
    return made
