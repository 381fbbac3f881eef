"""Parquet and Arrow files through polars; units from names or from the metadata of fields."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.array_table import NamedArray, gather, names_start
from dashpot.extensions.formats.arrow_schema import decode_parquet_schema, read_field_metadata
from dashpot.extensions.formats.attribute_factors import factors_among
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox.limits import check_value_count
from dashpot.reading.table import FileTable

_UNITS = ("unit", "units", "Unit", "Units", "unit_string", "UNIT")
_ARROW = b"ARROW1"
_LARGEST_SCHEMA = 1 << 22


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the columns of numbers, instants and durations of a file.

    Raises
    ------
    ReadError
        If polars is not installed, or no column holds numbers.
    """
    del options
    try:
        import polars as pl
    except ImportError:
        raise ReadError(
            'Parquet and Arrow files need the package polars; install it with pip install "dashpot'
            '[batch]"'
        ) from None
    arrow = raw.head(len(_ARROW)) == _ARROW
    if arrow:
        stated = read_field_metadata(raw.head(_LARGEST_SCHEMA)[8:])
        with raw.open() as stream:
            frame = pl.read_ipc(stream)
    else:
        stated = _read_parquet_metadata(pl.read_parquet_metadata(_source(raw)))
        lazy = pl.scan_parquet(_source(raw))
        rows = lazy.select(pl.len()).collect().item()
        check_value_count(rows * len(lazy.collect_schema()), "the columns hold")
        frame = lazy.collect()
    check_value_count(frame.height * frame.width, "the columns hold")
    arrays = [
        array
        for column in frame.iter_columns()
        if (array := _read_column(column, stated.get(column.name, {})))
    ]
    passed = [name for name in frame.columns if all(array.name != name for array in arrays)]
    notes = [f"column '{name}' holds no numbers and was passed over" for name in passed[:8]]
    return gather(arrays, format_="Arrow" if arrow else "Parquet", notes=notes)


def _read_column(column: Any, stated: dict[str, str]) -> NamedArray | None:
    """Return a column of numbers, or of time as seconds, None of anything else."""
    kind, unit = column.dtype, next((stated[key] for key in _UNITS if stated.get(key)), None)
    start = "".join(f"{key} = {value}" for key, value in stated.items() if names_start(key))
    if kind.is_temporal():
        word = str(kind).partition("(")[0]
        if word not in {"Datetime", "Duration"}:  # a day, or a time of an unknown day
            return None
        if word == "Datetime":
            column -= column.min()
        seconds = column.dt.total_nanoseconds().cast(float) * 1e-9
        return NamedArray(column.name, seconds.to_numpy(), "s")
    if not kind.is_numeric():
        return None
    values = column.cast(float).to_numpy(allow_copy=True)
    return NamedArray(column.name, values, unit, factor=factors_among(stated), start=start)


def _source(raw: RawFile) -> Path | BytesIO:
    """Return what polars reads: the path of a large file, which is not held in memory."""
    return raw.path if raw.path is not None and not raw.held else BytesIO(raw.held)


def _read_parquet_metadata(entries: dict[str, str]) -> dict[str, dict[str, str]]:
    schema = entries.get("ARROW:schema", "")
    return read_field_metadata(decode_parquet_schema(schema)) if schema else {}
