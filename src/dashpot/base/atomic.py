"""A file written whole or not at all."""

from __future__ import annotations

import os
import re
import stat
import time
from pathlib import Path

from dashpot.base.errors import DataError
from dashpot.base.escaping import escape_terminal_text
from dashpot.base.lock import is_locked

PART = ".part"
"""How the name of a file ends that is not yet whole."""


def validate_path(path: str | Path) -> Path:
    r"""Return a path that a file system can have.

    Raises
    ------
    DataError
        If there is a zero byte in it.

    >>> validate_path("seal\0.csv")
    Traceback (most recent call last):
    ...
    dashpot.base.errors.DataError: seal\x00.csv: a zero byte is in this name; give another
    """
    if "\0" in os.fspath(path):
        raise DataError(
            f"{escape_terminal_text(str(path))}: a zero byte is in this name; give another"
        )
    return Path(path)


_LEFT = re.compile(rf"\.[0-9a-f]{{16}}\{PART}")
_SURELY = 60.0
"""Seconds after which nobody writes such a file any more."""


def is_partial_file(name: str) -> bool:
    """Whether a file is called as one that :func:`write_atomic` has not finished."""
    return _LEFT.fullmatch(name) is not None


def find_partial_files(folder: str | Path) -> list[Path]:
    """Return the files that runs which were killed left in a folder and below it."""
    paths = (path for path in Path(folder).rglob(f".*{PART}") if is_partial_file(path.name))
    until = time.time() - _SURELY
    return sorted(path for path in paths if path.is_file() and path.lstat().st_mtime < until)


def write_atomic(path: str | Path, content: bytes) -> None:
    """Write a file beside its place and move it there, so that no half of it is ever seen.

    A link is followed: what it points to is replaced, with the permissions it had. A device or a
    pipe has no place to be moved to and is written as it stands.

    Raises
    ------
    DataError
        If no file can have that name, or another process holds the lock on the file.
    OSError
        If the folder is missing or cannot be written to, or the disk is full; what stood at
        `path` then stands there still.
    """
    place = Path(os.path.realpath(validate_path(path)))
    mode = place.stat().st_mode if place.exists() else None
    if mode is not None and not stat.S_ISREG(mode):
        place.write_bytes(content)
        return
    if mode is not None and is_locked(place):
        raise DataError(
            f"{escape_terminal_text(str(path))} is being written by another dashpot; wait until it "
            "ends, or "
            "give another name"
        )
    parallel_path = place.with_name(f".{os.urandom(8).hex()}{PART}")
    try:
        with parallel_path.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            parallel_path.chmod(stat.S_IMODE(mode))
        parallel_path.replace(place)
    except BaseException as error:
        parallel_path.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:
            error.filename = str(path)  # a full disk names no file
        raise
