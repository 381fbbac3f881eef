"""Chromium without a window: what a page looks like to a reader. It is not needed to install."""

from __future__ import annotations

import shutil
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PROGRAM = next(filter(None, map(shutil.which, NAMES)), None)

needs_browser = pytest.mark.skipif(
    PROGRAM is None, reason="no chromium on this machine (apt-get install chromium)"
)


def probe(browser: Any, page: str, script: str, *, width: int, height: int, **how: Any) -> Any:
    """What a script finds on a page in a window of that size, px; its policy would stop it."""
    context = browser.new_context(
        viewport={"width": width, "height": height}, bypass_csp=True, **how
    )
    try:
        window = context.new_page()
        # a page's own modules have run when it is loaded
        window.set_content(page, wait_until="load")
        return window.evaluate(f"() => {{ {script} }}")
    finally:
        context.close()
