"""What people are told of each result, as text: the same in a terminal and in Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from dashpot.base.result_mixins import Judged

if TYPE_CHECKING:
    from dashpot.text_output.layout import Text

_TEXTS: Mapping[str, str] = MappingProxyType({
    "extensions.door.closing_result:ClosingResult": "extensions.door.closing_text:closed",
    "extensions.door.result:DoorResult": "extensions.door.text:door",
    "extensions.materials.cld.fit_files:Pieces": "extensions.materials.cld.text:cld",
    "extensions.materials.hyperelastic.datamodel:HyperelasticFit": (
        "extensions.materials.hyperelastic.text:hyperelastic"
    ),
    "extensions.materials.indentation.datamodel:IndentationFit": "text_output.results:indentation",
    "extensions.amplitude.hits_by_amplitude:HitLevels": "text_output.results:amplitude",
    "extensions.amplitude.level_results:LevelFit": "text_output.results:amplitude",
    "extensions.amplitude.datamodel:AmplitudeFit": "text_output.results:amplitude",
    "extensions.batch.comparison:LotComparison": "text_output.frequency_table:plainly",
    "planning.plan:Plan": "text_output.frequency_table:plainly",
    "datamodel.fit:Fit": "text_output.results:fit",
    "workflow.vibration.impact_tests:Agreement": "text_output.results:agreement",
    "workflow.vibration.impact_tests:Identified": "text_output.identification:identified",
    "workflow.vibration.impact_tests:ImpactResult": "text_output.results:impact",
    "extensions.amplitude.fit_files:Levels": "text_output.results:levels",
    "extensions.modes.measured_modes:MeasuredModes": "text_output.modes:modes",
    "workflow.response.frf_prediction:Prediction": "text_output.results:prediction",
    "extensions.materials.rod.fit_files:Rod": "extensions.materials.rod.text:rod",
    "workflow.study:Study": "text_output.results:study",
    "extensions.modes.mass_series_files:ModesByMass": "text_output.modes:modes_by_mass",
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
    from dashpot.text_output.terminal_layout import shown

    checks = getattr(noun, "weighed", None) or noun.checks
    return "\n".join(shown(found(noun), getattr(noun, "verdict", None), checks))


def _teller(noun: object) -> Callable[[Any], Text] | None:
    kind = type(noun)
    name = f"{kind.__module__.removeprefix('dashpot.')}:{kind.__qualname__}"
    word = _TEXTS.get(
        name,
        "text_output.frequency_table:by_facts" if isinstance(noun, Judged) and noun.facts else "",
    )
    if not word:
        return None
    module, _, function = word.partition(":")
    found: Callable[[Any], Text] = getattr(import_module(f"dashpot.{module}"), function)
    return found
