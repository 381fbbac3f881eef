"""Reader of counterforce tests: hours, force or F/F0, oven, specimen and method."""

from __future__ import annotations

import re
from collections.abc import Set as AbstractSet
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from dashpot.base import units
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.units import celsius
from dashpot.datamodel.shift_factors import SAME_TEMPERATURE
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.csr.datamodel import CSRTest
from dashpot.extensions.materials.csr.table_rule import find_counterforce_columns, is_ratio
from dashpot.reading.columns.vocabulary import tokens
from dashpot.reading.read_options import DELIMITERS, ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.header_metadata import add_specimen_temperature
from dashpot.reading.table import LoadedColumns
from dashpot.reading.text.cells import split

# Text columns: specimen and method.


def read_text_column(
    file: OpenedFile, names: AbstractSet[str], loaded_columns: LoadedColumns
) -> npt.NDArray[np.str_]:
    """Return the texts of the column with one of some names; empty if there is none.

    Raises
    ------
    ReadError
        If the file is not a text file, and the column holds words.
    """
    columns, count = file.table.columns, len(loaded_columns.values)
    index = next((i for i, column in enumerate(columns) if names & set(tokens(column.name))), None)
    if index is None:
        return np.full(count, "")
    if columns[index].content == "number":
        return channels.load(file.table, [index], file.options.segment).values[:, 0].astype(str)
    delimiter = DELIMITERS.get(file.table.delimiter or "")
    if delimiter is None or not loaded_columns.lines:
        raise ReadError(f"'{columns[index].name}' holds words. Write numbers in their place")
    with file.raw.open() as stream:
        lines = stream.read().decode(file.table.encoding).splitlines()
    return np.array(
        [split(lines[loaded_columns.line(row) - 1], delimiter)[index] for row in range(count)]
    )


_SPECIMEN_COLUMNS = {
    "piece",
    "specimen",
    "sample",
    "ring",
    "button",
    "probe",
    "prüfling",
    "probekörper",
}
_METHOD = {"method", "methode", "verfahren"}
_METHOD_PATTERN = re.compile(r"\bmethod\s*[:=,;]?\s*([ab])\b")
_PER_CENT_LIMIT = 1.5
"""Per cent of F0 below the first reading of any specimen: such columns are parts of 1."""


def read_csr(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> CSRTest:
    """Return the counterforce of the specimens in a file, in SI units; ``-`` is stdin.

    Parameters
    ----------
    path : path
        Hours or days and force, or F/F0, with columns of temperature, specimen and method, or one
        oven a file. Without a column of specimens a new one begins where the clock does.
    options : ReadOptions
        Reading options of the file.
    specimen : Specimen or None
        Its temperature is that of the oven, where the file says none.

    Raises
    ------
    ReadError
        If the file cannot be read, leaves open which column is what, or contradicts the specimen.
    """
    with channels.open_file(path, options) as opened_file:
        force_columns = find_counterforce_columns(opened_file.table, opened_file.options)
        if force_columns is None:
            channels.refuse_other_kinds(
                opened_file,
                ["csr"],
                "compression stress relaxation is",
                stated_columns=("time", "force"),
            )
        file = replace(opened_file, options=force_columns or opened_file.options)
        temperature_role = file.column("temperature")
        roles_wanted = channels.select_columns(file, ["time", "force"])
        channels_chosen = channels.add_units(
            file, [*roles_wanted, *([temperature_role] if temperature_role else [])]
        )
        loaded_columns = channels.load_test(file, channels_chosen, 1)
        is_complete = np.isfinite(loaded_columns.values).all(axis=1)
        specimens, methods = (
            read_text_column(file, names, loaded_columns)[is_complete]
            for names in (_SPECIMEN_COLUMNS, _METHOD)
        )
        rows, notes = channels.select_complete_rows(loaded_columns)
        _refuse_parts(file, channels_chosen[1].index, float(rows[:, 1].max()))
        values = channels.convert_signals_to_si(rows, channels_chosen)
        kelvin, sentences = _read_oven_temperatures(
            file, values.get("temperature"), specimen or Specimen(), len(rows)
        )
        number = np.unique(specimens, return_inverse=True)[1]
        if not specimens.any():
            number = np.cumsum(np.diff(values["time"], prepend=0.0) <= 0)
        read = {
            name.upper() for name in _METHOD_PATTERN.findall(" ".join(file.table.header).casefold())
        }
        read |= {word.strip()[-1:].upper() for word in methods.tolist()}
        source = channels.make_source(
            file,
            [channel.message for channel in channels_chosen],
            [*file.table.notes, *notes, *sentences],
        )
        return CSRTest(
            values["time"], values["force"], kelvin, number + 1,
            "".join(sorted(read & {"A", "B"})), source, units="SI",
        )  # fmt: skip


def _read_oven_temperatures(
    file: OpenedFile, column: FloatArray | None, specimen: Specimen, count: int
) -> tuple[FloatArray, list[str]]:
    """Return the temperature of every row, K: that of the column, of the header, or as given."""
    temperature = specimen.temperature
    if column is not None:
        max_deviation = 0.0 if temperature is None else float(np.abs(column - temperature).max())
        if temperature is not None and max_deviation > SAME_TEMPERATURE:
            low, high = celsius(float(column.min())), celsius(float(column.max()))
            raise ReadError(
                f"the column of temperature runs from {low} to {high}, and --temperature says "
                f"{celsius(temperature)}. Leave out --temperature, or mend the file"
            )
        return column, []
    value, sentences = add_specimen_temperature(file, specimen)
    if value.stated_temperature is not None:
        raise ReadError(
            f"the file says {celsius(value.stated_temperature)}, and --temperature "
            f"{celsius(value.temperature or 0.0)}. Leave out --temperature, or mend the file"
        )
    if value.temperature is None:
        raise ReadError(
            "the file says no temperature of its oven. Add one for each file, in their order: "
            "--temperature 125degC"
        )
    return np.full(count, value.temperature), sentences


def _refuse_parts(file: OpenedFile, index: int, largest: float) -> None:
    """Refuse a column in per cent whose values are parts of 1."""
    column = file.table.columns[index]
    if (
        is_ratio(column)
        and column.unit
        and units.is_same_unit(column.unit, "%")
        and largest <= _PER_CENT_LIMIT
    ):
        raise ReadError(
            f"'{column.name}' is said to be in %, and its largest value is {largest:.3g}, as of a "
            f"fraction. Write its unit as 1, or the values in %"
        )
