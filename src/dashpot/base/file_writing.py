"""Atomic writing of files, and file locks of the operating system."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from dashpot.base.errors import DataError
from dashpot.base.plain_text import escape_terminal_text

# File locks, which end with the process that holds them.


@contextmanager
def open_exclusive_lock(path: Path, description: str) -> Iterator[None]:
    """Hold the lock on `path`, a file that is created if missing and not deleted.

    Raises
    ------
    DataError
        If another process holds it; `description` it is then using.
    """
    descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o666)
    try:
        if not lock(descriptor):
            raise DataError(
                f"{description} is in use by another dashpot; try again when it is done"
            )
        yield
    finally:
        os.close(descriptor)  # and the lock with it


def lock(descriptor: int) -> bool:
    """Return whether the lock on an open file is now this process's, until the file is closed."""
    try:
        _take(descriptor)
    except (BlockingIOError, PermissionError):
        return False
    return True


def is_locked(path: Path) -> bool:
    """Return whether another process or another open file holds the lock on a file.

    Two processes may try at the same time. A file that is missing or cannot be read is not locked.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return False
    try:
        return not _shares(descriptor)
    finally:
        os.close(descriptor)


if sys.platform == "win32":
    # a lock keeps others from what it is on: a byte that no file has
    _FAR = 2**30

    def _take(descriptor: int) -> None:
        import msvcrt

        position = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, _FAR, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        finally:
            os.lseek(descriptor, position, os.SEEK_SET)

    def _shares(descriptor: int) -> bool:
        # a file that is open elsewhere cannot be replaced there
        return descriptor >= 0

else:

    def _take(descriptor: int) -> None:
        import fcntl

        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _shares(descriptor: int) -> bool:
        import fcntl

        try:
            fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:  # a file system without locks
            return True
        return True


# Atomic writing.


PART = ".part"
"""Suffix of a file that is still being written."""


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


def write_atomic(path: str | Path, content: bytes) -> None:
    """Write a temporary file and rename it, so that no incomplete file is ever seen.

    A link is followed: its target is replaced and keeps its permissions. A device or a pipe cannot
    be replaced and is written directly.

    Raises
    ------
    DataError
        If no file can have that name, or another process holds the lock on the file.
    OSError
        If the folder is missing or cannot be written to, or the disk is full; the file at `path` is
        then unchanged.
    """
    target = Path(os.path.realpath(validate_path(path)))
    mode = target.stat().st_mode if target.exists() else None
    if mode is not None and not stat.S_ISREG(mode):
        target.write_bytes(content)
        return
    if mode is not None and is_locked(target):
        raise DataError(
            f"{escape_terminal_text(str(path))} is being written by another dashpot; wait until it "
            "ends, or give another name"
        )
    parallel_path = target.with_name(f".{os.urandom(8).hex()}{PART}")
    try:
        with parallel_path.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            parallel_path.chmod(stat.S_IMODE(mode))
        parallel_path.replace(target)
    except BaseException as error:
        parallel_path.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:
            error.filename = str(path)  # a full disk names no file
        raise
