"""Processes of a process, as /proc lists them."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")


def alive(process: int) -> bool:
    """Whether it runs: one that nobody waited for does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def children(process: int) -> list[int]:
    """Those that any of its threads started."""
    result: set[int] = set()
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            result.update(map(int, task.read_text().split()))
        except OSError:  # the thread, or all of it, has ended meanwhile
            continue
    return sorted(result)
