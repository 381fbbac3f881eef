"""Reproduction of the paper, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dashpot.base.units import convert_to_unit
from dashpot.text_output.layout import Text, table

if TYPE_CHECKING:
    from dashpot.extensions.paper.reproduction import Coefficient, Reproduction, Statement


def render_reproduction(reproduction: Reproduction) -> Text:
    """Return the results, Table 1 as printed and as reproduced, and every statement."""
    header = ("Table 1", "printed", "simulation, 95 %", "by the hold alone, 95 %", "unit")
    rows = [header, *map(_format_row, reproduction.table)]
    word = "reproduced" if reproduction.is_reproduced else "not reproduced"
    lines = [f"The paper is {word}: {reproduction.summary}", "", *table(rows)]
    details = ["", *(line for row in reproduction.rows for line in _format_statement(row))]
    return Text(lines, details)


def _format_row(coefficient: Coefficient) -> tuple[str, ...]:
    printed_text = f"{convert_to_unit(coefficient.printed, coefficient.full.reading):.4f}"
    intervals = (
        reported_value.cells.interval for reported_value in (coefficient.full, coefficient.hold)
    )
    return (coefficient.name, printed_text, *intervals, coefficient.full.cells.unit)


def _format_statement(row: Statement) -> list[str]:
    difference_text = f" (off by {row.difference:.1g})" if row.difference is not None else ""
    return [f"  {row.name}: {row.paper}", f"    {row.reproduced}{difference_text}"]
