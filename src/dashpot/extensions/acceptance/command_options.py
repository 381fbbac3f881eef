"""Options for acceptance limits; imports no NumPy, so that help is fast."""

from __future__ import annotations

from typing import Any

import click

from dashpot.cli._command import CommandOption, group, opt
from dashpot.cli._options import RESULT
from dashpot.cli._param_types import File

_SOURCES = "dashpot.limits"
"""Where files and expressions of limits are kept."""


def list_options() -> list[CommandOption]:
    """Return the options that ask for limits."""
    return group(
        RESULT,
        opt("--limits", type=File(), metavar="FILE", multiple=True, expose_value=False,
            callback=_note_limits, help="Acceptance limits (.toml)."),
        opt("--limit", type=str, metavar="TEXT", multiple=True, expose_value=False,
            callback=_note_limits, help="One limit, e.g. 'damping >= 3%'."),
    )  # fmt: skip


def _note_limits(context: click.Context, _: click.Parameter, sources: tuple[str, ...]) -> None:
    """Keep what was typed, and what judges a result by it, for the end of the command."""
    if not sources:
        return
    from dashpot.extensions.acceptance.command_result import judge_result, render_page

    context.meta.setdefault(_SOURCES, []).extend(sources)
    context.meta["dashpot.judge"] = judge_result
    context.meta["dashpot.page"] = render_page


def get_sources(context: click.Context) -> tuple[str, ...]:
    """Return the files and expressions that were typed."""
    sources: list[Any] = context.meta[_SOURCES]
    return tuple(sources)
