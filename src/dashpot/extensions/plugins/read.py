"""Reader of a file's columns in SI units, with the roles that are recognised."""

from __future__ import annotations

from pathlib import Path

from dashpot.base import units
from dashpot.base.errors import ReadError
from dashpot.extensions.plugins.datamodel import PluggedColumn, PluggedTest
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE
from dashpot.reading.columns.role_assignment import assign_role
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.table import Question


def read_plugged(path: str | Path, *, options: ReadOptions | None = None) -> PluggedTest:
    """Return the columns of a file for the plug-in that ``options.kind`` names; ``-`` is stdin.

    Raises
    ------
    ReadError
        If the file cannot be read, or holds no column of numbers.
    """
    with channels.open_file(path, options) as opened_file:
        all_columns = opened_file.table.columns
        numeric = [
            i for i, column in enumerate(all_columns) if column.content in {"number", "clock"}
        ]
        if not numeric:
            raise ReadError("no column of numbers is in it; expected at least one")
        roles = _find_role_columns(opened_file)
        loaded_columns = channels.load(opened_file.table, numeric, opened_file.options.segment)
        columns = []
        for position, index in enumerate(numeric):
            role, name = roles.get(index), all_columns[index].name.strip().casefold()
            text = opened_file.options.get_units_by_name().get(name, all_columns[index].unit)
            word = opened_file.unit_word(index, role) if role else text
            unit = units.find_unit(word) if word else None
            values = loaded_columns.values[:, position].copy()
            columns.append(
                PluggedColumn(
                    all_columns[index].label(index + 1),
                    role or "",
                    "" if unit is None else units.si_unit(unit.dimension).word,
                    values if unit is None else channels.scale_to_si(values, unit),
                )
            )
        notes = [*opened_file.table.notes, *loaded_columns.notes]
        sentences = [
            f"{column.role or '-'}: {column.name} [{column.unit or '?'}]" for column in columns
        ]
        return PluggedTest(
            opened_file.options.kind or "",
            tuple(columns),
            channels.make_source(opened_file, sentences, notes),
        )


def _find_role_columns(file: OpenedFile) -> dict[int, Role]:
    """Return the columns that surely play a role, by index; the likelier role comes first."""
    entries: dict[int, Role] = {}
    for role in KINDS_OF_FILE["plug-in"].roles:
        answer = assign_role(file.table, role, file.options)
        if not isinstance(answer, Question):
            entries.setdefault(answer.index, role)
    return entries
