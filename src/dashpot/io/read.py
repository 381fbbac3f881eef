"""From a file to a record in SI units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.errors import DataError, ReadError
from dashpot.io import cleaning
from dashpot.io.formats import read_table
from dashpot.io.inspection import InspectedColumn, Inspection, Segment
from dashpot.io.kinds import cycle_peaks, kind_of
from dashpot.io.opening import Raw, open_raw
from dashpot.io.options import ReadOptions
from dashpot.io.roles import Assigned, Question, accelerations, assign, quoted, unit_for
from dashpot.io.table import Loaded, Table
from dashpot.io.vocabulary import Role
from dashpot.provenance import Source
from dashpot.relaxation.records import RelaxationTest, Specimen
from dashpot.units import Unit
from dashpot.vibration.records import ImpactTest


@dataclass(frozen=True)
class _Channel:
    """A column chosen for a role, with its unit."""

    role: Role
    index: int
    unit: Unit
    says: str


def read_relaxation(
    path: str | Path, *, options: ReadOptions = ReadOptions(), specimen: Specimen | None = None
) -> RelaxationTest:
    """Return the relaxation test in a file, in SI units; ``-`` is stdin.

    Parameters
    ----------
    path : path
        A text file of any lab, or an instrument's own format.
    options : ReadOptions
        Answers to what the file leaves open.
    specimen : Specimen or None
        What was tested, kept with the record.

    Raises
    ------
    ReadError
        If the file cannot be read, or leaves open which column is what or in which unit; the
        sentence says which option answers it.
    """
    raw = open_raw(path)
    table = _table(raw, options)
    roles: list[Role] = ["displacement", "force"]
    channels = _channels(raw, table, ["time", *roles] if options.rate is None else roles, options)
    loaded = _part(table.load([c.index for c in channels]), options, raw.name)
    notes = [*table.notes, *loaded.notes]
    values = {c.role: _si(loaded.values[:, j], c.unit) for j, c in enumerate(channels)}
    if options.rate is not None:
        values["time"] = np.arange(len(loaded.values)) / options.rate
        notes.append(f"time counted from the rows at {options.rate:g} Hz, as given")
    _enough(raw.name, loaded)
    time, moved = values["time"], values["displacement"]
    protect = cleaning.ramp_window(time, moved)
    keep, said = cleaning.drop_missing(
        loaded, [c.role for c in channels], protect=protect, file=raw.name
    )
    notes += said
    if len(loaded.starts) > 1:
        notes.append(_joined(loaded, options))
    kept = _rows(loaded, keep)
    unique, said = cleaning.drop_repeats(time[keep], kept, file=raw.name)
    notes += said
    time, moved, force = (values[role][keep][unique] for role in ("time", "displacement", "force"))
    notes += cleaning.clock_notes(time)
    warning = cleaning.swapped(moved, force)
    notes += [warning] if warning else []
    source = Source(
        raw.name,
        raw.sha256,
        table.format,
        tuple(c.says for c in channels),
        tuple(notes),
        table.simulated,
    )
    try:
        return RelaxationTest(time, moved, force, specimen or Specimen(), source)
    except DataError as error:
        raise ReadError(f"{raw.name}: {error}") from None


def read_impact(
    paths: str | Path | Sequence[str | Path], *, options: ReadOptions = ReadOptions()
) -> ImpactTest:
    """Return the impact test in one file or several, in SI units; ``-`` is stdin.

    Segments of a file, resets of its clock, and further files each start a new continuous
    record (`starts`).

    Raises
    ------
    ReadError
        As :func:`read_relaxation`, or if the files do not hold the same channels.
    """
    listed = [paths] if isinstance(paths, str | Path) else list(paths)
    if not listed:
        raise ReadError("no impact file given")
    parts = [_one_impact(path, options) for path in listed]
    names = parts[0].channels
    for part, path in zip(parts, listed, strict=True):
        if part.channels != names:
            raise ReadError(
                f"{path}: accelerations are {', '.join(part.channels)}, but {listed[0]} has "
                f"{', '.join(names)}; give files of one set-up"
            )
    offsets = np.cumsum([0, *(len(part.time) for part in parts)])
    try:
        return ImpactTest(
            time=np.concatenate([part.time for part in parts]),
            force=np.concatenate([part.force for part in parts]),
            acceleration=np.concatenate([part.acceleration for part in parts], axis=1),
            starts=tuple(
                int(offset + start)
                for offset, part in zip(offsets, parts, strict=False)
                for start in part.starts
            ),
            channels=names,
            source=tuple(source for part in parts for source in part.source),
        )
    except DataError as error:
        raise ReadError(f"{listed[0]}: {error}") from None


def _one_impact(path: str | Path, options: ReadOptions) -> ImpactTest:
    raw = open_raw(path)
    table = _table(raw, options)
    wanted: list[Role] = ["force"] if options.rate is not None else ["time", "force"]
    channels = _channels(raw, table, wanted, options)
    found = accelerations(table, [c.index for c in channels], options)
    if not found:
        raise ReadError(
            f"{raw.name}: no column is recognised as acceleration; the columns are "
            f'{_listed(table)}; name each, for example --acceleration "{_label(table)}"'
        )
    channels += [_channel(raw, table, Assigned("acceleration", i, ""), options) for i in found]
    loaded = _part(table.load([c.index for c in channels]), options, raw.name)
    _enough(raw.name, loaded)
    notes = [*table.notes, *loaded.notes]
    holes = np.flatnonzero(~np.isfinite(loaded.values).all(axis=1))
    if holes.size:
        raise ReadError(
            f"{raw.name}: {loaded.where(int(holes[0]))} lacks a number ({holes.size} such rows); an "
            "impact record needs every sample: cut the record there or export it again"
        )
    columns = [_si(loaded.values[:, j], c.unit) for j, c in enumerate(channels)]
    starts = loaded.starts
    if options.rate is not None:
        time = np.arange(len(columns[0])) / options.rate
        notes.append(f"time counted from the rows at {options.rate:g} Hz, as given")
        signals = columns
    else:
        time, signals = columns[0], columns[1:]
        breaks = _breaks(time)
        if new := [b for b in breaks if b not in starts]:
            notes.append(
                f"the clock jumps at {loaded.where(new[0])}"
                + (f" and {len(new) - 1} more places" if len(new) > 1 else "")
                + ": a new record starts at each"
            )
        starts = tuple(sorted({*starts, *breaks}))
    accelerated = tuple(
        table.columns[i].name or f"acceleration {k + 1}" for k, i in enumerate(found)
    )
    source = Source(
        raw.name,
        raw.sha256,
        table.format,
        tuple(c.says for c in channels),
        tuple(notes),
        table.simulated,
    )
    try:
        return ImpactTest(
            time, signals[0], np.array(signals[1:]), starts, accelerated, source=(source,)
        )
    except DataError as error:
        raise ReadError(f"{raw.name}: {error}") from None


def _breaks(time: FloatArray) -> list[int]:
    """Samples before which an even clock jumps, forward or back."""
    steps = np.diff(time)
    step = float(np.median(steps)) if len(steps) else 0.0
    if step <= 0:
        return []
    return [int(i) + 1 for i in np.flatnonzero(np.abs(steps - step) > 0.5 * step)]


def _table(raw: Raw, options: ReadOptions) -> Table:
    table = read_table(raw, options)
    if table.doubts:
        raise ReadError(f"{raw.name}: {table.doubts[0]}")
    peaks = cycle_peaks(table)
    if peaks and not (options.force or options.displacement or options.acceleration):
        raise ReadError(f"{raw.name} is not a test: {peaks}")
    return table


def _channels(
    raw: Raw, table: Table, roles: Sequence[Role], options: ReadOptions
) -> list[_Channel]:
    """The columns for the roles, each with its unit, or one error with every question."""
    found = [assign(table, role, options) for role in roles]
    asked = [answer.says for answer in found if isinstance(answer, Question)]
    if asked:
        kind, reason = kind_of(table, options)
        what = (
            f"{raw.name} is not a test: {reason}"
            if kind == "not-a-test"
            else f"{raw.name}: " + "; ".join(asked)
        )
        raise ReadError(what)
    chosen = [answer for answer in found if isinstance(answer, Assigned)]
    for i, one in enumerate(chosen):
        for other in chosen[:i]:
            if other.index == one.index:
                raise ReadError(
                    f"{raw.name}: {quoted(table.columns, one.index)} would be both {other.role} and {one.role}; "
                    f"name the columns with --{other.role} and --{one.role}; they are {_listed(table)}"
                )
    return [_channel(raw, table, one, options) for one in chosen]


def _channel(raw: Raw, table: Table, one: Assigned, options: ReadOptions) -> _Channel:
    column = table.columns[one.index]
    try:
        unit = unit_for(column, one.index + 1, one.role, options)
    except ReadError as error:
        raise ReadError(f"{raw.name}: {error}") from None
    says = f"{one.role}: {column.label(one.index + 1)} [{unit.word}]"
    return _Channel(one.role, one.index, unit, says + (f" ({one.reason})" if one.reason else ""))


def _si(values: FloatArray, unit: Unit) -> FloatArray:
    """Values in SI; 1000 mm is 1 m exactly, so a factor 1/k divides."""
    inverse = round(1 / unit.factor) if unit.factor < 1 else 0
    exact = inverse > 1 and abs(unit.factor * inverse - 1) < 1e-15
    scaled = values / inverse if exact else values * unit.factor
    return np.asarray(scaled + unit.offset if unit.offset else scaled)


def _part(loaded: Loaded, options: ReadOptions, file: str) -> Loaded:
    """The segment asked for."""
    if options.segment is None:
        return loaded
    count = len(loaded.starts)
    if options.segment > count:
        raise ReadError(f"{file}: --segment {options.segment}, but the file has {count}")
    stops = (*loaded.starts[1:], len(loaded.values))
    start, stop = loaded.starts[options.segment - 1], stops[options.segment - 1]
    keep = np.zeros(len(loaded.values), dtype=bool)
    keep[start:stop] = True
    rows = _rows(loaded, keep)
    return Loaded(
        rows.values, (0,), (loaded.segments[options.segment - 1],), rows.lines, loaded.notes
    )


def _rows(loaded: Loaded, keep: np.ndarray) -> Loaded:  # type: ignore[type-arg]
    """Some of the rows, each still knowing its line."""
    if keep.all():
        return loaded
    rows = np.flatnonzero(keep)
    runs = np.flatnonzero(np.diff(rows, prepend=-2) != 1)
    lines = tuple((int(i), int(loaded.where(int(rows[i])).split()[1])) for i in runs)
    return Loaded(loaded.values[rows], (0,), ("",), lines, ())


def _enough(file: str, loaded: Loaded, least: int = 8) -> None:
    if len(loaded.values) < least:
        count = len(loaded.values)
        raise ReadError(
            f"{file}: only {count} row{'s' * (count != 1)} of numbers; a test needs at least {least}"
        )


def _joined(loaded: Loaded, options: ReadOptions) -> str:
    del options
    names = [name or f"{i + 1}" for i, name in enumerate(loaded.segments)]
    return f"{len(names)} segments joined into one record: {', '.join(names[:6])}"


def _listed(table: Table) -> str:
    from dashpot.io.roles import list_columns

    return list_columns(table.columns)


def _label(table: Table) -> str:
    index = next((i for i, c in enumerate(table.columns) if c.content == "number"), 0)
    return table.columns[index].label(index + 1)


def inspect_file(path: str | Path, *, options: ReadOptions = ReadOptions()) -> Inspection:
    """Return what is in a file: columns with roles and reasons, sampling, and open questions.

    Raises
    ------
    ReadError
        If the file cannot be opened or holds no table.
    """
    raw = open_raw(path)
    table = read_table(raw, options)
    kind, reason = kind_of(table, options)
    roles, questions = _proposal(table, kind, options)
    questions += [Question(says, "--decimal") for says in table.doubts]
    numbers = [i for i, c in enumerate(table.columns) if c.content in {"number", "clock"}]
    loaded = table.load(numbers)
    warnings = [*table.notes, *loaded.notes]
    columns = []
    for i, column in enumerate(table.columns):
        role, why = roles.get(i, (None, ""))
        first = loaded.values[:5, numbers.index(i)] if i in numbers else ()
        columns.append(
            InspectedColumn(i + 1, column.name, column.unit, role, why, tuple(map(float, first)))
        )
    time = _time(table, loaded, numbers, roles, options)
    rate, even, duration = _sampling(time)
    if time is not None:
        warnings += cleaning.clock_notes(time)
    return Inspection(
        file=raw.name, sha256=raw.sha256, format=table.format, kind=kind, reason=reason,
        encoding=table.encoding, delimiter=table.delimiter, decimal=table.decimal,
        header=table.header, columns=tuple(columns), rows=len(loaded.values), rate=rate, even=even,
        duration=duration, segments=_segments(loaded, time), warnings=tuple(warnings),
        questions=tuple(questions), simulated=table.simulated,
    )  # fmt: skip


_ROLES: dict[str, tuple[Role, ...]] = {
    "relaxation": ("time", "displacement", "force"),
    "unclear": ("time", "displacement", "force"),
    "impact": ("time", "force"),
    "dma": ("frequency", "storage", "loss", "temperature"),
    "frf": ("frequency", "real", "imaginary"),
}


def _proposal(
    table: Table, kind: str, options: ReadOptions
) -> tuple[dict[int, tuple[str, str]], list[Question]]:
    """Role and reason by column, and the questions left."""
    roles: dict[int, tuple[str, str]] = {}
    questions: list[Question] = []
    for role in _ROLES.get(kind, ()):
        if role == "time" and options.rate is not None:
            continue
        answer = assign(table, role, options)
        if isinstance(answer, Question):
            if role not in {"temperature", "real", "imaginary"}:
                questions.append(answer)
            continue
        roles[answer.index] = (role, answer.reason)
        if role in {"real", "imaginary"}:
            continue
        questions += _unit_question(table, answer, options)
    if kind == "impact":
        for i in accelerations(table, list(roles), options):
            answer = Assigned("acceleration", i, "its name or unit says acceleration")
            roles[i] = (answer.role, answer.reason)
            questions += _unit_question(table, answer, options)
    return roles, questions


def _unit_question(table: Table, one: Assigned, options: ReadOptions) -> list[Question]:
    try:
        unit_for(table.columns[one.index], one.index + 1, one.role, options)
    except ReadError as error:
        return [Question(str(error), f'--units "{one.role}=..."')]
    return []


def _time(
    table: Table,
    loaded: Loaded,
    numbers: list[int],
    roles: dict[int, tuple[str, str]],
    options: ReadOptions,
) -> FloatArray | None:
    if options.rate is not None:
        return np.arange(len(loaded.values)) / options.rate
    for index, (role, _) in roles.items():
        if role == "time":
            try:
                unit = unit_for(table.columns[index], index + 1, "time", options)
            except ReadError:
                return None
            return _si(loaded.values[:, numbers.index(index)], unit)
    return None


def _sampling(time: FloatArray | None) -> tuple[float | None, bool, float | None]:
    """Median rate, whether it is even, and duration."""
    if time is None:
        return None, True, None
    known = time[np.isfinite(time)]
    steps = np.diff(known)
    forward = steps[steps > 0]
    if forward.size == 0:
        return None, True, None
    step = float(np.median(forward))
    even = bool(np.abs(steps - step).max() <= 0.2 * step)
    return 1 / step, even, float(known[-1] - known[0])


def _segments(loaded: Loaded, time: FloatArray | None) -> tuple[Segment, ...]:
    stops = (*loaded.starts[1:], len(loaded.values))
    segments = []
    for name, start, stop in zip(loaded.segments, loaded.starts, stops, strict=True):
        if time is None or stop <= start:
            segments.append(Segment(name, stop - start))
        else:
            segments.append(Segment(name, stop - start, float(time[start]), float(time[stop - 1])))
    return tuple(segments)
