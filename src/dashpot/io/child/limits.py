"""What reading a file may cost: memory, time and numbers."""

from __future__ import annotations

import math
import time

from dashpot.base.errors import ReadError

MEMORY = 1 << 30
"""Bytes of address space of the process that reads."""
LARGEST = 1 << 28
"""Bytes of all that is handed over: 33 million numbers."""
VALUES = LARGEST // 8
_SECONDS = 30.0
_LONGEST = 600.0
_OF_IT = 2 / 3
"""Part of that time for the rows of a text; the rest is for what is made of them."""
_PACE = 1e6
"""Bytes per second that the slowest reader of a large file makes."""


def seconds_for(size: int) -> float:
    """Return the time that reading so many bytes may take."""
    return min(max(_SECONDS, size / _PACE), _LONGEST)


class Patience:
    """What this process spends on a file that is parsed in it: no more than a child would get.

    Parameters
    ----------
    size : int, optional
        Bytes of the file; of one that is not known, as much as the largest may cost.
    """

    def __init__(self, size: int | None) -> None:
        self._most = _OF_IT * (_LONGEST if size is None else seconds_for(size))
        self._until = time.thread_time() + self._most

    def asked(self, line: int) -> None:
        """Raise a ReadError if it is spent at a line.

        Raises
        ------
        ReadError
            With what to do.
        """
        if time.thread_time() > self._until:
            raise ReadError(
                f"took more than {self._most:.0f} s to read up to line {line}, for hardly a row is "
                "like the one before it: take what stands between the rows out, or split the file"
            )


def within(count: int, what: str) -> None:
    """Raise a ReadError if that many numbers, in all arrays together, are no test.

    Raises
    ------
    ReadError
        With the count found and what to do.
    """
    if count > VALUES:
        raise ReadError(
            f"{what} {count} numbers in all, and at most {VALUES} are read; export fewer channels, "
            "a part of the test or a lower rate"
        )


def confine(seconds: float) -> None:
    """Hold this process to its memory and time, so far as the system can.

    Linux and FreeBSD hold memory. macOS takes the limit and does not enforce it, Windows has none
    of this kind: there time and numbers alone are held, and time by the parent.
    """
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent answers the keyboard, and ends us
    try:
        import resource
    except ImportError:
        return
    whole = math.ceil(seconds)
    for which, most in (
        (resource.RLIMIT_AS, MEMORY),
        (resource.RLIMIT_CPU, whole + 5),  # both ends, should the parent be gone
        (resource.RLIMIT_CORE, 0),
    ):
        held = (one for one in resource.getrlimit(which) if one != resource.RLIM_INFINITY)
        least = min([most, *held])
        try:
            resource.setrlimit(which, (least, least))
        except (OSError, ValueError):  # macOS refuses a limit below what is mapped
            continue
    signal.alarm(whole + 5)
