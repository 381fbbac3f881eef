"""TA Instruments TRIOS exports in JSON: steps of named columns with units."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any, TypeAlias

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits
from dashpot.reading.table import Column, FileTable, make_loader

_MAX_SIZE = 1 << 28
_MAX_DEPTH = 20
_Set: TypeAlias = tuple[str, tuple[tuple[str, str], ...], list[list[float]]]


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the data sets of a TRIOS JSON file, joined as segments where their columns agree.

    Raises
    ------
    ReadError
        If it is not such a file, or its data sets differ in their columns.
    """
    sets = _parse_data_sets(raw)
    if options.sheet is not None:
        sets = [entry for entry in sets if entry[0] == options.sheet] or sets
    names, heads, values = zip(*sets, strict=True)
    columns = heads[0]
    if len(set(heads)) > 1:
        names_text = ", ".join(f"'{name}'" for name in names[:6])
        raise ReadError(
            f"results {names_text} have different columns; choose one with --file-part sheet=NAME"
        )
    rows = [np.asarray(part, dtype=float).reshape(-1, len(columns)) for part in values]
    starts = np.cumsum([0, *map(len, rows[:-1])])
    return FileTable(
        format="TRIOS JSON",
        columns=tuple(Column(name, unit or None) for name, unit in columns),
        load=make_loader(np.concatenate(rows), tuple(map(int, starts)), names),
    )


def _parse_data_sets(raw: RawFile) -> list[_Set]:
    if raw.size > _MAX_SIZE:
        raise ReadError(f"a JSON file of {raw.size} bytes; export it as text instead")
    try:
        sets = list(_data_sets(json.loads(raw.head(raw.size).decode("utf-8-sig"))))
    except (ValueError, RecursionError) as error:
        raise ReadError(f"not valid JSON: {error}") from None
    if not sets:
        raise ReadError(
            "JSON, but no TRIOS data found (expected 'columns' with 'name' and "
            "'unit', and 'values'); dashpot's own results are read by the commands that take FIT"
        )
    return sets


def _data_sets(node: Any, name: str = "", depth: int = 0) -> Iterator[_Set]:
    """Every ``{"columns": [...], "values": [...]}`` in the document, with the nearest name."""
    children: Iterable[Any] = node if isinstance(node, list) else ()
    if isinstance(node, dict):
        properties = node.get("Properties", node)
        name = str(properties.get("Name", name)) if isinstance(properties, dict) else name
        if _table_like(node):
            heads = tuple((str(c["name"]), str(c.get("unit") or "")) for c in node["columns"])
            limits.check_value_count(len(heads) * len(node["values"]), "a data set holds")
            yield name, heads, [_row(row, len(heads)) for row in node["values"]]
            return
        children = node.values()
    for child in children if depth < _MAX_DEPTH else ():
        yield from _data_sets(child, name, depth + 1)


def _table_like(node: dict[str, Any]) -> bool:
    columns, values = node.get("columns"), node.get("values")
    return (
        isinstance(columns, list)
        and isinstance(values, list)
        and bool(columns and values)
        and all(isinstance(column, dict) and "name" in column for column in columns)
        and all(isinstance(row, list) for row in values)
    )


def _row(row: list[Any], width: int) -> list[float]:
    """Return a row of this length; NaN for missing or invalid numbers."""
    numbers = [_number(value) for value in row[:width]]
    return numbers + [float("nan")] * (width - len(numbers))


def _number(value: Any) -> float:
    try:
        return float(value) if isinstance(value, int | float) else float("nan")
    except OverflowError:  # JSON's integers have no end
        return float("nan")
