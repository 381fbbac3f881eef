"""WAV files: channels of a recorder, whose full scale is stated by the user."""

from __future__ import annotations

import struct
from typing import BinaryIO

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox.limits import check_value_count
from dashpot.reading.table import Column, FileTable, make_loader

_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_WHOLE = {1: "u1", 2: "i2", 3: "", 4: "i4"}
_FLOATS = {4: "f4", 8: "f8"}
_UNKNOWN = 0xFFFFFFFF
_ORDERS = {b"RIFF": "<", b"RIFX": ">", b"RF64": "<", b"BW64": "<"}
"""Byte order by the first bytes; RF64 and BW64 keep sizes beyond 4 GiB in a chunk of their own."""
FULL_SCALE = "1 = full scale"
"""Note on the scale of every channel."""


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the channels of a file as parts of full scale, with the time in front.

    Raises
    ------
    ReadError
        If the file is cut, packed, or of a kind of number that is not known.
    """
    del options
    with raw.open() as stream:
        order, form, data = _read_chunks(stream)
    if len(form) < 16:
        raise ReadError("a WAV file without a chunk 'fmt ': it is damaged")
    kind, channels, rate, _, block, bits = struct.unpack_from(f"{order}HHIIHH", form)
    valid_bits = bits
    if kind == _EXTENSIBLE and len(form) >= 26:
        valid_bits = struct.unpack_from(f"{order}H", form, 18)[0] or bits
        kind = struct.unpack_from(f"{order}H", form, 24)[0]
    size = block // channels if channels else 0
    sample_type = (_WHOLE if kind == _PCM else _FLOATS if kind == _FLOAT else {}).get(size)
    if (
        sample_type is None
        or block != size * channels
        or not rate
        or not 0 < valid_bits <= 8 * size
    ):
        raise ReadError(
            f"a WAV file of {bits} bits in the coding {kind}, which is not read; save it as PCM "
            "(16, 24 or 32 bits) or as floats"
        )
    rows = len(data) // block
    check_value_count(rows * (channels + 1), "the channels hold")
    if len(data) % block:
        raise ReadError("a WAV file that ends within a sample: it was cut")
    values = _scale_samples(data, order, sample_type, size)
    if kind == _PCM and valid_bits < 8 * size and (values * 2.0 ** (valid_bits - 1) % 1).any():
        raise ReadError(
            f"a WAV file of {valid_bits} bits in {8 * size} whose samples do not stand in the "
            "upper bits, as the format has it, so that its full scale is not known; save it as "
            f"PCM of {valid_bits} bits"
        )
    time = np.arange(rows) / rate
    names = [f"channel {i + 1}" for i in range(channels)]
    scaling_note = "whole numbers, 1 is their largest" if kind == _PCM else "floats, as stored"
    return FileTable(
        format="WAV",
        columns=(Column("time", "s"), *(Column(name, factor=FULL_SCALE) for name in names)),
        load=make_loader(np.column_stack([time, values.reshape(rows, channels)])),
        notes=(
            (
                f"the numbers are parts of full scale ({scaling_note}), which a WAV file does not "
                "state: say which column is what, and what 1 means, such as --column force=2 "
                "--units force=50N"
            ),
        ),
    )


def _read_chunks(stream: BinaryIO) -> tuple[str, bytes, bytes]:
    """Return the byte order, the bytes of the format and those of the samples."""
    head = stream.read(12)
    order = _ORDERS.get(head[:4], "")
    if head[8:] != b"WAVE" or not order:
        raise ReadError(
            f"a RIFF file of the kind {head[8:]!r}, which is not read; save it as WAV or as text"
        )
    form = b""
    chunk_size = _UNKNOWN
    while len(chunk := stream.read(8)) == 8:
        name, size = struct.unpack(f"{order}4sI", chunk)
        if name == b"data":
            size = chunk_size if size == _UNKNOWN else size
            if size == _UNKNOWN:
                raise ReadError("a WAV file whose recorder never wrote its length; save it again")
            data = stream.read(size)
            if len(data) < size:
                raise ReadError(f"cut: it says {size} bytes of samples and holds {len(data)}")
            return order, form, data
        content = stream.read(size + size % 2)
        if name == b"fmt ":
            form = content
        elif name == b"ds64" and len(content) >= 16:
            chunk_size = struct.unpack_from("<Q", content, 8)[0]
    raise ReadError("a WAV file without samples: it was cut")


def _scale_samples(data: bytes, order: str, kind: str, size: int) -> FloatArray:
    """Return samples as parts of full scale; floats as they are."""
    if kind == "u1":
        return (np.frombuffer(data, "u1").astype(float) - 128) / 128
    if not kind:
        padded_values = np.zeros((len(data) // 3, 4), "u1")
        packed_bytes = np.frombuffer(data, "u1").reshape(-1, 3)
        padded_values[:, 1:] = packed_bytes if order == "<" else packed_bytes[:, ::-1]
        return padded_values.view("<i4")[:, 0].astype(float) / 2**31
    values = np.frombuffer(data, order + kind).astype(float)
    return values / 2 ** (8 * size - 1) if kind[0] == "i" else values
