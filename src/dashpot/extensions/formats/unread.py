"""Formats recognised by their first bytes but not read, with an export that keeps units."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

from dashpot.base.errors import ReadError
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable

GZIP = b"\x1f\x8b\x08"
"""First bytes of a packed file."""
_OFFICE = ("word/", "ppt/", "visio/")
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
_DEWESOFT = (
    "in Dewesoft export it as MDF 4, HDF5, TDMS or UFF 58, which keep units, clock and scale; an "
    "export as text needs its units"
)
_UNPACK = "unpack it and give the file that is in it"
_TABLE = "export the table as text with names and units"
_OPEN_TABLE = "open it there and export the table as text with a row of names and one of units"
_ARRAY = "write it as text with a header (Python: dp.fit(t, x, F, units=...) takes the arrays)"
_NAMED = {
    b"|CF,": ("an imc FAMOS file (|CF)", _FAMOS),
    b"MULTI_STREAM_FILE": ("a Dewesoft file (.dxd, .d7d)", _DEWESOFT),
    b"FORMAT\0\0": (
        "an MTS RPC III file (.rsp, .drv, .tim)",
        "in RPC Pro export it as text with names and units, or as MAT",
    ),
    b"DIAHEAD": (
        "a DIAdem header (.dat), whose numbers are in other files",
        "in DIAdem save the data as TDMS, which keeps units and clocks",
    ),
    b"CDF\x01": ("a netCDF file of version 3", "nccopy -k nc4 in.nc out.nc makes HDF5 of it"),
    b"CDF\x02": ("a netCDF file of version 3", "nccopy -k nc4 in.nc out.nc makes HDF5 of it"),
    b"CDF\x05": ("a netCDF file of version 3", "nccopy -k nc4 in.nc out.nc makes HDF5 of it"),
    b"\x0e\x03\x13\x01": ("an HDF 4 file", "h4toh5 makes HDF5 of it, which keeps attributes"),
    b"CPYA ": ("an Origin project (.opj)", _OPEN_TABLE),
    b"CPYUA ": ("an Origin project (.opju)", _OPEN_TABLE),
    b"\0\1\0\0Standard": ("an Access database (.mdb, .accdb)", _TABLE),
    b"$FL2": ("an SPSS file (.sav)", _TABLE),
    b"%PDF": ("a PDF document", "export the record of the test as text or as a workbook"),
    b"FEA1": (
        "a Feather file of version 1",
        "write it as version 2 or as Parquet, which keep metadata (df.to_parquet)",
    ),
    b"riff": ("a Sony Wave64 file (.w64)", _WAV),
    b"fLaC": ("a FLAC file", _WAV),
    b"OggS": ("an Ogg file", _WAV),
    b"\x93NUMPY": ("an array of NumPy (.npy)", "it holds no units; " + _ARRAY),
    b"\x80\x04\x95": ("a pickle of Python", "it could run code; " + _ARRAY),
    b"\x80\x05\x95": ("a pickle of Python", "it could run code; " + _ARRAY),
    b"SQLite": ("a database of SQLite", _TABLE),
    b"BZh": ("a packed file (bzip2)", _UNPACK),
    b"\xfd7zXZ": ("a packed file (xz)", _UNPACK),
    b"7z\xbc\xaf": ("a packed file (7-Zip)", _UNPACK),
    b"Rar!": ("a packed file (RAR)", _UNPACK),
    b"\x28\xb5\x2f\xfd": ("a packed file (zstd)", _UNPACK),
}
"""Formats by their first bytes, with advice."""


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Refuse a file by the name of its format.

    Raises
    ------
    ReadError
        Always.
    """
    del options
    head = raw.head(4096)
    known_format = next(
        (message for signature, message in _NAMED.items() if head.startswith(signature)), None
    )
    if known_format:
        format_title, advice = known_format
    elif not head.startswith(GZIP):
        format_title, advice = "a catman file (.bin)", _CATMAN
    elif _unpack_head(head).startswith(_ZS2):
        format_title, advice = "a testXpert file (.zs2)", _ZWICK
    else:
        format_title, advice = "a packed file (gzip)", _UNPACK
    raise ReadError(f"{format_title}, which is not read: {advice}")


def refuse_archive(names: Sequence[str]) -> None:
    """Refuse a ZIP archive that is no workbook, and name the kind of its contents.

    Raises
    ------
    ReadError
        Of a measurement of Dewesoft, of arrays of NumPy, and of any other archive.
    """
    if {"DBDATA", "SETUP"} <= {name.rpartition("/")[2] for name in names}:
        format_title, advice = "a Dewesoft archive (.dxz)", _DEWESOFT
    elif names and all(name.endswith(".npy") for name in names):
        format_title, advice = "arrays of NumPy (.npz)", "they hold no units; " + _ARRAY
    elif any(name.startswith(_OFFICE) for name in names):
        format_title, advice = (
            "an office document without a table of cells",
            "save its table as xlsx or csv",
        )
    else:
        format_title, advice = "a packed file (ZIP)", _UNPACK
    raise ReadError(f"{format_title}, which is not read: {advice}")


def _unpack_head(head: bytes) -> bytes:
    """Return the first bytes of the contents of a compressed file."""
    try:
        return zlib.decompressobj(31).decompress(head, 16)
    except zlib.error:
        return b""
