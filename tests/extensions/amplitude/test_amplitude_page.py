"""The page of a fit of several levels: whole, safe, and the command's own numbers."""

import base64
import hashlib
import json
import re
from html import unescape

import pytest
from kit import levels
from kit.shell import run_json

from dashpot.reading.write import write_relaxation

pytestmark = pytest.mark.once


def test_the_page_holds_what_the_command_prints(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = "<b>loops & co.csv"
    write_relaxation(levels.loops(), tmp_path / name)
    printed = run_json("fit", name, "-o", "level.html")
    page = (tmp_path / "level.html").read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert "<b>loops" not in page
    assert name in unescape(page)
    (link,) = re.findall(
        r'download="levels.json" href="data:application/json;base64,([^"]+)"', page
    )
    assert json.loads(base64.b64decode(link)) == printed
    assert f">{printed['verdict']['verdict_grade'].capitalize()}<" in page
    # storage, loss, and the loops of four amplitudes beside each other
    assert page.count('<svg class="wide') == 6
    assert len(re.findall(r"<td>levels</td>", page)) == len(printed["checks"])
    for tag in ("style", "script"):
        (body,) = re.findall(rf"<{tag}[^>]*>(.*?)</{tag}>", page, flags=re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(body.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in unescape(page)
    assert not re.search(r"""(?:src|href)=["']?(?:https?:)?//""", page)
