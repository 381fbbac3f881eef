"""dashpot record: samples of an instrument, written to a file."""

from __future__ import annotations

import math
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import dashpot as dp
from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Driver, get_choice_values
from dashpot.base.progress import send_progress
from dashpot.base.serialisation import Serialisable
from dashpot.cli import _options as options
from dashpot.cli._command import group, opt, verb
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, note_written
from dashpot.cli._param_types import ChoiceWithSuggestion, File, WithUnit
from dashpot.cli._simulation_options import explain_unclear_file, load_simulated_seal
from dashpot.text_output.layout import Text

_COLUMNS = "time [s], displacement [mm], force [N]"


@dataclass(frozen=True)
class RecordedFile(Serialisable):
    """Recorded file, with its number of rows and notes."""

    schema = "dashpot/recorded@1"

    file: str
    rows: int
    notes: tuple[str, ...]


@verb(
    "record",
    """Record an instrument to a file that dashpot reads. It does not drive the rig.

  dashpot record --driver serial --port /dev/ttyUSB0 --seconds 45s -o seal.csv

The rig's own controller moves the plate (dashpot plan --setpoints). The file
grows at its place and is on the disk within a second.""",
    group(
        "Instrument",
        opt(
            "--driver",
            type=ChoiceWithSuggestion(get_choice_values(Driver)),
            required=True,
            metavar="NAME",
            help="serial, replay or simulated.",
        ),
        opt("--port", metavar="PORT", help="Serial port, e.g. /dev/ttyUSB0."),
        opt("--baud", type=int, default=115200, metavar="N", help="Baud rate (115200)."),
        opt("--columns", default=_COLUMNS, metavar="TEXT", help=f"Numbers of a line ({_COLUMNS})."),
        opt("--from", "played", type=File(), metavar="FILE", help="The record to replay."),
        opt(
            "--seal",
            default="paper",
            metavar="NAME|FIT",
            help="Seal of the simulated driver (paper).",
        ),
        opt("--speed", type=float, default=1.0, metavar="NUMBER", help="Speed of a replay (1)."),
        opt(
            "--seconds",
            type=WithUnit("time"),
            metavar="TIME",
            help="How long, e.g. 45s; else until Ctrl-C.",
        ),
    ),
    options.result_options(
        "The record (required).", ".csv", ".txt", plot=False, has_open_option=False, required=True
    ),
)
def command(*, driver: str, output: str, seconds: float | None, **choices: Any) -> CommandResult:
    """Read an instrument until it ends, the time is over, or Ctrl-C."""
    if output == "-":
        raise DataError("a record is kept in a file; give one with -o, such as -o seal.csv")
    recorder = _open_device(driver, **choices)
    device = recorder.describe().device
    send_progress(f"recording from {device}; Ctrl-C ends it")
    with _stop_on_signals(recorder):
        rows, notes = dp.files.acquisition.record(
            recorder,
            output,
            seconds=math.inf if seconds is None else seconds,
            replace=Path(output).exists(),  # what must not be written over was refused before
        )
    note_written(output)
    summary = Text([f"{output}: {rows} samples; {device}", *(f"! {note}" for note in notes)])
    return CommandResult(
        RecordedFile(output, rows, tuple(notes)),
        summary,
        next_command=format_command("inspect", output),
    )


@contextmanager
def _stop_on_signals(recorder: dp.files.acquisition.Recorder) -> Iterator[None]:
    """Stop recording on Ctrl-C only between a read and its write."""
    previous_handlers = {}
    with suppress(ValueError):  # not the main thread of whoever calls
        for number in (signal.SIGINT, signal.SIGTERM):
            previous_handlers[number] = signal.signal(number, lambda *_: recorder.stop())
    try:
        yield
    finally:
        for number, handler in previous_handlers.items():
            signal.signal(number, handler)


def _open_device(
    driver: str,
    *,
    port: str | None,
    baud: int,
    columns: str,
    played: str | None,
    seal: str,
    speed: float,
) -> dp.files.acquisition.Recorder:
    """Return the device that was requested."""
    if driver == "serial":
        if port is None:
            raise DataError("--driver serial needs the line: add --port, e.g. /dev/ttyUSB0")
        return dp.files.acquisition.SerialLine(port, columns=columns.split(","), baud=baud)
    if driver == "simulated":
        return dp.files.acquisition.create_simulated_device(
            load_simulated_seal(seal).solid, speed=speed
        )
    if played is None:
        raise DataError("--driver replay needs the record: add --from FILE")
    with explain_unclear_file(played):
        return dp.files.acquisition.replay(played, speed=speed)
