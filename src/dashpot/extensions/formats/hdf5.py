"""HDF5 files, MATLAB's version 7.3 among them, through h5py."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import Any

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import ReadError
from dashpot.extensions.formats.array_table import (
    NamedArray,
    convert_to_floats,
    gather,
    names_start,
    stated_rate,
)
from dashpot.extensions.formats.attribute_factors import (
    apply_attributes,
    concerns_numbers,
    factors_among,
    stated_numbers,
    stated_unit,
)
from dashpot.reading.raw_file import RawFile, import_extra
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits
from dashpot.reading.table import FileTable

_UNIT = ("unit", "units", "Unit", "Units", "unit_string", "UNIT")
_NAMES = ("columns", "names", "channels", "column_names", "fields")
_VALUE_NAMES = {"data", "values"}
_COMPLEX = ("real", "imag")
"""The fields that MATLAB writes a complex number in."""
_CF_ATTRIBUTES = (
    "scale_factor", "add_offset", "_FillValue", "missing_value", "valid_range", "valid_min",
    "valid_max",
)  # fmt: skip
"""Attributes of the CF conventions that change numbers."""
_SCALING_ATTRIBUTES = ("scale_factor", "add_offset")
_INSTANT_KINDS = "MmSO"
"""Kinds of NumPy types that may hold instants."""
_MIN_INSTANTS = 8
_UNIT_SINCE = re.compile(r"\A\s*(\w+)\s+since\b", re.IGNORECASE)
"""A unit of time with its zero, as the CF conventions write it."""
_MAX_UNIT_LENGTH = 1000
_NUMERIC_KINDS = "iufbcV"
"""Kinds of NumPy types that may hold numbers, records among them."""
_OTHER_FILE_REASON = (
    "it is data of another file, which this file's hash does not cover; save both as one"
)


@dataclass
class _FileFindings:
    """Findings of a walk, and the objects visited: links may lead in circles."""

    datasets: list[tuple[Any, str]] = field(default_factory=list)
    single_values: list[NamedArray] = field(default_factory=list)
    """Attributes of the clock and of factors, as single numbers."""
    notes: list[str] = field(default_factory=list)
    visited: set[tuple[int, int]] = field(default_factory=set)
    number_count: int = 0


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the datasets of an HDF5 file, or of the group ``options.sheet``, as a table.

    Units are read from the attribute ``unit`` or ``units``, or from a text dataset of that name
    beside the data (as MATLAB structs become).

    Raises
    ------
    ReadError
        If there is no such group, or numbers stand in another file (external links and storage,
        virtual datasets).
    """
    h5py = import_extra("h5py", "h5py", "HDF5 or MAT 7.3 files")
    visitor = _FileFindings()
    with raw.open() as stream, h5py.File(stream, "r") as file:
        group: Any = file
        for key in (options.sheet or "").strip("/").split("/"):
            inner = _get_group_member(group, key) if key else group
            if inner is None:
                raise ReadError(
                    f"--file-part sheet={options.sheet}: there is no such group; there are "
                    f"{', '.join(islice(file, 10))}"
                )
            group = inner
        _visit_node(group, "", visitor)
        limits.check_value_count(visitor.number_count, "the datasets hold")
        arrays = [
            array for node, name in visitor.datasets for array in _read_dataset(node, name, visitor)
        ]
    matlab = raw.head(10) == b"MATLAB 7.3"
    form = "MAT 7.3" if matlab else "HDF5"
    return gather(
        [*arrays, *visitor.single_values], format_=form, notes=visitor.notes, rate=options.rate
    )


def _get_group_member(group: Any, key: str) -> Any:
    """Return a member of a group, or None; the targets of soft links are found on their own."""
    h5py = import_extra("h5py", "h5py", "HDF5 files")
    link = group.get(key, getlink=True) if isinstance(group, h5py.Group) else None
    if isinstance(link, h5py.ExternalLink):
        raise ReadError(f"'{key}' is a link into '{link.filename}': {_OTHER_FILE_REASON}")
    return group[key] if isinstance(link, h5py.HardLink) else None


def _visit_node(node: Any, name: str, visitor: _FileFindings) -> None:
    from h5py import Dataset, Group, h5o

    info = h5o.get_info(node.id)
    if (info.fileno, info.addr) in visitor.visited:
        return
    visitor.visited.add((info.fileno, info.addr))
    if isinstance(node, Dataset):
        _take_dataset(node, name, visitor)
    elif isinstance(node, Group):
        visitor.single_values += _list_stated_numbers(node, name, also_factors=True)
        for key in node:
            if not key.startswith("#") and key not in _UNIT:
                inner = _get_group_member(node, key)
                if inner is not None:
                    _visit_node(inner, f"{name}.{key}".strip("."), visitor)


def _take_dataset(node: Any, name: str, visitor: _FileFindings) -> None:
    """Keep a numeric dataset, up to the size limit."""
    if node.is_virtual or node.external:
        raise ReadError(f"'{name}' is a virtual or external dataset: {_OTHER_FILE_REASON}")
    if node.dtype.kind not in _NUMERIC_KINDS + _INSTANT_KINDS or not node.size:
        return
    value_count = max(node.size, node.size * node.dtype.itemsize // 8)
    if value_count > limits.VALUES:
        visitor.notes.append(f"'{name}' with {node.size} values was passed over")
    elif not node.id.get_storage_size():
        visitor.notes.append(f"'{name}' was never written and was passed over")
    else:
        visitor.number_count += value_count
        visitor.datasets.append((node, name))


def _read_dataset(node: Any, name: str, visitor: _FileFindings) -> list[NamedArray]:
    """Return the numbers of one dataset, parted where its columns or fields have names."""
    if node.dtype.kind in _INSTANT_KINDS:
        return _convert_instants(node, name, visitor)
    all_values = _read_columns(node, name, visitor)
    for array in all_values:
        visitor.single_values += _list_stated_numbers(node, array.name, also_factors=False)
    attributes, start = _list_attributes_by_column(node, len(all_values)), _get_start_time(node)
    arrays = []
    for array, entries in zip(all_values, attributes, strict=True):
        if np.iscomplexobj(array.values):
            factor, values = factors_among(entries), array.values
        else:
            numbers: FloatArray = array.values.real
            values, factor = apply_attributes(array.name, numbers, entries, visitor.notes)
        arrays.append(replace(array, values=values, stated_factor=factor, stated_start=start))
    return arrays


def _read_columns(node: Any, name: str, visitor: _FileFindings) -> list[NamedArray]:
    if node.dtype.names == _COMPLEX:
        raw_values = node[()]
        return [NamedArray(name, raw_values["real"] + 1j * raw_values["imag"], _read_unit(node))]
    if node.dtype.names:
        packed_keys = [key for key in _CF_ATTRIBUTES if key in node.attrs]
        if packed_keys:
            raise ReadError(
                f"'{name}' has named fields and states {', '.join(packed_keys)}, which the CF "
                "conventions know of one variable alone; write each field as a dataset of its own"
            )
        raw_values, fields = node[()], node.dtype.names
        pairs = zip(
            fields,
            map(convert_to_floats, map(raw_values.__getitem__, fields)),
            _read_units(node, len(fields)),
            strict=True,
        )
        return [NamedArray(field, value, unit) for field, value, unit in pairs if value is not None]
    text = _convert_to_text(node.attrs.get("MATLAB_class")) == "char"
    values = None if text else convert_to_floats(node[()])
    if values is None:
        return []
    values = _decode_cf_values(node, name, values, visitor)
    unit = _read_unit(node)
    return _split_named_columns(node, name, values) or [
        NamedArray(_get_struct_name(name) if unit else name, values, unit)
    ]


def _decode_cf_values(
    node: Any, name: str, values: FloatArray | ComplexArray, visitor: _FileFindings
) -> FloatArray | ComplexArray:
    """The numbers as the CF conventions unpack them: fill values out, scale and offset applied.

    References
    ----------
    CF Metadata Conventions 1.11, sections 2.5.1 and 8.1.
    """
    cf_attributes = {
        key: _parse_cf_attribute(name, key, node.attrs[key])
        for key in _CF_ATTRIBUTES
        if key in node.attrs
    }
    if not cf_attributes or np.iscomplexobj(values):
        return values
    missing = np.zeros(values.shape, bool)
    for key in ("_FillValue", "missing_value"):
        for fill_value in cf_attributes.get(key, ()):
            missing |= values == np.asarray(fill_value).astype(node.dtype).astype(float)
    low, high = cf_attributes.get("valid_range", (-np.inf, np.inf))[:2] or (-np.inf, np.inf)
    low = max([low, *cf_attributes.get("valid_min", ())])
    high = min([high, *cf_attributes.get("valid_max", ())])
    missing |= (values < low) | (values > high)
    scale, offset = (cf_attributes.get(key, ()) for key in ("scale_factor", "add_offset"))
    if len(scale) > 1 or len(offset) > 1:
        raise ReadError(
            f"'{name}' has a scale_factor or add_offset of several numbers, and the CF conventions "
            "know one of each; write the numbers as they were measured"
        )
    decoded_values = np.where(
        missing, np.nan, values * (scale or (1.0,))[0] + (offset or (0.0,))[0]
    )
    applied_texts = [
        f"{key} = {pair[0]:g}"
        for key, pair in cf_attributes.items()
        if key in _SCALING_ATTRIBUTES and pair
    ]
    if applied_texts:
        visitor.notes.append(f"{' and '.join(applied_texts)} of '{name}' applied (CF conventions)")
    if missing.any():
        visitor.notes.append(
            f"{np.count_nonzero(missing)} numbers of '{name}' are fill values, or outside the "
            "valid range that the file states: they are no numbers"
        )
    return decoded_values


def _parse_cf_attribute(name: str, key: str, value: Any) -> tuple[float, ...]:
    """Return the numbers of an attribute of the CF conventions, also of a text.

    Raises
    ------
    ReadError
        If it holds no number: its effect on the data is then not known.
    """
    numbers = _list_numbers(value)
    if numbers:
        return numbers
    word = _convert_to_text(value)
    try:
        return tuple(float(part) for part in (word or "").replace(",", " ").split())
    except ValueError:
        raise ReadError(
            f"'{name}' states {key} = {word!r}, which is no number; write it as one, or "
            "leave it out"
        ) from None


def _list_numbers(value: Any) -> tuple[float, ...]:
    """Return the numbers of an attribute, in its own order."""
    array = np.ravel(np.asarray(value))
    return tuple(array.astype(float).tolist()) if array.dtype.kind in "iufb" else ()


def _list_attributes_by_column(node: Any, count: int) -> list[dict[str, Any]]:
    """Return the attributes of a dataset that no convention applies, by column."""
    attributes = {
        key: node.attrs[key]
        for key in node.attrs
        if key not in _CF_ATTRIBUTES and concerns_numbers(key)
    }
    return [
        {
            key: value[column_index] if count > 1 and np.shape(value) == (count,) else value
            for key, value in attributes.items()
        }
        for column_index in range(count)
    ]


def _get_start_time(node: Any) -> str:
    """Return the start time of a dataset or of its group; empty if none is given."""
    for holder in (node, node.parent):
        for key in filter(names_start, holder.attrs):
            value = holder.attrs[key]
            word = _convert_to_text(value)
            text = (
                word
                if word is not None
                else ", ".join(f"{number:g}" for number in _list_numbers(value))
            )
            if text:
                return f"{key} = {text}"
    return ""


def _list_stated_numbers(node: Any, name: str, *, also_factors: bool) -> list[NamedArray]:
    """Return the attributes of a node that state a rate, a step or a factor, as single numbers."""
    arrays = []
    for key in node.attrs:
        names_rate = stated_rate(key, 1.0) > 0
        if not names_rate and not (also_factors and concerns_numbers(key)):
            continue
        value = stated_numbers(node.attrs[key])
        if value:
            unit = stated_unit(node.attrs[key]) if names_rate else None
            arrays.append(NamedArray(f"{name}.{key}".strip("."), np.array(value), unit))
    return arrays


def _convert_instants(node: Any, name: str, visitor: _FileFindings) -> list[NamedArray]:
    """Instants as seconds since the first: numbers of NumPy's kind, or text by ISO 8601."""
    if node.ndim != 1 or node.size < _MIN_INSTANTS:
        return []
    try:
        cells = node[()]
        if node.dtype.kind not in "Mm":
            words = [_convert_to_text(cell) or "" for cell in cells]
            if not all(word[:1].isdigit() for word in words[:_MIN_INSTANTS]):
                return []
            cells = np.array([word.removesuffix("Z").strip() for word in words], "datetime64[ns]")
        seconds = cells - cells[0]
        return [NamedArray(name, seconds / np.timedelta64(1, "s"), "s")]
    except (ValueError, TypeError):
        visitor.notes.append(f"'{name}' holds text that is no instant, and was passed over")
        return []


def _split_named_columns(
    node: Any, name: str, values: FloatArray | ComplexArray
) -> list[NamedArray]:
    """Return the columns of a matrix by the names in an attribute, if it has one for each."""
    names: Any = next((node.attrs[key] for key in _NAMES if key in node.attrs), None)
    if np.ndim(names) != 1 or values.ndim != 2 or len(names) not in values.shape:
        return []
    column_values = values if values.shape[1] == len(names) else values.T
    pairs = zip(names, column_values.T, _read_units(node, len(names)), strict=True)
    return [NamedArray(_convert_to_text(n) or name, column, unit) for n, column, unit in pairs]


def _get_struct_name(name: str) -> str:
    """Return the struct that ``struct.data`` is the numbers of."""
    stem, _, last = name.rpartition(".")
    return stem if stem and last in _VALUE_NAMES else name


def _read_unit(node: Any) -> str | None:
    for key in _UNIT:
        if key in node.attrs:
            word = _convert_to_text(node.attrs[key])
            match = _UNIT_SINCE.match(word or "")
            return match[1] if match else word
    for key in _UNIT:
        member: Any = (
            _get_group_member(node.parent, key)
            if node.name.rsplit("/", 1)[-1] in _VALUE_NAMES
            else None
        )
        if 0 < (getattr(member, "size", None) or 0) < _MAX_UNIT_LENGTH and not member.is_virtual:
            return _convert_to_text(member[()])
    return None


def _read_units(node: Any, count: int) -> list[str | None]:
    """Return the units of the columns or fields in an attribute, if it has one for each."""
    words: Any = next((node.attrs[key] for key in _UNIT if key in node.attrs), None)
    one_each = np.ndim(words) == 1 and len(words) == count
    return [_convert_to_text(word) or None for word in words] if one_each else [None] * count


def _convert_to_text(value: Any) -> str | None:
    """Text from what HDF5 and MATLAB keep it in: bytes, str, or an array of character codes."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, str):
        return value
    if isinstance(value, np.ndarray) and value.size and value.dtype.kind == "u":
        return "".join(map(chr, value.ravel().tolist()))
    if isinstance(value, np.ndarray) and value.size == 1:
        return _convert_to_text(value.ravel()[0])
    return None
