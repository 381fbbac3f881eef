"""Options of ``dashpot fit`` on blank tests; imports no NumPy, so that help is fast."""

from __future__ import annotations

from dashpot.cli._command import CommandOption, group, mark_advanced, opt
from dashpot.cli._param_types import ChoiceWithSuggestion, Scoped, WithUnit

_BLANK = "blank"


def list_groups() -> list[list[CommandOption]]:
    """Return the options of blank tests."""
    return [
        mark_advanced(
            group(
                "Blank tests",
                opt(
                    "--spring-stiffness",
                    type=WithUnit("stiffness"),
                    metavar="STIFFNESS",
                    kinds=_BLANK,
                    help="Known stiffness of the steel spring, e.g. 1N/mm.",
                ),
                opt(
                    "--spring-error",
                    type=WithUnit("strain"),
                    metavar="SHARE",
                    kinds=_BLANK,
                    help="Its standard error (0.1%).",
                ),
                opt(
                    "--role",
                    "roles",
                    type=Scoped(ChoiceWithSuggestion(("stop", "spring", "empty"))),
                    multiple=True,
                    metavar="FILE:ROLE",
                    kinds=_BLANK,
                    help="Role of a file, if its record shows none.",
                ),
            )
        )
    ]
