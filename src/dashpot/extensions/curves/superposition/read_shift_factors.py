"""Reader of tables of shift factors."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.datamodel.shift_factors import Shift
from dashpot.reading.columns.role_assignment import assign_role, list_columns
from dashpot.reading.columns.vocabulary import normalise_name
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.table import Column

# log aT, log10_a_t, lg(a_T), ln aT, aT, shift factor; and b_T, vertical shift
_HORIZONTAL = re.compile(r"(log10|log|lg|ln|)(at|shiftfactors?|horizontalshifts?)")
_VERTICAL = re.compile(r"(log10|log|lg|ln|)(bt|verticalshifts?)")
_PATTERNS = {"a": _HORIZONTAL, "b": _VERTICAL, "se": re.compile("()se")}


def read_shifts(path: str | Path, *, options: ReadOptions | None = None) -> tuple[Shift, ...]:
    """Return the shifts in a table of temperature and a_T, by rising temperature.

    The column of shifts is named a_T, log a_T or ln a_T (or shift factor, with or without the
    log); one of b_T and one of standard errors, of log a_T, named se, may stand beside it.

    Raises
    ------
    ReadError
        If temperature or shift is not found, a factor is not above 0, or a temperature recurs.
    """
    with channels.open_file(path, options) as file:
        columns = channels.add_units(
            file,
            channels.require_answers(file, [assign_role(file.table, "temperature", file.options)]),
        )
        names = [_join_name_words(column) for column in file.table.columns]
        entries = {role: _find_column(names, pattern) for role, pattern in _PATTERNS.items()}
        available = {role: entry for role, entry in entries.items() if entry is not None}
        if "a" not in available:
            raise ReadError(
                "no column is named a_T, log a_T or ln a_T; the columns are "
                f"{list_columns(file.table.columns)}"
            )
        column_indices = [columns[0].index, *(index for index, _ in available.values())]
        rows, _ = channels.select_complete_rows(
            channels.load(file.table, column_indices, file.options.segment)
        )
        kelvin = channels.scale_to_si(rows[:, 0].copy(), columns[0].unit)
        if len(set(kelvin.tolist())) < len(kelvin):
            raise ReadError("a temperature stands in the table of shifts twice")
        values, zeros = dict(zip(available, rows.T[1:], strict=True)), np.zeros(len(rows))
        log10_a = _take_decadic_logarithm(values["a"], available["a"][1])
        log10_b = (
            _take_decadic_logarithm(values["b"], available["b"][1]) if "b" in available else zeros
        )
        error = values.get("se", zeros)
    return tuple(
        Shift(float(kelvin[i]), float(log10_a[i]), float(error[i]), float(10 ** log10_b[i]))
        for i in np.argsort(kelvin)
    )


def _join_name_words(column: Column) -> str:
    """Return a column's name as one word; log(a_T) has no unit."""
    joined_name = normalise_name(f"{column.name} {column.unit or ''}").replace(" ", "")
    name_match = _HORIZONTAL.fullmatch(joined_name) or _VERTICAL.fullmatch(joined_name)
    return joined_name if name_match else normalise_name(column.name).replace(" ", "")


def _find_column(names: list[str], pattern: re.Pattern[str]) -> tuple[int, str] | None:
    """Return the index of the first column of such a name, and its logarithm if it has one."""
    for i, name in enumerate(names):
        if match := pattern.fullmatch(name):
            return i, match[1]
    return None


def _take_decadic_logarithm(values: FloatArray, logarithm: str) -> FloatArray:
    """Return the decadic logarithm of a factor or of its stated logarithm."""
    if logarithm:
        return np.asarray(values / np.log(10.0) if logarithm == "ln" else values)
    if (values <= 0).any():
        raise ReadError(
            f"a shift factor is {values.min():g}; expected > 0: is the column its logarithm? name "
            "it log a_T then"
        )
    return np.asarray(np.log10(values))
