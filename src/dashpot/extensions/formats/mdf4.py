"""Blocks of ASAM MDF 4: groups, channels, conversions and data."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from html import unescape
from typing import BinaryIO

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.extensions.formats import mdf_conversions as conversions
from dashpot.extensions.formats.mdf_conversions import Conversion, NoNumbersError
from dashpot.extensions.formats.mdf_records import PIECE, MdfChannel, MdfGroup

_HEADER = struct.Struct("<4s4xQQ")
_MAX_LINKS = 1 << 20
_MAX_BLOCKS = 1 << 18
"""Groups, channels and lists of data of a file, at most."""
_LARGEST_TEXT = 1 << 20
_LAST_BYTE = 1 << 62
"""Largest valid offset in a file."""
_LARGEST_BLOCK = 1 << 26
"""Bytes to which one packed block may unpack."""
_TEXT = re.compile(r"<TX\b[^>]*>(.*?)</TX>", re.S)
_KINDS = {0: "u", 1: "u", 2: "i", 3: "i", 4: "f", 5: "f"}
_BIG_ENDIAN_TYPES = {1, 3, 5}
_WORDS = {
    6: "text", 7: "text", 8: "text", 9: "text", 10: "bytes", 11: "samples of a medium",
    12: "a stream of a medium", 13: "dates", 14: "times of day", 15: "complex numbers",
    16: "complex numbers",
}  # fmt: skip
_TYPES = {
    1: "samples of varying length",
    4: "a place in another medium",
    5: "samples of varying length",
}
_FORMULA, _RANGES, _STATES = 3, 6, (7, 8)
_MAKERS: dict[int, Callable[[Sequence[float]], Conversion]] = {
    0: lambda _: conversions.keep_raw,
    1: conversions.linear,
    2: conversions.rational,
    4: conversions.interpolated_table,
    5: conversions.nearest_table,
}
_REMOTE = 8
"""Flag of a group whose time channel is in another group."""
_VLSD = 1


@dataclass(eq=False)
class Content:
    """Contents of the blocks of a file.

    Attributes
    ----------
    groups : list of MdfGroup
    passed : dict of str to str
        Skipped channels, each with the kind of its contents.
    header : list of str
    hints : dict of str to str
        Note on channels without a clock, by their sampling rate.
    """

    groups: list[MdfGroup] = field(default_factory=list)
    passed: dict[str, str] = field(default_factory=dict)
    header: list[str] = field(default_factory=list)
    hints: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class _Mdf4Block:
    kind: bytes
    links: tuple[int, ...]
    data: bytes
    start: int
    """Position of its data."""
    length: int

    def link(self, link_index: int) -> int:
        return self.links[link_index] if link_index < len(self.links) else 0


class _Mdf4Blocks:
    """Blocks of an open file."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._count = 0

    def read_block(self, address: int, *kinds: bytes, read_all: bool = True) -> _Mdf4Block:
        """Return the block at an address, which is one of the kinds."""
        self._count += 1
        if self._count > _MAX_BLOCKS:
            raise ReadError(f"more than {_MAX_BLOCKS} blocks: its links go round, or it is no test")
        self._stream.seek(min(address, _LAST_BYTE))
        head = self._stream.read(_HEADER.size)
        if len(head) < _HEADER.size:
            raise ReadError(
                f"cut: a block of kind {_name_conversion_kinds(kinds)} should stand at byte "
                f"{address}, beyond the "
                "end of the file"
            )
        kind, length, count = _HEADER.unpack(head)
        if kind not in kinds or count > _MAX_LINKS or length < _HEADER.size + 8 * count:
            raise ReadError(
                f"damaged: no block of kind {_name_conversion_kinds(kinds)} at byte {address}"
            )
        links = self._exactly(8 * count, address)
        size = length - _HEADER.size - 8 * count
        start = address + _HEADER.size + 8 * count
        if read_all and size > _LARGEST_TEXT * 16:
            raise ReadError(f"damaged: the block at byte {address} says {size} bytes")
        data = self._exactly(size, address) if read_all else b""
        return _Mdf4Block(kind, struct.unpack(f"<{count}Q", links), data, start, size)

    def _exactly(self, size: int, address: int) -> bytes:
        data = self._stream.read(size)
        if len(data) < size:
            raise ReadError(f"cut: the block at byte {address} ends beyond the end of the file")
        return data

    def text(self, address: int) -> str:
        """Return the text of a block of text or XML; empty without one."""
        if not address:
            return ""
        block = self.read_block(address, b"##TX", b"##MD")
        words = block.data.split(b"\0", 1)[0].decode("utf-8", "replace")
        if block.kind == b"##MD":
            match = _TEXT.search(words)
            words = unescape(match[1]) if match else ""
        return words.strip()

    def chain(self, address: int, kind: bytes) -> Iterator[_Mdf4Block]:
        """Yield a block and its successors by the first link."""
        while address:
            block = self.read_block(address, kind)
            yield block
            address = block.link(0)


def read_blocks(stream: BinaryIO) -> Content:
    """Return the contents of the blocks of an open file.

    Raises
    ------
    ReadError
        If a block is missing or broken.
    """
    blocks = _Mdf4Blocks(stream)
    header = blocks.read_block(64, b"##HD")
    content = Content(header=_read_header(blocks, header))
    for data_group in blocks.chain(header.link(0), b"##DG"):
        _read_data_group(blocks, data_group, content)
    return content


def _read_header(blocks: _Mdf4Blocks, header: _Mdf4Block) -> list[str]:
    nanoseconds, zone, summer, flags = struct.unpack_from("<QhhB", header.data)
    lines = [line.strip() for line in blocks.text(header.link(5)).splitlines() if line.strip()]
    since_epoch = timedelta(microseconds=nanoseconds // 1000)
    if nanoseconds and since_epoch < timedelta(days=200 * 365):
        local = timedelta(minutes=zone + summer) if flags & 2 and not flags & 1 else timedelta()
        start_time = datetime(1970, 1, 1, tzinfo=UTC) + since_epoch + local
        zone_word = " (local time)" if flags & 1 or local else " UTC"
        lines.append(f"recorded: {start_time:%Y-%m-%d %H:%M:%S}{zone_word}")
    return lines


def _read_data_group(blocks: _Mdf4Blocks, data_group: _Mdf4Block, content: Content) -> None:
    """Read the channel groups of one data group."""
    id_size = data_group.data[0]
    if id_size not in {0, 1, 2, 4, 8}:
        raise ReadError(f"damaged: records carry a number of {id_size} bytes")
    groups = list(blocks.chain(data_group.link(1), b"##CG"))
    address = data_group.link(2)
    sizes: dict[int, int | None] = {}
    total = 0
    for group in groups:
        number, rows, flags = struct.unpack_from("<QQH", group.data)
        data, invalid_bytes = struct.unpack_from("<II", group.data, 24)
        if number in sizes:
            raise ReadError("damaged: two groups of the same data have one number")
        total += rows
        sizes[number] = None if flags & _VLSD else data + invalid_bytes
    if len(groups) > 1 and not id_size:
        raise ReadError("damaged: records of several groups carry no number")
    for group in groups:
        number, rows, flags = struct.unpack_from("<QQH", group.data)
        data, invalid_bytes = struct.unpack_from("<II", group.data, 24)
        if flags & _VLSD:
            continue
        name = blocks.text(group.link(2)) or f"group {len(content.groups) + 1}"
        channels_found = list(
            _iterate_channels(blocks, group.link(1), (data, invalid_bytes), content.passed)
        )
        if flags & _REMOTE:
            content.passed |= {channel.name: "stored by columns" for channel in channels_found}
            continue
        content.groups.append(
            MdfGroup(
                name=name, rows=rows, size=data + invalid_bytes, channels=tuple(channels_found),
                pieces=_iterate_bytes(address), number=number,
                sizes=sizes if len(groups) > 1 else {}, total=total, id_size=id_size,
            )
        )  # fmt: skip


def _iterate_channels(
    blocks: _Mdf4Blocks,
    address: int,
    sizes: tuple[int, int],
    skipped_channels: dict[str, str],
    depth: int = 0,
) -> Iterator[MdfChannel]:
    """Yield the numeric channels of a group; name the others in `skipped_channels`."""
    for block in blocks.chain(address, b"##CN"):
        name = blocks.text(block.link(2))
        inner = block.link(1)
        if inner:
            kind = blocks.read_block(
                inner, b"##CN", b"##CA", b"##CL", b"##CV", b"##CU", b"##DS"
            ).kind
            if kind == b"##CN" and depth < 8:
                yield from _iterate_channels(blocks, inner, sizes, skipped_channels, depth + 1)
            else:
                skipped_channels[name] = "arrays" if kind == b"##CA" else "structures"
            continue
        try:
            yield _read_channel(blocks, block, name, sizes)
        except NoNumbersError as error:
            skipped_channels[name or "a channel without a name"] = str(error)


def _read_channel(
    blocks: _Mdf4Blocks, block: _Mdf4Block, name: str, sizes: tuple[int, int]
) -> MdfChannel:
    data, invalid_bytes = sizes
    kind, sync_type, data_type, bit, byte, bits, flags, invalid_bit = struct.unpack_from(
        "<BBBBIIII", block.data
    )
    for types, number in ((_TYPES, kind), (_WORDS, data_type)):
        if number in types and kind not in {3, 6}:
            raise NoNumbersError(types[number])
    if kind not in {0, 2, 3, 6} or (data_type not in _KINDS and kind not in {3, 6}):
        raise NoNumbersError(f"a kind of channel ({kind}, {data_type}) that is not known")
    clock = kind in {2, 3} and sync_type == 1
    if flags & 1 and not clock:
        raise NoNumbersError("no valid number, by its flag")
    unit = blocks.text(block.link(6))
    form, is_integer = _KINDS.get(data_type, "u"), data_type < 4
    convert: Conversion = conversions.keep_raw
    if block.link(4):
        conversion = blocks.read_block(block.link(4), b"##CC")
        unit = unit or blocks.text(conversion.link(1))
        convert = _read_conversion(blocks, conversion, is_integer=is_integer)
    if kind in {3, 6}:
        return MdfChannel(name, unit or None, "row", convert=convert, clock=clock)
    _require_place(name, form, (byte, bit, bits), data)
    invalid = None
    if flags & 2:
        invalid = 8 * data + invalid_bit
        if invalid_bit >= 8 * invalid_bytes:
            raise ReadError(f"damaged: the mark of '{name}' stands outside its record")
    return MdfChannel(
        name,
        unit or None,
        form,
        byte,
        bit,
        bits,
        data_type in _BIG_ENDIAN_TYPES,
        convert,
        invalid,
        clock,
    )


def _require_place(name: str, form: str, bit_position: tuple[int, int, int], size: int) -> None:
    """Refuse a channel outside its record; pass over one whose numbers have an odd length."""
    byte, bit, bits = bit_position
    if form == "f" and (bit or bits not in {16, 32, 64}):
        raise NoNumbersError(f"floating numbers of {bits} bits")
    if not 0 < bits <= 64 or bit + bits > 64:
        raise NoNumbersError(f"whole numbers of {bits} bits, {bit} bits into a byte")
    if byte + (bit + bits + 7) // 8 > size:
        raise ReadError(f"damaged: '{name}' stands outside its record")


def _read_conversion(
    blocks: _Mdf4Blocks, block: _Mdf4Block, *, is_integer: bool, depth: int = 0
) -> Conversion:
    kind, _, _, refs, count = struct.unpack_from("<BBHHH", block.data)
    if len(block.data) < 24 + 8 * count or refs > len(block.links) - 4:
        raise ReadError("damaged: a conversion says more parameters than it holds")
    values = struct.unpack_from(f"<{count}d", block.data, 24)
    links = block.links[4 : 4 + refs]
    if kind in _MAKERS:
        return _MAKERS[kind](values)
    if kind == _RANGES:
        return conversions.ranges(values, is_integer=is_integer)
    if kind == _FORMULA:
        formula = blocks.text(links[0]) if links else ""
        raise NoNumbersError(f"raw numbers of a formula, {formula[:60]}")
    if kind not in _STATES:
        raise NoNumbersError("names of states")
    pairs = (values, values) if kind == _STATES[0] else (values[::2], values[1::2])
    spans = list(zip(*pairs, strict=False))
    if len(links) not in {len(spans), len(spans) + 1} or depth > 2:
        raise ReadError("damaged: a conversion to text has a state too many or too few")
    conversions_of_states = [
        _convert_state(blocks, link, is_integer=is_integer, depth=depth) for link in links
    ]
    default_conversion = (
        conversions_of_states.pop() if len(conversions_of_states) > len(spans) else None
    )
    return conversions.some_text(
        spans, conversions_of_states, default_conversion, is_integer=is_integer
    )


def _convert_state(
    blocks: _Mdf4Blocks, link: int, *, is_integer: bool, depth: int
) -> Conversion | None:
    """Return how the numbers in a state are converted, None where the state has a name."""
    if not link:
        return None
    block = blocks.read_block(link, b"##TX", b"##MD", b"##CC")
    if block.kind != b"##CC":
        return None
    try:
        return _read_conversion(blocks, block, is_integer=is_integer, depth=depth + 1)
    except NoNumbersError:
        return None


def _iterate_bytes(address: int) -> Callable[[BinaryIO], Iterator[bytes]]:
    """Return a function that iterates over the bytes of the data at an address."""

    def pieces(stream: BinaryIO) -> Iterator[bytes]:
        if address:
            yield from _iterate_data(_Mdf4Blocks(stream), stream, address)

    return pieces


def _iterate_data(
    blocks: _Mdf4Blocks, stream: BinaryIO, address: int, depth: int = 0
) -> Iterator[bytes]:
    kinds = (b"##DT", b"##DZ", b"##DL", b"##HL", b"##DV", b"##LD")
    block = blocks.read_block(address, *kinds, read_all=False)
    if block.kind == b"##DT":
        yield from _read_stored(stream, block)
    elif block.kind == b"##DZ":
        yield _unpack(stream, block)
    elif block.kind in {b"##DV", b"##LD"}:
        raise ReadError(
            "its numbers are stored by columns (##DV, ##LD of MDF 4.2), which is not read; save it "
            "as MDF 4.1"
        )
    else:
        if block.kind == b"##HL":
            block = blocks.read_block(block.link(0), b"##DL", read_all=False)
        for link in _walk_lists(blocks, block):
            if link == address or depth:
                raise ReadError(f"damaged: lists of lists of data at byte {address}")
            yield from _iterate_data(blocks, stream, link, depth + 1)


def _walk_lists(blocks: _Mdf4Blocks, block: _Mdf4Block) -> Iterator[int]:
    """Yield the positions of the data of a list, and of the following lists."""
    while True:
        yield from filter(None, block.links[1:])
        if not block.link(0):
            return
        block = blocks.read_block(block.link(0), b"##DL", read_all=False)


def _read_stored(stream: BinaryIO, block: _Mdf4Block) -> Iterator[bytes]:
    read_offset, end = block.start, block.start + block.length
    while read_offset < end:
        stream.seek(read_offset)
        data = stream.read(min(PIECE, end - read_offset))
        if not data:
            raise ReadError("cut: its data ends beyond the end of the file")
        yield data
        read_offset += len(data)


def _unpack(stream: BinaryIO, block: _Mdf4Block) -> bytes:
    stream.seek(block.start)
    head = stream.read(24)
    if len(head) < 24:
        raise ReadError("cut: its data ends beyond the end of the file")
    original, kind, columns, size, packed_size = struct.unpack("<2sBxIQQ", head)
    if original != b"DT":
        raise ReadError(f"damaged: packed data of the kind {original!r}")
    if kind > 1:
        raise ReadError(
            f"its data is packed by a method ({kind}) of MDF 4.3 that is not read; save it with "
            "Deflate, or as MDF 4.1"
        )
    if packed_size > block.length - 24 or size > _LARGEST_BLOCK:
        raise ReadError(f"damaged: a packed block says {packed_size} bytes that unpack to {size}")
    packed_data = stream.read(packed_size)
    if len(packed_data) < packed_size:
        raise ReadError("cut: its data ends beyond the end of the file")
    unpacking = zlib.decompressobj()
    try:
        data = unpacking.decompress(packed_data, size + 1)
    except zlib.error as error:
        raise ReadError(f"damaged: packed data does not unpack ({error})") from None
    if len(data) != size or not unpacking.eof:
        raise ReadError(f"damaged: a packed block says {size} bytes and unpacks to others")
    if kind == 1 and columns > 1:
        lines = size // columns
        byte_matrix = np.frombuffer(data, np.uint8, lines * columns).reshape(columns, lines)
        data = byte_matrix.T.tobytes() + data[lines * columns :]
    return data


def _name_conversion_kinds(kinds: tuple[bytes, ...]) -> str:
    return " or ".join(kind.decode("latin-1") for kind in kinds)
