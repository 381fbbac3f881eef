"""Limits held against a result as text."""

from __future__ import annotations

from dashpot.base.number_format import ascii_only
from dashpot.extensions.acceptance.datamodel import Acceptance
from dashpot.text_output.layout import Text, table


def render_acceptance(acceptance: Acceptance) -> Text:
    """Return the seal's word, and a line for each limit."""
    rows = [["limit", "found", "95 % from", "to", ""]]
    for limit in acceptance.limits:
        value, low, high = (ascii_only(cell) for cell in limit.cell_texts)
        value_text = f"{value} {ascii_only(limit.value.word)}".rstrip()
        rows.append([ascii_only(limit.request), value_text, low, high, limit.outcome])
    lines = [f"Seal: {acceptance.headline}", *table(rows)]
    lines += [
        f"  {ascii_only(labels)}: {ascii_only(text)}"
        for text, labels in acceptance.explanations.items()
    ]
    return Text(lines)
