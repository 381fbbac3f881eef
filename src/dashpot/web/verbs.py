"""Every question that a page may put to a worker."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dashpot.web import against, bench, folders, judging, level, modes, taking, work

VERBS: Mapping[str, Callable[[Mapping[str, Any], Path], bytes]] = {
    "inspect": work.inspect, "live": work.live, "look": work.look,
    "settle": work.settle, "predict": work.predict, "study": work.study,
    "take": taking.take, "profile": taking.profile,
    "project": taking.project,
    "bench": bench.bench, "take-bench": bench.take_bench,
    "level": level.level, "take-level": level.take_level,
    "against": against.against, "judged": judging.judge, "take-judged": judging.take_judged,
    "modes": modes.modes, "take-modes": modes.take_modes,
    "recent": folders.listed, "folder": folders.folder, "row": folders.row,
}  # fmt: skip
"""From the request and the folder of the files to a message."""
