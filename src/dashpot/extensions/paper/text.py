"""What ``dashpot demo --paper`` found, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dashpot.base.units import convert_to_unit
from dashpot.text_output.layout import Text, table

if TYPE_CHECKING:
    from dashpot.extensions.paper.reproduction import Coefficient, Reproduction, Statement


def render_reproduction(found: Reproduction) -> Text:
    """Return what came out, Table 1 as printed and as found, and every statement."""
    head = ("Table 1", "printed", "virtual rig, 95 %", "by the hold alone, 95 %", "unit")
    rows = [head, *map(_row, found.table)]
    word = "reproduced" if found.reproduced else "not reproduced"
    lines = [f"The paper is {word}: {found.says}", "", *table(rows)]
    details = ["", *(line for row in found.rows for line in _statement(row))]
    return Text(lines, details)


def _row(one: Coefficient) -> tuple[str, ...]:
    printed = f"{convert_to_unit(one.printed, one.full.reading):.4f}"
    intervals = (fact.cells.interval for fact in (one.full, one.hold))
    return (one.name, printed, *intervals, one.full.cells.unit)


def _statement(row: Statement) -> list[str]:
    off = f" (off by {row.off:.1g})" if row.off is not None else ""
    return [f"  {row.name}: {row.paper}", f"    {row.found}{off}"]
