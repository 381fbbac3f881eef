"""View models: panels, tables and curves in the form that the page displays.

Pure functions, tested without a server. Terms, digits and symbols are those of the report.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib import import_module, resources
from typing import Any, NamedTuple

import numpy as np

from dashpot import plot
from dashpot.base import units
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict
from dashpot.base.number_format import (
    duration,
    format_cell,
    format_with_error,
    round_to_error,
    seals,
    symbol,
)
from dashpot.base.option_fields import FormField, Method, get_choice_values
from dashpot.base.plain_text import sentences
from dashpot.base.reported_values import UNKNOWN, ReportedValue
from dashpot.base.units import Dimension, convert_to_unit, get_display_unit
from dashpot.datamodel.bounds import StiffnessBounds
from dashpot.datamodel.fit import Fit, list_model_values
from dashpot.datamodel.frf import FRF, Kind
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.extensions.app import relaxation_panels
from dashpot.extensions.app.hit_selection import HitSelection
from dashpot.extensions.app.words import format_for_page
from dashpot.plot import relaxation
from dashpot.plot.frf_figure import (
    DISPLAY_UNITS,
    Curve,
    PredictionBand,
    about_peaks,
    coherence_panels,
    curves_of,
    magnitude_panel,
    make_prediction_bands,
    phase_panel,
    resonance_curves,
)
from dashpot.plot.layout import ROW
from dashpot.plot.picture import (
    JOINT,
    PREDICTED,
    REF,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Tag,
    joint_pen,
)
from dashpot.plot.plotted_data import downsample_to_extremes, select_plot_unit
from dashpot.plot.svg import strip, swatch
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE
from dashpot.registry import KINDS
from dashpot.report import first_screen
from dashpot.report.figures import draw_stabilisation_chart
from dashpot.report.first_screen import GRADE_MARKS, Indicator, Row
from dashpot.report.page_frame import VERDICT_COLOURS, environment
from dashpot.report.result_page import Group
from dashpot.vibration.impact.checks import high_frequency_mass_agrees
from dashpot.vibration.impact.hits import cut_hits
from dashpot.workflow.frf_prediction import Prediction
from dashpot.workflow.inspections import InspectedFile
from dashpot.workflow.job import Job
from dashpot.workflow.recommended_solid import Recommendation, RecommendedValue
from dashpot.workflow.study import Study

ROLES = ("time", "displacement", "force", "hammer", "acceleration")
"""Roles of the columns of a relaxation test or hammer test."""
_SEPARATE_SECTIONS = ("response", "base", "bench", "level", "standalone", "part")
"""Sections of the page with files that belong to no job, or to several."""
REQUESTED_DIMENSIONS: tuple[Dimension, ...] = ("time", "length", "force", "acceleration")
"""Dimensions of the units that a column may have."""
EQ5_PEN = Pen("ref", 1.6, (2, 3))
SHORT_LABELS = {
    "residual: range of samples": "range of samples", "residual: mean": "mean",
    "noise, one SD": "noise", "ramp": "", "eq. (5), hold only": "eq. (5)",
    "k∞, relaxation fit": "k∞", "k∞, fit": "k∞", "relaxation fit": "arms",
    "predicted from relaxation": "predicted",
    "95 % bounds over all spectra": "bounds over all spectra",
    "unresolved range": "outside the test", "other family from relaxation": "other family",
    "band that every accepted hit excites": "excited by all",
    "fitted mode": "mode", "new pole": "new", "stable in frequency": "stable in frequency",
    "stable in frequency and damping": "stable in damping",
}  # fmt: skip
"""Short labels in the key of a figure with a title."""
STIFFNESS_LABELS = {
    "relaxation fit": "valid band", "relaxation fit, extrapolated": "extrapolated",
    "fit, extrapolated": "extrapolated", "fit": "valid band",
    "95 % interval of the parameters": "95 % interval",
    "95 % bounds over all spectra": "bounds over all spectra",
}  # fmt: skip
"""Labels in the key of stiffness over frequency."""
Sizes = Mapping[str, tuple[float, float]]
"""Width and height of the drawing of each panel, px."""
HIDDEN_SIZE = (400.0, 180.0)
"""Size of a panel that is not shown yet, px."""
LABELLED_AT_LINE = {"displacement", "coherence"}
"""Marks labelled in the drawing, not in a legend."""
MIN_WIDTH, NARROW_WIDTH = 160.0, 480.0
"""Least width of a drawing, px; below which two peaks are named and no third."""
HEIGHT_SHARES = {1: (1.0,), 2: (0.6, 0.4), 3: (0.56, 0.26, 0.18)}
"""Shares of the height of a drawing, to each of its panels."""
PULSE_SIZE, PULSE_EDGE = (88, 26), 0.1
"""Size of the drawing of a pulse, px; at which part of its peak it begins and ends."""
MAX_SAME_TAU_FACTOR = 3.0
"""Ratio of relaxation times up to which arms of two solids count as the same."""
MAX_LISTED_ARMS = 8
"""Largest number of arms in a table."""
MIN_PLOT_HEIGHT = 44.0
"""Least height of a plot, px: below it no curve can be read."""
LIVE_POINTS = 240
"""Points of a curve while a handle is dragged."""


def render_template(name: str, **values: Any) -> str:
    """Return a piece of the page, from its template; text from files is escaped."""
    return str(environment("dashpot.extensions.app").get_template(f"{name}.html").render(values))


def preload_templates() -> None:
    """Load every template and module, so that the first plot is not delayed."""
    for module in ("msgspec", "dashpot.reading.formats.text", "dashpot.plot.solid"):
        import_module(module)
    template_environment = environment("dashpot.extensions.app")
    for path in resources.files("dashpot.extensions.app").joinpath("templates").iterdir():
        template_environment.get_template(path.name)


# -- panels ---------------------------------------------------------------------------------------


def render_panels(
    name: str, panels: Panel | tuple[Panel, ...], sizes: Sizes, *, title: str = "", note: str = ""
) -> str:
    """Panels as the page has them: the key, then the drawing at the size of its place.

    Of several, one below the other, the first is as high as `HEIGHT_SHARES` of them. A `title`
    replaces the heading of the slot; a `note` replaces the legend.
    """
    width, height = sizes.get(name, HIDDEN_SIZE)
    panel_strip = panels if isinstance(panels, tuple) else (panels,)
    without_titles = bool(title)
    frame_height = (
        2 * ROW
        + 6
        + len(panel_strip) * (4 + ROW * (not without_titles))
        + 10 * (len(panel_strip) - 1)
    )
    plot_height = max(height - frame_height, MIN_PLOT_HEIGHT * len(panel_strip))
    shares = HEIGHT_SHARES[len(panel_strip)]
    panel_strip = tuple(
        replace(
            panel,
            height=share * plot_height,
            without_y_label=without_titles,
            title="",
            note="" if without_titles else panel.note,
        )
        for panel, share in zip(panel_strip, shares, strict=True)
    )
    key_marks = [] if note else [item for item in Picture(name, "", (panel_strip,)).key
                           if item.label not in LABELLED_AT_LINE]  # fmt: skip
    samples = [(swatch(mark, name=f"{name}-k{i}"), mark.label) for i, mark in enumerate(key_marks)]
    svg = strip(panel_strip, name=name, width=max(width, MIN_WIDTH), kind="figure")
    return render_template("figure", key=samples, svg=svg, title=title, note=note)


def render_test_panels(
    fit: Fit,
    prepared: RampHold,
    by_eq5: Fit | None,
    sizes: Sizes,
    full_test: RampHold | None,
) -> dict[str, str]:
    """Ramp, hold with its residual, and arms of a fit, in the colour of its solid.

    With a shortened hold the `full_test` remains visible: its handle goes both ways.
    """
    plotted_fit = _make_plotted_fit(fit, prepared)
    eq5_fit = None
    if by_eq5 is not None and fit.method != "hold":
        eq5_fit = relaxation.PlottedFit(by_eq5, EQ5_PEN, *relaxation.fitted_force(by_eq5, prepared))
    ramp, hold, residual_panel = relaxation_panels.make_fit_panels(
        plotted_fit, prepared, comparison_fit=eq5_fit, full_test=full_test
    )
    force, residual_unit = (panel.y.label.rpartition(", ")[2] for panel in (hold, residual_panel))
    noise_note = _format_noise_comparison(residual_panel.note, prepared, residual_unit)
    arms = _label_arms(plot.spectrum(fit).panels[0], fit)
    return {
        "ramp": render_panels("ramp", _shorten_key(ramp), sizes, title=f"Ramp, {force}"),
        "hold": render_panels(
            "hold", (_shorten_key(hold), _shorten_key(residual_panel)), sizes,
            title=f"Hold, {force}; residual, {residual_unit}", note=noise_note,
        ),
        "spectrum": render_panels(
            "spectrum", _recolour_panel(_shorten_key(arms), _get_solid_colour(fit)), sizes,
            title=f"{'Arms' if fit.family == 'maxwell' else 'Spectrum'}, "
            f"{arms.y.label.rpartition(', ')[2]}",
        ),
    }  # fmt: skip


def _format_noise_comparison(residual_text: str, prepared: RampHold, unit: str) -> str:
    """Return the residual of a force against its noise, in `unit` if that is the axis'."""
    force_unit, factor = select_plot_unit(np.array([prepared.force_noise]), "N")
    noise_text = round_to_error(factor * prepared.force_noise, digits=2)
    text = f"{residual_text.removesuffix(force_unit).rstrip()}, noise {noise_text}"
    return text if force_unit == unit else f"{text} {force_unit}"


def render_record_panels(prepared: RampHold, sizes: Sizes) -> dict[str, str]:
    """Ramp and hold as they were recorded, where they will stand upon their fit."""
    ramp, hold = map(_shorten_key, relaxation_panels.make_record_panels(prepared))
    empty_residual = Panel(hold.x, Scale("residual", (0.0, 1.0), unnumbered=True), ())
    unit = ramp.y.label.rpartition(", ")[2]
    return {
        "ramp": render_panels("ramp", ramp, sizes, title=f"Ramp, {unit}"),
        "hold": render_panels("hold", (hold, empty_residual), sizes, title=f"Hold, {unit}"),
    }


def _make_plotted_fit(fit: Fit, prepared: RampHold) -> relaxation.PlottedFit:
    """Return a fit with its curve, in the colour of its solid."""
    plotted_fit = relaxation.make_plotted_fits(fit, (), prepared)[0]
    return plotted_fit._replace(pen=replace(plotted_fit.pen, colour=_get_solid_colour(fit)))


def _get_solid_colour(fit: Fit) -> str:
    """Return the colour of the solid: of the relaxation test alone, or of both tests."""
    return "fit" if fit.method in get_choice_values(Method) else "joint-ink"


def _recolour_panel(panel: Panel, colour: str) -> Panel:
    """Return a panel whose marks of the fit have the colour of its solid."""

    def recolour_mark(mark: Mark) -> Mark:
        if isinstance(mark, (Dots, Tag)) and mark.colour == "fit":
            return replace(mark, colour=colour)
        if isinstance(mark, Line) and mark.pen.colour == "fit":
            return replace(mark, pen=replace(mark.pen, colour=colour))
        return mark

    return replace(panel, marks=tuple(map(recolour_mark, panel.marks)))


def _label_arms(panel: Panel, fit: Fit) -> Panel:
    """Return the spectrum of the arms, with a label on each; k∞ is in the table."""
    if fit.family != "maxwell" or not fit.model.arms:
        return panel
    k = convert_to_unit(np.array(fit.model.k), get_display_unit(fit.unit)).tolist()
    tips = list(zip(fit.model.tau, k, strict=True))
    tags = [
        Tag(tau, tip, f"{symbol(f'tau_{j}')} {duration(tau)}", "fit", "filled")
        for j, (tau, tip) in enumerate(tips, 1)
    ] if len(tips) <= MAX_LISTED_ARMS else []  # fmt: skip
    marks = (
        replace(mark, label="") if isinstance(mark, Line) and mark.label else mark
        for mark in panel.marks
        if not isinstance(mark, Rule)
    )
    tops = [mark.y for mark in panel.marks if isinstance(mark, Line)]
    top = 1.25 * max(float(np.nanmax(top)) for top in tops)
    return replace(
        panel, marks=(*marks, *tags), y=replace(panel.y, limits=(0.0, min(top, 2.5 * max(k))))
    )


def _shorten_key(panel: Panel, words: Mapping[str, str] = SHORT_LABELS) -> Panel:
    """Return the panel with a key of one line: beside its title each mark needs a word."""
    marks: list[Mark] = []
    for mark in panel.marks:
        if not isinstance(mark, Tag) and mark.label:
            short_label = "fit" if mark.label.startswith("fit, ") else mark.label
            mark = replace(mark, label=words.get(short_label, short_label))  # noqa: PLW2901
        marks.append(mark)
    return replace(panel, marks=tuple(marks))


def format_response_title(job: Job, quantity: Kind) -> str:
    """Return the title of the panel of the response."""
    name = quantity.value.replace("_", " ").capitalize()
    return f"{name} of {format_load(job)}, {DISPLAY_UNITS[quantity][0]}"


def render_response(predicted: FRF, sizes: Sizes, title: str) -> str:
    """Return the predicted response before anything bounds it."""
    if predicted.quantity is Kind.TRANSMISSIBILITY:
        curve = Curve(predicted, "predicted from relaxation", PREDICTED)
        return render_panels("frf", magnitude_panel([curve]), sizes, title=title)
    return render_panels("frf", plot.resonance(None, predicted).panels[0], sizes, title=title)


def render_stiffness(
    fit: Fit,
    sizes: Sizes,
    *,
    parameters: StiffnessBounds | None = None,
    unresolved_bounds: StiffnessBounds | None = None,
) -> str:
    """Return storage stiffness and loss factor of one seal, with their interval and their bound."""
    from dashpot.plot.solid import stiffness

    picture = stiffness(fit, parameters=parameters, unresolved_bounds=unresolved_bounds)
    storage_panel, _, loss_panel = (panel for (panel,) in picture.strips)
    unit = storage_panel.y.label.rpartition(", ")[2]
    modulus = "E′" if fit.unit == "Pa" else "K′"
    shortened_panels = tuple(
        _shorten_key(panel, STIFFNESS_LABELS) for panel in (storage_panel, loss_panel)
    )
    title = f"{modulus} of one seal, {unit}; loss factor"
    return render_panels("frf", shortened_panels, sizes, title=title) + render_template("give_mass")


def render_study_panel(study: Study, sizes: Sizes, title: str, *, with_phase: bool = False) -> str:
    """Return the response of the mass, with all that is known of it.

    Without a mass it is the stiffness of one seal.

    Of a study of both tests the solid of both is held against the hammer, and that of the
    relaxation test alone stands dotted beside it. `with_phase` draws the phase below, and the
    coherence.
    """
    if study.prediction is None:
        parameters = study.parameters if study.joint is None else None
        return render_stiffness(
            study.fit, sizes, parameters=parameters, unresolved_bounds=study.unmeasured
        )
    curves, limits = _make_response_curves(study)
    if sizes.get("frf", HIDDEN_SIZE)[0] < NARROW_WIDTH:
        curves = [replace(curve, peak=None) if curve.pen is REF else curve for curve in curves]
    panel = magnitude_panel(curves, limits, view=about_peaks(curves), tagged=True)
    lower_panels: tuple[Panel, ...] = ()
    if with_phase:
        lower_panels = (
            phase_panel(curves, panel.x.limits),
            *_make_coherence_panels(study, panel.x),
        )
    return render_panels(
        "frf", tuple(map(_shorten_key, (panel, *lower_panels))), sizes, title=title
    )


def _make_coherence_panels(study: Study, frequency: Scale) -> tuple[Panel, ...]:
    if study.measured is None:
        return ()
    return tuple(
        replace(panel, marks=tuple(
            replace(mark, label="coherence") if isinstance(mark, Line) else mark
            for mark in panel.marks
        ))
        for panel in coherence_panels(study.measured, frequency)
    )  # fmt: skip


def _make_response_curves(study: Study) -> tuple[list[Curve], tuple[PredictionBand, ...]]:
    """Return the curves of the tab's model, of the hammer, and the prediction's bounds."""
    joint, comparison = study.joint_comparison, study.comparison
    if joint is None or comparison is None or study.prediction is None:
        return _make_predicted_curves(study), make_prediction_bands(study.frf_band)[:1]
    is_failed = study.joint is not None and study.joint.verdict.use == "do not use"
    measured, relaxation_curve, joint_curve = curves_of(comparison, joint, failed=is_failed)
    if joint_curve.pen is JOINT:
        joint_curve = replace(joint_curve, label="joint model")
    return [measured, joint_curve, replace(relaxation_curve, label="relaxation alone", pen=REF)], ()


def _make_predicted_curves(study: Study) -> list[Curve]:
    """Return the prediction from the relaxation test, as the figure of a resonance has it."""
    return resonance_curves(study.comparison, study.prediction, alternative=study.rival)  # type: ignore[arg-type]


def render_base_response(prediction: Prediction, is_joint: bool, sizes: Sizes, title: str) -> str:
    """Return the transmissibility to the mass, its peak, and from where on the mass is isolated."""
    pen, name = joint_pen(failed=False) if is_joint else (PREDICTED, "predicted from relaxation")
    panel = magnitude_panel([Curve(prediction.frf, name, pen, prediction.peak)], tagged=True)
    if prediction.isolation is not None:
        text = f"less than its base above {round_to_error(prediction.isolation, digits=4)} Hz"
        panel = replace(panel, marks=(*panel.marks, Rule(prediction.isolation, REF, label=text)))
    return render_panels("frf", panel, sizes, title=title)


def render_hit_panels(study: Study, sizes: Sizes) -> dict[str, str]:
    """Return the panels of the hits of a study, as :func:`render_pulse_panels` draws them."""
    if study.impact is None or study.measured is None:
        return {}
    return render_pulse_panels(study.impact, study.measured, draw_stabilisation_chart(study), sizes)


def render_pulse_panels(
    impact: ImpactTest, frf: FRF, chart: Picture | None, sizes: Sizes
) -> dict[str, str]:
    """The pulses of the hits, their spectra, the responses, and the stabilisation chart."""
    strips = plot.hits(impact, frf).strips
    panels = {"pulses": strips[0][0], "force": strips[1][0], "answers": strips[-1][0]}
    if chart is not None:
        panels["poles"] = chart.panels[-1]
    return {
        name: render_panels(name, replace(_shorten_key(panel), title=""), sizes)
        for name, panel in panels.items()
    }


def format_hammer_line(study: Study) -> str:
    """Return the entry of an averaged hammer test in the list of files."""
    if study.measured is None or not study.measured.hits:
        return ""
    accepted = sum(hit.accepted for hit in study.measured.hits)
    peak = (
        "" if study.comparison is None else f", {round_to_error(study.comparison.measured_hz)} Hz"
    )
    return f"{accepted} of {len(study.measured.hits)} hits{peak}"


# -- Curves while a handle is dragged -------------------------------------------------------------


class LiveCurves(NamedTuple):
    """Curves by panel and name, in axis units, with texts.

    Of a test in progress, `residual_note` labels the residual of the force.
    """

    arrays: dict[str, FloatArray]
    words: str
    residual_note: str = ""


def compute_live_test(
    fit: Fit,
    prepared: RampHold,
    by_eq5: Fit | None,
    *,
    unit: str = "N",
    time_origin: float | None = None,
) -> LiveCurves:
    """Return the curves, residual and numbers of a fit while a handle is dragged.

    The axes of the hold stand as they were drawn: they count from `time_origin` on the record's
    clock, s.
    """
    plotted_fit = _make_plotted_fit(fit, prepared)
    residual_time, residual = relaxation_panels.compute_mean_residual(plotted_fit, prepared)
    ramp, hold = (
        (line.x, line.y) for line in relaxation_panels.make_fit_lines(plotted_fit, prepared)
    )
    time_shift = 0.0 if time_origin is None else prepared.ramp_end - time_origin
    curves = {
        "ramp/fit": ramp,
        "hold/fit": (hold[0] + time_shift, hold[1]),
        "hold/mean": (residual_time + time_shift, convert_to_unit(residual, unit)),
    }
    arrays: dict[str, FloatArray] = {}
    for name, (x, y) in curves.items():
        keep = np.unique(np.linspace(0, len(x) - 1, LIVE_POINTS).astype(int))
        arrays[f"{name}/x"], arrays[f"{name}/y"] = x[keep], y[keep]
    residual_note = _format_noise_comparison(
        relaxation.residual_panel(plotted_fit, prepared).note, prepared, unit
    )
    return LiveCurves(
        arrays,
        render_template("paper_values", rows=make_parameter_rows(fit, by_eq5)),
        residual_note,
    )


def format_end_stiffness(fit: Fit, prepared: RampHold) -> tuple[str, str]:
    """Return name and value of the stiffness of one seal at the end of the hold."""
    unit, hold_time_text = (
        get_display_unit(fit.unit),
        duration(prepared.hold_time).replace(".0 ", " "),
    )
    k = convert_to_unit(float(fit.solid.relaxation(prepared.hold_time)), unit)
    return f"k after {hold_time_text}", f"{round_to_error(k, digits=4)} {unit}"


def make_parameter_rows(fit: Fit, by_eq5: Fit | None) -> list[tuple[str, str, str, str]]:
    """Name, value of the fit, value of eq. (5) and unit, of every parameter."""
    eq5_values = {}
    if by_eq5 is not None and fit.family != "fractional":
        eq5_values = {fact.name: fact.cells.value for fact in list_model_values(by_eq5)}
    return [
        (fact.symbol, fact.cells.value, eq5_values.get(fact.name, ""), fact.word)
        for fact in list_model_values(fit)
        if fact.name[0] != "b" and fact.name != "k_end"
    ]


def compute_live_response(predicted: FRF) -> LiveCurves:
    """Return the predicted response while the mass moves."""
    magnitude = np.abs(predicted.value)
    peak_index = int(magnitude.argmax())
    peak_text = (
        f"{round_to_error(float(predicted.frequency[peak_index]), digits=4)} Hz, "
        f"{round_to_error(float(magnitude[peak_index]))} "
        f"{DISPLAY_UNITS[predicted.quantity][0]}"
    )
    return LiveCurves(
        {"frf/predicted/x": predicted.frequency, "frf/predicted/y": magnitude}, peak_text
    )


# -- Parts of the page ----------------------------------------------------------------------------


def render_verdict(
    verdict: Verdict, indicators: Sequence[Indicator] = (), *, mass: str = ""
) -> str:
    """The verdict in colour and words, with its lights, and a mass, g, that would mend it."""
    return render_template(
        "verdict",
        verdict=verdict,
        colour=VERDICT_COLOURS[verdict.use],
        lights=indicators,
        mass=mass,
    )


def find_explaining_mass(study: Study) -> str:
    """The mass, g, of the best explanation of both tests; of a gross error that of the FRF."""
    best_explanation = next(iter(study.joint.evidence.explanations), None) if study.joint else None
    if best_explanation is not None and best_explanation.is_sufficient:
        is_mass_alone = best_explanation.name.split(" and ")[0] == "mass"
        return (
            round_to_error(
                convert_to_unit(best_explanation.value, "g"),
                convert_to_unit(best_explanation.standard_error, "g"),
            )
            if is_mass_alone
            else ""
        )
    mass_check = next(
        (
            check
            for check in study.verdict_checks
            if check.name == high_frequency_mass_agrees.name and check.failed
        ),
        None,
    )
    if (
        study.mass is None
        or study.mass_inferred
        or mass_check is None
        or mass_check.value is None
        or mass_check.value <= -1
    ):
        return ""
    return round_to_error(convert_to_unit(study.mass * (1 + mass_check.value), "g"), digits=4)


def make_fit_indicators(fit: Fit) -> tuple[Indicator, ...]:
    """Return the indicators of a fit, before the hammer and the limits are computed."""
    return (
        first_screen.make_test_light(fit.checks),
        *(Indicator(name, "open", "not looked at") for name in ("Stiffness", "Damping")),
    )


class Term(NamedTuple):
    """Parameter with its 95 % interval and a mark."""

    name: str
    value: str
    low: str
    high: str
    unit: str
    mark: str
    pads: tuple[str, ...] = ()
    """What is hidden behind value, low and high, so that points stand below each other."""


def make_terms(fit: Fit) -> list[Term]:
    """Return every parameter of the solid, the stiffness at the end of the hold first."""
    # b = k tau says of an arm what k and tau say
    return [make_term(fact) for fact in list_model_values(fit) if not fact.name.startswith("b_")]


def make_term(fact: ReportedValue) -> Term:
    """Return a number with the ends of its interval, and whether it is determined."""
    half_width = (fact.high - fact.low) / 2
    # known to half of itself is seen; beyond, it is not determined
    mark = "good" if 0 < half_width < 0.5 * abs(fact.value) else "care"
    return Term(fact.symbol, *fact.cell_texts, fact.word, mark)


class ArmRow(NamedTuple):
    """Spring or arm: stiffness and relaxation time with their standard errors."""

    name: str
    k: str
    k_error: str
    tau: str
    tau_error: str
    mark: str
    note: str = ""


def _is_near_any(tau: float, values: Iterable[float]) -> bool:
    return any(1 / MAX_SAME_TAU_FACTOR < tau / value < MAX_SAME_TAU_FACTOR for value in values)


def render_arms(fit: Fit, *, relaxation_fit: Fit | None = None) -> str:
    """Return the solid of one seal, one row an arm; arms not in `relaxation_fit` are marked.

    A solid without arms, or with too many to read, is shown by its parameters.
    """
    if fit.family != "maxwell" or fit.model.arms > MAX_LISTED_ARMS:
        return render_solid(fit)
    reported_values = {fact.name: fact for fact in list_model_values(fit)}
    row_parameters = [("k∞", "k_inf", "")]
    row_parameters += [(f"arm {j}", f"k_{j}", f"tau_{j}") for j in range(1, fit.model.arms + 1)]
    if "b" in reported_values:
        row_parameters.append((f"dashpot, {reported_values['b'].word}", "b", ""))
    rows = []
    for name, *parameter_names in row_parameters:
        facts = [reported_values[text] for text in parameter_names if text in reported_values]
        cells = [text for fact in facts for text in (fact.cell_texts[0], _format_error(fact))]
        marks = [make_term(fact).mark for fact in facts]
        is_new = (
            len(facts) > 1
            and relaxation_fit is not None
            and not _is_near_any(facts[1].value, relaxation_fit.model.tau)
        )
        k, k_error, tau, tau_error = (*cells, "", "")[:4]
        mark = max(marks, key=first_screen.MARK_ORDER.index)
        rows.append(ArmRow(name, k, k_error, tau, tau_error, mark, "hammer" if is_new else ""))
    unit = reported_values["k_inf"].word
    return render_template("arms", rows=rows, unit=unit, of=fit._identity)


def _format_error(fact: ReportedValue) -> str:
    """Return the standard error of a number; its highest value where that is all that is known."""
    if fact.is_at_most or fact.is_upper_bound:
        return f"≤ {fact.cell_texts[2]}"
    return "not known" if fact.cells.error == UNKNOWN else fact.cells.error


def render_solid(fit: Fit) -> str:
    """Return the solid of one seal, each term with its interval and a mark."""
    shown_terms, spectrum_note = make_terms(fit), ""
    if fit.family == "maxwell" and fit.model.arms > MAX_LISTED_ARMS:
        shown_terms = [new_term for new_term in shown_terms if new_term.name == symbol("k_inf")]
        spectrum_note = (
            f"and a spectrum of {fit.model.arms} arms from {fit.model.tau[0]:.3g} to "
            f"{fit.model.tau[-1]:.3g} s, a table for a solver: fit.json holds it."
        )
    return render_terms("Model of one seal", shown_terms, spectrum_note, subject=fit._identity)


def render_terms(title: str, terms: Sequence[Term], note: str = "", *, subject: str = "") -> str:
    """Render terms by unit, each with its interval and a mark, and notes on them.

    `subject` is the identity of the fit, by which a deck is requested.
    """
    groups = []
    for unit in dict.fromkeys(term.unit for term in terms):
        rows = [term for term in terms if term.unit == unit]
        columns = [_make_pads(texts) for texts in zip(*(row[1:4] for row in rows), strict=True)]
        groups.append(
            (unit, [row._replace(pads=pads) for row, *pads in zip(rows, *columns, strict=True)])
        )
    return render_template("solid", title=title, groups=groups, more=note, of=subject)


def _make_pads(texts: Sequence[str]) -> list[str]:
    """Return the padding behind each number that aligns their decimal points."""
    decimal_counts = [len(text.partition(".")[2]) for text in texts]
    return [
        "." * (not decimals and max(decimal_counts) > 0) + "0" * (max(decimal_counts) - decimals)
        if text[-1:].isdigit()
        else ""
        for text, decimals in zip(texts, decimal_counts, strict=True)
    ]


def render_checks(checks: Sequence[Check]) -> str:
    """Render the failed checks, the gravest first, and the number of checks by grade."""
    unique_checks = list(dict.fromkeys(checks))
    failed_checks = [
        (GRADE_MARKS[check.grade], *_split_finding(check), check.message_with_remedy)
        for check in unique_checks
        if check.failed
    ]
    failed_checks.sort(key=lambda row: -first_screen.MARK_ORDER.index(row[0]))
    passed_count = sum(check.passed is True for check in unique_checks)
    grades = [
        (mark, f"{count} {grade}{'' if count == 1 else 's'}")
        for grade, mark in reversed(GRADE_MARKS.items())
        if (count := sum(failed_row[0] == mark for failed_row in failed_checks))
    ]
    grades.sort(key=lambda pair: -first_screen.MARK_ORDER.index(pair[0]))
    return render_template(
        "checks",
        failed=failed_checks,
        passed=passed_count,
        checked=passed_count + len(failed_checks),
        grades=grades,
    )


def _split_finding(check: Check) -> tuple[str, str]:
    """Return the finding of a check in one sentence, and its remedy."""
    return sentences(check.message)[0], check.remedy.words if check.remedy else ""


def list_values(study: Study, recommendation: Recommendation) -> str:
    """Return the numbers that one came for, of the solid of the tab."""
    title, rows = first_screen.make_mass_rows(study, recommendation)
    value_groups: list[tuple[str, list[Row]]] = []
    if rows:
        pairs = zip(recommendation.mass_values, rows, strict=True)
        value_groups.append((title, [_shorten_name(*pair) for pair in pairs]))
    pairs = zip(
        recommendation.seal_values, first_screen.rows(recommendation.seal_values), strict=True
    )
    value_groups.append(("One seal", [_shorten_name(*pair) for pair in pairs]))
    has_measurement = study.comparison is not None
    return render_template(
        "answers", groups=value_groups, measured=has_measurement, ranged=True, caption="Numbers",
        note=""
    )  # fmt: skip


def format_next_test(study: Study, checks: Sequence[Check]) -> str:
    """Return the test that would determine the end of the hold; "" if a check states it."""
    end = study.fit.evidence.end_of_hold
    stated_remedies = {check.remedy.words for check in checks if check.failed and check.remedy}
    if end is None or end.remedy in stated_remedies:
        return ""
    return render_template("more", remedy=end.remedy, limits_text=end.format_limits(study.fit.unit))


def render_groups(groups: Sequence[Group], text: str, note: str) -> str:
    """Return the table of a result of a kind: value, from and to of each number."""
    value_groups = [(group.title, group.rows) for group in groups if group.rows]
    has_measurement = any(row.measured for _, rows in value_groups for row in rows)
    has_interval = any(row.low or row.high for _, rows in value_groups for row in rows)
    return render_template(
        "answers", groups=value_groups, measured=has_measurement, ranged=has_interval, caption=text,
        note=note
    )  # fmt: skip


def _shorten_name(value: RecommendedValue, row: Row) -> Row:
    """Return a number under a name that does not wrap beside its five cells."""
    return row._replace(name=get_short_name(value))


def get_short_name(value: RecommendedValue) -> str:
    """Return a number's name that does not wrap beside its cells."""
    frequency_text = "" if value.at is None else round_to_error(value.at)
    return {
        "frequency": "Frequency", "damping": "Damping", "peak": "Peak",
        "end of hold": f"k after {frequency_text.removesuffix('.0')} s",
        "dynamic stiffness": f"K′ at {frequency_text} Hz",
        "loss factor": "Loss factor",
    }[value.quantity]  # fmt: skip


def format_load(job: Job) -> str:
    """Return the mass and the number of seals under it."""
    mass_text = "the mass" if job.mass is None else format_with_error(job.mass, "g", digits=4)
    return f"{mass_text} on {seals(job.seals)}"


def render_hits(impact: ImpactTest | None, frf: FRF | None, selection: HitSelection | None) -> str:
    """Return every hit with its pulse and its verdict, and which to keep; nothing without hits."""
    if frf is None or not frf.hits:
        return ""
    deviations = {} if selection is None else selection.deviations
    return render_template(
        "hits", hits=frf.hits, pulses=_draw_pulses(impact), size=PULSE_SIZE,
        off={name: f"{round_to_error(100 * value, digits=2)} %" for name,
        value in deviations.items()},
        message="" if selection is None else selection.message,
        keep=",".join(selection.keep) if selection is not None and selection.drop else "",
    )  # fmt: skip


def _draw_pulses(impact: ImpactTest | None) -> dict[str, str]:
    """Return the path of each hit's pulse by its name, all to one scale."""
    if impact is None:
        return {}
    (width, height), blocks = PULSE_SIZE, cut_hits([impact])
    longest = max(max(block.width(PULSE_EDGE), 8 / block.rate) for block in blocks)
    largest_force = max(float(block.force.max()) for block in blocks)
    entries = {}
    for hit_block in blocks:
        time = (np.arange(len(hit_block.force)) - hit_block.onset) / hit_block.rate
        is_shown = (time > -0.5 * longest) & (time < 2.5 * longest)
        t, force = downsample_to_extremes(time[is_shown], hit_block.force[is_shown], bins=width)
        x, y = (
            width * (t / longest + 0.5) / 3,
            height * (1 - np.clip(force / largest_force, -0.05, 1)) + 1,
        )
        entries[hit_block.name] = "M" + "L".join(
            f"{a:.1f} {b:.1f}" for a, b in zip(x, y, strict=True)
        )
    return entries


def get_section(inspection: InspectedFile) -> str:
    """Return where the page takes a file; empty if not."""
    return KINDS[inspection.kind].app_section if inspection.kind in KINDS else ""


def make_form_fields(fields: Sequence[FormField]) -> list[dict[str, Any]]:
    """Return the form fields of a file as the page's script takes them."""
    return [{"name": item.name, "label": item.label, "unit": item.unit, "choices": [*item.choices],
             "each": item.per_file} for item in fields]  # fmt: skip


def file_row(inspection: InspectedFile) -> dict[str, Any]:
    """Return the entry of a file in the list: its kind, one line, a mark."""
    is_unusable = _get_refusal(inspection) or _format_unplaced_kind(inspection)
    mark = "care" if inspection.questions else "bad" if is_unusable else "good"
    return {
        "kind": inspection.kind,
        "page": get_section(inspection),
        "line": format_for_page(_format_file_line(inspection)),
        "mark": mark,
        "simulated": inspection.simulated,
    }


def _format_file_line(inspection: InspectedFile) -> str:
    preparation = inspection.preparation
    if preparation is not None:
        ramp, hold = round_to_error(preparation.ramp_time), round_to_error(preparation.hold_time)
        return f"{format_cell(preparation.depth, 'mm')} mm, {ramp} s, {hold} s"
    if inspection.questions:
        question = inspection.questions[0]
        unit = "a unit" if "--units" in question.option else "a column"
        return f"asks: {'a specimen' if question.answers else unit}"
    if get_section(inspection) in _SEPARATE_SECTIONS:
        return _get_refusal(inspection) or KINDS_OF_FILE[inspection.kind].label
    return inspection.refusal or inspection.reason


def _get_refusal(inspection: InspectedFile) -> str:
    """Return why a file is not fitted; not for loops, which have no ramp and hold."""
    return "" if get_section(inspection) == "level" else inspection.refusal


def _format_heading(inspection: InspectedFile) -> str:
    if inspection.questions:
        return f"What does {inspection.file} hold?"
    if _format_unplaced_kind(inspection):
        return f"{inspection.file} is {KINDS_OF_FILE[inspection.kind].label}"
    return f"{inspection.file} was not read"


def _format_unplaced_kind(inspection: InspectedFile) -> str:
    """Return the advice for a file of a kind that this page does not take; empty for others."""
    has_place = get_section(inspection) or inspection.kind not in KINDS_OF_FILE
    if inspection.questions or inspection.refusal or has_place:
        return ""
    advice = KINDS_OF_FILE[inspection.kind].usage
    return (
        "this page takes relaxation tests, hammer files, FRFs, sweeps, loops, moduli and creep "
        f"tests; for this one: {advice}"
    )


class UnitImplication(NamedTuple):
    """Largest force and stiffness of the seal, were a column in this unit."""

    unit: str
    force: str
    stiffness: str


def render_column_questions(
    result: InspectedFile,
    consequences: Sequence[UnitImplication],
    rate: float | None,
    specimens: Sequence[Mapping[str, Any]],
) -> str:
    """Return the first rows with choices of roles and units, and the open questions.

    The sampling rate, Hz, is requested where no column is the time, or one was given; of several
    specimens one is to be chosen, or all.
    """
    units_by_dimension: dict[str, list[str]] = {}
    for unit in units.TABLE.values():
        if unit.dimension in REQUESTED_DIMENSIONS:
            units_by_dimension.setdefault(unit.dimension, []).append(unit.word)
    return render_template(
        "column_questions", file=result, heading=_format_heading(result),
        stranger=_format_unplaced_kind(result), roles=ROLES,
        units=units_by_dimension, consequences=consequences, on_page=format_for_page, rate=rate,
        timeless=rate is not None or any(question.role == "time" for question in result.questions),
        rows=list(zip(*(column.first for column in result.columns), strict=False)),
        specimens=specimens,
    )  # fmt: skip
