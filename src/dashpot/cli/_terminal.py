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
from dashpot.text_output.layout import COLUMNS, DEFAULT_SIZE, ScreenSize

# Colour and progress.


PROGRESS_DELAY, PROGRESS_PERIOD = 1.0, 0.25
"""Seconds until progress shows, and between its changes."""


MIN_SCREEN = ScreenSize(60, 20)
"""A screen that is smaller scrolls."""
OTHER_LINES = 4
"""Lines reserved for the recognised kinds, the written files and the next commands."""


def get_screen_size() -> ScreenSize:
    """Return the size for which a result is laid out: that of the terminal, if stdout is one."""
    if not getattr(sys.stdout, "isatty", bool)():
        return DEFAULT_SIZE
    columns, lines = shutil.get_terminal_size((COLUMNS, DEFAULT_SIZE.lines + OTHER_LINES))
    return ScreenSize(
        min(max(columns, MIN_SCREEN.columns), DEFAULT_SIZE.columns),
        min(max(lines - OTHER_LINES, MIN_SCREEN.lines), DEFAULT_SIZE.lines),
    )


@contextmanager
def show_progress() -> Iterator[None]:
    """Show progress on stderr, if that is a terminal, of work longer than a second."""
    if not getattr(sys.stderr, "isatty", bool)():  # None where it is closed
        yield
        return
    current_task, is_over, start = ["working"], threading.Event(), time.monotonic()
    display = threading.Thread(
        target=_display_progress, args=(current_task, is_over, start), daemon=True
    )
    display.start()
    try:
        with set_progress_listener(lambda what: current_task.__setitem__(0, what)):
            yield
    finally:
        is_over.set()
        display.join()


def _display_progress(current_task: list[str], is_over: threading.Event, start: float) -> None:
    """Show the current step and its duration in one line, and erase it at the end."""
    if is_over.wait(PROGRESS_DELAY):
        return
    while not is_over.wait(PROGRESS_PERIOD):
        line = f"{escape_terminal_text(current_task[0])} ... {time.monotonic() - start:.0f} s"
        sys.stderr.write(f"\r\x1b[K{line[: COLUMNS - 1]}")
        sys.stderr.flush()
    sys.stderr.write("\r\x1b[K")
    sys.stderr.flush()


# Output to the terminal, without control characters.


def to_stdout(text: str) -> None:
    """Print a result on stdout."""
    _print_text(text, err=False)


def to_stderr(message: str) -> None:
    """Print progress, remarks and errors on stderr."""
    _print_text(message, err=True)


def _print_text(text: str, *, err: bool) -> None:
    stream = sys.stderr if err else sys.stdout
    if stream is None and not err:
        raise OSError(errno.EBADF, "stdout is closed, and the result with it", "stdout")
    safe_text = escape_terminal_text(text.removesuffix("\n"), colours=True)
    # an alphabet that lacks a sign prints its escape
    encoding = getattr(stream, "encoding", None) or "utf-8"
    click.echo(
        safe_text.encode(encoding, "backslashreplace").decode(encoding),
        err=err,
        color=_get_colour_choice(),
    )


def _get_colour_choice() -> bool | None:
    """Return False if colour is switched off, None if click decides by the terminal."""
    is_colourless = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return False if is_colourless else None
