"""First screen of the report: specimen, three lights, sentences and files."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import number_format
from dashpot.base.checks import GRADES, Check
from dashpot.base.number_format import (
    decibels,
    duration,
    format_band,
    format_count,
    format_typographic,
    format_with_error,
    hertz,
    percent,
    round_to_error,
)
from dashpot.base.provenance import Source
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.fit import Fit, get_hammer_stiffness_factor, get_model_label
from dashpot.datamodel.frf import FRF
from dashpot.report import page_frame
from dashpot.report.page_frame import AttachedDeck, Attachment, attachment
from dashpot.solids.fractional import FractionalZener
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.modal.dynamic_stiffness import STORAGE_LIMIT, DynamicStiffness
from dashpot.workflow.json_archive import to_json
from dashpot.workflow.recommended_solid import Recommendation, RecommendedValue
from dashpot.workflow.study import Study

# Header, lights, values and files.


NOT_GIVEN, NBSP = "not given", "\N{NO-BREAK SPACE}"

GRADE_MARKS = {"stop": "bad", "limit": "care", "note": "note"}
"""Class of a failed check by its grade."""

MARK_ORDER = ("good", "note", "care", "bad")


class Indicator(NamedTuple):
    """One of the three indicators of the first screen: its mark and a short text."""

    name: str
    mark: str
    message: str


class Row(NamedTuple):
    """Row of the first table as cells; `is_limit` adds the hatched mark."""

    name: str
    value: str
    low: str
    high: str
    unit: str
    measured: str
    is_limit: bool


def make_header(study: Study) -> tuple[tuple[str, str], ...]:
    """Return the header: specimen, files, operator, date and conditions."""
    specimen = study.prepared.specimen
    length = "" if specimen.length is None else f"{format_with_error(specimen.length, 'mm')} long"
    specimen_text = ", ".join(part for part in (specimen.name, length) if part)
    kelvin = specimen.temperature
    mass = "" if study.mass is None else format_with_error(study.mass, "g", digits=4)
    inferred = " (found from the FRF)" if study.mass_inferred else ""
    rows = (
        ("Specimen", specimen_text),
        ("Lot", specimen.lot),
        ("Operator", specimen.operator),
        ("Date", specimen.date),
        ("Temperature", "" if kelvin is None else format_quantity(kelvin, "°C", ".1f")),
        ("Mass", mass + inferred),
        ("Seals", "" if study.mass is None else f"{study.seals:g}"),
        ("Compression", format_with_error(study.prepared.depth, "mm")),
    )
    return tuple((name, value or NOT_GIVEN) for name, value in rows)


# -- marks ----------------------------------------------------------------------------------------


def get_gravest_mark(checks: Iterable[Check]) -> str:
    """Return the mark of the gravest check that failed: bad, care, note; good if none did."""
    grade_marks = [GRADE_MARKS[check.grade] for check in checks if check.failed]
    return max(grade_marks, key=MARK_ORDER.index, default="good")


def count_passed(checks: Iterable[Check], verdict_checks: Collection[Check]) -> tuple[str, str]:
    """Return the mark of some checks, and how many of the judged ones passed.

    What the verdict does not weigh, for the joint fit has mended it, is a note.
    """
    checks_with_result = [check for check in checks if check.passed is not None]
    if not checks_with_result:
        return "note", "not applicable"
    failed = [check for check in checks_with_result if check.failed]
    notes = sum(check.grade == "note" for check in failed)
    text = f"{len(checks_with_result) - len(failed)} of {len(checks_with_result)}"
    if notes and notes == len(failed):
        text += f", {format_count(notes, 'note')}"
    class_name = get_gravest_mark(check for check in checks_with_result if check in verdict_checks)
    return ("note" if failed and class_name == "good" else class_name), text


def make_study_indicators(
    study: Study, recommendation: Recommendation
) -> tuple[Indicator, Indicator, Indicator]:
    """Return the lights of the test, and of stiffness and damping against the hammer.

    Values of the joint model if it is recommended, else of the relaxation test alone: a failed
    joint fit agrees with the hammer for the wrong reason.
    """
    hammer = () if study.measured is None else study.measured.checks
    test = make_test_light((*study.fit.checks, *hammer))
    comparison = study.joint_comparison if recommendation.joint else study.comparison
    if comparison is None:
        untested = "no hammer test"
        return (
            test,
            Indicator("Stiffness", "note", untested),
            Indicator("Damping", "note", untested),
        )
    return (
        test,
        _make_stiffness_light(study, recommendation, comparison),
        _make_light(
            "Damping",
            comparison,
            {"peak_agrees", "damping_agrees"},
            f"{decibels(comparison.ratio_db)} at the peak",
        ),
    )


def _make_stiffness_light(
    study: Study, recommendation: Recommendation, comparison: Comparison
) -> Indicator:
    """Return the light of the stiffness, against the hammer (K' = m w^2 / n at its peak) and test.

    A joint fit peaks where the hammer does with any mass. So its stiffness is held against the
    limits of the relaxation test, and its disagreement with either test is heeded.
    """
    checks = [check for check in comparison.checks if check.name == "stiffness_agrees"]
    if recommendation.joint and study.joint is not None:
        checks += [check for check in study.joint.checks if check.name in _STIFFNESS_CHECKS]
    class_name = get_gravest_mark(checks)
    storage_comparison = _compare_storage_at_peak(study, recommendation)
    if storage_comparison is None:
        text = f"{percent(comparison.frequency_error)} in frequency"
    else:
        excess = max(storage_comparison.deviations, default=0.0)
        worst = "bad" if excess > 2 * STORAGE_LIMIT else "care" if excess > 0 else "good"
        class_name = max(class_name, worst, key=MARK_ORDER.index)
        model, hammer, *limit_texts = (
            round_to_error(convert_to_unit(value, "N/mm"), digits=3)
            for value in (
                storage_comparison.model,
                storage_comparison.hammer,
                *storage_comparison.test,
            )
        )
        other = (
            f"test {' to '.join(limit_texts)}"
            if max(storage_comparison.deviations[1:], default=0.0)
            else f"hammer {hammer}"
        )
        text = f"K\N{PRIME}{NBSP}{model}, {other}{NBSP}N/mm"
    return Indicator(
        "Stiffness", class_name, f"{'agrees' if class_name in _PASSED_MARKS else 'misses'}, {text}"
    )


_STIFFNESS_CHECKS = {"tests_agree", "stiffness_plausible", "mass_plausible"}
_PASSED_MARKS = {"good", "note"}


class _StorageAtPeak(NamedTuple):
    """K' of one seal under the hammer at its peak, N/m: of the model shown, and measured.

    `deviations` are the relative deviation of the two, and of the measurement from the limits of
    the relaxation test; 0 within the errors.
    """

    model: float
    hammer: float
    deviations: tuple[float, ...]
    test: tuple[float, ...] = ()


def _compare_storage_at_peak(study: Study, recommendation: Recommendation) -> _StorageAtPeak | None:
    """Return K' at the peak by model and hammer; None where the mass was inferred."""
    direct, comparison = study.direct, study.comparison
    if direct is None or comparison is None or study.mass_inferred or not len(direct.frequency):
        return None
    peak_line = int(np.argmin(np.abs(direct.frequency - comparison.measured_hz)))
    hertz, hammer = float(direct.frequency[peak_line]), float(direct.storage[peak_line])
    error = 2 * float(direct.storage_sd[peak_line])
    solid, point = recommendation.solid, recommendation.point
    factor = 1.0 if point is None else point.factor
    model = (
        get_hammer_stiffness_factor(solid) * factor * float(solid.solid.storage(frequency=hertz))
    )
    tolerance = STORAGE_LIMIT * abs(hammer)
    excesses = [
        _compute_excess(model, hammer - max(error, tolerance), hammer + max(error, tolerance))
    ]
    test: tuple[float, ...] = ()
    bounds = study.unmeasured
    if (
        recommendation.joint
        and bounds is not None
        and bounds.frequency[0] <= hertz <= bounds.frequency[-1]
    ):
        rest_factor = (
            1.0 if study.static_equilibrium is None else study.static_equilibrium.point.factor
        )
        test = low, high = tuple(
            rest_factor * float(np.interp(np.log(hertz), np.log(bounds.frequency), edge))
            for edge in bounds.storage
        )
        excesses.append(_compute_excess(hammer, low - error, high + error))
        excesses.append(_compute_excess(model, low - error, high + error))
    return _StorageAtPeak(model, hammer, tuple(excesses), test)


def _compute_excess(value: float, low: float, high: float) -> float:
    """Return the relative distance of a value from an interval; 0 inside."""
    return max(low - value, value - high, 0.0) / max(abs(low if value < low else high), 1e-300)


def make_test_light(checks: Iterable[Check]) -> Indicator:
    """Return the light of a test by its checks."""
    class_name = get_gravest_mark(checks)
    message = {"good": "valid", "note": "valid, with notes", "care": "limited", "bad": "not valid"}
    return Indicator("Test", class_name, message[class_name])


def _make_light(
    name: str, comparison: Comparison, check_names: set[str], difference: str
) -> Indicator:
    class_name = get_gravest_mark(check for check in comparison.checks if check.name in check_names)
    text = "agrees" if class_name in {"good", "note"} else "misses"
    return Indicator(name, class_name, f"{text}, {difference}")


# -- numbers --------------------------------------------------------------------------------------


def make_heading(recommendation: Recommendation) -> str:
    """Return the heading that names the recommended model, or says that there is none."""
    if not recommendation.recommended:
        return "No model is recommended"
    return f"Recommended: {source(recommendation)}, {get_model_label(recommendation.solid)}"


def source(recommendation: Recommendation) -> str:
    """Return the name of the model by the data that it was fitted to."""
    return "joint model" if recommendation.joint else "model of the relaxation test"


def solid_heading(recommendation: Recommendation) -> str:
    """Return the heading of the table of parameters."""
    if not recommendation.recommended:
        return "Model of the relaxation test, not recommended, one seal"
    return f"The recommended {source(recommendation)}, one seal"


def band_row(recommendation: Recommendation) -> Row:
    """Return the row of the valid band."""
    low, high = (round_to_error(end, digits=2) for end in recommendation.solid.band)
    return Row("Valid band", "", low, high, "Hz", "", is_limit=False)


def make_mass_rows(study: Study, recommendation: Recommendation) -> tuple[str, tuple[Row, ...]]:
    """Return the values of the mass on its seals; empty without a mass."""
    if study.mass is None or not recommendation.mass_values:
        return "", ()
    mass, seals = format_with_error(study.mass, "g", digits=4), study.seals
    text = f"{mass} on {number_format.seals(seals)}"
    if study.mass_inferred:
        text += ", the mass found from the FRF"
    elif not recommendation.recommended:
        text += ", as given"
    return text, rows(recommendation.mass_values)


def rows(values: Iterable[RecommendedValue]) -> tuple[Row, ...]:
    """Return rows of the table, with digits by the intervals."""
    return tuple(_format_row(value) for value in values)


def _format_row(value: RecommendedValue) -> Row:
    measured = "" if value.measured_fact is None else value.measured_fact.cells.value
    return Row(
        _format_name(value), *value.fact.cell_texts, value.fact.word, measured, value.is_limit
    )


def _format_name(value: RecommendedValue) -> str:
    frequency_text = "" if value.at is None else f"{round_to_error(value.at)}{NBSP}Hz"
    return {
        "frequency": "Peak frequency",
        "damping": "Damping ratio",
        "peak": "Peak height",
        "end of hold": f"Stiffness at end of hold, {_format_hold_time(value.at or 0.0)}",
        "dynamic stiffness": f"Dynamic stiffness, {frequency_text}",
        "loss factor": f"Loss factor, {frequency_text}",
    }[value.quantity]


def _format_hold_time(seconds: float) -> str:
    return duration(seconds).replace(".0 ", " ").replace(" ", NBSP)


# -- files ----------------------------------------------------------------------------------------


def files(
    study: Study, recommendation: Recommendation, made_decks: Sequence[AttachedDeck]
) -> tuple[Attachment, ...]:
    """Return the attached files, the recommended solid and its decks first."""
    fits = {"fit.json": (study.fit, "the fit of the relaxation test")}
    if study.joint is not None:
        fits["joint.json"] = (study.joint, "the joint model")
    name = "joint.json" if recommendation.joint else "fit.json"
    solid, description = fits.pop(name)
    label = "Download this model" if recommendation.recommended else "Download anyway"
    attached = [
        _attach_json(
            name,
            label,
            description if recommendation.recommended else f"DO NOT USE: {description}",
            solid,
        )
    ]
    attached += page_frame.attach_decks(made_decks, name)
    if study.comparison is not None:
        lines = _format_frf_csv(study.comparison, study.joint_comparison)
        description = "measured and predicted accelerance, line by line"
        attached.append(attachment("frf.csv", "frf.csv", description, "text/csv", lines))
    return (
        *attached,
        *(_attach_json(name, name, description, fit) for name, (fit, description) in fits.items()),
    )


def decks(recommendation: Recommendation) -> tuple[AttachedDeck, ...]:
    """Return decks of one seal; of a nonlinear elastic law with the tangent under the mass."""
    if not recommendation.recommended:
        return ()
    is_nonlinear = recommendation.point is not None and not recommendation.point.linear
    return page_frame.decks(
        recommendation.solid,
        recommendation.point.compression if recommendation.point and is_nonlinear else None,
    )


def format_deck_note(recommendation: Recommendation, made_decks: Sequence[AttachedDeck]) -> str:
    """Return the sentence on the band of the decks and missing specimen data."""
    return (
        page_frame.format_deck_note(recommendation.solid, made_decks)
        if recommendation.recommended
        else ""
    )


def _attach_json(name: str, label: str, description: str, result: object) -> Attachment:
    description += ", SI units, full precision"
    return attachment(name, label, description, "application/json", to_json(result))


def _format_frf_csv(c: Comparison, joint: Comparison | None) -> str:
    curves = {"measured": c.measured, "predicted": c.predicted}
    if joint is not None and len(joint.predicted.frequency) == len(c.measured.frequency):
        curves["joint"] = joint.predicted
    columns = {"frequency [Hz]": c.measured.frequency}
    for name, frf in curves.items():
        columns[f"{name} real [(m/s^2)/N]"] = frf.value.real
        columns[f"{name} imaginary [(m/s^2)/N]"] = frf.value.imag
    if c.measured.coherence is not None:
        columns["coherence [1]"] = c.measured.coherence
    rows = (",".join(f"{v:.7g}" for v in row) for row in zip(*columns.values(), strict=True))
    return "\n".join((",".join(columns), *rows, ""))


# Sentences at the top of the report.


def title(study: Study) -> str:
    """Return the title of the report: as stated, or the specimen and its lot, or the file."""
    if study.title:
        return study.title
    specimen = study.prepared.specimen
    if specimen.name:
        return specimen.name + (f", lot {specimen.lot}" if specimen.lot else "")
    source = study.test.source or study.prepared.source
    return source.file if source is not None else "relaxation test"


def sentences(study: Study, recommendation: Recommendation) -> tuple[str, ...]:
    """Return the sentences below the verdict, one statement each."""
    return tuple(
        format_typographic(sentence)
        for sentence in (
            _describe_model(recommendation),
            _describe_end_of_hold(recommendation),
            _describe_equilibrium(study),
            _describe_hammer(study),
            _describe_joint_model(study),
        )
        if sentence
    )


def _describe_model(recommendation: Recommendation) -> str:
    fit = recommendation.solid
    arms = format_count(fit.model.arms, "Maxwell arm")
    if isinstance(fit.solid, FractionalZener):
        arms = f"a springpot of slope {round_to_error(fit.solid.alpha)} beside it"
    return (
        f"One seal behaves as a spring of {_format_k_inf(fit)}, with {arms}. Its "
        f"instantaneous stiffness is {format_with_error(fit.model.k_0, 'N/mm')}. The valid band "
        f"of the {source(recommendation)} is {hertz(fit.band)}."
    )


def _format_k_inf(fit: Fit) -> str:
    """Return k_inf with its upper limit, as text."""
    cells = next(
        reported_value for reported_value in fit.facts if reported_value.name == "k_inf"
    ).cells
    return ", ".join(filter(None, (cells.with_unit, cells.interval)))


def _describe_end_of_hold(recommendation: Recommendation) -> str:
    """Return the gain by stating the machine, if it is large, as a sentence."""
    end = recommendation.solid.evidence.end_of_hold
    return "" if end is None else end.naming


def _describe_equilibrium(study: Study) -> str:
    """Return the sentence on the static equilibrium, if it changes the stiffness."""
    equilibrium = study.static_equilibrium
    if equilibrium is None or equilibrium.point.linear:
        return ""
    tangent, secant, depth = equilibrium.tangent, equilibrium.secant, equilibrium.point.depth or 0.0
    at_tangent, at_secant = (
        ""
        if stiffness.frequency is None
        else f" ({round_to_error(stiffness.frequency, digits=4)} Hz)"
        for stiffness in (tangent, secant)
    )
    text = ", deeper than tested" if equilibrium.point.is_extrapolated else ""
    return (
        f"The mass rests at {format_with_error(equilibrium.point.compression, 'mm')}{text}. It "
        "vibrates on the tangent stiffness, "
        f"{format_with_error(tangent.stiffness, 'N/mm', tangent.stiffness_se)}{at_tangent}. The "
        f"secant at {format_with_error(depth, 'mm')} is "
        f"{format_with_error(secant.stiffness, 'N/mm')}{at_secant}."
    )


def _describe_hammer(study: Study) -> str:
    if study.comparison is not None:
        return study.comparison.message
    if study.mass is None:
        return (
            "No mass was given, so no vibration was predicted. Outside the valid band the model is "
            "an extrapolation."
        )
    return (
        "No hammer test was given, so nothing has tested the predicted vibration. Where the "
        "figures are dashed it lies outside the valid band."
    )


def _describe_joint_model(study: Study) -> str:
    joint, comparison = study.joint, study.joint_comparison
    if joint is None or comparison is None:
        return ""
    if joint.evidence.explanations:
        lead = joint.evidence.explanations[0]
        if lead.is_sufficient:
            return f"The two tests match only if {lead.message}."
        return (
            "No single seal matches relaxation and hammer test, whatever mass, gain or stiffness "
            "is taken."
        )
    return (
        f"The joint model {_format_agreement(comparison)} in frequency and "
        f"{max(abs(comparison.ratio_db), 0.1):.1f} dB at the peak."
    )


def _format_agreement(comparison: Comparison) -> str:
    """Return the agreement of a prediction with the hammer, as text."""
    disagrees = any(
        check.name in {"stiffness_agrees", "peak_agrees"}
        for check in comparison.verdict.failed_checks
    )
    error = f"{max(100 * abs(comparison.frequency_error), 0.01):.2f} %"
    return f"misses the hammer by {error}" if disagrees else f"matches the hammer within {error}"


def format_direct_band(study: Study) -> str:
    """Return the band where the FRF alone gives stiffness and damping, and its limits, as text."""
    direct = study.direct
    if direct is None:
        return ""
    mass_percent, phase = 100 * direct.mass_sd / direct.mass, math.degrees(direct.phase_sd)
    return (
        f"With an uncertainty of {mass_percent:.2g} % of the mass and {phase:.2g}° of the phase, "
        f"the storage stiffness is known to 10 % {format_band(direct.storage_band)}. The loss is "
        f"known to 30 % {format_band(direct.loss_band)}. At higher frequencies the inertia of the "
        "mass dominates; at lower ones the "
        "error of the phase exceeds the damping."
    )


def inferred_mass(study: Study) -> str:
    """Return a warning where the mass was inferred from the measured frequency."""
    if not (study.mass_inferred and study.mass is not None):
        return ""
    return (
        f"The mass of {format_with_error(study.mass, 'g', digits=4)} was found from the measured "
        "FRF, so the agreement in frequency proves nothing. Weigh the test mass."
    )


def find_simulated_files(study: Study) -> tuple[str, ...]:
    """Return the names of simulated files and of simulated records in memory."""
    files = tuple(source.file for source in sources(study) if source.simulated)
    if not files and "simulated" in study.prepared.specimen.notes.lower():
        return ("records in memory",)
    return files


def sources(study: Study) -> tuple[Source, ...]:
    """Return every file that went into the study, once."""
    sources = [study.test.source, study.prepared.source, *study.fit.source]
    for frf in (study.measured, study.impact):
        sources += list(frf.source) if frf is not None else []
    return tuple(dict.fromkeys(source for source in sources if source is not None))


# Subject of the checks of each stage.
SUBJECTS = {
    "relaxation": "Relaxation test", "fit": "Fit of the relaxation test", "hammer": "Hammer test",
    "FRF": "FRF", "comparison": "Prediction from relaxation", "joint fit": "Joint model",
    "after joint fit": "Joint model", "story": "",
}  # fmt: skip

MAX_WORDS = 100
"""Words of the checks on the first screen, which fit one printed page."""


class DecisiveCheck(NamedTuple):
    """Failed check, and its topic."""

    subject: str
    check: Check


def select_decisive_checks(
    study: Study, recommendation: Recommendation
) -> tuple[tuple[DecisiveCheck, ...], int]:
    """Return the failed checks that fit the screen, the gravest first, and the number of others.

    Less the one that the verdict quotes, and less the notes on a solid of the relaxation test
    beside which that of both tests is recommended.
    """
    quoted = study.verdict.failed_checks[:1]
    stage_by_check: dict[Check, str] = {}
    for stage, checks in stages(study):
        for check in checks:
            stage_by_check.setdefault(check, stage)
    failed = [
        DecisiveCheck(SUBJECTS[stage_by_check.get(check, "story")], check)
        for check in study.verdict_checks
        if check.failed and check not in quoted
        if not (
            recommendation.joint and check.grade == "note" and stage_by_check.get(check) == "fit"
        )
    ]
    failed.sort(key=lambda decisive_check: -GRADES.index(decisive_check.check.grade))
    words = np.cumsum(
        [len(decisive_check.check.message_with_remedy.split()) for decisive_check in failed]
    )
    shown_count = max(int(np.sum(words <= MAX_WORDS)), min(len(failed), 1))
    return tuple(failed[:shown_count]), len(failed) - shown_count


def group_by_part(
    stages: Iterable[tuple[str, tuple[Check, ...]]], verdict_checks: Iterable[Check]
) -> list[tuple[str, list[Check]]]:
    """Return the checks of each folded part of the page; over the list, those of the verdict."""
    part_stages = {
        "test": ("relaxation",),
        "fit": ("fit",),
        "hammer": ("comparison", "FRF"),
        "joint": ("joint fit", "after joint fit"),
        "hits": ("hammer",),
    }
    checks = dict(stages)
    part_checks = [
        (part, [check for stage in names for check in checks.get(stage, ())])
        for part, names in part_stages.items()
    ]
    return [*part_checks, ("checks", list(verdict_checks))]


def stages(study: Study) -> list[tuple[str, tuple[Check, ...]]]:
    """Return the checks of every stage, in the order of the work."""
    fit_checks = tuple(check for check in study.fit.checks if check not in study.prepared.checks)
    results: dict[str, FRF | DynamicStiffness | Comparison | Fit | Study | None] = {
        "hammer": study.measured,
        "FRF": study.direct,
        "comparison": study.comparison,
        "joint fit": study.joint,
        "after joint fit": study.joint_comparison,
        "story": study,
    }
    return [
        ("relaxation", study.prepared.checks),
        ("fit", fit_checks),
        *((stage, item.checks) for stage, item in results.items() if item is not None),
    ]
