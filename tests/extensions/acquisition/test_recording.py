"""Recording from an instrument: a pseudo-terminal, a file, the virtual rig."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import numpy as np
import pytest
from kit.shell import ran

import dashpot as dp
from dashpot.base.errors import DataError, ReadError
from dashpot.base.file_writing import write_atomic
from dashpot.base.version import is_ours
from dashpot.extensions.acquisition.line_parser import MAX_LENGTH, Lines
from dashpot.extensions.acquisition.record_to_file import record
from dashpot.extensions.acquisition.recorder import Description
from dashpot.extensions.acquisition.replay_device import (
    PacedReplay,
    create_simulated_device,
    replay,
)
from dashpot.extensions.acquisition.serial_line import SerialLine
from dashpot.fitting.relaxation import fit
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER

TEST = simulate_relaxation(PAPER, hold_time=4.0, rig=Rig(rate=200.0)).test
ROWS = list(
    zip(TEST.time.tolist(), (1e3 * TEST.displacement).tolist(), TEST.force.tolist(), strict=True)
)
PLAIN = [f"{t:.4f},{x:.4f},{f:.6f}\n".encode() for t, x, f in ROWS]
needs_pty = pytest.mark.skipif(not hasattr(os, "openpty"), reason="needs a pseudo-terminal")


@contextmanager
def instrument(**how) -> Iterator[tuple[int, SerialLine]]:
    """The end of a line that an instrument writes to, and its reader."""
    ours, theirs = os.openpty()
    line = SerialLine(os.ttyname(theirs), **how)
    try:
        yield ours, line
    finally:
        os.close(theirs)
        with suppress(OSError):  # the instrument was unplugged
            os.close(ours)


class Sender:
    """Sends a part of the lines whenever the reader has taken the one before; then unplugs."""

    def __init__(self, handle: int, lines: list[bytes], part: int = 40) -> None:
        self._handle, self._parts = (
            handle,
            [lines[i : i + part] for i in range(0, len(lines), part)],
        )
        self.next()

    def next(self, *_: object) -> None:
        if self._parts:
            os.write(self._handle, b"".join(self._parts.pop(0)))
        else:
            os.close(self._handle)


@needs_pty
@pytest.mark.once
def test_a_serial_instrument_becomes_a_record_that_is_fitted(tmp_path):
    with instrument() as (handle, line):
        sender = Sender(handle, [b"cut line\n", *PLAIN])
        rows, notes = record(line, tmp_path / "seal.csv", on_block=sender.next)
    assert rows == len(ROWS)
    assert notes == ("the device closed the line",)
    back = read_relaxation(tmp_path / "seal.csv")
    np.testing.assert_allclose(back.time, TEST.time, atol=1e-4)
    np.testing.assert_allclose(back.displacement, TEST.displacement, atol=1e-7)
    np.testing.assert_allclose(back.force, TEST.force, atol=1e-6)
    assert fit(back).model.k_inf == pytest.approx(fit(TEST).model.k_inf, rel=1e-3)
    text = (tmp_path / "seal.csv").read_text().splitlines()
    assert text[0].startswith("# serial line /dev/")
    assert text[1] == "time [s],displacement [mm],force [N]"
    assert text[-1] == "# the device closed the line"
    assert not is_ours((tmp_path / "seal.csv").read_bytes())  # a measurement: never written over


@needs_pty
def test_record_counts_and_reports_lost_lines(tmp_path):
    sent = [b"\n", *PLAIN[:300]]
    sent[100:105] = []  # five samples never came
    sent[150] = b"0.7450,0.00\xff\xfe7\n"
    sent[151] = b"0.7500,0.0\n"
    sent[160] = sent[160] + sent[150]
    sent[200] = sent[199]
    with instrument() as (handle, line):
        sender = Sender(handle, sent)
        rows, notes = record(line, tmp_path / "a.csv", on_block=sender.next)
    assert rows == 300 - 5 - 2 - 1
    assert notes[0] == r"three garbled lines left out, first '0.7450,0.00\xff\xfe7'"
    assert notes[1] == "one line left out that came no later than the line before"
    # 5, then 2, then 1 sample: steps of 6, 3 and 2 times 5 ms
    assert notes[2] == "three gaps in the clock, 8 samples missing, the longest gap 0.03 s"
    back = dp.files.read_trajectory(tmp_path / "a.csv")
    assert len(back.time) == rows


@needs_pty
def test_serial_line_is_opened_read_only_and_must_be_serial(tmp_path):
    with instrument() as (_, line):
        with pytest.raises(OSError, match="Bad file descriptor"):
            os.write(line._handle, b"G0 Z-8\n")
        line.stop()
        assert [*line.blocks()] == []
    (tmp_path / "a.csv").write_text("1,2,3\n")
    with pytest.raises(ReadError, match="is no serial line; expected one such as /dev/ttyUSB0"):
        SerialLine(str(tmp_path / "a.csv"))
    with pytest.raises(ReadError, match="cannot be read: No such file"):
        SerialLine(str(tmp_path / "none"))
    with pytest.raises(ReadError, match="is no serial line"):
        SerialLine(os.devnull)
    with pytest.raises(DataError, match="12345 baud is no speed of a serial line here"):
        SerialLine("/dev/ttyUSB0", baud=12345)


@pytest.mark.parametrize("cut", [1, 7, 64, 4000])
def test_lines_are_the_same_however_they_arrive(cut: int):
    lines, whole = Lines(), b"".join([b"x\n", *PLAIN[:200]])
    blocks = [lines.feed(whole[i : i + cut]) for i in range(0, len(whole), cut)]
    times = np.concatenate([item for item, _ in blocks])
    np.testing.assert_allclose(times, TEST.time[:200], atol=1e-4)
    assert lines.notes() == ()


def test_an_end_of_line_is_any_of_the_three_and_what_a_terminal_obeys_is_escaped():
    lines = Lines()
    times, _ = lines.feed(b"\r0.1,2,3\r0.2,2,3\r\n0.3,2,3\n\x1b[2J\r")
    assert times.tolist() == [0.1, 0.2, 0.3]
    assert lines.notes() == (r"one garbled line left out, first '\x1b[2J'",)


def test_a_checksum_finds_what_still_looks_like_a_number():
    lines = Lines()
    body = b"0.1,2.0,3.0"
    good = body + b"*" + f"{np.bitwise_xor.reduce(np.frombuffer(body, np.uint8)):02X}".encode()
    later = b"0.2,2.0,3.0*2D"
    bad = [good.replace(b"2.0", b"7.0"), good.replace(b"*", b""), good[:-1]]
    times, values = lines.feed(b"\r\n".join([b"", good, *bad, later, b""]))
    assert times.tolist() == [0.1, 0.2]
    assert values.tolist() == [[2.0, 3.0], [2.0, 3.0]]
    assert lines.notes() == ("three garbled lines left out, first '0.1,7.0,3.0*2E'",)


def test_without_a_time_the_clock_is_this_computers():
    ticks = iter([10.0, 10.4, 10.8])
    lines = Lines(["force [N]"], clock=lambda: next(ticks))
    # the first rows waited since nobody knows when
    assert lines.feed(b"\n1\n2\n")[0].tolist() == [10.0]
    times, values = lines.feed(b"3\n4\n5\n6\n")
    np.testing.assert_allclose(times, [10.1, 10.2, 10.3, 10.4])
    assert values[:, 0].tolist() == [3.0, 4.0, 5.0, 6.0]
    assert lines.notes() == (
        "the device sends no time: it is that of this computer, as lines arrived",
    )


def test_times_have_units_and_a_clock_that_begins_again_ends_the_record():
    lines = Lines(["force [N]", "time [ms]"])
    assert lines.channels == ("force [N]",)
    assert lines.feed(b"\n7 500\n8;510\n")[0].tolist() == [0.5, 0.51]
    lines.feed(b"".join(b"1 %d\n" % t for t in range(9)))
    assert not lines.has_restarted
    lines.feed(b"1 9\n")
    assert lines.has_restarted
    assert "the device's clock began again: the record ends there" in lines.notes()


def test_a_time_that_was_garbled_is_no_gap_and_ends_no_record():
    sent = [f"{0.01 * i:.2f},1,2\n".encode() for i in range(100)]
    sent[0] = b"\n5,1,2\n"  # 0.05 without its beginning
    sent[50] = b"850,1,2\n"
    sent[60:65] = []  # a gap, and true
    lines = Lines()
    times, _ = lines.feed(b"".join(sent))
    np.testing.assert_allclose(times, np.delete(0.01 * np.arange(100), [0, 50, *range(60, 65)]))
    assert lines.notes() == (
        "two garbled lines left out, first 'time 5 s'",
        "two gaps in the clock, 6 samples missing, the longest gap 0.06 s",
    )
    assert not lines.has_restarted


def test_a_line_without_an_end_is_no_memory_without_an_end():
    lines = Lines()
    for _ in range(100):
        lines.feed(b"1" * MAX_LENGTH)
    assert len(lines._incomplete_line) <= MAX_LENGTH


@pytest.mark.parametrize(
    ("columns", "message"),
    [(["force"], "each column needs a name and a unit"), ([], "each column needs a name"),
     (["time [s]"], "only a time is sent"), (["time [N]", "force [N]"], "'N' is no unit of time")],
)  # fmt: skip
def test_columns_that_say_too_little_are_refused(columns, message: str):
    with pytest.raises(DataError, match=message):
        Lines(columns)


def test_a_replay_is_the_record(tmp_path):
    write_relaxation(TEST, tmp_path / "a.csv", comments=["simulated"])
    rows, notes = record(replay(tmp_path / "a.csv", speed=np.inf), tmp_path / "b.csv")
    assert (rows, notes) == (len(TEST.time), ())
    back = read_relaxation(tmp_path / "b.csv")
    np.testing.assert_array_equal(back.force, TEST.force)
    np.testing.assert_allclose(back.displacement, TEST.displacement, atol=1e-15)
    assert back.source.simulated
    with pytest.raises(ReadError, match=r"b.csv is there already; a record is written to a new"):
        record(replay(tmp_path / "a.csv"), tmp_path / "b.csv")
    with pytest.raises(DataError, match="expected a number > 0, such as 10"):
        replay(tmp_path / "a.csv", speed=0)


def test_the_virtual_rig_is_a_device_and_stops_after_its_seconds(tmp_path):
    played = create_simulated_device(speed=400.0)
    rows, _ = record(played, tmp_path / "a.csv", seconds=5.0)
    assert 5000 <= rows < 42501
    assert read_relaxation(tmp_path / "a.csv").source.simulated


class Silent:
    """A device of which nothing comes."""

    def __init__(self) -> None:
        self.stopped = 0

    def describe(self) -> Description:
        return Description("a card", ("force [N]",), ("its cable is off",))

    def blocks(self):
        while not self.stopped:
            yield np.empty(0), np.empty((0, 1))

    def stop(self) -> None:
        self.stopped += 1


def test_a_device_that_says_nothing_is_not_waited_for(tmp_path):
    card = Silent()
    with pytest.raises(ReadError, match="nothing came from a card; its cable is off: is it on"):
        record(card, tmp_path / "a.csv", seconds=1e-3)
    assert card.stopped


@pytest.mark.once
def test_record_refuses_a_file_that_another_recorder_writes(tmp_path):
    """The second is refused while the first runs, and not after it was killed."""
    file = tmp_path / "a.csv"
    words = f"record --driver simulated --speed 0.5 -o {file}".split()
    with subprocess.Popen(
        [sys.executable, "-m", "dashpot", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as child:
        try:
            while not file.exists() or file.read_bytes().count(b"\n") < 20:
                assert child.poll() is None
            second = ran(*f"record --driver simulated --seconds 1s --overwrite -o {file}".split())
            assert second.exit_code == 2
            assert "another dashpot records to this file" in " ".join(second.output.split())
            with pytest.raises(DataError, match="is being written by another dashpot"):
                write_atomic(file, b"another result")
            assert b"another" not in file.read_bytes()
        finally:
            child.kill()
            child.communicate(timeout=60)
    text = file.read_text()
    assert "\0" not in text
    # rows of the one recorder alone: its clock never goes back
    times = [float(row.split(",")[0]) for row in text.splitlines()[2:-1]]
    assert times == sorted(times)
    # what was killed holds no lock
    rows, _ = record(PacedReplay(TEST, "a card", speed=np.inf), file, replace=True)
    assert rows == len(TEST.time)
    write_atomic(file, b"another result")
    assert file.read_bytes() == b"another result"


def test_an_earlier_record_stays_until_rows_come(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("an earlier record, longer than what follows\n" * 20_000)
    before = file.read_bytes()
    with pytest.raises(ReadError, match="nothing came"):
        record(Silent(), file, seconds=1e-3, replace=True)
    assert file.read_bytes() == before
    record(PacedReplay(TEST, "a card", speed=np.inf), file, replace=True)
    assert "earlier" not in file.read_text()
    assert len(read_relaxation(file).time) == len(TEST.time)


class Broken(PacedReplay):
    """A device whose driver fails in the middle."""

    def blocks(self):
        for number, block in enumerate(super().blocks()):
            yield block[0][:50], block[1][:50]
            if number == 0:
                raise OSError("the card is gone")


def test_what_was_read_before_a_fault_is_in_the_file(tmp_path):
    with pytest.raises(OSError, match="the card is gone"):
        record(Broken(TEST, "a card", speed=np.inf), tmp_path / "a.csv")
    assert len(read_relaxation(tmp_path / "a.csv").time) == 50


def test_a_full_disk_leaves_whole_rows(tmp_path, monkeypatch):
    folder = [3000]
    write = os.write

    def filling(handle: int, data: bytes) -> int:
        if not folder[0]:
            raise OSError(28, "No space left on device")
        folder[0] -= (fits := min(len(data), folder[0]))
        return write(handle, data[:fits])

    monkeypatch.setattr("dashpot.extensions.acquisition.record_to_file.os.write", filling)
    blocks = PacedReplay(TEST, "a card", speed=5.0)
    with pytest.raises(ReadError, match=r"a.csv cannot be written any further: No space left on"):
        record(blocks, tmp_path / "a.csv")
    text = (tmp_path / "a.csv").read_text()
    assert text.endswith("\n")
    assert len(text) < 3000
    rows = text.splitlines()[2:]
    assert [float(row.split(",")[0]) for row in rows] == TEST.time[: len(rows)].tolist()


def test_a_stop_between_any_two_steps_ends_the_reading():
    # the handler of a signal runs in the thread that reads, whatever that thread holds
    device = create_simulated_device(speed=0.5)

    def read():
        sys.setprofile(lambda *_: device.stop())
        for _ in device.blocks():
            pass

    reading = threading.Thread(target=read, daemon=True)
    reading.start()
    reading.join(timeout=60)
    assert not reading.is_alive()


@pytest.mark.once
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_a_record_in_good_order(tmp_path, how):
    # dashpot record --driver simulated
    file = tmp_path / "a.csv"
    words = f"record --driver simulated --speed 0.5 --json -o {file}".split()
    with subprocess.Popen(
        [sys.executable, "-m", "dashpot", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as child:
        while not file.exists() or file.read_bytes().count(b"\n") < 20:
            assert child.poll() is None
        child.send_signal(how)
        out, _ = child.communicate(timeout=60)
    assert child.returncode == 0
    text = file.read_text().splitlines()
    assert text[-1].endswith("rows recorded")
    assert f'"rows": {len(text) - 3}' in out.decode()


@pytest.mark.once
def test_the_command_refuses_what_it_cannot_record(tmp_path):
    (tmp_path / "mine.csv").write_text("somebody's\n")
    for words, message in [
        ("serial -o a.csv", "add --port"),
        ("replay -o a.csv", "add --from FILE"),
        (f"replay --from {tmp_path / 'mine.csv'} -o a.csv", "give it a header such as"),
        ("replay --from nowhere.csv -o a.csv", "nowhere.csv"),
        ("simulated -o -", "a record is kept in a file"),
        (f"simulated -o {tmp_path / 'mine.csv'}", "was not written by dashpot"),
        ("serial --port nowhere -o a.csv", "nowhere cannot be read"),
        ("serial --port a --columns force -o a.csv", "each column needs a name and a unit"),
    ]:
        done = ran("record", "--driver", *words.split())
        assert done.exit_code == 2, done.output
        assert message in " ".join(done.output.split())
    assert (tmp_path / "mine.csv").read_text() == "somebody's\n"
