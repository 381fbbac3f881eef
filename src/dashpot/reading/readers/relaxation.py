"""Reader of relaxation tests, or of their motion alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import ReadError
from dashpot.datamodel.relaxation import RelaxationTest, Trajectory
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.columns.file_kinds import SWEEP_KINDS, FileKind
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels, cleaning, size_checks
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.cleaning import find_separate_clocks, interpolate_to_force_clock
from dashpot.reading.readers.header_metadata import add_specimen_temperature, stated_rest
from dashpot.reading.table import LoadedColumns
from dashpot.signals.clock import ClockJump, find_rate_change

# Relaxation test.


def read_relaxation(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> RelaxationTest:
    """Return the relaxation test in a file, in SI units; ``-`` is stdin.

    Parameters
    ----------
    path : path
        A text file of any lab, or an instrument's own format.
    options : ReadOptions
        Reading options of the file.
    specimen : Specimen or None
        Tested specimen, kept with the record.

    Raises
    ------
    ReadError
        If the file cannot be read, or does not determine its columns and units; the sentence names
        the option to use.
    """
    with channels.open_file(path, options) as file:
        return relaxation_in(file, specimen or Specimen())


def roles(file: OpenedFile) -> list[Role]:
    """Return the columns that a relaxation test needs: no clock where a rate is given."""
    return channels.add_time_role(file, "displacement", "force")


def relaxation_in(file: OpenedFile, specimen: Specimen) -> RelaxationTest:
    """Return the relaxation test in an opened file."""
    channels.refuse_summary(file)
    _require_relaxation_kind(file, SWEEP_KINDS)
    try:
        channels_chosen, clocks = moving_columns(file)
    except ReadError:
        _require_relaxation_kind(file)
        raise
    values, notes = load_signals(file, channels_chosen, clocks)
    time, displacement, force = (values[role] for role in ("time", "displacement", "force"))
    _refuse_swapped(file, channels_chosen, displacement, force)
    notes += _refuse_sizes(file, channels_chosen, time, displacement, force)
    specimen, sentences = add_specimen_temperature(file, specimen, channels_chosen)
    specimen, rest_notes = stated_rest(file, specimen)
    source = channels.make_source(
        file, [c.message for c in channels_chosen], [*notes, *sentences, *rest_notes]
    )
    return RelaxationTest(time, displacement, force, specimen, source, units="SI")


def load_signals(
    file: OpenedFile, channels_chosen: Sequence[Channel], clocks: Sequence[Channel] = ()
) -> tuple[dict[Role, FloatArray], list[str]]:
    """Return the signals of a test by role, in SI units on one rising clock, and notes.

    Parameters
    ----------
    file : OpenedFile
    channels_chosen : sequence of Channel
        The time unless a rate is given, what moves, what pushes.
    clocks : sequence of Channel
        The clock of the displacement, where it has a separate one.

    Raises
    ------
    ReadError
        If rows are missing about the ramp or are too many, or a clock decreases.
    """
    channels.refuse_other_rate(file)
    moving = channels_chosen[-2].role
    loaded_columns = channels.load_test(file, [*channels_chosen, *clocks])
    if clocks:
        loaded_columns = interpolate_to_force_clock(
            loaded_columns, clocks[0].unit.factor / channels_chosen[0].unit.factor
        )
    elif not file.options.rate:
        loaded_columns = cleaning.remove_padding(loaded_columns)
    values = channels.convert_signals_to_si(loaded_columns.values, channels_chosen)
    notes = [
        *file.table.notes,
        *channels.describe_alternatives(file, channels_chosen),
        *loaded_columns.notes,
    ]
    rate = file.options.rate
    if rate is not None:
        values["time"] = np.arange(len(loaded_columns.values)) / rate
        notes.append(f"time counted from the rows at {rate:g} Hz, as given")
    if len(loaded_columns.starts) > 1:
        notes.append(check_joined_segments(values["time"], loaded_columns))
    if not np.isfinite(loaded_columns.values).all():
        window = cleaning.ramp_window(values["time"], values[moving])
        keep, dropped = cleaning.drop_missing(
            loaded_columns, [c.role for c in channels_chosen], protect=window
        )
        notes += dropped
        values = {role: column[keep] for role, column in values.items()}
        loaded_columns = channels.select_rows(loaded_columns, keep)
    keep, dropped = cleaning.drop_repeats(values["time"], loaded_columns)
    notes += dropped
    if not keep.all():
        values = {role: column[keep] for role, column in values.items()}
    is_clock_stated = rate is not None or channels.is_stated(file, channels_chosen[0])
    clock = cleaning.clock_notes(values["time"], is_stated=is_clock_stated)
    if not (is_clock_stated or clock):
        clock = cleaning.round_steps(values["time"], channels_chosen[0].unit)
    return values, [*notes, *clock]


def signals(
    file: OpenedFile, *roles: Role, min_count: int = 8, clock_matters: bool = True
) -> tuple[list[Channel], dict[Role, FloatArray], list[str]]:
    """Return two signals in SI units, as :func:`load_signals`, or row by row without a clock.

    With their columns, and that of the time unless there is none or a rate is given, and notes. A
    clock that does not matter may be broken, or lack its unit: it is omitted with a note.

    Raises
    ------
    ReadError
        With the open questions, such as which of two clocks is the clock of the test.
    """
    left_out = []
    if file.options.rate or file.find_unambiguous_column("time"):
        try:
            channels_chosen = channels.choose_channels(file, channels.add_time_role(file, *roles))
            return channels_chosen, *load_signals(file, channels_chosen)
        except ReadError as error:
            if clock_matters:
                raise
            left_out.append(f"the clock is left out: {error}")
    channels_chosen = channels.choose_channels(file, roles)
    rows, gaps = channels.select_complete_rows(channels.load_test(file, channels_chosen, min_count))
    notes = [
        *file.table.notes,
        *channels.describe_alternatives(file, channels_chosen),
        *gaps,
        *left_out,
    ]
    return channels_chosen, channels.convert_signals_to_si(rows, channels_chosen), notes


_MIN_RAMP_STEPS = 5
"""Steps between samples that show a ramp; a commanded step has one."""


def _refuse_sizes(
    file: OpenedFile,
    channels_chosen: Sequence[Channel],
    time: FloatArray,
    displacement: FloatArray,
    force: FloatArray,
) -> list[str]:
    """Ask for the units again that make a size no test of a seal has; notes on unusual ones."""
    travel, force_range = float(np.ptp(displacement)), float(np.ptp(force))
    ramp_start, ramp_stop = cleaning.ramp_samples(displacement)
    force_change = np.abs(force - force[ramp_start])
    # a record that begins in its hold shows neither
    has_loading = bool(
        force_change[ramp_stop] > 0.5 * force_range and force_change[ramp_stop] >= force_change[-1]
    )
    has_ramp = has_loading and ramp_stop - ramp_start >= _MIN_RAMP_STEPS
    ramp_time = float(time[ramp_stop] - time[ramp_start]) if has_ramp else 0.0
    duration = float(np.ptp(time))
    change = find_rate_change(time)

    def check_step_unit(steps: ClockJump, ticks: str) -> Check:
        return size_checks.clock_unit_constant(
            steps.expected_step, steps.step, float(time[steps.at]), ticks
        )

    def evaluate_sizes(
        times: Mapping[Role, float], unit: Mapping[Role, str], stated_roles: AbstractSet[Role]
    ) -> list[tuple[Role, list[Check]]]:
        motion_range, force_size = travel * times["displacement"], force_range * times["force"]
        clock = times.get("time", 1.0)
        ramp = 0.0 if "displacement" in stated_roles else ramp_time * clock
        # a speed is made of both: of an unusual travel that is too fast the travel is asked first
        is_too_fast = bool(ramp) and size_checks.ramp_not_fast(motion_range / ramp, "s").failed
        motion_unit, force_unit = unit["displacement"], unit["force"]
        time_unit = unit.get("time", "s")
        of_seal = replace(
            size_checks.travel_of_a_seal(motion_range, motion_unit),
            grade="stop" if is_too_fast else "note",
        )
        answers: dict[Role, list[Check]] = {
            "force": [
                size_checks.size_possible("force", force_size, force_unit, role="force"),
                size_checks.force_of_a_seal(force_size, force_unit),
                size_checks.force_of_a_bench(force_size, force_unit, travel=motion_range),
                size_checks.stiffness_of_a_seal(
                    force_size, force_unit, travel=motion_range, travel_unit=motion_unit
                ),
            ],
            "displacement": [
                size_checks.size_possible("travel", motion_range, motion_unit, role="displacement"),
                of_seal,
                *(
                    [size_checks.travel_of_a_bench(motion_range, motion_unit, force=force_size)]
                    if has_loading
                    else []
                ),
            ],
            "time": [
                size_checks.time_of_a_test(duration * clock, time_unit),
                size_checks.size_possible("record", duration * clock, time_unit, role="time"),
                size_checks.size_possible("ramp", ramp, time_unit, role="time"),
                size_checks.ramp_not_slow(ramp, time_unit),
                *([] if change is None else [check_step_unit(change, time_unit)]),
                *([size_checks.ramp_not_fast(motion_range / ramp, time_unit)] if ramp else []),
            ],
        }
        return [(role, answers[role]) for role in answers if role in unit]

    return channels.refuse_all_sizes(file, channels_chosen, evaluate_sizes)


def _refuse_swapped(
    file: OpenedFile,
    channels_chosen: Sequence[Channel],
    displacement: FloatArray,
    force: FloatArray,
) -> None:
    """Propose the swap where the 'displacement' relaxes, unless the user named the columns."""
    if (
        file.options.force
        or file.options.displacement
        or not cleaning.has_swapped_signals(displacement, force)
    ):
        return
    index = {channel.role: channel.index for channel in channels_chosen}
    raise ReadError(
        "displacement and force look swapped: the column read as force is held while the one read "
        "as displacement relaxes; if so, add "
        + channels.format_role_options(
            file, [("displacement", index["force"]), ("force", index["displacement"])]
        )
    )


def _require_relaxation_kind(file: OpenedFile, other_kinds: Sequence[FileKind] = ()) -> None:
    """Refuse another kind of file; a sweep may hold the columns of a relaxation test too.

    If only the clock is missing, the sampling rate is requested.
    """
    channels.refuse_other_kinds(
        file,
        ["relaxation", "cld", "cyclic", *other_kinds],
        "a ramp and a hold is",
        stated_columns=["displacement", "force"],
    )


def moving_columns(
    file: OpenedFile, moving: Role = "displacement", force_role: Role = "force"
) -> tuple[list[Channel], list[Channel]]:
    """Return the columns of a record's roles, and the clock of what moves where it has its own.

    Raises
    ------
    ReadError
        With every question that the file leaves open.
    """
    clocks = find_separate_clocks(file.table, file.options) if moving == "displacement" else ()
    if not clocks:
        return channels.choose_channels(file, channels.add_time_role(file, moving, force_role)), []
    displacement_clock, force_clock = channels.add_units(file, clocks)
    signals = channels.choose_channels(file, [moving, force_role])
    return [force_clock, *signals], [displacement_clock]


def check_joined_segments(time: FloatArray, loaded_columns: LoadedColumns) -> str:
    """Note that segments were joined; refuse it where their clocks start again."""
    names = [f"{i + 1} {name}".strip() for i, name in enumerate(loaded_columns.segments)]
    segments_text = ", ".join(names[:8]) + (" ..." if len(names) > 8 else "")
    for start in loaded_columns.starts[1:]:
        if time[start] < time[start - 1]:
            raise ReadError(
                f"{len(names)} segments ({segments_text}), and the clock starts again at "
                f"{loaded_columns.format_row_position(start)}; choose one, for example --file-part "
                "segment=1"
            )
    return f"{len(names)} segments joined into one record: {segments_text}"


# Motion: the columns of time and displacement alone.


def read_trajectory(path: str | Path, *, options: ReadOptions | None = None) -> Trajectory:
    """Return the motion in a record or in a list of set-points; ``-`` is stdin.

    Rows without a number are omitted, with a note in the source.

    Raises
    ------
    ReadError
        If the file cannot be read, or does not determine its columns and units.
    """
    with channels.open_file(path, options) as file:
        channels.refuse_other_rate(file)
        rate = file.options.rate
        channels_chosen = channels.choose_channels(
            file, channels.add_time_role(file, "displacement")
        )
        rows, sentences = channels.select_complete_rows(
            channels.load_test(file, channels_chosen, 2)
        )
        values = channels.convert_signals_to_si(rows, channels_chosen)
        time = np.arange(len(rows)) / rate if rate else values["time"]
        notes = [*file.table.notes, *sentences]
        source = channels.make_source(file, [c.message for c in channels_chosen], notes)
        return Trajectory(time, values["displacement"], source=source)
