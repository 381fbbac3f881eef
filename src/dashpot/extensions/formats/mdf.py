"""ASAM MDF files (.mf4, .mdf, .dat), versions 2 to 4: read in a child process, by own code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.extensions.formats.mdf_table import describe, read_columns
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import parent_process
from dashpot.reading.table import FileTable, LoadedColumns

_CACHED_COLUMNS = 8
"""Cached columns of a large file."""


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the channels of an MDF file as columns on one clock.

    Groups with the same channels are segments. Of others, the one with most channels of a test
    gives the clock, and those of the rest are interpolated to it. Columns of a large file are read
    when they are requested.

    Raises
    ------
    ReadError
        If the file is damaged, cut or unfinished, or stores its numbers in a way not known here.
    """
    table: FileTable = parent_process.run_in_child("mdf", describe, raw, options)
    if len(table.load([0]).values):
        return table
    cached_columns: dict[int, LoadedColumns] = {}

    def load(indexes: Sequence[int]) -> LoadedColumns:
        missing_indices = [index for index in dict.fromkeys(indexes) if index not in cached_columns]
        if missing_indices:
            part = parent_process.run_in_child(
                "mdf", read_columns, raw, options, columns=missing_indices
            )
            loaded_columns = part.load(range(len(missing_indices)))
            for position, index in enumerate(missing_indices):
                column_name = f"'{table.columns[index].name}'"
                cached_columns[index] = replace(
                    loaded_columns,
                    values=loaded_columns.values[:, position],
                    notes=tuple(note for note in part.notes if column_name in note),
                )
        columns = [cached_columns[index] for index in indexes]
        for index in list(cached_columns)[:-_CACHED_COLUMNS]:
            del cached_columns[index]
        return replace(
            columns[0],
            values=np.array([column.values for column in columns]).T,
            notes=tuple(dict.fromkeys(note for column in columns for note in column.notes)),
        )

    return replace(table, load=load, large=True)
