"""Page of an indentation test."""

from __future__ import annotations

from dashpot.base.number_format import duration, format_with_error, round_to_error
from dashpot.extensions.materials.indentation.datamodel import IndentationFit
from dashpot.extensions.materials.law_ranking import make_law_ranking
from dashpot.report.result_page import KindPage, Topic, get_sources, group, make_indicators


def page(indentation_fit: IndentationFit) -> KindPage:
    """Return the page of a contact."""
    law = {"law_residual_small", "parameters_determined", "laws_agree", "indentation_shallow"}
    remainder = f"{round_to_error(100 * indentation_fit.residual, digits=2)} % left"
    return KindPage(
        subject="contact of an indenter",
        summary_line=(
            ("Law", indentation_fit.law),
            ("Recorded", indentation_fit.quantity),
            ("Contact", duration(indentation_fit.duration)),
            (
                "Indenter",
                ""
                if indentation_fit.indenter.mass is None
                else format_with_error(indentation_fit.indenter.mass, "g"),
            ),
        ),
        indicators=make_indicators(
            indentation_fit.checks, Topic("Record"), Topic("Law", law, remainder)
        ),
        figure_title="The contact, recorded and fitted",
        picture=indentation_fit.plot(),
        table_title=f"The {indentation_fit.law} law",
        groups=(group("", indentation_fit.reported_values),),
        sources=get_sources(indentation_fit),
        collapsible_sections=(make_law_ranking(indentation_fit.orders),),
    )
