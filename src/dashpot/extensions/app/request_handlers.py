"""Handlers of requests in the workers: one function for each kind of request.

Every function takes the request and the folder of the files; results are cached by the
job that requested them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DashpotError, DataError
from dashpot.base.number_format import format_cell
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF, Kind
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.app import (
    hammer_results,
    record_cache,
    result_cache,
    view_models,
    wire_format,
)
from dashpot.extensions.app.command_lines import (
    FIT_FILE,
    format_job_command,
    format_predict_command,
)
from dashpot.extensions.app.limits_panel import judge_limits
from dashpot.extensions.app.page_form import get_form
from dashpot.extensions.app.request_parsing import (
    build_job,
    build_part,
    get_panel_sizes,
    parse_selection,
    require_number,
    require_text,
)
from dashpot.extensions.app.upload_store import find_file, identify_specimen
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation, relaxation_in
from dashpot.registry import KINDS, list_names, require_handler
from dashpot.report import first_screen
from dashpot.report.first_screen import find_simulated_files
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.vibration.mass_on_seals import MassOnSeals, compute_peak_limit, predict_frf
from dashpot.workflow.inspections import InspectedFile, inspect_files
from dashpot.workflow.job import Job
from dashpot.workflow.recommended_solid import recommend_solid
from dashpot.workflow.stiffness_under_mass import family_checks, find_static_equilibrium
from dashpot.workflow.study import Study

MASS_HINT = (
    "Give the test mass and the number of seals: the hammer test is then compared with the "
    "prediction of the relaxation test."
)
RESPONSE_LINES = np.geomspace(0.2, 4.0, 2001)
"""Lines of a response, as multiples of its peak's frequency."""
LIVE_LINES = np.geomspace(0.3, 3.0, 301)
"""Lines of a response while the mass is changed, as multiples of its peak's frequency."""


def inspect(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the description of a file, and open questions on it."""
    path = find_file(folder, request.get("file"))
    described_file = _describe_by_suffix(path)
    if described_file is not None:
        return wire_format.encode_message(described_file)
    options = build_part(ReadOptions, request.get("options", {}), "options")
    job = Job(str(path), reading=options)
    # the test that is read and prepared here is cached for the fit
    (inspection,) = inspect_files(
        [path],
        options=options,
        read=lambda file: record_cache.cache_record(
            str(path), options, relaxation_in(file, Specimen())
        ),
        prepare_test=lambda *_: result_cache.prepare_job_tests(
            result_cache.select_test_choices(job), result_cache.MAX_QUICK_SAMPLES
        )[0],
    ).files
    description = view_models.file_row(inspection)
    description["long"] = inspection.rows > result_cache.MAX_QUICK_SAMPLES
    description |= _get_kind_fields(inspection.kind)
    description["specimens"] = _list_specimens(path, inspection, options)
    if description["mark"] != "good" or view_models.get_section(inspection) in {"", "part"}:
        description["question"] = view_models.render_column_questions(
            inspection,
            _list_unit_consequences(path, inspection, options),
            options.rate,
            description["specimens"],
        )
    return wire_format.encode_message({**description, "name": path.name})


def _describe_by_suffix(path: Path) -> dict[str, Any] | None:
    """Return the description of a file by the first extension that supports it, or None."""
    names = [name for name in list_names("file row") if name.split()[0] == path.suffix.lower()]
    rows = (require_handler("file row", name)(path) for name in names)
    return next((row for row in rows if row is not None), None)


def _get_kind_fields(kind: str) -> dict[str, Any]:
    """Return the form fields of a kind, or of its alternative kind."""
    kind_of_test = KINDS.get(kind)
    form_kind = (
        KINDS[kind_of_test.alternative_kind]
        if kind_of_test is not None and kind_of_test.alternative_kind
        else kind_of_test
    )
    if form_kind is None:
        return {"form_fields": [], "takes_one_file": False}
    return {
        "form_fields": view_models.make_form_fields(get_form(form_kind.name)),
        "takes_one_file": form_kind.takes_one_file,
    }


def _list_specimens(
    path: Path, inspection: InspectedFile, options: ReadOptions
) -> list[dict[str, Any]]:
    """Return the specimens of which a file asks one: identity, label and options of each."""
    sheet = options.sheet or ""
    return [
        {
            "id": identify_specimen(
                path.parent.name, f"sheet={sheet},{selection}" if sheet else selection
            ),
            "label": ", ".join(filter(None, (sheet, name or selection.partition("=")[2]))),
            "options": parse_selection(selection),
        }
        for question in inspection.questions
        for name, selection in question.answers
    ]


def _list_unit_consequences(
    path: Path, inspection: InspectedFile, options: ReadOptions
) -> list[view_models.UnitImplication]:
    """Return stiffness and depth of a relaxation test for each possible unit."""
    if inspection.kind not in ("relaxation", "unclear") or len(inspection.questions) != 1:
        return []
    option = inspection.questions[0].option
    implications = []
    for role, words in (("force", ("N", "gf", "mN", "kgf")), ("displacement", ("mm", "um", "m"))):
        if f"{role}=" not in option:
            continue
        for unit in words:
            read_options = replace(options, units={**dict(options.units), role: unit})
            try:
                test = prepare(
                    result_cache.downsample_test(read_relaxation(path, options=read_options))
                )
                solid = fit(test, arms=1, intervals=False).model
            except DashpotError:
                continue
            stiffness = convert_to_unit(float(solid.relaxation(test.hold_time)), "N/mm")
            implications.append(
                view_models.UnitImplication(
                    unit, f"{float(test.force.max()):.3g}", f"{stiffness:.3g}"
                )
            )
    return implications


def preview_fit(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the point estimate while a time limit is dragged: curves and values, no intervals."""
    job = build_job(request.get("job"), folder)
    preview = result_cache.fit_while_dragging(result_cache.select_fit_choices(job))
    _, ramp_hold = result_cache.select_shown_test(job, preview, result_cache.MAX_PREVIEW_SAMPLES)
    by_eq5 = result_cache.fit_by_eq5(job, preview, result_cache.MAX_PREVIEW_SAMPLES)
    origin_text = request.get("since")
    time_origin = None if origin_text is None else require_number(origin_text, "since")
    live_curves = view_models.compute_live_test(
        preview, ramp_hold, by_eq5, unit=require_text(request, "unit") or "N",
        time_origin=time_origin
    )  # fmt: skip
    message = {
        "both_fits": live_curves.words,
        "time_limits": _list_time_limits(ramp_hold),
        "end": view_models.format_end_stiffness(preview, ramp_hold),
        "residual_note": live_curves.residual_note,
    }
    return wire_format.encode_message(message, live_curves.arrays)


def preview_record(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the recorded test, downsampled, to show while it is fitted."""
    job = build_job(request.get("job"), folder)
    max_samples = result_cache.MAX_PREVIEW_SAMPLES if request.get("quick") is True else None
    ramp_hold = result_cache.prepare_job_tests(result_cache.select_test_choices(job), max_samples)[
        0
    ]
    return wire_format.encode_message(
        {"panels": view_models.render_record_panels(ramp_hold, get_panel_sizes(request))}
    )


def fit_with_intervals(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the fit with its intervals and checks, every panel of the test, and the command line.

    A `quick` one uses part of the samples, as a preview.
    """
    job = build_job(request.get("job"), folder)
    sizes = get_panel_sizes(request)
    max_samples = result_cache.MAX_QUICK_SAMPLES if request.get("quick") is True else None
    fit = result_cache.fit_job(result_cache.select_fit_choices(job), True, max_samples)
    test, ramp_hold = result_cache.select_shown_test(job, fit, max_samples)
    by_eq5 = result_cache.fit_by_eq5(job, fit, max_samples)
    uncut_test = result_cache.prepare_uncut_test(job, ramp_hold)
    panels = view_models.render_test_panels(fit, ramp_hold, by_eq5, sizes, uncut_test)
    checks = fit.checks
    if job.mass is not None:
        response = _predict_response(fit, job, _get_frf_kind(request), RESPONSE_LINES)
        panels["frf"] = view_models.render_response(
            response, sizes, view_models.format_response_title(job, _get_frf_kind(request))
        )
        mass_on_seals = MassOnSeals(job.mass, job.seals, job.compression)
        checks += family_checks(
            fit, find_static_equilibrium(fit, mass_on_seals).point, mass_on_seals
        )
    else:
        panels["frf"] = view_models.render_stiffness(fit, sizes)
    return wire_format.encode_message(
        {
            "verdict": view_models.render_verdict(
                fit.verdict, view_models.make_fit_indicators(fit)
            ),
            "colour": VERDICT_COLOURS[fit.verdict.use],
            "solid": view_models.render_arms(fit),
            "checks": view_models.render_checks(checks),
            "both_fits": view_models.render_template(
                "paper_values", rows=view_models.make_parameter_rows(fit, by_eq5)
            ),
            "panels": panels,
            "time_limits": _list_time_limits(ramp_hold),
            "pressed": _format_compression(fit, job, ramp_hold),
            "temperature": format_cell(test.specimen.temperature, "°C"),
            "clock": [float(test.time[0]), float(test.time[-1])],
            "step": float(np.median(np.diff(test.time))),
            "arms": fit.model.arms if fit.family == "maxwell" else "",
            "law": _get_law_option(fit),
            "end": view_models.format_end_stiffness(fit, ramp_hold),
            "simulated": test.source is not None and test.source.simulated,
            "command": format_job_command("report", job),
        }
    )


def _get_law_option(fit: Fit) -> str:
    """Return the option of a job that selects the elastic law of a fit."""
    if fit.elastic_law is None:
        return ""
    return "linear" if fit.elastic_law.kind == "linear" else "nonlinear"


def _format_compression(fit: Fit, job: Job, prepared: RampHold) -> dict[str, str]:
    """Return the compression of the seals under the mass, mm, and a note on the tested range."""
    depth = f"test at {format_cell(prepared.depth, 'mm')} mm"
    if job.mass is None or job.compression is not None:
        return {"value": "", "message": depth}
    equilibrium = find_static_equilibrium(fit, MassOnSeals(job.mass, job.seals))
    return {
        "value": format_cell(equilibrium.point.compression, "mm"),
        "message": f"by its weight; {depth}",
    }


def _list_time_limits(prepared: RampHold) -> dict[str, float]:
    return {
        "onset": prepared.onset, "ramp_end": prepared.ramp_end, "hold_end": prepared.hold_end
    }  # fmt: skip


def _get_frf_kind(request: Mapping[str, Any]) -> Kind:
    """Return the kind of response: to a force on the mass, or to a motion of the base."""
    return Kind.TRANSMISSIBILITY if request.get("base") is True else Kind.ACCELERANCE


def _predict_response(fit: Fit, job: Job, kind: Kind, multiples: FloatArray) -> FRF:
    """Return the response at multiples of the frequency of its peak."""
    if job.mass is None:
        raise DataError("no mass is given: state the mass on the seals, such as 104 g")
    peak_limit = compute_peak_limit(job.seals * fit.solid.k_0, job.mass)
    return predict_frf(
        fit, mass=job.mass, frequency=peak_limit * multiples, kind=kind, seals=job.seals,
        compression=job.compression,
    )  # fmt: skip


def predict(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the response of the mass while a parameter changes: a curve without limits."""
    job = build_job(request.get("job"), folder)
    # part of a long record suffices for a preview
    fit = result_cache.fit_job(
        result_cache.select_fit_choices(job), job.arms == "auto", result_cache.MAX_QUICK_SAMPLES
    )
    live_curves = view_models.compute_live_response(
        _predict_response(fit, job, _get_frf_kind(request), LIVE_LINES)
    )
    return wire_format.encode_message(
        {"peak": live_curves.words, "command": format_job_command("report", job)},
        live_curves.arrays,
    )


def _draw_hammer(study: Study, job: Job, sizes: view_models.Sizes) -> dict[str, Any]:
    """Return the table for the selection of hits, and their panels."""
    impact, frf = study.impact, study.measured
    if impact is None or frf is None or not frf.hits:
        return {"hits": view_models.render_hits(impact, frf, None), "hit_panels": {}}
    selection = hammer_results.propose_selection(impact, frf, job.hammer)
    panels = view_models.render_hit_panels(study, sizes)
    panels |= hammer_results.draw_hits(impact, frf, job.hammer, sizes)
    return {"hits": view_models.render_hits(impact, frf, selection), "hit_panels": panels}


def study(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return a study: limits, comparison, joint model if requested, values and verdict."""
    job = build_job(request.get("job"), folder)
    sizes = get_panel_sizes(request)
    study = result_cache.get_study(job)
    # without a stated mass there is no verdict on the hammer test yet
    asks_for_mass, solid = study.mass_inferred, study.joint or study.fit
    checks, verdict = (
        (study.fit.checks, study.fit.verdict)
        if asks_for_mass
        else (study.verdict_checks, study.verdict)
    )
    recommendation = recommend_solid(study, allow_rejected=True)
    indicators = (
        view_models.make_fit_indicators(study.fit)
        if asks_for_mass
        else first_screen.make_study_indicators(study, recommendation)
    )
    with_phase, title = (
        request.get("phase") is True,
        view_models.format_response_title(job, _get_frf_kind(request)),
    )
    by_eq5 = study.hold_fit if solid is study.fit and solid.family == "maxwell" else None
    message: dict[str, Any] = {
        "verdict": view_models.render_verdict(
            verdict, indicators, mass=view_models.find_explaining_mass(study)
        ),
        "colour": VERDICT_COLOURS[verdict.use],
        "hint": MASS_HINT if asks_for_mass else "",
        "answers": view_models.list_values(study, recommendation),
        "solid": view_models.render_arms(solid, relaxation_fit=study.fit if study.joint else None),
        "arms": solid.model.arms if solid.family == "maxwell" else "",
        "checks": view_models.render_checks(sorted(checks, key=lambda check: not check.failed)),
        "more": view_models.format_next_test(study, checks),
        "frf": view_models.render_study_panel(study, sizes, title, with_phase=with_phase),
        **_draw_hammer(study, job, sizes),
        "hammer": view_models.format_hammer_line(study),
        "panels": view_models.render_test_panels(
            solid,
            study.prepared,
            by_eq5,
            sizes,
            result_cache.prepare_uncut_test(job, study.prepared),
        ),
        "time_limits": _list_time_limits(study.prepared),
        "simulated": bool(find_simulated_files(study)),
        **judge_limits(request, folder, study).add_to(format_job_command("report", job)),
    }
    if request.get("base") is True and study.mass is not None:
        prediction, joint = result_cache.predict_base_motion(job), study.joint is not None
        message["frf"] = view_models.render_base_response(prediction, joint, sizes, title)
        study_job = replace(job, mass=study.mass)
        message["command"] += "\n" + format_predict_command(
            study_job, prediction.frf, "joint.json" if joint else FIT_FILE
        )
    return wire_format.encode_message(message)
