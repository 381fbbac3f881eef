"""Formats that are known by their first bytes and not read, with the export that keeps units."""

from __future__ import annotations

import zlib

from dashpot.base.errors import ReadError
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable

GZIP = b"\x1f\x8b\x08"
"""First bytes of a packed file."""
_ZS2 = b"\xaf\xbe\xad\xde"
_FAMOS = (
    "in imc FAMOS save the channels as TDMS, HDF5 or MDF 4, which keep units and clocks; an export "
    "as ASCII needs its line of units"
)
_CATMAN = (
    "in catman save it as MDF 4 or TDMS, or as ASCII with the head of channels: they keep units"
)
_ZWICK = "in testXpert export the series as text with the row of units"
_WAV = "save it as WAV"
_NAMED = {
    b"|CF,": ("an imc FAMOS file (|CF)", _FAMOS),
    b"FEA1": (
        "a Feather file of version 1",
        "write it as version 2 or as Parquet, which keep metadata (df.to_parquet)",
    ),
    b"riff": ("a Sony Wave64 file (.w64)", _WAV),
    b"fLaC": ("a FLAC file", _WAV),
    b"\x93NUMPY": (
        "an array of NumPy (.npy)",
        "it holds no units; write it as text with a header, or give the arrays in Python",
    ),
    b"SQLite": ("a database of SQLite", "export the table as text with names and units"),
}
"""What a file is by its first bytes, and what to do."""


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Refuse a file by the name of its format.

    Raises
    ------
    ReadError
        Always.
    """
    del options
    head = raw.head(4096)
    named = next((said for mark, said in _NAMED.items() if head.startswith(mark)), None)
    if named:
        what, how = named
    elif not head.startswith(GZIP):
        what, how = "a catman file (.bin)", _CATMAN
    elif _unpack_head(head).startswith(_ZS2):
        what, how = "a testXpert file (.zs2)", _ZWICK
    else:
        what, how = "a packed file (gzip)", "unpack it and give the file that is in it"
    raise ReadError(f"{what}, which is not read: {how}")


def _unpack_head(head: bytes) -> bytes:
    """Return the first bytes of what a packed file holds."""
    try:
        return zlib.decompressobj(31).decompress(head, 16)
    except zlib.error:
        return b""
