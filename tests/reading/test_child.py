"""A foreign parser in a child process: whatever becomes of it, a table or a sentence."""

from __future__ import annotations

import json
import os
import signal
import struct
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from kit import misbehaving

from dashpot.base.errors import ReadError
from dashpot.reading import raw_file
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits, parent_process
from dashpot.reading.sandbox.parent_process import run_in_child

RAW = RawFile("a.bin", None, bytes(range(8)))


def run(function, raw: RawFile = RAW, options: ReadOptions | None = None):
    return run_in_child("junk", function, raw, options or ReadOptions())


def children() -> set[str]:
    """Processes whose parent is this one, the dead and unburied among them."""
    result: set[str] = set()
    for path in Path(f"/proc/{os.getpid()}/task").iterdir():
        # a thread may end between being listed and being asked
        with suppress(FileNotFoundError, ProcessLookupError):
            result.update((path / "children").read_text().split())
    return result


def test_a_table_comes_through_whole() -> None:
    options = ReadOptions(sheet="Data", segment=2)
    here, there = misbehaving.behaves(RAW, options), run(misbehaving.behaves, options=options)
    for name in vars(here):
        if name != "load":
            assert getattr(there, name) == getattr(here, name), name
    for indexes in ([0, 1], [1]):
        a, b = here.load(indexes), there.load(indexes)
        np.testing.assert_array_equal(a.values, b.values)
        assert a.values.flags["C_CONTIGUOUS"] == b.values.flags["C_CONTIGUOUS"]
        assert (a.starts, a.segments, a.lines, a.notes) == (b.starts, b.segments, b.lines, b.notes)


def test_a_large_file_is_read_from_its_place(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(RAW.content)
    process = run(misbehaving.behaves, RawFile("a.bin", path))
    np.testing.assert_array_equal(process.load([1]).values[:, 0], [1, 3, 5, 7])


def test_what_a_library_prints_is_not_the_answer() -> None:
    assert run(misbehaving.prints) == {"a": b"1", "b": b"", "threads": b"1"}


@pytest.mark.parametrize(
    ("function", "sentence"),
    [
        (misbehaving.refuses, r"^force  \[31mis missing$"),
        (misbehaving.panics, "a broken or unknown variety of junk: Panic: index out of bounds; "),
        (misbehaving.aborts, "the reader of junk files ended with SIGABRT; export it again"),
        (misbehaving.is_killed, "ended with SIGKILL"),
        (misbehaving.leaves, "ended with exit code 3"),
        (misbehaving.eats, "takes more than 1 GiB of memory to read as junk; export a part"),
        (misbehaving.selects_without_memory, "takes more than 1 GiB of memory to read as junk"),
    ],
)
def test_whatever_it_does_is_a_sentence(function, sentence: str) -> None:
    before = children()
    with pytest.raises(ReadError, match=sentence):
        run(function)
    assert children() == before


def test_more_numbers_than_a_test_has_are_refused_and_no_fewer() -> None:
    most = run(misbehaving.pours, options=ReadOptions(sheet=str(limits.MAX_SIZE)))
    assert len(most["much"]) == limits.MAX_SIZE
    with pytest.raises(ReadError, match="33554433 numbers in all, and at most 33554432 are read"):
        run(misbehaving.pours, options=ReadOptions(sheet=str(limits.MAX_SIZE + 8)))


def test_slow_parser_is_terminated(monkeypatch: pytest.MonkeyPatch) -> None:
    assert raw_file.compute_time_allowed(0) == raw_file.compute_time_allowed(30_000_000) == 30
    assert raw_file.compute_time_allowed(40_000_000) == 40
    assert (
        raw_file.compute_time_allowed(600_000_000) == raw_file.compute_time_allowed(1 << 40) == 600
    )
    monkeypatch.setattr(raw_file, "compute_time_allowed", lambda size: 0.5)
    before = children()
    with pytest.raises(ReadError, match="took more than 0 s to read as junk: it is damaged"):
        run(misbehaving.hangs)
    assert children() == before


HEAD = {
    "format": "f", "rows": 1, "starts": [0], "segments": [""], "questions": [],
    "columns": [["a", None, "number", ""]],
    "simulated": False, "notes": [], "header": [], "hints": [], "cautions": [],
}  # fmt: skip


def answer(head: object, more: bytes = b"") -> bytes:
    text = json.dumps(head).encode()
    return struct.pack("<Q", len(text)) + text + more


@pytest.mark.parametrize(
    "junk",
    [
        b"",
        b"\0" * 8,
        struct.pack("<Q", 1 << 60),
        struct.pack("<Q", 9) + b"[" * 9,
        struct.pack("<Q", 1 << 20) + b"[" * (1 << 20),
        answer([1]),
        answer({}),
        answer(HEAD, b"1234567"),
        answer(HEAD | {"rows": 1 << 40}),
        answer(HEAD | {"rows": -1}),
        answer(HEAD | {"rows": True}, bytes(8)),
        answer(HEAD | {"starts": [0, 2], "segments": ["", ""]}, bytes(8)),
        answer(HEAD | {"starts": [], "segments": []}, bytes(8)),
        answer(HEAD | {"columns": [["a", None, "code", ""]]}, bytes(8)),
        answer(HEAD | {"columns": [["a", 1, "number", ""]]}, bytes(8)),
        answer(HEAD | {"columns": [["a", None, "number", 1]]}, bytes(8)),
        answer(HEAD | {"cautions": ["a"]}, bytes(8)),
        answer(HEAD | {"columns": [["a"]]}, bytes(8)),
        answer(HEAD | {"notes": "abc"}, bytes(8)),
        answer(HEAD | {"questions": [[1, 2]]}, bytes(8)),
        answer({"texts": [["a", 1 << 40]]}),
        answer({"texts": [[1, 1]]}, b"a"),
        answer({"texts": 3}),
    ],
)
def test_a_child_that_is_led_astray_is_not_believed(junk: bytes) -> None:
    with pytest.raises(ReadError, match="the reader of junk files ended"):
        run(misbehaving.lies, RawFile("a", None, junk or b"\0"))
    assert run(misbehaving.lies, RawFile("a", None, answer(HEAD, bytes(8)))).load([0]).values == 0


def test_parser_processes_run_in_many_threads() -> None:
    with ThreadPoolExecutor(4) as pool:
        result = list(pool.map(run, [misbehaving.behaves] * 8))
    assert {table.format for table in result} == {"bytes"}


def test_the_keyboard_ends_parent_and_child(tmp_path: Path) -> None:
    mark = tmp_path / "pid"
    code = (
        "import signal\n"
        "from kit import misbehaving\n"
        "from dashpot.reading.sandbox.parent_process import run_in_child\n"
        "from dashpot.reading.read_options import ReadOptions\n"
        "from dashpot.reading.raw_file import RawFile\n"
        # what runs in the background may have been set to ignore the keyboard
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"options = ReadOptions(sheet={str(mark)!r})\n"
        "run_in_child('junk', misbehaving.hangs, RawFile('a', None, b'1'), options)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stderr=subprocess.PIPE, start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    ) as parent:  # fmt: skip
        while not (mark.exists() and mark.read_text()):
            assert parent.poll() is None
            time.sleep(0.01)
        os.killpg(parent.pid, signal.SIGINT)
        _, message = parent.communicate()
    assert b"KeyboardInterrupt" in message
    assert not Path(f"/proc/{mark.read_text()}").exists()


def test_a_packed_program_starts_itself(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """As PyInstaller's: its executable takes no option of Python."""
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    with pytest.raises(ReadError, match="this packed program cannot start the reader"):
        run(misbehaving.behaves)
    program = tmp_path / "program"
    path = os.pathsep.join(sys.path)
    program.write_text(
        f"#!/bin/sh\nPYTHONPATH='{path}' exec {sys.executable} -c 'from "
        "dashpot.reading.sandbox.parent_process "
        'import frozen_support; frozen_support()\' "$@"\n'
    )
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program))
    monkeypatch.setattr(parent_process, "_frozen_children", [])
    parent_process.frozen_support()
    assert run(misbehaving.behaves).format == "bytes"
