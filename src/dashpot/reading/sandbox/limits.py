"""Limits of reading a file: memory, time and numbers."""

from __future__ import annotations

import math

from dashpot.base.errors import ReadError

MEMORY = 1 << 30
"""Bytes of address space of the process that reads."""
MAX_SIZE = 1 << 28
"""Bytes of all that is handed over: 33 million numbers."""
VALUES = MAX_SIZE // 8


def check_value_count(count: int, subject: str) -> None:
    """Raise a ReadError if that many numbers, in all arrays together, are no test.

    Raises
    ------
    ReadError
        With the count found and what to do.
    """
    if count > VALUES:
        raise ReadError(
            f"{subject} {count} numbers in all, and at most {VALUES} are read; export fewer "
            "channels, a part of the test or a lower rate"
        )


def confine(seconds: float) -> None:
    """Limit memory and time of this process, as far as the system can.

    Linux and FreeBSD hold memory. macOS takes the limit and does not enforce it, Windows has none
    of this kind: there time and numbers alone are held, and time by the parent.
    """
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent answers the keyboard, and ends us
    try:
        import resource
    except ImportError:
        return
    whole_seconds = math.ceil(seconds)
    for key, maximum in (
        (resource.RLIMIT_AS, MEMORY),
        (resource.RLIMIT_CPU, whole_seconds + 5),  # both ends, should the parent be gone
        (resource.RLIMIT_CORE, 0),
    ):
        current = (index for index in resource.getrlimit(key) if index != resource.RLIM_INFINITY)
        new_limit = min([maximum, *current])
        try:
            resource.setrlimit(key, (new_limit, new_limit))
        except (OSError, ValueError):  # macOS refuses a limit below what is mapped
            continue
    signal.alarm(whole_seconds + 5)
