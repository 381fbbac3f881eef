"""The first screen in words: who and what, three lights, the numbers, the files to take."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import number_format
from dashpot.base.checks import Check
from dashpot.base.number_format import (
    decibels,
    duration,
    format_count,
    format_with_error,
    percent,
    round_to_error,
)
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.report import attachments
from dashpot.report.attachments import AttachedDeck, Attachment, attachment
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.vibration.modal.dynamic_stiffness import STORAGE_LIMIT
from dashpot.workflow.json_archive import to_json
from dashpot.workflow.recommendation import Answer, Recommendation
from dashpot.workflow.study import Study

NOT_GIVEN, NBSP = "not given", "\N{NO-BREAK SPACE}"

GRADES = {"stop": "bad", "limit": "care", "note": "note"}
"""How a failed check of each grade looks."""

ORDER = ("good", "note", "care", "bad")


class Light(NamedTuple):
    """One of the three lights: its mark, and two or three words."""

    name: str
    mark: str
    says: str


class Row(NamedTuple):
    """A number of the first table as cells; `bound` puts the hatched mark beside its name."""

    name: str
    value: str
    low: str
    high: str
    unit: str
    measured: str
    bound: bool


def header(study: Study) -> tuple[tuple[str, str], ...]:
    """What was tested, where it comes from, by whom, when, and under what."""
    specimen = study.prepared.specimen
    length = "" if specimen.length is None else f"{format_with_error(specimen.length, 'mm')} long"
    what = ", ".join(part for part in (specimen.name, length) if part)
    kelvin = specimen.temperature
    mass = "" if study.mass is None else format_with_error(study.mass, "g", digits=4)
    inferred = " (found from the FRF)" if study.mass_inferred else ""
    rows = (
        ("Specimen", what),
        ("Lot", specimen.lot),
        ("Operator", specimen.operator),
        ("Date", specimen.date),
        ("Temperature", "" if kelvin is None else format_quantity(kelvin, "°C", ".1f")),
        ("Mass", mass + inferred),
        ("Seals", "" if study.mass is None else f"{study.seals:g}"),
        ("Test depth", format_with_error(study.prepared.depth, "mm")),
    )
    return tuple((name, value or NOT_GIVEN) for name, value in rows)


# -- marks ----------------------------------------------------------------------------------------


def mark_of(checks: Iterable[Check]) -> str:
    """The mark of the gravest check that failed: bad, care, note; good if none did."""
    marks = [GRADES[check.grade] for check in checks if check.failed]
    return max(marks, key=ORDER.index, default="good")


def tally(checks: Iterable[Check], weighed: Collection[Check]) -> tuple[str, str]:
    """The mark of some checks, and how many of those judged passed.

    What the verdict does not weigh, for the joint fit has mended it, is a note.
    """
    checked_checks = [check for check in checks if check.passed is not None]
    if not checked_checks:
        return "note", "not applicable"
    failed = [check for check in checked_checks if check.failed]
    notes = sum(check.grade == "note" for check in failed)
    text = f"{len(checked_checks) - len(failed)} of {len(checked_checks)}"
    if notes and notes == len(failed):
        text += f", {format_count(notes, 'note')}"
    heavy = mark_of(check for check in checked_checks if check in weighed)
    return ("note" if failed and heavy == "good" else heavy), text


def lights(study: Study, recommendation: Recommendation) -> tuple[Light, Light, Light]:
    """Whether the test is sound, and whether the hammer bears out stiffness and damping.

    Those of the joint solid if it is recommended, else those of the relaxation test alone: a joint
    fit that failed agrees with the hammer for the wrong reason.
    """
    hammer = () if study.measured is None else study.measured.checks
    test = test_light((*study.fit.checks, *hammer))
    held = study.joint_comparison if recommendation.joint else study.comparison
    if held is None:
        untested = "no hammer test"
        return (
            test,
            Light("Stiffness", "note", untested),
            Light("Damping", "note", untested),
        )
    return (
        test,
        _stiffness_light(study, recommendation, held),
        _light(
            "Damping",
            held,
            {"peak_agrees", "damping_agrees"},
            f"{decibels(held.ratio_db)} at the peak",
        ),
    )


def _stiffness_light(study: Study, recommendation: Recommendation, held: Comparison) -> Light:
    """Whether the stiffness is that of the hammer, K' = m w^2 / n at its peak, and of the test.

    A joint fit peaks where the hammer does with any mass. So its stiffness is held against the
    limits of the relaxation test, and its disagreement with either test is heeded.
    """
    checks = [check for check in held.checks if check.name == "stiffness_agrees"]
    if recommendation.joint and study.joint is not None:
        checks += [check for check in study.joint.checks if check.name in _STIFF]
    mark = mark_of(checks)
    seen = _storage_at_peak(study, recommendation)
    if seen is None:
        text = f"{percent(held.frequency_error)} in frequency"
    else:
        off = max(seen.off, default=0.0)
        worst = "bad" if off > 2 * STORAGE_LIMIT else "care" if off > 0 else "good"
        mark = max(mark, worst, key=ORDER.index)
        here, there, *ends = (
            round_to_error(convert_to_unit(value, "N/mm"), digits=3)
            for value in (seen.model, seen.hammer, *seen.test)
        )
        other = f"test {' to '.join(ends)}" if max(seen.off[1:], default=0.0) else f"hammer {there}"
        text = f"K\N{PRIME}{NBSP}{here}, {other}{NBSP}N/mm"
    return Light("Stiffness", mark, f"{'agrees' if mark in _FINE else 'misses'}, {text}")


_STIFF = {"tests_agree", "stiffness_believable", "mass_believable"}
_FINE = {"good", "note"}


class _Storage(NamedTuple):
    """K' of one seal under the hammer at its peak, N/m: of the solid shown, and measured.

    `off` is how far the one lies from the other, and the measured one beyond the limits of the
    relaxation test, relative; 0 within the errors.
    """

    model: float
    hammer: float
    off: tuple[float, ...]
    test: tuple[float, ...] = ()


def _storage_at_peak(study: Study, recommendation: Recommendation) -> _Storage | None:
    """Return what the solid and the hammer say of K' at the peak; None where a mass was found."""
    direct, held = study.direct, study.comparison
    if direct is None or held is None or study.mass_inferred or not len(direct.frequency):
        return None
    at = int(np.argmin(np.abs(direct.frequency - held.measured_hz)))
    hertz, hammer = float(direct.frequency[at]), float(direct.storage[at])
    error = 2 * float(direct.storage_sd[at])
    solid, point = recommendation.solid, recommendation.point
    factor = 1.0 if point is None else point.factor
    model = solid.under_hammer * factor * float(solid.solid.storage(frequency=hertz))
    near = STORAGE_LIMIT * abs(hammer)
    off = [_compute_excess(model, hammer - max(error, near), hammer + max(error, near))]
    test: tuple[float, ...] = ()
    wide = study.unseen
    if (
        recommendation.joint
        and wide is not None
        and wide.frequency[0] <= hertz <= wide.frequency[-1]
    ):
        rests = 1.0 if study.at_rest is None else study.at_rest.point.factor
        test = low, high = tuple(
            rests * float(np.interp(np.log(hertz), np.log(wide.frequency), edge))
            for edge in wide.storage
        )
        off.append(_compute_excess(hammer, low - error, high + error))
        off.append(_compute_excess(model, low - error, high + error))
    return _Storage(model, hammer, tuple(off), test)


def _compute_excess(value: float, low: float, high: float) -> float:
    """How far a value lies beyond two ends, relative to the nearer one; 0 between them."""
    return max(low - value, value - high, 0.0) / max(abs(low if value < low else high), 1e-300)


def test_light(checks: Iterable[Check]) -> Light:
    """Whether the test is sound, by what it was asked."""
    mark = mark_of(checks)
    says = {"good": "valid", "note": "valid, with notes", "care": "limited", "bad": "not valid"}
    return Light("Test", mark, says[mark])


def _light(name: str, held: Comparison, requested: set[str], off: str) -> Light:
    mark = mark_of(check for check in held.checks if check.name in requested)
    text = "agrees" if mark in {"good", "note"} else "misses"
    return Light(name, mark, f"{text}, {off}")


# -- numbers --------------------------------------------------------------------------------------


def heading(recommendation: Recommendation) -> str:
    """Which solid to take, or that none is recommended."""
    if not recommendation.recommended:
        return "No model is recommended"
    return f"Recommended: model of {source(recommendation)}, {recommendation.solid.called}"


def source(recommendation: Recommendation) -> str:
    """Which data the solid comes from."""
    return "both tests" if recommendation.joint else "the relaxation test"


def solid_heading(recommendation: Recommendation) -> str:
    """What the table of the solid's parameters is of."""
    if not recommendation.recommended:
        return "Model of the relaxation test, not recommended, one seal"
    return f"The recommended model, of {source(recommendation)}, one seal"


def band_row(recommendation: Recommendation) -> Row:
    """The frequencies that the solid is known at."""
    low, high = (round_to_error(end, digits=2) for end in recommendation.solid.band)
    return Row("Valid band", "", low, high, "Hz", "", bound=False)


def under_mass(study: Study, recommendation: Recommendation) -> tuple[str, tuple[Row, ...]]:
    """What the mass does on its seals; nothing without a mass."""
    if study.mass is None or not recommendation.under_mass:
        return "", ()
    weight, seals = format_with_error(study.mass, "g", digits=4), study.seals
    text = f"{weight} on {number_format.seals(seals)}"
    if study.mass_inferred:
        text += ", the mass found from the FRF"
    elif not recommendation.recommended:
        text += ", as given"
    return text, rows(recommendation.under_mass)


def rows(answers: Iterable[Answer]) -> tuple[Row, ...]:
    """Numbers to as many digits as their ends know."""
    return tuple(_row(answer) for answer in answers)


def _row(answer: Answer) -> Row:
    measured = "" if answer.measured_fact is None else answer.measured_fact.cells.value
    return Row(_name(answer), *answer.fact.ends, answer.fact.word, measured, answer.bound)


def _name(answer: Answer) -> str:
    where = "" if answer.at is None else f"{round_to_error(answer.at)}{NBSP}Hz"
    return {
        "frequency": "Peak frequency",
        "damping": "Damping ratio",
        "peak": "Peak height",
        "end of hold": f"Stiffness at end of hold, {_format_hold_time(answer.at or 0.0)}",
        "dynamic stiffness": f"Dynamic stiffness, {where}",
        "loss factor": f"Loss factor, {where}",
    }[answer.quantity]


def _format_hold_time(seconds: float) -> str:
    return duration(seconds).replace(".0 ", " ").replace(" ", NBSP)


# -- files ----------------------------------------------------------------------------------------


def files(
    study: Study, recommendation: Recommendation, made_decks: Sequence[AttachedDeck]
) -> tuple[Attachment, ...]:
    """What can be taken along, the recommended solid and its decks first."""
    fits = {"fit.json": (study.fit, "the fit of the relaxation test")}
    if study.joint is not None:
        fits["joint.json"] = (study.joint, "the fit of both tests")
    name = "joint.json" if recommendation.joint else "fit.json"
    solid, about = fits.pop(name)
    label = "Download this model" if recommendation.recommended else "Download anyway"
    made = [
        _json(name, label, about if recommendation.recommended else f"DO NOT USE: {about}", solid)
    ]
    made += attachments.attach_decks(made_decks, name)
    if study.comparison is not None:
        lines = _lines(study.comparison, study.joint_comparison)
        about = "measured and predicted accelerance, line by line"
        made.append(attachment("frf.csv", "frf.csv", about, "text/csv", lines))
    return (*made, *(_json(name, name, about, fit) for name, (fit, about) in fits.items()))


def decks(recommendation: Recommendation) -> tuple[AttachedDeck, ...]:
    """Decks of one recommended seal; a solid that hardens is written as the mass feels it."""
    if not recommendation.recommended:
        return ()
    bent = recommendation.point is not None and not recommendation.point.linear
    return attachments.decks(
        recommendation.solid,
        recommendation.point.compression if recommendation.point and bent else None,
    )


def about_decks(recommendation: Recommendation, made_decks: Sequence[AttachedDeck]) -> str:
    """Where the decks hold, and what they miss."""
    return (
        attachments.format_deck_note(recommendation.solid, made_decks)
        if recommendation.recommended
        else ""
    )


def _json(name: str, label: str, about: str, result: object) -> Attachment:
    about += ", SI units, full precision"
    return attachment(name, label, about, "application/json", to_json(result))


def _lines(c: Comparison, joint: Comparison | None) -> str:
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
