"""Raw bytes of a file or of stdin, their hash, and a time limit on reading them."""

from __future__ import annotations

import hashlib
import os
import select
import stat
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cached_property, lru_cache
from importlib import import_module
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO

from dashpot.base import dataclass
from dashpot.base.errors import DataError, ReadError
from dashpot.base.plain_text import escape_terminal_text
from dashpot.registry import format_install_command

# Time limit of reading a file.


_MIN_SECONDS = 30.0
_MAX_SECONDS = 600.0
_ROWS_SHARE = 2 / 3
"""Part of that time for the rows of a text; the rest is for what is made of them."""
_BYTES_PER_SECOND = 1e6
"""Bytes per second that the slowest reader of a large file makes."""


def compute_time_allowed(size: int) -> float:
    """Return the time limit of reading a number of bytes."""
    return min(max(_MIN_SECONDS, size / _BYTES_PER_SECOND), _MAX_SECONDS)


class TimeBudget:
    """Time limit of parsing a file in this process, as in a child process.

    All that reads a file shares it, however often its rows are read.

    Parameters
    ----------
    size : int, optional
        Bytes of the file; of one that is not known, as much as the largest may cost.
    """

    def __init__(self, size: int | None) -> None:
        self._max_time = _ROWS_SHARE * (
            _MAX_SECONDS if size is None else compute_time_allowed(size)
        )
        self._spent_time = self._start_time = 0.0
        self._line_number = 1

    @contextmanager
    def count_time_spent(self) -> Iterator[None]:
        """Count the time spent in the block."""
        self._start_time = time.thread_time()
        try:
            yield
        finally:
            self._spent_time += time.thread_time() - self._start_time

    def check_time_limit(self, line: int) -> None:
        """Raise a ReadError if it is spent at a line.

        Raises
        ------
        ReadError
            With what to do.
        """
        self._line_number = max(line, self._line_number)
        if self._spent_time + time.thread_time() - self._start_time > self._max_time:
            raise ReadError(
                f"took more than {self._max_time:.0f} s to read up to line {self._line_number}: "
                "rows with grouped thousands, or with text between them, are read one by one; "
                "export the file without either, or split it"
            )


# Bytes and hash.


_BLOCK = 1 << 18
"""Bytes read at once: their numbers fit in a processor's cache."""
_MAX_FOLDER_NAMES = 10_000
"""Largest number of names of a folder searched for a missing file."""
_MAX_IN_MEMORY = 1 << 24
"""Bytes of the largest file kept in memory, and so opened once."""
MAX_PIPE_SIZE = 1 << 29
"""Bytes that may come through a pipe: they are held in memory."""
PIPE_TIMEOUT = 30
"""Seconds that a pipe may bring nothing."""


@dataclass(frozen=True)
class RawFile:
    """Bytes of a file: in memory, or (`path` alone) on disk if too many."""

    name: str
    path: Path | None
    content: bytes = b""

    def open(self) -> BinaryIO:
        """Return the bytes from the start."""
        return BytesIO(self.content) if self.content or self.path is None else self.path.open("rb")

    def head(self, size: int) -> bytes:
        """Return the first `size` bytes, or fewer."""
        with self.open() as stream:
            return stream.read(size)

    def blocks(self) -> Iterator[bytes]:
        """All bytes, a block at a time."""
        with self.open() as stream:
            while block := stream.read(_BLOCK):
                yield block

    @cached_property
    def size(self) -> int:
        """Bytes in all."""
        return len(self.content) if self.content or self.path is None else self.path.stat().st_size

    @cached_property
    def patience(self) -> TimeBudget:
        """Time budget to read it in this process."""
        return TimeBudget(self.size)

    @cached_property
    def sha256(self) -> str:
        """Hash of the raw bytes."""
        digest = hashlib.sha256(self.content)
        for block in () if self.content else self.blocks():
            digest.update(block)
        return digest.hexdigest()


@contextmanager
def add_name_to_errors(name: str) -> Iterator[None]:
    """Context manager that adds the name of the file to error messages."""
    try:
        yield
    except (ReadError, DataError) as error:
        text = str(error)
        separator = " " if text.startswith("is not a test") else ": "
        raise ReadError(f"{name}{separator}{text}") from None


def looks_like_json(head: bytes) -> bool:
    """Return whether the first bytes of a file open a JSON object."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{")


def open_raw(path: str | Path) -> RawFile:
    """Return the file at `path`, or stdin for ``-``.

    Raises
    ------
    ReadError
        If there is no such file, it cannot be read, it is empty, or it is a pipe without end.
    """
    if str(path) == "-" and sys.stdin is None:
        raise ReadError("stdin is closed; give the path of a file")
    try:
        raw = (
            RawFile("stdin", None, _stdin(sys.stdin.buffer))
            if str(path) == "-"
            else _open_path(Path(path))
        )
    except (FileNotFoundError, NotADirectoryError):
        raise ReadError(missing(path)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ReadError(f"{path}: cannot be read: {reason}") from None
    if raw.size == 0:
        raise ReadError(f"{raw.name} is empty (0 bytes); save it again")
    return raw


def missing(path: str | Path) -> str:
    """Return the message for a missing file or folder, with similar names."""
    from difflib import get_close_matches  # few need it, and it costs time to import

    missing_path = Path(path)
    missing_parent = next(
        (parent for parent in reversed(missing_path.parents) if not parent.is_dir()), None
    )
    if missing_parent is not None:
        return f"{missing_path}: there is no folder {missing_parent}. Check the path."
    try:
        with os.scandir(missing_path.parent) as result:
            extras = [
                entry.name for entry in islice(result, _MAX_FOLDER_NAMES) if entry.name[:1] != "."
            ]
    except OSError:
        extras = []
    names_by_lower_case = {name.casefold(): name for name in extras}
    close_names = get_close_matches(missing_path.name.casefold(), names_by_lower_case, 1)
    suggestion = (
        "Did you mean "
        f"{escape_terminal_text(str(missing_path.with_name(names_by_lower_case[close_names[0]])))}?"
        if close_names
        else ""
    )
    return (
        f"{missing_path}: there is no such file or folder. "
        f"{suggestion or 'Give one that is there.'}"
    )


def _open_path(path: Path) -> RawFile:
    status, name = path.stat(), escape_terminal_text(path.name)
    mode = status.st_mode
    if stat.S_ISFIFO(mode):  # it has no path to be opened again
        return RawFile(name, None, _fifo(path, (status.st_dev, status.st_ino)))
    if not stat.S_ISREG(mode):
        noun = "folder" if stat.S_ISDIR(mode) else "socket" if stat.S_ISSOCK(mode) else "device"
        raise ReadError(f"{path} is a {noun}; give the file to read")
    _keep_what_is_freed()
    with path.open("rb") as stream:
        return RawFile(name, path, b"" if status.st_size >= _MAX_IN_MEMORY else stream.read())


@lru_cache(maxsize=1)
def _keep_what_is_freed() -> None:
    """Free one large piece of memory that nothing was written to.

    From then on the C library of Linux keeps smaller ones for what is asked next. Given back and
    taken anew for every record, their pages cost up to a third of reading it.
    """
    bytes(_MAX_IN_MEMORY)


@lru_cache(maxsize=1)
def _stdin(stream: BinaryIO) -> bytes:
    """Return the bytes of stdin; kept, for a pipe can be read only once."""
    return _read_pipe(stream, "stdin")


@lru_cache(maxsize=8)
def _fifo(path: Path, _one: tuple[int, int]) -> bytes:
    """Return the bytes of a pipe, kept while it exists; its writer may never come."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    os.set_blocking(descriptor, True)
    with os.fdopen(descriptor, "rb") as stream:
        return _read_pipe(stream, escape_terminal_text(path.name))


def _read_pipe(stream: BinaryIO, name: str) -> bytes:
    """Return all that a pipe brings, if it ends."""
    parts, size = [], 0
    while block := _next_block(stream, name):
        parts.append(block)
        size += len(block)
        if size > MAX_PIPE_SIZE:
            raise ReadError(
                f"{name} brings more than {MAX_PIPE_SIZE >> 20} MiB through a pipe; save it as a "
                "file and give its path"
            )
    return b"".join(parts)


def _next_block(stream: BinaryIO, name: str) -> bytes:
    """The next bytes of a pipe, waited for so long and no longer; of anything else at once."""
    with suppress(OSError, AttributeError):  # no descriptor, as in a test; no poll, as on Windows
        mode = os.fstat(stream.fileno()).st_mode
        waiting = select.poll()
        waiting.register(stream, select.POLLIN)
        if (stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)) and not waiting.poll(1000 * PIPE_TIMEOUT):
            raise ReadError(
                f"{name} is a pipe into which nothing was written for {PIPE_TIMEOUT} s; "
                "save the test as a file and give its path"
            )
    block: bytes = stream.read1(_BLOCK)  # type: ignore[attr-defined]
    return block


def import_extra(module: str, package: str, subject: str) -> Any:
    """Return an optional package's module, imported when a file needs it.

    Raises
    ------
    ReadError
        If it is not installed, with the command that installs it.
    """
    try:
        return import_module(module)
    except ImportError:
        advice = format_install_command("io")
        raise ReadError(
            f"{subject} need the package {package}; install it with: {advice}"
        ) from None
