"""Inspection of a file's contents before they are used."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, distinct, median
from dashpot.base.errors import ReadError
from dashpot.base.result_mixins import Plottable, Series
from dashpot.reading.columns.file_kinds import (
    KINDS_OF_FILE,
    RAMP_ROLES,
    SWEEP_KINDS,
    RecognisedKind,
    get_kind_command,
)
from dashpot.reading.columns.role_assignment import (
    RoleAssignment,
    accelerations,
    assign_role,
    find_column,
)
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.raw_file import add_name_to_errors, open_raw
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.readers import channels, cleaning
from dashpot.reading.readers.channels import OpenedFile, find_mass_motions
from dashpot.reading.readers.cleaning import assign_time_since_step, find_separate_clocks
from dashpot.reading.readers.detect_kind import open_or_identify, recognise_opened
from dashpot.reading.readers.sweep_columns import load_sweep, sweep_columns
from dashpot.reading.table import LoadedColumns, Question
from dashpot.registry import find_handler

COURSE_ROWS = 400
"""Rows that an inspection keeps for a picture."""

_COURSE = "_course"
_SHOWN_NUMBERS = 5
"""Numbers that are shown of a column."""
_First: TypeAlias = Mapping[int, tuple[float | None, ...]]
_NO_ROLE = (None, "")
_DOCUMENT = "json"
_OPTIONAL_ROLES = {
    "velocity", "temperature", "real", "imaginary", "magnitude", "phase", "coherence", "stretch",
    "strain",
}  # fmt: skip
"""Roles that are shown where they are found, and not asked for."""
_CURVES: frozenset[Role] = frozenset({"modulus", "creep_compliance"})
"""Roles over the time since a step."""
_KINDS_WITHOUT_CLOCK = ("cld", "stress-strain")
"""Kinds whose time is optional as well."""


@dataclass(frozen=True)
class InspectedColumn:
    """Column: its name and unit, its role, and the reason.

    `first` holds the first few numbers as they stand, in the file's own unit; None
    if there is none.
    """

    number: int
    name: str
    unit: str | None
    role: str | None
    reason: str
    first: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class Segment:
    """Segment of rows: its name, number of rows, and first and last time, s, if known."""

    name: str
    rows: int
    start: float | None = None
    end: float | None = None


@dataclass(frozen=True, repr=False)
class Inspection(Plottable):
    """Contents of a file, and the questions that they leave open.

    Attributes
    ----------
    file, sha256, format, encoding, delimiter, decimal : str
    kind : str
        What the file is (:func:`~dashpot.reading.readers.detect_kind.recognise`), and `reason` why.
    header : tuple of str
        The lines above the table.
    columns : tuple of InspectedColumn
    rows : int
    rate : float or None
        Median sampling rate, Hz; None without a usable clock.
    even : bool
        Whether the sampling is even.
    duration : float or None
        s.
    segments : tuple of Segment
    warnings : tuple of str
    questions : tuple of Question
        Questions to answer before the file can be read, each with its option.
    simulated : bool
    """

    file: str
    sha256: str
    format: str
    kind: str
    reason: str
    encoding: str = ""
    delimiter: str = ""
    decimal: str = ""
    header: tuple[str, ...] = ()
    columns: tuple[InspectedColumn, ...] = ()
    rows: int = 0
    rate: float | None = None
    even: bool = True
    duration: float | None = None
    segments: tuple[Segment, ...] = ()
    warnings: tuple[str, ...] = ()
    questions: tuple[Question, ...] = ()
    simulated: bool = False

    @property
    def _table_columns(self) -> Series:
        """A row for each column of the file."""
        columns = self.columns
        return {
            "number": ([column.number for column in columns], ""),
            "name": ([column.name for column in columns], ""),
            "unit": ([column.unit or "" for column in columns], ""),
            "role": ([column.role or "" for column in columns], ""),
            "reason": ([column.reason for column in columns], ""),
        }

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary of the file: its columns and open questions."""
        return (
            f"{self.file}: {self.kind} ({self.reason}), {self.rows} rows",
            *(
                f"  {column.number}  {column.name or '(no name)'} [{column.unit or '?'}]  "
                f"{column.role or '-'}"
                for column in self.columns
            ),
            *(f"  ASK {question.message}" for question in self.questions),
        )

    @property
    def course(self) -> FloatArray | None:
        """A few hundred rows of every column, in the file's units; None if they were not kept.

        Shape (rows, columns), NaN where there is no number. Data for a figure; not part of the
        inspection's value or document.
        """
        stored_course: FloatArray | None = vars(self).get(_COURSE)
        return stored_course

    @property
    def use(self) -> str:
        """Command that reads such a file, or why there is none; empty if unknown."""
        return get_kind_command(self.kind)


def inspect_file(path: str | Path, *, options: ReadOptions | None = None) -> Inspection:
    """Return the inspection of a file: columns, roles, reasons, sampling, open questions.

    Raises
    ------
    ReadError
        If the file cannot be opened, or holds no table and is of no known kind.
    """
    file = open_or_identify(path, options)
    if isinstance(file, RecognisedKind):
        return inspect_other_path(path, file)
    with add_name_to_errors(file.raw.name):
        return inspect_opened(file)


def inspect_other_path(path: str | Path, detection: RecognisedKind) -> Inspection:
    """Return the inspection of a file without a table."""
    resolved_path = Path(path)
    if resolved_path.is_dir():
        return Inspection(resolved_path.name, "", "folder", detection.kind, detection.reason)
    raw = open_raw(path)
    form = _DOCUMENT if detection.stored else "toml"
    return Inspection(raw.name, raw.sha256, form, detection.kind, detection.reason)


def inspect_opened(file: OpenedFile) -> Inspection:
    """Return the inspection of an open file."""
    raw, table, options = file.raw, file.table, file.options
    kind, reason = recognise_opened(file)
    roles, questions = _propose_roles(file, kind)
    numbers = [i for i, c in enumerate(table.columns) if c.content in {"number", "clock"}]
    if table.large:
        numbers = [i for i in numbers if i in roles] or numbers[:1]
    loaded_columns = channels.load(table, numbers, options.segment, refuse_questions=False)
    by_index = {i: loaded_columns.values[:, j] for j, i in enumerate(numbers)}
    time = _time(file, by_index, roles, len(loaded_columns.values))
    rate, is_even, duration = _inspect_sampling(time, loaded_columns.starts)
    warnings = [*table.notes, *loaded_columns.notes]
    by_hand = kind in KINDS_OF_FILE and KINDS_OF_FILE[kind].by_hand
    if time is not None and not loaded_columns.questions and not by_hand:
        warnings += cleaning.clock_notes(time[np.isfinite(time)])
    open_questions = [question for _, question in loaded_columns.questions]
    if kind == "relaxation" and not questions and _look_swapped(by_index, roles):
        warnings.append("displacement and force look swapped")
    refuse_sizes = find_handler("refuse sizes", kind)
    if refuse_sizes and not questions:
        questions = list_unit_questions(
            lambda: _judge_sizes(file, by_index, roles, refuse_sizes), "strain"
        )
    inspection = Inspection(
        file=raw.name, sha256=raw.sha256, format=table.format, kind=kind, reason=reason,
        encoding=table.encoding, delimiter=table.delimiter, decimal=table.decimal,
        header=table.header, rows=len(loaded_columns.values),
        columns=_inspect_columns(file, _first(numbers, loaded_columns.values), roles),
        rate=rate, even=is_even, duration=duration,
        segments=_inspect_segments(loaded_columns, time),
        warnings=tuple(warnings), questions=(*table.questions, *open_questions, *questions),
        simulated=table.simulated,
    )  # fmt: skip
    vars(inspection)[_COURSE] = _select_course_rows(
        len(table.columns), numbers, loaded_columns.values
    )
    return inspection


def _look_swapped(by_index: dict[int, FloatArray], roles: dict[int, tuple[Role, str]]) -> bool:
    entries = {role: by_index.get(i) for i, (role, _) in roles.items()}
    change, pushed = entries["displacement"], entries["force"]
    if change is None or pushed is None:
        return False
    has_both = np.isfinite(change) & np.isfinite(pushed)
    return bool(has_both.any()) and cleaning.has_swapped_signals(change[has_both], pushed[has_both])


def _judge_sizes(
    file: OpenedFile,
    by_index: dict[int, FloatArray],
    roles: dict[int, tuple[Role, str]],
    refuse_sizes: Callable[..., None],
) -> None:
    """Add the questions on the magnitudes of strain and stress."""
    assigned_roles = {role for role, _ in roles.values()}
    elongated: Role = "strain" if "strain" in assigned_roles else "stretch"
    if not {elongated, "stress"} <= assigned_roles:
        return
    channels_chosen = channels.choose_channels(file, [elongated, "stress"])
    strain, stress = (channel.unit.factor * by_index[channel.index] for channel in channels_chosen)
    has_both = np.isfinite(strain) & np.isfinite(stress)
    strain, stress = strain[has_both] - (elongated == "stretch"), stress[has_both]
    if len(stress):
        refuse_sizes(file, channels_chosen, strain, stress)


def _select_course_rows(columns: int, numbers: Sequence[int], values: FloatArray) -> FloatArray:
    """Return rows spread evenly over the record, of every column."""
    rows = len(values) if numbers else 0
    at = distinct(np.linspace(0, rows - 1, min(rows, COURSE_ROWS)).astype(int))
    course = np.full((len(at), columns), np.nan)
    course[:, numbers] = values[at]
    return course


def _inspect_columns(
    file: OpenedFile, first: _First, roles: dict[int, tuple[Role, str]]
) -> tuple[InspectedColumn, ...]:
    columns = []
    for i, column in enumerate(file.table.columns):
        role, role_reason = roles.get(i, _NO_ROLE)
        unit = file.unit_word(i, role) if role else column.unit
        columns.append(
            InspectedColumn(i + 1, column.name, unit, role, role_reason, first.get(i, ()))
        )
    return tuple(columns)


def _first(numbers: Sequence[int], values: FloatArray) -> _First:
    """Return the first few values of each numeric column; None of other columns."""
    rows = values[:_SHOWN_NUMBERS]
    cells = rows.astype(object)
    cells[np.isnan(rows)] = None
    return dict(zip(numbers, map(tuple, cells.T.tolist()), strict=True))


def _propose_roles(
    file: OpenedFile, kind: str
) -> tuple[dict[int, tuple[Role, str]], list[Question]]:
    """Role and reason by column, and the questions left: of the roles, and of the kind besides."""
    roles, questions = _assign_kind_roles(file, kind)
    if kind in {"frf", "transmissibility"}:
        from dashpot.reading.readers.frf import determine_frf_columns, make_ratio_file

        select = find_handler("first point", "frf") or make_ratio_file
        questions = list_unit_questions(
            lambda: determine_frf_columns(make_ratio_file(select(file))), "ROLE"
        )
    if kind in SWEEP_KINDS and not questions:
        questions = list_unit_questions(lambda: load_sweep(file), "ROLE")
    propose_more = find_handler("propose roles", kind)
    if propose_more:
        questions += propose_more(file, roles)
    if kind in KINDS_OF_FILE and KINDS_OF_FILE[kind].takes_all_accelerations:
        for acceleration in _find_accelerations(file, list(roles)):
            roles[acceleration.index] = (acceleration.role, acceleration.reason)
            questions += _make_role_questions(file, acceleration.role, acceleration)
    return roles, questions


def _assign_kind_roles(
    file: OpenedFile, kind: str
) -> tuple[dict[int, tuple[Role, str]], list[Question]]:
    """Return the columns that take the roles of the kind, and the questions on them."""
    table, options = file.table, file.options
    clocks = (
        find_separate_clocks(table, options) if "displacement" in _get_usual_roles(kind) else ()
    )
    roles = {clock.index: (clock.role, clock.reason) for clock in clocks}
    questions: list[Question] = []
    roles_wanted = _list_expected_roles(file, kind, has_clock=bool(clocks))
    curve = not _CURVES.isdisjoint(roles_wanted)
    for role in roles_wanted:
        is_elapsed = curve and role == "time"
        assignment = (
            assign_time_since_step(table, options)
            if is_elapsed
            else assign_role(table, role, options)
        )
        if isinstance(assignment, RoleAssignment):
            assigned_role, _ = roles.get(assignment.index, (role, ""))
            if assigned_role != role and {assigned_role, role} <= set(
                RAMP_ROLES
            ):  # who reads it asks this, too
                message = channels.format_role_conflict(
                    table.columns, assignment.index, assigned_role, role
                )
                questions.append(Question(message, f"{flag(role)}=NAME"))
                continue
            roles[assignment.index] = (role, assignment.reason)
        welcome = role in _OPTIONAL_ROLES or (
            role == "time" and kind in _KINDS_WITHOUT_CLOCK and _has_no_copies(assignment)
        )
        questions += [] if welcome else _make_role_questions(file, role, assignment)
    return roles, questions


def _has_no_copies(assignment: RoleAssignment | Question) -> bool:
    """Return whether no two columns could play a role."""
    return isinstance(assignment, RoleAssignment) or not assignment.choices


def _find_accelerations(file: OpenedFile, taken_columns: list[int]) -> list[RoleAssignment]:
    """The accelerations, or those of a shaken base and its mass, whose motion may be another."""
    named_column, columns = file.options.base_acceleration, file.table.columns
    if named_column is not None:
        base = find_column(columns, named_column, flag("base_acceleration"))
        of_base = RoleAssignment("acceleration", base, "named as that of the base")
        return [of_base, *find_mass_motions(file, [base, *taken_columns])]
    message = "its name or unit says acceleration"
    return [
        RoleAssignment("acceleration", i, message)
        for i in accelerations(file.table, taken_columns, file.options)
    ]


def _get_usual_roles(kind: str) -> tuple[Role, ...]:
    """The roles of a kind; of a table that shows none, those of a ramp and hold are requested."""
    if kind == "unclear":
        return RAMP_ROLES
    return KINDS_OF_FILE[kind].roles if kind in KINDS_OF_FILE else ()


def _list_expected_roles(file: OpenedFile, kind: str, *, has_clock: bool) -> list[Role]:
    """The roles that a file of a kind should fill, without a time or a hammer it does not need."""
    find_roles = find_handler("roles", kind)
    roles_wanted = find_roles(file) if find_roles else _get_usual_roles(kind)
    if kind in SWEEP_KINDS:
        with suppress(ReadError):  # what is lacking is asked of the caller
            roles_wanted = tuple(assignment.role for assignment in sweep_columns(file)[0])
    options = file.options
    needless = {"time": has_clock or options.rate, "hammer": options.base_acceleration}
    return [role for role in roles_wanted if not needless.get(role)]


def _make_role_questions(
    file: OpenedFile, role: Role, assignment: RoleAssignment | Question
) -> list[Question]:
    """Return the open questions of a role: its column, or the unit of that."""
    if isinstance(assignment, RoleAssignment):
        return list_unit_questions(lambda: file.unit(assignment.index, role), role)
    needless = role == "loss" and file.column("loss_factor")
    return [] if needless else [assignment]


def list_unit_questions(resolve_unit: Callable[[], object], role: str) -> list[Question]:
    """Return the question of the unit of a role, if it is open."""
    try:
        resolve_unit()
    except ReadError as error:
        return [Question(str(error), f'--units "{role}=UNIT"')]
    return []


def _time(
    file: OpenedFile,
    by_index: dict[int, FloatArray],
    roles: dict[int, tuple[Role, str]],
    rows: int,
) -> FloatArray | None:
    """Return time of every row, s, if the file or the options show it."""
    if file.options.rate is not None:
        return np.arange(rows) / file.options.rate
    index = next((i for i, (role, _) in roles.items() if role == "time"), None)
    if index is None or index not in by_index:  # the column that is named may be empty
        return None
    try:
        unit = file.unit(index, "time")
    except ReadError:
        return None
    return channels.scale_to_si(by_index[index].copy(), unit)


def _inspect_sampling(
    time: FloatArray | None, starts: tuple[int, ...]
) -> tuple[float | None, bool, float | None]:
    """Median rate, whether each segment is evenly sampled, and duration."""
    if time is None:
        return None, True, None
    steps = np.diff(time)
    steps[[start - 1 for start in starts[1:]]] = np.nan
    steps = steps[np.isfinite(steps)]
    forward = steps[steps > 0]
    if forward.size == 0:
        return None, True, None
    step = median(forward)
    is_even = bool(np.abs(steps - step).max() <= 0.2 * step)
    return 1 / step, is_even, float(np.nanmax(time) - np.nanmin(time))


def _inspect_segments(
    loaded_columns: LoadedColumns, time: FloatArray | None
) -> tuple[Segment, ...]:
    stops = (*loaded_columns.starts[1:], len(loaded_columns.values))
    segments = []
    for name, start, stop in zip(
        loaded_columns.segments, loaded_columns.starts, stops, strict=True
    ):
        time_range: tuple[float | None, ...] = (None, None)
        if time is not None and stop > start:
            time_range = tuple(
                None if math.isnan(end) else end
                for end in (time[start].item(), time[stop - 1].item())
            )
        segments.append(Segment(name, stop - start, *time_range))
    return tuple(segments)
