"""From a file to the motion of an indenter."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.arrays import median
from dashpot.base.errors import DataError, ReadError
from dashpot.io.columns.kinds import FileKind
from dashpot.io.columns.roles import Assigned, accelerations, assign, list_columns, quoted
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels, checks
from dashpot.io.readers.channels import Channel, Opened
from dashpot.records.indentation import IndentationTest, Indenter, Motion

_NAMED = ("acceleration", "velocity", "displacement", "force")


def read_indentation(
    path: str | Path, *, indenter: Indenter | None = None, options: ReadOptions | None = None
) -> IndentationTest:
    """Return the motion of an indenter in a file, in SI units.

    An acceleration is taken before a velocity, that before a displacement, and any before a force
    alone; a force beside a motion is kept to hold the motion to.

    Raises
    ------
    ReadError
        If the file cannot be read, or leaves open which column is what or in which unit.
    """
    with channels.opened(path, options) as file:
        beside = assign(file.table, "force", file.options)
        # an acceleration beside a force is a hammer's, unless the file speaks of an indenter
        kinds: list[FileKind] = ["indentation"]
        kinds += [] if isinstance(beside, Assigned) else ["impact"]
        channels.expect(file, kinds, "the motion of an indenter is", named=_NAMED)
        motion, of = _motion(file)
        wanted: list[Role] = [] if file.options.rate else ["time"]
        forces = [beside] if isinstance(beside, Assigned) and of != "force" else []
        forces = [one for one in forces if one.index != motion.index]
        chosen = channels.with_units(file, [*channels.chosen(file, wanted), motion, *forces])
        channels.refuse_other_rate(file)
        loaded = channels.load_test(file, chosen, least=16)
        rows, gaps = channels.whole_rows(loaded)
        values = {c.role: channels.si(rows[:, j].copy(), c.unit) for j, c in enumerate(chosen)}
        rate = file.options.rate
        time = np.arange(len(rows)) / rate if rate else values["time"]
        _refuse_sizes(file, chosen, time, float(np.abs(values[of]).max()))
        source = channels.source(file, [c.says for c in chosen], [*file.table.notes, *gaps])
        try:
            return IndentationTest(
                time, values[of], of, indenter or Indenter(),
                values["force"] if forces else None, source,
            )  # fmt: skip
        except DataError as error:
            raise ReadError(str(error)) from None


def _motion(file: Opened) -> tuple[Assigned, Motion]:
    """The column that is fitted, and what it is."""
    options = file.options
    named = [role for role in _NAMED if getattr(options, role)]
    if not named or named[0] == "acceleration":
        found = accelerations(file.table, (), options)
        if len(found) > 1:
            listed = ", ".join(quoted(file.table.columns, i) for i in found)
            raise ReadError(
                f"{listed} are accelerations, and one indenter has one; name it with --acceleration"
            )
        if found:
            return Assigned("acceleration", found[0], "its name or unit says acceleration"), (
                "acceleration"
            )
    order: tuple[Motion, ...] = ("velocity", "displacement", "force")
    for role in order:
        answer = assign(file.table, role, options)
        if isinstance(answer, Assigned) and (not named or role in named):
            return answer, role
    raise ReadError(
        "no acceleration, velocity, displacement or force of an indenter is recognised; name its "
        "column with --acceleration, --velocity, --displacement or --force; the columns are "
        f"{list_columns(file.table.columns)}"
    )


def _refuse_sizes(file: Opened, chosen: list[Channel], time: np.ndarray, largest: float) -> None:
    """Ask for the units again that make a size no indenter has."""
    asked = []
    for one in chosen:
        word = one.unit.word
        if one.role == "time":
            asked.append((one, [checks.contact_rate(1 / max(median(np.diff(time)), 1e-12), word)]))
        elif one.role == "acceleration":
            asked.append((one, [checks.shock_not_large(largest, word)]))
        elif one.role == "velocity":
            asked.append((one, [checks.indenter_not_fast(largest, word)]))
    channels.refuse_sizes(file, asked)
