"""From a file to an amplitude sweep: storage and loss against strain or displacement."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.io.columns.roles import Assigned, assign, list_columns
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.readers.dynamic import sweep_columns
from dashpot.io.readers.stated import stated_specimen
from dashpot.records.amplitude import AmplitudeSweep
from dashpot.records.specimen import Specimen

_OF: tuple[tuple[Role, str], ...] = (("strain", "strain"), ("displacement", "m"))


def read_amplitude(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> AmplitudeSweep:
    """Return the amplitude sweep in a file, in SI units: strain as a ratio, displacement in m.

    Storage and loss (or storage and loss factor) against a column of strain or displacement
    amplitude, at one frequency or a few. Rows that lack a number are left out with a note.

    Raises
    ------
    ReadError
        If a column is not found or has no unit, or the amplitude never changes.
    """
    with channels.opened(path, options) as file:
        channels.expect(
            file,
            ["strain-sweep", "one-frequency", "dma"],
            "an amplitude sweep is",
            named=["storage"],
        )
        wanted, ratio = sweep_columns(file)
        found = [(assign(file.table, role, file.options), of) for role, of in _OF]
        held = [(one, of) for one, of in found if isinstance(one, Assigned)]
        if not held:
            raise ReadError(
                "no column of strain or displacement amplitude was found; name it with --strain or "
                f"--displacement; the columns are {list_columns(file.table.columns)}"
            )
        column, of = held[0]
        chosen = channels.with_units(file, [*wanted, column])
        indexes = [c.index for c in chosen] + ([] if ratio is None else [ratio])
        loaded = channels.load(file.table, indexes, file.options.segment)
        rows, gaps = channels.whole_rows(loaded)
        values = {c.role: channels.si(rows[:, j].copy(), c.unit) for j, c in enumerate(chosen)}
        if ratio is not None:
            percent = file.table.columns[ratio].unit == "%"
            values["loss"] = values["storage"] * rows[:, -1] / (100 if percent else 1)
        amplitude = values[column.role]
        if not np.ptp(amplitude) > 0:
            raise ReadError(
                f"'{file.table.columns[column.index].name}' never changes: it is no amplitude sweep"
            )
        kinds = {c.role: c.unit.dimension for c in chosen}
        specimen, said = stated_specimen(file, specimen or Specimen())
        return AmplitudeSweep(
            values["frequency"],
            amplitude,
            values["storage"],
            values["loss"],
            "N/m" if kinds["storage"] == "stiffness" else "Pa",
            of,
            specimen,
            channels.source(file, [c.says for c in chosen], (*file.table.notes, *gaps, *said)),
        )
