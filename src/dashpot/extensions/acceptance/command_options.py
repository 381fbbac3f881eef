"""Options for acceptance limits; the judging functions are imported only if an option is typed."""

from __future__ import annotations

import click

from dashpot.cli._command import group, mark_advanced, opt
from dashpot.cli._options import RESULT
from dashpot.cli._param_types import File


def note_limits(source: str) -> str:
    """Store a file or an expression of limits in the context of the command, and return it.

    With it are stored the functions that judge and render the result at the end of the command.
    As the type of an option it runs only where the option is typed.
    """
    from dashpot.extensions.acceptance.accept import read_limits
    from dashpot.extensions.acceptance.command_result import SOURCES, judge_result, render_page

    read_limits(source)
    meta = click.get_current_context().meta
    meta.setdefault(SOURCES, []).append(source)
    meta |= {"dashpot.judge": judge_result, "dashpot.page": render_page}
    return source


OPTIONS = group(
    RESULT,
    mark_advanced(opt(
        "--limits", type=note_limits, metavar="FILE", multiple=True, expose_value=False,
        shell_complete=File().shell_complete, help="Acceptance limits (.toml).",
    )),
    opt("--limit", type=note_limits, metavar="LIMIT", multiple=True, expose_value=False,
        help="One limit, e.g. 'damping >= 3%'."),
)  # fmt: skip
"""Options for limits."""
