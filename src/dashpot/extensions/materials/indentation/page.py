"""The page of an indenter's contact."""

from __future__ import annotations

from dashpot.base.number_format import duration, format_with_error, round_to_error
from dashpot.extensions.materials.indentation.datamodel import IndentationFit
from dashpot.report.page_content import (
    KindPage,
    Topic,
    group,
    lights,
    make_law_ranking,
    sources_behind,
)


def page(found: IndentationFit) -> KindPage:
    """What the page of a contact holds."""
    law = {"law_followed", "parameters_known", "laws_agree", "indentation_shallow"}
    left = f"{round_to_error(100 * found.residual, digits=2)} % left"
    return KindPage(
        about="contact of an indenter",
        strip=(
            ("Law", found.law),
            ("Recorded", found.of),
            ("Contact", duration(found.duration)),
            (
                "Indenter",
                "" if found.indenter.mass is None else format_with_error(found.indenter.mass, "g"),
            ),
        ),
        lights=lights(found.checks, Topic("Record"), Topic("Law", law, left)),
        answers="The contact, recorded and fitted",
        picture=found.plot(),
        told=f"The {found.law} law",
        groups=(group("", found.found),),
        sources=sources_behind(found),
        folds=(make_law_ranking(found.orders),),
    )
