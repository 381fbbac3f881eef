"""Options of commands on slam tests."""

from __future__ import annotations

from dashpot.cli._command import CommandOption, build_options
from dashpot.extensions.materials.slam.options import SlamOptions


def list_of_prediction(kinds: str) -> list[CommandOption]:
    """Return the options of ``dashpot predict`` on slams."""
    return [*build_options(SlamOptions, kinds=kinds)]
