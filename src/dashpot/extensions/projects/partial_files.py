"""Removal of partial files of interrupted runs."""

from __future__ import annotations

import re
import time
from pathlib import Path

from dashpot.base.file_writing import PART

_PARTIAL_NAME = re.compile(rf"\.[0-9a-f]{{16}}\{PART}")
_ABANDONED_AFTER = 60.0
"""Age above which a partial file is abandoned, s."""


def is_partial_file(name: str) -> bool:
    """Return whether a file has the name of an unfinished one of :func:`write_atomic`."""
    return _PARTIAL_NAME.fullmatch(name) is not None


def find_partial_files(folder: str | Path) -> list[Path]:
    """Return the partial files of killed runs in a folder and below it."""
    paths = (path for path in Path(folder).rglob(f".*{PART}") if is_partial_file(path.name))
    newest_time = time.time() - _ABANDONED_AFTER
    return sorted(path for path in paths if path.is_file() and path.lstat().st_mtime < newest_time)
