"""Recording to a file that the readers take, flushed every second."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Self

from dashpot.base.errors import ReadError
from dashpot.base.file_writing import lock
from dashpot.base.number_format import format_count
from dashpot.base.plain_text import escape_formula, format_csv_comment
from dashpot.base.version import __version__
from dashpot.extensions.acquisition.recorder import Block, Description, Recorder

SYNC_INTERVAL = 1.0
"""Period of writing to the disk, s."""


def record(
    recorder: Recorder,
    path: str | Path,
    *,
    seconds: float = math.inf,
    replace: bool = False,
    on_block: Callable[[Block], None] | None = None,
) -> tuple[int, tuple[str, ...]]:
    """Write the samples of a recorder to a file, until it ends, is stopped, or `seconds` are over.

    The file is written in place and flushed within a second: if the process is killed, all rows
    until then remain. Meanwhile the operating system's lock on it is held, which ends with the
    process. An existing file is replaced when the first rows arrive.

    Parameters
    ----------
    recorder : Recorder
    path : path
        Text; the columns are the time in s and the channels.
    seconds : float
        By the recorder's clock; of this computer's while nothing comes.
    replace : bool
        Whether a file that exists is written over.
    on_block : callable
        Takes each block when it is in the file.

    Returns
    -------
    rows : int
    notes : tuple of str
        Losses of data; they are also written at the end of the file.

    Raises
    ------
    ReadError
        If the file exists, another process records to it, nothing came, or it cannot be written any
        further; earlier rows are kept.
    OSError
        If it cannot be made.
    """
    start_time, first, rows = time.monotonic(), math.nan, 0
    try:
        with _Log(path, recorder.describe(), replace=replace) as log:
            try:
                for times, values in recorder.blocks():
                    log.add((times, values))
                    rows += len(times)
                    if len(times):
                        first = times[0] if math.isnan(first) else first
                        if on_block is not None:
                            on_block((times, values))
                    elapsed_time = (
                        times[-1] - first if len(times) else time.monotonic() - start_time
                    )
                    if elapsed_time >= seconds:
                        break
            finally:
                recorder.stop()
                notes = recorder.describe().notes
                log.close((f"{format_count(rows, 'row')} recorded", *notes))
    finally:
        recorder.stop()
    if not rows:
        raise ReadError(
            f"nothing came from {recorder.describe().device}{''.join('; ' + n for n in notes)}: is "
            "it on, and are its speed and its columns as said?"
        )
    return rows, notes


class _Log:
    """A file that grows by whole rows."""

    def __init__(self, path: str | Path, device: Description, *, replace: bool) -> None:
        flags = os.O_WRONLY | os.O_CREAT | (0 if replace else os.O_EXCL)
        try:
            self._handle = os.open(path, flags, 0o666)
        except FileExistsError:
            raise ReadError(f"{path} is there already; a record is written to a new file") from None
        self._path, self._sync_time = path, time.monotonic()
        self._head = device
        try:
            if self._is_taken():
                raise ReadError(
                    f"{path}: another dashpot records to this file; stop that one, or give another "
                    "name"
                )
            # an earlier record is replaced when there is something to replace it with
            self._begun = False
            if not os.fstat(self._handle).st_size:
                self._begin()
        except BaseException:
            os.close(self._handle)
            raise

    def _is_taken(self) -> bool:
        try:
            return not lock(self._handle)
        except OSError:  # a file system without locks keeps no record from being made
            return False

    def _begin(self) -> None:
        """Delete the rest of an earlier record, and write the header."""
        if self._begun:
            return
        self._begun = True
        if os.fstat(self._handle).st_size:
            os.ftruncate(self._handle, 0)
        timestamp = datetime.now().astimezone().isoformat(timespec="seconds")
        self._report(f"{self._head.device}; recorded {timestamp} with dashpot {__version__}")
        self._write(",".join(("time [s]", *map(escape_formula, self._head.channels))) + "\n")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._handle)

    def add(self, block: Block) -> None:
        """Write the rows of a block."""
        if not len(block[0]):
            return
        self._begin()
        rows = zip(block[0].tolist(), block[1].tolist(), strict=True)
        self._write("".join(f"{t!r},{','.join(map(repr, row))}\n" for t, row in rows))
        if time.monotonic() - self._sync_time >= SYNC_INTERVAL:
            os.fsync(self._handle)
            self._sync_time = time.monotonic()

    def close(self, notes: tuple[str, ...]) -> None:
        """Report lost samples, and flush the file to the disk."""
        for note in notes if self._begun else ():
            self._report(note)
        os.fsync(self._handle)

    def _report(self, message: str) -> None:
        self._write(f"# {format_csv_comment(message)}\n")

    def _write(self, text: str) -> None:
        remaining_bytes, size = text.encode(), os.fstat(self._handle).st_size
        try:
            while remaining_bytes:
                remaining_bytes = remaining_bytes[os.write(self._handle, remaining_bytes) :]
        except OSError as error:
            # half a number reads as another
            os.ftruncate(self._handle, size)
            raise ReadError(
                f"{self._path} cannot be written any further: {error.strerror}; what came before "
                "stands in it"
            ) from None
