"""Channels in SI units from the columns of a table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

import numpy as np

from dashpot.base import dataclass, replace, units
from dashpot.base.arrays import BoolArray, FloatArray, median, slices
from dashpot.base.checks import Check
from dashpot.base.errors import ReadError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Caution, Source, list_cautions
from dashpot.base.units import Unit
from dashpot.reading.columns.file_kinds import FileKind
from dashpot.reading.columns.kind_detection import (
    detect_table_kind,
    explain_cycle_summary,
    refuse_kind,
)
from dashpot.reading.columns.role_assignment import (
    EXAMPLE,
    RoleAssignment,
    accelerations,
    assign_role,
    explain_missing_units,
    format_column,
    get_unit,
    get_unit_word,
    join_questions,
    list_columns,
    quote_column,
)
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.formats import read_table
from dashpot.reading.raw_file import RawFile, add_name_to_errors, open_raw
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.table import Column, FileTable, LoadedColumns, Question

SizeCheckFunction: TypeAlias = Callable[
    [Mapping[Role, float], Mapping[Role, str], AbstractSet[Role]],
    Sequence[tuple[Role, Sequence[Check]]],
]
"""Function that checks the sizes of a test with other units."""
_OVERLOAD = 9.9e37
"""Number that SCPI instruments send for an infinite or an invalid reading."""
_MIN_NINES = 999.0
"""The smallest number, all nines, that loggers write for no reading: 999, -9999, 999.99."""
_RATE_TOLERANCE = 0.01
"""Largest relative deviation of the steps of an even clock, and of its stated rate."""
_MARK_RATIO = 5.0
"""Factor of such a number over all others of its column."""


@dataclass(frozen=True, eq=False)
class OpenedFile:
    """File with its table and the user's reading options."""

    raw: RawFile
    table: FileTable
    options: ReadOptions
    is_cached: bool = False
    """Whether the columns read last are kept."""

    def column(self, role: Role) -> RoleAssignment | None:
        """Return the column of a role, if there is only one."""
        answer = assign_role(self.table, role, self.options)
        return answer if isinstance(answer, RoleAssignment) else None

    def find_unambiguous_column(self, role: Role) -> RoleAssignment | None:
        """Return the column of a role; ask if there are several.

        Raises
        ------
        ReadError
        """
        answer = assign_role(self.table, role, self.options)
        if isinstance(answer, RoleAssignment):
            return answer
        if answer.choices:
            raise ReadError(answer.message)
        return None

    def unit(self, index: int, role: Role) -> Unit:
        """The unit of a column in a role, as
        :func:`~dashpot.reading.columns.role_assignment.get_unit`.
        """
        return get_unit(self.table.columns[index], index + 1, role, self.options)

    def unit_word(self, index: int, role: Role) -> str | None:
        """Return the unit of a column by the options or the file; or None."""
        return get_unit_word(self.table.columns[index], role, self.options)


@dataclass(frozen=True)
class Channel:
    """Column chosen for a role, with its unit and a note."""

    role: Role
    index: int
    unit: Unit
    message: str


@contextmanager
def open_file(
    path: str | Path, options: ReadOptions | None, *, refuse_questions: bool = True
) -> Iterator[OpenedFile]:
    """Open a file for a reader: errors inside the block name the file.

    Raises
    ------
    ReadError
        If it cannot be read, or, where it must be `refuse_questions`, its numbers can be read two
        ways.
    """
    options = (options or ReadOptions()).for_file(path)
    file = pop_cached_file(path, options) or open_table(open_raw(path), options)
    with add_name_to_errors(file.raw.name):
        if refuse_questions and file.table.questions:
            raise ReadError(file.table.questions[0].message)
        yield file


def open_table(raw: RawFile, options: ReadOptions) -> OpenedFile:
    """Return a file with the table found in it, without the questions that options answer."""
    table = read_table(raw, options)
    if options.window_decay is not None and table.questions:
        questions = [
            question
            for question in table.questions
            if not question.option.startswith(flag("window_decay"))
        ]
        table = replace(table, questions=tuple(questions))
    return OpenedFile(raw, table, options)


_OPEN_FILES: dict[object, OpenedFile] = {}
"""Files that were looked at and are about to be read."""
_MAX_OPEN_FILES = 16
"""Number of kept ones."""


def cache_open_file(path: str | Path, file: OpenedFile) -> None:
    """Cache an open file for the next reader with the same options, so that it is parsed once."""
    key = _key(path, file.options)
    if key is not None:
        while len(_OPEN_FILES) >= _MAX_OPEN_FILES:
            _OPEN_FILES.pop(next(iter(_OPEN_FILES)), None)
        _OPEN_FILES[key] = file


def pop_cached_file(path: str | Path, options: ReadOptions) -> OpenedFile | None:
    """Return a file that was left open, which then is so no longer."""
    return _OPEN_FILES.pop(_key(path, options), None) if _OPEN_FILES else None


def _key(path: str | Path, options: ReadOptions) -> object:
    """Return the cache key of a file with its options, valid until the file changes."""
    try:
        stat = Path(path).stat()
    except (OSError, ValueError):  # stdin, or no such file
        return None
    return stat.st_dev, stat.st_ino, stat.st_size, stat.st_mtime_ns, options


def read_once(file: OpenedFile) -> OpenedFile:
    """Return the file with a cache of the loaded columns."""
    if file.is_cached:
        return file
    columns: dict[tuple[int, ...], LoadedColumns] = {}

    def load(indexes: Sequence[int]) -> LoadedColumns:
        requested = tuple(indexes)
        if requested not in columns:
            columns.clear()
            columns[requested] = file.table.load(indexes)
        # who cleans them must not clean the next one's
        return replace(columns[requested], values=columns[requested].values.copy(order="K"))

    return replace(file, table=replace(file.table, load=load), is_cached=True)


def refuse_summary(file: OpenedFile) -> None:
    """Refuse a table of one row per cycle, unless the user names its columns."""
    options = file.options
    peaks = explain_cycle_summary(file.table)
    if peaks and not (options.force or options.displacement or options.acceleration):
        raise ReadError(f"is not a test: {peaks}")


def refuse_other_kinds(
    file: OpenedFile,
    accepted: Sequence[FileKind],
    wanted_kind: str,
    *,
    stated_columns: Sequence[str],
) -> None:
    """Refuse a file that is surely of another kind, with the command that takes it.

    Nothing is refused if the options name a column of one of the roles `stated_columns`.

    Raises
    ------
    ReadError
    """
    if not any(getattr(file.options, name) for name in stated_columns):
        refuse_kind(file.table, file.options, accepted, wanted_kind)


def choose_channels(file: OpenedFile, roles: Sequence[Role]) -> list[Channel]:
    """Return the columns that play the roles, with their units.

    Raises
    ------
    ReadError
        With every question that the file leaves open, in one sentence each.
    """
    return add_units(file, select_columns(file, roles))


def select_columns(
    file: OpenedFile, roles: Sequence[Role], *, other_questions: Sequence[Question] = ()
) -> list[RoleAssignment]:
    """Return the columns of the roles; raise their open questions with `other_questions`.

    Raises
    ------
    ReadError
        With every question that the file leaves open, in one sentence each.
    """
    answers = [*(assign_role(file.table, role, file.options) for role in roles), *other_questions]
    if any(isinstance(answer, Question) for answer in answers):
        kind, reason = detect_table_kind(file.table, file.options)
        if kind == "not-a-test":
            raise ReadError(f"is not a test: {reason}")
    columns = require_answers(file, answers)
    roles_of: dict[int, Role] = {}
    for column in columns:
        other = roles_of.setdefault(column.index, column.role)
        if other != column.role:
            raise ReadError(
                format_role_conflict(file.table.columns, column.index, other, column.role)
            )
    return columns


def format_role_conflict(columns: Sequence[Column], index: int, name: Role, other: Role) -> str:
    """Return the message for a column that would have two roles."""
    return (
        f"{format_column(columns, index)} would be both {name} and {other}; name the columns with "
        f"{flag(name)}=NAME and {flag(other)}=NAME; they are {list_columns(columns)}"
    )


def require_answers(
    file: OpenedFile, assignments: Sequence[RoleAssignment | Question], hint: str = ""
) -> list[RoleAssignment]:
    """Return the columns found, or raise every question in one sentence with the hint."""
    questions = [answer for answer in assignments if isinstance(answer, Question)]
    if questions:
        raise ReadError(join_questions(file.table, questions) + hint)
    return [answer for answer in assignments if isinstance(answer, RoleAssignment)]


def add_units(file: OpenedFile, assignments: Sequence[RoleAssignment]) -> list[Channel]:
    """Return assigned columns with their units.

    Raises
    ------
    ReadError
        With every unit that is missing, unknown or wrong, and how to give it.
    """
    without_unit = [
        assignment
        for assignment in assignments
        if file.unit_word(assignment.index, assignment.role) is None
    ]
    grouped = without_unit if len(without_unit) > 1 else []
    channels, requested = [], [explain_missing_units(file.table, grouped)] if grouped else []
    for item in assignments:
        if item in grouped:
            continue
        try:
            unit = file.unit(item.index, item.role)
        except ReadError as error:
            requested.append(str(error))
            continue
        reason_text = f" ({item.reason})" if item.reason else ""
        label = file.table.columns[item.index].label(item.index + 1)
        message = f"{item.role}: {label} [{unit.word}]{reason_text}"
        channels.append(Channel(item.role, item.index, unit, message))
    if requested:
        raise ReadError("; ".join(requested))
    return channels


def refuse_sizes(
    file: OpenedFile, size_checks: Sequence[tuple[Channel, Sequence[Check]]]
) -> list[str]:
    """Ask for the first unit that makes an unbelievable size; return notes on unusual ones.

    The user's own word for a unit is not doubted.

    Raises
    ------
    ReadError
    """
    notes: list[str] = []
    for channel, checks in size_checks:
        failed = [check for check in checks if check.failed and not is_stated(file, channel)]
        if requested := [check.message_with_option for check in failed if check.grade == "stop"]:
            raise ReadError(requested[0])
        notes += [Caution(check.message_with_option, check.message_with_remedy) for check in failed]
    return notes


def refuse_all_sizes(
    file: OpenedFile, channels_chosen: Sequence[Channel], function: SizeCheckFunction
) -> list[str]:
    """Ask together for all units that make a size impossible; return notes on unusual sizes.

    All questions are collected: each is taken as answered before the next is searched for. The
    user's own word for a unit is not doubted.

    Parameters
    ----------
    function : callable
        Function of the factor and the unit of every role, and of the roles with stated units;
        returns the checks of each role.

    Raises
    ------
    ReadError
    """
    unit_of = {channel.role: channel.unit for channel in channels_chosen}
    stated_roles = {channel.role for channel in channels_chosen if is_stated(file, channel)}
    questions: list[str] = []
    while True:
        times = {
            channel.role: unit_of[channel.role].factor / channel.unit.factor
            for channel in channels_chosen
        }
        words = {role: unit.word for role, unit in unit_of.items()}
        failed = [
            (role, check)
            for role, checks in function(times, words, stated_roles)
            if role not in stated_roles
            for check in checks
            if check.failed
        ]
        stop_checks = [item for item in failed if item[1].grade == "stop"]
        if not stop_checks:
            break
        role, check = stop_checks[0]
        questions.append(check.message_with_option)
        stated_roles.add(role)
        likelier = check.remedy.value.partition("=")[2] if check.remedy else ""
        unit_of[role] = units.find_unit(likelier, unit_of[role].dimension) or unit_of[role]
    if questions:
        raise ReadError(" ".join(questions))
    return [Caution(check.message_with_option, check.message_with_remedy) for _, check in failed]


def is_stated(file: OpenedFile, channel: Channel) -> bool:
    """Whether the unit of a channel is stated by the user or in each cell, as of clock times."""
    column = file.table.columns[channel.index]
    return column.content == "clock" or file.options.unit_of(channel.role, column.name) is not None


def refuse_other_rate(file: OpenedFile) -> None:
    """Refuse a rate that the file's own even clock contradicts.

    A clock that is uneven, coarse or without a unit is not used: the rate replaces it.

    Raises
    ------
    ReadError
    """
    answer, rate = file.column("time"), file.options.rate
    if rate is None or answer is None:
        return
    try:
        unit = file.unit(answer.index, "time")
    except ReadError:
        return
    ticks = load(file.table, [answer.index], file.options.segment, refuse_questions=False).values[
        :, 0
    ]
    steps = np.diff(scale_to_si(ticks[np.isfinite(ticks)], unit))
    step = median(steps) if len(steps) else 0.0
    is_even = step > 0 and np.mean(np.abs(steps / step - 1) < _RATE_TOLERANCE) > 1 - _RATE_TOLERANCE
    if is_even and abs(rate * step - 1) > _RATE_TOLERANCE:
        raise ReadError(
            f"--rate {rate:g}Hz, but the clock in "
            f"{format_column(file.table.columns, answer.index)} runs "
            f"at {1 / step:.6g} Hz: leave --rate out, or, if its unit is another, say it instead: "
            '--units "time=ms"; a clock that is wrong altogether is taken out of the file first'
        )


def format_role_options(file: OpenedFile, columns: Sequence[tuple[Role, int]]) -> str:
    """Return the options that give roles to columns, with the usual units, as they are typed."""
    words = [f'{flag(role)}="{quote_column(file.table.columns, index)}"' for role, index in columns]
    unit_options = dict.fromkeys(f"{role}={EXAMPLE[role]}" for role, _ in columns)
    return f'{" ".join(words)} --units "{",".join(unit_options)}"'


def describe_alternatives(file: OpenedFile, channels_chosen: Sequence[Channel]) -> list[str]:
    """Return notes on other columns that could have had a role."""
    taken_columns = {channel.index for channel in channels_chosen}
    columns = file.table.columns
    notes = []
    for item in channels_chosen:
        if item.role == "acceleration":  # there may be several
            continue
        answer = file.column(item.role)
        other_columns = [i for i in answer.alternatives if i not in taken_columns] if answer else []
        if other_columns:
            columns_text = ", ".join(format_column(columns, i) for i in other_columns[:3])
            notes.append(
                f"{item.role} is {format_column(columns, item.index)}; {columns_text} could be "
                f"too: {flag(item.role)}=NAME chooses"
            )
    return notes


def find_optional_column(file: OpenedFile, role: Role) -> tuple[RoleAssignment | None, list[str]]:
    """Return the column of a role that a test may have beside its own, and notes.

    Where several could play it none is taken, with a note.
    """
    answer = assign_role(file.table, role, file.options)
    if isinstance(answer, RoleAssignment):
        return answer, []
    return None, [f"no {role} is taken: {answer.message}"] if answer.choices else []


def make_source(file: OpenedFile, columns: Sequence[str], notes: Sequence[str]) -> Source:
    """Return where the numbers came from."""
    raw, table = file.raw, file.table
    return Source(
        raw.name, raw.sha256, table.format, tuple(columns), tuple(notes), table.simulated,
        list_cautions(notes),
    )  # fmt: skip


def scale_to_si(values: FloatArray, unit: Unit) -> FloatArray:
    """Return values in SI, the same array scaled; 1000 mm is 1 m, so a factor 1/k divides."""
    inverse = round(1 / unit.factor) if 0 < unit.factor < 1 else 0
    if inverse > 1 and abs(unit.factor * inverse - 1) < 1e-15:
        values /= inverse
    elif unit.factor != 1.0:
        values *= unit.factor
    if unit.offset:
        values += unit.offset
    return values


def convert_signals_to_si(
    values: FloatArray, selection: Sequence[Channel]
) -> dict[Role, FloatArray]:
    """Return the columns of loaded values, in the order chosen, in SI units by their role."""
    columns = ((channel, np.ascontiguousarray(values[:, j])) for j, channel in enumerate(selection))
    return {channel.role: scale_to_si(column, channel.unit) for channel, column in columns}


def add_time_role(file: OpenedFile, *roles: Role) -> list[Role]:
    """Return the roles after that of the time, which is not needed where a rate is given."""
    return list(roles) if file.options.rate else ["time", *roles]


def load(
    table: FileTable, indexes: Sequence[int], segment: int | None, *, refuse_questions: bool = True
) -> LoadedColumns:
    """Return the numbers of some columns: of the segment requested, overload marks omitted.

    Raises
    ------
    ReadError
        If there is no such segment, or, where it must be `refuse_questions`, its numbers leave a
        doubt.
    """
    loaded_data = select_segment(table.load(indexes), segment)
    if refuse_questions and loaded_data.questions:
        raise ReadError(loaded_data.questions[0][1].message)
    extremes = (
        np.fmax.reduce(loaded_data.values, initial=0.0),
        -np.fmin.reduce(loaded_data.values, initial=0.0),
    )
    tops = np.fmax(*extremes)
    large_indices = np.flatnonzero(tops >= _MIN_NINES)
    marked_columns = [
        j
        for j, top in zip(large_indices.tolist(), tops[large_indices].tolist(), strict=True)
        if _is_mark(top)
    ]
    notes = [
        note for j in marked_columns for note in _remove_marks(loaded_data.values[:, j], tops[j])
    ]
    return replace(loaded_data, notes=(*loaded_data.notes, *notes)) if notes else loaded_data


def _is_mark(top: float) -> bool:
    """Whether the largest size of a column may be a mark of no reading: by its digits alone."""
    return top >= _OVERLOAD or not f"{top:.10g}".strip("9.")


def _remove_marks(column: FloatArray, top: float) -> list[str]:
    """Take the marks of no reading, of the largest size, out of a column, with a note."""
    magnitude = np.abs(column)
    if top >= _OVERLOAD:
        is_overload = magnitude >= _OVERLOAD
        message = "values of 9.9e37 or more are an instrument's overload mark, not numbers"
    else:
        is_overload = magnitude == top
        rest = float(np.fmax.reduce(magnitude[~is_overload], initial=0.0))
        if not is_overload.any() or rest * _MARK_RATIO > top:
            return []
        message = (
            f"values of {column[is_overload][0]:.10g}, far beyond all others, are a mark of "
            "no reading"
        )
    column[is_overload] = np.nan
    return [f"{is_overload.sum()} {message}"]


def load_test(
    file: OpenedFile, channels_chosen: Sequence[Channel], min_count: int = 8
) -> LoadedColumns:
    """Return the numbers of the chosen columns of a test, in the file's units.

    Raises
    ------
    ReadError
        If there are fewer than `min_count` rows.
    """
    loaded_columns = load(
        file.table, [channel.index for channel in channels_chosen], file.options.segment
    )
    count = len(loaded_columns.values)
    if count < min_count:
        raise ReadError(
            f"only {format_count(count, 'row')} of numbers; a test needs at least {min_count}"
        )
    return loaded_columns


def fill_down(loaded_columns: LoadedColumns, roles: Sequence[Role]) -> LoadedColumns:
    """Return the rows, with a temperature written once per block filled down, and a note.

    So it is where it stands in less than half of the rows that lack nothing else.
    """
    if "temperature" not in roles:
        return loaded_columns
    temperature_index = roles.index("temperature")
    column = loaded_columns.values[:, temperature_index]
    is_complete: BoolArray = np.all(
        np.isfinite(np.delete(loaded_columns.values, temperature_index, axis=1)), axis=1
    )
    finite = np.isfinite(column)
    first = int(np.argmax(finite))
    complete_count = int(np.count_nonzero(finite & is_complete))
    is_late = not finite.any() or is_complete[:first].any()
    if is_late or 2 * complete_count >= np.count_nonzero(is_complete):
        return loaded_columns
    values = loaded_columns.values.copy()
    values[:, temperature_index] = column[
        np.maximum.accumulate(np.where(finite, np.arange(len(column)), first))
    ]
    note = (
        f"the temperature stands in {complete_count} of {np.count_nonzero(is_complete)} rows, from "
        f"{loaded_columns.format_row_position(first)} on; each holds for the rows below it"
    )
    return replace(loaded_columns, values=values, notes=(*loaded_columns.notes, note))


def select_complete_rows(loaded_columns: LoadedColumns) -> tuple[FloatArray, tuple[str, ...]]:
    """Return the rows that lack no number, and notes: of loading, and how many are omitted."""
    is_complete = np.isfinite(loaded_columns.values).all(axis=1)
    missing_indices = np.flatnonzero(~is_complete)
    if not missing_indices.size:
        return loaded_columns.values, loaded_columns.notes
    first = loaded_columns.format_row_position(int(missing_indices[0]))
    note = f"{missing_indices.size} rows lack a number and were left out, first {first}"
    return loaded_columns.values[is_complete], (*loaded_columns.notes, note)


def select_segment(loaded_columns: LoadedColumns, segment: int | None) -> LoadedColumns:
    """Return the segment requested, or everything.

    Raises
    ------
    ReadError
        If there is no such segment.
    """
    if segment is None:
        return loaded_columns
    count = len(loaded_columns.starts)
    if segment > count:
        raise ReadError(
            f"--file-part segment={segment}, but the file has {format_count(count, 'segment')}"
        )
    keep = np.zeros(len(loaded_columns.values), dtype=bool)
    keep[slices(loaded_columns.starts, len(keep))[segment - 1]] = True
    questions = tuple(
        question for question in loaded_columns.questions if question[0] in {None, segment - 1}
    )
    return replace(select_rows(loaded_columns, keep), questions=questions)


def select_rows(loaded_columns: LoadedColumns, keep: BoolArray) -> LoadedColumns:
    """Return some of the rows as one segment, with their line numbers."""
    if keep.all() and len(loaded_columns.starts) == 1:
        return loaded_columns
    indices = np.flatnonzero(keep)
    lines: tuple[tuple[int, int], ...] = ()
    if loaded_columns.lines:
        firsts = {first for first, _ in loaded_columns.lines}
        # a new run wherever a row is left out or the file itself breaks
        runs = [
            i
            for i, row in enumerate(indices)
            if i == 0 or indices[i - 1] != row - 1 or row in firsts
        ]
        lines = tuple((i, loaded_columns.line(int(indices[i]))) for i in runs)
    return LoadedColumns(loaded_columns.values[indices], (0,), ("",), lines, loaded_columns.notes)


# From one file or several to the record of a base that is shaken and the mass on it.


_OTHER_MOTIONS: tuple[Role, ...] = ("velocity", "displacement")


def find_mass_motions(file: OpenedFile, taken_columns: Sequence[int]) -> list[RoleAssignment]:
    """Return the motions of the mass: the named ones, else accelerations, else the others."""
    options = file.options
    roles_named = [role for role in _OTHER_MOTIONS if getattr(options, role)]
    assignments: list[RoleAssignment] = []
    if options.acceleration or not roles_named:
        assignments = [
            RoleAssignment("acceleration", i, "of the mass")
            for i in accelerations(file.table, taken_columns, options)
        ]
    assignments += filter(
        None,
        map(
            file.find_unambiguous_column,
            roles_named if roles_named or assignments else _OTHER_MOTIONS,
        ),
    )
    return [assignment for assignment in assignments if assignment.index not in taken_columns]
