"""What every command shares: its outcome, files in and out, errors in words, exit codes."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

import dashpot as dp
from dashpot.base.errors import DashpotError, ReadError

if TYPE_CHECKING:
    from dashpot.base.checks import Check

MARKS = {"stop": "!!", "limit": "!", "note": "-"}
"""How the text of a command marks a failed check, by its grade."""

A_FIT = "a fit, as 'dashpot fit FILE -o fit.json' writes it"


class Outcome(NamedTuple):
    """What a command found, for programs and as text for people, and its checks.

    Attributes
    ----------
    found
        A noun of the archive, or a document. It is written when it is asked for: the archive
        knows every noun, and importing all of them takes longer than a fit.
    more
        What only the command knows, beside the noun's document.
    must_pass
        A failed check is this command's own failure, ``--strict`` or not.
    """

    found: object
    text: str
    checks: tuple[Check, ...] = ()
    more: Mapping[str, Any] = {}
    must_pass: bool = False


def reports(function: Callable[..., Outcome]) -> Callable[..., None]:
    """Give a command ``--json`` and ``--strict``, and turn its outcome into output and exit code.

    stdout gets the text or, with ``--json``, one JSON document and nothing else. An error of
    dashpot's own becomes one sentence on stderr and exit code 2; any other is a bug and shows.
    """

    @click.option("--json", "as_json", is_flag=True, help="Print one JSON document, SI units.")
    @click.option(
        "--strict", is_flag=True, help="Exit with 1 if a check failed that limits the use."
    )
    @functools.wraps(function)
    def command(*, as_json: bool, strict: bool, **arguments: Any) -> None:
        try:
            outcome = function(**arguments)
            text = printed(outcome.found, outcome.more) if as_json else outcome.text
            if text:
                click.echo(text)
        except DashpotError as error:
            fail(str(error))
        except OSError as error:
            if isinstance(error, BrokenPipeError):
                raise
            where = f"{error.filename}: " if error.filename else ""
            fail(f"{where}{error.strerror or error}")
        weighty = [check for check in outcome.checks if check.failed and check.grade != "note"]
        if (strict or outcome.must_pass) and weighty:
            sys.exit(1)

    return command


def printed(found: object, more: Mapping[str, Any] | None = None) -> str:
    """Return a noun or a document as the JSON that commands print and write."""
    import json

    if not isinstance(found, dict):
        from dashpot.workflow.archive import document

        found = document(found)
    return json.dumps(found | dict(more or {}), indent=2, ensure_ascii=False, allow_nan=False)


def fail(sentence: str) -> None:
    """Say what is wrong on stderr and leave with exit code 2."""
    click.echo(f"dashpot: {sentence}", err=True)
    sys.exit(2)


def to_stderr(message: str) -> None:
    """Print progress and remarks on stderr."""
    click.echo(message, err=True)


def write(path: str, text: str) -> None:
    """Write text to a file and say so; ``-`` is stdout."""
    if path == "-":
        click.echo(text, nl=not text.endswith("\n"))
        return
    Path(path).write_text(text, encoding="utf-8", newline="\n")
    to_stderr(f"wrote {path}")


def failed(checks: Iterable[Check]) -> list[str]:
    """Return one line for each failed check, the gravest first, for the text of a command."""
    bad = [
        (grade, check)
        for grade in MARKS
        for check in checks
        if check.failed and check.grade == grade
    ]
    return [f"  {MARKS[grade]} {check.name}: {check.says}" for grade, check in bad]


def read_fit(path: str) -> dp.Fit:
    """Return the fit in a JSON file, as written by ``dashpot fit -o``; ``-`` is stdin."""
    found = _read(path, hint=f"; expected {A_FIT}")
    if not isinstance(found, dp.Fit):
        raise ReadError(f"{path} holds a {type(found).__name__}; expected {A_FIT}")
    return found


def read_model(path: str) -> dp.GeneralizedMaxwell:
    """Return the solid in a JSON file that holds a fit or a model; ``-`` is stdin."""
    found = _read(path)
    if isinstance(found, dp.Fit):
        return found.model
    if isinstance(found, dp.GeneralizedMaxwell):
        return found
    raise ReadError(f"{path} holds a {type(found).__name__}; expected a fit or a model")


def _read(path: str, *, hint: str = "") -> object:
    try:
        content = sys.stdin.buffer.read() if path == "-" else Path(path).read_bytes()
        return dp.from_json(content.decode())
    except UnicodeDecodeError:
        raise ReadError(f"{path} is not a JSON document: it is not UTF-8 text") from None
    except ReadError as error:
        raise ReadError(f"{path}: {error}{hint}") from None


def is_json(path: str) -> bool:
    """Tell whether a file opens like a JSON object, so that it may be a fit."""
    with Path(path).open("rb") as file:
        return file.read(64).lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{")
