"""Chromium without a window: what a page looks like to a reader. It is not needed to install.

A probe is a script that leaves one JSON value; the page is then a copy without its policy, which
would stop the probe.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PROGRAM = next(filter(None, map(shutil.which, NAMES)), None)

needs_browser = pytest.mark.skipif(
    PROGRAM is None, reason="no chromium on this machine (apt-get install chromium)"
)

DARK = "--blink-settings=preferredColorScheme=0"


def run(folder: Path, *flags: str) -> subprocess.CompletedProcess[str]:
    """Start it once, with a profile of its own."""
    assert PROGRAM is not None
    # as root, in a container, it has no sandbox of its own; the pages are ours
    common = (
        "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
        "--enable-logging=stderr", "--v=0", f"--user-data-dir={folder / 'profile'}",
    )  # fmt: skip
    return subprocess.run(
        [PROGRAM, *common, *flags], check=True, capture_output=True, text=True, timeout=120
    )


def probe(folder: Path, page: str, script: str, *, width: int, height: int, flags=()) -> Any:
    """What a script finds on a page in a window of that size, px."""
    bare = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page)
    found = (
        # a page's own modules have run when it is loaded
        "<script>addEventListener('load', () => { document.title = 'found:' + JSON.stringify((() =>"
        f" {{ {script} }})()); }});</script></body>"
    )
    inner = folder / "inner.html"
    inner.write_text(bare.replace("</body>", found), encoding="utf-8")
    # a window has a least width; a frame has not
    (folder / "outer.html").write_text(
        f'<body style="margin:0"><iframe src="inner.html" id="f" style="border:0;width:{width}px;'
        f'height:{height}px"></iframe><script>f.onload = () => {{ document.title = '
        "f.contentDocument.title; }</script>",
        encoding="utf-8",
    )
    said = run(
        folder, "--allow-file-access-from-files", "--virtual-time-budget=5000", "--dump-dom",
        f"--window-size={max(width, 800)},{height}", *flags, f"file://{folder / 'outer.html'}",
    ).stdout  # fmt: skip
    return json.loads(re.search(r"<title>found:(.*?)</title>", said, re.DOTALL)[1])
