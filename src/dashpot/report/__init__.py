"""Reports: a study or result as one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from dashpot.base.provenance import Step
from dashpot.base.result_mixins import HasVerdict
from dashpot.plot.picture import Picture
from dashpot.registry import find_handler
from dashpot.report import first_screen, result_page, tables
from dashpot.report.figures import figures_of
from dashpot.report.page_frame import VERDICT_COLOURS, environment, frame
from dashpot.workflow.recommendation import recommendation
from dashpot.workflow.study import Study

__all__ = ["has_page", "html", "write_study"]


def html(
    study: Study | HasVerdict, *, lead: Picture | None = None, beside: Sequence[Picture] = ()
) -> str:
    """Return the report as one self-contained HTML file.

    The first screen holds the verdict, the figure that answers, and the solid to take; then test,
    fit and the checks that matter; all else is folded. No network: figures are inline SVG, files
    to take along are links that hold them. One small script lets figures be zoomed and read off;
    without it the page is whole. A strict content security policy names the hash of that script
    and of the style, and allows nothing else. Whatever came from a file is escaped.

    Parameters
    ----------
    study : Study or another result of a kind
        What ``dashpot report``, ``fit`` or ``predict`` found.
    lead : Picture, optional
        The figure that answers, where the caller knows more than the result tells; not of a study.
    beside : sequence of Picture
        Figures of the records behind it, which are folded; not of a study.

    Returns
    -------
    str
        The text of the file; the same study gives the same text.
    """
    write = find_handler("html", study)
    if write is not None:
        return str(write(study))
    return _render_template(
        "judged.html", result_page.build_page_contents(study, lead=lead, pictures=beside)
    )


def write_study(study: Study) -> str:
    """Return the report of a study."""
    return _render_template("report.html", _contents(study))


def has_page(result: object) -> bool:
    """Return whether a result has a page."""
    return find_handler("html", result) is not None or result_page.has_kind_page(result)


def _render_template(name: str, contents: dict[str, Any]) -> str:
    return str(environment("dashpot.report").get_template(name).render(contents))


def _contents(study: Study) -> dict[str, Any]:
    length = study.prepared.specimen.length
    stages = first_screen.stages(study)
    new_recommendation = recommendation(study)
    decks = first_screen.decks(new_recommendation)
    return {
        "study": study,
        **frame(),
        "title": first_screen.title(study),
        "header": first_screen.header(study),
        "verdict": study.verdict,
        "colour": VERDICT_COLOURS[study.verdict.use],
        "lights": first_screen.lights(study, new_recommendation),
        "found": new_recommendation,
        "heading": first_screen.heading(new_recommendation),
        "under_mass": first_screen.under_mass(study, new_recommendation),
        "one_seal": (
            *first_screen.rows(new_recommendation.one_seal),
            first_screen.band_row(new_recommendation),
        ),
        "about_decks": first_screen.about_decks(new_recommendation, decks),
        "files": first_screen.files(study, new_recommendation, decks),
        "sentences": first_screen.sentences(study, new_recommendation),
        "weighty": first_screen.select_decisive_checks(study, new_recommendation),
        "simulated": first_screen.find_simulated_files(study),
        "straight": first_screen.straight(study),
        "inferred": first_screen.inferred_mass(study),
        "tallies": {
            stage: first_screen.tally(checks, study.verdict_checks)
            for stage, checks in first_screen.parts(stages, study.verdict_checks)
        },
        "checks": tables.checks(stages, study.verdict_checks),
        "figures": figures_of(study),
        "peaks": tables.peaks(study),
        "facts": tables.test_facts(study.prepared),
        "solid_heading": first_screen.solid_heading(new_recommendation),
        "recommended": tables.coefficients(new_recommendation.solid, length),
        "coefficients": tables.coefficients(study.fit, length),
        "orders": tables.orders(study),
        "routes": tables.two_routes(study),
        "nuisances": tables.nuisances(study.fit),
        "frequency": tables.make_frequency_table(study),
        "arms": tables.arms_tested(study.comparison),
        "resonance": tables.resonance(study),
        "hits": tables.hits(study.measured),
        "explanations": tables.explanations(study.joint),
        "moved": tables.make_change_table(study.joint),
        "joint_coefficients": tables.coefficients(study.joint, length),
        "joint_arms": tables.arms_tested(study.joint_comparison),
        "joint_nuisances": tables.nuisances(study.joint),
        "assumptions": tables.assumptions(study),
        "sources": first_screen.sources(study),
        "steps": _steps(study),
    }


def _steps(study: Study) -> list[Step]:
    """Return every step since the raw files, each once, in order."""
    groups = [study.fit.steps or study.prepared.steps]
    groups += [later.steps for later in (study.measured, study.joint) if later is not None]
    return list(dict.fromkeys(step for steps in groups for step in steps))
