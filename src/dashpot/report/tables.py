"""Tables of the report: cells as text in display units."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import GRADES, Check
from dashpot.base.errors import DashpotError
from dashpot.base.number_format import (
    decibels,
    duration,
    format_cell,
    format_signed_difference,
    format_typographic,
    percent,
    round_to_error,
    split_identifier,
)
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.bounds import StiffnessBounds
from dashpot.datamodel.fit import (
    Fit,
    get_fitted_mass,
    get_hammer_stiffness_factor,
    list_model_values,
    list_reported_nuisances,
)
from dashpot.datamodel.fit_diagnostics import ParameterChange
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.mass_on_seals import MassOnSeals, model_modes, operating_point
from dashpot.workflow.assumptions import ASSUMPTIONS
from dashpot.workflow.stiffness_under_mass import replace_by_alternative
from dashpot.workflow.study import Study

STATES = {True: "passed", None: "not applicable"}
FAILURES = {
    "stop": "failed: do not use",
    "limit": "failed: use with care",
    "note": "failed: a note",
}
CORRECTED_FAILURE = "failed: corrected by the joint model"
VALUE = ("", "value ± standard error", "unit")


@dataclass(frozen=True)
class TextTable:
    """Table as text; `marks` names a style for a row: "good", "bad", "doubt" or ""."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    marks: tuple[str, ...] = ()

    def mark(self, row: int) -> str:
        """Return the style of a row."""
        return self.marks[row] if row < len(self.marks) else ""


def select_rows(count: int, max_rows: int) -> range:
    """Return the indices of evenly spaced rows of `count`, at most `max_rows` of them.

    >>> select_rows(100, 60), select_rows(60, 60)
    (range(0, 100, 2), range(0, 60))
    """
    return range(0, count, max(-(-count // max_rows), 1))


def describe_rows(indices: range, plural: str) -> str:
    """Return how many rows there are, and which part of them a table shows.

    >>> describe_rows(range(0, 100, 2), "lines"), describe_rows(range(60), "lines")
    ('one of 2 of 100 lines', '60 lines')
    """
    count, step = indices.stop, indices.step
    return f"{count} {plural}" if step == 1 else f"one of {step} of {count} {plural}"


def assumptions(study: Study) -> TextTable:
    """Return the assumptions of the results, their checks in this study, and what lifts them."""
    checks = (*study.prepared.checks, *study.every_check)
    pairs = [(assumption, assumption.state(checks)) for assumption in ASSUMPTIONS]
    rows = tuple(
        (
            assumption.name,
            assumption.holds,
            state,
            ", ".join(assumption.options) or "–",
            assumption.advice,
        )
        for assumption, state in pairs
    )
    header = (
        "assumed",
        "what that means",
        "in this study",
        "option that makes it unnecessary",
        "on the bench",
    )
    return TextTable(
        header, rows, tuple("bad" if state == "contradicted" else "" for _, state in pairs)
    )


def checks(
    groups: Sequence[tuple[str, Sequence[Check]]], verdict_checks: Collection[Check]
) -> TextTable:
    """Return every check in words, failed ones first; a sentence that two stages share stands once.

    A check that does not count in the verdict, such as one that the joint fit resolves, is marked.
    """
    distinct: dict[tuple[str, str], tuple[str, Check]] = {}
    for stage, checks in groups:
        for check in checks:
            distinct.setdefault((check.name, check.message), (stage, check))
    ordered = sorted(distinct.values(), key=lambda pair: _get_check_order(pair[1], verdict_checks))
    rows = tuple(
        (
            _state(check, verdict_checks),
            stage,
            split_identifier(check.name),
            format_typographic(check.message_with_remedy),
        )
        for stage, check in ordered
    )
    row_classes = tuple(_mark(check, verdict_checks) for _, check in ordered)
    return TextTable(("", "stage", "question", "answer"), rows, row_classes)


def _get_check_order(check: Check, verdict_checks: Collection[Check]) -> int:
    """Order of a check: failed by grade, corrected, then not checked, then passed."""
    if check.failed:
        return -GRADES.index(check.grade) if check in verdict_checks else 1
    return 3 if check.passed else 2


def _state(check: Check, verdict_checks: Collection[Check]) -> str:
    if check.failed:
        return FAILURES[check.grade] if check in verdict_checks else CORRECTED_FAILURE
    return STATES[check.passed]


def _mark(check: Check, verdict_checks: Collection[Check]) -> str:
    if check.failed and check in verdict_checks:
        return {"stop": "bad", "limit": "care", "note": "doubt"}[check.grade]
    return "good" if check.passed else "doubt"


# -- the relaxation test and its fits -------------------------------------------------------------


def test_facts(prepared: RampHold) -> TextTable:
    """Return the facts of the test."""
    steps = np.diff(prepared.time)
    rate = 1 / float(np.median(steps))
    is_even = float(np.ptp(steps)) < 0.01 / rate
    specimen = prepared.specimen
    rows = [
        ("compression", format_cell(prepared.depth, "mm", digits=4), "mm"),
        ("ramp", round_to_error(prepared.ramp_time), "s"),
        ("speed", format_cell(prepared.depth / prepared.ramp_time, "mm/s"), "mm/s"),
        ("hold", round_to_error(prepared.hold_time), "s"),
        ("samples", f"{len(prepared.time)}", ""),
        ("sampling" if is_even else "sampling, uneven, median", round_to_error(rate), "Hz"),
        (
            "force noise (standard deviation)",
            format_cell(prepared.force_noise, "mN", digits=2),
            "mN",
        ),
    ]
    if prepared.preload:
        rows.append(("preload at the first sample", round_to_error(prepared.preload), "N"))
    if specimen.length:
        rows.append(("length under the plate", format_cell(specimen.length, "mm", digits=4), "mm"))
    if specimen.height:
        strain = prepared.depth / specimen.height
        rows.append(("free height", format_cell(specimen.height, "mm", digits=4), "mm"))
        rows.append(("compression / height", format_cell(strain, "%", digits=2), "%"))
    if specimen.temperature:
        rows.append(("temperature", f"{convert_to_unit(specimen.temperature, 'degC'):.1f}", "°C"))
    return TextTable(("", "value", "unit"), tuple(rows))


def coefficients(fit: Fit | None, length: float | None) -> TextTable | None:
    """Table 1 of the paper, with intervals, and per 100 mm of seal if the length is known."""
    if fit is None:
        return None
    rows = []
    for quantity in list_model_values(fit):
        cells = quantity.cells
        row = (quantity.symbol, cells.with_error, cells.interval, cells.unit)
        scaled = ""
        if length is not None and quantity.unit not in ("s", ""):
            scale = 0.1 / length
            value = round_to_error(
                quantity.to_display_unit(quantity.value) * scale, quantity.size * scale
            )
            scaled = f"{value} {cells.unit}"
        rows.append(row if length is None else (*row, scaled))
    header = ("", "value ± standard error", "95 % interval", "unit", "per 100 mm")
    return TextTable(header if length is not None else header[:-1], tuple(rows))


def orders(study: Study) -> TextTable:
    """Solids with one, two and more arms in columns."""
    fit = study.fit
    best = min((order.bic for order in fit.evidence.orders), default=math.nan)
    scores = {
        order.arms: (
            round_to_error(order.bic - best, digits=4),
            "yes" if order.significant else "no",
        )
        for order in fit.evidence.orders
    }
    models_by_arms = {
        order.arms: (order.model, math.sqrt(order.sse / fit.estimate.residual.n))
        for order in fit.evidence.orders
    }
    chosen_fits = (fit,) if fit.family == "maxwell" else ()
    models_by_arms |= {
        alternative.model.arms: (alternative.model, alternative.estimate.residual.rms)
        for alternative in (*study.alternatives, *chosen_fits)
    }
    rows, row_classes = [], []
    for arms in sorted(models_by_arms):
        model, rms = models_by_arms[arms]
        is_chosen = arms == fit.model.arms and bool(chosen_fits)
        arms_text = ", ".join(
            f"{format_cell(k, 'N/mm')} at {round_to_error(tau)} s"
            for k, tau in zip(model.k, model.tau, strict=True)
        )
        rows.append((
            f"{arms}{' (chosen)' * is_chosen}",
            format_cell(model.k_inf, "N/mm", digits=4),
            arms_text or "none",
            format_cell(rms, "mN"),
            *scores.get(arms, ("", "")),
        ))  # fmt: skip
        row_classes.append("chosen" * is_chosen)
    header = ("arms N", "k∞, N/mm", "arms: k, N/mm at τ", "residual rms, mN", "BIC − best",
            "every arm significant")  # fmt: skip
    # a ramp that no linear solid follows is fitted hold first, and its orders are not compared
    columns = len(header) if scores else 4
    return TextTable(header[:columns], tuple(row[:columns] for row in rows), tuple(row_classes))


def two_routes(study: Study) -> TextTable | None:
    """The full history against the paper's eq. (5) on the hold; None if their arms differ."""
    fit, hold = study.fit, study.hold_fit
    if hold is None or fit.model.arms != hold.model.arms:
        return None
    values_of_hold = {
        reported_value.name: reported_value for reported_value in list_model_values(hold)
    }
    rows = tuple(
        (
            f"{reported_value.symbol}, {reported_value.word}",
            reported_value.cells.with_error,
            values_of_hold[reported_value.name].cells.with_error,
            percent(values_of_hold[reported_value.name].value / reported_value.value - 1),
        )
        for reported_value in list_model_values(fit)
        if reported_value.name in values_of_hold
        and reported_value.error is not None
        and reported_value.value
        and reported_value.name[0] != "b"
    )
    return TextTable(("", "full history", "hold only, eq. (5)", "difference"), rows)


def nuisances(fit: Fit | None) -> TextTable | None:
    """Return the table of nuisance parameters."""
    if fit is None or not list_reported_nuisances(fit):
        return None
    reported_values = (term.fact for term in list_reported_nuisances(fit))
    rows = tuple(
        (reported_value.symbol, reported_value.cells.with_error, reported_value.word or "–")
        for reported_value in reported_values
    )
    return TextTable(VALUE, rows)


def make_frequency_table(study: Study) -> TextTable:
    """Stiffness and loss factor of one seal at some frequencies, and whether they are known."""
    (low, high), bounds = study.fit.band, study.unmeasured
    marked_frequencies = () if study.comparison is None else (study.comparison.measured_hz,)
    rows, row_classes = [], []
    for f in sorted({low, float(np.sqrt(low * high)), high, 1.0, 50.0, *marked_frequencies}):
        stiffness = complex(study.fit.solid.complex_stiffness(omega=2 * np.pi * f))
        factor = max(f / high, low / f)
        is_identified = factor < 1.0001
        cells = [
            round_to_error(f),
            format_cell(stiffness.real, "N/mm"),
            format_cell(stiffness.imag, "N/mm"),
            round_to_error(stiffness.imag / stiffness.real),
        ]
        if bounds is not None:
            cells.append(_format_limits_at(bounds, convert_to_unit(bounds.storage, "N/mm"), f))
            cells.append(_format_limits_at(bounds, bounds.loss_factor, f))
        cells.append(
            "identified" if is_identified else f"extrapolated ×{round_to_error(factor, digits=2)}"
        )
        rows.append(tuple(cells))
        row_classes.append("" if is_identified else "doubt")
    header = ["frequency, Hz", "storage K′, N/mm", "loss K″, N/mm", "loss factor"]
    if bounds is not None:
        header += ["limits of K′, N/mm", "limits of loss factor"]
    return TextTable((*header, "this test"), tuple(rows), tuple(row_classes))


def _format_limits_at(bounds: StiffnessBounds, limits: FloatArray, f: float) -> str:
    if not bounds.frequency[0] <= f <= bounds.frequency[-1]:
        return "not computed"
    low, high = (float(np.interp(np.log(f), np.log(bounds.frequency), edge)) for edge in limits)
    return f"{round_to_error(low, digits=3)} to {round_to_error(high, digits=3)}"


# -- the hammer test ------------------------------------------------------------------------------


def peaks(study: Study) -> TextTable | None:
    """Predicted, measured and joint: frequency, height and damping of the peak."""
    c, joint = study.comparison, study.joint_comparison
    if c is None:
        return None
    header = ["", "measured", "predicted", "difference"]
    columns = [
        (
            "peak frequency, Hz",
            "peak accelerance, 1/kg",
            "damping ratio, %",
            "FRF correlation, FRAC (1: identical)",
            "rms difference, dB",
        ),
        (
            ReportedValue.from_error(
                "", c.measured_hz, c.measured_hz_se or None, unit="Hz"
            ).cells.with_error,
            round_to_error(c.measured_peak),
            _measured_damping(c),
            "",
            "",
        ),
        *_make_prediction_columns(c),
    ]
    if joint is not None:
        header += ["joint model", "difference"]
        columns += _make_prediction_columns(joint)
    return TextTable(tuple(header), tuple(zip(*columns, strict=True)))


def _make_prediction_columns(c: Comparison) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the prediction of a solid for each row of the table of peaks, and its deviation."""
    damping = "none" if c.predicted_damping is None else round_to_error(100 * c.predicted_damping)
    damping_text = "" if c.damping_ratio_error is None else percent(c.damping_ratio_error)
    return (
        (
            round_to_error(c.predicted_hz, digits=4),
            round_to_error(c.predicted_peak),
            damping,
            round_to_error(c.frac),
            round_to_error(c.rms_db),
        ),
        (percent(c.frequency_error), decibels(c.ratio_db), damping_text, "", ""),
    )


def _measured_damping(c: Comparison) -> str:
    if c.measured_damping is None:
        return "not supported by the record"
    se = c.measured_damping_se or None
    return ReportedValue.from_error(
        "damping ratio", c.measured_damping, se, unit="1", read="%"
    ).cells.with_error


def resonance(study: Study) -> TextTable | None:
    """Natural frequency and damping of the resonance, read in every way the record supports."""
    c, measured = study.comparison, study.measured
    if c is None or measured is None or study.mass is None:
        return None
    methods = {
        "rational": "rational-fraction fit of the poles",
        "circle": "circle fit",
        "half-power": "half-power width",
        "decrement": "logarithmic decrement",
        "peak": "peak picking",
    }
    rows = [
        (f"measured: {message}", *_mode_cells(measured, method, c))
        for method, message in methods.items()
    ]
    rest = study.static_equilibrium
    compression = rest.point.compression if rest is not None and rest.point.is_stated else None
    for message, fit, mass in _solids(study, study.mass):
        point = operating_point(fit, MassOnSeals(mass, study.seals, compression))
        seals_solid = study.seals * get_hammer_stiffness_factor(fit) * point.solid(fit)
        for mode in model_modes(seals_solid, mass)[:1]:
            rows.append((f"{message}: exact pole", round_to_error(mode.frequency, digits=5),
                         round_to_error(100 * mode.damping_ratio)))  # fmt: skip
    return TextTable(("", "natural frequency, Hz", "damping ratio, %"), tuple(rows))


def _solids(study: Study, mass: float) -> Iterator[tuple[str, Fit, float]]:
    """Return the models by the test that they are from, and the mass on each."""
    yield "model from relaxation", study.fit, mass
    other = replace_by_alternative(study.fit)
    if other is not None:
        yield "other family from relaxation", other, mass
    if study.joint is not None:
        yield "joint model", study.joint, get_fitted_mass(study.joint) or mass


def _mode_cells(measured: FRF, method: str, c: Comparison) -> tuple[str, str]:
    try:
        modes = measured.modes(method=method, band=c.band)
    except DashpotError as refused:
        return "refused", format_typographic(str(refused))
    if not modes:
        return "none found", ""
    # rocking and other modes beside it are not what the prediction is of
    mode = min(modes, key=lambda mode: abs(mode.frequency - c.measured_hz))
    frequency, ratio, _ = (reported_value.cells.with_error for reported_value in mode.facts)
    return frequency, ratio


def arms_tested(comparison: Comparison | None) -> TextTable | None:
    """Return which arms carried the loss at the measured peak, and which the test resolved."""
    if comparison is None or not comparison.arms:
        return None
    rows, row_classes = [], []
    for arm in comparison.arms:
        tested, resolved = arm.loss_share > 0.1, arm.seen_by_relaxation
        share = f"{100 * arm.loss_share:.1f}"
        cells = ("yes" if tested else "hardly", "yes" if resolved else "no")
        rows.append((duration(arm.tau), share, *cells))
        row_classes.append("bad" if tested and not resolved else "")
    header = ("τ of the arm", "share of the loss at the peak, %", "tested by this FRF",
            "resolved by the relaxation test")  # fmt: skip
    return TextTable(header, tuple(rows), tuple(row_classes))


def hits(frf: FRF | None) -> TextTable | None:
    """Return every hit and the verdict on it, with the reasons if there are any."""
    if frf is None or not frf.hits:
        return None
    columns = 6 if any(hit.reasons for hit in frf.hits) else 5
    header = ("hit", "time, s", "peak, N", "pulse width, ms", "verdict", "why")
    rows = tuple(
        (
            hit.name,
            round_to_error(hit.time, digits=4),
            round_to_error(hit.peak),
            format_cell(hit.duration, "ms"),
            "accepted" if hit.accepted else "rejected",
            "; ".join(hit.reasons),
        )[:columns]
        for hit in frf.hits
    )
    return TextTable(
        header[:columns], rows, tuple("" if hit.accepted else "bad" for hit in frf.hits)
    )


def explanations(joint: Fit | None) -> TextTable | None:
    """Return the explanations of two tests that disagree, or None if they agree."""
    if joint is None or not joint.evidence.explanations:
        return None
    rows = tuple(
        (
            format_typographic(explanation.message),
            round_to_error(explanation.deviance_fall, digits=4),
            "yes" if explanation.is_sufficient else "no",
        )
        for explanation in joint.evidence.explanations
    )
    return TextTable(("if", "chi-square falls by", "is sufficient"), rows)


def make_change_table(joint: Fit | None) -> TextTable | None:
    """Return the table of the solid's changes by the hammer test."""
    if joint is None or not joint.evidence.parameter_changes:
        return None
    rows = tuple(_make_change_row(change) for change in joint.evidence.parameter_changes)
    row_classes = tuple("doubt" if row[-1] == "new" else "" for row in rows)
    header = (
        "",
        "relaxation alone, ± SE of noise",
        "joint model, ± SE of noise",
        "change",
        "in SE of relaxation alone",
    )
    return TextTable(header, rows, row_classes)


def _make_change_row(m: ParameterChange) -> tuple[str, ...]:
    before, value_after = m.was, m.now
    name, after_text = (
        ", ".join(filter(None, (value_after.symbol, value_after.word))),
        value_after.cells.with_limit,
    )
    if before is None:
        return name, "", after_text, "", "new"
    change = percent(value_after.value / before.value - 1) if before.value else ""
    return (name, before.cells.with_limit, after_text, change, format_signed_difference(m.shift))
