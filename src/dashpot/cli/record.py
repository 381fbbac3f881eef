"""dashpot record: what an instrument sends, to a file."""

from __future__ import annotations

import math
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

import dashpot as dp
from dashpot.base.choices import Driver, words
from dashpot.base.documents import Documented
from dashpot.base.errors import DataError
from dashpot.base.progress import doing
from dashpot.cli import _options as options
from dashpot.cli._options import WithUnit
from dashpot.cli._shell import File, Outcome, note_written, reports, typed
from dashpot.cli._terminal import Text
from dashpot.cli.simulate import as_it_stands, seal


@dataclass(frozen=True)
class KeptRecord(Documented):
    """A file, how many rows it has, and what is to be said of them."""

    schema = "dashpot/recorded@1"

    file: str
    rows: int
    notes: tuple[str, ...]


@click.command("record")
@click.option(
    "--driver", type=click.Choice(words(Driver)), required=True,
    help="A serial line, a record played again, or the virtual rig.",
)  # fmt: skip
@click.option("--port", metavar="PORT", help="Of the serial line, e.g. /dev/ttyUSB0.")
@click.option("--baud", type=int, default=115200, show_default=True)
@click.option(
    "--columns",
    default="time [s], displacement [mm], force [N]",
    show_default=True,
    help="What the numbers of a line are.",
)
@click.option("--from", "played", type=File(), metavar="FILE", help="The record to replay.")
@click.option("--model", default="paper", show_default=True, metavar="paper|broad|hidden|FIT")
@click.option("--speed", type=float, default=1.0, show_default=True, help="Of what is played.")
@click.option("--seconds", type=WithUnit("time"), help="How long, e.g. 45s; else until Ctrl-C.")
@options.output("Text; it grows while the instrument is read.", ".csv", ".txt", required=True)
@options.force
@reports
def command(*, driver: str, output: str, seconds: float | None, **choices: Any) -> Outcome:
    """Record force and displacement as an instrument sends them, to a file that dashpot reads.

    It reads, and moves nothing: the rig's own controller does (dashpot plan --setpoints). Each line
    of a serial instrument holds a number for each column; what is garbled or missing is counted and
    said. The file grows at its place and is on the disk within a second. Ctrl-C ends the record.

    \b
    dashpot record --driver serial --port /dev/ttyUSB0 --seconds 45s -o seal.csv
    dashpot record --driver simulated --seconds 10s -o rehearsal.csv
    dashpot record --driver replay --from seal_8mm.csv --speed 20 -o again.csv
    """
    if output == "-":
        raise DataError("a record is kept in a file; give one with -o, such as -o seal.csv")
    recorder = _device(driver, **choices)
    device = recorder.describe().device
    doing(f"recording from {device}; Ctrl-C ends it")
    with _stopped_by_signals(recorder):
        rows, notes = dp.recording.record(
            recorder,
            output,
            seconds=math.inf if seconds is None else seconds,
            replace=Path(output).exists(),  # what must not be written over was refused before
        )
    note_written(output)
    story = Text([f"{output}: {rows} samples; {device}", *(f"! {note}" for note in notes)])
    return Outcome(KeptRecord(output, rows, tuple(notes)), story, follow=typed("inspect", output))


@contextmanager
def _stopped_by_signals(recorder: dp.recording.Recorder) -> Iterator[None]:
    """Let Ctrl-C end the record in good order, not between a read and its write."""
    before = {}
    with suppress(ValueError):  # not the main thread of whoever calls
        for number in (signal.SIGINT, signal.SIGTERM):
            before[number] = signal.signal(number, lambda *_: recorder.stop())
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _device(
    driver: str,
    *,
    port: str | None,
    baud: int,
    columns: str,
    played: str | None,
    model: str,
    speed: float,
) -> dp.recording.Recorder:
    """Return the device that was asked for."""
    if driver == "serial":
        if port is None:
            raise DataError("--driver serial needs the line: add --port, e.g. /dev/ttyUSB0")
        return dp.recording.SerialLine(port, columns=columns.split(","), baud=baud)
    if driver == "simulated":
        return dp.recording.simulated(seal(model).solid, speed=speed)
    if played is None:
        raise DataError("--driver replay needs the record: add --from FILE")
    with as_it_stands(played):
        return dp.recording.replay(played, speed=speed)
