"""Signals that each have a clock of their own: columns in pairs, time and signal, side by side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.reading.columns.role_assignment import RoleAssignment, assign, score
from dashpot.reading.columns.vocabulary import STEP_TIME, Role, has_word
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.table import FileTable, LoadedColumns, Question


def find_separate_clocks(table: FileTable, options: ReadOptions) -> tuple[RoleAssignment, ...]:
    """Return the clock of the displacement and that of the force, if each has its own; else none.

    A signal's own clock is the column of time right before it, where no one column is the time.
    """
    if options.time or options.rate or not isinstance(assign(table, "time", options), Question):
        return ()
    clocks = []
    signals: tuple[Role, ...] = ("displacement", "force")
    for role in signals:
        signal = assign(table, role, options)
        before = signal.index - 1 if isinstance(signal, RoleAssignment) else -1
        if before < 0 or score(table.columns[before], "time", options) < 1.5:
            return ()
        clocks.append(RoleAssignment("time", before, f"it stands before the {role}"))
    return tuple(clocks) if clocks[0].index != clocks[1].index else ()


def since_the_step(table: FileTable, options: ReadOptions) -> RoleAssignment | Question:
    """Return the clock of a curve over the time since a step: that of the step, beside a whole one.

    A rheometer writes both, and the whole one began before the step.
    """
    answer = assign(table, "time", options)
    if options.time or isinstance(answer, Question):
        return answer
    indices = [
        i
        for i in answer.rivals
        if score(table.columns[i], "time", options) >= 1.5
        and has_word(table.columns[i].name, STEP_TIME)
    ]
    return (
        RoleAssignment("time", indices[0], "it runs since the step")
        if len(indices) == 1
        else answer
    )


def interpolate_to_force_clock(loaded: LoadedColumns, ratio: float = 1.0) -> LoadedColumns:
    """Return time, displacement and force at the instants of the force.

    Parameters
    ----------
    loaded : Loaded
        Time of the force, displacement, force, time of the displacement.
    ratio : float
        The unit of the displacement's time in that of the force's.

    Raises
    ------
    ReadError
        If the displacement's clock falls, or the two share no time.
    """
    time, change, force, ticks = loaded.values.T
    ticks = ratio * ticks
    value = np.isfinite(ticks) & np.isfinite(change)
    falls = np.flatnonzero(np.diff(ticks[value]) <= 0)
    if falls.size:
        row = int(np.flatnonzero(value)[falls[0] + 1])
        raise ReadError(
            f"the clock of the displacement does not rise at {loaded.format_row_position(row)}; "
            "name one clock "
            "for both with --column time=NAME"
        )
    begin, end = (
        np.min(ticks, where=value, initial=np.inf),
        np.max(ticks, where=value, initial=-np.inf),
    )
    both = np.isfinite(time) & np.isfinite(force) & (time >= begin) & (time <= end)
    if not both.any():
        raise ReadError(
            "the clocks of displacement and force share no time; name one clock for both "
            "with --column time=NAME"
        )
    shared = channels.rows(loaded, both)
    at_forces = np.interp(time[both], ticks[value], change[value])
    note = (
        f"displacement and force have clocks of their own: {both.sum()} of {len(time)} rows of "
        "force lie within both, and the displacement was interpolated to their instants"
    )
    values = np.column_stack([time[both], at_forces, force[both]])
    return replace(shared, values=values, notes=(*shared.notes, note))
