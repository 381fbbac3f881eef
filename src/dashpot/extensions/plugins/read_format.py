"""File format of a plug-in: bytes in, plain columns out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.extensions.plugins.contract import (
    get_items,
    get_text,
    get_texts,
    refuse_result,
    validate_keys,
)
from dashpot.reading.columns.header_units import split_unit
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox.limits import check_value_count
from dashpot.reading.table import Column, FileTable, make_loader
from dashpot.registry.plugins import Plugin, require_plugin

API = 1
"""The version of the contract, which a format states as its ``API``."""
_EXPECTED = (
    "{'columns': [{'name': ..., 'unit': ..., 'values': [...]}, ...]}, of one length and of numbers"
)
_KEYS, _COLUMN_KEYS = ("columns", "header", "notes"), ("name", "unit", "values")


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table that the plug-in ``options.format`` finds in a file.

    Raises
    ------
    ReadError
        If there is no such plug-in, it fails, or its result violates the contract.
    """
    plugin = require_plugin("formats", options.format or "")
    return make_table(plugin, plugin.load(), b"".join(raw.blocks()), raw.name)


def make_table(plugin: Plugin, module: Any, content: bytes, name: str) -> FileTable:
    """Return the table that the module of a format reads from a file's bytes, validated.

    Raises
    ------
    ReadError
        If it fails, or returns something else.
    """
    version = getattr(module, "API", None)
    if version != API:
        raise ReadError(
            f"{plugin.label} states API = {version!r}; this dashpot knows {API}. Ask who maintains "
            f"{plugin.package}"
        )
    try:
        entries = module.read(content, name=name)
    except Exception as error:  # noqa: BLE001  others' code may raise anything
        plugin.raise_failure(error)
    if not isinstance(entries, dict):
        refuse_result(plugin, f"a {type(entries).__name__}", _EXPECTED)
    validate_keys(plugin, entries, _KEYS)
    columns = get_items(plugin, entries, "columns")
    if not columns:
        refuse_result(plugin, "no columns", _EXPECTED)
    values = [_convert_values(plugin, column) for column in columns]
    lengths = sorted({len(value) for value in values})
    if len(lengths) > 1 or lengths[0] < 2:
        refuse_result(plugin, f"columns of {', '.join(map(str, lengths))} values", _EXPECTED)
    check_value_count(len(values) * lengths[0], "the file holds")
    return FileTable(
        format=plugin.full_label,
        columns=tuple(_make_column(plugin, column) for column in columns),
        load=make_loader(np.column_stack(values)),
        header=get_texts(plugin, entries, "header"),
        notes=(f"read by {plugin.label}", *get_texts(plugin, entries, "notes")),
    )


def _make_column(plugin: Plugin, item: Mapping[str, Any]) -> Column:
    name = get_text(plugin, item, "name")
    validate_keys(plugin, item, _COLUMN_KEYS, f" of the column '{name}'")
    unit = item.get("unit")
    return Column(name, get_text(plugin, item, "unit")) if unit else Column(*split_unit(name))


def _convert_values(plugin: Plugin, item: Mapping[str, Any]) -> FloatArray:
    """Return the numbers of a column; None and nan are blank cells."""
    name = get_text(plugin, item, "name")
    try:
        values = np.asarray(item.get("values"), dtype=float)
    except (TypeError, ValueError):
        refuse_result(plugin, f"column '{name}' whose values are not numbers", _EXPECTED)
    if values.ndim != 1:
        refuse_result(plugin, f"column '{name}' of {values.ndim} dimensions", _EXPECTED)
    return values
