"""Containers of this field that are not read: named, with the export that keeps units."""

# ruff: noqa: E501 - a container and its message stand on one line

from __future__ import annotations

import bz2
import gzip
import lzma
import struct
import zipfile
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from dashpot.base.errors import ReadError
from dashpot.extensions.formats import unread
from dashpot.reading.formats import read_table
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.registry import FORMATS

ZEROS = bytes(90)
TEXT = b"t [s],F [N]\n0,1\n"


def archive(*names: str) -> bytes:
    """A ZIP archive of empty files."""
    packed = BytesIO()
    with zipfile.ZipFile(packed, "w") as file:
        for name in names:
            file.writestr(name, b"")
    return packed.getvalue()


REFUSED = {
    "FAMOS": (b"|CF,2,1,1;|CK,1,3,1,1;" + bytes(9), "imc FAMOS file .* TDMS, HDF5 or MDF 4"),
    "catman": (struct.pack("<hI", 5012, 90) + bytes(90), "catman file .* MDF 4 or TDMS"),
    "zs2": (gzip.compress(b"\xaf\xbe\xad\xde" + bytes(90)), "testXpert file .*zs2.* row of units"),
    "Feather 1": (b"FEA1" + bytes(90), "Feather file of version 1, .* version 2 or as Parquet"),
    "Wave64": (b"riff\x2e\x91\xcf\x11" + bytes(90), "Wave64 file .*save it as WAV"),
    "FLAC": (b"fLaC" + bytes(90), "FLAC file.* save it as WAV"),
    "NumPy": (b"\x93NUMPY\x01\0" + bytes(90), r"array of NumPy .*\(Python: dp.fit"),
    "SQLite": (b"SQLite format 3\0" + bytes(90), "database of SQLite.* export the table as text"),
    "gzip": (gzip.compress(b"t [s],F [N]\n0,1\n"), "a packed file .gzip., .* unpack it"),
    "bzip2": (bz2.compress(TEXT), "a packed file .bzip2., .* unpack it"),
    "xz": (lzma.compress(TEXT), "a packed file .xz., .* unpack it"),
    "ZIP": (archive("seal.csv"), "a packed file .ZIP., .* unpack it"),
    "Dewesoft": (b"MULTI_STREAM_FILE_VER02106\0\0\0Dewesoft_Data_7.x" + ZEROS, r"Dewesoft file \(.dxd, .d7d\).* MDF 4"),
    "Dewesoft archive": (archive("DBDATA", "SETUP", "EVENTS"), "Dewesoft archive .* MDF 4, HDF5, TDMS"),
    "RPC III": (b"FORMAT".ljust(32, b"\0") + b"BINARY_IEEE_LITTLE_END" + ZEROS, "MTS RPC III .* or as MAT"),
    "DIAdem": (b"DIAHEADER\r\n#BEGINGLOBALHEADER\r\n", "DIAdem header .* save the data as TDMS"),
    "netCDF 3": (b"CDF\x01" + ZEROS, "netCDF file of version 3.* nccopy -k nc4"),
    "HDF 4": (b"\x0e\x03\x13\x01" + ZEROS, "HDF 4 file.* h4toh5"),
    "Origin": (b"CPYA 4.3668 178#\n" + ZEROS, "Origin project .* a row of names and one of units"),
    "Access": (b"\0\1\0\0Standard Jet DB\0" + ZEROS, "Access database .* export the table"),
    "SPSS": (b"$FL2@(#) SPSS DATA FILE" + ZEROS, "SPSS file.* export the table"),
    "PDF": (b"%PDF-1.7\n%" + ZEROS, "PDF document.* as text or as a workbook"),
    "pickle": (b"\x80\x04\x95" + ZEROS, "pickle of Python.* it could run code"),
    "arrays": (archive("force.npy", "time.npy"), r"arrays of NumPy .*\(Python: dp.fit"),
    "letter": (archive("word/document.xml"), "office document without a table"),
    "zeros": (ZEROS, "begins with zeros, and is no format that dashpot knows"),
}  # fmt: skip


@pytest.mark.parametrize(("data", "message"), REFUSED.values(), ids=REFUSED)
def test_containers_that_are_not_read_are_named(data: bytes, message: str) -> None:
    with pytest.raises(ReadError, match=message):
        read_table(RawFile("a", None, data), ReadOptions())


def test_first_bytes_of_each_named_container_are_registered() -> None:
    named = set(unread._NAMED) | {unread.GZIP} | {bytes((low, 0x13)) for low in range(0x92, 0x96)}
    marks = FORMATS["unread"].marks
    assert all(any(mark.startswith(name) for name in named) for mark in marks)
    assert all(any(mark.startswith(name) for mark in marks) for name in named)


def test_a_matlab_file_of_version_4_is_read(tmp_path: Path) -> None:
    time = np.arange(200) / 10
    shifted = 5 * np.clip(time - 1, 0, 1)
    content = {"time_s": time, "displacement_mm": shifted, "force_N": 3 * shifted}
    savemat(tmp_path / "old.mat", content, format="4")
    test = read_relaxation(tmp_path / "old.mat")
    np.testing.assert_allclose(test.force, 3 * shifted)
    np.testing.assert_allclose(test.displacement, 5e-3 * np.clip(time - 1, 0, 1))
