"""How a result is laid out as text: lines, tables of cells, tables of named numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from dashpot.base.reported_values import ReportedValue


class Text(NamedTuple):
    """What a command prints: what everyone reads, and what is there for who asks.

    Attributes
    ----------
    lines
        Cut where they are longer than a screen.
    details
        For ``-v`` alone.
    asked
        What an option asked for: never cut.
    """

    lines: Sequence[str] = ()
    details: Sequence[str] = ()
    asked: Sequence[str] = ()


def table(rows: Sequence[Sequence[str]], *, left: bool = False) -> list[str]:
    """Return rows of cells as lines of aligned columns: the first, or all, to the left."""
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    sides = ["-" if left or i == 0 else "" for i in range(len(widths))]
    form = "".join(f"  %{side}{width}s" for side, width in zip(sides, widths, strict=True))
    return [(form % tuple(row)).rstrip() for row in rows]


def facts(reported_values: Sequence[ReportedValue]) -> list[str]:
    """Return named numbers as a table: value, error, interval and unit, where any has one."""
    head = ("", "value", "± SE", "95 % interval", "unit")
    rows = [value.cells.ascii for value in reported_values]
    some = [i for i in range(len(head)) if any(row[i] for row in rows)]
    return table([[row[i] for i in some] for row in (head, *rows)])
