"""Result cards of bench tests: sweeps, master curves, relaxation moduli, creep."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from dashpot import plot
from dashpot.base.progress import send_progress
from dashpot.datamodel.fit import Fit
from dashpot.extensions.app import view_models, wire_format
from dashpot.extensions.app.command_lines import format_job_command
from dashpot.extensions.app.figure_cards import make_figure_cards
from dashpot.extensions.app.limits_panel import judge_limits
from dashpot.extensions.app.request_parsing import build_from_request, get_panel_sizes
from dashpot.plot.picture import Picture
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.report.result_page import kind_page
from dashpot.workflow.bench_tests import fit_files
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import to_json

DEFAULT_SIZE = (800.0, 0.0)
"""Default width and height of the figures, px."""
MAX_CACHED = 4
"""Fits that a worker remembers."""


@lru_cache(MAX_CACHED)
def _fit_and_plot(job: Job) -> tuple[Fit, Picture]:
    """Return the fit of a file, and its figure."""
    send_progress(f"fitting {Path(job.relaxation).name}")
    fit, records = fit_files(
        [job.relaxation], arms=job.arms, temperatures=job.temperatures, options=job.reading
    )
    return fit, plot.bench(fit, records)


def _parse_request(request: Mapping[str, Any], folder: Path) -> Job:
    """File, options, arms and temperature of a request."""
    temperature = request.get("temperature")
    options = {
        "relaxation": request.get("file"),
        "reading": request.get("options", {}),
        "arms": request.get("arms"),
        "temperatures": [temperature] if temperature else [],
    }
    return build_from_request(Job, options, folder)


def fit_bench_test(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit of one such file: verdict, solid, checks, figures, and the command that gives it."""
    job = _parse_request(request, folder)
    fit, picture = _fit_and_plot(job)
    page = kind_page(fit)
    return wire_format.encode_message(
        {
            "verdict": view_models.render_verdict(fit.verdict, page.indicators),
            "colour": VERDICT_COLOURS[fit.verdict.use],
            "solid": view_models.render_solid(fit),
            "arms": fit.model.arms,
            "checks": view_models.render_checks(fit.checks),
            "figures": make_figure_cards(
                picture, get_panel_sizes(request).get("bench", DEFAULT_SIZE)[0]
            ),
            "facts": [list(names) for names in page.summary_line],
            "simulated": any(source.simulated for source in fit.source),
            **judge_limits(request, folder, fit).add_to(format_job_command("fit", job)),
        }
    )


def download_bench(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the fit as its JSON, as ``dashpot fit --json`` prints it."""
    fit, _ = _fit_and_plot(_parse_request(request, folder))
    text = judge_limits(request, folder, fit).render_document(to_json(fit))
    return wire_format.encode_message(
        {"name": "fit.json", "kind": "application/json", "text": text}
    )
