"""Every reader on whatever bytes, in a process of its own: it may die, and is asked why.

Run as a program this is that process. There foreign parsers run without a child of their own, which
would cost a hundred times the parsing; a mutant at which the process dies is tried again with one,
and must then be a sentence.
"""

from __future__ import annotations

import contextlib
import os
import struct
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import BinaryIO

from dashpot.base.errors import DashpotError, ReadError
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox.parent_process import CHILD_ENVIRONMENT

SECONDS = 10.0
"""Processor time that no mutant may cost."""
_LIMIT, _SANDBOX_LIMIT = 30, 120
"""Wall time over that, after which a process hangs; longer with a child of its own."""
NAMED = ReadOptions(
    time="1", displacement="2", force="3", acceleration=("2",), frequency="1", storage="2",
    loss="3", modulus="2",
    units={
        "time": "s", "displacement": "mm", "force": "N", "acceleration": "g", "frequency": "Hz",
        "storage": "Pa", "loss": "Pa", "modulus": "Pa",
    },
)  # fmt: skip


def read_all(path: Path) -> None:
    """Give a file to every reader, without a word and with all of them."""
    from dashpot.extensions.curves.dynamic.read import read_dynamic
    from dashpot.extensions.curves.modulus.read import read_modulus
    from dashpot.reading.readers.frf import read_frf
    from dashpot.reading.readers.impact import read_impact
    from dashpot.reading.readers.inspect import inspect_file
    from dashpot.reading.readers.relaxation import read_relaxation

    for reader in (
        inspect_file, read_relaxation, read_impact, read_frf, read_dynamic, read_modulus,
    ):  # fmt: skip
        for options in (ReadOptions(), NAMED):
            with contextlib.suppress(ReadError):
                reader(path, options=options)


def calibrate(path: Path) -> None:
    from dashpot.extensions.formats.ati import read_calibration

    with contextlib.suppress(ReadError):
        read_calibration(path)


def profile(path: Path) -> None:
    from dashpot.reading.read_options import load_profile

    with contextlib.suppress(ReadError):
        load_profile(path)


def unpack(path: Path) -> None:
    from dashpot.workflow.json_archive import from_json, to_json

    with contextlib.suppress(DashpotError):
        to_json(from_json(path.read_bytes()))


def hold(path: Path) -> None:
    """Verify the project in a zip file; a study made by hand stands in for the work done again."""
    from dashpot.extensions.projects import project, verification
    from kit.handmade import bench_only

    verification.run = lambda _job: bench_only()
    with tempfile.TemporaryDirectory() as folder, contextlib.suppress(DashpotError):
        with zipfile.ZipFile(path) as packed:
            packed.extractall(folder)
        verification.verify(project.open_project(folder), page=lambda study: study.fit._identity)


TASKS: dict[str, Callable[[Path], None]] = {
    task.__name__: task for task in (read_all, calibrate, profile, unpack, hold)
}


class Fuzzer:
    """The process that reads, begun again whenever it has died; `deaths` counts, and `tries`."""

    def __init__(self) -> None:
        self.deaths = self.tries = 0
        self._process: subprocess.Popen[bytes] | None = None

    def survives(self, task: str, content: bytes) -> None:
        """Fail unless a task ends in a value or a refusal, and soon."""
        self.tries += 1
        message = self._tried(task, content, separate=False)
        if message is None:
            self.deaths += 1
            message = self._tried(task, content, separate=True)
        if message != "":
            place = Path(tempfile.gettempdir()) / f"dashpot-{task}-{os.getpid()}"
            place.write_bytes(content)
            raise AssertionError(f"{message or 'the process died, or was ended'}\n{place}")

    def close(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _tried(self, task: str, content: bytes, *, separate: bool) -> str | None:
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-W", "error", "-m", "kit.fuzzing"], stdin=subprocess.PIPE,
                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                env={**os.environ, **CHILD_ENVIRONMENT, "PYTHONPATH": os.pathsep.join(sys.path)},
            )  # fmt: skip
        # on a busy machine a mutant waits far longer than it works; who works too long is reported
        clock = threading.Timer(
            (_SANDBOX_LIMIT if separate else _LIMIT) * SECONDS, self._process.kill
        )
        clock.start()
        try:
            with contextlib.suppress(OSError):
                _put(self._process.stdin, task.encode(), b"apart" * separate, content)
            result = _got(self._process.stdout, 1)
        finally:
            clock.cancel()
        if result is None:
            self.close()
            return None
        return result[0].decode()


def _put(stream: BinaryIO, *parts: bytes) -> None:
    for part in parts:
        stream.write(struct.pack("<Q", len(part)) + part)
    stream.flush()


def _got(stream: BinaryIO, count: int) -> list[bytes] | None:
    parts = []
    for _ in range(count):
        size = stream.read(8)
        parts.append(stream.read(struct.unpack("<Q", size)[0]) if len(size) == 8 else b"")
        if len(size) < 8:
            return None
    return parts


@dataclass
class _Parsers:
    """What stands in for a child: the parsers in this process or, if `apart`, in one of theirs.

    Each file is parsed once, for all readers.
    """

    child: Callable[..., object]
    separate: bool = False
    parsed: dict[object, object] = field(default_factory=dict)

    def __call__(self, what, function, raw, options, *, columns=None):
        key = function, options.sheet, options.segment, columns and tuple(columns)
        if key not in self.parsed:
            self.parsed[key] = self._parsed(what, function, raw, options, columns)
        if isinstance(self.parsed[key], ReadError):
            raise self.parsed[key]
        return self.parsed[key]

    def _parsed(self, what, function, raw, options, columns):
        from dashpot.reading.sandbox import child_process, message_protocol

        try:
            if self.separate:
                return self.child(what, function, raw, options, columns=columns)
            function = function if columns is None else partial(function, columns=columns)
            narrow = ReadOptions(sheet=options.sheet, segment=options.segment)
            answer = child_process.run_parser(what, function, raw, narrow)
            with Path(os.devnull).open("wb") as out:
                message_protocol.send_reply(out, answer)
        except DashpotError as error:
            return ReadError(str(error))
        return answer


def main() -> None:
    """Answer each file with nothing, or with how it went wrong."""
    import resource

    from dashpot.extensions.formats import workbook
    from dashpot.reading.sandbox import limits, parent_process

    parsers = parent_process.run_in_child = workbook.run_in_child = _Parsers(
        parent_process.run_in_child
    )
    resource.setrlimit(resource.RLIMIT_AS, (limits.MEMORY, limits.MEMORY))
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fuzz"
        while (requested := _got(sys.stdin.buffer, 3)) is not None:
            path.write_bytes(requested[2])
            parsers.separate = bool(requested[1])
            parsers.parsed.clear()
            before, message = time.process_time(), ""
            try:
                TASKS[requested[0].decode()](path)
            except BaseException:  # noqa: BLE001
                message = traceback.format_exc()
            spent = time.process_time() - before
            _put(out, (message or (f"took {spent:.0f} s" if spent > SECONDS else "")).encode())


if __name__ == "__main__":
    main()
