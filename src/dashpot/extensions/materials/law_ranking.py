"""BIC of the fitted laws: on a page and in a line of text."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.number_format import round_to_error
from dashpot.report.result_page import CollapsibleSection
from dashpot.report.tables import TextTable


def make_law_ranking(orders: Sequence[tuple[str, float]]) -> CollapsibleSection:
    """Return the BIC of every fitted law, best first."""
    lowest_score = min(score for _, score in orders)
    rows = tuple(
        (name, round_to_error(score - lowest_score))
        for name, score in sorted(orders, key=lambda o: o[1])
    )
    return CollapsibleSection(
        "Laws tried", "BIC above the least", TextTable(("law", "BIC above the least"), rows)
    )


def format_bic_differences(orders: Sequence[tuple[str, float]]) -> str:
    """Return the BIC of each law above that of the best."""
    lowest_score = min(score for _, score in orders)
    return "  BIC above the least: " + ", ".join(
        f"{name} {at - lowest_score:.1f}" for name, at in orders
    )
