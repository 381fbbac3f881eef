"""Results as text, the same in the terminal and in Python."""

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
    function = _find_renderer(result)
    if function is None:
        raise TypeError(f"a {type(result).__name__} is no result that is shown")
    return function(result)


def format_result(result: Any) -> str:
    """Return the text that a command prints for a result; its repr if there is no other."""
    function = _find_renderer(result)
    if function is None:
        return repr(result)
    from dashpot.text_output.layout import format_for_screen

    checks = getattr(result, "weighed", None) or result.checks
    return "\n".join(format_for_screen(function(result), getattr(result, "verdict", None), checks))


def _find_renderer(result: object) -> Callable[[Any], Text] | None:
    handler: Callable[[Any], Text] | None = find_handler("text", result)
    if handler is None and isinstance(result, HasVerdict) and result.facts:
        from dashpot.text_output.results import render_facts

        return render_facts
    return handler
