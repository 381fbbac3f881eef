"""HDF5 files, MATLAB's version 7.3 among them, through h5py."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import ReadError
from dashpot.io.child import limits
from dashpot.io.formats.gathering import Named, gather, numbers
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw, extra
from dashpot.io.table import FileTable

_UNIT = ("unit", "units", "Unit", "Units", "unit_string", "UNIT")
_NAMES = ("columns", "names", "channels", "column_names", "fields")
_INNER = {"data", "values"}
_COMPLEX = ("real", "imag")
"""The fields that MATLAB writes a complex number in."""
_TEXT = 1000
_NUMERIC = "iufbcV"
"""Kinds of NumPy types that may hold numbers, records among them."""
_FOREIGN = "it is data of another file, which this file's hash does not cover; save both as one"


@dataclass
class _Walked:
    """What a walk has found, and the objects it has been to: links may lead in circles."""

    datasets: list[tuple[Any, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    visited: set[tuple[int, int]] = field(default_factory=set)
    numbers: int = 0


def read(raw: Raw, options: ReadOptions) -> FileTable:
    """Return the datasets of an HDF5 file, or of the group ``options.sheet``, as a table.

    Units are read from the attribute ``unit`` or ``units``, or from a text dataset of that name
    beside the data (as MATLAB structs become).

    Raises
    ------
    ReadError
        If there is no such group, or numbers stand in another file (external links and storage,
        virtual datasets).
    """
    h5py = extra("h5py", "h5py", "HDF5 or MAT 7.3 files")
    found = _Walked()
    with raw.open() as stream, h5py.File(stream, "r") as file:
        group: Any = file
        for key in (options.sheet or "").strip("/").split("/"):
            inner = _linked(group, key) if key else group
            if inner is None:
                raise ReadError(
                    f"--part sheet={options.sheet}: there is no such group; there are "
                    f"{', '.join(islice(file, 10))}"
                )
            group = inner
        _walk(group, "", found)
        limits.within(found.numbers, "the datasets hold")
        arrays = [array for node, name in found.datasets for array in _dataset(node, name)]
    matlab = raw.head(10) == b"MATLAB 7.3"
    return gather(arrays, format_="MAT 7.3" if matlab else "HDF5", notes=found.notes)


def _linked(group: Any, key: str) -> Any:
    """The member of a group, or None; what a soft link names has a place of its own."""
    h5py = extra("h5py", "h5py", "HDF5 files")
    link = group.get(key, getlink=True) if isinstance(group, h5py.Group) else None
    if isinstance(link, h5py.ExternalLink):
        raise ReadError(f"'{key}' is a link into '{link.filename}': {_FOREIGN}")
    return group[key] if isinstance(link, h5py.HardLink) else None


def _walk(node: Any, name: str, found: _Walked) -> None:
    from h5py import Dataset, Group, h5o

    info = h5o.get_info(node.id)
    if (info.fileno, info.addr) in found.visited:
        return
    found.visited.add((info.fileno, info.addr))
    if isinstance(node, Dataset):
        _take(node, name, found)
    elif isinstance(node, Group):
        for key in node:
            if not key.startswith("#") and key not in _UNIT:
                inner = _linked(node, key)
                if inner is not None:
                    _walk(inner, f"{name}.{key}".strip("."), found)


def _take(node: Any, name: str, found: _Walked) -> None:
    """Keep a dataset that holds numbers of its own, no more than may be read."""
    if node.is_virtual or node.external:
        raise ReadError(f"'{name}' is a virtual or external dataset: {_FOREIGN}")
    if node.dtype.kind not in _NUMERIC or not node.size:
        return
    size = max(node.size, node.size * node.dtype.itemsize // 8)
    if size > limits.VALUES:
        found.notes.append(f"'{name}' with {node.size} values was passed over")
    elif not node.id.get_storage_size():
        found.notes.append(f"'{name}' was never written and was passed over")
    else:
        found.numbers += size
        found.datasets.append((node, name))


def _dataset(node: Any, name: str) -> list[Named]:
    """The numbers of one dataset, parted where its columns or fields have names."""
    if node.dtype.names == _COMPLEX:
        whole = node[()]
        return [Named(name, whole["real"] + 1j * whole["imag"], _unit(node))]
    if node.dtype.names:
        whole, fields = node[()], node.dtype.names
        each = zip(
            fields,
            map(numbers, map(whole.__getitem__, fields)),
            _units(node, len(fields)),
            strict=True,
        )
        return [Named(field, found, unit) for field, found, unit in each if found is not None]
    text = _word(node.attrs.get("MATLAB_class")) == "char"
    values = None if text else numbers(node[()])
    if values is None:
        return []
    unit = _unit(node)
    return _parted(node, name, values) or [Named(_stem(name) if unit else name, values, unit)]


def _parted(node: Any, name: str, values: FloatArray | ComplexArray) -> list[Named]:
    """The columns of a matrix by the names in an attribute, if it has one for each."""
    names: Any = next((node.attrs[key] for key in _NAMES if key in node.attrs), None)
    if np.ndim(names) != 1 or values.ndim != 2 or len(names) not in values.shape:
        return []
    tall = values if values.shape[1] == len(names) else values.T
    each = zip(names, tall.T, _units(node, len(names)), strict=True)
    return [Named(_word(n) or name, column, unit) for n, column, unit in each]


def _stem(name: str) -> str:
    """The struct that ``struct.data`` is the numbers of."""
    stem, _, last = name.rpartition(".")
    return stem if stem and last in _INNER else name


def _unit(node: Any) -> str | None:
    for key in _UNIT:
        if key in node.attrs:
            return _word(node.attrs[key])
    for key in _UNIT:
        beside: Any = _linked(node.parent, key) if node.name.rsplit("/", 1)[-1] in _INNER else None
        if 0 < (getattr(beside, "size", None) or 0) < _TEXT and not beside.is_virtual:
            return _word(beside[()])
    return None


def _units(node: Any, count: int) -> list[str | None]:
    """The units of the columns or fields in an attribute, if it has one for each."""
    words: Any = next((node.attrs[key] for key in _UNIT if key in node.attrs), None)
    one_each = np.ndim(words) == 1 and len(words) == count
    return [_word(word) or None for word in words] if one_each else [None] * count


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
