"""MATLAB files of versions 4 to 7, through SciPy.

SciPy looks an element's type up in a table without a check: a damaged tag ends the process, not the
call. The tags are therefore walked first. Layout: MathWorks, *MAT-File Format*, chapter 1.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import prod
from typing import Any, BinaryIO

import numpy as np

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
)
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits
from dashpot.reading.table import FileTable

_DATA = ("data", "values", "value", "y", "signal")
_UNITS = ("unit", "units", "unit_string", "label_unit")
_HEADER, _TAG, _MATRIX, _COMPRESSED = 128, 8, 14, 15
_NAME, _INT32, _UINT32 = frozenset({1}), frozenset({5}), 6
_ARRAYS, _VARIABLES = frozenset({_MATRIX}), frozenset({_MATRIX, _COMPRESSED})
_NUMBERS = frozenset({*range(1, 8), 9, 12, 13})
_LETTERS = _NUMBERS | {16, 17, 18}
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE = range(1, 6)
_NUMERIC = range(_SPARSE, 16)
_COMPLEX = 0x800
_DIMENSIONS = range(8, 132, 4)  # two to 31 whole numbers
_MAX_DEPTH = 32
_BATCH_SIZE = 1 << 16

_VERSION_4 = bytes(4)
"""A full matrix of doubles, the least significant byte first."""

Take = Callable[[int], bytes]


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the vectors of a MAT file as a table; a struct's fields are named ``struct.field``."""
    from scipy.io import loadmat

    with raw.open() as stream:
        _require_version(stream)
        check_elements(stream)
        content: dict[str, Any] = loadmat(stream, simplify_cells=True)  # type: ignore[arg-type]
    arrays: list[NamedArray] = []
    notes: list[str] = []
    for name, value in content.items():
        if not name.startswith("__"):
            _flatten(name, value, arrays, notes)
    if options.sheet is not None:
        arrays = [array for array in arrays if array.name.startswith(options.sheet)]
        if not arrays:
            raise ReadError(f"--file-part sheet={options.sheet}: there is no such variable")
    return gather(arrays, format_="MAT", notes=notes, rate=options.rate)


def _require_version(stream: BinaryIO) -> None:
    """Refuse a file that begins with zeros and is no MAT file of version 4.

    There five whole numbers come first: type, rows, columns, whether it is complex, and the length
    of the name.
    """
    head = stream.read(_HEADER)
    stream.seek(0)
    if head.startswith(_VERSION_4):
        _, rows, columns, imaginary, length = struct.unpack("<5i", head[:20].ljust(20, b"\0"))
        name = head[20 : 20 + length - 1]
        is_possible = rows > 0 and columns > 0 and imaginary in {0, 1} and 1 < length < 64
        if not (is_possible and name.isascii() and name.decode("ascii").isidentifier()):
            raise ReadError(
                "begins with zeros, and is no format that dashpot knows by its content; export it "
                "as text (csv, txt)"
            )


def _flatten(
    name: str, value: Any, arrays: list[NamedArray], notes: list[str], depth: int = 0
) -> None:
    """Append the arrays in a variable, a struct or a cell; a struct may hold data and unit."""
    if isinstance(value, dict | list) and depth < 8:
        measured = _extract_struct_array(name, value, notes) if isinstance(value, dict) else None
        if isinstance(value, dict) and measured is not None:
            arrays.append(measured)
            arrays += [
                NamedArray(f"{name}.{key}", np.array(float(row)))
                for key, row in value.items()
                if isinstance(row, int | float | np.number) and stated_rate(str(key), 1.0) > 0
            ]
            return
        inner = value.items() if isinstance(value, dict) else enumerate(value, start=1)
        for key, entry in inner:
            _flatten(f"{name}.{key}", entry, arrays, notes, depth + 1)
    elif isinstance(value, int | float | complex | np.ndarray | np.number):
        values = convert_to_floats(value)
        if values is not None:
            arrays.append(NamedArray(name, values))


def _extract_struct_array(name: str, fields: dict[str, Any], notes: list[str]) -> NamedArray | None:
    """Return the array of a struct of numbers and their unit."""
    by_lower_case = {str(key).casefold(): value for key, value in fields.items()}
    data = next((by_lower_case[key] for key in _DATA if key in by_lower_case), None)
    unit = next((by_lower_case[key] for key in _UNITS if key in by_lower_case), None)
    values = None if data is None else convert_to_floats(data)
    if values is None or not isinstance(unit, str):
        return None
    extras = {str(key): value for key, value in fields.items() if concerns_numbers(str(key))}
    start = next((f"{key} = {value}" for key, value in fields.items() if names_start(str(key))), "")
    if np.iscomplexobj(values):
        return NamedArray(name, values, unit, factors_among(extras), start)
    values, factor = apply_attributes(name, values.real, extras, notes)
    return NamedArray(name, values, unit, factor, start)


def check_elements(stream: BinaryIO) -> None:
    """Raise a ReadError if a tag is none that a MAT file can hold, or all arrays hold too much.

    Files of another version than 5 to 7 are passed over; the stream is returned to its start.
    """
    header = stream.read(_HEADER)
    order = {b"IM": "<", b"MI": ">"}.get(header[126:128])
    if order is not None and 0 not in header[:4]:
        size = stream.seek(0, 2)
        stream.seek(_HEADER)
        file = _MatFile(order)
        try:
            while stream.tell() < size:
                _read_element(stream.read, file, size - stream.tell(), _VARIABLES, depth=0)
        except (_Damaged, zlib.error, struct.error) as error:
            position = stream.tell()
            raise ReadError(
                f"the MAT file is damaged near byte {position}: {error}; save it again"
            ) from None
    stream.seek(0)


class _Damaged(Exception):  # noqa: N818
    pass


@dataclass
class _MatFile:
    """The order of the bytes of a file, and the numbers that have been met in it."""

    byte_order: str
    number_count: int = 0

    def count(self, numbers: int) -> None:
        self.number_count += numbers
        limits.check_value_count(self.number_count, "the variables hold")


def _read_element(
    take: Take, file: _MatFile, space: int, kinds: frozenset[int], *, depth: int
) -> int:
    """Walk one element, of these kinds and at most `space` bytes; return how many it took."""
    kind, size, short = _read_tag(take, file, space, kinds)
    if short is not None:
        return 8
    if kind == _COMPRESSED:
        _scan_compressed_element(take, file, size, depth=depth)
    elif kind == _MATRIX:
        _read_array(take, file, size, depth=depth)
    else:
        size = min(-(-size // 8) * 8, space - 8)
        _skip_bytes(take, size)
    return 8 + size


def _read_tag(
    take: Take, file: _MatFile, space: int, kinds: frozenset[int]
) -> tuple[int, int, bytes | None]:
    """Type and size of the next element, and its data if they are in the tag."""
    if space < _TAG:
        raise _Damaged(f"an element where {max(space, 0)} bytes are left")
    word: int = struct.unpack(file.byte_order + "I", _read_exactly(take, 4))[0]
    kind, size = word & 0xFFFF, word >> 16
    if size:
        if kind not in kinds - _VARIABLES or size > 4:
            raise _Damaged(f"an element of type {kind} with {size} bytes in its tag")
        return kind, size, _read_exactly(take, 4)[:size]
    size = int(struct.unpack(file.byte_order + "I", _read_exactly(take, 4))[0])
    if kind not in kinds or size > space - 8:
        raise _Damaged(f"an element of type {kind} and {size} bytes, {space - 8} are left")
    return kind, size, None


def _read_content(
    take: Take, file: _MatFile, space: int, kinds: frozenset[int]
) -> tuple[int, bytes]:
    """Return how many bytes the next element took, and its data."""
    _, size, short = _read_tag(take, file, space, kinds)
    if short is not None:
        return 8, short
    padded = min(-(-size // 8) * 8, space - 8)
    return 8 + padded, _read_exactly(take, padded)[:size]


def _read_array(take: Take, file: _MatFile, size: int, *, depth: int) -> None:
    """The elements of an array: class, dimensions, name, then the elements of its class."""
    if not size:
        return
    if depth > _MAX_DEPTH:
        raise _Damaged("arrays nested too deep")
    kind, length, flags, _ = struct.unpack(
        file.byte_order + "4I", _read_exactly(take, min(16, size))
    )
    class_, parts = flags & 0xFF, 1 + bool(flags & _COMPLEX)
    if (kind, length) != (_UINT32, 8):
        raise _Damaged("an array without a class")
    remaining = size - 16
    bytes_read, dimensions = _read_content(take, file, remaining, _INT32)
    remaining -= bytes_read
    if len(dimensions) not in _DIMENSIONS:
        raise _Damaged(f"an array with {len(dimensions)} bytes of dimensions")
    shape = _read_integers(dimensions, file)
    cells = 0 if class_ == _SPARSE else prod(abs(n) for n in shape)
    if cells > size:
        raise _Damaged(f"an array of {cells} values in {size} bytes")
    file.count(cells)
    remaining -= _read_content(take, file, remaining, _NAME)[0]
    bytes_read, kinds, parts = _read_element_layout(
        take, file, remaining, class_=class_, cells=cells, parts=parts
    )
    remaining -= bytes_read
    if class_ == _SPARSE:
        remaining, parts = remaining - _read_indices(take, file, remaining, shape), parts - 2
    for _part in range(parts):
        remaining -= _read_element(take, file, remaining, kinds, depth=depth + 1)
    _skip_bytes(take, remaining)


def _read_indices(take: Take, file: _MatFile, space: int, shape: Sequence[int]) -> int:
    """Rows and starts of the columns of a sparse array, which SciPy follows without a look."""
    first, rows = _read_content(take, file, space, _INT32)
    second, starts = _read_content(take, file, space - first, _INT32)
    row_indices, begins = _read_integers(rows, file), _read_integers(starts, file)
    if (
        len(shape) != 2
        or len(begins) != shape[1] + 1
        or begins[0] != 0
        or begins[-1] > len(row_indices)
        or any(a > b for a, b in pairwise(begins))
        or any(not 0 <= row < shape[0] for row in row_indices)
    ):
        raise _Damaged("a sparse array whose indices lie outside it")
    return first + second


def _read_element_layout(
    take: Take, file: _MatFile, space: int, *, class_: int, cells: int, parts: int
) -> tuple[int, frozenset[int], int]:
    """Bytes that name the fields, and the kinds and number of the elements that follow them."""
    if class_ in {_STRUCT, _OBJECT}:
        bytes_left = space - (
            _read_content(take, file, space, _NAME)[0] if class_ == _OBJECT else 0
        )
        bytes_read, longest = _read_content(take, file, bytes_left, _INT32)
        bytes_left -= bytes_read
        bytes_read, names = _read_content(take, file, bytes_left, _NAME)
        width = sum(_read_integers(longest, file))
        if width < 1:
            raise _Damaged(f"a struct with names of {width} letters")
        return space - bytes_left + bytes_read, _ARRAYS, cells * (len(names) // width)
    if class_ == _CELL:
        return 0, _ARRAYS, cells
    if class_ == _CHAR:
        return 0, _LETTERS, 1
    if class_ not in _NUMERIC:
        raise _Damaged(f"an array of class {class_}")
    return 0, _NUMBERS, parts + 2 * (class_ == _SPARSE)


def _read_integers(data: bytes, file: _MatFile) -> tuple[int, ...]:
    return struct.unpack(f"{file.byte_order}{len(data) // 4}i", data[: len(data) // 4 * 4])


def _scan_compressed_element(take: Take, file: _MatFile, size: int, *, depth: int) -> None:
    """A compressed element: the one inside, inflated a stretch at a time."""
    inflate = zlib.decompressobj()
    buffered_bytes, bytes_left = b"", size

    def more(count: int) -> bytes:
        nonlocal buffered_bytes, bytes_left
        while len(buffered_bytes) < count and (bytes_left or inflate.unconsumed_tail):
            source = inflate.unconsumed_tail
            if not source:
                source = _read_exactly(take, min(bytes_left, _BATCH_SIZE))
                bytes_left -= len(source)
            new_bytes = inflate.decompress(source, _BATCH_SIZE)
            if not new_bytes and inflate.eof:
                break
            buffered_bytes += new_bytes
        content, buffered_bytes = buffered_bytes[:count], buffered_bytes[count:]
        return content

    _read_element(more, file, 1 << 62, _ARRAYS, depth=depth + 1)
    _skip_bytes(take, bytes_left)


def _skip_bytes(take: Take, count: int) -> None:
    while count > 0:
        count -= len(_read_exactly(take, min(count, _BATCH_SIZE)))


def _read_exactly(take: Take, count: int) -> bytes:
    content = take(count)
    if len(content) < count:
        raise _Damaged("it ends inside an array")
    return content
