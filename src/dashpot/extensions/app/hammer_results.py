"""Results of the hits of a hammer test: each alone, their average, its modes."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.progress import send_progress
from dashpot.base.units import si_range
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.extensions.app import view_models, wire_format
from dashpot.extensions.app.command_lines import format_options
from dashpot.extensions.app.hit_selection import HitSelection, estimate_each_hit, propose_hits
from dashpot.extensions.app.limits_panel import judge_limits
from dashpot.extensions.app.request_parsing import (
    build_part,
    get_list,
    get_panel_sizes,
    require_text,
)
from dashpot.extensions.app.result_cache import MAX_CACHED
from dashpot.extensions.app.upload_store import find_file
from dashpot.plot.frf_figure import coherence_panels
from dashpot.plot.picture import MEASURED, Line, Mark, Panel, Pen, Scale
from dashpot.plot.plotted_data import compute_padded_log_limits
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.impact import read_impact
from dashpot.registry import find_handler
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.report.result_page import format_json, kind_page
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured_frf import ImpactResult, modes_of_hits

ACCEPTED_PEN, REJECTED_PEN = Pen("fit", 1.0), Pen("bad", 1.0, (5, 3))
"""Pen of the FRF of one hit: accepted, and rejected."""
VIEW_RATIO = 5.0
"""Factor by which the figure of single hits extends below and above the peak."""


@dataclass(frozen=True)
class HammerRequest:
    """Request of the page on hits without a relaxation test."""

    files: tuple[str, ...]
    hammer: HammerChoices
    options: ReadOptions
    band: tuple[float, float] | None = None


def _parse_request(request: Mapping[str, Any], folder: Path) -> HammerRequest:
    files = tuple(str(find_file(folder, item)) for item in get_list(request, "files"))
    if not files:
        raise DataError("no hammer file is open: open one first")
    band = require_text(request, "band")
    return HammerRequest(
        files,
        build_part(HammerChoices, request.get("hammer", {}), "hammer"),
        build_part(ReadOptions, request.get("options", {}), "options"),
        si_range(band, "frequency") if band else None,
    )


@lru_cache(MAX_CACHED)
def _read_hits(files: tuple[str, ...], options: ReadOptions) -> Any:
    return read_impact(list(files), options=options)


@lru_cache(MAX_CACHED)
def _find_modes(request: HammerRequest) -> tuple[ImpactResult, str]:
    send_progress(f"averaging {', '.join(Path(path).name for path in request.files)}")
    test = _read_hits(request.files, request.options)
    return modes_of_hits(test, hammer=request.hammer, band=request.band)


_single_hit_cache: dict[tuple[int, HammerChoices], tuple[ImpactTest, dict[str, FRF]]] = {}
"""FRF of each hit, by the identity of the record and the choices of its average."""


def get_single_hits(impact: ImpactTest, frf: FRF, choices: HammerChoices) -> dict[str, FRF]:
    """Return the FRF of every single hit, which does not depend on the selection."""
    key = id(impact), replace(choices, accept=(), reject=())
    if key not in _single_hit_cache:
        while len(_single_hit_cache) >= MAX_CACHED:
            del _single_hit_cache[next(iter(_single_hit_cache))]
        _single_hit_cache[key] = impact, estimate_each_hit(impact, frf, choices)
    return _single_hit_cache[key][1]


def draw_hits(
    impact: ImpactTest, frf: FRF, choices: HammerChoices, sizes: view_models.Sizes
) -> dict[str, str]:
    """Return the panel of the FRF of each hit and of their average, above its coherence."""
    single_frfs = get_single_hits(impact, frf, choices)
    accepted_names = {hit.name for hit in frf.hits if hit.accepted}
    peak = frf.frequency[int(np.argmax(np.abs(frf.value)))]
    view = (
        max(peak / VIEW_RATIO, float(frf.frequency[1])),
        min(peak * VIEW_RATIO, float(frf.frequency[-1])),
    )
    marks: list[Mark] = []
    for name, hit_frf in sorted(
        single_frfs.items(), key=lambda pair: pair[0] not in accepted_names
    ):
        pen = ACCEPTED_PEN if name in accepted_names else REJECTED_PEN
        label = "each hit" if name in accepted_names else f"hit {name}, rejected"
        marks.append(Line(*_get_visible_curve(hit_frf, view), pen, label))
    marks.append(Line(*_get_visible_curve(frf, view), MEASURED, "average"))
    values = [mark.y for mark in marks if isinstance(mark, Line)]
    frequency_axis = Scale("frequency, Hz", view, log=True)
    panel = Panel(frequency_axis, Scale("accelerance, 1/kg", compute_padded_log_limits(*values),
    log=True),
                  tuple(marks))  # fmt: skip
    panels = (panel, *coherence_panels(frf, frequency_axis))
    title = "FRF of each hit, 1/kg; coherence"
    return {"hit-frf": view_models.render_panels("hit-frf", panels, sizes, title=title)}


def _get_visible_curve(frf: FRF, view: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    is_visible = (frf.frequency >= view[0]) & (frf.frequency <= view[1])
    return frf.frequency[is_visible], np.abs(frf.value[is_visible])


def propose_selection(impact: ImpactTest, frf: FRF, choices: HammerChoices) -> HitSelection:
    """Return the hits to keep among the accepted ones."""
    return propose_hits(frf, get_single_hits(impact, frf, choices))


def analyse_hits(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the modes and figures of hits without a relaxation test."""
    hammer_request = _parse_request(request, folder)
    result, reason = _find_modes(hammer_request)
    page, sizes = kind_page(result), get_panel_sizes(request)
    test = _read_hits(hammer_request.files, hammer_request.options)
    is_hits = isinstance(test, ImpactTest) and bool(result.frf.hits)
    message: dict[str, Any] = {
        "verdict": view_models.render_verdict(result.verdict, page.indicators),
        "colour": VERDICT_COLOURS[result.verdict.use],
        "answers": view_models.render_groups(page.groups, page.table_title, reason or page.note),
        "solid": "",
        "arms": "",
        "checks": view_models.render_checks(result.checks),
        "simulated": any(source.simulated for source in page.sources),
        **judge_limits(request, folder, result).add_to(_format_command(hammer_request)),
        "hits": "",
        "hit_panels": {},
        "poles": [],
    }
    if is_hits:
        message["hits"] = view_models.render_hits(
            test, result.frf, propose_selection(test, result.frf, hammer_request.hammer)
        )
        draw = find_handler("pole figure", result.frf)
        list_poles = find_handler("poles", result.frf)
        message["poles"] = [] if list_poles is None else list_poles(result.frf)
        message["hit_panels"] = {
            **draw_hits(test, result.frf, hammer_request.hammer, sizes),
            **view_models.render_pulse_panels(
                test, result.frf, None if draw is None else draw(result.frf), sizes
            ),
        }
    return wire_format.encode_message(message)


def download_hammer(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the modes as their JSON, as ``dashpot fit --json`` prints it."""
    result, _ = _find_modes(_parse_request(request, folder))
    text = judge_limits(request, folder, result).render_document(format_json(result))
    return wire_format.encode_message(
        {"name": "modes.json", "kind": "application/json", "text": text}
    )


def _format_command(request: HammerRequest) -> str:
    """Return the command that gives the same."""
    names: Sequence[str] = [Path(path).name for path in request.files]
    words = [*format_options(request.hammer), *format_options(request.options)]
    if request.band is not None:
        words += ["--band", f"{request.band[0]!r}:{request.band[1]!r}Hz"]
    return shlex.join(["dashpot", "fit", *names, *words])
