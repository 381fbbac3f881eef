"""Which reader a file goes to, by its first bytes and its extension."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from dashpot.io.opening import Raw
from dashpot.io.options import ReadOptions
from dashpot.io.table import Table

_MAGIC: tuple[tuple[bytes, str], ...] = (
    (b"LabVIEW Measurement", "lvm"),
    (b"\x89HDF\r\n\x1a\n", "hdf5"),
    (b"MATLAB 5.0 MAT-file", "matlab"),
    (b"MATLAB 7.3 MAT-file", "hdf5"),
    (b"TDSm", "tdms"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "workbook"),
    (b"PK\x03\x04", "workbook"),
)
_SUFFIX = {
    ".uff": "uff",
    ".unv": "uff",
    ".uf": "uff",
    ".bunv": "uff",
    ".lvm": "lvm",
    ".json": "trios",
}


def format_of(raw: Raw) -> str:
    """Return the name of the reader, a module of this folder."""
    head = raw.head(4096)
    bare = head.removeprefix(b"\xef\xbb\xbf")
    for mark, name in _MAGIC:
        if bare.startswith(mark):
            return name
    first = next((line.strip() for line in bare.splitlines() if line.strip()), b"")
    if first == b"-1":
        return "uff"
    if first.startswith(b"{"):
        return "trios"
    # the extension counts only where text could be the same format
    return _SUFFIX.get(raw.suffix, "text") if raw.suffix in {".uff", ".unv"} else "text"


def read_table(raw: Raw, options: ReadOptions) -> Table:
    """Return the table in a file of any known format."""
    reader: Callable[[Raw, ReadOptions], Table] = import_module(f"dashpot.io.{format_of(raw)}").read
    return reader(raw, options)
