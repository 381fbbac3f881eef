"""Tables with named columns: points of a line, modes at points."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.units import Dimension, parse_unit
from dashpot.reading.columns.role_assignment import join_words, list_columns
from dashpot.reading.columns.vocabulary import normalise_name
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.table import Column, LoadedColumns


def read_named_columns(
    file: OpenedFile, available: Sequence[str], *, required: Sequence[Sequence[str]], hint: str
) -> tuple[dict[str, Column], LoadedColumns]:
    """Return each column of a known name, and their numbers in that order.

    Raises
    ------
    ReadError
        If a group of `required` names has no column; the `hint` states what is expected.
    """
    names = [normalise_name(column.name) for column in file.table.columns]
    missing = [words for words in required if not set(words) & set(names)]
    if missing:
        raise ReadError(
            f"no column is named {join_words(missing[0], 'or')}; the columns are "
            f"{list_columns(file.table.columns)}; {hint}"
        )
    index = {name: names.index(name) for name in available if name in names}
    columns = {name: file.table.columns[i] for name, i in index.items()}
    return columns, channels.load(file.table, list(index.values()), None)


def convert_column_to_si(
    column: Column, values: FloatArray, dimension: Dimension, unit: str | None, advice: str
) -> FloatArray:
    """Return the numbers of a column in SI units, by the unit of its header, or the one stated.

    Raises
    ------
    ReadError
        If there is neither, with the advice.
    """
    word = column.unit or unit
    if word is None:
        name = normalise_name(column.name)
        raise ReadError(f"column {name} has no unit; write {name} [mm] over it, or {advice}")
    return channels.scale_to_si(values.copy(), parse_unit(word, dimension))
