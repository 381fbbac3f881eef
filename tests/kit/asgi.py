"""A client without a network: one request to an ASGI application, one answer."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import unquote


@dataclass(frozen=True)
class Answer:
    """What came back."""

    status_code: int
    headers: dict[str, str]
    content: bytes

    def json(self) -> Any:
        """The body as JSON."""
        return json.loads(self.content)


@dataclass
class Client:
    """Like a browser as far as these tests need one: it knows its host and keeps cookies."""

    app: Any
    host: str
    cookies: dict[str, str] = field(default_factory=dict)

    def request(
        self, method: str, target: str, content: bytes = b"", headers: dict[str, str] | None = None
    ) -> Answer:
        """Send one request; a target is taken as it stands, dots and all."""
        path, _, query = target.partition("?")
        sent = {"host": self.host, **(headers or {})}
        if self.cookies:
            sent["cookie"] = "; ".join(f"{name}={value}" for name, value in self.cookies.items())
        scope = {
            "type": "http", "method": method, "path": unquote(path), "raw_path": path.encode(),
            "query_string": query.encode(), "root_path": "", "http_version": "1.1",
            "headers": [(name.encode(), value.encode()) for name, value in sent.items()],
        }  # fmt: skip
        output: list[Any] = []

        async def receive() -> dict[str, Any]:
            return {"type": "http.request", "body": content, "more_body": False}

        async def send(message: Any) -> None:
            output.append(message)

        asyncio.run(self.app(scope, receive, send))
        start = output[0]
        texts = {name.decode(): value.decode() for name, value in start["headers"]}
        if "set-cookie" in texts:
            name, _, value = texts["set-cookie"].partition(";")[0].partition("=")
            self.cookies[name] = value
        return Answer(
            start["status"], texts, b"".join(item.get("body", b"") for item in output[1:])
        )

    def get(self, target: str, **how: Any) -> Answer:
        """Ask for something."""
        return self.request("GET", target, **how)
