"""From the columns of a table to channels in SI units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Source
from dashpot.base.units import Unit
from dashpot.io.columns.kinds import cycle_peaks, kind_of
from dashpot.io.columns.roles import Assigned, assign, list_columns, quoted, unit_for
from dashpot.io.columns.vocabulary import Role
from dashpot.io.formats.detect import read_table
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw, about
from dashpot.io.table import Loaded, Question, Table

_OVERLOAD = 9.9e37
"""What SCPI instruments send for an infinite or an invalid reading."""


@dataclass(frozen=True)
class Channel:
    """A column chosen for a role, with its unit and a line that says so."""

    role: Role
    index: int
    unit: Unit
    says: str


def sure_table(raw: Raw, options: ReadOptions) -> Table:
    """Return the table of a file.

    Raises
    ------
    ReadError
        If its numbers can be read two ways.
    """
    table = read_table(raw, options)
    if table.doubts:
        raise ReadError(f"{raw.name}: {table.doubts[0].says}")
    return table


def test_table(raw: Raw, options: ReadOptions) -> Table:
    """Return the table of a file that claims to be a test.

    Raises
    ------
    ReadError
        If its numbers can be read two ways, or it is a summary of cycles.
    """
    table = sure_table(raw, options)
    peaks = cycle_peaks(table)
    if peaks and not (options.force or options.displacement or options.acceleration):
        raise ReadError(f"{raw.name} is not a test: {peaks}")
    return table


def choose(raw: Raw, table: Table, roles: Sequence[Role], options: ReadOptions) -> list[Channel]:
    """Return the columns that play the roles.

    Raises
    ------
    ReadError
        With every question that the file leaves open, in one sentence each.
    """
    with about(raw):
        found = [assign(table, role, options) for role in roles]
    asked = [answer.says for answer in found if isinstance(answer, Question)]
    if asked:
        kind, reason = kind_of(table, options)
        if kind == "not-a-test":
            raise ReadError(f"{raw.name} is not a test: {reason}")
        raise ReadError(f"{raw.name}: " + "; ".join(asked))
    chosen = [answer for answer in found if isinstance(answer, Assigned)]
    for i, one in enumerate(chosen):
        for other in chosen[:i]:
            if other.index == one.index:
                raise ReadError(
                    f"{raw.name}: {quoted(table.columns, one.index)} would be both {other.role} "
                    f"and {one.role}; name the columns with --{other.role} and --{one.role}; they "
                    f"are {list_columns(table.columns)}"
                )
    return with_units(raw, table, chosen, options)


def with_units(
    raw: Raw, table: Table, chosen: Sequence[Assigned], options: ReadOptions
) -> list[Channel]:
    """Return assigned columns with their units.

    Raises
    ------
    ReadError
        With every unit that is missing, unknown or wrong, and how to give it.
    """
    found, asked = [], []
    for one in chosen:
        try:
            found.append(channel(table, one, options))
        except ReadError as error:
            asked.append(str(error))
    if asked:
        raise ReadError(f"{raw.name}: " + "; ".join(asked))
    return found


def channel(table: Table, one: Assigned, options: ReadOptions) -> Channel:
    """Return an assigned column with its unit."""
    column = table.columns[one.index]
    unit = unit_for(column, one.index + 1, one.role, options)
    says = f"{one.role}: {column.label(one.index + 1)} [{unit.word}]"
    return Channel(one.role, one.index, unit, says + (f" ({one.reason})" if one.reason else ""))


def rivals(table: Table, chosen: Sequence[Channel], options: ReadOptions) -> list[str]:
    """Say which other columns could have played a role, where one was clearly better."""
    taken = {one.index for one in chosen}
    notes = []
    for one in chosen:
        answer = assign(table, one.role, options)
        others = [i for i in getattr(answer, "rivals", ()) if i not in taken]
        if others:
            listed = ", ".join(quoted(table.columns, i) for i in others[:3])
            notes.append(
                f"{one.role} is {quoted(table.columns, one.index)}; {listed} could be too: "
                f"--{one.role} NAME chooses"
            )
    return notes


def source(raw: Raw, table: Table, channels: Sequence[Channel], notes: Sequence[str]) -> Source:
    """Return where the numbers came from."""
    lines = tuple(one.says for one in channels)
    return Source(raw.name, raw.sha256, table.format, lines, tuple(notes), table.simulated)


def si(values: FloatArray, unit: Unit) -> FloatArray:
    """Return values in SI, the same array scaled; 1000 mm is 1 m, so a factor 1/k divides."""
    inverse = round(1 / unit.factor) if 0 < unit.factor < 1 else 0
    if inverse > 1 and abs(unit.factor * inverse - 1) < 1e-15:
        values /= inverse
    elif unit.factor != 1.0:
        values *= unit.factor
    if unit.offset:
        values += unit.offset
    return values


def load(table: Table, indexes: Sequence[int], options: ReadOptions, file: str) -> Loaded:
    """Return the numbers of some columns: of the segment asked for, overload marks left out."""
    loaded = part(table.load(indexes), options, file)
    marks = 0
    for j in range(loaded.values.shape[1]):
        beyond = np.abs(loaded.values[:, j]) >= _OVERLOAD
        if beyond.any():
            marks += int(beyond.sum())
            loaded.values[beyond, j] = np.nan
    if marks:
        note = f"{marks} values of 9.9e37 or more are an instrument's overload mark, not numbers"
        loaded = replace(loaded, notes=(*loaded.notes, note))
    return loaded


def whole_rows(loaded: Loaded) -> tuple[FloatArray, tuple[str, ...]]:
    """Return the rows that lack no number, and notes: of loading, and how many are left out."""
    whole = np.isfinite(loaded.values).all(axis=1)
    missing = np.flatnonzero(~whole)
    if not missing.size:
        return loaded.values, loaded.notes
    first = loaded.where(int(missing[0]))
    note = f"{missing.size} rows lack a number and were left out, first {first}"
    return loaded.values[whole], (*loaded.notes, note)


def part(loaded: Loaded, options: ReadOptions, file: str) -> Loaded:
    """Return the segment asked for, or everything.

    Raises
    ------
    ReadError
        If there is no such segment.
    """
    if options.segment is None:
        return loaded
    count = len(loaded.starts)
    if options.segment > count:
        plural = "s" * (count != 1)
        raise ReadError(
            f"{file}: --segment {options.segment}, but the file has {count} segment{plural}"
        )
    stops = (*loaded.starts[1:], len(loaded.values))
    keep = np.zeros(len(loaded.values), dtype=bool)
    keep[loaded.starts[options.segment - 1] : stops[options.segment - 1]] = True
    return rows(loaded, keep)


def rows(loaded: Loaded, keep: BoolArray) -> Loaded:
    """Return some of the rows as one segment; each still knows its line."""
    if keep.all() and len(loaded.starts) == 1:
        return loaded
    kept = np.flatnonzero(keep)
    lines: tuple[tuple[int, int], ...] = ()
    if loaded.lines:
        firsts = {first for first, _ in loaded.lines}
        # a new run wherever a row is left out or the file itself breaks
        runs = [
            i for i, row in enumerate(kept) if i == 0 or kept[i - 1] != row - 1 or row in firsts
        ]
        lines = tuple((i, loaded.line(int(kept[i]))) for i in runs)
    return Loaded(loaded.values[kept], (0,), ("",), lines, loaded.notes)


def enough(loaded: Loaded, file: str, least: int = 8) -> None:
    """Refuse a table of too few rows."""
    count = len(loaded.values)
    if count < least:
        plural = "s" * (count != 1)
        raise ReadError(
            f"{file}: only {count} row{plural} of numbers; a test needs at least {least}"
        )
