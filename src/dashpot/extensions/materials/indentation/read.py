"""Reader of indentation tests: the motion of an indenter."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.arrays import median
from dashpot.base.errors import ReadError
from dashpot.extensions.materials.indentation import size_checks
from dashpot.extensions.materials.indentation.datamodel import IndentationTest, Motion
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.reading.columns.file_kinds import FileKind
from dashpot.reading.columns.role_assignment import (
    RoleAssignment,
    accelerations,
    format_column,
    list_columns,
)
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import Channel, OpenedFile

_NAMED: tuple[Motion, ...] = ("acceleration", "velocity", "displacement", "force")


def read_indentation(
    path: str | Path, *, indenter: Indenter | None = None, options: ReadOptions | None = None
) -> IndentationTest:
    """Return the motion of an indenter in a file, in SI units.

    An acceleration is preferred to a velocity, that to a displacement, and any motion to a force
    only; a force beside a motion is kept to hold the motion to.

    Raises
    ------
    ReadError
        If the file cannot be read, or does not determine its columns and units.
    """
    with channels.open_file(path, options) as file:
        assignment, notes = channels.find_optional_column(file, "force")
        # an acceleration beside a force is a hammer's, unless the file concerns an indenter
        kinds: list[FileKind] = ["indentation"] if assignment else ["indentation", "impact"]
        channels.refuse_other_kinds(
            file, kinds, "the motion of an indenter is", stated_columns=_NAMED
        )
        motion, quantity = _find_motion_column(file)
        forces = (
            [assignment]
            if assignment and quantity != "force" and assignment.index != motion.index
            else []
        )
        ticks = channels.select_columns(file, channels.add_time_role(file))
        channels_chosen = channels.add_units(file, [*ticks, motion, *forces])
        channels.refuse_other_rate(file)
        rows, gaps = channels.select_complete_rows(
            channels.load_test(file, channels_chosen, min_count=16)
        )
        values = channels.convert_signals_to_si(rows, channels_chosen)
        rate = file.options.rate
        time = np.arange(len(rows)) / rate if rate else values["time"]
        _refuse_sizes(file, channels_chosen, time, float(np.abs(values[quantity]).max()))
        source = channels.make_source(
            file, [c.message for c in channels_chosen], [*file.table.notes, *gaps, *notes]
        )
        return IndentationTest(
            time, values[quantity], quantity, indenter or Indenter(),
            values["force"] if forces else None, source, units="SI",
        )  # fmt: skip


def _find_motion_column(file: OpenedFile) -> tuple[RoleAssignment, Motion]:
    """Return the fitted column, and its kind."""
    roles_named = [role for role in _NAMED if getattr(file.options, role)]
    for role in roles_named or _NAMED:
        answer = (
            _find_acceleration(file)
            if role == "acceleration"
            else file.find_unambiguous_column(role)
        )
        if answer is not None:
            return answer, role
    raise ReadError(
        "no acceleration, velocity, displacement or force of an indenter is recognised; name its "
        "column, such as --column acceleration=NAME; the columns are "
        f"{list_columns(file.table.columns)}"
    )


def _find_acceleration(file: OpenedFile) -> RoleAssignment | None:
    """Return the only acceleration, if there is one."""
    indices = accelerations(file.table, (), file.options)
    if len(indices) > 1:
        columns_text = ", ".join(format_column(file.table.columns, i) for i in indices)
        raise ReadError(
            f"{columns_text} are accelerations, and one indenter has one; name it with "
            "--column acceleration=NAME"
        )
    message = "its name or unit says acceleration"
    return RoleAssignment("acceleration", indices[0], message) if indices else None


def _refuse_sizes(
    file: OpenedFile, channels_chosen: list[Channel], time: np.ndarray, largest: float
) -> None:
    """Ask again for units that give an implausible size for an indenter."""
    failed_checks = []
    for channel in channels_chosen:
        word = channel.unit.word
        if channel.role == "time":
            failed_checks.append(
                (channel, [size_checks.contact_rate(1 / max(median(np.diff(time)), 1e-12), word)])
            )
        elif channel.role == "acceleration":
            failed_checks.append((channel, [size_checks.shock_not_large(largest, word)]))
        elif channel.role == "velocity":
            failed_checks.append((channel, [size_checks.indenter_not_fast(largest, word)]))
    channels.refuse_sizes(file, failed_checks)
