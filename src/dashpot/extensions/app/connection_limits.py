"""Time limits of a connection: an incomplete request does not block a connection."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

HEAD_SECONDS = 10.0
"""Time limit of a request's head, from its first byte or the connection, s."""
BODY_SECONDS = 30.0
"""Time limit between two parts of a request's body, s."""


class LimitedProtocol(H11Protocol):
    """HTTP protocol that closes a connection with an incomplete request.

    The head of a request has `HEAD_SECONDS` in all, however slowly its bytes come; its body may
    pause for `BODY_SECONDS`. There is no limit while a response is computed.
    """

    _timer: asyncio.TimerHandle | None = None
    _in_head = False

    def connection_made(self, transport: Any) -> None:
        """Begin to wait for a request."""
        super().connection_made(transport)
        self._limit_wait()

    def data_received(self, data: bytes) -> None:
        """Take bytes of a request, and wait for the rest of it."""
        super().data_received(data)
        self._limit_wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """End every wait."""
        self._cancel()
        super().connection_lost(exc)

    def _limit_wait(self) -> None:
        cycle = self._get_cycle()
        in_head = cycle is None or cycle.response_complete
        if in_head and self._in_head and self._timer is not None:
            return  # one that drips wins no time
        self._cancel()
        self._in_head = in_head
        if in_head:
            self._timer = self.loop.call_later(HEAD_SECONDS, self._close)
        elif cycle.more_body:
            self._timer = self.loop.call_later(BODY_SECONDS, self._close)

    def _get_cycle(self) -> Any:
        """Return the request that is answered, or was last; None before the first."""
        return self.cycle

    def _close(self) -> None:
        self._timer = None
        # an answer may have begun since, or the connection may be gone
        cycle = self._get_cycle()
        is_waiting = cycle is None or cycle.response_complete or cycle.more_body
        if is_waiting and not self.transport.is_closing():
            self.transport.close()

    def _cancel(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
