"""Lines of numbers as an instrument sends them: what is whole, what is garbled, what is missing."""

from __future__ import annotations

import math
import re
import time
from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.numbers import counted
from dashpot.base.units import find
from dashpot.recording.recorder import COLUMNS, Block

LONGEST = 4096
"""Bytes of a line, at most."""
FALLS = 10
"""Lines in a row, earlier than the one before, after which the device has begun again."""
_GAP = 1.5
"""Steps of the usual size that a missing sample makes at least."""
_SEPARATOR = re.compile(rb"[,;\s]")
_NAMED = re.compile(r"([^\[\]]+)\[([^\[\]]+)\]")


class Lines:
    """Bytes to blocks, and an account of what was lost.

    A line holds a number for each column, separated by commas, semicolons or blanks; ``*HH`` at
    its end is the exclusive or of the bytes before it, and is then held to it. The first line is
    left out: nobody knows how much of it was sent before the listening began.

    Parameters
    ----------
    columns : sequence of str
        Names with units; that of the time, if there is one, begins with ``time``. Without it the
        clock is that of this computer.
    clock : callable
        Tells the seconds of this computer.

    Raises
    ------
    DataError
        If a column has no unit.
    """

    def __init__(
        self, columns: Sequence[str] = COLUMNS, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        named = [_NAMED.fullmatch(one.strip()) for one in columns]
        if not columns or None in named:
            raise DataError(
                "each column needs a name and a unit, such as 'time [s], displacement [mm], "
                "force [N]'"
            )
        words = [(one[1].strip(), one[2].strip()) for one in named if one is not None]
        times = [i for i, (name, _) in enumerate(words) if name.casefold() == "time"]
        self._at = times[0] if times else None
        self.channels = tuple(f"{n} [{u}]" for i, (n, u) in enumerate(words) if i != self._at)
        if not self.channels:
            raise DataError("only a time is sent; expected a displacement or a force with it")
        unit = find(words[self._at][1], "time") if self._at is not None else None
        if self._at is not None and unit is None:
            raise DataError(f"'{words[self._at][1]}' is no unit of time that dashpot knows")
        self._factor = 1.0 if unit is None else unit.factor
        self._width, self._clock = len(words), clock
        self._rest, self._first, self._last = b"", True, -math.inf
        self._steps: deque[float] = deque(maxlen=201)
        self._garbled, self._example, self._fell, self._falls = 0, "", 0, 0
        self._gaps, self._missing, self._longest = 0, 0, 0.0
        self.begun_again = False

    def feed(self, data: bytes) -> Block:
        """Return the samples of the lines that `data` completes."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        if len(self._rest) > LONGEST:
            lines, self._rest = [*lines, self._rest[:LONGEST]], b""
        if lines and self._first:
            self._first, lines = False, lines[1:]
        rows = [row for line in lines if (row := self._row(line.strip())) is not None]
        clocked = self._arrived(rows) if self._at is None else self._sent(rows, self._at)
        times = np.array([clock for clock, _ in clocked])
        values = np.array([row for _, row in clocked]).reshape(len(clocked), len(self.channels))
        return times, values

    def notes(self) -> tuple[str, ...]:
        """Return what was lost so far, in sentences."""
        found = []
        if self._at is None:
            found.append("the device sends no time: it is that of this computer, as lines arrived")
        if self._garbled:
            lines = counted(self._garbled, "garbled line")
            found.append(f"{lines} left out, first '{self._example}'")
        if self._fell:
            lines = counted(self._fell, "line")
            found.append(f"{lines} left out that came no later than the line before")
        if self._gaps:
            found.append(
                f"{counted(self._gaps, 'gap')} in the clock, {self._missing} samples missing, the "
                f"longest gap {self._longest:.4g} s"
            )
        if self.begun_again:
            found.append("the device's clock began again: the record ends there")
        return tuple(found)

    def _row(self, line: bytes) -> list[float] | None:
        """The numbers of a line; None if it is empty or garbled."""
        if not line:
            return None
        body, star, sent = line.partition(b"*")
        try:
            if star and int(sent, 16) != _checksum(body):
                raise ValueError
            row = [float(cell) for cell in _SEPARATOR.split(body) if cell]
        except ValueError:
            row = []
        if len(row) == self._width and all(map(math.isfinite, row)):
            return row
        self._example = self._example or line[:40].decode("ascii", "backslashreplace")
        self._garbled += 1
        return None

    def _arrived(self, rows: list[list[float]]) -> list[tuple[float, list[float]]]:
        """Rows that came together with times between the last look and now."""
        now, last = self._clock(), self._last
        if not rows:
            return []
        self._last = now
        if math.isinf(last):
            return [(now, rows[-1])]  # nobody knows since when the others had waited
        part = (now - last) / len(rows)
        return [(last + i * part, row) for i, row in enumerate(rows, start=1)]

    def _sent(self, rows: list[list[float]], at: int) -> list[tuple[float, list[float]]]:
        """Rows with the device's own times, as far as those rise."""
        timed = [(row.pop(at) * self._factor, row) for row in rows]
        return [(clock, row) for clock, row in timed if self._rises(clock)]

    def _rises(self, clock: float) -> bool:
        """Whether a sample is later than the one before; its step is put in the account."""
        if clock <= self._last:
            self._fell, self._falls = self._fell + 1, self._falls + 1
            self.begun_again |= self._falls >= FALLS
            return False
        step, self._falls = clock - self._last, 0
        self._last = clock
        if math.isfinite(step):
            usual = float(np.median(self._steps)) if len(self._steps) > FALLS else math.inf
            if step > _GAP * usual:
                self._gaps += 1
                self._missing += round(step / usual) - 1
                self._longest = max(self._longest, step)
            else:
                self._steps.append(step)
        return True


def _checksum(body: bytes) -> int:
    found = 0
    for byte in body:
        found ^= byte
    return found
