"""Pages of a solid over frequency, and of FRFs: measured, predicted, compared."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np

from dashpot import plot
from dashpot.base.number_format import (
    duration,
    format_count,
    format_with_error,
    hertz,
    round_to_error,
    seals,
)
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit, get_display_unit
from dashpot.datamodel.fit import Fit, list_model_values
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.prediction_bounds import parameter_band, unresolved_arm_band
from dashpot.plot.picture import Span
from dashpot.registry import find_handler
from dashpot.report.figures import LEAD_WIDTH
from dashpot.report.first_screen import NBSP, Row
from dashpot.report.result_page import (
    CollapsibleSection,
    Group,
    KindPage,
    Topic,
    format_specimen_header,
    group,
    make_indicators,
    row,
)
from dashpot.report.tables import TextTable
from dashpot.workflow.frf_comparison import FRFComparison
from dashpot.workflow.frf_prediction import Prediction
from dashpot.workflow.identification import IdentificationResult
from dashpot.workflow.measured_frf import Modes

# Pages of FRFs: measured, predicted, and both compared.


_PEAK = frozenset({"prediction_in_valid_band", "seal_mass_negligible", "mass_of_a_block"})
_RESONANCE = frozenset({
    "resonance", "record_long_enough", "lines_in_half_power_band", "amplitude_linear",
})  # fmt: skip


def mode_rows(mode: Any) -> Iterator[Row]:
    """The numbers of one mode."""
    frequency, ratio, _ = mode.facts
    yield row(frequency, "Natural frequency")
    yield row(ratio, "Damping ratio")


def modes_page(modes: Modes) -> KindPage:
    """Return the page of hits or FRFs."""
    frf, first = modes.frf, next(iter(modes), None)
    used_text = f"{frf.averages} of {len(frf.hits)} used" if frf.hits else format_count(1, "FRF")
    top = f"to {round_to_error(float(frf.frequency[-1]), digits=3)}{NBSP}Hz"
    topics = (
        Topic("Hits" if frf.hits else "FRF", message=used_text),
        Topic("Resonance", _RESONANCE,
             "" if first is None else f"{round_to_error(first.frequency, digits=4)}{NBSP}Hz"),
        Topic("Band", {"coherence", "hammer_excites", "high_frequency_mass_agrees",
            "line_errors_stated"}, top),
    )  # fmt: skip
    hits = tuple(
        (hit.name, f"{hit.time:.3f}", round_to_error(hit.peak, digits=3),
         round_to_error(convert_to_unit(hit.duration, "ms"), digits=3),
         "accepted" if hit.accepted else f"rejected: {'; '.join(hit.reasons)}")
        for hit in frf.hits
    )  # fmt: skip
    row_classes = tuple("" if hit.accepted else "bad" for hit in frf.hits)
    header = ("hit", "time, s", "peak, N", "pulse width, ms", "verdict")
    hits_section = CollapsibleSection("Every hit", used_text, TextTable(header, hits, row_classes))
    return KindPage(
        subject="hammer test" if frf.hits else "measured FRF",
        summary_line=(("Hits", used_text), ("Averages", str(frf.averages)),
               ("Lines", str(len(frf.frequency))),
               ("Resolution", f"{frf.frequency[1] - frf.frequency[0]:.3g} Hz"),
               ("Quantity", frf.quantity.label)),
        indicators=make_indicators(modes.checks, *topics),
        figure_title="Measured response",
        picture=modes.plot(),
        table_title=format_count(len(modes), "mode").capitalize(),
        groups=tuple(Group(f"Mode {i}", tuple(mode_rows(mode)))
                     for i, mode in enumerate(list(modes)[:4], start=1)),
        sources=tuple(dict.fromkeys(frf.source)),
        collapsible_sections=(hits_section,) if hits else (),
        name="modes",
    )  # fmt: skip


def prediction_page(prediction: Prediction) -> KindPage:
    """Return the page of a prediction."""
    hz, height = prediction.peak
    load_text = (
        f"{format_with_error(prediction.mass, 'g', digits=4)} on "
        f"{format_count(int(prediction.seals), 'seal')}"
        if prediction.seals == int(prediction.seals)
        else format_with_error(prediction.mass, "g", digits=4)
    )
    peak: list[Row] = []
    bounds = prediction.limits
    for name, value, limits, unit in (
        ("Largest at" if prediction.is_peak_at_edge else "Peak frequency", hz,
         None if bounds is None else bounds.peak_frequency, "Hz"),
        ("Height", height, None if bounds is None else bounds.peak_height, ""),
    ):  # fmt: skip
        low, high = limits or (math.nan, math.nan)
        final_row = row(ReportedValue(name, value, low, high, unit))
        peak.append(
            final_row._replace(
                unit=final_row.unit or prediction.frf.read, is_limit=limits is not None
            )
        )
    return KindPage(
        subject=f"prediction of {load_text}",
        summary_line=(*format_specimen_header(prediction.fit.specimen), ("Mass", load_text),
               ("Valid band", hertz(prediction.fit.band)), ("Fit", prediction.fit._identity[:8])),
        indicators=make_indicators(prediction.checks, Topic("Test"),
                      Topic("Peak", _PEAK, f"{round_to_error(hz, digits=4)}{NBSP}Hz"),
                      Topic("Rest", {"compression_tested"}, "within the depth tested")),
        figure_title="Predicted response",
        picture=prediction.plot(),
        table_title=f"{load_text[:1].upper()}{load_text[1:]}",
        groups=(Group("Peak", tuple(peak)),
                *(Group(f"Mode {i}", tuple(mode_rows(mode)))
                  for i, mode in enumerate(prediction.modes[:3], start=1))),
        note=("Hatched: what the relaxation test does not exclude." if bounds is not None else
              "No bound is known without the record behind the fit.")
        if prediction.limits is not None or prediction.interval is None else KindPage.note,
        sources=tuple(dict.fromkeys(prediction.fit.source)),
        name="prediction",
    )  # fmt: skip


def agreement_page(agreement: FRFComparison) -> KindPage:
    """Return the page of a prediction compared with a hammer test."""
    comparison = agreement.comparison
    rows = tuple(Row(name, predicted, "", "", "", measured, is_limit=False)
                 for name, predicted, measured, _ in comparison.rows)  # fmt: skip
    difference_rows = tuple(
        (name, predicted, measured, difference)
        for name, predicted, measured, difference in comparison.rows
    )
    load_text = f"{format_with_error(agreement.mass, 'g', digits=4)} on {seals(agreement.seals)}"
    return KindPage(
        subject=f"prediction against the hammer, {load_text}",
        summary_line=(("Mass", load_text), ("Lines", str(len(comparison.measured.frequency))),
               ("Mass was", "found from the FRF" if agreement.mass_inferred else "given")),
        indicators=make_indicators(agreement.checks, Topic("FRF"),
                      Topic("Stiffness", {"stiffness_agrees"}, "agrees"),
                      Topic("Damping", {"peak_agrees", "damping_agrees"}, "agrees")),
        figure_title="Measured against predicted",
        picture=agreement.plot(),
        table_title="Predicted",
        groups=(Group("", tuple(row._replace(unit=row.measured, measured="") for row in rows)),),
        note="The last column is what the hammer measured.",
        sources=tuple(dict.fromkeys(comparison.measured.source)),
        collapsible_sections=(CollapsibleSection("How far apart", comparison.lines,
                    TextTable(("", "predicted", "measured", "difference"), difference_rows)),),
        name="comparison",
    )  # fmt: skip


# Page of a solid.


_DEFAULT_BAND = (0.1, 10.0)
"""Hz, of a model that has no valid band."""
_LINES, _BAND_FACTOR, _MAX_BOUNDED_TESTS = 41, 4.0, 3
"""Lines of a bound, how far beyond the band it is drawn, and of how many tests at most."""

_FEW_ARMS = 6
"""Largest number of arms that are listed; more stand in a fold."""

STIFFNESS_CHECKS = frozenset({
    "k_end_determined", "k_inf_positive", "k_inf_plausible", "plateau_determined",
    "curve_level_at_end",
    "strain_small", "hold_long_enough", "tangent_determined", "vertical_shift_plausible",
    "flow_distinguished",
    "creep_finished", "machine_deflection_small",
})  # fmt: skip
LOSS_CHECKS = frozenset({
    "fast_arm_visible", "valid_band_exists", "loss_positive", "kramers_kronig", "arms_distinct",
    "arms_supported", "tau_inside_window", "arms_where_force_relaxes", "arms_identified",
    "dashpot_not_missed", "few_arms_sufficient",
})  # fmt: skip


class TemperaturePart(NamedTuple):
    """Part of the page of a solid on its temperature dependence.

    Attributes
    ----------
    subject : str
        The fitted material, if any.
    topics, summary_line, groups, collapsible_sections
        As in :class:`~dashpot.report.result_page.KindPage`.
    """

    subject: str
    topics: Sequence[Topic]
    summary_line: Sequence[tuple[str, str]]
    groups: Sequence[Group]
    collapsible_sections: Sequence[CollapsibleSection]


def _make_part(fit: Fit) -> TemperaturePart | None:
    make_part = None if fit.temperatures is None else find_handler("part page", fit.temperatures)
    return None if make_part is None else cast("TemperaturePart", make_part(fit))


def solid_page(fit: Fit) -> KindPage:
    """Return the page of a fitted solid."""
    return _make_solid_page(fit, fit)


def identified_page(result: IdentificationResult) -> KindPage:
    """Return the page of a joint or hammer fit."""
    page = _make_solid_page(result, result.fit)
    has_both_tests = "relaxation" in result.fit.method or len(page.sources) > 1
    modes = Group(
        "Measured", tuple(r for mode in result.vibration.modes for r in mode_rows(mode.mode))
    ) if result.vibration else None  # fmt: skip
    return replace(
        page,
        subject="joint model of relaxation and hammer test"
        if has_both_tests
        else "the model under a hammer",
        groups=(*page.groups, *((modes,) if modes else ())),
        sources=tuple(dict.fromkeys((*page.sources, *result.direct.stiffness.source)))
        if hasattr(result.direct.stiffness, "source") else page.sources,
        name="joint" if has_both_tests else "fit",
    )  # fmt: skip


def _make_solid_page(result: Fit | IdentificationResult, fit: Fit) -> KindPage:
    """Return a page of a solid: stiffness and loss over frequency, its arms one by one."""
    is_material, part = fit.unit == "Pa", _make_part(fit)
    name = "The material" if is_material else "One seal"
    high = round_to_error(fit.band[1], digits=2)
    at_end = fit.evidence.end_of_hold
    stiffness = at_end.fact(fit.model, fit.unit) if at_end else next(iter(fit.facts), None)
    stiffness_text = "" if stiffness is None else f"{stiffness.cells.value} {stiffness.word}"
    topics = [Topic("Stiffness", STIFFNESS_CHECKS, stiffness_text),
             Topic("Damping", LOSS_CHECKS, f"known to {high}{NBSP}Hz")]  # fmt: skip
    if part is not None:
        topics = [
            *part.topics,
            Topic("Arms", LOSS_CHECKS | STIFFNESS_CHECKS, format_count(fit.model.arms, "arm")),
        ]
    summary_line = [
        *format_specimen_header(fit.specimen),
        *_make_condition_cells(fit),
        *(part.summary_line if part is not None else ()),
        ("Valid band", hertz(fit.band)),
        ("Fit", fit._identity[:8]),
    ]
    return KindPage(
        subject=part.subject if part is not None and is_material else _format_test_name(fit),
        summary_line=tuple(summary_line),
        indicators=make_indicators(result.checks, Topic("Test"), *topics),
        figure_title=f"What {name.lower()} does at each frequency",
        picture=over_frequency(fit),
        table_title=f"{name}, {_format_model_name(fit)}",
        groups=tuple(make_solid_groups(fit)),
        note="From and to are the 95 % interval; at the end of the test and at rest they are the "
        "bound that it leaves."
        if at_end
        else KindPage.note,
        sources=tuple(dict.fromkeys(fit.source)),
        collapsible_sections=(
            *_make_solid_sections(fit),
            *(part.collapsible_sections if part is not None else ()),
        ),
        name="fit",
    )


def over_frequency(fit: Fit, records: Sequence[Any] = ()) -> plot.Picture:
    """Return figures of storage and loss factor over frequency, with their bounds.

    Parameters
    ----------
    fit : Fit
    records : sequence
        Records behind it: the bounds over all spectra of ramps and holds are drawn, too.
    """
    low, high = fit.band if fit.band[1] > 0 else _DEFAULT_BAND
    lines = np.geomspace(max(low, 1e-9) / _BAND_FACTOR, high * (_BAND_FACTOR * 10), _LINES)
    ramp_holds = [record for record in records if isinstance(record, RampHold)]
    bounds = None
    if ramp_holds and len(ramp_holds) == len(records) <= _MAX_BOUNDED_TESTS:
        bounds = unresolved_arm_band(fit, ramp_holds, lines)
    stiffness_bounds = parameter_band(fit, lines) if fit.estimate.parameters else None
    picture = plot.stiffness(fit, parameters=stiffness_bounds, unresolved_bounds=bounds)
    (storage,), _, (loss,) = picture.strips
    axis_limits = (float(lines[0]), float(lines[-1]))
    valid = (Span(low, high, "fit", "valid band", tint=0.06),) if fit.band[1] > 0 else ()
    stacked = tuple(
        replace(panel, x=replace(panel.x, limits=axis_limits), height=height,
                marks=(*valid, *panel.marks))
        for panel, height in ((storage, 150.0), (loss, 170.0))
    )  # fmt: skip
    return replace(picture, strips=(stacked,), columns=1, width=LEAD_WIDTH)


def _format_test_name(fit: Fit) -> str:
    test_name = {"dynamic": "dynamic sweep", "creep": "creep test"}.get(
        fit.method, "relaxation test"
    )
    test_count = len(fit.source)
    return test_name if test_count < 2 else f"{test_count} files, {test_name}s"


def _format_model_name(fit: Fit) -> str:
    return "fractional model" if fit.family == "fractional" else format_count(fit.model.arms, "arm")


def _make_condition_cells(fit: Fit) -> Iterator[tuple[str, str]]:
    """Facts of a fit beside its specimen: the hold."""
    if fit.evidence.end_of_hold is not None and not fit.evidence.end_of_hold.is_frequency:
        yield "Held", duration(fit.evidence.end_of_hold.end_time)


def make_solid_groups(fit: Fit) -> Iterator[Group]:
    """Stiffness at the end and at rest, stiffness and loss within the band, arms, shifts."""
    reported_values = {
        reported_value.name: reported_value for reported_value in list_model_values(fit)
    }
    stiffness_rows: list[Row] = []
    if fit.evidence.end_of_hold is not None:
        reported_value = fit.evidence.end_of_hold.fact(fit.model, fit.unit)
        seconds = duration(fit.evidence.end_of_hold.end_time).replace(".0 ", NBSP)
        stiffness_rows.append(
            row(reported_value, f"After {seconds}")
            if fit.estimate.residual.unit == "N"
            else row(reported_value)
        )
        reported_values.pop(reported_value.name, None)
    if "k_inf" in reported_values:
        equilibrium = reported_values.pop("k_inf")
        stiffness_rows.append(
            row(equilibrium, "Below the band" if equilibrium.words else "At rest, k∞")
        )
    yield Group("Stiffness" if fit.unit != "Pa" else "Modulus", tuple(stiffness_rows))
    yield Group("Inside the valid band", tuple(_make_band_rows(fit)))
    other_values = [
        reported_value
        for name, reported_value in reported_values.items()
        if not name.startswith("b_")
    ]
    if fit.model.arms <= _FEW_ARMS or fit.family == "fractional":
        yield group("Arms: k, τ", other_values) if other_values else Group("", ())
    elif not fit.estimate.parameters:
        yield group("Spectrum", other_values)
    part = _make_part(fit)
    if part is not None:
        yield from part.groups


def _make_band_rows(fit: Fit) -> Iterator[Row]:
    """Return storage and loss factor at the middle of the band, with their errors."""
    low, high = fit.band
    if not (0 < low < high):
        return
    frequency = float(f"{math.sqrt(low * high):.1g}")
    band = parameter_band(fit, [frequency]) if fit.estimate.parameters else None
    symbol = "E" if fit.unit == "Pa" else "K"
    for label, name, unit in (
        (f"{symbol}′", "storage", fit.unit),
        ("Loss factor", "loss_factor", ""),
    ):
        value = float(getattr(fit.solid, name)(frequency=frequency))
        lower, upper = (math.nan,) * 2 if band is None else getattr(band, name)[:, 0].tolist()
        yield row(ReportedValue(f"{label} at {frequency:g}{NBSP}Hz", value, lower, upper, unit))


def _make_solid_sections(fit: Fit) -> Iterator[CollapsibleSection]:
    if fit.estimate.parameters:
        in_newtons = fit.estimate.residual.unit == "N"
        residual = round_to_error(fit.estimate.residual.rms * (1e3 if in_newtons else 1), digits=3)
        yield CollapsibleSection(
            "Every parameter",
            f"{_format_model_name(fit)}, each with its standard error; residual "
            f"{residual} {'mN' if in_newtons else fit.estimate.residual.unit}",
            _fact_table(list_model_values(fit)),
        )
    else:
        arms = tuple(
            (str(j), round_to_error(convert_to_unit(k, get_display_unit(fit.unit))), f"{tau:.4g}")
            for j, (k, tau) in enumerate(zip(fit.model.k, fit.model.tau, strict=True), start=1)
        )
        header = ("arm", f"k, {get_display_unit(fit.unit)}", "τ, s")
        yield CollapsibleSection(
            "Every arm", "none has a meaning of its own: use the table", TextTable(header, arms)
        )


def _fact_table(reported_values: Sequence[ReportedValue]) -> TextTable:
    rows = tuple(
        (reported_value.symbol, *reported_value.cells[1:]) for reported_value in reported_values
    )
    return TextTable(("", "value", "± SE", "95 % interval", "unit"), rows)
