"""Indentation tests, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dashpot.extensions.materials.law_ranking import format_bic_differences
from dashpot.text_output.layout import Text, format_values

if TYPE_CHECKING:
    from dashpot.extensions.materials.indentation.datamodel import IndentationFit


def indentation(indentation_fit: IndentationFit) -> Text:
    """Return the law of a contact, its numbers with their intervals, and the laws tried."""
    return Text(
        [
            f"  law: {indentation_fit.law}",
            *format_values(indentation_fit.reported_values),
            format_bic_differences(indentation_fit.orders),
        ]
    )
