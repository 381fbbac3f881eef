"""Parent process of the sandbox: starts a child for each file and validates its answer.

A child costs the start of an interpreter, and the parent saves what the foreign library would have
cost to import. With several files in one child, damage by one file would affect the next.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import BinaryIO, TypeVar, cast

from dashpot.base.errors import ReadError
from dashpot.base.subprocesses import get_single_thread_env, interpreter
from dashpot.reading import raw_file
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits, message_protocol

A = TypeVar("A", bound=message_protocol.Reply)
_MARK = "--read-for-dashpot"
CHILD_ENVIRONMENT = {"MALLOC_ARENA_MAX": "1", "POLARS_MAX_THREADS": "1"}
"""Each thread of polars sets aside 64 MB of addresses in an arena: a GiB is full before a file."""
CHILD_OPTIONS = ("sheet", "segment", "format", "rate")
"""Options that a reader in a child process receives."""
_frozen_children: list[str] = []


def frozen_support() -> None:
    """Enable reading in a child process of a frozen program; call it before any parsing.

    A packed program has no interpreter to start, so it starts itself, and this call turns that
    second one into a child.
    """
    if sys.argv[1:] == [_MARK]:
        from dashpot.reading.sandbox.child_process import main

        main()
    _frozen_children[:] = [_MARK]


def run_in_child(
    format_name: str,
    function: Callable[..., A],
    raw: RawFile,
    options: ReadOptions,
    *,
    columns: Sequence[int] | None = None,
) -> A:
    """Return ``function(raw, options)``, run in a process with limits of memory, time and numbers.

    Where `columns` of a large file are requested, the function takes them as its third argument.

    The function reads files of the format `format_name` and stands at the top of a module of
    dashpot; of the options it gets the sheet, the segment and the rate.

    Raises
    ------
    ReadError
        What the function raises there; and where the process dies, or takes too long.
    """
    seconds = raw_file.compute_time_allowed(raw.size)
    request = {
        "format": format_name, "function": [function.__module__, function.__name__],
        "seconds": seconds, "name": raw.name, "path": raw.path and str(raw.path.absolute()),
        "options": {name: getattr(options, name) for name in CHILD_OPTIONS},
        "columns": None if columns is None else [int(index) for index in columns],
    }  # fmt: skip
    timed_out = threading.Event()
    with _child(seconds, timed_out) as child:
        try:
            with suppress(OSError):  # the child is gone; what it left is read below
                _send(child, request, raw)
            reply = _receive_answer(cast("BinaryIO", child.stdout))
        except message_protocol.ProtocolError:
            reply = None
    if reply is None:
        raise ReadError(
            _death(format_name, child.returncode, seconds if timed_out.is_set() else None)
        )
    return cast("A", reply)


def _send(child: subprocess.Popen[bytes], request: dict[str, object], raw: RawFile) -> None:
    stream = cast("BinaryIO", child.stdin)
    message_protocol.send(stream, request, [raw.content])
    stream.close()


def _receive_answer(stream: BinaryIO) -> message_protocol.Reply:
    head = message_protocol.receive(stream)
    if "error" in head:
        raise ReadError("".join(c if c.isprintable() else " " for c in str(head["error"])))
    return message_protocol.receive_answer(stream, head)


@contextmanager
def _child(seconds: float, timed_out: threading.Event) -> Iterator[subprocess.Popen[bytes]]:
    """A child that is killed after a time limit, and in any case at the end of the block."""
    try:
        child = subprocess.Popen(  # noqa: S603
            _command(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=get_single_thread_env() | CHILD_ENVIRONMENT,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )
    except OSError as error:
        raise ReadError(f"no process could be started to read it: {error.strerror}") from None

    def end() -> None:
        timed_out.set()
        child.kill()

    clock = threading.Timer(seconds, end)
    clock.daemon = True
    clock.start()
    try:
        yield child
    finally:
        clock.cancel()
        child.kill()
        for stream in (child.stdin, child.stdout):
            with suppress(OSError):
                cast("BinaryIO", stream).close()
        child.wait()


def _command() -> list[str]:
    if getattr(sys, "frozen", False):
        if not _frozen_children:
            raise ReadError(
                "this packed program cannot start the reader of this format; export the test as "
                "text (its maker: call dashpot.reading.sandbox.parent_process.frozen_support first)"
            )
        return [sys.executable, *_frozen_children]
    return interpreter("dashpot.reading.sandbox.child_process", "-W", "ignore")


def _death(format_name: str, code: int, seconds: float | None) -> str:
    """Return the sentence on a child that gave no answer."""
    if seconds is not None:
        return (
            f"took more than {seconds:.0f} s to read as {format_name}: it is damaged, or unpacks "
            "to far more than a test; export it again, or as text"
        )
    exit_text = f"exit code {code}"
    with suppress(ValueError):
        exit_text = signal.Signals(-code).name
    return (
        f"damaged, or unpacks to more than the {limits.MEMORY >> 30} GiB of memory that reading "
        f"may take: the reader of {format_name} files ended with {exit_text}; export it again, or "
        "as text"
    )
