"""Output to the terminal: safe text, width, colour and progress."""

from __future__ import annotations

import errno
import os
import shutil
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import click

from dashpot.base.plain_text import escape_terminal_text
from dashpot.base.progress import set_progress_listener
from dashpot.text_output.layout import COLUMNS, SIZE, ScreenSize

# Colour and progress.


PROGRESS_DELAY, PROGRESS_PERIOD = 1.0, 0.25
"""Seconds until progress shows, and between its changes."""


MIN_SCREEN = ScreenSize(60, 20)
"""A screen that is smaller scrolls."""
OTHER_LINES = 4
"""Lines that are left for what was recognised and written, and for what comes next."""


def screen() -> ScreenSize:
    """Return the size for which a result is laid out: that of the terminal, if stdout is one."""
    if not getattr(sys.stdout, "isatty", bool)():
        return SIZE
    columns, lines = shutil.get_terminal_size((COLUMNS, SIZE.lines + OTHER_LINES))
    return ScreenSize(
        min(max(columns, MIN_SCREEN.columns), SIZE.columns),
        min(max(lines - OTHER_LINES, MIN_SCREEN.lines), SIZE.lines),
    )


@contextmanager
def progress() -> Iterator[None]:
    """Show on stderr, if that is a terminal, what takes longer than a second."""
    if not getattr(sys.stderr, "isatty", bool)():  # None where it is closed
        yield
        return
    now, over, began = ["working"], threading.Event(), time.monotonic()
    watch = threading.Thread(target=_watch, args=(now, over, began), daemon=True)
    watch.start()
    try:
        with set_progress_listener(lambda what: now.__setitem__(0, what)):
            yield
    finally:
        over.set()
        watch.join()


def _watch(now: list[str], over: threading.Event, began: float) -> None:
    """Write what is being done and for how long, over itself, and wipe it at the end."""
    if over.wait(PROGRESS_DELAY):
        return
    while not over.wait(PROGRESS_PERIOD):
        line = f"{escape_terminal_text(now[0])} ... {time.monotonic() - began:.0f} s"
        sys.stderr.write(f"\r\x1b[K{line[: COLUMNS - 1]}")
        sys.stderr.flush()
    sys.stderr.write("\r\x1b[K")
    sys.stderr.flush()


# Output to the terminal, without control characters.


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
