"""Reader of relaxation moduli over time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.units import si_unit
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.datamodel.sample_temperatures import has_several_temperatures
from dashpot.extensions.curves.datamodel.stress_relaxation import StressRelaxationTest
from dashpot.extensions.curves.material_records import (
    MATERIAL,
    is_stress_record,
    read_strain_and_stress,
)
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE
from dashpot.reading.columns.role_assignment import RoleAssignment, assign_role, format_column
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.cleaning import assign_time_since_step
from dashpot.reading.readers.header_metadata import (
    add_specimen_temperature,
    temperatures_of_segments,
)
from dashpot.reading.readers.inspect import list_unit_questions
from dashpot.reading.readers.relaxation import check_joined_segments
from dashpot.reading.table import Question


def roles(file: OpenedFile) -> tuple[Role, ...]:
    """The columns that a relaxation modulus is read from, or strain and stress in its place."""
    curve, stress = (assign_role(file.table, role, file.options) for role in ("modulus", "stress"))
    is_named = isinstance(curve, RoleAssignment)
    # the only column in a unit of stress is the stress where a strain stands beside it
    if isinstance(curve, RoleAssignment) and isinstance(stress, RoleAssignment):
        is_named = file.options.modulus is not None or curve.index != stress.index
    return ("time", "modulus") if is_named or not is_stress_record(file) else MATERIAL


def read_modulus(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> RelaxationModulus | StressRelaxationTest:
    """Return the relaxation modulus E(t) in a file, or strain and stress, in SI units.

    Rows that lack a number are omitted with a note. Where there is a column of temperature, and
    it says several, the times may start again at each.

    Raises
    ------
    ReadError
        If time or modulus is not found or has no unit, or time does not increase.
    """
    with channels.open_file(path, options) as file:
        if roles(file) is MATERIAL:
            return StressRelaxationTest(
                **read_strain_and_stress(file, specimen or Specimen()), units="SI"
            )
        assignments = [
            assign_time_since_step(file.table, file.options),
            assign_role(file.table, "modulus", file.options),
        ]
        columns = channels.require_answers(file, assignments)
        _refuse_compliance(file, columns[1])
        channels_chosen, values, temperature, notes = read_over_time(file, columns)
        specimen, sentences = add_specimen_temperature(file, specimen or Specimen())
        return RelaxationModulus(
            values["time"],
            values["modulus"],
            si_unit(channels_chosen[1].unit.dimension).word,
            specimen,
            channels.make_source(
                file,
                [channel.message for channel in channels_chosen],
                (*file.table.notes, *notes, *sentences),
            ),
            temperature,
            units="SI",
        )


def propose_temperature(file: OpenedFile, roles: object) -> list[Question]:
    """Return the question of the temperature, which a relaxation modulus may have."""
    del roles
    return list_unit_questions(lambda: file.find_unambiguous_column("temperature"), "temperature")


def read_over_time(
    file: OpenedFile, columns: Sequence[RoleAssignment]
) -> tuple[list[Channel], dict[Role, FloatArray], FloatArray | None, Sequence[str]]:
    """Return time and value after a step in SI units, by role, and the temperature, K, of each row.

    None for the last unless a column, or the lines over the segments, say several.
    """
    temperature = file.find_unambiguous_column("temperature")
    if temperature is not None and temperature.index not in {column.index for column in columns}:
        columns = [*columns, temperature]
    channels_chosen = channels.add_units(file, columns)
    loaded_columns = channels.load(
        file.table, [channel.index for channel in channels_chosen], file.options.segment
    )
    loaded_columns = channels.fill_down(
        loaded_columns, [channel.role for channel in channels_chosen]
    )
    rows, notes = channels.select_complete_rows(loaded_columns)
    values = channels.convert_signals_to_si(rows, channels_chosen)
    row_temperature = values.get("temperature", temperatures_of_segments(file, loaded_columns))
    if row_temperature is not None:
        row_temperature = (
            row_temperature[np.isfinite(loaded_columns.values).all(axis=1)]
            if len(row_temperature) > len(rows)
            else row_temperature
        )
    if not has_several_temperatures(row_temperature):
        row_temperature = None
        if len(loaded_columns.starts) > 1:
            notes = (*notes, check_joined_segments(loaded_columns.values[:, 0], loaded_columns))
    return channels_chosen, values, row_temperature, notes


def _refuse_compliance(file: OpenedFile, item: RoleAssignment) -> None:
    """Refuse a column that is named a compliance, which rises where a modulus falls."""
    if "compliance" in file.table.columns[item.index].name.casefold():
        kind_title, advice, *_ = KINDS_OF_FILE["creep"]
        raise ReadError(
            f"{format_column(file.table.columns, item.index)} is a compliance, of {kind_title}, "
            f"where a relaxation modulus is expected: {advice}"
        )
