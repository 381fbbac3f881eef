"""A lot as a workbook: its tests, its seals, its statistics."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator
from io import BytesIO
from typing import TYPE_CHECKING, Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

from dashpot.base.errors import ExportError
from dashpot.base.version import byline
from dashpot.io.write import neutral
from dashpot.lots.parts import polars
from dashpot.lots.summary import OfQuantity, Summary, finite

if TYPE_CHECKING:
    import polars as pl

_MADE = dt.datetime(1980, 1, 1)
"""That a workbook says it was made: the same lot is the same bytes."""
_SHEET_ROWS = 1_048_575
"""That a sheet has below its header."""


def workbook(found: Summary) -> bytes:
    """Return a lot as XLSX with the sheets tests, seals, scatter, capability and checks.

    SI units, as in the table; no text is a formula.

    Raises
    ------
    ExportError
        If xlsxwriter is not installed, or there are more tests than a sheet has rows.
    """
    try:
        from xlsxwriter import Workbook
    except ImportError:
        raise ExportError(
            'a workbook needs xlsxwriter, which is not installed: pip install "dashpot[batch]"'
        ) from None
    tests = found.lot.neutral()
    if tests.height > _SHEET_ROWS:
        raise ExportError(
            f"{tests.height} tests are more than the {_SHEET_ROWS} rows of a sheet; use lot.csv or "
            "the Parquet parts"
        )
    made = BytesIO()
    with Workbook(made, {"in_memory": True, "strings_to_formulas": False}) as book:
        book.set_properties({"comments": byline("lot"), "created": _MADE})
        for name, frame in (("tests", tests), *_sheets(found)):
            if frame.height:
                frame.write_excel(book, name, autofit=False, float_precision=6)
    return _byline_first(made)


_CORE = "docProps/core.xml"


def _byline_first(made: BytesIO) -> bytes:
    """The archive with its properties first and plain: a file of ours is known by its head."""
    whole = BytesIO()
    with ZipFile(made) as old, ZipFile(whole, "w", ZIP_DEFLATED) as new:
        for one in sorted(old.infolist(), key=lambda one: one.filename != _CORE):
            plain = one.filename == _CORE
            new.writestr(one, old.read(one), ZIP_STORED if plain else ZIP_DEFLATED)
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
