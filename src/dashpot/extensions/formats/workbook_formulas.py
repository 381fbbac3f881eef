"""Formulas and errors in the cells of a workbook; only their last results are read.

Found in xlsx files, which store both a formula and its result.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from math import isclose
from typing import BinaryIO

from dashpot.extensions.formats.hidden_cells import list_sheet_parts

_CHUNK = 1 << 20
_LONGEST_ROW = 1 << 22
"""Bytes of a row, at most."""
_MAX_FORMULAS = 200_000
"""Formulas of a sheet that are looked at."""
_RESULT_TOLERANCE = 1e-6
"""Relative difference between a formula's result and the stored one."""
_CELL = re.compile(
    rb"<c\b([^<>]{0,300}?)>(?:<f\b([^<>]{0,300}?)(?:/>|>([^<]{0,2000})</f>))?"
    rb"(?:<v(?:/>|>([^<]{0,400})</v>))?"
)
_REFERENCE = re.compile(rb'\br="([A-Z]{1,3})(\d{1,7})"')
_KIND = re.compile(rb'\bt="(\w+)"')
_SHARED = re.compile(rb'\bsi="(\d{1,9})"')
_SIMPLE = re.compile(
    rb"\$?([A-Z]{1,3})\$?(\d{1,7})\s*([*/+-])\s*(\d{1,12}(?:\.\d{1,12})?(?:[eE][-+]?\d{1,3})?)"
)
"""A cell and a number with one sign between them."""


def scan_formulas(stream: BinaryIO) -> dict[str, list[str]]:
    """Return notes on formulas without value and errors, by sheet."""
    stream.seek(0)
    if not zipfile.is_zipfile(stream):
        return {}
    notes_by_sheet: dict[str, list[str]] = {}
    with zipfile.ZipFile(stream) as archive:
        for name, part in list_sheet_parts(archive).items():
            notes = _SheetFormulas().scan(_iterate_rows(archive, part))
            if notes:
                notes_by_sheet[name] = notes
    return notes_by_sheet


def _iterate_rows(archive: zipfile.ZipFile, part: str) -> Iterator[bytes]:
    """Iterate over the rows of a sheet, each as its XML."""
    rest = b""
    with archive.open(part) as stream:
        while block := stream.read(_CHUNK):
            rest += block
            *rows, rest = rest.split(b"</row>")
            yield from rows
            rest = rest[-_LONGEST_ROW:]


class _SheetFormulas:
    """Formulas of one sheet, row by row."""

    def __init__(self) -> None:
        self._values: dict[bytes, float] = {}
        self._previous_row: dict[bytes, float] = {}
        self._shared: dict[bytes, tuple[bytes, int, bytes]] = {}
        self._uncomputed_cells: list[str] = []
        self._stale_cells: list[str] = []
        self._errors: dict[str, list[str]] = {}
        self._count = 0

    def scan(self, rows: Iterator[bytes]) -> list[str]:
        """Return a note on each kind of cell that may hold a wrong number, over all rows."""
        has_formula = False
        for row in rows:
            has_formula = has_formula or b"<f" in row
            if has_formula or b't="e"' in row:
                self._scan_row(row)
        notes = []
        if self._uncomputed_cells:
            notes.append(
                f"{_describe_cells(self._uncomputed_cells)} without a result: open the workbook "
                "and save it"
            )
        if self._stale_cells:
            notes.append(
                f"{_describe_cells(self._stale_cells)} whose stored result does not follow from "
                "their cells: recalculate the workbook and save it"
            )
        for error, cells in self._errors.items():
            notes.append(
                f"{len(cells)} cells hold the error {error}, first {cells[0]}: they are no numbers"
            )
        return notes

    def _scan_row(self, row: bytes) -> None:
        self._previous_row, self._values = self._values, {}
        formulas: list[tuple[bytes, int, bytes]] = []
        for match in _CELL.finditer(row):
            reference = _REFERENCE.search(match[1])
            if reference is None:
                continue
            column, number = reference[1], int(reference[2])
            kind = _KIND.search(match[1])
            if kind and kind[1] == b"e":
                word = (match[4] or b"").decode("utf-8", "replace")
                self._errors.setdefault(word, []).append(f"{column.decode()}{number}")
                continue
            if match[2] is not None and not (match[4] or b"").strip():
                self._uncomputed_cells.append(f"{column.decode()}{number}")
                continue
            if kind is None or kind[1] == b"n":
                try:
                    self._values[column] = float(match[4] or b"nan")
                except ValueError:
                    continue
                if match[2] is not None and self._count < _MAX_FORMULAS:
                    self._count += 1
                    formulas.append((column, number, self._read_formula(match, column, number)))
        for column, number, formula in formulas:
            expected = self._evaluate(formula, number)
            stored_value = self._values[column]
            if expected is not None and not isclose(
                expected, stored_value, rel_tol=_RESULT_TOLERANCE, abs_tol=1e-12
            ):
                self._stale_cells.append(f"{column.decode()}{number}")

    def _read_formula(self, match: re.Match[bytes], column: bytes, number: int) -> bytes:
        """Return the formula of a cell; a shared one is that of the first cell, shifted."""
        text, shared = match[3] or b"", _SHARED.search(match[2])
        if shared is None:
            return text
        if text:
            self._shared[shared[1]] = column, number, text
            return text
        first, row, text = self._shared.get(shared[1], (b"", 0, b""))
        simple = _SIMPLE.fullmatch(text.strip()) if first == column else None
        if simple is None or b"$" in text:
            return b""
        shifted = int(simple[2]) + number - row
        return simple[1] + str(shifted).encode() + simple[3] + simple[4]

    def _evaluate(self, formula: bytes, number: int) -> float | None:
        """Return the result of a simple formula of a cell in this row or the one before."""
        simple = _SIMPLE.fullmatch(formula.strip())
        if simple is None:
            return None
        row = {number: self._values, number - 1: self._previous_row}.get(int(simple[2]), {})
        value, operand = row.get(simple[1]), float(simple[4])
        if value is None or (simple[3] == b"/" and operand == 0):
            return None
        return {
            b"*": value * operand,
            b"/": value / (operand or 1.0),
            b"+": value + operand,
            b"-": value - operand,
        }[simple[3]]


def _describe_cells(cells: list[str]) -> str:
    """Return how many cells hold formulas, and the first."""
    return f"{len(cells)} cells hold formulas (first {cells[0]})"
