"""The app in a real browser: a server of its own, a page, and what went wrong on it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from kit.browser import PROGRAM

WINDOW = {"width": 1366, "height": 768}
"""Of the page, px."""


@contextmanager
def serving(*files: str) -> Iterator[tuple[str, int]]:
    """The address of a server with these files and its process, until the end of the block."""
    words = [sys.executable, "-m", "dashpot", "app", "--no-browser", *files]
    with (
        tempfile.TemporaryDirectory() as state,
        subprocess.Popen(
            words, stdout=subprocess.PIPE, text=True, env={**os.environ, "DASHPOT_STATE": state}
        ) as server,
    ):
        try:
            assert server.stdout is not None
            yield server.stdout.readline().strip(), server.pid
        finally:
            server.terminate()


@contextmanager
def serve_app(*files: str) -> Iterator[str]:
    """Its address alone."""
    with serving(*files) as (address, _):
        yield address


class Page:
    """A page of Playwright with what it complained of.

    Attributes
    ----------
    at : Page of Playwright
    complaints : list of str
        Errors of the console, exceptions, requests that left the machine.
    at_first : str
        What its list of files said when it was opened first, where a test asks for that.
    """

    at_first = ""

    def __init__(self, browser: Any, address: str, *, fresh: bool = True, **how: Any) -> None:
        self.complaints: list[str] = []
        self._address = address
        self.context = browser.new_context(**({"viewport": WINDOW, "accept_downloads": True} | how))
        self.at = self.context.new_page()
        self.at.set_default_timeout(120_000)  # of what is a second where nobody else computes
        self.at.on("console", self._console)
        self.at.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.at.on("request", self._request)
        if fresh:
            self._forget()
        self._open()

    def _open(self) -> None:
        self.at.goto(self._address)
        self.at.locator("body[data-ready=true]").wait_for()

    def _forget(self) -> None:
        """What an earlier page left is not this one's."""
        self.context.request.get(self._address)
        self.context.request.put(f"{self._address.partition('?')[0]}api/state", data={})

    def anew(self) -> Page:
        """Open the app as new in the same window: another window takes a browser two seconds."""
        self._forget()
        self.complaints.clear()
        self.at.set_viewport_size(WINDOW)
        self.at.emulate_media(color_scheme="null")
        self._open()
        return self

    def leave(self) -> None:
        """Go from the app, and nothing may have gone wrong on it."""
        complaints = self.complaints[:]
        for other in self.context.pages:
            if other is not self.at:
                other.close()
        self.at.unroute_all(behavior="ignoreErrors")
        # of the same server, whose page then needs no process of its own
        self.at.goto(f"{self._address.partition('?')[0]}static/icon.svg")
        assert not complaints, complaints

    def _console(self, message: Any) -> None:
        # a browser seeks one for the picture that is left to, and may say so late
        if message.location["url"].endswith("/favicon.ico"):
            return
        # a refusal of the server is a sentence on the page, and the browser's own line about it
        if message.type == "error" and "422" not in message.text and "409" not in message.text:
            self.complaints.append(message.text)

    def _request(self, request: Any) -> None:
        if not request.url.startswith(("http://127.0.0.1:", "blob:", "data:")):
            self.complaints.append(f"left the machine: {request.url}")

    def file(self, name: str) -> Any:
        """Where a file stands in the list, whatever else on the page names it."""
        return self.at.locator("#files .file").filter(has_text=name)

    def remove(self, name: str) -> None:
        """Take a file off the list, in the list."""
        away = self.at.locator("#files").get_by_role("button", name=f"remove {name}", exact=True)
        away.click()

    def done(self) -> None:
        """Wait until nothing is computed any more, and all of it is."""
        self.still()
        fault = self.at.get_by_text("a fault of dashpot's own")
        done = self.at.get_by_role("status").filter(has_text="done in")
        done.or_(fault).first.wait_for()
        # a fault ends the wait for what never comes
        assert not fault.count(), fault.first.inner_text()

    def still(self) -> None:
        """Wait until no answer is awaited; what was just done to the page has then been heard."""
        self.at.evaluate(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
        )
        self.at.locator("body:not([data-busy=true])").wait_for()

    def close(self) -> None:
        """Close the window, and nothing may have gone wrong."""
        self.context.close()
        assert not self.complaints, self.complaints


@contextmanager
def chromium() -> Iterator[Any]:
    """The browser that the system has."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=PROGRAM, args=["--no-sandbox"])
        try:
            yield browser
        finally:
            browser.close()
