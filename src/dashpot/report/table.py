"""A table of the report: cells as text."""

from __future__ import annotations

from dataclasses import dataclass


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
