"""Records in memory: tables of pandas, polars and xarray, mappings of arrays, and bare arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isnan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from dashpot.api.read_save import ReadOptionKeywords, read
from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.extensions.formats.attribute_factors import factors_among
from dashpot.extensions.formats.stated_metadata import find_stated_unit

_NUMBERS, _INSTANTS, _SPANS = "iuf", "M", "m"
_HINT = 'dp.read(frame, columns={"force": "F"}, units={"force": "N"})'
_LINE = 'dp.fit(time, displacement, force, units="s, mm, N")'


def read_frame(frame: Any, *, kind: str | None = None, **keywords: Any) -> Any:
    """Return the record in a table in memory, read as a text file of its columns would be.

    Units stand in names (``"force [N]"``), in ``attrs`` of variables of xarray, or in
    ``frame.attrs["units"]`` of pandas. Instants become seconds since the first.

    Raises
    ------
    ReadError
        As :func:`dashpot.read` of a file.
    DataError
        If no column holds numbers, or columns differ in length.
    """
    columns = list(_iterate_columns(frame))
    if not columns:
        raise DataError(f"this {type(frame).__name__} has no column of numbers")
    if len({len(values) for _, values, _ in columns}) > 1:
        counts = ", ".join(f"'{name}' {len(values)}" for name, values, _ in columns[:6])
        raise DataError(f"its columns differ in length ({counts}): give those of one clock")
    above, head = [], []
    for name, _, stated in columns:
        unit, factor = find_stated_unit(stated), factors_among(stated)
        head.append(f"{name} [{unit}]" if unit else name)
        above += [f"# factor stated of {name}: {factor}"] if factor else []
    cells = [
        ["" if isnan(value) else repr(value) for value in values.tolist()]
        for _, values, _ in columns
    ]
    lines = [*above, "\t".join(head), *map("\t".join, zip(*cells, strict=True))]
    with TemporaryDirectory() as folder:
        path = Path(folder) / type(frame).__name__
        path.write_text("\n".join(lines) + "\n", "utf-8")
        try:
            return read(path, kind=kind, **keywords)
        except ReadError as error:
            text = str(error).replace(str(path), path.name)
            hint = f" (Python: {_HINT})" if "--" in text else ""
            raise ReadError(text + hint) from None


def make_records(values: Sequence[Any], options: dict[str, Any]) -> list[Any]:
    """Return the records that tables or arrays in memory are; options that say how are taken out.

    Three arrays are time, displacement and force of a relaxation test.

    Raises
    ------
    DataError
        If arrays are not three, or have no units.
    """
    if isinstance(values[0], np.ndarray):
        if len(values) != 3 or not all(isinstance(value, np.ndarray) for value in values):
            raise DataError(f"{len(values)} arrays are no test. Give three: {_LINE}")
        if "units" not in options:
            raise DataError(f"arrays have no units. Say them: {_LINE}")
        time, displacement, force = values
        return [RelaxationTest(time, displacement, force, units=options.pop("units"))]
    said = ReadOptionKeywords.__annotations__.keys() & options.keys() & {"units", "columns", "rate"}
    keywords = {name: options.pop(name) for name in said}
    return [
        value if hasattr(value, "source") else read_frame(value, **keywords) for value in values
    ]


def _iterate_columns(frame: Any) -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """Yield the name, the numbers and the attributes of each column of numbers or instants."""
    for name, column, stated in _raw_columns(frame):
        values = np.asarray(column)
        if values.dtype.kind == _INSTANTS:
            values = values - values[:1]
        if values.dtype.kind in _INSTANTS + _SPANS:
            yield _clean(name), values / np.timedelta64(1, "s"), {"unit": "s"}
        elif values.dtype.kind in _NUMBERS:
            yield _clean(name), np.asarray(values, float).ravel(), stated


def _clean(name: Any) -> str:
    """Return a name as one line without tabs."""
    return " ".join(str(name).split())


def _raw_columns(frame: Any) -> Iterator[tuple[Any, Any, dict[str, Any]]]:
    if hasattr(frame, "data_vars"):  # xarray
        for name, variable in [*frame.coords.items(), *frame.data_vars.items()]:
            if variable.ndim == 1:
                yield name, variable.to_numpy(), dict(variable.attrs)
        return
    attributes = getattr(frame, "attrs", {})
    units = attributes.get("units", {})
    units = units if isinstance(units, Mapping) else {}
    index = getattr(frame, "index", None)
    named = getattr(index, "name", None)
    if named or np.asarray(index).dtype.kind in _INSTANTS + _SPANS:
        yield named or "time", index, {"unit": units.get(named)} if named in units else {}
    for name in frame.keys() if isinstance(frame, dict) else frame.columns:
        yield name, frame[name], {"unit": units[name]} if name in units else {}
