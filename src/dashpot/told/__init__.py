"""What people are told of each result, as text: the same in a terminal and in Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from dashpot.base.offered import Judged

if TYPE_CHECKING:
    from dashpot.told.layout import Text

_TEXTS: Mapping[str, str] = MappingProxyType({
    "door.closing_result:ClosingResult": "closing:closed",
    "door.result:DoorResult": "door:door",
    "kinds.cld.from_files:Pieces": "cld:cld",
    "kinds.hyperelastic.record:HyperelasticFit": "hyperelastic:hyperelastic",
    "kinds.indentation.record:IndentationFit": "text:indentation",
    "kinds.level.hits:HitLevels": "text:amplitude",
    "kinds.level.levels:LevelFit": "text:amplitude",
    "kinds.level.record:AmplitudeFit": "text:amplitude",
    "lots.comparison:LotComparison": "lines:plainly",
    "planning.plan:Plan": "lines:plainly",
    "records.fit:Fit": "text:fit",
    "workflow.vibration.impacts:Agreement": "text:agreement",
    "workflow.vibration.impacts:Identified": "joint:identified",
    "workflow.vibration.impacts:ImpactResult": "text:impact",
    "workflow.vibration.levels:Levels": "text:levels",
    "workflow.vibration.measured_modes:MeasuredModes": "modes:modes",
    "workflow.response.predictions:Prediction": "text:prediction",
    "workflow.vibration.rods:Rod": "rod:rod",
    "workflow.study:Study": "text:study",
    "workflow.vibration.under_masses:ModesByMass": "modes:modes_by_mass",
})  # fmt: skip
"""Each result, and what tells it, under this room; any other is told by its facts."""


def text_of(result: object) -> Text:
    """Return the text of a result.

    Raises
    ------
    TypeError
        If it is none.
    """
    found = _teller(result)
    if found is None:
        raise TypeError(f"a {type(result).__name__} is no result that is told")
    return found(result)


def printed(noun: Any) -> str:
    """Return what a command prints of a result; of what is none, what a shell shows."""
    found = _teller(noun)
    if found is None:
        return repr(noun)
    from dashpot.told.screen import shown

    checks = getattr(noun, "weighed", None) or noun.checks
    return "\n".join(shown(found(noun), getattr(noun, "verdict", None), checks))


def _teller(noun: object) -> Callable[[Any], Text] | None:
    kind = type(noun)
    name = f"{kind.__module__.removeprefix('dashpot.')}:{kind.__qualname__}"
    word = _TEXTS.get(name, "lines:by_facts" if isinstance(noun, Judged) and noun.facts else "")
    if not word:
        return None
    module, _, function = word.partition(":")
    found: Callable[[Any], Text] = getattr(import_module(f"dashpot.told.{module}"), function)
    return found
