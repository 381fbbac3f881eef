"""Whether the elements of a MAT file (version 5 to 7) are sound.

SciPy looks an element's type up in a table without a check: a damaged tag ends the process, not the
call. The tags are therefore walked first. Layout: MathWorks, *MAT-File Format*, chapter 1.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from typing import BinaryIO

from dashpot.errors import ReadError

_HEADER, _MATRIX, _COMPRESSED, _FLAGS = 128, 14, 15, 6
_TYPES = frozenset({*range(1, 8), 9, *range(12, 19)})
_CLASSES = range(1, 19)
_DEEPEST = 32
_AT_ONCE = 1 << 16

Take = Callable[[int], bytes]


def check_elements(stream: BinaryIO, name: str) -> None:
    """Raise a ReadError if a tag of the file is none that a MAT file can hold.

    Files of another version than 5 to 7 are passed over; the stream is left at its start.
    """
    header = stream.read(_HEADER)
    order = {b"IM": "<", b"MI": ">"}.get(header[126:128])
    if order is not None and 0 not in header[:4]:
        size = stream.seek(0, 2)
        stream.seek(_HEADER)
        try:
            while stream.tell() < size:
                _element(stream.read, order, size - stream.tell(), depth=0)
        except (_Damaged, zlib.error, struct.error) as error:
            at = stream.tell()
            raise ReadError(
                f"{name}: the MAT file is damaged near byte {at}: {error}; save it again"
            ) from None
    stream.seek(0)


class _Damaged(Exception):  # noqa: N818
    pass


def _element(take: Take, order: str, room: int, *, depth: int) -> int:
    """Walk one element of at most `room` bytes, its own included; return how many it took."""
    if depth > _DEEPEST:
        raise _Damaged("arrays nested too deep")
    first = _exactly(take, 4)
    word: int = struct.unpack(order + "I", first)[0]
    kind, size = word & 0xFFFF, word >> 16
    if size:  # a small element keeps its data in the tag
        if kind not in _TYPES or size > 4:
            raise _Damaged(f"an element of type {kind} with {size} bytes in its tag")
        _exactly(take, 4)
        return 8
    size = int(struct.unpack(order + "I", _exactly(take, 4))[0])
    if kind not in _TYPES or size > room - 8:
        raise _Damaged(f"an element of type {kind} and {size} bytes, {room - 8} are left")
    if kind == _COMPRESSED:
        _inflated(take, order, size, depth=depth)
        return 8 + size
    padded = size if kind == _MATRIX else min(-(-size // 8) * 8, room - 8)
    if kind != _MATRIX:
        _passed(take, padded)
        return 8 + padded
    left = size
    if left:
        left -= _flags(take, order, left)
    while left > 0:
        left -= _element(take, order, left, depth=depth + 1)
    return 8 + size


def _flags(take: Take, order: str, room: int) -> int:
    """The first element of an array: its class."""
    kind, size, flags, _ = struct.unpack(order + "4I", _exactly(take, min(16, room)))
    if (kind, size) != (_FLAGS, 8) or flags & 0xFF not in _CLASSES:
        raise _Damaged(f"an array of class {flags & 0xFF}")
    return 16


def _inflated(take: Take, order: str, size: int, *, depth: int) -> None:
    """A compressed element: the one inside, inflated a stretch at a time."""
    inflate = zlib.decompressobj()
    waiting, packed = b"", size

    def more(count: int) -> bytes:
        nonlocal waiting, packed
        while len(waiting) < count and (packed or inflate.unconsumed_tail):
            source = inflate.unconsumed_tail
            if not source:
                source = _exactly(take, min(packed, _AT_ONCE))
                packed -= len(source)
            fresh = inflate.decompress(source, _AT_ONCE)
            if not fresh and inflate.eof:
                break
            waiting += fresh
        found, waiting = waiting[:count], waiting[count:]
        return found

    _element(more, order, 1 << 62, depth=depth + 1)
    _passed(take, packed)


def _passed(take: Take, count: int) -> None:
    while count:
        count -= len(_exactly(take, min(count, _AT_ONCE)))


def _exactly(take: Take, count: int) -> bytes:
    found = take(count)
    if len(found) < count:
        raise _Damaged("it ends inside an array")
    return found
