"""Options of commands on drop tests."""

from __future__ import annotations

from dashpot.cli._command import CommandOption, build_options
from dashpot.extensions.materials.options import DropOptions


def list_of_prediction(kinds: str) -> list[CommandOption]:
    """Return the options of ``dashpot predict`` on drop tests."""
    return [*build_options(DropOptions, kinds=kinds)]
