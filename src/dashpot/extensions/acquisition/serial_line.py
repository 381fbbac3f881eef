"""Serial port, or a USB device that acts as one, opened for reading only."""

from __future__ import annotations

import os
import select
import stat
from collections.abc import Iterator, Sequence

from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.acquisition.line_parser import Lines
from dashpot.extensions.acquisition.recorder import COLUMNS, Block, Description

READ_TIMEOUT = 0.1
"""Seconds for which a silent line is waited for."""


class SerialLine:
    """Instrument that sends one line of numbers for each sample.

    Of the operating system's own calls: the one library for it would be a dependency for thirty
    lines, and opens to write. Linux and macOS.

    Parameters
    ----------
    port : str
        Such as ``/dev/ttyUSB0``.
    columns : sequence of str
        Names of the numbers of a line, with units.
    baud : int

    Raises
    ------
    ReadError
        If it is no serial line, or cannot be opened.
    DataError
        If a column lacks its unit, or the line knows no such speed.
    """

    def __init__(self, port: str, *, columns: Sequence[str] = COLUMNS, baud: int = 115200) -> None:
        self._lines, self._is_stopped = Lines(columns), False
        self._device, self._end_note = f"serial line {port}, {baud} baud", ""
        self._handle = _open_serial_line(port, baud)

    def describe(self) -> Description:
        """Return the source and the lost samples so far."""
        stated = (self._end_note,) if self._end_note else ()
        return Description(self._device, self._lines.channels, (*self._lines.notes(), *stated))

    def blocks(self) -> Iterator[Block]:
        """Yield the samples that came, until the line is closed or the clock begins again."""
        try:
            while not self._is_stopped and not self._lines.has_restarted:
                readable, _, _ = select.select([self._handle], [], [], READ_TIMEOUT)
                data = self._read() if readable else b""
                if data is None:
                    self._end_note = "the device closed the line"
                    return
                yield self._lines.feed(data)
        finally:
            os.close(self._handle)

    def stop(self) -> None:
        """End the reading within a tenth of a second."""
        self._is_stopped = True

    def _read(self) -> bytes | None:
        """Return the bytes that have arrived; None at the end of the stream."""
        try:
            return os.read(self._handle, 1 << 16) or None
        except BlockingIOError:
            return b""
        except OSError:  # unplugged
            return None


def _open_serial_line(port: str, baud: int) -> int:
    """Return the handle of a serial line, raw, 8 bits, at a speed."""
    try:
        import termios
        import tty
    except ImportError:
        raise ReadError(
            "a serial line is read on Linux and macOS; elsewhere let the instrument's own program "
            "write a file, and fit it as it comes with 'dashpot batch FOLDER --watch'"
        ) from None
    speed = getattr(termios, f"B{baud}", None)
    if speed is None:
        raise DataError(f"{baud} baud is no speed of a serial line here; 115200 is usual")
    try:
        handle = os.open(port, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        raise ReadError(f"{port} cannot be read: {error.strerror}") from None
    if not stat.S_ISCHR(os.fstat(handle).st_mode) or not os.isatty(handle):
        os.close(handle)
        raise ReadError(f"{port} is no serial line; expected one such as /dev/ttyUSB0")
    tty.setraw(handle)
    settings = termios.tcgetattr(handle)
    settings[4] = settings[5] = speed
    termios.tcsetattr(handle, termios.TCSANOW, settings)
    return handle
