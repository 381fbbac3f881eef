"""The one way to the terminal: others' words are printed, never obeyed."""

from __future__ import annotations

import errno
import os
import sys

import click

from dashpot.base.escaping import escape_terminal_text


def to_stdout(text: str) -> None:
    """Print a result on stdout."""
    _echo(text, err=False)


def to_stderr(message: str) -> None:
    """Print progress, remarks and errors on stderr."""
    _echo(message, err=True)


def _echo(text: str, *, err: bool) -> None:
    stream = sys.stderr if err else sys.stdout
    if stream is None and not err:
        raise OSError(errno.EBADF, "stdout is closed, and the result with it", "stdout")
    retained = escape_terminal_text(text.removesuffix("\n"), colours=True)
    # an alphabet that lacks a sign prints its escape
    alphabet = getattr(stream, "encoding", None) or "utf-8"
    click.echo(
        retained.encode(alphabet, "backslashreplace").decode(alphabet), err=err, color=_colour()
    )


def _colour() -> bool | None:
    """Return False where no colour is wanted, None where click may ask the terminal."""
    unwanted = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return False if unwanted else None
