"""HDF5 files, MATLAB's version 7.3 among them, through h5py."""

from __future__ import annotations

from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.io.formats.gathering import Named, gather, real
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw, extra
from dashpot.io.table import Table

_UNIT = ("unit", "units", "Unit", "Units", "unit_string", "UNIT")
_NAMES = ("columns", "names", "channels", "column_names", "fields")
_INNER = {"data", "values"}
_TEXT = 1000
_LARGEST = 1 << 28
"""Values in one dataset; a small file can claim any number of them."""


def read(raw: Raw, options: ReadOptions) -> Table:
    """Return the datasets of an HDF5 file, or of the group ``options.sheet``, as a table.

    Units are read from the attribute ``unit`` or ``units``, or from a text dataset of that name
    beside the data (as MATLAB structs become).
    """
    h5py = extra("h5py", "h5py", "HDF5 or MAT 7.3 files")
    with raw.open() as stream, h5py.File(stream, "r") as file:
        group: Any = file
        if options.sheet is not None:
            if options.sheet not in file:
                raise ReadError(
                    f"--sheet {options.sheet}: there is no such group; there are "
                    f"{', '.join(list(file)[:10])}"
                )
            group = file[options.sheet]
        arrays: list[Named] = []
        notes: list[str] = []
        _walk(group, "", arrays, notes)
    matlab = raw.head(10) == b"MATLAB 7.3"
    return gather(arrays, format_="MAT 7.3" if matlab else "HDF5", notes=notes)


def _walk(node: Any, name: str, arrays: list[Named], notes: list[str]) -> None:
    if hasattr(node, "dtype"):
        if node.size is not None and node.size <= _LARGEST:
            arrays += _dataset(node, name)
        else:
            notes.append(f"'{name}' with {node.size} values was passed over")
        return
    for key, child in node.items():
        if not key.startswith("#") and key not in _UNIT:
            _walk(child, f"{name}.{key}".strip("."), arrays, notes)


def _dataset(node: Any, name: str) -> list[Named]:
    """The numbers of one dataset, parted where its columns or fields have names."""
    if node.dtype.names:
        whole = node[()]
        fields = ((field, real(whole[field])) for field in node.dtype.names)
        return [Named(field, numbers) for field, numbers in fields if numbers is not None]
    text = _word(node.attrs.get("MATLAB_class")) == "char"
    numbers = None if text or node.dtype.kind not in "iufb" else real(node[()])
    if numbers is None:
        return []
    unit = _unit(node)
    return _parted(node, name, numbers) or [Named(_stem(name) if unit else name, numbers, unit)]


def _parted(node: Any, name: str, numbers: FloatArray) -> list[Named]:
    """The columns of a matrix by the names in an attribute, if it has one for each."""
    names = next((node.attrs[key] for key in _NAMES if key in node.attrs), None)
    if names is None or numbers.ndim != 2 or len(names) not in numbers.shape:
        return []
    tall = numbers if numbers.shape[1] == len(names) else numbers.T
    return [Named(_word(n) or name, tall[:, i]) for i, n in enumerate(names)]


def _stem(name: str) -> str:
    """The struct that ``struct.data`` is the numbers of."""
    stem, _, last = name.rpartition(".")
    return stem if stem and last in _INNER else name


def _unit(node: Any) -> str | None:
    for key in _UNIT:
        if key in node.attrs:
            return _word(node.attrs[key])
    for key in _UNIT:
        beside = node.parent.get(key) if node.name.rsplit("/", 1)[-1] in _INNER else None
        if beside is not None and beside.size < _TEXT:
            return _word(beside[()])
    return None


def _word(value: Any) -> str | None:
    """Text from what HDF5 and MATLAB keep it in: bytes, str, or an array of character codes."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, str):
        return value
    if isinstance(value, np.ndarray) and value.size and value.dtype.kind == "u":
        return "".join(map(chr, value.ravel().tolist()))
    if isinstance(value, np.ndarray) and value.size == 1:
        return _word(value.ravel()[0])
    return None
