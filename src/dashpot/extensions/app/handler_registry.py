"""Table of the handlers of all requests of the page."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dashpot.extensions.app import (
    bench_tests,
    compare_fits,
    downloads,
    hammer_results,
    job_results,
    kind_results,
    open_folder,
    overlay_fits,
    request_handlers,
)

VERBS: Mapping[str, Callable[[Mapping[str, Any], Path], bytes]] = {
    "inspect": request_handlers.inspect, "live": request_handlers.preview_fit,
    "look": request_handlers.preview_record, "settle": request_handlers.fit_with_intervals,
    "predict": request_handlers.predict, "study": request_handlers.study,
    "take": downloads.download_file, "profile": downloads.download_profile,
    "project": downloads.keep_project,
    "bench": bench_tests.fit_bench_test, "take-bench": bench_tests.download_bench,
    "level": job_results.fit_levels, "take-level": job_results.download_level,
    "against": compare_fits.build_fit_comparison, "overlay": overlay_fits.overlay_tests,
    "standalone": kind_results.fit_kind, "take-standalone": kind_results.download_kind,
    "hammer": hammer_results.analyse_hits, "take-hammer": hammer_results.download_hammer,
    "modes": job_results.find_modes, "take-modes": job_results.download_modes,
    "recent": open_folder.get_recent_folders, "folder": open_folder.open_folder,
    "row": open_folder.open_row,
}  # fmt: skip
"""From the request and the folder of the files to a message."""
