"""Tests in which amplitude was varied, that the page fits: sweeps, loops, FRFs at levels."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from dashpot import plot
from dashpot.base.errors import DataError
from dashpot.base.progress import send_progress
from dashpot.extensions.amplitude.fit_files import Levels, level_files
from dashpot.extensions.amplitude.page import format_residual_note, numbers
from dashpot.extensions.app import view_models, wire_format
from dashpot.extensions.app.bench_tests import KEPT, WIDE
from dashpot.extensions.app.figure_cards import make_figure_cards
from dashpot.extensions.app.request_parsing import build_from_request, sizes_of
from dashpot.plot.picture import Picture
from dashpot.report.page_content import kind_page
from dashpot.report.page_frame import COLOURS
from dashpot.report.result_page import text_of
from dashpot.workflow.command_lines import line
from dashpot.workflow.job import LevelJob


@lru_cache(KEPT)
def _fit_and_plot(level_job: LevelJob) -> tuple[Levels, Picture]:
    """The fit of these files, and its figure."""
    send_progress(f"fitting {', '.join(Path(path).name for path in level_job.files)}")
    levels = level_files(**vars(level_job))
    return levels, plot.level(levels.fit, levels.records)


def _parse_request(request: Mapping[str, Any], folder: Path) -> LevelJob:
    """The request; a mass and what goes with it are of FRFs alone, each of which has its level."""
    job = build_from_request(LevelJob, request, folder)
    if not job.levels:
        return LevelJob(job.files, law=job.law, options=job.options)
    if job.mass is None:
        raise DataError("no mass is given: say what rests on the seals, such as 104 g")
    return job


def level(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit of such files: verdict, numbers, checks, figures, and the command that gives it."""
    level_job = _parse_request(request, folder)
    levels, picture = _fit_and_plot(level_job)
    page = kind_page(levels)
    rows = [view_models.term(number) for number in numbers(levels)]
    return wire_format.encode_message(
        {
            "verdict": view_models.verdict(levels.verdict, page.lights),
            "colour": COLOURS[levels.verdict.use],
            "solid": view_models.term_table(
                "What amplitude does", rows, format_residual_note(levels)
            ),
            "arms": "",
            "checks": view_models.check_list(levels.checks),
            "figures": make_figure_cards(picture, sizes_of(request).get("bench", WIDE)[0]),
            "facts": [list(names) for names in page.strip],
            "simulated": any(source.simulated for source in levels.source),
            "command": line("fit", level_job),
        }
    )


def download_level(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit as its JSON, as ``dashpot fit --json`` prints it."""
    levels, _ = _fit_and_plot(_parse_request(request, folder))
    text = text_of(levels)
    return wire_format.encode_message(
        {"name": "levels.json", "kind": "application/json", "text": text}
    )
