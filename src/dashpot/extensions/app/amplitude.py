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
def _fit_and_plot(asked: LevelJob) -> tuple[Levels, Picture]:
    """The fit of these files, and its figure."""
    send_progress(f"fitting {', '.join(Path(path).name for path in asked.files)}")
    found = level_files(**vars(asked))
    return found, plot.level(found.fit, found.records)


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
    asked = _parse_request(request, folder)
    found, picture = _fit_and_plot(asked)
    page = kind_page(found)
    rows = [view_models.term(one) for one in numbers(found)]
    return wire_format.encode_message(
        {
            "verdict": view_models.verdict(found.verdict, page.lights),
            "colour": COLOURS[found.verdict.use],
            "solid": view_models.term_table(
                "What amplitude does", rows, format_residual_note(found)
            ),
            "arms": "",
            "checks": view_models.check_list(found.checks),
            "figures": make_figure_cards(picture, sizes_of(request).get("bench", WIDE)[0]),
            "facts": [list(one) for one in page.strip],
            "simulated": any(source.simulated for source in found.source),
            "command": line("fit", asked),
        }
    )


def download_level(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit as its JSON, as ``dashpot fit --json`` prints it."""
    found, _ = _fit_and_plot(_parse_request(request, folder))
    text = text_of(found)
    return wire_format.encode_message(
        {"name": "levels.json", "kind": "application/json", "text": text}
    )
