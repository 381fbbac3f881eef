"""Downloads: reports, decks, tables, figures, a profile, a project."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from dashpot import plot
from dashpot.base.checks import Use, Verdict
from dashpot.base.errors import DataError
from dashpot.base.option_fields import get_choice_values
from dashpot.base.progress import send_progress
from dashpot.datamodel.fit import Fit, add_checks
from dashpot.export import SUFFIXES, deck_for
from dashpot.extensions.app import recent, result_cache, wire_format
from dashpot.extensions.app.limits_panel import judge_limits
from dashpot.extensions.app.request_parsing import (
    build_job,
    build_part,
    get_deck_options,
    require_text,
)
from dashpot.reading.read_options import ReadOptions, dump_profile
from dashpot.reading.write import write_frf
from dashpot.registry import require_handler
from dashpot.report import html as report_html
from dashpot.report.figures import stamp
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import to_json


def add_verdict_checks(fit: Fit, verdict: Verdict) -> Fit:
    """Return the fit with the failed checks of a verdict, where its own verdict is milder."""
    severity = get_choice_values(Use)
    if severity.index(fit.verdict.use) >= severity.index(verdict.use):
        return fit
    return add_checks(fit, verdict.failed_checks)


def download_file(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return a file to take away: a head with its name and kind, then its bytes."""
    job = build_job(request.get("job"), folder)
    content_name = require_text(request, "what")
    makers: dict[str, Callable[[], tuple[str, str, str | bytes]]] = {
        "report": lambda: ("report.html", "text/html", _render_report(request, folder, job)),
        "fit": lambda: ("fit.json", "application/json", to_json(_get_shown_fit(request, job))),
        "joint": lambda: ("joint.json", "application/json", to_json(_get_joint_fit(job))),
        "deck": lambda: _make_deck(request, job),
        "picture": lambda: _make_picture(job),
        "frf": lambda: ("frf.csv", "text/csv", _format_frf(job)),
        "base": lambda: (
            "base.csv",
            "text/csv",
            write_frf(result_cache.predict_base_motion(job).frf),
        ),
        "base-json": lambda: (
            "base.json",
            "application/json",
            json.dumps(result_cache.predict_base_motion(job).to_dict(), indent=2, allow_nan=False),
        ),
    }
    if content_name not in makers:
        raise DataError(
            f"'{content_name}' cannot be exported; expected one of {', '.join(map(str, makers))}"
        )
    name, kind, content = makers[content_name]()
    content_entry = (
        {"text": content} if isinstance(content, str) else {"base64": b64encode(content).decode()}
    )
    return wire_format.encode_message({"name": name, "kind": kind, **content_entry})


def download_profile(request: Mapping[str, Any], folder: Path) -> bytes:  # noqa: ARG001
    """Answers to a file's questions, as TOML that every command reads."""
    options = build_part(ReadOptions, request.get("options", {}), "options")
    return wire_format.encode_message(
        {"name": "profile.toml", "kind": "application/toml", "text": dump_profile(options)}
    )


def _render_report(request: Mapping[str, Any], folder: Path, job: Job) -> str:
    """Return the report, with the section of the limits of the page.

    Raises
    ------
    DataError
        If one of them is no limit of this study.
    """
    study = result_cache.get_study(job)
    limits = judge_limits(request, folder, study)
    if limits.refusal:
        raise DataError(limits.refusal)
    send_progress("drawing the report")
    return report_html(study, limits=limits.html)


def _get_shown_fit(request: Mapping[str, Any], job: Job) -> Fit:
    """Return the solid that the page shows: of both tests, or of the relaxation test alone."""
    fit = (
        _get_joint_fit(job)
        if request.get("joint") is True
        else result_cache.fit_job(result_cache.select_fit_choices(job), True, None)
    )
    shown_identity = request.get("solid", fit._identity)
    if shown_identity != fit._identity:
        raise DataError(
            f"the page shows another model ({shown_identity}) than its choices give "
            f"({fit._identity}): "
            "wait until it is judged"
        )
    return fit


def _get_joint_fit(job: Job) -> Fit:
    fit = result_cache.get_study(job).joint
    if fit is None:
        raise DataError("there is no joint model. Open a hammer test and fit both")
    return fit


def _make_deck(request: Mapping[str, Any], job: Job) -> tuple[str, str, str | bytes]:
    target = str(request.get("target"))
    solid = add_verdict_checks(_get_shown_fit(request, job), result_cache.get_study(job).verdict)
    deck = deck_for(
        target,
        solid,
        units=request.get("units", "mm-t-s"),
        allow=("all",) if request.get("anyway") is True else (),
        **get_deck_options(request),
    )
    kind = "text/plain" if deck.printable else "application/octet-stream"
    return f"{target}.{SUFFIXES[target]}", kind, deck.file_content


def _make_picture(job: Job) -> tuple[str, str, str]:
    study = result_cache.get_study(job)
    hero = replace(plot.hero(study), stamp=stamp(study))
    return "seal.svg", "image/svg+xml", plot.to_svg(hero)


def _format_frf(job: Job) -> str:
    study = result_cache.get_study(job)
    if study.prediction is None:
        raise DataError("no mass is given, so there is no response to export")
    rows = ["frequency [Hz],real [(m/s^2)/N],imaginary [(m/s^2)/N]"]
    values = zip(study.prediction.frequency, study.prediction.value, strict=True)
    rows += [f"{f!r},{v.real!r},{v.imag!r}" for f, v in ((float(f), complex(v)) for f, v in values)]
    return "\n".join([*rows, ""])


def keep_project(request: Mapping[str, Any], folder: Path) -> bytes:
    """Save raw files, results and history in a project folder."""
    job = build_job(request.get("job"), folder)
    project_folder = request.get("folder")
    if not isinstance(project_folder, str) or not project_folder.strip():
        raise DataError("no folder is named: type where the project is to be kept")
    keep = require_handler("keep", "project")
    _, page, kept_project = keep(Path(project_folder).expanduser(), job, page=report_html)
    recent.add_recent_folder(kept_project.folder)
    return wire_format.encode_message(
        {"folder": str(kept_project.folder), "report": str(page), "head": kept_project.head}
    )
