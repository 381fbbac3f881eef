"""No regular expression of the readers is worth attacking."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.once

SCRIPT = Path(__file__).parents[1] / "kit" / "patterns.py"

pytest.importorskip("resource")


def last_line(*inputs: str) -> str:
    """What the child prints last; the kernel ends it where a pattern takes too long."""
    command = [sys.executable, str(SCRIPT), *inputs]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    return ended.stdout.splitlines()[-1]


def test_every_pattern_takes_a_time_in_proportion_to_its_text() -> None:
    assert last_line() == "done"


def test_pattern_check_detects_a_quadratic_expression() -> None:
    """The swiftest quadratic pattern that once stood here: runs of bare CR."""
    assert last_line(r"\r+\n") == r"\r+\n"
