"""The words of a column that holds none of the numbers of a test: which piece, which method."""

from __future__ import annotations

from collections.abc import Set as AbstractSet

import numpy as np
import numpy.typing as npt

from dashpot.base.errors import ReadError
from dashpot.reading.columns.vocabulary import tokens
from dashpot.reading.read_options import DELIMITERS
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.table import LoadedColumns
from dashpot.reading.text.cells import split


def read_text_column(
    file: OpenedFile, names: AbstractSet[str], loaded: LoadedColumns
) -> npt.NDArray[np.str_]:
    """The word of every row in the column that is called so; empty where there is none.

    Raises
    ------
    ReadError
        If the file is none of text, and the column holds words.
    """
    columns, count = file.table.columns, len(loaded.values)
    index = next((i for i, column in enumerate(columns) if names & set(tokens(column.name))), None)
    if index is None:
        return np.full(count, "")
    if columns[index].content == "number":
        return channels.load(file.table, [index], file.options.segment).values[:, 0].astype(str)
    mark = DELIMITERS.get(file.table.delimiter or "")
    if mark is None or not loaded.lines:
        raise ReadError(f"'{columns[index].name}' holds words. Write numbers in their place")
    with file.raw.open() as stream:
        lines = stream.read().decode(file.table.encoding).splitlines()
    return np.array([split(lines[loaded.line(row) - 1], mark)[index] for row in range(count)])
