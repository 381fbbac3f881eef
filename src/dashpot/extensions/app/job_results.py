"""Jobs of several files with one result: amplitudes, FRFs with their modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from dashpot.base.errors import DataError
from dashpot.extensions.app import view_models, wire_format
from dashpot.extensions.app.bench_tests import DEFAULT_SIZE, MAX_CACHED
from dashpot.extensions.app.command_lines import format_job_command
from dashpot.extensions.app.figure_cards import draw_cards
from dashpot.extensions.app.limits_panel import judge_limits
from dashpot.extensions.app.request_parsing import build_from_request, get_list, get_panel_sizes
from dashpot.extensions.app.upload_store import find_file
from dashpot.registry import find_handler, require_handler
from dashpot.report.first_screen import Indicator
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.report.result_page import JobPage, format_json, kind_page
from dashpot.workflow.job import LevelJob


@lru_cache(2 * MAX_CACHED)
def _fit_job(job: Any) -> tuple[Any, JobPage]:
    """Return the result of the files of a job, and its panels on the page."""
    result: tuple[Any, JobPage] = require_handler("fit job", job)(job)
    return result


def _parse_level_job(request: Mapping[str, Any], folder: Path) -> LevelJob:
    """Return the parsed request; mass options are only for FRFs, each with its level."""
    job = build_from_request(LevelJob, request, folder)
    if not job.levels:
        return LevelJob(job.files, law=job.law, options=job.options)
    if job.mass is None:
        raise DataError("no mass is given: say what rests on the seals, such as 104 g")
    return job


def _parse_modes_job(request: Mapping[str, Any], folder: Path) -> Any:
    for file, mass in zip(get_list(request, "files"), get_list(request, "masses"), strict=False):
        if not mass:
            name = find_file(folder, file).name
            raise DataError(f"{name}: say which mass was on the seals, such as 104 g")
    return build_from_request(find_handler("job", "modes"), request, folder)


def _build_message(
    job: Any,
    request: Mapping[str, Any],
    folder: Path,
    indicators: Sequence[Indicator],
    **others: Any,
) -> bytes:
    """Return verdict, numbers, checks, figures, downloads, and the equivalent command."""
    result, page = _fit_job(job)
    terms = [view_models.make_term(fact) for fact in page.facts]
    message = {
        "verdict": view_models.render_verdict(result.verdict, indicators),
        "colour": VERDICT_COLOURS[result.verdict.use],
        "solid": view_models.render_terms(page.title, terms, page.note),
        "arms": "",
        "checks": view_models.render_checks(result.checks),
        "figures": draw_cards(page.cards, get_panel_sizes(request).get("bench", DEFAULT_SIZE)[0]),
        **others,
        "simulated": any(source.simulated for source in page.sources),
        **judge_limits(request, folder, result).add_to(format_job_command("fit", job)),
    }
    return wire_format.encode_message(message)


def fit_levels(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the fit of tests at several amplitudes, with its lights and the line of facts."""
    job = _parse_level_job(request, folder)
    page = kind_page(_fit_job(job)[0])
    return _build_message(
        job, request, folder, page.indicators, facts=[list(names) for names in page.summary_line]
    )


def find_modes(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the modes of FRFs: of points of one structure, or under several masses on one seal."""
    return _build_message(_parse_modes_job(request, folder), request, folder, ())


def download_level(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the fit as its JSON, as ``dashpot fit --json`` prints it."""
    return _build_download("levels.json", _parse_level_job(request, folder), request, folder)


def download_modes(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the modes as their JSON, as ``dashpot fit --json`` prints it."""
    return _build_download("modes.json", _parse_modes_job(request, folder), request, folder)


def _build_download(name: str, job: Any, request: Mapping[str, Any], folder: Path) -> bytes:
    result, _ = _fit_job(job)
    text = judge_limits(request, folder, result).render_document(format_json(result))
    return wire_format.encode_message({"name": name, "kind": "application/json", "text": text})
