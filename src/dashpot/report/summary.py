"""The sentences at the top of the report: what the tests say, in plain words."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from dashpot.base.checks import GRADES, Check
from dashpot.base.number_format import (
    format_band,
    format_count,
    format_typographic,
    format_with_error,
    hertz,
    round_to_error,
)
from dashpot.base.provenance import Source
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.solids.fractional import FractionalZener
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness
from dashpot.workflow.recommendation import Recommendation
from dashpot.workflow.study import Study


def title(study: Study) -> str:
    """What the report is about: as it was said, or the specimen and its lot, or the file."""
    if study.title:
        return study.title
    specimen = study.prepared.specimen
    if specimen.name:
        return specimen.name + (f", lot {specimen.lot}" if specimen.lot else "")
    source = study.test.source or study.prepared.source
    return source.file if source is not None else "relaxation test"


def sentences(study: Study, recommendation: Recommendation) -> tuple[str, ...]:
    """What the tests say, one thought a sentence, below the verdict."""
    return tuple(
        format_typographic(sentence)
        for sentence in (
            _solid(recommendation),
            _end(recommendation),
            _resting(study),
            _hammer(study),
            _joint(study),
        )
        if sentence
    )


def _solid(recommendation: Recommendation) -> str:
    fit = recommendation.solid
    arms = format_count(fit.model.arms, "Maxwell arm")
    if isinstance(fit.solid, FractionalZener):
        arms = f"a springpot of slope {round_to_error(fit.solid.alpha)} beside it"
    tests = "both tests" if recommendation.joint else "the relaxation test"
    return (
        f"One seal behaves as a spring of {_format_k_inf(fit)} with {arms}. At once it "
        f"has {format_with_error(fit.model.k_0, 'N/mm')}. The valid band of {tests} is "
        f"{hertz(fit.band)}."
    )


def _format_k_inf(fit: Fit) -> str:
    """k_inf with what it is at most."""
    cells = next(fact for fact in fit.facts if fact.name == "k_inf").cells
    return ", ".join(filter(None, (cells.with_unit, cells.interval)))


def _end(recommendation: Recommendation) -> str:
    """What naming the machine would give, if that is much."""
    end = recommendation.solid.end_of_hold
    return "" if end is None else end.naming


def _resting(study: Study) -> str:
    """Where the mass rests, if that makes a difference."""
    rests = study.at_rest
    if rests is None or rests.point.linear:
        return ""
    tangent, secant, depth = rests.tangent, rests.secant, rests.point.depth or 0.0
    here, there = (
        ""
        if stiffness.frequency is None
        else f" ({round_to_error(stiffness.frequency, digits=4)} Hz)"
        for stiffness in (tangent, secant)
    )
    text = ", deeper than tested" if rests.point.beyond else ""
    return (
        f"The mass rests at {format_with_error(rests.point.compression, 'mm')}{text}. It "
        "vibrates on the "
        "tangent stiffness, "
        f"{format_with_error(tangent.stiffness, 'N/mm', tangent.stiffness_se)}{here}. The "
        f"secant at {format_with_error(depth, 'mm')} is "
        f"{format_with_error(secant.stiffness, 'N/mm')}{there}."
    )


def _hammer(study: Study) -> str:
    if study.comparison is not None:
        return study.comparison.says
    if study.mass is None:
        return (
            "No mass was given, so no vibration was predicted. Outside the valid band the model is "
            "an extrapolation."
        )
    return (
        "No hammer test was given, so nothing has tested the predicted vibration. Where the "
        "figures are dashed it lies outside the valid band."
    )


def _joint(study: Study) -> str:
    joint, after = study.joint, study.joint_comparison
    if joint is None or after is None:
        return ""
    if joint.explanations:
        lead = joint.explanations[0]
        if lead.explains:
            return f"The two tests match only if {lead.says}."
        return "No single seal matches both tests, whatever mass, gain or stiffness is taken."
    return (
        f"Fitted to both tests together, {_format_model_name(joint)} "
        f"{_meets(after)} in frequency and {max(abs(after.ratio_db), 0.1):.1f} dB at the peak."
    )


def _format_model_name(fit: Fit) -> str:
    return "a fractional model" if fit.family == "fractional" else f"a model of {fit.called}"


def _meets(c: Comparison) -> str:
    """How far a prediction is from the hammer; a failure does not read as a success."""
    missed = any(check.name in {"stiffness_agrees", "peak_agrees"} for check in c.verdict.because)
    error = f"{max(100 * abs(c.frequency_error), 0.01):.2f} %"
    return f"misses the hammer by {error}" if missed else f"matches the hammer within {error}"


def straight(study: Study) -> str:
    """Where the FRF alone gives stiffness and damping, and what limits it."""
    d = study.direct
    if d is None:
        return ""
    mass, phase = 100 * d.mass_sd / d.mass, math.degrees(d.phase_sd)
    return (
        f"With an uncertainty of {mass:.2g} % of the mass and {phase:.2g}° of the phase, the "
        f"storage stiffness is known to 10 % {format_band(d.storage_band)}. The loss is known to "
        "30 % "
        f"{format_band(d.loss_band)}. At higher frequencies the mass hides the seal; at lower ones "
        "the "
        "phase hides its damping."
    )


def inferred_mass(study: Study) -> str:
    """A warning where the mass was taken from the very frequency it should predict."""
    if not (study.mass_inferred and study.mass is not None):
        return ""
    return (
        f"The mass of {format_with_error(study.mass, 'g', digits=4)} was found from the measured "
        "FRF, "
        "so the agreement in frequency proves nothing. Weigh the block."
    )


def find_simulated_files(study: Study) -> tuple[str, ...]:
    """The files that the virtual rig or hammer made; a record in memory says so in its notes."""
    files = tuple(source.file for source in sources(study) if source.simulated)
    if not files and "simulated" in study.prepared.specimen.notes.lower():
        return ("records in memory",)
    return files


def sources(study: Study) -> tuple[Source, ...]:
    """Every file that went into the study, once."""
    sources = [study.test.source, study.prepared.source, *study.fit.source]
    for frf in (study.measured, study.impact):
        sources += list(frf.source) if frf is not None else []
    return tuple(dict.fromkeys(source for source in sources if source is not None))


# what a check of each stage speaks of
SUBJECTS = {
    "relaxation": "Relaxation test", "fit": "Fit of the relaxation test", "hammer": "Hammer test",
    "FRF": "FRF", "comparison": "Prediction from relaxation", "joint fit": "Model of both tests",
    "after joint fit": "Model of both tests", "story": "",
}  # fmt: skip

MOST_WORDS = 100
"""Of the checks on the first screen: what stands on one page of paper with all the rest."""


class DecisiveCheck(NamedTuple):
    """A failed check, and what it speaks of."""

    subject: str
    check: Check


def select_decisive_checks(
    study: Study, recommendation: Recommendation
) -> tuple[tuple[DecisiveCheck, ...], int]:
    """The failed checks behind the verdict that there is room for, the gravest first; how many not.

    Less the one that the verdict quotes, and less the notes on a solid of the relaxation test
    beside which that of both tests is recommended.
    """
    quoted = study.verdict.because[:1]
    subject: dict[Check, str] = {}
    for stage, checks in stages(study):
        for check in checks:
            subject.setdefault(check, stage)
    failed = [
        DecisiveCheck(SUBJECTS[subject.get(check, "story")], check)
        for check in study.weighed
        if check.failed and check not in quoted
        if not (recommendation.joint and check.grade == "note" and subject.get(check) == "fit")
    ]
    failed.sort(key=lambda decisive_check: -GRADES.index(decisive_check.check.grade))
    words = np.cumsum([len(decisive_check.check.told.split()) for decisive_check in failed])
    shown = max(int(np.sum(words <= MOST_WORDS)), min(len(failed), 1))
    return tuple(failed[:shown]), len(failed) - shown


def parts(
    stages: Iterable[tuple[str, tuple[Check, ...]]], weighed: Iterable[Check]
) -> list[tuple[str, list[Check]]]:
    """The checks of each folded part of the page; over the list of all those of the verdict."""
    of_part = {
        "test": ("relaxation",),
        "fit": ("fit",),
        "hammer": ("comparison", "FRF"),
        "joint": ("joint fit", "after joint fit"),
        "hits": ("hammer",),
    }
    checks = dict(stages)
    named = [
        (part, [check for stage in names for check in checks.get(stage, ())])
        for part, names in of_part.items()
    ]
    return [*named, ("checks", list(weighed))]


def stages(study: Study) -> list[tuple[str, tuple[Check, ...]]]:
    """The checks of every stage, in the order of the work."""
    of_fit = tuple(check for check in study.fit.checks if check not in study.prepared.checks)
    later: dict[str, FRF | DynamicStiffness | Comparison | Fit | Study | None] = {
        "hammer": study.measured,
        "FRF": study.direct,
        "comparison": study.comparison,
        "joint fit": study.joint,
        "after joint fit": study.joint_comparison,
        "story": study,
    }
    return [
        ("relaxation", study.prepared.checks),
        ("fit", of_fit),
        *((stage, item.checks) for stage, item in later.items() if item is not None),
    ]
