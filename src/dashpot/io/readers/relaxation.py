"""From a file to a relaxation test."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError, ReadError
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels, cleaning
from dashpot.io.source import open_raw
from dashpot.io.table import Loaded
from dashpot.records.relaxation import RelaxationTest
from dashpot.records.specimen import Specimen


def read_relaxation(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
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
    options = options or ReadOptions()
    raw = open_raw(path)
    table = channels.test_table(raw, options)
    roles: list[Role] = ["displacement", "force"]
    if options.rate is None:
        roles.insert(0, "time")
    chosen = channels.choose(raw, table, roles, options)
    loaded = channels.load(table, [c.index for c in chosen], options, raw.name)
    channels.enough(loaded, raw.name)
    values = {c.role: channels.si(loaded.values[:, j], c.unit) for j, c in enumerate(chosen)}
    notes = [*table.notes, *channels.rivals(table, chosen, options), *loaded.notes]
    if options.rate is not None:
        values["time"] = np.arange(len(loaded.values)) / options.rate
        notes.append(f"time counted from the rows at {options.rate:g} Hz, as given")
    if len(loaded.starts) > 1:
        notes.append(_joined(values["time"], loaded, raw.name))
    if not np.isfinite(loaded.values).all():
        window = cleaning.ramp_window(values["time"], values["displacement"])
        names = [c.role for c in chosen]
        keep, said = cleaning.drop_missing(loaded, names, protect=window, file=raw.name)
        notes += said
        values = {role: column[keep] for role, column in values.items()}
        loaded = channels.rows(loaded, keep)
    keep, said = cleaning.drop_repeats(values["time"], loaded, file=raw.name)
    notes += said
    time, moved, force = (
        values[role] if keep.all() else values[role][keep]
        for role in ("time", "displacement", "force")
    )
    notes += cleaning.clock_notes(time)
    notes += cleaning.swapped(moved, force)
    source = channels.source(raw, table, chosen, notes)
    try:
        return RelaxationTest(time, moved, force, specimen or Specimen(), source)
    except DataError as error:
        raise ReadError(f"{raw.name}: {error}") from None


def _joined(time: FloatArray, loaded: Loaded, file: str) -> str:
    """Say that segments were joined; refuse it where their clocks start again."""
    names = [f"{i + 1} {name}".strip() for i, name in enumerate(loaded.segments)]
    listed = ", ".join(names[:8]) + (" ..." if len(names) > 8 else "")
    for start in loaded.starts[1:]:
        if time[start] < time[start - 1]:
            raise ReadError(
                f"{file}: {len(names)} segments ({listed}), and the clock starts again at "
                f"{loaded.where(start)}; choose one, for example --segment 1"
            )
    return f"{len(names)} segments joined into one record: {listed}"
