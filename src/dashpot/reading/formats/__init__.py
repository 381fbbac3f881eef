"""One file format, one file; which one reads a file shows in its first bytes."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib import import_module

from dashpot.base.errors import ReadError
from dashpot.reading.raw_file import Raw, about
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable

_PLUGGED = "plugin_format"
_CORE = {"text", _PLUGGED}
_FOREIGN = {"hdf5", "matlab", "tdms", "trios", "uff", _PLUGGED}
"""Formats whose whole reading is left to a child; a workbook's is left to it up to the text."""
_SHEETED = {"hdf5", "tdms", "workbook"}
"""Formats whose sheets or groups are named."""
_MAGIC: tuple[tuple[bytes, str], ...] = (
    (b"LabVIEW Measurement", "lvm"),
    (b"\x89HDF\r\n\x1a\n", "hdf5"),
    (b"MATLAB 5.0 MAT-file", "matlab"),
    (b"MATLAB 7.3 MAT-file", "hdf5"),
    (b"TDSm", "tdms"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "workbook"),
    (b"PK\x03\x04", "workbook"),
)


def format_of(raw: Raw) -> str:
    """Return the name of the format, which is that of a module of this folder."""
    head = raw.head(4096)
    bare = head.removeprefix(b"\xef\xbb\xbf")
    for mark, name in _MAGIC:
        if bare.startswith(mark):
            return name
    if re.match(rb"\A\s*+-1[ \t]*+[\r\n]\s*+\d++b?(\s|\Z)", bare):
        return "uff"
    opens = bare.lstrip().startswith((b"{", b"[{")) and not bare.startswith(b"{\\rtf")
    return "trios" if opens else "text"


def read_table(raw: Raw, options: ReadOptions) -> FileTable:
    """Return the table in a file of any known format.

    Raises
    ------
    ReadError
        Whatever is wrong with the file. A foreign parser may stumble over a broken one in any way:
        it runs in a child process, with limits.
    """
    with about(raw.name):
        table = _table(raw, options)
    if options.calibration is None:
        return table
    from dashpot.extensions.formats.ati import calibrated

    return calibrated(table, raw, options)


def _table(raw: Raw, options: ReadOptions) -> FileTable:
    name, called = format_of(raw), ""
    if options.format is not None:
        from dashpot.base.plugins import wanted

        name, called = _PLUGGED, wanted("formats", options.format).called
    if options.sheet is not None and name not in _SHEETED:
        raise ReadError(
            f"--part sheet={options.sheet}: this file has no sheets or groups; leave it out"
        )
    home = "reading" if name in _CORE else "extensions"
    reads = import_module(f"dashpot.{home}.formats.{name}")
    reader: Callable[[Raw, ReadOptions], FileTable] = reads.read
    try:
        if name not in _FOREIGN:
            return reader(raw, options)
        from dashpot.extensions.formats.sandbox.parent_process import in_child

        return in_child(called or name, reader, raw, options)
    except (MemoryError, OSError) as error:
        raise ReadError(f"cannot be read: {type(error).__name__} {error}") from None
