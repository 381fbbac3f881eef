"""Parquet and Arrow files through polars; units from names or from metadata."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.array_table import (
    NamedArray,
    gather,
    names_start,
    stated_rate,
    window_line,
)
from dashpot.extensions.formats.arrow_schema import decode_parquet_schema, read_schema_metadata
from dashpot.extensions.formats.attribute_factors import (
    apply_attributes,
    concerns_numbers,
    stated_numbers,
    stated_unit,
)
from dashpot.extensions.formats.passed_channels import note_passed
from dashpot.extensions.formats.specimens import LABELS, format_labels, names_specimen
from dashpot.extensions.formats.stated_metadata import assign_metadata, find_stated_unit
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox.limits import check_value_count
from dashpot.reading.table import FileTable
from dashpot.registry import format_install_command

_ARROW, _STREAM = b"ARROW1", b"\xff\xff\xff\xff"
_LARGEST_SCHEMA = 1 << 22
_TEXT = {"String", "Categorical", "Enum"}


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the columns of numbers, instants and durations of a file.

    A factor, fill value, full scale or clock in its metadata is applied, noted or questioned as in
    other formats; no rule of Parquet or Arrow applies a factor.

    Raises
    ------
    ReadError
        If polars is not installed, or no column holds numbers.
    """
    try:
        import polars as pl
    except ImportError:
        advice = format_install_command("batch")
        raise ReadError(
            f"Parquet and Arrow files need the package polars; install it with: {advice}"
        ) from None
    head = raw.head(len(_ARROW))
    if head == _ARROW or head.startswith(_STREAM):
        form, start = ("Arrow", 8) if head == _ARROW else ("Arrow stream", 0)
        schema_metadata, fields = read_schema_metadata(raw.head(_LARGEST_SCHEMA)[start:])
        with raw.open() as stream:
            frame = pl.read_ipc(stream) if start else pl.read_ipc_stream(stream)
    else:
        form = "Parquet"
        schema_metadata = pl.read_parquet_metadata(_get_polars_source(raw))
        schema = schema_metadata.pop("ARROW:schema", "")
        fields = read_schema_metadata(decode_parquet_schema(schema))[1] if schema else {}
        lazy = pl.scan_parquet(_get_polars_source(raw))
        rows = lazy.select(pl.len()).collect().item()
        check_value_count(rows * len(lazy.collect_schema()), "the columns hold")
        frame = lazy.collect()
    check_value_count(frame.height * frame.width, "the columns hold")
    metadata = assign_metadata(schema_metadata, fields, frame.columns)
    arrays: list[NamedArray] = []
    notes: list[str] = []
    for column in frame.iter_columns():
        entries = metadata.columns[column.name]
        array = _read_column(column, entries, notes)
        arrays += [] if array is None else [array, *_list_rates(f"{column.name}.", entries)]
    labels = _number_labels(frame, arrays)
    array_names = [array.name for array in arrays]
    skipped_columns = {name: "no numbers" for name in frame.columns if name not in array_names}
    arrays += _list_rates("", metadata.table)
    arrays += [
        NamedArray(key, np.array(values))
        for key, value in metadata.table.items()
        if concerns_numbers(key.rpartition(".")[2]) and (values := stated_numbers(value))
    ]
    return gather(
        arrays, format_=form, notes=[*notes, *note_passed(skipped_columns, array_names)],
        rate=options.rate, header=[
            *labels,
            *(line for key, value in metadata.table.items() if (line := window_line(key, value))),
        ],
    )  # fmt: skip


def _number_labels(frame: Any, arrays: list[NamedArray]) -> list[str]:
    """Add the labels of specimens as numbers to the arrays; return the label of each number."""
    lines = []
    for column in frame.iter_columns():
        if str(column.dtype).partition("(")[0] in _TEXT and names_specimen(column.name):
            numbers, labels_text = format_labels([str(cell or "") for cell in column.to_list()])
            arrays.append(NamedArray(column.name, np.array(numbers, float)))
            lines.append(f"{LABELS}{column.name}: {labels_text}")
    return lines


def _read_column(column: Any, metadata: Mapping[str, Any], notes: list[str]) -> NamedArray | None:
    """Return a column of numbers, or of time as seconds; None for other types."""
    kind, name = column.dtype, column.name
    start = ", ".join(f"{key} = {value}" for key, value in metadata.items() if names_start(key))
    if kind.is_temporal():
        word = str(kind).partition("(")[0]
        if word not in {"Datetime", "Duration"}:  # a date, or a time without a date
            return None
        if word == "Datetime":
            column -= column.min()
        seconds = column.dt.total_nanoseconds().cast(float) * 1e-9
        return NamedArray(name, seconds.to_numpy(), "s")
    if not kind.is_numeric() and str(kind) != "Boolean":
        return None
    values = column.cast(float).to_numpy(allow_copy=True)
    values, factor = apply_attributes(name, values, metadata, notes)
    return NamedArray(
        name, values, find_stated_unit(metadata), stated_factor=factor, stated_start=start
    )


def _list_rates(owner: str, metadata: Mapping[str, Any]) -> list[NamedArray]:
    """Return the rate or the time step in metadata, as single numbers."""
    return [
        NamedArray(f"{owner}{key}", np.array(values[0]), stated_unit(value))
        for key, value in metadata.items()
        if stated_rate(key.rpartition(".")[2], 1.0) and len(values := stated_numbers(value)) == 1
    ]


def _get_polars_source(raw: RawFile) -> Path | BytesIO:
    """Return the source for polars: the path of a large file, which is not loaded into memory."""
    return raw.path if raw.path is not None and not raw.content else BytesIO(raw.content)
