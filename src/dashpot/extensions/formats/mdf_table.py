"""Table of the groups of an ASAM MDF file, on one clock."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Sequence
from functools import cached_property
from typing import BinaryIO

import numpy as np

from dashpot.base import dataclass, replace, units
from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Caution
from dashpot.extensions.formats import mdf3, mdf4
from dashpot.extensions.formats.mdf_records import MdfGroup, read_channels
from dashpot.extensions.formats.passed_channels import names_role_as_well, note_passed
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox.limits import check_value_count
from dashpot.reading.table import Column, FileTable, LoadedColumns

WHOLE_TABLE_VALUES = 1 << 22
"""Numbers of a table that is handed over with all of its columns."""
_ROLES: tuple[Role, ...] = ("force", "displacement", "acceleration", "velocity", "stress", "strain")
_LOADS, _MOTIONS = {"force", "stress"}, {"displacement", "strain", "acceleration"}
_SURE_SCORE, _LIKELY_SCORE = 2.0, 1.0
"""Scores of the name of a channel for a role of a test: sure, and likely."""
_MAX_GAP_STEPS = 10.0
"""Steps of its clock over which nothing is interpolated: something is missing there."""
_MAX_LISTED = 8
_UNFINISHED_SIGNATURE = b"UnFinMF "


@dataclass(frozen=True)
class _Place:
    """Position of a column: the group of each segment and its channel there; None for the rows."""

    groups: tuple[int, ...]
    channel: int


class MdfTable:
    """Groups of an open file, as columns on one clock."""

    def __init__(self, stream: BinaryIO, sheet: str | None) -> None:
        head = stream.read(64)
        if head.startswith(_UNFINISHED_SIGNATURE):
            raise ReadError(
                "an MDF file whose recording was not finished (UnFinMF): its counts of samples are "
                "not to be trusted; open and save it with the program that recorded it"
            )
        version = head[8:16].split(b"\0", 1)[0].decode("latin-1").strip()
        if version[:1] not in {"2", "3", "4"}:
            raise ReadError(f"an MDF file of version '{version}'; 2, 3 and 4 are read")
        self._stream = stream
        self.format = f"MDF {version}"
        try:
            content = (mdf4 if version[:1] == "4" else mdf3).read_blocks(stream)
        except struct.error:
            raise ReadError("damaged: a block is shorter than its kind") from None
        self.header = tuple(content.header)
        self.hints = tuple(content.hints.values())
        channel_names = [c.name for group in content.groups for c in group.channels if group.rows]
        self.notes: list[str] = note_passed(content.passed, channel_names)
        empty = [group for group in content.groups if not group.rows]
        if empty:
            note = f"no samples stand in {_list([group.name for group in empty])}"
            channel_names_lost = [channel.name for group in empty for channel in group.channels]
            self.notes.append(
                Caution(note) if names_role_as_well(channel_names_lost, channel_names) else note
            )
        groups = [
            group
            for group in content.groups
            if group.rows and any(not channel.clock for channel in group.channels)
        ]
        self._choose_groups(_name_groups_apart(groups), sheet)

    def _choose_groups(self, groups: list[MdfGroup], sheet: str | None) -> None:
        names = [group.name for group in groups]
        if sheet is not None:
            if sheet not in names:
                raise ReadError(f"--file-part sheet={sheet}: the groups are {_list(names)}")
            groups = [groups[names.index(sheet)]]
        if not groups:
            raise ReadError("this MDF file holds no samples of numeric channels")
        self._groups = groups
        self._lined_up: dict[int, FloatArray] = {}
        kinds = {tuple((c.name, c.unit) for c in group.channels) for group in groups}
        if len(kinds) == 1:
            self._base, self._segments = groups[0], tuple(range(len(groups)))
            self.segments = tuple(names) if len(groups) > 1 else ("",)
        else:
            base = self._find_base()
            self._base = self._groups[base]
            self._segments, self.segments = (base,), ("",)
        self.columns, self._places = self._columns()

    @property
    def rows(self) -> int:
        """Rows in all segments."""
        return sum(self._groups[i].rows for i in self._segments)

    @cached_property
    def starts(self) -> tuple[int, ...]:
        """First row of each segment."""
        counts = [self._groups[i].rows for i in self._segments]
        return tuple(int(i) for i in np.cumsum([0, *counts[:-1]]))

    def _columns(self) -> tuple[tuple[Column, ...], list[_Place]]:
        columns, column_places = [], []
        base = self._segments[0]
        order = [base, *(i for i in range(len(self._groups)) if i != base)]
        for i in order if len(self._segments) == 1 else [base]:
            group = self._groups[i]
            other_clock = i != base and self._note_clock(i)
            if i != base and not other_clock:
                continue
            segments = self._segments if i == base else (i,)
            clock = group.clock
            ordered_indices = sorted(
                range(len(group.channels)), key=lambda column_place: column_place != clock
            )
            for column_place in ordered_indices:
                channel = group.channels[column_place]
                if channel.clock and (i != base or column_place != clock):
                    continue
                name = channel.name
                if channel.clock and not vocabulary.matches(name).get("time"):
                    name = "time"
                unit = channel.unit or ("s" if channel.clock else None)
                columns.append(Column(name, unit))
                column_places.append(_Place(segments, column_place))
        counts = Counter(column.name for column in columns)
        named_columns = [
            replace(column, name=f"{column.name} ({self._groups[column_place.groups[0]].name})")
            if counts[column.name] > 1
            else column
            for column, column_place in zip(columns, column_places, strict=True)
        ]
        return tuple(named_columns), column_places

    def _note_clock(self, i: int) -> bool:
        """Return whether a group can be joined to the base group, and note how."""
        group, base = self._groups[i], self._base
        if group.clock is None or base.clock is None:
            if group.clock is None and base.clock is None and group.rows == base.rows:
                self.notes.append(
                    Caution(
                        f"groups '{base.name}' and '{group.name}' have no clock and {base.rows} "
                        "rows each: their rows were taken for simultaneous"
                    )
                )
                return True
            self._note_dropped(
                group,
                f"group '{group.name}' has no clock in common with '{base.name}' and was passed "
                f'over (--file-part sheet="{group.name}" reads it)',
            )
            return False
        clock_units = _get_clock_unit(group), _get_clock_unit(base)
        if clock_units[0] != clock_units[1] and None in (
            units.find_unit(unit, "time") for unit in clock_units
        ):
            self.notes.append(
                Caution(
                    f"the clocks of '{group.name}' ({clock_units[0]}) and '{base.name}' "
                    f"({clock_units[1]}) have no known common unit: the first was passed over"
                )
            )
            return False
        ticks, base_ticks = self._ticks(i), self._ticks(self._segments[0])
        if np.array_equal(ticks, base_ticks):
            return True
        if not (np.diff(ticks) > 0).all() or not np.isfinite(ticks).all():
            self._note_dropped(
                group,
                f"the clock of group '{group.name}' does not rise throughout: it was passed over",
            )
            return False
        common_count = int(((base_ticks >= ticks[0]) & (base_ticks <= ticks[-1])).sum())
        if not common_count:
            self._note_dropped(
                group, f"group '{group.name}' shares no time with '{base.name}' and was passed over"
            )
            return False
        self._lined_up[i] = ticks
        message = (
            f"group '{group.name}'{_format_rate(ticks)} has a clock of its own: its channels were "
            f"interpolated to the {common_count} of {base.rows} instants of '{base.name}'"
            f'{_format_rate(base_ticks)} within it; --file-part sheet="{group.name}" reads it alone'
        )
        moving = _list_roles(group) | _list_roles(base)
        # straight lines dull what is near half the sampling rate
        self.notes.append(Caution(message) if "acceleration" in moving else message)
        return True

    def _note_dropped(self, group: MdfGroup, note: str) -> None:
        """Note a group that is passed over: a caution if it may be a part of the test."""
        lost_names, kept_names = (
            [c.name for c in channel_group.channels if not c.clock]
            for channel_group in (group, self._base)
        )
        self.notes.append(Caution(note) if names_role_as_well(lost_names, kept_names) else note)

    def _find_base(self) -> int:
        """Return which group gives the clock.

        One with load and motion, and most roles of a test. If they are in several groups, the
        slowest of those: between its samples nothing is known, and interpolated values would look
        measured.
        """
        role_scores = [_list_roles(group, _LIKELY_SCORE) for group in self._groups]
        if not any(roles & _LOADS and roles & _MOTIONS for roles in role_scores):
            clocks = [
                (median(np.diff(self._ticks(i))), i)
                for i, (group, roles) in enumerate(zip(self._groups, role_scores, strict=True))
                if group.clock is not None and group.rows > 1 and roles & (_LOADS | _MOTIONS)
            ]
            if len(clocks) > 1:
                return max(clocks)[1]
        roles = [_list_roles(group) for group in self._groups]
        return max(
            range(len(roles)),
            key=lambda i: (len(roles[i]), "force" in roles[i], self._groups[i].rows),
        )

    def _ticks(self, i: int) -> FloatArray:
        """Return the clock of a group, s; in its own unit if that is not known."""
        group = self._groups[i]
        clock_channel = group.clock
        if clock_channel is None:
            raise ReadError(f"group '{group.name}' has no clock")
        ticks = read_channels(self._stream, group, [clock_channel])[0][:, 0]
        unit = units.find_unit(_get_clock_unit(group), "time")
        with np.errstate(invalid="ignore", over="ignore"):  # a damaged clock is passed over later
            return ticks * (unit.factor if unit else 1.0)

    def load(self, indexes: Sequence[int]) -> LoadedColumns:
        """Return the numbers of some columns, NaN where they are marked as invalid."""
        check_value_count(self.rows * len(indexes), "the channels hold")
        values = np.empty((self.rows, len(indexes)))
        notes: list[str] = []
        by_group: dict[tuple[int, ...], list[int]] = {}
        for position, index in enumerate(indexes):
            by_group.setdefault(self._places[index].groups, []).append(position)
        for groups, positions in by_group.items():
            channels = [self._places[indexes[position]].channel for position in positions]
            parts, counts = [], np.zeros(len(channels), int)
            for i in groups:
                part, invalid = read_channels(self._stream, self._groups[i], channels)
                parts.append(self._align(i, part))
                counts += invalid
            values[:, positions] = parts[0] if len(parts) == 1 else np.concatenate(parts)
            notes += [
                f"{count} numbers of '{self.columns[indexes[position]].name}' are marked as "
                "invalid by the file: they are no numbers"
                for position, count in zip(positions, counts, strict=True)
                if count
            ]
        return LoadedColumns(values, self.starts, self.segments, notes=tuple(notes))

    def _align(self, i: int, part: FloatArray) -> FloatArray:
        """Return the channels of a group at the instants of the base."""
        ticks = self._lined_up.get(i)
        if ticks is None:
            return part
        base_ticks = self._ticks(self._segments[0])
        steps = np.diff(ticks)
        is_gap = steps > _MAX_GAP_STEPS * median(steps) if len(steps) else steps > 0
        lower_index = np.clip(
            np.searchsorted(ticks, base_ticks, side="right") - 1, 0, max(len(ticks) - 2, 0)
        )
        is_outside = (base_ticks < ticks[0]) | (base_ticks > ticks[-1])
        is_outside |= (is_gap[lower_index] if len(is_gap) else False) & (
            base_ticks != ticks[lower_index]
        )
        columns = [_interpolate(base_ticks, ticks, lower_index, column) for column in part.T]
        result = np.column_stack(columns)
        result[is_outside] = np.nan
        return result

    def table(self) -> FileTable:
        """Return the table, its numbers read."""
        loaded_columns = self.load(range(len(self.columns)))
        return replace(
            self.description(), load=lambda indexes: replace(
                loaded_columns, values=loaded_columns.values[:, list(indexes)], notes=()),
            notes=(*self.notes, *loaded_columns.notes),
        )  # fmt: skip

    def description(self) -> FileTable:
        """Return the table without its numbers."""
        return FileTable(
            format=self.format, columns=self.columns, notes=tuple(self.notes), header=self.header,
            hints=self.hints,
            load=lambda indexes: LoadedColumns(np.empty((0, len(indexes)))),
            simulated=any("simulated" in line.casefold() for line in self.header),
        )  # fmt: skip


def describe(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table of a file; a large one without its numbers."""
    with raw.open() as stream:
        table = MdfTable(stream, options.sheet)
        if table.rows * len(table.columns) <= WHOLE_TABLE_VALUES:
            return table.table()
        return table.description()


def read_columns(raw: RawFile, options: ReadOptions, columns: Sequence[int]) -> FileTable:
    """Return some columns of a large file."""
    with raw.open() as stream:
        table = MdfTable(stream, options.sheet)
        loaded_columns = table.load(columns)
    return FileTable(
        format=table.format,
        columns=tuple(table.columns[index] for index in columns),
        notes=loaded_columns.notes,
        load=lambda indexes: replace(
            loaded_columns, values=loaded_columns.values[:, list(indexes)]
        ),
    )


def _interpolate(
    time: FloatArray, ticks: FloatArray, lower_index: np.ndarray, column: FloatArray
) -> FloatArray:
    """Return a column interpolated linearly, NaN next to an invalid sample."""
    if len(ticks) == 1:
        return np.where(time == ticks[0], column[0], np.nan)
    low, high = column[lower_index], column[lower_index + 1]
    with np.errstate(over="ignore", invalid="ignore"):
        ratio = (time - ticks[lower_index]) / (ticks[lower_index + 1] - ticks[lower_index])
        interpolated: FloatArray = low + ratio * (high - low)
    interpolated[ratio == 0], interpolated[ratio == 1] = low[ratio == 0], high[ratio == 1]
    return interpolated


def _get_clock_unit(group: MdfGroup) -> str:
    """Return the unit of the clock of a group, seconds where none is stated."""
    return (None if group.clock is None else group.channels[group.clock].unit) or "s"


def _list_roles(group: MdfGroup, score: float = _SURE_SCORE) -> set[str]:
    """Return the roles of a test that the channels of a group have by their names."""
    return {
        role
        for channel in group.channels
        for role in _ROLES
        if not channel.clock and vocabulary.matches(channel.name).get(role, 0.0) >= score
    }


def _name_groups_apart(groups: Sequence[MdfGroup]) -> list[MdfGroup]:
    """Return the groups, each with a unique name."""
    counts = Counter(group.name for group in groups)
    return [
        replace(group, name=f"{group.name} {i + 1}") if counts[group.name] > 1 else group
        for i, group in enumerate(groups)
    ]


def _format_rate(ticks: FloatArray) -> str:
    """Return the rate of a clock in brackets."""
    step = median(np.diff(ticks)) if len(ticks) > 1 else 0.0
    return f" ({1 / step:.4g} Hz)" if step > 0 else ""


def _list(names: Sequence[str]) -> str:
    names_text = ", ".join(f"'{name}'" for name in names[:_MAX_LISTED])
    return names_text + (
        f" and {len(names) - _MAX_LISTED} more" if len(names) > _MAX_LISTED else ""
    )
