"""Small files that cost much: what each unpacks to is said with it."""

from __future__ import annotations

import json
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import h5py

from kit.instruments import ods, uff, workbook, xls
from kit.mdf_files import Channel, Group, mdf4


def _inflating(before: bytes, count: int) -> bytes:
    """A zlib stream of `before` and so many zeros: one block again and again takes no time."""
    at_once = 1 << 22
    squeeze = zlib.compressobj(9)
    head = squeeze.compress(before) + squeeze.flush(zlib.Z_FULL_FLUSH)
    block = squeeze.compress(bytes(at_once)) + squeeze.flush(zlib.Z_FULL_FLUSH)
    rest = squeeze.compress(bytes(count % at_once)) + squeeze.flush()
    low, high = zlib.adler32(before) & 0xFFFF, zlib.adler32(before) >> 16
    checksum = ((high + count * low) % 65521) << 16 | low
    return head + count // at_once * block + rest[:-4] + struct.pack(">I", checksum)


def _variable(claimed: int, count: int) -> bytes:
    """A compressed MAT variable that claims so many numbers, and inflates to as many zeros."""
    array = struct.pack("<4I", 6, 8, 6, 0) + struct.pack("<2I2i", 5, 8, claimed, 1)
    array += struct.pack("<2I8s2I", 1, 8, b"force_mN", 9, 8 * claimed)
    whole = struct.pack("<2I", 14, len(array) + 8 * claimed) + array
    packed = _inflating(whole, 8 * count)
    return struct.pack("<2I", 15, len(packed)) + packed


def _mat(path: Path, variables: bytes) -> None:
    header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    path.write_bytes(header + variables)


def mat_of_three_gigabytes(path: Path) -> None:
    _mat(path, _variable(400 << 20, 400 << 20))


def mat_of_many_arrays(path: Path) -> None:
    _mat(path, _variable(4 << 20, 4 << 20) * 20)


def mat_of_more_than_it_claims(path: Path) -> None:
    _mat(path, _variable(10, 650 << 20))


def h5_never_written(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for i in range(64):
            file.create_dataset(f"x{i}", shape=(1 << 25,), chunks=(1 << 20,), dtype="f8")


def h5_of_zeros(path: Path) -> None:
    chunk = zlib.compress(bytes(8 << 20))
    with h5py.File(path, "w") as file:
        for i in range(64):
            data = file.create_dataset(f"x{i}", (1 << 24,), "f8", chunks=(1 << 20,), compression=9)
            for at in range(16):
                data.id.write_direct_chunk((at << 20,), chunk)


def write_h5_with_huge_chunk(path: Path) -> None:
    """A chunk that inflates to far more than it should."""
    with h5py.File(path, "w") as file:
        data = file.create_dataset("x", (1000,), "f8", chunks=(1000,), compression=9)
        data.id.write_direct_chunk((0,), _inflating(b"", 2 << 30))


def h5_of_groups_linked_twice(path: Path) -> None:
    with h5py.File(path, "w") as file:
        group = file
        for _ in range(60):
            inner = group.create_group("a")
            group["b"] = inner
            group = inner
        group["c"] = file


def h5_of_a_deep_chain(path: Path) -> None:
    with h5py.File(path, "w") as file:
        group = file
        for _ in range(3000):
            group = group.create_group("a")


def write_xlsx_with_far_cell(path: Path) -> None:
    workbook(path, {"One": []}, body='<row r="1048576"><c r="A1"><v>1</v></c>'
             '<c r="XFD1048576"><v>1</v></c></row>')  # fmt: skip


def xlsx_of_many_cells(path: Path) -> None:
    row = b"<row>" + b"<c><v>1</v></c>" * 1000 + b"</row>"
    workbook(path, {"One": []}, body="HERE")
    _repeat_block(path, row * 100, 250)


def write_xlsx_with_long_string(path: Path) -> None:
    workbook(path, {"One": []}, strings="<si><t>HERE</t></si>")
    _repeat_block(path, b"x" * (1 << 20), 1024)


def xlsx_that_lies_about_its_size(path: Path) -> None:
    workbook(path, {"One": []}, body="HERE")
    _repeat_block(path, b" " * (1 << 20), 3 << 10, lie=True)


def ods_of_repeated_cells(path: Path) -> None:
    cell = '<table:table-cell table:number-columns-repeated="1000" office:value-type="float" '
    cell += 'office:value="1"><text:p>1</text:p></table:table-cell>'
    ods(path, f'<table:table-row table:number-rows-repeated="20000">{cell}</table:table-row>')


def ods_of_blanks(path: Path) -> None:
    ods(path, "HERE")
    _repeat_block(path, b" " * (1 << 20), 1024)


def _repeat_block(path: Path, block: bytes, times: int, *, lie: bool = False) -> None:
    """Put a block so many times where a zipped workbook says HERE: its bytes are packed once."""
    with zipfile.ZipFile(path) as file:
        parts = {name: file.read(name) for name in file.namelist()}
    out, folder = b"", b""
    for name, content in parts.items():
        before, here, after = content.partition(b"HERE")
        squeeze = zlib.compressobj(9, zlib.DEFLATED, -15)
        packed = squeeze.compress(before) + squeeze.flush(zlib.Z_FULL_FLUSH)
        size, crc = len(content), zlib.crc32(before)
        if here:
            packed += times * (squeeze.compress(block) + squeeze.flush(zlib.Z_FULL_FLUSH))
            size = 100 if lie else len(before) + times * len(block) + len(after)
            for _ in range(times):
                crc = zlib.crc32(block, crc)
        packed += squeeze.compress(after) + squeeze.flush()
        common = struct.pack("<HHHHHIIIHH", 20, 0, 8, 0, 0, zlib.crc32(after, crc), len(packed),
                             size, len(name), 0)  # fmt: skip
        folder += b"PK\x01\x02\x14\0" + common + struct.pack("<HHHII", 0, 0, 0, 0, len(out))
        folder += name.encode()
        out += b"PK\x03\x04" + common + name.encode() + packed
    end = struct.pack("<HHHHIIH", 0, 0, len(parts), len(parts), len(folder), len(out), 0)
    path.write_bytes(out + folder + b"PK\x05\x06" + end)


def write_xls_with_far_cell(path: Path) -> None:
    xls(path, [[1.0]], more=struct.pack("<HHHHHd", 0x203, 14, 65535, 65535, 0, 1.0))


def trios_of_short_rows(path: Path) -> None:
    columns = [{"name": str(i)} for i in range(16_000)]
    text = json.dumps({"columns": columns, "values": [[]] * 30_000}, separators=(",", ":"))
    path.write_text(text)


def trios_of_brackets(path: Path) -> None:
    path.write_text('{"values": [' + "[]," * 15_000_000 + "[]]}")


def tdms_of_claims(path: Path) -> None:
    """A channel of 2^60 numbers in a segment that says that it goes on for ever."""

    def text(word: str) -> bytes:
        return struct.pack("<I", len(word)) + word.encode()

    meta = struct.pack("<I", 1) + text("/'a'/'b'") + struct.pack("<IIIQ", 20, 10, 1, 1 << 60)
    meta += struct.pack("<I", 0)
    lead = b"TDSm" + struct.pack("<IIQQ", 0b1110, 4713, (1 << 64) - 1, len(meta))
    path.write_bytes(lead + meta + bytes(80))


def mdf_of_zeros(path: Path) -> None:
    """Two groups whose records take turns, in blocks of zeros that are packed a thousandfold."""
    groups = [Group([Channel("a", [0], dtype="<u1")], number=k, rows=1 << 20) for k in (0, 1)]
    data = bytearray(mdf4(groups, id_size=1))
    place = data.find(b"##DT")
    stored = _inflating(b"", 1 << 26)
    body = struct.pack("<2sBxIQQ", b"DT", 0, 0, 1 << 26, len(stored)) + stored
    data += bytes(-len(data) % 8)
    block = len(data)
    data += struct.pack("<4s4xQQ", b"##DZ", 24 + len(body), 0) + body + bytes(-len(body) % 8)
    link = data.find(struct.pack("<Q", place), data.find(b"##DG"))
    struct.pack_into("<Q", data, link, len(data))
    data += struct.pack("<4s4xQQ500Q", b"##DL", 24 + 8 * 500 + 16, 500, 0, *[block] * 499)
    path.write_bytes(bytes(data) + struct.pack("<B3xIQ", 1, 499, 1 << 26))


def mdf_of_claims(path: Path) -> None:
    """A group of a thousand million records that are not there."""
    path.write_bytes(mdf4([Group([Channel("a", [0.0])], rows=10**9)]))


def uff_of_claims(path: Path) -> None:
    """A dataset 58 that claims two thousand million points."""
    uff(path, labels=("N", "g"), length=None)
    text = path.read_text()
    assert "         4        30" in text
    path.write_text(text.replace("         4        30", "         42000000000"))


BOMBS: dict[Callable[[Path], None], str] = {
    mat_of_three_gigabytes: "the variables hold 419430400 numbers in all, and at most 33554432",
    mat_of_many_arrays: "the variables hold 37748736 numbers in all",
    mat_of_more_than_it_claims: "a broken or unknown variety of matlab",
    h5_never_written: "no numeric channels found",
    h5_of_zeros: "the datasets hold 1073741824 numbers in all",
    write_h5_with_huge_chunk: "cannot be read: OSError",
    h5_of_groups_linked_twice: "no numeric channels found",
    h5_of_a_deep_chain: "a broken or unknown variety of hdf5: RecursionError",
    write_xlsx_with_far_cell: "the reader of workbook files ended with SIGABRT",
    xlsx_of_many_cells: "the reader of workbook files ended with SIGABRT",
    write_xlsx_with_long_string: "the reader of workbook files ended with SIGABRT",
    xlsx_that_lies_about_its_size: (
        "File is larger than its declared uncompressed size | damaged, or unpacks to more | "
        "Bad CRC-32"
    ),
    ods_of_repeated_cells: "the reader of workbook files ended with SIGABRT",
    ods_of_blanks: "the reader of workbook files ended with SIGABRT",
    write_xls_with_far_cell: "the reader of workbook files ended with SIGABRT",
    trios_of_short_rows: "a data set holds 480000000 numbers in all",
    trios_of_brackets: "takes more than 1 GiB of memory to read as trios",
    tdms_of_claims: "",
    mdf_of_zeros: "its groups say 2097152 records together",
    mdf_of_claims: "the channels hold 1000000000 numbers in all",
    uff_of_claims: "",
}
"""How each is refused; "" where its claim is not believed, and what it holds is read."""
