"""Parsers that misbehave, for a child process to run."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

import numpy as np

from dashpot.base.errors import DataError
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits
from dashpot.reading.table import Column, FileTable, Question, make_loader


class Panic(BaseException):
    """As Rust's panics arrive in Python: no Exception."""


def behaves(raw: RawFile, options: ReadOptions) -> FileTable:
    """A table of the bytes of the file, with something in every field."""
    values = np.frombuffer(raw.head(raw.size), np.uint8).astype(float).reshape(-1, 2)
    return FileTable(
        "bytes",
        (Column("even", "N"), Column("odd \ud800\x1b", None, "clock")),
        make_loader(np.where(values == 0, np.nan, values), (0, 1), ("", "second")),
        header=("# a",), notes=(str(options.sheet), str(options.segment)), simulated=True,
        questions=(Question("which?", "--that"),), hints=("hint",),
    )  # fmt: skip


def prints(raw: RawFile, options: ReadOptions) -> dict[str, bytes]:
    print("not the answer")
    os.write(1, b"neither")
    return {"a": b"1", "b": b"", "threads": os.environ["OPENBLAS_NUM_THREADS"].encode()}


def refuses(raw: RawFile, options: ReadOptions) -> FileTable:
    raise DataError("force \x1b[31mis missing")


def panics(raw: RawFile, options: ReadOptions) -> FileTable:
    raise Panic("index out of bounds")


def aborts(raw: RawFile, options: ReadOptions) -> FileTable:
    os.abort()


def is_killed(raw: RawFile, options: ReadOptions) -> FileTable:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def leaves(raw: RawFile, options: ReadOptions) -> FileTable:
    sys.stdin.close()
    os._exit(3)


def hangs(raw: RawFile, options: ReadOptions) -> FileTable:
    """Hang, and say so in the file that the name of the sheet names."""
    if options.sheet:
        Path(options.sheet).write_text(str(os.getpid()))
    time.sleep(600)
    raise AssertionError


def selects_without_memory(raw: RawFile, options: ReadOptions) -> FileTable:
    """What NumPy raises where it has no memory to select rows."""
    raise SystemError("error return without exception set")


def eats(raw: RawFile, options: ReadOptions) -> FileTable:
    return {"much": bytes(2 * limits.MEMORY)}  # type: ignore[return-value]


def pours(raw: RawFile, options: ReadOptions) -> dict[str, bytes]:
    """As many bytes as the name of the sheet says."""
    return {"much": bytes(int(options.sheet or 0))}


def _sends(junk: bytes) -> None:
    for descriptor in range(3, 20):  # whichever is the parent's ear
        try:
            os.write(descriptor, junk)
        except OSError:
            continue
    os._exit(0)


def lies(raw: RawFile, options: ReadOptions) -> FileTable:
    """Whatever bytes the file holds stand for the answer."""
    _sends(raw.head(raw.size))
    raise AssertionError
