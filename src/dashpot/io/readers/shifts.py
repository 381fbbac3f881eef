"""From a table of shift factors to shifts."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.io.columns.roles import assign, list_columns
from dashpot.io.columns.vocabulary import plain
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.table import Column
from dashpot.records.temperature import Shift

# log aT, log10_a_t, lg(a_T), ln aT, aT, shift factor; and b_T, vertical shift
_HORIZONTAL = re.compile(r"(log10|log|lg|ln|)(at|shiftfactors?|horizontalshifts?)")
_VERTICAL = re.compile(r"(log10|log|lg|ln|)(bt|verticalshifts?)")


def read_shifts(path: str | Path, *, options: ReadOptions | None = None) -> tuple[Shift, ...]:
    """Return the shifts in a table of temperature and a_T, by rising temperature.

    The column of shifts is named a_T, log a_T or ln a_T (or shift factor, with or without the
    log); one of b_T and one of standard errors, of log a_T, named se, may stand beside it.

    Raises
    ------
    ReadError
        If temperature or shift is not found, a factor is not above 0, or a temperature recurs.
    """
    with channels.opened(path, options) as file:
        columns = channels.with_units(
            file, channels.answered(file, [assign(file.table, "temperature", file.options)])
        )
        names = [_joined(column) for column in file.table.columns]
        a, b = (_found(names, pattern) for pattern in (_HORIZONTAL, _VERTICAL))
        if a is None:
            raise ReadError(
                "no column is named a_T, log a_T or ln a_T; the columns are "
                f"{list_columns(file.table.columns)}"
            )
        se = names.index("se") if "se" in names else None
        wanted = [columns[0].index, a[0], *(i for i in (b and b[0], se) if i is not None)]
        rows, _ = channels.whole_rows(channels.load(file.table, wanted, file.options.segment))
        kelvin = channels.si(rows[:, 0].copy(), columns[0].unit)
        if len(set(kelvin.tolist())) < len(kelvin):
            raise ReadError("a temperature stands in the table of shifts twice")
        log10_a = _decadic(rows[:, 1], a[1])
        log10_b = np.zeros(len(rows)) if b is None else _decadic(rows[:, 2], b[1])
        error = np.zeros(len(rows)) if se is None else rows[:, -1]
    return tuple(
        Shift(float(kelvin[i]), float(log10_a[i]), float(error[i]), float(10 ** log10_b[i]))
        for i in np.argsort(kelvin)
    )


def _joined(column: Column) -> str:
    """A column's name in one word; what looks like a unit in log(a_T) is none."""
    whole = plain(f"{column.name} {column.unit or ''}").replace(" ", "")
    parted = _HORIZONTAL.fullmatch(whole) or _VERTICAL.fullmatch(whole)
    return whole if parted else plain(column.name).replace(" ", "")


def _found(names: list[str], pattern: re.Pattern[str]) -> tuple[int, str] | None:
    """Return the index of the first column of such a name, and its logarithm if it has one."""
    for i, name in enumerate(names):
        if found := pattern.fullmatch(name):
            return i, found[1]
    return None


def _decadic(values: FloatArray, logarithm: str) -> FloatArray:
    """Return the decadic logarithm of a factor, or of what its logarithm is."""
    if logarithm:
        return np.asarray(values / np.log(10.0) if logarithm == "ln" else values)
    if (values <= 0).any():
        raise ReadError(
            f"a shift factor is {values.min():g}; expected > 0: is the column its logarithm? name "
            "it log a_T then"
        )
    return np.asarray(np.log10(values))
