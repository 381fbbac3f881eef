"""Access control of every route: this machine, page and user only."""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any
from urllib.parse import parse_qs, urlsplit

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

COOKIE = "dashpot-{port}"
"""Name of the cookie of one server: a browser shares cookies among the ports of a host."""
SECURITY_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = (
    (b"content-security-policy", SECURITY_POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)


class Guard:
    """Middleware that admits requests with the token, from the page itself, to this host.

    The address with ``?token=`` is good for a cookie (HttpOnly, SameSite=Strict) and leads on to
    the plain address; all else needs the cookie. A Host that is not this one is a rebound name, an
    Origin that is not this one is another page.

    Parameters
    ----------
    app : ASGI application
    port : int
    token : str, optional
    """

    def __init__(self, app: App, *, port: int, token: str | None = None) -> None:
        self._app = app
        self.token = token or secrets.token_urlsafe(24)
        self._cookie = COOKIE.format(port=port)
        self._hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request of the ASGI server, or pass it on."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            return
        headers = {
            name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]
        }
        refusal = self._refusal(scope, headers)
        if refusal:
            await _send_text(send, 403, refusal)
        elif "token=" in scope["query_string"].decode("latin-1"):
            flags = "Path=/; HttpOnly; SameSite=Strict"
            cookie = f"{self._cookie}={self.token}; {flags}".encode()
            await _send_text(send, 303, "", (b"location", b"/"), (b"set-cookie", cookie))
        else:
            # the page has shown the fault, and a request pending at the end gets no answer; a log
            # would quote its contents
            with contextlib.suppress(Exception, asyncio.CancelledError):
                await self._app(scope, receive, _add_security_headers(send))

    def _refusal(self, scope: Scope, headers: dict[str, str]) -> str:
        """Return why a request is refused; "" if it is allowed."""
        if headers.get("host") not in self._hosts:
            return "this page is served under 127.0.0.1 alone"
        origin = headers.get("origin")
        if origin is not None and _get_host(origin) not in self._hosts:
            return "this request comes from another page"
        token = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        if scope["path"] == "/" and token:
            return "" if self._is_valid_token(token) else "the token is not this server's"
        cookie = dict(
            part.strip().partition("=")[::2] for part in headers.get("cookie", "").split(";")
        ).get(self._cookie, "")
        return "" if self._is_valid_token(cookie) else "open the address that 'dashpot app' printed"

    def _is_valid_token(self, token: str) -> bool:
        return hmac.compare_digest(token.encode(), self.token.encode())


def _get_host(origin: str) -> str:
    """Return host and port of an origin; "" for an invalid address."""
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return ""


def _add_security_headers(send: Send) -> Send:
    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message.get("headers", []), *_HEADERS]
        await send(message)

    return send_with_headers


async def _send_text(
    send: Send, status: int, text: str, *extra_headers: tuple[bytes, bytes]
) -> None:
    headers = [(b"content-type", b"text/plain; charset=utf-8"), *_HEADERS, *extra_headers]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": text.encode()})
