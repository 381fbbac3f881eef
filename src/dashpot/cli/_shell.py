"""What every command shares: outcomes, quantities, errors in words, exit codes."""

from __future__ import annotations

import functools
import math
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from dashpot.base.errors import DashpotError

if TYPE_CHECKING:
    from dashpot.base.checks import Check
    from dashpot.base.units import Dimension


class Outcome(NamedTuple):
    """What a command found: a document for programs, text for people, and its checks.

    The document is made when it is asked for: the archive knows every noun, and importing all of
    them takes longer than a fit.
    """

    document: Callable[[], dict[str, Any]]
    text: str
    checks: tuple[Check, ...] = ()
    must_pass: bool = False  # a failed check is this command's own failure, --strict or not


class Quantity(click.ParamType[Any]):
    """A number with its unit, such as ``104g``; the value passed on is in SI."""

    def __init__(self, dimension: Dimension) -> None:
        self.dimension: Dimension = dimension
        self.name = dimension

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from dashpot.base.units import parse_quantity

        if isinstance(value, float):
            return value
        try:
            return parse_quantity(value, self.dimension)
        except DashpotError as error:
            self.fail(str(error), param, ctx)


class Range(Quantity):
    """Two quantities, such as ``1:50Hz``, in SI."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from dashpot.base.units import parse_range

        if isinstance(value, tuple):
            return value
        try:
            return parse_range(value, self.dimension)
        except DashpotError as error:
            self.fail(str(error), param, ctx)


class Arms(click.ParamType[Any]):
    """A number of Maxwell arms, or ``auto``."""

    name = "auto|N"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "auto" or isinstance(value, int):
            return value
        if not value.isdecimal():
            self.fail(
                f"'{value}' is not a number of arms; expected 'auto', 0, 1, 2, ...", param, ctx
            )
        return int(value)


def reports(function: Callable[..., Outcome]) -> Callable[..., None]:
    """Give a command ``--json`` and ``--strict``, and turn its outcome into output and exit code.

    stdout gets the text or, with ``--json``, one JSON document and nothing else. An error of
    dashpot's own becomes one sentence on stderr and exit code 2; any other is a bug and shows.
    """

    @click.option("--json", "as_json", is_flag=True, help="Print one JSON document, SI units.")
    @click.option("--strict", is_flag=True, help="Exit with 1 if a check failed.")
    @functools.wraps(function)
    def command(*, as_json: bool, strict: bool, **arguments: Any) -> None:
        try:
            outcome = function(**arguments)
            text = printed(outcome.document()) if as_json else outcome.text
            if text:
                click.echo(text)
        except DashpotError as error:
            fail(str(error))
        except OSError as error:
            if isinstance(error, BrokenPipeError):
                raise
            where = f"{error.filename}: " if error.filename else ""
            fail(f"{where}{error.strerror or error}")
        if (strict or outcome.must_pass) and any(not check.passed for check in outcome.checks):
            sys.exit(1)

    return command


def printed(document: dict[str, Any]) -> str:
    """Return a document as the JSON that commands print and write."""
    import json

    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)


def fail(sentence: str) -> None:
    """Say what is wrong on stderr and leave with exit code 2."""
    click.echo(f"dashpot: {sentence}", err=True)
    sys.exit(2)


def said(message: str) -> None:
    """Tell about progress, on stderr."""
    click.echo(message, err=True)


def write(path: str, text: str) -> None:
    """Write text to a file and say so; ``-`` is stdout."""
    if path == "-":
        click.echo(text, nl=not text.endswith("\n"))
        return
    Path(path).write_text(text, encoding="utf-8", newline="\n")
    said(f"wrote {path}")


def failed(checks: Iterable[Check]) -> list[str]:
    """Return one line for each failed check, for the text of a command."""
    return [f"  ! {check.name}: {check.says}" for check in checks if not check.passed]


def finite(value: float | None) -> float | None:
    """Return the number, or None where there is none to tell."""
    return value if value is not None and math.isfinite(value) else None
