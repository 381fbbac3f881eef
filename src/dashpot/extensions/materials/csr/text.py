"""Life at a temperature, and retained force after a time, as text."""

from __future__ import annotations

from dashpot.extensions.materials.csr.lifetime_prediction import AgingPrediction
from dashpot.text_output.layout import Text
from dashpot.text_output.results import render_facts


def render_aged(prediction: AgingPrediction) -> Text:
    """Return the results with their intervals, and the errors that these do not include."""
    text, note = render_facts(prediction), prediction.interval_note
    return text._replace(lines=[*text.lines, *([f"  {note}"] if note else [])])
