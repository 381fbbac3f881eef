"""Recognition of a table of stiffness at several compressions by its columns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import units
from dashpot.base.errors import ReadError
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.kind_detection import NamedColumns
from dashpot.reading.table import Column, FileTable

STATIC = (
    "compression", "precompression", "preload", "static", "mean", "offset", "vorspannung",
    "vorlast", "stauchung", "squeeze", "précompression",
)  # fmt: skip
MOVING = (
    "amplitude", "dynamic", "amp", "ampl", "amplitud", "amplituda", "dynamisch", "dynamique",
    "pp", "p", "pk", "peak", "rms", "schwingbreite", "doppelamplitude",
)  # fmt: skip
"""Words of a column of the static compression, and of one of the amplitude."""


def has_several_compressions(columns: NamedColumns) -> bool:
    """Return whether a column of static compression steps from sweep to sweep."""
    index = find_length_column(columns.table, STATIC, without=MOVING)
    if index is None:
        return False
    values = columns.table.load([index]).values[:, 0]
    values = values[np.isfinite(values)]
    return bool(len(values) and np.ptp(values) > 0.05 * np.abs(values).max())


def find_length_column(
    table: FileTable, words: Sequence[str], *, without: Sequence[str] = ()
) -> int | None:
    """Return the one column of a length that has one of the words in its name, and none of others.

    Raises
    ------
    ReadError
        If several have.
    """
    found = [
        i
        for i, column in enumerate(table.columns)
        if _is_length(column)
        and not set(words).isdisjoint(vocabulary.tokens(column.name))
        and set(without).isdisjoint(vocabulary.tokens(column.name))
    ]
    if len(found) > 1:
        names = " and ".join(f"'{table.columns[i].name}'" for i in found)
        raise ReadError(f"{names} could each be the {words[0]}; rename all but one")
    return found[0] if found else None


def _is_length(column: Column) -> bool:
    return column.content == "number" and bool(
        column.unit and units.find_unit(column.unit, "length")
    )
