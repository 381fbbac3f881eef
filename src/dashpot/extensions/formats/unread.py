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


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Refuse a file by the name of its format.

    Raises
    ------
    ReadError
        Always.
    """
    del options
    head = raw.head(4096)
    if head.startswith(b"|CF,"):
        what, how = "an imc FAMOS file (|CF)", _FAMOS
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
