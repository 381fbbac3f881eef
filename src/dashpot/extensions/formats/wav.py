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
_WHOLE = {1: "u1", 2: "<i2", 3: "", 4: "<i4"}
_FLOATS = {4: "<f4", 8: "<f8"}
_UNKNOWN = 0xFFFFFFFF


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the channels of a file as parts of full scale, with the time in front.

    Raises
    ------
    ReadError
        If the file is cut, packed, or of a kind of number that is not known.
    """
    del options
    with raw.open() as stream:
        form, data = _read_chunks(stream)
    if len(form) < 16:
        raise ReadError("a WAV file without a chunk 'fmt ': it is damaged")
    kind, channels, rate, _, block, bits = struct.unpack_from("<HHIIHH", form)
    if kind == _EXTENSIBLE and len(form) >= 26:
        kind = struct.unpack_from("<H", form, 24)[0]
    size = block // channels if channels else 0
    known = (_WHOLE if kind == _PCM else _FLOATS if kind == _FLOAT else {}).get(size)
    if known is None or block != size * channels or not rate:
        raise ReadError(
            f"a WAV file of {bits} bits in the coding {kind}, which is not read; save it as PCM "
            "(16, 24 or 32 bits) or as floats"
        )
    rows = len(data) // block
    check_value_count(rows * (channels + 1), "the channels hold")
    if len(data) % block:
        raise ReadError("a WAV file that ends within a sample: it was cut")
    values = _scale_samples(data, known, size).reshape(rows, channels)
    time = np.arange(rows) / rate
    names = [f"channel {i + 1}" for i in range(channels)]
    scaled = "whole numbers, 1 is their largest" if kind == _PCM else "floats, as stored"
    return FileTable(
        format="WAV",
        columns=(Column("time", "s"), *(Column(name) for name in names)),
        load=make_loader(np.column_stack([time, values])),
        notes=(
            (
                f"the numbers are parts of full scale ({scaled}), which a WAV file does not state: "
                "say which column is what, and what 1 means, such as --column force=2 --units "
                "force=50N"
            ),
        ),
    )


def _read_chunks(stream: BinaryIO) -> tuple[bytes, bytes]:
    """Return the bytes of the format and those of the samples."""
    head = stream.read(12)
    if head[8:] != b"WAVE" or head[:4] != b"RIFF":
        raise ReadError(
            f"a RIFF file of the kind {head[8:]!r}, which is not read; save it as WAV or as text"
        )
    form = b""
    while len(chunk := stream.read(8)) == 8:
        name, size = struct.unpack("<4sI", chunk)
        if name == b"data":
            if size == _UNKNOWN:
                raise ReadError("a WAV file whose recorder never wrote its length; save it again")
            data = stream.read(size)
            if len(data) < size:
                raise ReadError(f"cut: it says {size} bytes of samples and holds {len(data)}")
            return form, data
        content = stream.read(size + size % 2)
        if name == b"fmt ":
            form = content
    raise ReadError("a WAV file without samples: it was cut")


def _scale_samples(data: bytes, kind: str, size: int) -> FloatArray:
    """Return samples as parts of full scale; floats as they are."""
    if kind == "u1":
        return (np.frombuffer(data, "u1").astype(float) - 128) / 128
    if not kind:
        wide = np.zeros((len(data) // 3, 4), "u1")
        wide[:, 1:] = np.frombuffer(data, "u1").reshape(-1, 3)
        return wide.view("<i4")[:, 0].astype(float) / 2**31
    values = np.frombuffer(data, kind).astype(float)
    return values / 2 ** (8 * size - 1) if kind[1] == "i" else values
