"""Records of an ASAM MDF file: their channels, and how their bytes become numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import BinaryIO, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.extensions.formats.mdf_conversions import Conversion, keep_raw
from dashpot.reading.sandbox.limits import check_value_count

Bytes: TypeAlias = NDArray[np.uint8]
PIECE = 1 << 23
"""Bytes of records that are decoded at a time."""
_MAX_INTEGER_BYTES = 8
"""Bytes of a whole number."""


@dataclass(frozen=True)
class MdfChannel:
    """Channel of a group: the position of its bits in a record, and their type.

    Attributes
    ----------
    name : str
    unit : str or None
    kind : str
        ``"u"``, ``"i"`` or ``"f"``; ``"row"`` where the number of the record is the raw number.
    byte, bit, bits : int
        First byte in the record, first bit above it, and length.
    big : bool
        Whether the first byte is the most significant.
    convert : callable
    invalid : int or None
        Bit of the record, counted from its start, that is set for an invalid number.
    clock : bool
        Whether it is the time of its group.
    """

    name: str
    unit: str | None
    kind: str
    byte: int = 0
    bit: int = 0
    bits: int = 0
    big: bool = False
    convert: Conversion = keep_raw
    invalid: int | None = None
    clock: bool = False


@dataclass(frozen=True, eq=False)
class MdfGroup:
    """Channels that were sampled together.

    Attributes
    ----------
    name : str
    rows : int
        Samples of each.
    size : int
        Bytes of a record.
    channels : tuple of MdfChannel
    pieces : callable
        From the file to its bytes, a piece at a time.
    number : int
        Record number that distinguishes its records from those of other groups.
    sizes : mapping
        Length of each kind of record in the same data, bytes; None if a record states its own
        length; empty if all records belong to this group.
    total : int
        Records of all groups in the same data.
    id_size, id_after : int
        Bytes of the number before a record, and behind it.
    big : bool
        Byte order of that number.
    """

    name: str
    rows: int
    size: int
    channels: tuple[MdfChannel, ...]
    pieces: Callable[[BinaryIO], Iterator[bytes]]
    number: int = 0
    sizes: dict[int, int | None] = field(default_factory=dict)
    total: int = 0
    id_size: int = 0
    id_after: int = 0
    big: bool = False

    @property
    def clock(self) -> int | None:
        """Return the place of the time among the channels, if it is on record."""
        return next((i for i, channel in enumerate(self.channels) if channel.clock), None)


def read_channels(
    stream: BinaryIO, group: MdfGroup, channel_indices: Sequence[int]
) -> tuple[FloatArray, list[int]]:
    """Return some channels as columns, and how many numbers of each are marked as invalid.

    Raises
    ------
    ReadError
        If the file holds fewer records than it states, or a record is damaged.
    """
    check_value_count(
        group.rows * len(channel_indices), f"the channels of group '{group.name}' hold"
    )
    values = np.empty((len(channel_indices), group.rows))
    invalid = [0] * len(channel_indices)
    first = 0
    for records_read in _iterate_records(stream, group):
        records = records_read[: group.rows - first]
        last = first + len(records)
        for row, channel_index in enumerate(channel_indices):
            channel = group.channels[channel_index]
            raw = _convert_raw_numbers(records, channel, first)
            try:
                numbers = channel.convert(raw)
            except ReadError as error:
                raise ReadError(f"'{channel.name}': {error}") from None
            if channel.invalid is not None:
                byte, bit = divmod(channel.invalid, 8)
                is_invalid = (records[:, byte] >> bit & 1).astype(bool)
                numbers = np.where(is_invalid, np.nan, numbers)
                invalid[row] += int(np.count_nonzero(is_invalid))
            values[row, first:last] = numbers
        first = last
        if first == group.rows and not group.sizes:
            break
    if first < group.rows:
        raise ReadError(
            f"group '{group.name}' says {group.rows} records and holds {first}: the file was cut, "
            "or not finished; open and save it with the program that recorded it"
        )
    return values.T, invalid


def _iterate_records(stream: BinaryIO, group: MdfGroup) -> Iterator[Bytes]:
    """Yield the records of a group as rows of bytes, one chunk of the file at a time."""
    if group.sizes:
        yield from _iterate_group_records(stream, group)
        return
    partial_record = b""
    step = group.id_size + group.size + group.id_after
    if step == 0:
        yield np.empty((group.rows, 0), np.uint8)
        return
    for piece in group.pieces(stream):
        data = partial_record + piece if partial_record else piece
        count = len(data) // step
        partial_record = data[count * step :]
        rows = np.frombuffer(data, np.uint8, count * step).reshape(count, step)
        yield rows[:, group.id_size : group.id_size + group.size]


def _iterate_group_records(stream: BinaryIO, group: MdfGroup) -> Iterator[Bytes]:
    """Yield those records among others that carry the number of the group."""
    partial_record, size, number = b"", group.id_size, group.number
    order: Literal["big", "little"] = "big" if group.big else "little"
    byte_offsets, record_count = np.arange(group.size), 0
    for piece in group.pieces(stream):
        data, position, record_starts = partial_record + piece, 0, []
        end = len(data)
        while position + size <= end:
            kind = (
                data[position]
                if size == 1
                else int.from_bytes(data[position : position + size], order)
            )
            if kind not in group.sizes:
                raise ReadError(
                    f"a record carries the number {kind}, which no group of the file has: the file "
                    "is damaged"
                )
            length = group.sizes[kind]
            start = position + size
            if length is None:
                if start + 4 > end:
                    break
                length = 4 + int.from_bytes(data[start : start + 4], order)
            next_position = start + length + group.id_after
            if next_position > end:
                break
            record_count += 1
            if record_count > group.total:
                raise ReadError(
                    f"its groups say {group.total} records together, and their data holds more: "
                    "the file is damaged, or was not finished"
                )
            if kind == number:
                record_starts.append(start)
            position = next_position
        partial_record = data[position:]
        if record_starts:
            bytes_read = np.frombuffer(data, np.uint8)
            yield bytes_read[np.add.outer(np.array(record_starts), byte_offsets)]


def _convert_raw_numbers(records: Bytes, channel: MdfChannel, first: int) -> FloatArray:
    if channel.kind == "row":
        return np.arange(first, first + len(records), dtype=float)
    size = (channel.bit + channel.bits + 7) // 8
    parts = records[:, channel.byte : channel.byte + size]
    if parts.shape[1] < size or not 0 < size <= _MAX_INTEGER_BYTES:
        raise ReadError(f"'{channel.name}' stands outside its record: the file is damaged")
    order = ">" if channel.big else "<"
    is_aligned = channel.bit == 0 and channel.bits == 8 * size and size in {1, 2, 4, 8}
    if is_aligned:
        kind = f"{order}{channel.kind}{size}"
        return np.ascontiguousarray(parts).view(kind)[:, 0].astype(float)
    unsigned = np.zeros(len(parts), np.uint64)
    for byte_index in range(size):
        shift = 8 * (size - 1 - byte_index if channel.big else byte_index)
        unsigned |= parts[:, byte_index].astype(np.uint64) << np.uint64(shift)
    unsigned >>= np.uint64(channel.bit)
    unsigned &= np.uint64((1 << channel.bits) - 1)
    if channel.kind == "i":
        up = np.uint64(64 - channel.bits)
        return ((unsigned << up).view(np.int64) >> up.astype(np.int64)).astype(float)
    return unsigned.astype(float)
