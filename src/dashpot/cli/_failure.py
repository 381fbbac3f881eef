"""Failures of a command: one sentence and an exit code for every exception."""

from __future__ import annotations

import io
import json
import os
import re
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path

import click

from dashpot.base import dataclass, replace
from dashpot.base.errors import DashpotError
from dashpot.base.plain_text import escaped_json
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.version import __version__
from dashpot.cli._terminal import to_stderr, to_stdout
from dashpot.registry import call_handler

BAD_INPUT, FAULT, INTERRUPTED = 2, 3, 130
"""Exit codes: bad input or usage, internal error of dashpot, stopped by the user."""

REPORT_ADDRESS = "the maintainers of the repository that dashpot came from (SECURITY.md there)"
"""Where a fault is reported."""


@dataclass(frozen=True)
class Failure(Serialisable):
    """Failure of a command: its kind, sentence, exit code, output and place."""

    schema = "dashpot/error@2"
    _keys = ("kind", "message", Key("exit_code", "code"), Key("traceback", optional=True))

    kind: str
    message: str
    shown: str
    code: int
    traceback: str | None = None


def report_error(error: BaseException, words: Sequence[str]) -> int:
    """Print the error and return the exit code.

    stderr gets the sentence; stdout, if the words of the command hold ``--json``, one JSON
    document. With ``--traceback`` both say where in the code it happened.
    """
    failure = _classify_error(error)
    traceback_text = (
        "".join(traceback.format_exception(error)) if _has_option("--traceback", words) else ""
    )
    to_stderr(traceback_text + failure.shown)
    if _has_option("--json", words) and sys.stdout is not None:
        document = replace(failure, traceback=traceback_text or None).to_dict()
        to_stdout(escaped_json(json.dumps(document, indent=2, ensure_ascii=False)))
    return failure.code


def _has_option(option: str, words: Sequence[str]) -> bool:
    """Return whether the words contain an option before ``--``, which ends the options."""
    before_separator = list(words)
    return option in (
        before_separator[: before_separator.index("--")]
        if "--" in before_separator
        else before_separator
    )


def _classify_error(error: BaseException) -> Failure:
    kind = type(error).__name__
    if isinstance(error, click.ClickException):
        if isinstance(error, click.NoSuchOption):
            context = error.ctx
            suggestion = context and call_handler(
                "suggest", "option", context.command, context.parent, error.option_name, default=""
            )
            # without click's own suggestions
            error = click.NoSuchOption(
                error.option_name, f"{error.message} {suggestion or ''}".rstrip(), ctx=context
            )
        click_output = io.StringIO()
        error.show(click_output)
        message = _simplify_text(error.format_message())
        screen_text = re.sub(
            "(?m)^Error: ", "dashpot: ", _simplify_text(click_output.getvalue().rstrip("\n"))
        )
        return Failure("UsageError", message, screen_text, error.exit_code)
    if isinstance(error, click.Abort | KeyboardInterrupt):
        text = str(error.__cause__ or error)  # click aborts because of the interrupt
        return _build_failure("Interrupted", text or "interrupted", INTERRUPTED)
    if isinstance(error, DashpotError):
        return _build_failure(kind, f"{error}{_format_example_hint(error.__context__)}", BAD_INPUT)
    if isinstance(error, FileNotFoundError) and error.filename:
        from dashpot.reading.raw_file import missing

        message = missing(os.fsdecode(error.filename)) + _format_example_hint(error)
        return _build_failure("OSError", message, BAD_INPUT)
    if isinstance(error, OSError):
        file_prefix = f"{error.filename}: " if error.filename else ""
        return _build_failure("OSError", f"{file_prefix}{error.strerror or error}", BAD_INPUT)
    if isinstance(error, MemoryError):
        return _build_failure(
            kind, "there is not enough memory for this; give a shorter record", BAD_INPUT
        )
    error_summary = ": ".join((kind, *str(error).splitlines()[:1]))
    message = (
        f"a fault in dashpot {__version__} itself, not in what you typed: {error_summary}. "
        f"Please report it, with the command and, if it may be shown, the file, to "
        f"{REPORT_ADDRESS}; --traceback shows where it happened"
    )
    return _build_failure("InternalError", message, FAULT)


def _simplify_text(message: str) -> str:
    """Return a refusal of click in words that no programmer is needed for."""
    text = re.sub(r"is not a valid integer(?: range)?\b", "is no whole number", message)
    return text.replace("is not a valid float", "is no number")


def _format_example_hint(cause: BaseException | None) -> str:
    """Name the command that writes a missing file, if the how-to pages use it."""
    if isinstance(cause, FileNotFoundError) and cause.filename:
        from dashpot import workflow

        if Path(os.fsdecode(cause.filename)).name in workflow.EXAMPLES:
            return " To write the example of that name: dashpot demo --files --all"
    return ""


def _build_failure(kind: str, message: str, code: int) -> Failure:
    return Failure(kind, message, f"dashpot: {message}", code)
