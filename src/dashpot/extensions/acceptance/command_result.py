"""Result of a command with its limits: text, document, page and exit code."""

from __future__ import annotations

from typing import Any

import click

from dashpot import workflow
from dashpot.cli._command_result import CommandResult
from dashpot.extensions.acceptance.accept import read_limits
from dashpot.extensions.acceptance.datamodel import Acceptance, AcceptanceResult
from dashpot.extensions.acceptance.page import render_section
from dashpot.extensions.acceptance.text import render_acceptance

SOURCES = "dashpot.limits"
"""Key of the context under which files and expressions of limits are kept."""


def judge(result: Any) -> Acceptance:
    """Return the acceptance of a result by the limits of the running command."""
    return read_limits(*click.get_current_context().meta[SOURCES]).judge(result)


def judge_result(outcome: CommandResult) -> CommandResult:
    """Return the result of a command with its limits: their lines follow the verdict."""
    acceptance = judge(getattr(outcome.result, "study", outcome.result))
    text = outcome.text
    return outcome._replace(
        result=AcceptanceResult(outcome.result, acceptance),
        text=text._replace(lines=[*render_acceptance(acceptance).lines, *text.lines]),
        unmet=acceptance.word != "meets",
    )


def render_page(result: Any, **figures: Any) -> str:
    """Return the page of a result with the section of its limits."""
    return workflow.html(result, **figures, limits=render_section(judge(result)))
