"""Options of ``dashpot predict`` for stiffness at a frequency."""

from __future__ import annotations

from dashpot.cli._command import CommandOption, opt
from dashpot.cli._param_types import WithUnit


def list_options(kinds: str) -> list[CommandOption]:
    """Return the options of stiffness without a mass."""
    return [
        opt(
            "--frequency",
            type=WithUnit("frequency"),
            multiple=True,
            metavar="FREQUENCY",
            kinds=kinds,
            help="K', K'' and loss factor there; needs no mass.",
        )
    ]
