"""Recognition of a table of stiffness at several compressions by its columns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import units
from dashpot.base.errors import ReadError
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.kind_detection import NamedColumns
from dashpot.reading.read_options import ReadOptions
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
SETTINGS = (
    *(word for word in STATIC if word not in {"static", "mean", "offset"}),
    *(word for word in MOVING if word not in {"dynamic", "dynamisch", "dynamique", "p", "peak"}),
    "strain", "displacement",
)  # fmt: skip
"""Words that name a setting even where the unit is missing or no length."""


def has_several_compressions(columns: NamedColumns) -> bool:
    """Return whether a column of static compression steps from sweep to sweep."""
    index = find_length_column(columns.table, STATIC, columns.options, excluded_words=MOVING)
    if index is None:
        return False
    values = columns.table.load([index]).values[:, 0]
    values = values[np.isfinite(values)]
    return bool(len(values) and np.ptp(values) > 0.05 * np.abs(values).max())


def find_length_column(
    table: FileTable,
    words: Sequence[str],
    options: ReadOptions,
    *,
    excluded_words: Sequence[str] = (),
) -> int | None:
    """Return the one column of a length that has one of the words in its name, and none of others.

    A unit that the user gives, under the first of the words or the name of the column, counts.

    Raises
    ------
    ReadError
        If several have.
    """
    length_columns = [
        i
        for i, column in enumerate(table.columns)
        if _is_length(column, get_length_word(column, words, options))
        and not set(words).isdisjoint(vocabulary.tokens(column.name))
        and set(excluded_words).isdisjoint(vocabulary.tokens(column.name))
    ]
    if len(length_columns) > 1:
        names = " and ".join(f"'{table.columns[i].name}'" for i in length_columns)
        raise ReadError(f"{names} could each be the {words[0]}; rename all but one")
    return length_columns[0] if length_columns else None


def get_length_word(column: Column, words: Sequence[str], options: ReadOptions) -> str | None:
    """Return the unit of a column of such a length by the options, else by the file."""
    return options.unit_of(words[0], column.name) or column.unit


def _is_length(column: Column, word: str | None) -> bool:
    return column.content == "number" and bool(word and units.find_unit(word, "length"))
