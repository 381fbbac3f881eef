"""Small ASAM MDF files, made by hand: block by block, also what no library writes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass
class Channel:
    """Channel of a group: its numbers are stored as `dtype`, bit by bit where `bits` says so."""

    name: str
    raw: Any
    unit: str = ""
    dtype: str = "<f8"
    kind: int = 0
    sync: int = 0
    flags: int = 0
    conversion: tuple[int, Sequence[float], Sequence[Any]] | None = None
    invalid: Any = None


@dataclass
class Group:
    channels: list[Channel]
    name: str = ""
    number: int = 0
    rows: int | None = None

    @property
    def records(self) -> list[bytes]:
        """The records, marks of invalid numbers behind."""
        count = max(len(channel.raw) for channel in self.channels if channel.dtype)
        marks = np.zeros((count, 1), np.uint8)
        parts = []
        for place, channel in enumerate(self.channels):
            if channel.dtype:
                values = np.asarray(channel.raw).astype(channel.dtype)
                parts.append(values.view(np.uint8).reshape(count, -1))
            if channel.invalid is not None:
                marks[:, 0] |= np.asarray(channel.invalid, np.uint8) << place
        return [bytes(row) for row in np.hstack([*parts, marks])]


@dataclass
class Writer:
    """Blocks of MDF 4, one behind the other."""

    data: bytearray = field(default_factory=lambda: bytearray(64))

    def block(self, kind: str, links: Sequence[int], data: bytes) -> int:
        self.data += bytes(-len(self.data) % 8)
        address = len(self.data)
        size = 24 + 8 * len(links) + len(data)
        self.data += struct.pack("<4s4xQQ", f"##{kind}".encode(), size, len(links))
        self.data += struct.pack(f"<{len(links)}Q", *links) + data
        return address

    def text(self, words: str) -> int:
        return self.block("TX", [], words.encode() + b"\0") if words else 0


def _kind_of(dtype: str) -> int:
    big = dtype[0] == ">"
    return {"u": 0, "i": 2, "f": 4}[dtype[1]] + big


def _conversion(file: Writer, kind: int, values: Sequence[float], refs: Sequence[Any]) -> int:
    links = [_conversion(file, *ref) if isinstance(ref, tuple) else file.text(ref) for ref in refs]
    data = struct.pack("<BBHHHdd", kind, 0, 0, len(links), len(values), 0.0, 0.0)
    return file.block("CC", [0, 0, 0, 0, *links], data + struct.pack(f"<{len(values)}d", *values))


def _group(file: Writer, group: Group, following: int) -> int:
    place, first = 0, []
    for channel in group.channels:
        first.append(place)
        place += np.dtype(channel.dtype).itemsize if channel.dtype else 0
    after = 0
    for k, channel in reversed(list(enumerate(group.channels))):
        bits = 8 * np.dtype(channel.dtype).itemsize if channel.dtype else 0
        conversion = _conversion(file, *channel.conversion) if channel.conversion else 0
        flags = channel.flags | 2 * (channel.invalid is not None)
        data = struct.pack(
            "<BBBBIIIIBBHdddddd", channel.kind, channel.sync,
            _kind_of(channel.dtype) if channel.dtype else 0, 0, first[k], bits, flags, k,
            0, 0, 0, *6 * [0.0],
        )  # fmt: skip
        links = [after, 0, file.text(channel.name), 0, conversion, 0, file.text(channel.unit), 0]
        after = file.block("CN", links, data)
    records = group.records
    rows = len(records) if group.rows is None else group.rows
    data = struct.pack("<QQHH4xII", group.number, rows, 0, 0, place, 1)
    return file.block("CG", [following, after, file.text(group.name), 0, 0, 0], data)


def pack_block(
    data: bytes, *, columns: int = 0, message: int | None = None, original: bytes = b"DT"
) -> bytes:
    """The data of a DZ block; `columns` transposes it."""
    whole = data
    if columns:
        lines = len(data) // columns
        head = np.frombuffer(data, np.uint8, lines * columns).reshape(lines, columns)
        whole = head.T.tobytes() + data[lines * columns :]
    stored = zlib.compress(whole, 9)
    size = len(data) if message is None else message
    return struct.pack("<2sBxIQQ", original, bool(columns), columns, size, len(stored)) + stored


def mdf4(
    *sets: Sequence[Group], how: str = "DT", id_size: int = 0, comment: str = "",
    mark: bytes = b"MDF     ", order: Sequence[int] = (), version: bytes = b"4.10    ",
) -> bytes:  # fmt: skip
    """A file of sets of groups, each set in data of its own.

    `how` it is kept: DT, DZ, DZT (transposed), DL, HL. Several groups of a set are unsorted: their
    records take turns, or follow in the `order` of groups.
    """
    file = Writer()
    header = file.block("HD", [0, 0, 0, 0, 0, 0], struct.pack("<QhhBBBxdd", 0, 0, 0, 0, 0, 0, 0, 0))
    assert header == 64
    first, note = 0, file.text(comment)
    for groups in reversed(sets):
        following = 0
        for group in reversed(groups):
            following = _group(file, group, following)
        data = _store_data(_interleave_groups(groups, id_size, order), how, file)
        first = file.block("DG", [first, following, data, 0], struct.pack("<B7x", id_size))
    struct.pack_into("<Q", file.data, 64 + 24, first)
    struct.pack_into("<Q", file.data, 64 + 24 + 40, note)
    struct.pack_into("<8s8s8s4xH", file.data, 0, mark, version, b"by hand ", int(version[:1]) * 100)
    return bytes(file.data)


def _interleave_groups(groups: Sequence[Group], id_size: int, order: Sequence[int]) -> bytes:
    waiting = [list(group.records) for group in groups]
    if not order:
        order = [
            i
            for k in range(max(map(len, waiting)))
            for i in range(len(groups))
            if k < len(waiting[i])
        ]
    parts = []
    for i in order:
        parts.append(groups[i].number.to_bytes(id_size, "little") if id_size else b"")
        parts.append(waiting[i].pop(0))
    return b"".join(parts)


def _store_data(data: bytes, how: str, file: Writer) -> int:
    if how == "DT":
        return file.block("DT", [], data)
    if how in {"DZ", "DZT"}:
        return file.block("DZ", [], pack_block(data, columns=17 if how == "DZT" else 0))
    size = max(1, len(data) // 5 + 3)
    pieces = [data[k : k + size] for k in range(0, len(data), size)]
    blocks = [
        file.block("DZ", [], pack_block(piece)) if how == "HL" else file.block("DT", [], piece)
        for piece in pieces
    ]
    half = len(blocks) // 2
    rest = file.block("DL", [0, *blocks[half:]], struct.pack("<B3xIQ", 1, len(blocks) - half, size))
    lists = file.block("DL", [rest, *blocks[:half]], struct.pack("<B3xIQ", 1, half, size))
    return file.block("HL", [lists], struct.pack("<HB5x", 1, 0)) if how == "HL" else lists


def mdf3(
    channels: Sequence[Channel], *, order: str = "<", step: float = 0.0,
    version: bytes = b"3.30    ",
    rows: int | None = None,
) -> bytes:  # fmt: skip
    """A file of MDF 3 of one group, in the byte order given."""
    data = bytearray(64 + 164)
    group = Group(list(channels))
    records = [record[:-1] for record in group.records]

    def add(block: bytes) -> int:
        data.extend(block)
        return len(data) - len(block)

    after, place = 0, sum(np.dtype(channel.dtype).itemsize for channel in channels)
    size = place
    for channel in reversed(channels):
        place -= np.dtype(channel.dtype).itemsize
        kind, values = (channel.conversion or (65535, (), ()))[:2]
        body = struct.pack(f"{order}{len(values)}d", *values)
        count = len(values) // 2 if kind in {1, 2} else len(values)
        conversion = add(
            struct.pack(f"{order}2sHHdd20sHH", b"CC", 46 + len(body), 0, 0, 0,
                        channel.unit.encode("latin-1"), kind, count) + body
        )  # fmt: skip
        stored = {"u": 0, "i": 1, "f": 3}[channel.dtype[1]]
        if channel.dtype == f"{order}f4":
            stored = 2
        elif channel.dtype[0] != order:
            stored = {"u": 9, "i": 10, "f": 12}[channel.dtype[1]] + (
                4 if channel.dtype[0] == "<" else 0
            )
        block = struct.pack(
            f"{order}2sH5IH32s128s4H3d", b"CN", 218, after, conversion, 0, 0, 0, channel.sync,
            channel.name.encode("latin-1"), b"", 8 * place, 8 * np.dtype(channel.dtype).itemsize,
            stored, 0, 0, 0, step,
        )  # fmt: skip
        after = add(block)
    count = len(records) if rows is None else rows
    at = add(struct.pack(f"{order}2sH3I3HI", b"CG", 26, 0, after, 0, 0, len(channels), size, count))
    stored_at = add(b"".join(records))
    first = add(struct.pack(f"{order}2sH4I2H4x", b"DG", 28, 0, at, 0, stored_at, 1, 0))
    struct.pack_into("8s8s8sHHH", data, 0, b"MDF     ", version, b"by hand ", 0, 0, 330)
    struct.pack_into(f"{order}HH", data, 24, order == ">", 0)
    struct.pack_into(f"{order}2sHIIIH", data, 64, b"HD", 164, first, 0, 0, 1)
    return bytes(data)
