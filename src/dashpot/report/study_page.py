"""Page of a study: contents of the report of the main job."""

from __future__ import annotations

from typing import Any

from dashpot.base.provenance import Step
from dashpot.report import first_screen, tables
from dashpot.report.figures import draw_study_figures
from dashpot.report.page_frame import VERDICT_COLOURS, frame, render_template
from dashpot.workflow.recommended_solid import recommend_solid
from dashpot.workflow.study import Study


def write_study(study: Study, **sections: str) -> str:
    """Return the report of a study as HTML, with sections below the verdict."""
    return render_template("report.html", _build_contents(study) | sections)


def _build_contents(study: Study) -> dict[str, Any]:
    """Return the values of the template by name."""
    length = study.prepared.specimen.length
    stages = first_screen.stages(study)
    recommendation = recommend_solid(study)
    decks = first_screen.decks(recommendation)
    return {
        "study": study,
        **frame(),
        "title": first_screen.title(study),
        "header": first_screen.make_header(study),
        "verdict": study.verdict,
        "colour": VERDICT_COLOURS[study.verdict.use],
        "lights": first_screen.make_study_indicators(study, recommendation),
        "recommendation": recommendation,
        "heading": first_screen.make_heading(recommendation),
        "under_mass": first_screen.make_mass_rows(study, recommendation),
        "seal_values": (
            *first_screen.rows(recommendation.seal_values),
            first_screen.band_row(recommendation),
        ),
        "about_decks": first_screen.format_deck_note(recommendation, decks),
        "files": first_screen.files(study, recommendation, decks),
        "sentences": first_screen.sentences(study, recommendation),
        "weighty": first_screen.select_decisive_checks(study, recommendation),
        "simulated": first_screen.find_simulated_files(study),
        "straight": first_screen.format_direct_band(study),
        "inferred": first_screen.inferred_mass(study),
        "tallies": {
            stage: first_screen.count_passed(checks, study.verdict_checks)
            for stage, checks in first_screen.group_by_part(stages, study.verdict_checks)
        },
        "checks": tables.checks(stages, study.verdict_checks),
        "figures": draw_study_figures(study),
        "peaks": tables.peaks(study),
        "facts": tables.test_facts(study.prepared),
        "solid_heading": first_screen.solid_heading(recommendation),
        "recommended": tables.coefficients(recommendation.solid, length),
        "coefficients": tables.coefficients(study.fit, length),
        "orders": tables.orders(study),
        "routes": tables.two_routes(study),
        "nuisances": tables.nuisances(study.fit),
        "frequency": tables.make_frequency_table(study),
        "arms": tables.arms_tested(study.comparison),
        "resonance": tables.resonance(study),
        "hits": tables.hits(study.measured),
        "explanations": tables.explanations(study.joint),
        "parameter_changes": tables.make_change_table(study.joint),
        "joint_coefficients": tables.coefficients(study.joint, length),
        "joint_arms": tables.arms_tested(study.joint_comparison),
        "joint_nuisances": tables.nuisances(study.joint),
        "assumptions": tables.assumptions(study),
        "sources": first_screen.sources(study),
        "steps": _collect_steps(study),
    }


def _collect_steps(study: Study) -> list[Step]:
    """Return every step since the raw files, each once, in order."""
    groups = [study.fit.steps or study.prepared.steps]
    groups += [
        later_result.steps
        for later_result in (study.measured, study.joint)
        if later_result is not None
    ]
    return list(dict.fromkeys(step for steps in groups for step in steps))
