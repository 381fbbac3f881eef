"""What people are told of each result, as text: the same in a terminal and in Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from dashpot.base.result_mixins import Judged
from dashpot.registry import find_handler

if TYPE_CHECKING:
    from dashpot.text_output.layout import Text


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
    handler: Callable[[Any], Text] | None = find_handler("text", noun)
    if handler is None and isinstance(noun, Judged) and noun.facts:
        from dashpot.text_output.frequency_table import by_facts

        return by_facts
    return handler
