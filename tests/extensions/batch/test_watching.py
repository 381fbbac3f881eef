"""A watched folder: whatever happens to its files, the table is a batch of those that are still."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from kit.kinds import bench, ramp_and_hold

from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.batch import batch_run
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.batch_run import BatchJob, batch
from dashpot.extensions.batch.folder_watch import POLL_PERIOD, UNCHANGED_SECONDS, watch_batch
from dashpot.extensions.batch.parquet_parts import KEY, SMALL_PART
from dashpot.extensions.batch.process_pool import Executor
from dashpot.extensions.batch.table_row import make_row
from dashpot.reading.read_options import ReadOptions

pytestmark = pytest.mark.once

QUICK = {"arms": 1, "quick": True}
TEXT = bench(ramp_and_hold())


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """An empty folder, and rows that are made in this process."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(batch_run, "open_executor", lambda *_: make_executor())
    folder = Path("rig")
    folder.mkdir()
    return folder


@contextmanager
def make_executor():
    def compute_chunks(chunks, choices):
        for chunk in chunks:
            rows = [make_row(item.entry, item.hashes, choices) | {KEY: item.key} for item in chunk]
            yield chunk, rows

    yield Executor(1, 1, compute_chunks)


class Story:
    """What happens at which second, and the table after it; interrupted at its end."""

    def __init__(self, *acts, choices=None, **requested):
        self.now, self.acts, self.tables = 0.0, list(acts), []
        choices = BatchOptions(**QUICK) if choices is None else choices
        job = BatchJob(("rig",), Path("lot"), choices, jobs=1, **requested)
        self.lot = watch_batch(job, self.refreshed, wait=self.wait, clock=lambda: self.now)

    def refreshed(self, lot):
        outcomes = {Path(output["file"]).stem: output["outcome"] for output in lot.table.to_dicts()}
        self.tables.append((self.now, outcomes))

    def wait(self, seconds):
        if not self.acts:
            raise KeyboardInterrupt
        self.now += seconds
        while self.acts and self.acts[0][0] <= self.now:
            self.acts.pop(0)[1]()


def write(name, text=TEXT, at=0.0):
    return at, lambda: Path("rig", name).write_text(text)


def until(seconds):
    return seconds, lambda: None


def test_a_file_is_fitted_when_it_has_been_still_for_two_seconds(rig):
    (rig / "old.csv").write_text(TEXT)
    story = Story(write("new.csv", at=4 * POLL_PERIOD), until(12 * POLL_PERIOD))
    both = {"old": "fitted", "new": "fitted"}
    # seen first at 0 and at 2 s, and not a beat earlier than still for two
    assert story.tables == [
        (UNCHANGED_SECONDS, {"old": "fitted"}),
        (4 * POLL_PERIOD + UNCHANGED_SECONDS, both),
    ]
    assert story.lot.table.equals(batch("rig", jobs=1, **QUICK).table)


def test_watch_waits_for_a_growing_file_and_refits_a_resumed_one(rig):
    lines = TEXT.splitlines(keepends=True)
    growing = [write("a.csv", "".join(lines[:n]), at=t) for n, t in ((20, 0), (30, 1.5), (40, 3))]
    story = Story(*growing, write("a.csv", at=8.0), until(12.0))
    assert [at for at, _ in story.tables] == [5.0, 10.0]
    assert [entry["a"] for _, entry in story.tables] == ["refused", "fitted"]
    assert story.lot.table.height == 1


def test_names_that_change_and_files_that_go_are_followed(rig):
    for name in "abc":
        (rig / f"{name}.csv").write_text(TEXT)
    story = Story(
        (3.0, lambda: (rig / "a.csv").rename(rig / "z.csv")),
        (7.0, (rig / "b.csv").unlink),
        until(9.0),
    )
    assert [set(result) for _, result in story.tables] == [{*"abc"}, {*"bc"}, {*"bcz"}, {*"cz"}]


def test_what_is_replaced_by_as_many_bytes_of_the_same_time_is_fitted_again(rig):
    path, other = rig / "a.csv", bench(0.9 * ramp_and_hold())[: len(TEXT)].ljust(len(TEXT), "\n")
    path.write_text(TEXT)
    status = path.stat()

    def replace():
        Path("beside").write_text(other)
        Path("beside").replace(path)
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))

    story = Story((3.0, replace), until(7.0))
    assert path.stat().st_size == status.st_size
    assert [at for at, _ in story.tables] == [2.0, 5.0]
    assert story.lot.table["depth_m"][0] == pytest.approx(7.2e-3, rel=1e-3)


def test_watch_retries_an_unreadable_file(rig, monkeypatch):
    (rig / "a.csv").write_text(TEXT)
    opened, locked = Path.open, [True]

    def refuse_open(path, *how, **more):
        if locked and path.name == "a.csv":
            raise PermissionError(13, "Permission denied")
        return opened(path, *how, **more)

    monkeypatch.setattr(Path, "open", refuse_open)
    story = Story((4.0, locked.clear), until(6.0))
    assert story.tables == [(2.0, {"a": "refused"}), (4.0, {"a": "fitted"})]


def test_a_file_that_changes_under_the_fit_is_fitted_when_it_is_still(rig, monkeypatch):
    path = rig / "a.csv"
    path.write_text(TEXT)
    answers = iter([lambda: path.write_text(TEXT + "\n"), lambda: path.write_text(TEXT)])
    made = batch_run.make_row

    @contextmanager
    def interfere(*_):
        next(answers, lambda: None)()
        with make_executor() as engine:
            yield engine

    monkeypatch.setattr(batch_run, "open_executor", interfere)
    assert made is make_row
    story = Story(until(9.0))
    assert [entry["a"] for _, entry in story.tables][-1] == "fitted"
    assert story.tables[0] == (2.0, {"a": "changed"})


def test_watch_keeps_rows_while_the_folder_is_absent(rig):
    (rig / "a.csv").write_text(TEXT)
    story = Story(
        (3.0, lambda: rig.rename("away")),
        (5.0, rig.mkdir),
        (7.0, lambda: (rig.rmdir(), Path("away").rename(rig))),
        until(10.0),
    )
    assert story.tables == [(2.0, {"a": "fitted"})]
    assert "waiting: rig: there is no such file or folder" in Path("lot/batch.log").read_text()


def test_hammers_are_paired_as_they_come(rig):
    (rig / "a.csv").write_text(TEXT)
    story = Story(write("a_hammer.csv", "junk", at=4.0), until(8.0), pair="{stem}_hammer*.csv")
    assert [at for at, _ in story.tables] == [2.0, 6.0]
    assert story.lot.table["hammer"][0] == str(Path("rig", "a_hammer.csv"))


def test_watch_merges_many_single_tests_into_few_parts(rig):
    acts = [write(f"{i:02}.csv", "junk", at=i * POLL_PERIOD) for i in range(2 * SMALL_PART)]
    story = Story(*acts, until(2 * SMALL_PART * POLL_PERIOD + UNCHANGED_SECONDS))
    assert story.lot.table.height == 2 * SMALL_PART
    assert len(list(Path("lot").glob("*.parquet"))) <= SMALL_PART
    assert batch("rig", output="lot", jobs=1, **QUICK).computed == 0


@pytest.fixture
def search_count(monkeypatch):
    """How often the tests in the folder were sought."""
    calls, sought = [], BatchJob.entries
    monkeypatch.setattr(
        BatchJob, "entries", lambda job, **how: (calls.append(1), sought(job, **how))[1]
    )
    return calls


def test_an_idle_folder_is_only_scanned(rig, search_count):
    (rig / "a.csv").write_text(TEXT)
    Story(until(UNCHANGED_SECONDS + POLL_PERIOD))
    before = len(search_count)
    search_count.clear()
    story = Story(write("b.csv", at=40.0), write("a_hammer.csv", at=80.0), until(120.0),
                  pair="{stem}_hammer*.csv")  # fmt: skip
    assert len(search_count) <= 3 * before
    assert [set(result) for _, result in story.tables] == [{"a"}, {*"ab"}, {"b"}, {*"ab"}]
    assert [at for at, _ in story.tables] == [2.0, 42.0, 80.0, 82.0]


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights")
def test_an_idle_folder_notices_what_a_link_leads_to(rig, tmp_path):
    (rig / "day").mkdir()
    (rig / "day" / "a.csv").write_text(TEXT)
    (tmp_path / "elsewhere.csv").write_text(TEXT)
    (rig / "b.csv").symlink_to(tmp_path / "elsewhere.csv")

    def lead_inside():
        (tmp_path / "elsewhere.csv").unlink()
        (tmp_path / "elsewhere.csv").symlink_to(tmp_path / "rig" / "day" / "c.csv")
        (rig / "day" / "c.csv").write_text(TEXT)

    story = Story((20.0, lead_inside), (40.0, (rig / "day" / "c.csv").unlink), until(60.0))
    outside, inside = {"a": "fitted", "b": "refused"}, {"a": "fitted", "b": "fitted"}
    assert story.tables == [
        (2.0, outside), (20.0, {"a": "fitted"}), (22.0, inside), (40.0, {"a": "fitted"})
    ]  # fmt: skip


def test_a_calibration_that_changes_is_followed(rig, search_count):
    (rig / "a.csv").write_text(TEXT)
    table = '[force]\nscale = "{} N/N"\nsource = "certificate"\n'
    Path("cell.toml").write_text(table.format("1.0"))
    reading = ReadOptions(calibration="cell.toml")
    choices = BatchOptions(**QUICK, reading=reading)
    story = Story(
        (20.0, lambda: Path("cell.toml").write_text(table.format("1.1"))), until(30.0),
        choices=choices,
    )  # fmt: skip
    assert [at for at, _ in story.tables] == [2.0, 20.0]


@pytest.mark.parametrize("words", [{"pair": "../hammers/{stem}.csv"}, {"pair": "{lot}*.csv"}])
def test_a_folder_whose_hammers_may_be_anywhere_is_sought_each_time(rig, search_count, words):
    (rig / "a.csv").write_text(TEXT)
    by = r"(?P<lot>a)\.csv"
    Story(until(10.0), label_pattern=by, **words)
    assert len(search_count) >= 20


def test_what_makes_no_sense_is_refused_before_anything_comes(rig):
    for requested, message in (
        ({"label_pattern": "("}, "no regular"),
        ({"pair": "x"}, "in braces"),
    ):
        with pytest.raises(DataError, match=message):
            Story(**requested)
    rig.rmdir()
    with pytest.raises(ReadError, match="rig is no folder"):
        Story()
    assert not Path("lot").exists()


@pytest.mark.once
@pytest.mark.skipif(sys.platform == "win32", reason="a signal ends it")
def test_the_command_keeps_the_page_and_ends_on_a_signal(tmp_path):
    """``dashpot batch --watch`` as it is typed."""
    (tmp_path / "rig").mkdir()
    words = ["batch", "rig", "-o", "lot", "--watch", "--arms", "1", "--quick"]
    typed = [sys.executable, "-m", "dashpot", *words]
    with subprocess.Popen(typed, cwd=tmp_path, stdout=subprocess.PIPE) as running:
        (tmp_path / "rig" / "a.csv").write_text(TEXT)
        page = tmp_path / "lot" / "lot.html"
        while not page.exists() and running.poll() is None:
            time.sleep(0.05)
        running.send_signal(signal.SIGTERM)
        message = running.communicate()[0]
    assert running.returncode == 0
    assert b"files       1: 1 fitted" in message
    assert "rig/a.csv" in (tmp_path / "lot" / "lot.csv").read_text()
