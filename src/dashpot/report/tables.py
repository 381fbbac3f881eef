"""A table of the report: cells as text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dashpot.base.checks import Check
from dashpot.base.numbers import readable, words


@dataclass(frozen=True)
class Table:
    """Head and rows; `marks` names a style for a row: "good", "bad", "doubt" or ""."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    marks: tuple[str, ...] = ()
    caption: str = ""

    def mark(self, row: int) -> str:
        """The style of a row."""
        return self.marks[row] if row < len(self.marks) else ""


def halves(table: Table) -> tuple[Table, Table]:
    """A long narrow table as two, to stand side by side."""
    middle = (len(table.rows) + 1) // 2
    return Table(table.head, table.rows[:middle]), Table(table.head, table.rows[middle:])


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
