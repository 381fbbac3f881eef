"""What is in a file, before anything in it is trusted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.offered import Pictured
from dashpot.io.columns.kinds import SWEEPS, WANTED_BY, FileKind, kind_of
from dashpot.io.columns.roles import Assigned, accelerations, assign, find_column, unit_for
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions, flag
from dashpot.io.readers import channels, cleaning, creep
from dashpot.io.readers.channels import Opened
from dashpot.io.readers.clocks import own_clocks
from dashpot.io.readers.dynamic import sweep_columns
from dashpot.io.readers.frf import settled
from dashpot.io.readers.shaken import of_mass
from dashpot.io.table import Loaded, Question, Table

_RESPONSE: tuple[Role, ...] = ("frequency", "real", "imaginary", "magnitude", "phase", "coherence")
_ROLES: dict[str, tuple[Role, ...]] = {
    "relaxation": ("time", "displacement", "force"),
    "unclear": ("time", "displacement", "force"),
    "cld": ("displacement", "force"),
    "impact": ("time", "hammer"),
    "indentation": ("time", "velocity"),
    "frf": _RESPONSE,
    "transmissibility": _RESPONSE,
    "modulus": ("time", "modulus"),
    "stress-strain": ("stretch", "strain", "stress"),
    **dict.fromkeys(SWEEPS, ("frequency", "storage", "loss", "temperature")),
}
COURSE_ROWS = 400
"""Rows that an inspection keeps for a picture."""

_COURSE = "_course"
_WELCOME = {
    "velocity", "temperature", "real", "imaginary", "magnitude", "phase", "coherence", "stretch",
    "strain",
}  # fmt: skip
"""Roles that are shown where they are found, and not asked for."""


@dataclass(frozen=True)
class InspectedColumn:
    """One column: what it is called, its unit, the role it would play and why.

    `first` holds the first few numbers as they stand, in the file's own unit; None
    where there is none.
    """

    number: int
    name: str
    unit: str | None
    role: str | None
    reason: str
    first: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class Segment:
    """A run of rows: its name, number of rows, and first and last time, s, if known."""

    name: str
    rows: int
    start: float | None = None
    end: float | None = None


@dataclass(frozen=True, repr=False)
class Inspection(Pictured):
    """What a file holds and what it leaves open.

    Attributes
    ----------
    file, sha256, format, encoding, delimiter, decimal : str
    kind : str
        What the file seems to be, and `reason` why.
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
        What must be answered before the file can be read, and the option that answers it.
    simulated : bool
    """

    file: str
    sha256: str
    format: str
    kind: FileKind
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
    def described(self) -> tuple[str, ...]:
        """What the file is, its columns, and what is to be answered."""
        return (
            f"{self.file}: {self.kind} ({self.reason}), {self.rows} rows",
            *(
                f"  {one.number}  {one.name or '(no name)'} [{one.unit or '?'}]  {one.role or '-'}"
                for one in self.columns
            ),
            *(f"  ASK {question.says}" for question in self.questions),
        )

    @property
    def course(self) -> FloatArray | None:
        """A few hundred rows of every column, in the file's units; None if they were not kept.

        Shape (rows, columns), NaN where there is no number. For a picture: it is no part of the
        inspection's value, nor of its document.
        """
        kept: FloatArray | None = vars(self).get(_COURSE)
        return kept

    @property
    def use(self) -> str:
        """Which command wants such a file, or why none does; empty where that is not known."""
        return WANTED_BY.get(self.kind, ("", ""))[1]


def inspect_file(path: str | Path, *, options: ReadOptions | None = None) -> Inspection:
    """Return what is in a file: columns with roles and reasons, sampling, open questions.

    Raises
    ------
    ReadError
        If the file cannot be opened or holds no table.
    """
    with channels.opened(path, options, sure=False) as file:
        return inspect_opened(file)


def inspect_opened(file: Opened) -> Inspection:
    """Return what is in a file that is open."""
    raw, table, options = file.raw, file.table, file.options
    kind, reason = kind_of(table, options)
    roles, questions = _proposal(file, kind)
    numbers = [i for i, c in enumerate(table.columns) if c.content in {"number", "clock"}]
    loaded = channels.load(table, numbers, options.segment, sure=False)
    by_index = {i: loaded.values[:, j] for j, i in enumerate(numbers)}
    time = _time(table, by_index, roles, options, len(loaded.values))
    rate, even, duration = _sampling(time, loaded.starts)
    warnings = [*table.notes, *loaded.notes]
    if time is not None and not loaded.doubts:
        warnings += cleaning.clock_notes(time[np.isfinite(time)])
    doubts = [question for _, question in loaded.doubts]
    if kind == "relaxation" and not questions:
        found = {role: by_index[i] for i, (role, _) in roles.items()}
        if cleaning.swapped(found["displacement"], found["force"]):
            warnings.append("displacement and force look swapped")
    inspection = Inspection(
        file=raw.name, sha256=raw.sha256, format=table.format, kind=kind, reason=reason,
        encoding=table.encoding, delimiter=table.delimiter, decimal=table.decimal,
        header=table.header, columns=_columns(table, by_index, roles), rows=len(loaded.values),
        rate=rate, even=even, duration=duration, segments=_segments(loaded, time),
        warnings=tuple(warnings), questions=(*table.doubts, *doubts, *questions),
        simulated=table.simulated,
    )  # fmt: skip
    vars(inspection)[_COURSE] = _course(len(table.columns), by_index)
    return inspection


def _course(columns: int, by_index: dict[int, FloatArray]) -> FloatArray:
    """Return rows spread evenly over the record, of every column."""
    rows = max((len(values) for values in by_index.values()), default=0)
    at = np.unique(np.linspace(0, rows - 1, min(rows, COURSE_ROWS)).astype(int))
    course = np.full((len(at), columns), np.nan)
    for i, values in by_index.items():
        course[:, i] = values[at]
    return course


def _columns(
    table: Table, by_index: dict[int, FloatArray], roles: dict[int, tuple[Role, str]]
) -> tuple[InspectedColumn, ...]:
    columns = []
    for i, column in enumerate(table.columns):
        role, why = roles.get(i, (None, ""))
        cells = by_index[i][:5].tolist() if i in by_index else []
        first = tuple(None if math.isnan(value) else value for value in cells)
        columns.append(InspectedColumn(i + 1, column.name, column.unit, role, why, first))
    return tuple(columns)


def _proposal(file: Opened, kind: str) -> tuple[dict[int, tuple[Role, str]], list[Question]]:
    """Role and reason by column, and the questions left."""
    table, options = file.table, file.options
    clocks = own_clocks(table, options) if "displacement" in _ROLES.get(kind, ()) else ()
    roles = {clock.index: (clock.role, clock.reason) for clock in clocks}
    questions: list[Question] = []
    for role in _roles_of(file, kind):
        if role == "time" and (clocks or options.rate is not None):
            continue
        if role == "hammer" and options.base_acceleration is not None:
            continue
        answer = assign(table, role, options)
        if isinstance(answer, Question):
            needless = role == "loss" and isinstance(
                assign(table, "loss_factor", options), Assigned
            )
            questions += [] if role in _WELCOME or needless else [answer]
            continue
        roles[answer.index] = (role, answer.reason)
        questions += [] if role in _WELCOME else _unit_question(table, answer, options)
    if kind == "frf":
        questions = _frf_questions(file)
    if kind in {"impact", "indentation"}:
        for found in _moved(file, list(roles)):
            i = found.index
            roles[i] = (found.role, found.reason)
            questions += _unit_question(table, found, options)
    return roles, questions


def _moved(file: Opened, taken: list[int]) -> list[Assigned]:
    """The accelerations, or those of a shaken base and its mass, whose motion may be another."""
    named, columns = file.options.base_acceleration, file.table.columns
    if named is not None:
        base = find_column(columns, named, flag("base_acceleration"))
        of_base = Assigned("acceleration", base, "named as that of the base")
        return [of_base, *of_mass(file, [base, *taken])]
    says = "its name or unit says acceleration"
    return [
        Assigned("acceleration", i, says) for i in accelerations(file.table, taken, file.options)
    ]


def _roles_of(file: Opened, kind: str) -> tuple[Role, ...]:
    """The roles that a file of a kind should fill."""
    if kind == "creep":
        return creep.roles(file)
    if kind in SWEEPS:
        try:
            return tuple(one.role for one in sweep_columns(file)[0])
        except ReadError:
            pass  # what is lacking is asked below
    return _ROLES.get(kind, ())


def _frf_questions(file: Opened) -> list[Question]:
    try:
        settled(file)
    except ReadError as error:
        return [Question(str(error), '--units "ROLE=UNIT"')]
    return []


def _unit_question(table: Table, one: Assigned, options: ReadOptions) -> list[Question]:
    try:
        unit_for(table.columns[one.index], one.index + 1, one.role, options)
    except ReadError as error:
        return [Question(str(error), f'--units "{one.role}=UNIT"')]
    return []


def _time(
    table: Table,
    by_index: dict[int, FloatArray],
    roles: dict[int, tuple[Role, str]],
    options: ReadOptions,
    rows: int,
) -> FloatArray | None:
    """Time of every row, s, if the file or the options tell it."""
    if options.rate is not None:
        return np.arange(rows) / options.rate
    index = next((i for i, (role, _) in roles.items() if role == "time"), None)
    if index is None:
        return None
    try:
        unit = unit_for(table.columns[index], index + 1, "time", options)
    except ReadError:
        return None
    return channels.si(by_index[index].copy(), unit)


def _sampling(
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
    step = float(np.median(forward))
    even = bool(np.abs(steps - step).max() <= 0.2 * step)
    return 1 / step, even, float(np.nanmax(time) - np.nanmin(time))


def _segments(loaded: Loaded, time: FloatArray | None) -> tuple[Segment, ...]:
    stops = (*loaded.starts[1:], len(loaded.values))
    segments = []
    for name, start, stop in zip(loaded.segments, loaded.starts, stops, strict=True):
        ends: tuple[float | None, ...] = (None, None)
        if time is not None and stop > start:
            ends = tuple(
                None if math.isnan(end) else end
                for end in (time[start].item(), time[stop - 1].item())
            )
        segments.append(Segment(name, stop - start, *ends))
    return tuple(segments)
