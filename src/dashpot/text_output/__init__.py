"""What people are told of each result, as text: the same in a terminal and in Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from dashpot.base.result_mixins import HasVerdict
from dashpot.registry import find_handler

if TYPE_CHECKING:
    from dashpot.text_output.layout import Text


def render_text(result: object) -> Text:
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


def format_result(noun: Any) -> str:
    """Return what a command prints of a result; of what is none, what a shell shows."""
    found = _teller(noun)
    if found is None:
        return repr(noun)
    from dashpot.text_output.terminal_layout import format_for_screen

    checks = getattr(noun, "weighed", None) or noun.checks
    return "\n".join(format_for_screen(found(noun), getattr(noun, "verdict", None), checks))


def _teller(noun: object) -> Callable[[Any], Text] | None:
    handler: Callable[[Any], Text] | None = find_handler("text", noun)
    if handler is None and isinstance(noun, HasVerdict) and noun.facts:
        from dashpot.text_output.frequency_table import render_facts

        return render_facts
    return handler
