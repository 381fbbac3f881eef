"""Records in memory: tables of pandas, polars and xarray, mappings of arrays, and bare arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime
from decimal import Decimal
from math import isnan
from numbers import Real
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from dashpot.api.read_save import ReadOptionKeywords, inspect, read
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError, ReadError
from dashpot.base.units import find_unit
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.extensions.formats.attribute_factors import factors_among
from dashpot.extensions.formats.specimens import LABELS, format_labels, names_specimen
from dashpot.extensions.formats.stated_metadata import find_stated_unit
from dashpot.reading.columns.header_units import split_heading
from dashpot.signals.segments import classify_load_history

if TYPE_CHECKING:
    from dashpot.workflow.inspections import InspectedFile

_NUMBERS, _INSTANTS, _SPANS = "iuf", "M", "m"
_HINT = 'dp.read(frame, columns={"force": "F"}, units={"force": "N"})'
_PART_ROLES, _MATERIAL_ROLES = ("time", "displacement", "force"), ("time", "strain", "stress")
_LINE = 'dp.fit(time, displacement, force, units="s, mm, N")'


def read_frame(frame: Any, *, kind: str | None = None, **keywords: Any) -> Any:
    """Return the record in a table in memory, read as a text file of its columns would be.

    Units stand in names (``"force [N]"``), in ``attrs`` of variables of xarray, or in
    ``frame.attrs["units"]`` of pandas; contradictory ones raise a question. Instants become seconds
    since the first.

    Raises
    ------
    ReadError
        As :func:`dashpot.read` of a file.
    DataError
        If no column holds numbers, or columns differ in length.
    """
    with _write_temporary_file(frame) as path:
        return read(path, kind=kind, **_name_units(frame, keywords))


def inspect_frame(frame: Any, *, kind: str | None = None, **keywords: Any) -> InspectedFile:
    """Return how a table in memory would be read, as :func:`dashpot.inspect` does for a file.

    Raises
    ------
    ReadError, DataError
        As :func:`read_frame`.
    """
    with _write_temporary_file(frame) as path:
        return inspect(path, kind=kind, **_name_units(frame, keywords))


def refuse_array(array: Any, **_: Any) -> None:
    """Refuse a bare array, whose columns have neither names nor units.

    Raises
    ------
    DataError
    """
    raise DataError(
        f"an array of shape {array.shape} has no names of columns. Give a DataFrame with named "
        f"columns, or one array each: {_LINE}"
    )


def refuse_value(value: object, **_: Any) -> None:
    """Refuse a value that is neither a file name nor a table.

    Raises
    ------
    DataError
    """
    raise DataError(
        f"{value!r} is no file and no table. Give the name of a file, or a table or a mapping with "
        'named columns: dp.read("seal.csv"), dp.read(frame)'
    )


def _name_units(frame: Any, keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the keywords, with units that were listed as text named by the columns they are of.

    Raises
    ------
    DataError
        If they are not as many as the columns.
    """
    if not isinstance(keywords.get("units"), str):
        return keywords
    names = [name for name, _, _ in _iterate_columns(frame)]
    words = _list_stated_units(keywords["units"])
    if len(words) != len(names):
        raise DataError(
            f"units lists {len(words)} units, and the table has {len(names)} columns of numbers "
            f"({', '.join(names[:6])}). Name them, as {_HINT}"
        )
    return keywords | {"units": dict(zip(names, words, strict=True))}


@contextmanager
def _write_temporary_file(frame: Any) -> Iterator[Path]:
    """Write the columns of a table as text for as long as it is read; errors name the table."""
    columns = list(_iterate_columns(frame))
    if not columns:
        raise DataError(f"this {type(frame).__name__} has no column of numbers")
    if len({len(values) for _, values, _ in columns}) > 1:
        counts = ", ".join(f"'{name}' {len(values)}" for name, values, _ in columns[:6])
        raise DataError(f"its columns differ in length ({counts}): give those of one clock")
    header_lines, header = [], []
    for name, _, metadata in columns:
        stem, unit = split_heading(name, find_stated_unit(metadata))
        factor = factors_among(metadata)
        header.append(f"{stem} [{unit}]" if unit else name)
        header_lines += [f"{LABELS}{name}: {metadata[LABELS]}"] if LABELS in metadata else []
        header_lines += [f"# factor stated of {name}: {factor}"] if factor else []
    cells = [
        ["" if isnan(value) else repr(value) for value in values.tolist()]
        for _, values, _ in columns
    ]
    lines = [*header_lines, "\t".join(header), *map("\t".join, zip(*cells, strict=True))]
    with TemporaryDirectory() as folder:
        path = Path(folder) / type(frame).__name__
        path.write_text("\n".join(lines) + "\n", "utf-8")
        try:
            yield path
        except ReadError as error:
            text = str(error).replace(f'"{path}"', "frame").replace(str(path), path.name)
            raise ReadError(text) from None


def make_records(values: Sequence[Any], options: dict[str, Any]) -> list[Any]:
    """Return the records of tables or arrays in memory; reading options are removed.

    Three arrays, or lists of numbers, are time, displacement and force, or by their units time,
    strain and stress, of the test that they show.

    Raises
    ------
    DataError
        If arrays are not three, or have no units.
    """
    values = [_convert_column(value) for value in values]
    if isinstance(values[0], np.ndarray):
        if len(values) != 3 or not all(isinstance(value, np.ndarray) for value in values):
            raise DataError(f"{len(values)} arrays are no test. Give three: {_LINE}")
        if "units" not in options:
            raise DataError(f"arrays have no units. Say them: {_LINE}")
        return [_make_record(values, options.pop("units"))]
    if isinstance(values[0], list):  # of records, which are given one by one
        return values
    names = ReadOptionKeywords.__annotations__.keys() & options.keys()
    keywords = {name: options.pop(name) for name in names & {"units", "columns", "part", "rate"}}
    return [
        value if hasattr(value, "source") else read_frame(value, **keywords) for value in values
    ]


def _convert_column(value: Any) -> Any:
    """Return a list of numbers or a column of a table as an array, anything else as it is."""
    if isinstance(value, list):
        is_column = bool(value) and all(isinstance(element, Real) for element in value)
    else:
        is_column = getattr(value, "ndim", 1) == 1 and hasattr(value, "to_numpy")
    try:
        return np.asarray(value, float) if is_column else value
    except (TypeError, ValueError):
        raise DataError(
            f"a {type(value).__name__} of {len(value)} values holds some that are no numbers. Give "
            f"one column of numbers each: {_LINE}"
        ) from None


def _make_record(arrays: list[Any], units: Any) -> Any:
    """Return the test of three arrays, detected by their units and their motion."""
    words = _list_stated_units(units)
    is_material = len(words) == len(arrays) and find_unit(words[1], "strain") is not None
    if not is_material:
        time, displacement, force = arrays
        test = RelaxationTest(time, displacement, force, units=", ".join(words))
        load_history = classify_load_history(test.time, test.displacement, test.force)
        if load_history in {"relaxation", "still", "other"}:
            return test
    roles = _MATERIAL_ROLES if is_material else _PART_ROLES
    return read_frame(
        dict(zip(roles, arrays, strict=True)), units=dict(zip(roles, words, strict=True))
    )


def _list_stated_units(units: Any) -> list[str]:
    """Return the units of three arrays in their order, from ``"s, mm, N"`` or a mapping by role."""
    if not isinstance(units, Mapping):
        return [word.strip() for word in str(units).split(",")]
    for roles in (_PART_ROLES, _MATERIAL_ROLES):
        if units.keys() == set(roles):
            return [str(units[role]) for role in roles]
    raise DataError(
        f"units of three arrays are of {', '.join(_PART_ROLES)}, "
        f"or of {', '.join(_MATERIAL_ROLES)}: {_LINE}"
    )


def _iterate_columns(frame: Any) -> Iterator[tuple[str, FloatArray, dict[str, Any]]]:
    """Yield the name, the numbers and the attributes of each column of numbers or instants."""
    for name, column, metadata in _iterate_raw_columns(frame):
        values = _convert_objects(np.asarray(column))
        if values.dtype.kind == _INSTANTS:
            values = values - values[:1]
        if values.dtype.kind in _INSTANTS + _SPANS:
            yield _clean_name(name), values / np.timedelta64(1, "s"), {"unit": "s"}
        elif values.dtype.kind in "OUT" and names_specimen(_clean_name(name)):
            labels = ["" if _is_missing(value) else str(value) for value in values.ravel()]
            numbers, labels_text = format_labels(labels)
            yield _clean_name(name), np.asarray(numbers, float), {LABELS: labels_text}
        elif values.dtype.kind in _NUMBERS:
            yield _clean_name(name), np.asarray(values, float).ravel(), metadata


def _convert_objects(values: np.ndarray) -> np.ndarray:
    """Convert objects that are all numbers, or all instants with a time zone."""
    if values.dtype.kind != "O":
        return values
    present_values = [value for value in values.ravel() if not _is_missing(value)]
    if present_values and all(isinstance(value, Real | Decimal) for value in present_values):
        return values.astype(float)
    if present_values and all(isinstance(value, datetime) for value in present_values):
        seconds = [
            np.nan if _is_missing(value) else (value - present_values[0]).total_seconds()
            for value in values.ravel()
        ]
        return np.round(1e9 * np.asarray(seconds)).astype("timedelta64[ns]")
    return values


def _is_missing(value: Any) -> bool:
    """Return whether a cell is None, NaN or NaT; the last two differ from themselves."""
    return value is None or bool(value != value)  # noqa: PLR0124


def _clean_name(name: Any) -> str:
    """Return a name (of one or several levels) as one line without tabs."""
    return " ".join(" ".join(map(str, name if isinstance(name, tuple) else (name,))).split())


def _iterate_raw_columns(frame: Any) -> Iterator[tuple[Any, Any, dict[str, Any]]]:
    """Yield the name, the values and the attributes of each column, equal names apart."""
    if hasattr(frame, "data_vars"):  # xarray
        for name, variable in [*frame.coords.items(), *frame.data_vars.items()]:
            if variable.ndim == 1:
                yield name, variable.to_numpy(), dict(variable.attrs)
        return
    attributes = getattr(frame, "attrs", {})
    units = attributes.get("units", {})
    units = units if isinstance(units, Mapping) else {}
    index = getattr(frame, "index", None)
    index_name = getattr(index, "name", None)
    if index_name or _convert_objects(np.asarray(index)).dtype.kind in _INSTANTS + _SPANS:
        yield (
            index_name or "time",
            index,
            {"unit": units.get(index_name)} if index_name in units else {},
        )
    columns = frame.items() if hasattr(frame, "items") else zip(frame.columns, frame, strict=True)
    for name, column in columns:
        yield name, column, {"unit": units[name]} if name in units else {}
