"""What reading a file may take of time, in this process or in a child."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from dashpot.base.errors import ReadError

_SECONDS = 30.0
_LONGEST = 600.0
_OF_IT = 2 / 3
"""Part of that time for the rows of a text; the rest is for what is made of them."""
_PACE = 1e6
"""Bytes per second that the slowest reader of a large file makes."""


def seconds_for(size: int) -> float:
    """Return the time that reading so many bytes may take."""
    return min(max(_SECONDS, size / _PACE), _LONGEST)


class TimeBudget:
    """What this process spends on a file that is parsed in it: no more than a child would get.

    All that reads a file shares it, however often its rows are read.

    Parameters
    ----------
    size : int, optional
        Bytes of the file; of one that is not known, as much as the largest may cost.
    """

    def __init__(self, size: int | None) -> None:
        self._most = _OF_IT * (_LONGEST if size is None else seconds_for(size))
        self._spent = self._began = 0.0
        self._line = 1

    @contextmanager
    def count_time_spent(self) -> Iterator[None]:
        """Count what is spent within."""
        self._began = time.thread_time()
        try:
            yield
        finally:
            self._spent += time.thread_time() - self._began

    def check_time_limit(self, line: int) -> None:
        """Raise a ReadError if it is spent at a line.

        Raises
        ------
        ReadError
            With what to do.
        """
        self._line = max(line, self._line)
        if self._spent + time.thread_time() - self._began > self._most:
            raise ReadError(
                f"took more than {self._most:.0f} s to read up to line {self._line}: rows with "
                "grouped thousands, or with text between them, are read one by one; export the "
                "file without either, or split it"
            )
