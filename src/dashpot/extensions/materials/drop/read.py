"""Reader of drop tests: force on the specimen, or motion of the mass."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.drop.datamodel import DropTest
from dashpot.reading.columns.role_assignment import (
    RoleAssignment,
    accelerations,
    format_column,
    list_columns,
)
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.header_metadata import add_specimen_temperature


def read_drop_test(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> DropTest:
    """Return a drop test: force, acceleration of the mass, or both, in SI units.

    Raises
    ------
    ReadError
        If the file cannot be read, or the role or unit of a column is not known.
    """
    with channels.open_file(path, options) as file:
        channels.refuse_other_kinds(
            file, ["drop"], "a mass dropped on a specimen is",
            stated_columns=("force", "acceleration"),
        )  # fmt: skip
        signal_columns = [
            assignment
            for assignment in (file.find_unambiguous_column("force"), _find_acceleration(file))
            if assignment is not None
        ]
        if not signal_columns:
            raise ReadError(
                "no force and no acceleration is recognised. Name the column of one, such as "
                f"--column force=NAME; the columns are {list_columns(file.table.columns)}"
            )
        ticks = channels.select_columns(file, channels.add_time_role(file))
        channels_chosen = channels.add_units(file, [*ticks, *signal_columns])
        channels.refuse_other_rate(file)
        rows, gaps = channels.select_complete_rows(
            channels.load_test(file, channels_chosen, min_count=16)
        )
        values = channels.convert_signals_to_si(rows, channels_chosen)
        rate = file.options.rate
        time = np.arange(len(rows)) / rate if rate else values["time"]
        resolved_specimen, sentences = add_specimen_temperature(file, specimen or Specimen())
        source = channels.make_source(
            file,
            [channel.message for channel in channels_chosen],
            [*file.table.notes, *gaps, *sentences],
        )
        return DropTest(
            time,
            values.get("force"),
            values.get("acceleration"),
            resolved_specimen,
            source,
            units="SI",
        )


def _find_acceleration(file: OpenedFile) -> RoleAssignment | None:
    """Return the only acceleration, if there is one."""
    indices = accelerations(file.table, (), file.options)
    if len(indices) > 1:
        columns_text = ", ".join(format_column(file.table.columns, i) for i in indices)
        raise ReadError(
            f"{columns_text} are accelerations, and one mass has one. Name it: --column "
            "acceleration=NAME"
        )
    message = "its name or unit says acceleration"
    return RoleAssignment("acceleration", indices[0], message) if indices else None
