"""The operating system's lock on a file: it ends with the process that holds it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from dashpot.base.errors import DataError


@contextmanager
def alone(path: Path, what: str) -> Iterator[None]:
    """Hold the lock on `path`, which is made if it is missing, and stays.

    Raises
    ------
    DataError
        If another process holds it; `what` it is then using.
    """
    descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o666)
    try:
        try:
            _take(descriptor)
        except (BlockingIOError, PermissionError):
            raise DataError(
                f"{what} is in use by another dashpot; try again when it is done"
            ) from None
        yield
    finally:
        os.close(descriptor)  # and the lock with it


if sys.platform == "win32":

    def _take(descriptor: int) -> None:
        import msvcrt

        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)

else:

    def _take(descriptor: int) -> None:
        import fcntl

        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
