"""Progress of a computation, reported to a listener; none listens by default."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_listener: ContextVar[Callable[[str], None] | None] = ContextVar("listener", default=None)


def send_progress(message: str) -> None:
    """Report the current step of a long computation, such as ``"fitting the relaxation test"``."""
    listener = _listener.get()
    if listener is not None:
        listener(message)


@contextmanager
def set_progress_listener(listener: Callable[[str], None]) -> Iterator[None]:
    """Pass progress messages inside the context to `listener`."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)
