"""Parser of the lines of numbers that an instrument sends; counts garbled and missing ones."""

from __future__ import annotations

import math
import re
import time
from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.units import find_unit
from dashpot.extensions.acquisition.recorder import COLUMNS, Block

MAX_LENGTH = 4096
"""Largest length of a line, bytes."""
RESTART_LINES = 10
"""Lines in a row, earlier than the one before, after which the device has begun again."""
_GAP_RATIO = 1.5
"""Steps of the usual size that a missing sample makes at least."""
_MIN_STEPS, _MAX_STEPS = 3, 101
"""Smallest and largest number of steps for their median."""
_SEPARATOR = re.compile(rb"[,;\s]")
_NAMED = re.compile(r"([^\[\]]+)\[([^\[\]]+)\]")


def _split_time_column(columns: Sequence[str]) -> tuple[tuple[str, ...], int | None, float]:
    """Return the columns without the time, its position, and its unit, s."""
    matches = [_NAMED.fullmatch(" ".join(column.split())) for column in columns]
    words = [(match[1].strip(), match[2].strip()) for match in filter(None, matches)]
    if not words or None in matches:
        raise DataError(
            "each column needs a name and a unit, such as 'time [s], displacement [mm], force [N]'"
        )
    names, channels = [name.casefold() for name, _ in words], [f"{n} [{u}]" for n, u in words]
    if "time" not in names:
        return tuple(channels), None, 1.0
    time_column = names.index("time")
    del channels[time_column]
    if not channels:
        raise DataError("only a time is sent; expected a displacement or a force with it")
    unit = find_unit(words[time_column][1], "time")
    if unit is None:
        raise DataError(f"'{words[time_column][1]}' is no unit of time that dashpot knows")
    return tuple(channels), time_column, unit.factor


class Lines:
    """Parser from bytes to blocks of numbers, with a count of lost lines.

    A line holds a number for each column, separated by commas, semicolons or blanks; ``*HH`` at its
    end is the exclusive or of the bytes before it; a device that has sent one is held to it in
    every line. The first line is omitted: its beginning may have been sent before the recording
    started.

    Parameters
    ----------
    columns : sequence of str
        Names with units; that of the time, if there is one, begins with ``time``. Without it the
        time is that of this computer.
    clock : callable
        Clock of this computer, s.

    Raises
    ------
    DataError
        If a column has no unit.
    """

    def __init__(
        self, columns: Sequence[str] = COLUMNS, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.channels, self._time_column, self._factor = _split_time_column(columns)
        self._width, self._clock = len(columns), clock
        self._is_checked = False
        self._incomplete_line, self._skips_first_line, self._last_time = b"", True, -math.inf
        self._pending_sample: tuple[float, list[float]] | None = None
        self._steps: deque[float] = deque(maxlen=_MAX_STEPS)
        self._median, self._step_count = math.inf, 0
        self._garbled_count, self._example, self._fall_count, self._falls_in_a_row = 0, "", 0, 0
        self._gaps, self._missing_count, self._longest_gap = 0, 0, 0.0
        self.has_restarted = False

    def feed(self, data: bytes) -> Block:
        """Return the samples of the lines that `data` completes."""
        # an end of \r\n is one of \r, and an empty line
        *lines, self._incomplete_line = (
            (self._incomplete_line + data).replace(b"\r", b"\n").split(b"\n")
        )
        if len(self._incomplete_line) > MAX_LENGTH:
            lines, self._incomplete_line = [*lines, self._incomplete_line[:MAX_LENGTH]], b""
        if lines and self._skips_first_line:
            self._skips_first_line, lines = False, lines[1:]
        rows = [row for line in lines if (row := self._row(line.strip())) is not None]
        rows_with_time = (
            self._assign_arrival_times(rows)
            if self._time_column is None
            else self._extract_device_times(rows, self._time_column)
        )
        times = np.array([clock for clock, _ in rows_with_time])
        values = np.array([row for _, row in rows_with_time]).reshape(
            len(rows_with_time), len(self.channels)
        )
        return times, values

    def notes(self) -> tuple[str, ...]:
        """Return the notes on lost samples so far."""
        names = []
        if self._time_column is None:
            names.append("the device sends no time: it is that of this computer, as lines arrived")
        if self._garbled_count:
            lines = format_count(self._garbled_count, "garbled line")
            names.append(f"{lines} left out, first {self._example}")
        if self._fall_count:
            lines = format_count(self._fall_count, "line")
            names.append(f"{lines} left out that came no later than the line before")
        if self._gaps:
            names.append(
                f"{format_count(self._gaps, 'gap')} in the clock, {self._missing_count} samples "
                f"missing, the longest gap {self._longest_gap:.4g} s"
            )
        if self.has_restarted:
            names.append("the device's clock began again: the record ends there")
        return tuple(names)

    def _row(self, line: bytes) -> list[float] | None:
        """Return the numbers of a line; None if it is empty or garbled."""
        if not line:
            return None
        body, star, checksum_text = line.partition(b"*")
        try:
            if (star or self._is_checked) and int(checksum_text, 16) != _compute_checksum(body):
                raise ValueError
            self._is_checked |= bool(star)
            row = [float(cell) for cell in _SEPARATOR.split(body) if cell]
        except ValueError:
            row = []
        if len(row) == self._width and all(map(math.isfinite, row)):
            return row
        self._count_garbled_line(line[:40].decode("latin-1"))
        return None

    def _assign_arrival_times(self, rows: list[list[float]]) -> list[tuple[float, list[float]]]:
        """Return rows that came together with times between the last look and now."""
        now, last = self._clock(), self._last_time
        if not rows:
            return []
        self._last_time = now
        if math.isinf(last):
            return [(now, rows[-1])]  # nobody knows since when the others had waited
        part = (now - last) / len(rows)
        return [(last + i * part, row) for i, row in enumerate(rows, start=1)]

    def _extract_device_times(
        self, rows: list[list[float]], column: int
    ) -> list[tuple[float, list[float]]]:
        """Return rows with the device's own times, as far as those rise.

        A time far ahead of the one before is a gap if the next one follows it; if the next one
        falls back behind it, it was garbled. Until then it is held.
        """
        kept_lines = []
        for row in rows:
            sample = row.pop(column) * self._factor, row
            if self._pending_sample is not None and sample[0] <= self._pending_sample[0]:
                self._count_garbled_line(f"time {self._pending_sample[0]:g} s")
            elif self._pending_sample is not None:
                kept_lines.append(self._register_sample(self._pending_sample))
            self._pending_sample = None
            if sample[0] <= self._last_time:
                self._fall_count, self._falls_in_a_row = (
                    self._fall_count + 1,
                    self._falls_in_a_row + 1,
                )
                self.has_restarted |= self._falls_in_a_row >= RESTART_LINES
            elif sample[0] - self._last_time > _GAP_RATIO * self._get_usual_step():
                self._pending_sample = sample
            else:
                kept_lines.append(self._register_sample(sample))
        return kept_lines

    def _register_sample(self, sample: tuple[float, list[float]]) -> tuple[float, list[float]]:
        """Return a sample that is not discarded, after its step or gap is counted."""
        step, usual_step = sample[0] - self._last_time, self._get_usual_step()
        self._last_time, self._falls_in_a_row = sample[0], 0
        if math.isinf(step):
            return sample
        if step > _GAP_RATIO * usual_step:
            self._gaps += 1
            self._missing_count += round(step / usual_step) - 1
            self._longest_gap = max(self._longest_gap, step)
        else:
            self._steps.append(step)
            self._step_count += 1
            if self._step_count >= _MIN_STEPS and (
                self._step_count < _MAX_STEPS or self._step_count % _MAX_STEPS == 0
            ):
                self._median = float(np.median(self._steps))
        return sample

    def _get_usual_step(self) -> float:
        """The usual step, s; infinite before it is known, but for the first sample of all."""
        return 0.0 if math.isinf(self._last_time) else self._median

    def _count_garbled_line(self, example: str) -> None:
        self._example = self._example or ascii(example)
        self._garbled_count += 1


def _compute_checksum(body: bytes) -> int:
    count = 0
    for byte in body:
        count ^= byte
    return count
