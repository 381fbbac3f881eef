"""Metadata of a table and of its columns, as text or JSON, assigned to the columns."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from dashpot.base import units
from dashpot.reading.columns.header_units import join_units

Path: TypeAlias = tuple[str, ...]
_UNITS = {"unit", "units", "unitstring", "uom", "einheit", "einheiten", "physicalunit", "yunit"}
"""Names of a unit, without signs."""
_NAMES = ("name", "field_name", "column", "channel", "field", "id")
"""Keys of an object in a list that name its column."""
_IGNORED = {"ARROW:schema", "huggingface", "geo"}
_MAX_DEPTH, _MAX_ENTRIES, _MAX_LENGTH = 6, 2000, 1 << 20
_SIGNS = re.compile(r"[.:/|]")


@dataclass
class StatedMetadata:
    """Metadata by column and of the table.

    Attributes
    ----------
    columns : dict of str to dict
        Entries of each column by its name.
    table : dict of str to value
        Entries of no column.
    """

    columns: dict[str, dict[str, Any]] = field(default_factory=dict)
    table: dict[str, Any] = field(default_factory=dict)


def assign_metadata(
    table: Mapping[str, str], fields: Mapping[str, Mapping[str, str]], names: Sequence[str]
) -> StatedMetadata:
    """Return the metadata of a table and of its fields by column, with JSON decoded.

    >>> stated = assign_metadata({"units": '{"force": "N"}', "gain": "10"}, {}, ["force"])
    >>> stated.columns, stated.table
    ({'force': {'units': 'N'}}, {'gain': '10'})
    """
    metadata = StatedMetadata({name: {} for name in names})
    names_by_lower_case = {name.casefold(): name for name in names}
    for name, entries in fields.items():
        for path, value in _flatten_entries(entries):
            metadata.columns.setdefault(name, {})[".".join(path)] = value
    for path, value in _flatten_entries(table):
        column_index = next(
            (i for i, part in enumerate(path) if part.casefold() in names_by_lower_case), None
        )
        if column_index is None:
            _assign_by_prefix(path, value, names_by_lower_case, metadata)
        else:
            key = ".".join(path[column_index + 1 :]) or path[column_index - 1]
            _add_value(
                metadata.columns[names_by_lower_case[path[column_index].casefold()]], key, value
            )
    return metadata


def _assign_by_prefix(
    path: Path, value: Any, names_by_lower_case: Mapping[str, str], metadata: StatedMetadata
) -> None:
    """Give ``force_unit`` and ``unit_force`` to the column, anything else to the table."""
    word = path[-1].casefold()
    for name, column in names_by_lower_case.items():
        key = word.removeprefix(f"{name}_") if word != name else ""
        key = key if key != word else word.removesuffix(f"_{name}")
        if key and key != word and _remove_signs(key) in _UNITS:
            _add_value(metadata.columns[column], key, value)
            return
    metadata.table[".".join(path)] = value


def _add_value(entries: dict[str, Any], key: str, value: Any) -> None:
    """Add a value to those stated under the same name."""
    entries[key if entries.get(key, value) == value else f"{key} "] = value


def find_stated_unit(entries: Mapping[str, Any]) -> str | None:
    """Return the stated unit; if two differ, both.

    >>> find_stated_unit({"Unit": "N"}), find_stated_unit({"unit": "N", "meta.units": "kN"})
    ('N', 'N or kN')
    """
    unit = None
    for key, value in entries.items():
        word = str(value).strip()
        if _remove_signs(key.rpartition(".")[2]) not in _UNITS or not word or value is None:
            continue
        is_same_unit = unit is None or units.is_same_unit(unit, word)
        unit = word if is_same_unit else join_units(unit or "", word)
    return unit


def _remove_signs(key: str) -> str:
    return "".join(filter(str.isalpha, key.casefold()))


def _flatten_entries(entries: Mapping[str, str]) -> Iterator[tuple[Path, Any]]:
    for count, (key, text) in enumerate(entries.items()):
        if key in _IGNORED or count > _MAX_ENTRIES:
            continue
        value = _decode(text)
        if key == "pandas":  # contains types, and under "attributes" the entries of the user
            value = value.get("attributes", {}) if isinstance(value, dict) else {}
        yield from _flatten(tuple(_SIGNS.split(key)), value)


def _decode(text: str) -> Any:
    """Return the value of JSON; of another text the text itself."""
    if text[:1] not in {"{", "["} or len(text) > _MAX_LENGTH:
        return text
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _flatten(path: Path, value: Any) -> Iterator[tuple[Path, Any]]:
    if len(path) > _MAX_DEPTH + 4:
        return
    if isinstance(value, dict):
        for key, inner in list(value.items())[:_MAX_ENTRIES]:
            yield from _flatten((*path, *_SIGNS.split(str(key))), inner)
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for item in value[:_MAX_ENTRIES]:
            if not isinstance(item, dict):
                continue
            name = next((item[key] for key in _NAMES if isinstance(item.get(key), str)), None)
            yield from _flatten(path if name is None else (*path, name), item)
    elif value is not None:
        yield path, value
