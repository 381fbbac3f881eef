"""Recognition of counterforce tables and of their columns."""

from __future__ import annotations

import re
from dataclasses import replace

from dashpot.base import units
from dashpot.reading.columns.kind_detection import NamedColumns
from dashpot.reading.columns.role_assignment import score_columns
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import Column, FileTable

_LONG_UNIT = 3600.0
"""Seconds in a unit of time too long for a bench test."""
_OTHER_TEST_ROLES: tuple[Role, ...] = (
    "displacement", "acceleration", "strain", "stress", "frequency",
)  # fmt: skip
"""Roles of motion and material: a table with them is another test."""
_RATIO = re.compile(r"\bf\s*/\s*f[_ ]?(0|o)\b|\bretain|\bretention|\bcounterforce|\bsealing force")
_DIGIT = re.compile(r"\d")
_NAME_PATTERN = re.compile(
    r"compression stress relaxation|\bcsr\b|\biso\W{0,2}3384\b|\bd6147\b|counterforce"
)


def has_counterforce(columns: NamedColumns) -> bool:
    """Return whether the columns are a force over hours or days."""
    return find_counterforce_columns(columns.table, columns.options) is not None


def find_counterforce_columns(table: FileTable, options: ReadOptions) -> ReadOptions | None:
    """Return the options with the columns of time and force; None for another table.

    A column that is called hours or days is a clock of that unit. Fractions of F0 are forces in an
    arbitrary unit, for the F0 of every specimen is fitted.
    """
    if any(_has_role(table, role, options) for role in _OTHER_TEST_ROLES):
        return None
    columns = [
        (str(i), column) for i, column in enumerate(table.columns, 1) if column.content == "number"
    ]
    clock = _find_clock(table, columns, options)
    is_stated = any(_NAME_PATTERN.search(line.casefold()) for line in table.header)
    if not (clock or is_stated):
        return None
    read_options = clock or options
    has_force = _has_role(table, "force", read_options)
    ratios = [number for number, column in columns if is_ratio(column)]
    if not (has_force or ratios):
        return None
    if has_force or options.force:
        return read_options
    return replace(read_options, force=ratios[0], units={**dict(read_options.units), "force": "N"})


def is_ratio(column: Column) -> bool:
    """Return whether a column holds fractions of F0."""
    if not _RATIO.search(column.name.casefold()):
        return False
    return column.unit is None or any(units.is_same_unit(column.unit, name) for name in ("%", "1"))


def _find_clock(
    table: FileTable, columns: list[tuple[str, Column]], options: ReadOptions
) -> ReadOptions | None:
    """Return the options with a clock of hours or more; None without one."""
    time_columns = {
        str(i + 1) for i, value in score_columns(table, "time", options).items() if value >= 1.5
    }
    for number, column in columns:
        if number in time_columns or options.time in {number, column.name}:
            return (
                options
                if _is_long_unit(options.unit_of("time", column.name) or column.unit)
                else None
            )
    for number, column in columns:
        if column.unit is None and _is_long_unit(column.name):
            return replace(options, time=number, units={**dict(options.units), "time": column.name})
    return None


def _is_long_unit(word: str | None) -> bool:
    # no word for a time holds a digit, and the names of thousands of channels do
    unit = None if not word or _DIGIT.search(word) else units.find_unit(word, "time")
    return unit is not None and unit.factor >= _LONG_UNIT


def _has_role(table: FileTable, role: Role, options: ReadOptions) -> bool:
    best = max(score_columns(table, role, options).values(), default=0.0)
    return bool(getattr(options, role)) or best >= 1.5
