"""The operating system's lock on a file: it ends with the process that holds it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from dashpot.base.errors import DataError


@contextmanager
def open_exclusive_lock(path: Path, what: str) -> Iterator[None]:
    """Hold the lock on `path`, which is made if it is missing, and stays.

    Raises
    ------
    DataError
        If another process holds it; `what` it is then using.
    """
    descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o666)
    try:
        if not lock(descriptor):
            raise DataError(f"{what} is in use by another dashpot; try again when it is done")
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

    Two processes may ask at once. A file that is missing or cannot be read is not locked.
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

        place = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, _FAR, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        finally:
            os.lseek(descriptor, place, os.SEEK_SET)

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
