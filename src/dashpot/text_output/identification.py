"""The solid behind vibration, and what was measured beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dashpot.text_output.frequency_table import sensitive
from dashpot.text_output.layout import Text
from dashpot.text_output.results import fit, impact

if TYPE_CHECKING:
    from dashpot.workflow.vibration.impact_tests import Identified

_ASSUMED = "seals_counted"
"""The check whose answer changes every stiffness that is shown."""
_ROWS = 3
"""Lines of a transmissibility that are shown: both ends of its band, and between."""


def render_identification(result: Identified) -> Text:
    """Return the solid, and the modes of what was measured where nothing else was fitted."""
    solid, straight = fit(result.fit), result.direct.of
    first, lines = list(solid.lines[:1]), solid.lines[1:]
    if straight.over_base:
        first += sensitive(straight, errors=("phase", "mass"), unit="N/m", shown=_ROWS)
    assumed = [check.says for check in result.noted if check.failed and check.name == _ASSUMED]
    rests = [str(result.at_rest)] if str(result.at_rest) else []
    modes = impact(result.vibration) if result.vibration else Text()
    shown = [*first, *lines, *assumed, *rests, *modes.lines]
    return Text(shown, [*solid.details, *modes.details], solid.asked)
