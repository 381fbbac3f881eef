"""MATLAB files up to version 7, through SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.io.formats.gathering import Named, gather, real
from dashpot.io.formats.matfile import check_elements
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw
from dashpot.io.table import Table

_DATA = ("data", "values", "value", "y", "signal")
_UNIT = ("unit", "units", "unit_string", "label_unit")


def read(raw: Raw, options: ReadOptions) -> Table:
    """Return the vectors of a MAT file as a table; a struct's fields are named ``struct.field``."""
    from scipy.io import loadmat

    with raw.open() as stream:
        check_elements(stream, raw.name)
        content: dict[str, Any] = loadmat(stream, simplify_cells=True)  # type: ignore[arg-type]
    arrays: list[Named] = []
    for name, value in content.items():
        if not name.startswith("__"):
            flatten(name, value, arrays)
    if options.sheet is not None:
        arrays = [array for array in arrays if array.name.startswith(options.sheet)]
        if not arrays:
            raise ReadError(f"{raw.name}: --sheet {options.sheet}: there is no such variable")
    return gather(arrays, file=raw.name, format_="MAT")


def flatten(name: str, value: Any, arrays: list[Named], depth: int = 0) -> None:
    """Append the arrays in a variable, a struct or a cell; a struct may hold data and unit."""
    if isinstance(value, dict) and depth < 8:
        folded = {str(key).casefold(): key for key in value}
        data = next((folded[key] for key in _DATA if key in folded), None)
        unit = next((value[folded[key]] for key in _UNIT if key in folded), None)
        numbers = None if data is None else real(value[data])
        if numbers is not None and isinstance(unit, str):
            arrays.append(Named(name, numbers, unit))
            return
        for key, entry in value.items():
            flatten(f"{name}.{key}", entry, arrays, depth + 1)
    elif isinstance(value, list) and depth < 8:
        for i, entry in enumerate(value):
            flatten(f"{name}.{i + 1}", entry, arrays, depth + 1)
    elif isinstance(value, int | float | np.ndarray | np.number):
        numbers = real(value)
        if numbers is not None:
            arrays.append(Named(name, numbers))
