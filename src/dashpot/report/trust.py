"""The table of checks."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.checks import Check
from dashpot.report.numbers import (
    readable,
    words,
)
from dashpot.report.table import Table


def checks(groups: Sequence[tuple[str, Sequence[Check]]]) -> Table:
    """Every check in words, failed ones first; what two stages said alike is said once."""
    seen: dict[tuple[str, str], tuple[str, Check]] = {}
    for stage, found in groups:
        for check in found:
            seen.setdefault((check.name, check.says), (stage, check))
    ordered = sorted(seen.values(), key=lambda pair: pair[1].passed)
    rows = tuple(
        ("passed" if check.passed else "failed", stage, words(check.name), readable(check.says))
        for stage, check in ordered
    )
    marks = tuple("good" if check.passed else "bad" for _, check in ordered)
    return Table(("", "stage", "question", "answer"), rows, marks)
