"""Cleaning of recorded clocks and samples: repaired with a note, or refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, median
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Caution
from dashpot.base.units import Unit
from dashpot.reading.columns.role_assignment import RoleAssignment, assign_role, score
from dashpot.reading.columns.vocabulary import MIN_SCORE, STEP_TIME, Role, has_word
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.table import FileTable, LoadedColumns, Question
from dashpot.signals.clock import JUMP_RATIO, NEIGHBOUR_STEPS, find_clock_jumps

# Faults of one clock and its samples.


_MAX_LAST_STEP_RATIO = 5.0
"""Largest ratio of the last step to all others without a note."""
_RAMP_END_SHARE = 0.98
"""Part of the travel at which a ramp counts as over; what is left of it, as begun."""
_LOUD_SHARE = 0.1
"""Part of its peak beyond which a signal is not at rest."""
_MAX_LISTED = 3
"""Number of leaps of a clock that are reported one by one."""
_MINUTE = 60.0
_ROUND_DIGITS = (1.0, 2.0, 2.5, 4.0, 5.0, 8.0, 10.0)
"""First digits of the steps of recorders, in the unit that they count by."""
_ROUND_TOLERANCE = 1e-3
_MAX_REPEATED_SHARE = 1e-3
"""Share of repeated time stamps that may be dropped."""


def drop_missing(
    loaded_columns: LoadedColumns, names: Sequence[str], *, protect: BoolArray
) -> tuple[BoolArray, list[str]]:
    """Return which rows are whole, and a note on those that are not.

    Raises
    ------
    ReadError
        If a number is missing where `protect` is true, or in more than half of the rows.
    """
    holes = ~np.isfinite(loaded_columns.values)
    keep = np.logical_not(np.any(holes, axis=1))
    rows = np.flatnonzero(~keep)
    if rows.size == 0:
        return keep, []

    def lacks(row: int) -> str:
        return " and ".join(name for name, hole in zip(names, holes[row], strict=True) if hole)

    rows_text = ", ".join(
        f"{loaded_columns.format_row_position(int(row))} ({lacks(row)})" for row in rows[:3]
    )
    more_text = f" and {rows.size - 3} more" if rows.size > 3 else ""
    if rows.size > 0.5 * len(keep):
        raise ReadError(
            f"{rows.size} of {len(keep)} rows lack a number, first at {rows_text}{more_text}; "
            "the columns may be recorded at different rates: export them on one time base"
        )
    guarded = rows[protect[rows] & (rows < len(keep) - 1)]  # a last row may well be cut off
    if guarded.size:
        row = int(guarded[0])
        plural = "s" * (rows.size > 1)
        raise ReadError(
            f"{loaded_columns.format_row_position(row)} lacks {lacks(row)} within the ramp or the "
            f"start of the hold, where every sample counts ({rows.size} such row{plural} in all); "
            "repair or repeat the record there"
        )
    return keep, [
        f"{rows.size} of {len(keep)} rows lack a number and were left out: {rows_text}{more_text}"
    ]


def remove_padding(loaded_columns: LoadedColumns) -> LoadedColumns:
    """Return the rows, time first, without those at the end that only fill a buffer.

    That is the last row again and again, or rows of one number (0, -1, NaN) or all alike at which
    the clock does not rise.
    """
    values = loaded_columns.values
    if len(values) < 3 or values[-1, 0] > values[-2, 0]:
        return loaded_columns
    is_repeated = np.all((values == values[-1]) | np.isnan(values) & np.isnan(values[-1]), axis=1)
    first = int(np.flatnonzero(~is_repeated)[-1]) + 1 if not is_repeated.all() else 0
    if not first:
        return loaded_columns
    if values[first, 0] > values[first - 1, 0]:
        first += 1  # the last sample, and its copies
    elif len(values) - first == 1 and len(set(np.nan_to_num(values[-1]).tolist())) > 1:
        return loaded_columns  # one odd row is a fault of the clock
    is_kept_segment = [start < first for start in loaded_columns.starts]
    numbers = ", ".join(f"{value:.6g}" for value in values[-1])
    count = len(values) - first
    note = (
        f"rows at the end that only fill the file were left out: {count}, from "
        f"{loaded_columns.format_row_position(first)} on ({numbers})"
    )
    return replace(
        loaded_columns,
        values=values[:first],
        starts=loaded_columns.starts[: sum(is_kept_segment)],
        segments=loaded_columns.segments[: sum(is_kept_segment)],
        notes=(*loaded_columns.notes, note),
    )


def ramp_window(time: FloatArray, displacement: FloatArray) -> BoolArray:
    """Return where the loading and the first ten ramp times of the hold are, roughly.

    The fastest relaxation that a ramp shows has about the time of the ramp, so the arms are
    determined within ten ramp times of hold.
    """
    is_complete = np.isfinite(time) & np.isfinite(displacement)
    window = np.zeros(len(time), dtype=bool)
    if is_complete.sum() < 8:
        return window
    t, x = time[is_complete], displacement[is_complete]
    low, high = float(np.min(x)), float(np.max(x))
    if high <= low:
        return window
    magnitude = np.abs(x - x[0])
    indices = np.flatnonzero(magnitude > 0.02 * magnitude.max())
    full_indices = np.flatnonzero(magnitude > 0.98 * magnitude.max())
    onset, end = t[max(int(indices[0]) - 1, 0)], t[int(full_indices[0])]
    filled = np.interp(np.arange(len(time)), np.flatnonzero(is_complete), t)
    return np.asarray((filled >= onset) & (filled <= end + 10 * max(end - onset, 0.0)))


def ramp_samples(displacement: FloatArray) -> tuple[int, int]:
    """Return the first and the last sample of the first travel; equal where nothing moves."""
    magnitude = np.abs(displacement - displacement[0])
    max_magnitude = float(magnitude.max())
    first_full = int(np.argmax(magnitude > _RAMP_END_SHARE * max_magnitude))
    return first_full - int(
        np.argmax(magnitude[first_full::-1] <= (1 - _RAMP_END_SHARE) * max_magnitude)
    ), first_full


def drop_repeats(time: FloatArray, loaded_data: LoadedColumns) -> tuple[BoolArray, list[str]]:
    """Return which samples to keep so that time rises, and a note on the repeats omitted.

    Raises
    ------
    ReadError
        If the clock falls, or more than 0.1 % of the stamps are repeated.
    """
    keep = np.ones(len(time), dtype=bool)
    steps = np.diff(time)
    fall_indices = np.flatnonzero(steps < 0)
    if fall_indices.size:
        i = int(fall_indices[0])
        part = ", read one part with --file-part segment=N" if len(loaded_data.starts) > 1 else ""
        forward = steps[steps > 0]
        rate = f"--rate {1 / median(forward):.6g}Hz" if forward.size else "--rate 1000Hz"
        raise ReadError(
            f"time falls from {time[i]:.9g} s to {time[i + 1]:.9g} s at "
            f"{loaded_data.format_row_position(i + 1)}: the clock was reset or rows are out of "
            f"order ({fall_indices.size} such place{'s' * (fall_indices.size > 1)}); split the "
            f"file there{part}, or give {rate} if the rows are evenly sampled throughout"
        )
    repeats = np.flatnonzero(steps == 0) + 1
    if repeats.size == 0:
        return keep, []
    first = loaded_data.format_row_position(int(repeats[0]))
    if repeats.size > max(1.0, _MAX_REPEATED_SHARE * len(time)):
        raise ReadError(
            f"{repeats.size} of {len(time)} time stamps repeat the one before, first "
            f"t = {time[repeats[0]]:.9g} s at {first}; the clock has too few "
            f"digits: export more, or give --rate {_mean_rate(time)}Hz if the rows are evenly "
            "sampled, or the true one if that is another"
        )
    keep[repeats] = False
    return keep, [
        f"{repeats.size} repeated time stamp{'s' * (repeats.size > 1)} left out, first at {first}"
    ]


def _mean_rate(time: FloatArray) -> str:
    """The rate of rows whose clock has too few digits: between its first and its last tick."""
    ticks = np.flatnonzero(np.diff(time) > 0) + 1
    if len(ticks) < 2:
        return "1000"
    rows, duration = ticks[-1] - ticks[0], time[ticks[-1]] - time[ticks[0]]
    # either tick may stand a row early or late: the roundest rate that both allow
    rates = (float(f"{rows / duration:.{digits}g}") for digits in range(1, 18))
    return f"{next(rate for rate in rates if abs(rate * duration - rows) < 1.5):.6g}"


def clock_notes(time: FloatArray, *, is_stated: bool = False) -> list[str]:
    """Return notes on jumps of the clock and on an unusual sampling rate.

    A unit that is `is_stated` by the user, or by every cell, is not doubted.
    """
    steps = np.diff(time)
    step = median(steps) if len(time) > 1 else 0.0
    if step <= 0:
        return []
    rate, leaps = 1 / step, [*_find_late_start(steps), *_list_clock_jumps(time)]
    if len(steps) > 1 and steps[-1] / _MAX_LAST_STEP_RATIO > steps[:-1].max():
        message = (
            f"the last row stands {steps[-1]:.6g} s behind the one before it, further than any "
            f"other (up to {steps[:-1].max():.6g} s): does it belong to the record?"
        )
        return [*leaps, Caution(message)]
    if leaps or 1 <= rate <= 1e6:
        return leaps
    read = "milliseconds or minutes read as seconds" if rate > 1e6 else "these milliseconds"
    text = f"sampled at {rate:.3g} Hz, if the unit of time is right: are {read}?"
    message = f'{text} Say it with --units "time=ms"'
    return [message if is_stated else Caution(message, text)]


def round_steps(time: FloatArray, unit: Unit) -> list[str]:
    """Return a note if steps are round in minutes or hours, as those of no recorder.

    Parameters
    ----------
    time : array, shape (n,)
        s.
    unit : Unit
        In which the file has it.
    """
    step = median(np.diff(time)) if len(time) > 1 else 0.0
    if unit.factor < _MINUTE or not 0 < step <= 1:
        return []
    ratio = step / unit.factor
    digits = ratio / 10.0 ** np.floor(np.log10(ratio) + 1e-9)
    if min(abs(digits - value) for value in _ROUND_DIGITS) > _ROUND_TOLERANCE:
        return []
    message = (
        f"the clock's steps are {ratio:.3g} {unit.word}, round in {unit.word} and not in seconds "
        f"({step:.3g} s): are these seconds?"
    )
    return [Caution(f'{message} Say it with --units "time=s"', message)]


def _find_late_start(steps: FloatArray) -> list[str]:
    """Return a note if the first sample is far before all others."""
    rest = steps[1:].max(initial=0.0)
    if len(steps) < 2 * NEIGHBOUR_STEPS or not steps[0] > JUMP_RATIO * rest:
        return []
    message = (
        f"the first row stands {steps[0]:.6g} s before the one after it, further than any other "
        f"(up to {rest:.6g} s): does it belong to the record?"
    )
    return [Caution(message)]


def _list_clock_jumps(time: FloatArray) -> list[str]:
    """Return notes on jumps and interruptions of the clock."""
    # of the first and the last row others show
    leaps = [jump for jump in find_clock_jumps(time) if 0 < jump.at < len(time) - 2]
    notes = [
        f"the clock goes on by {leap.step:.6g} s at t = {time[leap.at]:.6g} s, where its steps "
        f"are {leap.expected_step:.3g} s: it jumped, or the record was interrupted"
        for leap in leaps[:_MAX_LISTED]
    ]
    unlisted = len(leaps) - len(notes)
    return [*notes, f"the clock does so at {unlisted} more places"] if unlisted else notes


def has_swapped_signals(displacement: FloatArray, force: FloatArray) -> bool:
    """Whether the 'force' is held and the 'displacement' relaxes; in a creep test it goes on."""
    return (
        _compute_relaxed_share(displacement) > 0.08
        and max(_compute_relaxed_share(force), _creeps(force)) < 0.01
    )


def compute_active_fraction(signal: FloatArray) -> float:
    """Return the part of a record in which a signal is beyond a tenth of its peak.

    A hammer's pulses take a few samples, the struck mass rings longer.
    """
    deviation = np.abs(signal - median(signal))
    return float(np.mean(deviation > _LOUD_SHARE * deviation.max()))


def _compute_relaxed_share(values: FloatArray) -> float:
    """Share of its range that a signal falls back from its peak by the end of a long tail."""
    change = np.abs(values - values[0])
    peak = int(np.argmax(change))
    if change[peak] <= 0 or peak > 0.5 * len(values):
        return 0.0
    last_part = change[int(0.9 * len(change)) :]
    return float((change[peak] - median(last_part)) / change[peak])


def _creeps(values: FloatArray) -> float:
    """Share of its range by which a signal that peaks late still moves in its later half."""
    change = np.abs(values - values[0])
    if int(np.argmax(change)) <= 0.5 * len(values):
        return 0.0
    return float(np.ptp(change[int(0.5 * len(change)) :]) / change.max())


# Signals with their own clocks: pairs of columns, time and signal.


def find_separate_clocks(table: FileTable, options: ReadOptions) -> tuple[RoleAssignment, ...]:
    """Return the clocks of displacement and force, if each has its own; else None.

    A signal's own clock is the column of time right before it, where no one column is the time.
    """
    if (
        options.time
        or options.rate
        or not isinstance(assign_role(table, "time", options), Question)
    ):
        return ()
    clocks = []
    signals: tuple[Role, ...] = ("displacement", "force")
    for role in signals:
        signal = assign_role(table, role, options)
        before = signal.index - 1 if isinstance(signal, RoleAssignment) else -1
        if before < 0 or score(table.columns[before], "time", options) < 1.5:
            return ()
        clocks.append(RoleAssignment("time", before, f"it stands before the {role}"))
    return tuple(clocks) if clocks[0].index != clocks[1].index else ()


def assign_time_since_step(table: FileTable, options: ReadOptions) -> RoleAssignment | Question:
    """Return the clock of a curve over the time since a step: that of the step, beside a whole one.

    A rheometer writes both, and the whole one began before the step.
    """
    assignment = assign_role(table, "time", options)
    if options.time or isinstance(assignment, Question):
        return assignment
    indices = [
        i
        for i in assignment.alternatives
        if score(table.columns[i], "time", options) >= MIN_SCORE
        and has_word(table.columns[i].name, STEP_TIME)
    ]
    return (
        RoleAssignment("time", indices[0], "it runs since the step")
        if len(indices) == 1
        else assignment
    )


def interpolate_to_force_clock(loaded_columns: LoadedColumns, ratio: float = 1.0) -> LoadedColumns:
    """Return time, displacement and force at the instants of the force.

    Parameters
    ----------
    loaded_columns : LoadedColumns
        Time of the force, displacement, force, time of the displacement.
    ratio : float
        The unit of the displacement's time in that of the force's.

    Raises
    ------
    ReadError
        If the displacement's clock falls, or the two share no time.
    """
    time, change, force, ticks = loaded_columns.values.T
    ticks = ratio * ticks
    value = np.isfinite(ticks) & np.isfinite(change)
    fall_indices = np.flatnonzero(np.diff(ticks[value]) <= 0)
    if fall_indices.size:
        row = int(np.flatnonzero(value)[fall_indices[0] + 1])
        raise ReadError(
            "the clock of the displacement does not rise at "
            f"{loaded_columns.format_row_position(row)}; name one clock for both with --column "
            "time=NAME"
        )
    start = np.min(ticks, where=value, initial=np.inf)
    end = np.max(ticks, where=value, initial=-np.inf)
    has_both = np.isfinite(time) & np.isfinite(force) & (time >= start) & (time <= end)
    if not has_both.any():
        raise ReadError(
            "the clocks of displacement and force share no time; name one clock for both "
            "with --column time=NAME"
        )
    shared = channels.select_rows(loaded_columns, has_both)
    at_forces = np.interp(time[has_both], ticks[value], change[value])
    note = (
        f"displacement and force have clocks of their own: {has_both.sum()} of {len(time)} rows of "
        "force lie within both, and the displacement was interpolated to their instants"
    )
    values = np.column_stack([time[has_both], at_forces, force[has_both]])
    return replace(shared, values=values, notes=(*shared.notes, note))
