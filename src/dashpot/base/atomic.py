"""A file written whole or not at all."""

from __future__ import annotations

import os
import stat
from pathlib import Path

PART = ".part"
"""How the name of a file ends that is not yet whole."""


def write_whole(path: str | Path, content: bytes) -> None:
    """Write a file beside its place and move it there, so that no half of it is ever seen.

    A link is followed: what it points to is replaced, with the permissions it had. A device or a
    pipe has no place to be moved to and is written as it stands.

    Raises
    ------
    OSError
        If the folder is missing or cannot be written to, or the disk is full; what stood at
        `path` then stands there still.
    """
    place = Path(os.path.realpath(path))
    mode = place.stat().st_mode if place.exists() else None
    if mode is not None and not stat.S_ISREG(mode):
        place.write_bytes(content)
        return
    beside = place.with_name(f".{os.urandom(8).hex()}{PART}")
    try:
        with beside.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            beside.chmod(stat.S_IMODE(mode))
        beside.replace(place)
    except BaseException as error:
        beside.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:
            error.filename = str(path)  # a full disk names no file
        raise
