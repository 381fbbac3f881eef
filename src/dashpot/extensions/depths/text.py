"""Text of the stiffnesses of each depth, and their fields from a document."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dashpot.base.reported_values import NORMAL
from dashpot.base.units import format_quantity
from dashpot.text_output.layout import table

if TYPE_CHECKING:
    from dashpot.datamodel.fit import Fit


def format_depth_stiffnesses(fit: Fit) -> list[str]:
    """Return the stiffnesses of each depth, where each has its own."""
    if not fit.evidence.stiffness_by_depth:
        return []
    fact_groups = [
        depth_stiffness.list_values(fit.unit) for depth_stiffness in fit.evidence.stiffness_by_depth
    ]
    rows = [["  depth", *(reported_value.label for reported_value in fact_groups[0])]]
    for at, group in zip(fit.evidence.stiffness_by_depth, fact_groups, strict=True):
        cells = (reported_value.cells.ascii.with_limit for reported_value in group)
        rows.append([f"  {format_quantity(at.depth, 'mm')}", *cells])
    return [f"    by depth, {fact_groups[0][0].word}, ± SE", *table(rows)]


def complete_document(entries: dict[str, Any]) -> dict[str, Any]:
    """Return the stiffnesses of one depth; an older document holds the standard error of k_inf."""
    error = entries.get("k_inf_se")
    if error is None:
        return entries
    return {"k_inf_most": entries["k_inf"] + NORMAL * error} | entries
