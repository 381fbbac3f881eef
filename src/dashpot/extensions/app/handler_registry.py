"""Every question that a page may put to a worker."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dashpot.extensions.app import (
    amplitude,
    bench_tests,
    compare_fits,
    downloads,
    kind_results,
    modes,
    open_folder,
    request_handlers,
)

VERBS: Mapping[str, Callable[[Mapping[str, Any], Path], bytes]] = {
    "inspect": request_handlers.inspect, "live": request_handlers.live,
    "look": request_handlers.look, "settle": request_handlers.settle,
    "predict": request_handlers.predict, "study": request_handlers.study,
    "take": downloads.take, "profile": downloads.profile,
    "project": downloads.project,
    "bench": bench_tests.bench, "take-bench": bench_tests.take_bench,
    "level": amplitude.level, "take-level": amplitude.take_level,
    "against": compare_fits.against,
    "judged": kind_results.judge, "take-judged": kind_results.take_judged,
    "modes": modes.modes, "take-modes": modes.take_modes,
    "recent": open_folder.listed, "folder": open_folder.folder, "row": open_folder.row,
}  # fmt: skip
"""From the request and the folder of the files to a message."""
