"""Comparison of two fits: responses, residuals, and each parameter by its interval."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.number_format import decibels, percent, round_to_error
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.fit import Fit, list_model_values
from dashpot.datamodel.relaxation import RampHold
from dashpot.extensions.app import relaxation_panels, result_cache, view_models, wire_format
from dashpot.extensions.app.request_parsing import build_job, get_panel_sizes, require_mapping
from dashpot.plot import relaxation
from dashpot.plot.frf_figure import (
    Curve,
    about_peaks,
    magnitude_panel,
    make_prediction_bands,
    resonance_curves,
)
from dashpot.plot.picture import (
    JOINT,
    MEASURED,
    PREDICTED,
    REF,
    Line,
    Mark,
    Panel,
    Pen,
    Rule,
    Scale,
)
from dashpot.plot.plotted_data import compute_padded_limits, downsample_to_means
from dashpot.report.first_screen import Indicator
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.workflow.job import Job
from dashpot.workflow.recommended_solid import Recommendation, RecommendedValue, recommend_solid
from dashpot.workflow.study import Study

PENS = {"A": Pen("fit", 2.0, (7, 4)), "B": Pen("joint-ink", 2.0)}
MULTIPLE_FROM = 1.5
"""Ratio above which a difference is stated as a multiple, not in per cent."""


class ComparedFit(NamedTuple):
    """One of two compared fits: its job and its study."""

    name: str
    job: Job
    study: Study
    recommendation: Recommendation

    @property
    def solid(self) -> Fit:
        """The solid of its tab."""
        return self.study.joint or self.study.fit

    @property
    def ramp_hold(self) -> RampHold:
        """The test behind it, as it was prepared."""
        return result_cache.select_shown_test(self.job, self.solid)[1]

    @property
    def values(self) -> tuple[RecommendedValue, ...]:
        """Its numbers."""
        return self.recommendation.values


def _load_fit(name: str, request: Mapping[str, Any], folder: Path) -> ComparedFit:
    options = require_mapping(request.get(name.lower()), name)
    job = build_job(options.get("job"), folder)
    study = result_cache.get_study(job)
    if job.joint and study.joint is None:
        raise DataError(f"{name} has no joint model: open a hammer test, and give the mass")
    return ComparedFit(name, job, study, recommend_solid(study, allow_rejected=True))


def build_fit_comparison(request: Mapping[str, Any], folder: Path) -> bytes:
    """Comparison of two fits: their figures, and a table with the differences."""
    a, b = (_load_fit(name, request, folder) for name in "AB")
    sizes = get_panel_sizes(request)
    rows = [*_compare_numbers(a, b), *_compare_arms(a.solid, b.solid)]
    return wire_format.encode_message(
        {
            "verdict": view_models.render_template(
                "fit_comparison",
                message=_format_comparison(a, b, rows),
                lights=_make_indicators(a, b),
            ),
            "colour": "open",
            "panels": {
                "ab-frf": _render_responses(a, b, sizes),
                "ab-rest": _render_residuals(a, b, sizes),
            },
            "table": view_models.render_template(
                "compared_values", rows=rows, names=(_get_source_name(a), _get_source_name(b))
            ),
            "simulated": True
            in {
                side.study.test.source is not None and side.study.test.source.simulated
                for side in (a, b)
            },
        }
    )


def _get_source_name(compared_fit: ComparedFit) -> str:
    return "joint model" if compared_fit.study.joint is not None else "relaxation"


def _make_indicators(a: ComparedFit, b: ComparedFit) -> tuple[Indicator, ...]:
    return tuple(
        Indicator(side.name, VERDICT_COLOURS[side.study.verdict.use], side.study.verdict.use)
        for side in (a, b)
    )


class ComparedValue(NamedTuple):
    """Value of A, the same value of B, their difference, and the interval of A."""

    name: str
    a: str
    b: str
    difference: str
    agreement: str
    group: str = ""


def _compare_numbers(a: ComparedFit, b: ComparedFit) -> Iterator[ComparedValue]:
    """Return the numbers that both fits have, with the limits of A."""
    values_of_b = {value.quantity: value for value in b.values}
    mass_quantities = {answer.quantity for answer in a.recommendation.mass_values}
    for value_of_a in a.values:
        value_of_b = values_of_b.get(value_of_a.quantity)
        if value_of_b is None:
            continue
        name, unit = view_models.get_short_name(value_of_a), value_of_a.fact.word
        group = (
            view_models.format_load(a.job) if value_of_a.quantity in mass_quantities else "One seal"
        )
        yield ComparedValue(
            f"{name}, {unit}" if unit else name, value_of_a.fact.cell_texts[0],
            value_of_b.fact.cell_texts[0], _format_difference(value_of_a, value_of_b),
            _classify_overlap(value_of_a, value_of_b),
            group,
        )  # fmt: skip


def _format_difference(first: RecommendedValue, second: RecommendedValue) -> str:
    """Return how much the other number is more; of a peak in dB."""
    if first.quantity == "peak" and first.value > 0 and second.value > 0:
        return decibels(20 * math.log10(second.value / first.value))
    return _format_relative_difference(first.value, second.value)


def _format_relative_difference(first: float, second: float) -> str:
    """Return how much the other is more: in per cent, or so many times."""
    if not first:
        return ""
    ratio = second / first
    if ratio > 0 and not 1 / MULTIPLE_FROM < ratio < MULTIPLE_FROM:
        return f"×{round_to_error(ratio, digits=2)}"
    return percent(ratio - 1)


def _classify_overlap(first: RecommendedValue, second: RecommendedValue) -> str:
    """Return whether the values of B are within the limits of A."""
    if math.isnan(first.low) or math.isnan(first.high):
        return "A has no bound"
    is_in_interval_a = first.low <= second.value <= first.high
    is_in_interval_b = second.low <= first.value <= second.high
    return (
        "inside both"
        if is_in_interval_a and is_in_interval_b
        else "inside A's"
        if is_in_interval_a
        else "outside A's"
    )


def _compare_arms(a: Fit, b: Fit) -> Iterator[ComparedValue]:
    """Springs and arms in one chart: common time constants in one row, others alone."""
    entries = [{fact.name: fact for fact in list_model_values(fit)} for fit in (a, b)]
    group = f"Model, k in {entries[0]['k_inf'].word}" if "k_inf" in entries[0] else "Model"
    if all("k_inf" in facts for facts in entries):
        yield _compare_values("k∞", entries[0]["k_inf"], entries[1]["k_inf"], group)
    if a.family != "maxwell" or b.family != "maxwell":
        return
    for i, j in match_time_constants(a.model.tau, b.model.tau):
        taus = [tau[n] for tau, n in ((a.model.tau, i), (b.model.tau, j)) if n is not None]
        name = " to ".join(dict.fromkeys(round_to_error(tau, digits=2) for tau in sorted(taus)))
        arm_of_a = None if i is None else entries[0].get(f"k_{i + 1}")
        arm_of_b = None if j is None else entries[1].get(f"k_{j + 1}")
        yield _compare_values(f"arm {name} s", arm_of_a, arm_of_b, group)


def match_time_constants(
    first: tuple[float, ...], second: tuple[float, ...]
) -> list[tuple[int | None, int | None]]:
    """Return the pairs of equal time constants of two models, ascending; None without partner.

    >>> match_time_constants((0.1, 0.5, 16.0), (0.01, 0.07, 0.5, 16.0))
    [(None, 0), (0, 1), (1, 2), (2, 3)]
    """
    distances = sorted(
        (abs(math.log(x / y)), i, j) for i, x in enumerate(first) for j, y in enumerate(second)
    )
    partners: dict[int, int] = {}
    for value, i, j in distances:
        if (
            value < math.log(view_models.MAX_SAME_TAU_FACTOR)
            and i not in partners
            and j not in partners.values()
        ):
            partners[i] = j
    pairs: list[tuple[int | None, int | None]] = [(i, partners.get(i)) for i in range(len(first))]
    pairs += [(None, j) for j in range(len(second)) if j not in partners.values()]
    return sorted(
        pairs,
        key=lambda pair: first[pair[0]] if pair[0] is not None else second[pair[1]],  # type: ignore[index]
    )


def _compare_values(
    name: str, a: ReportedValue | None, b: ReportedValue | None, group: str
) -> ComparedValue:
    if a is None or b is None:
        owner = "B's alone" if a is None else "A's alone"
        text_of_a, text_of_b = ("none" if fact is None else fact.cell_texts[0] for fact in (a, b))
        return ComparedValue(name, text_of_a, text_of_b, "", owner, group)
    errors = [fact.error for fact in (a, b)]
    difference_se = math.hypot(*(error or 0.0 for error in errors))
    has_error = (
        all(error is not None and math.isfinite(error) for error in errors) and difference_se > 0
    )
    difference_in_se = f"{abs(b.value - a.value) / difference_se:.1f} SE" if has_error else ""
    return ComparedValue(
        name,
        a.cell_texts[0],
        b.cell_texts[0],
        _format_relative_difference(a.value, b.value),
        difference_in_se,
        group,
    )


def _format_comparison(a: ComparedFit, b: ComparedFit, rows: list[ComparedValue]) -> str:
    """Return how far B is from A, in one sentence with its numbers."""
    values_of_b = {value.quantity: value for value in b.values}
    quantity_names = {
        "frequency": "frequency", "damping": "damping", "end of hold": "stiffness", "peak": "peak",
    }  # fmt: skip
    differences = [
        f"{quantity_names[answer.quantity]} "
        f"{_format_difference(answer, values_of_b[answer.quantity])}"
        for answer in a.values
        if answer.quantity in quantity_names and answer.quantity in values_of_b
    ]
    agreements = [
        row.agreement for row in rows if "A's" in row.agreement or row.agreement == "inside both"
    ]
    inside_count = sum("inside" in name for name in agreements)
    count = (
        f" {inside_count} of {len(agreements)} numbers lie inside what A left open."
        if agreements
        else ""
    )
    return f"B against A: {', '.join(differences)}.{count}"


def _get_response(compared_fit: ComparedFit) -> Curve | None:
    """Return the prediction of a model, with the peak of its own tab; None without a mass."""
    study = compared_fit.study
    comparison = study.joint_comparison if study.joint is not None else study.comparison
    frf = study.joint_prediction if study.joint is not None else study.prediction
    pen = PREDICTED if compared_fit.name == "A" else JOINT
    if comparison is not None:
        peak = comparison.predicted_hz, comparison.predicted_peak
        return Curve(comparison.predicted, compared_fit.name, pen, peak)
    if frf is None:
        return None
    (curve,) = resonance_curves(None, frf)
    return Curve(curve.frf, compared_fit.name, pen, curve.peak)


# -- figures --------------------------------------------------------------------------------------


def _render_responses(a: ComparedFit, b: ComparedFit, sizes: view_models.Sizes) -> str:
    """Return both responses in one panel, and the hammer's; empty without a mass."""
    limits = make_prediction_bands(a.study.frf_band if a.study.joint is None else None)[:1]
    curves = [curve for side in (a, b) if (curve := _get_response(side)) is not None]
    if len(curves) < 2:
        return ""
    measured = next((side.study.comparison for side in (a, b) if side.study.comparison), None)
    if measured is not None:
        peak = measured.measured_hz, measured.measured_peak
        curves.insert(0, Curve(measured.measured, "measured", MEASURED, peak))
    panel = magnitude_panel(curves, limits, view=about_peaks(curves), tagged=True)
    return view_models.render_panels("ab-frf", panel, sizes, title="Accelerance, 1/kg")


def _render_residuals(a: ComparedFit, b: ComparedFit, sizes: view_models.Sizes) -> str:
    """Return both residuals of the hold, as means over log time since the end of the ramp."""
    marks: list[Mark] = []
    notes, spans = [], []
    for side in (a, b):
        prepared = side.ramp_hold
        residual_panel = relaxation_panels.make_fit_panels(
            relaxation.make_plotted_fits(side.solid, (), prepared)[0], prepared
        )[2]
        (mean,) = [mark for mark in residual_panel.marks if isinstance(mark, Line)]
        x, y = downsample_to_means(mean.x, mean.y, log=True)
        marks.append(Line(x, y, PENS[side.name], side.name))
        notes.append(f"{side.name} {residual_panel.note}")
        spans.append(residual_panel.x.limits)
        unit = residual_panel.y.label.rpartition(", ")[2]
    noise = convert_to_unit(a.ramp_hold.force_noise, unit)
    rules = (
        (Rule(noise, REF, is_horizontal=True), Rule(-noise, REF, is_horizontal=True))
        if noise
        else ()
    )
    curves = [mark.y for mark in marks if isinstance(mark, Line)]
    time_span = (min(low for low, _ in spans), max(high for _, high in spans))
    panel = Panel(
        Scale(relaxation.TIME_AFTER_RAMP_LABEL, time_span, log=True),
        Scale(f"residual, {unit}", compute_padded_limits(*curves, np.array([noise, -noise]))),
        (*rules, *marks),
    )
    title = f"Residual of the hold, {unit}, mean"
    return view_models.render_panels("ab-rest", panel, sizes, title=title, note="; ".join(notes))
