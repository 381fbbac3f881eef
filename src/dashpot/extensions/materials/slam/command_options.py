"""Options of commands on slams."""

from __future__ import annotations

from dashpot.cli._command import Opt, of
from dashpot.extensions.materials.slam.options import SlamAsked


def list_of_prediction(kinds: str) -> list[Opt]:
    """Return the options of ``dashpot predict`` on slams."""
    return [*of(SlamAsked, kinds=kinds)]
