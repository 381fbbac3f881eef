"""Blocks of ASAM MDF 2 and 3: groups, channels, conversions and data."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from functools import partial
from typing import BinaryIO

from dashpot.base.errors import ReadError
from dashpot.extensions.formats import mdf_conversions as conversions
from dashpot.extensions.formats.mdf4 import Content
from dashpot.extensions.formats.mdf_conversions import Conversion, NoNumbersError
from dashpot.extensions.formats.mdf_records import PIECE, MdfChannel, MdfGroup

_MAX_BLOCKS = 1 << 18
_KINDS = {0: "u", 1: "i", 2: "f", 3: "f", 9: "u", 10: "i", 11: "f", 12: "f", 13: "u", 14: "i",
          15: "f", 16: "f"}  # fmt: skip
_WORDS = {
    7: "text",
    8: "bytes",
    4: "numbers of a VAX",
    5: "numbers of a VAX",
    6: "numbers of a VAX",
}
_BIG_ENDIAN_TYPES, _LITTLE_ENDIAN_TYPES = {9, 10, 11, 12}, {13, 14, 15, 16}
_FORMULA, _NONE = 10, 65535
_STATES = {11: "names of states", 12: "names of states"}
_PARAMETER_COUNTS = {0: 2, 1: 0, 2: 0, 6: 6, 7: 7, 8: 7, 9: 6}
"""Parameters of a conversion that gives numbers; 0 of a table."""
_MAKERS: dict[int, Callable[[list[float]], Conversion]] = {
    0: conversions.linear,
    1: conversions.interpolated_table,
    2: conversions.exact_table,
    6: conversions.mdf3_polynomial,
    7: partial(conversions.mdf3_exponential, logarithm=False),
    8: partial(conversions.mdf3_exponential, logarithm=True),
    9: conversions.rational,
}


class _Mdf3Blocks:
    """Blocks of an open file, in its own byte order."""

    def __init__(self, stream: BinaryIO, order: str, numbers: str) -> None:
        self._stream, self.order, self.numbers = stream, order, numbers
        self._count = 0

    def read_block(self, address: int, kind: bytes, min_size: int) -> bytes:
        """Return the bytes of the block of a kind at an address, with a minimum size."""
        self._count += 1
        if self._count > _MAX_BLOCKS:
            raise ReadError(f"more than {_MAX_BLOCKS} blocks: its links go round, or it is no test")
        self._stream.seek(address)
        head = self._stream.read(4)
        block_kind, size = struct.unpack(f"{self.order}2sH", head) if len(head) == 4 else (b"", 0)
        if block_kind != kind or size < min_size:
            raise ReadError(f"damaged or cut: no block of kind {kind.decode()} at byte {address}")
        data = head + self._stream.read(size - 4)
        if len(data) < size:
            raise ReadError(f"cut: the block at byte {address} ends beyond the end of the file")
        return data

    def unpack(self, form: str, data: bytes, offset: int) -> tuple[int, ...]:
        return struct.unpack_from(self.order + form, data, offset)

    def link(self, data: bytes, offset: int) -> int:
        """Return the address at a place of a block."""
        return self.unpack("I", data, offset)[0]

    def text(self, address: int) -> str:
        """Return a text; empty without one."""
        return _decode_text(self.read_block(address, b"TX", 4)[4:]) if address else ""

    def chain(self, address: int, kind: bytes, min_size: int) -> Iterator[bytes]:
        """Yield a block and its successors."""
        while address:
            block = self.read_block(address, kind, min_size)
            yield block
            address = self.link(block, 4)


def read_blocks(stream: BinaryIO) -> Content:
    """Return the contents of the blocks of an open file.

    Raises
    ------
    ReadError
        If a block is missing or broken.
    """
    stream.seek(24)
    numbers = "<" if stream.read(2) == b"\0\0" else ">"
    stream.seek(66)
    # some programs keep their blocks little-endian whatever the numbers are
    order = "<" if stream.read(2)[1:] == b"\0" else ">"
    blocks = _Mdf3Blocks(stream, order, numbers)
    header = blocks.read_block(64, b"HD", 164)
    content = Content()
    lines = blocks.text(blocks.link(header, 8)).splitlines()
    date, clock = _decode_text(header[18:28]), _decode_text(header[28:36])
    content.header = [line.strip() for line in lines if line.strip()]
    content.header += [f"recorded: {date} {clock} (local time)"] if date else []
    for data_group in blocks.chain(blocks.link(header, 4), b"DG", 24):
        _read_data_group(blocks, data_group, content)
    return content


def _read_data_group(blocks: _Mdf3Blocks, data_group: bytes, content: Content) -> None:
    """Read the channel groups of one data group."""
    numbers = blocks.unpack("H", data_group, 22)[0]
    if numbers > 2:
        raise ReadError(f"damaged: records carry {numbers} numbers")
    groups = list(blocks.chain(blocks.link(data_group, 8), b"CG", 26))
    if len(groups) > 1 and not numbers:
        raise ReadError("damaged: records of several groups carry no number")
    sizes: dict[int, int | None] = {}
    length = total = 0
    for group in groups:
        number, _, size, rows = blocks.unpack("HHHI", group, 16)
        if number in sizes:
            raise ReadError("damaged: two groups of the same data have one number")
        sizes[number] = size
        total += rows
        length += rows * (size + numbers)
    pieces = _iterate_bytes(blocks.link(data_group, 16), length)
    for group in groups:
        number, _, size, rows = blocks.unpack("HHHI", group, 16)
        comment = blocks.text(blocks.link(group, 12)).partition("\n")[0]
        name = comment.strip() or f"group {len(content.groups) + 1}"
        channels = []
        steps: dict[str, float] = {}
        for block in blocks.chain(blocks.link(group, 8), b"CN", 218):
            label = _read_name(blocks, block)
            steps[label] = blocks.unpack("d", block, 210)[0]
            try:
                channels.append(_read_channel(blocks, block, label, size))
            except NoNumbersError as error:
                content.passed[label] = str(error)
        if not any(channel.clock for channel in channels):
            content.hints |= _rate_hints(steps)
        content.groups.append(
            MdfGroup(
                name=name, rows=rows, size=size, channels=tuple(channels), pieces=pieces,
                number=number, sizes=sizes if len(groups) > 1 else {}, id_size=min(numbers, 1),
                total=total, id_after=max(numbers - 1, 0),
            )
        )  # fmt: skip


def _rate_hints(steps: dict[str, float]) -> dict[str, str]:
    """Return notes on the sampling rate of channels without a clock."""
    return {
        f"{1 / step:.10g}": f"the file says that '{label}' has a sample each {step:g} s; if that "
        f"is right, add --rate {1 / step:.10g}Hz"
        for label, step in reversed(steps.items())
        if step > 0
    }


def _read_name(blocks: _Mdf3Blocks, block: bytes) -> str:
    long_name_address = blocks.link(block, 218) if len(block) >= 222 else 0
    return blocks.text(long_name_address) or _decode_text(block[26:58])


def _read_channel(blocks: _Mdf3Blocks, block: bytes, name: str, size: int) -> MdfChannel:
    kind = blocks.unpack("H", block, 24)[0]
    start, bits, number_type = blocks.unpack("HHH", block, 186)
    extra_bytes = blocks.unpack("H", block, 226)[0] if len(block) >= 228 else 0
    if blocks.link(block, 16):
        raise NoNumbersError("arrays or structures")
    if number_type not in _KINDS:
        raise NoNumbersError(
            _WORDS.get(number_type, f"a kind of number ({number_type}) that is not known")
        )
    form, (byte, bit) = _KINDS[number_type], divmod(start, 8)
    byte += extra_bytes
    unit, convert = _read_conversion(blocks, blocks.link(block, 8))
    if kind == 1 and not bits:
        step = blocks.unpack("d", block, 210)[0]
        if not step > 0:
            raise ReadError("damaged: a clock that is not stored says no step")
        clock = conversions.linear([0.0, float(step)])
        return MdfChannel(name, unit or "s", "row", convert=clock, clock=True)
    if form == "f" and (bit or bits not in {32, 64}):
        raise NoNumbersError(f"floating numbers of {bits} bits")
    if not 0 < bits <= 64 or bit + bits > 64:
        raise NoNumbersError(f"whole numbers of {bits} bits, {bit} bits into a byte")
    if byte + (bit + bits + 7) // 8 > size:
        raise ReadError(f"damaged: '{name}' stands outside its record")
    big = number_type in _BIG_ENDIAN_TYPES or (
        number_type not in _LITTLE_ENDIAN_TYPES and blocks.numbers == ">"
    )
    return MdfChannel(name, unit, form, byte, bit, bits, big, convert, clock=kind == 1)


def _read_conversion(blocks: _Mdf3Blocks, address: int) -> tuple[str | None, Conversion]:
    """Return the unit and the conversion of a channel."""
    if not address:
        return None, conversions.keep_raw
    block = blocks.read_block(address, b"CC", 46)
    unit = _decode_text(block[22:42]) or None
    kind, count = blocks.unpack("HH", block, 42)
    if kind == _NONE:
        return unit, conversions.keep_raw
    if kind not in _PARAMETER_COUNTS:
        formula = f"raw numbers of a formula, {_decode_text(block[46:])[:60]}"
        raise NoNumbersError(formula if kind == _FORMULA else _STATES.get(kind, "dates"))
    size = _PARAMETER_COUNTS[kind] or 2 * count
    if len(block) < 46 + 8 * size:
        raise ReadError("damaged: a conversion says more parameters than it holds")
    values = [float(value) for value in blocks.unpack(f"{size}d", block, 46)]
    return unit, _MAKERS[kind](values)


def _iterate_bytes(address: int, length: int) -> Callable[[BinaryIO], Iterator[bytes]]:
    """Return a reader of bytes from an address."""

    def pieces(stream: BinaryIO) -> Iterator[bytes]:
        address_read, end = address, address + length * bool(address)
        while address_read < end:
            stream.seek(address_read)
            data = stream.read(min(PIECE, end - address_read))
            if not data:
                return
            yield data
            address_read += len(data)

    return pieces


def _decode_text(data: bytes) -> str:
    return data.split(b"\0", 1)[0].decode("latin-1").strip()
