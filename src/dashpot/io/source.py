"""The bytes of a file, or of stdin, and their hash."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

from dashpot.base.errors import DataError, ReadError
from dashpot.base.escapes import escaped

_BLOCK = 1 << 20
_HELD = 1 << 24
"""Bytes of the largest file that is kept in memory, and so opened once."""


@dataclass(frozen=True)
class Raw:
    """The bytes of a file: held in memory, or (`path` alone) too many for that."""

    name: str
    path: Path | None
    held: bytes = b""

    def open(self) -> BinaryIO:
        """The bytes from the start."""
        return BytesIO(self.held) if self.held or self.path is None else self.path.open("rb")

    def head(self, size: int) -> bytes:
        """The first `size` bytes, or fewer."""
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
        return len(self.held) if self.held or self.path is None else self.path.stat().st_size

    @cached_property
    def sha256(self) -> str:
        """Hash of the raw bytes."""
        digest = hashlib.sha256()
        for block in self.blocks():
            digest.update(block)
        return digest.hexdigest()

    def on_disk(self) -> Path:
        """The path, for readers that need one."""
        if self.path is None:
            raise ReadError(
                "stdin holds a binary format that must be read from a file; give its path"
            )
        return self.path


@contextmanager
def about(name: str) -> Iterator[None]:
    """Put a file's name before what is wrong with it or with its numbers."""
    try:
        yield
    except (ReadError, DataError) as error:
        text = str(error)
        mark = " " if text.startswith("is not a test") else ": "
        raise ReadError(f"{name}{mark}{text}") from None


def open_raw(path: str | Path) -> Raw:
    """Return the file at `path`, or stdin for ``-``.

    Raises
    ------
    ReadError
        If there is no such file, it cannot be read, or it is empty.
    """
    if str(path) == "-":
        raw = Raw("stdin", None, _piped(sys.stdin.buffer))
    else:
        path = Path(path)
        name = escaped(path.name)
        try:
            if path.is_dir():
                raise ReadError(f"{path} is a folder; give the file to read")
            with path.open("rb") as stream:
                if path.is_file() and path.stat().st_size >= _HELD:
                    raw = Raw(name, path)
                else:  # a pipe has no path to be opened again
                    raw = Raw(name, path if path.is_file() else None, stream.read())
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise ReadError(f"{path}: cannot be read: {reason}") from None
    if raw.size == 0:
        raise ReadError(f"{raw.name} is empty (0 bytes); export the test again")
    return raw


@lru_cache(maxsize=1)
def _piped(stream: BinaryIO) -> bytes:
    """What stdin holds; kept, for a pipe can be read only once and a file is looked at twice."""
    return stream.read()


def extra(module: str, package: str, what: str) -> Any:
    """Return an optional package's module, imported when a file needs it.

    Raises
    ------
    ReadError
        If it is not installed, with the command that installs it.
    """
    try:
        return import_module(module)
    except ImportError:
        raise ReadError(
            f'{what} need the package {package}; install it with pip install "dashpot[io]"'
        ) from None
