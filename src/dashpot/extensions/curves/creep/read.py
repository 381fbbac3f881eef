"""Reader of creep tests and creep compliances."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.provenance import Source
from dashpot.base.units import si_unit
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.creep import CreepCompliance, CreepTest
from dashpot.extensions.curves.material_records import refuse_creep_sizes
from dashpot.extensions.curves.modulus.read import read_over_time
from dashpot.reading.columns.file_kinds import FileKind
from dashpot.reading.columns.role_assignment import assign_role, score_columns
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels, size_checks
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.cleaning import assign_time_since_step
from dashpot.reading.readers.header_metadata import add_specimen_temperature
from dashpot.reading.readers.relaxation import load_signals

_CURVE: tuple[Role, ...] = ("time", "creep_compliance")
_MATERIAL: tuple[Role, ...] = ("time", "strain", "stress")
_PART_ROLES: tuple[Role, ...] = ("time", "displacement", "force")
# a name that says it and a unit that fits; a gap under an axial force is no such pair
_CERTAIN_SCORE = 3.0
_LIKELY_SCORE = 2.5
_NAMED_SCORE = 1.5


def read_creep(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> CreepTest | CreepCompliance:
    """Return the creep test in a file, or the curve that a rheometer made of one, in SI units.

    A column of compliance makes it a
    :class:`~dashpot.extensions.curves.datamodel.creep.CreepCompliance`, J(t) since the step; else
    displacement and force, or strain and stress, make it a
    :class:`~dashpot.extensions.curves.datamodel.creep.CreepTest`.

    Raises
    ------
    ReadError
        If the file cannot be read, holds several steps of which none is chosen, or leaves open
        which column is what or in which unit.
    """
    with channels.open_file(path, options) as file:
        return read_creep_in(file, specimen or Specimen())


def roles(file: OpenedFile) -> tuple[Role, ...]:
    """The columns that a creep test is read from: a compliance, stress and strain, or a part's."""
    for roles_wanted in (_CURVE, _MATERIAL, _PART_ROLES):
        if any(getattr(file.options, role) for role in roles_wanted[1:]):
            return roles_wanted
    for roles_wanted, min_score in (
        (_CURVE, _LIKELY_SCORE),
        (_PART_ROLES, _CERTAIN_SCORE),
        (_MATERIAL, _LIKELY_SCORE),
    ):
        if all(_is_likely_column(file, role, min_score) for role in roles_wanted[1:]):
            return roles_wanted
    return _PART_ROLES


def read_creep_in(file: OpenedFile, specimen: Specimen) -> CreepTest | CreepCompliance:
    """Return the creep test in an opened file."""
    channels.refuse_summary(file)
    role_names = roles(file)
    signal_names = ["displacement", "force", "stress", "strain", "creep_compliance"]
    likely_kinds: list[FileKind] = ["creep", "relaxation", "cld"]
    if role_names is _MATERIAL and (
        file.options.rate or _is_likely_column(file, "time", _NAMED_SCORE)
    ):
        likely_kinds.append("stress-strain")  # what moves in it decides
    channels.refuse_other_kinds(file, likely_kinds, "a creep test is", stated_columns=signal_names)
    if role_names is _CURVE:
        return _read_curve(file, *add_specimen_temperature(file, specimen))
    channels_chosen = channels.choose_channels(file, channels.add_time_role(file, *role_names[1:]))
    specimen, sentences = add_specimen_temperature(file, specimen, channels_chosen)

    def source(notes: list[str]) -> Source:
        return channels.make_source(
            file, [channel.message for channel in channels_chosen], [*notes, *sentences]
        )

    values, notes = load_signals(file, channels_chosen)
    time, displacement, load = (values[role] for role in role_names)
    if role_names is _PART_ROLES:
        notes += _refuse_sizes(file, channels_chosen, values)
    else:
        refuse_creep_sizes(file, channels_chosen, displacement, load)
    unit = "Pa" if role_names is _MATERIAL else "N/m"
    return CreepTest(time, displacement, load, unit, specimen, source(notes), units="SI")


def _refuse_sizes(
    file: OpenedFile, channels_chosen: Sequence[Channel], values: Mapping[Role, FloatArray]
) -> list[str]:
    """Ask for the units again that make a size no test of a seal has; notes on unusual ones."""
    options: dict[str, tuple[str, Callable[[float, str], Check]]] = {
        "displacement": ("travel", size_checks.travel_of_a_seal),
        "force": ("force", size_checks.force_of_a_seal),
        "time": ("record", size_checks.time_of_a_test),
    }
    answers: list[tuple[Channel, list[Check]]] = []
    for channel in channels_chosen:
        span, unit = float(np.ptp(values[channel.role])), channel.unit.word
        kind, unusual = options[channel.role]
        is_possible = size_checks.size_possible(kind, span, unit, role=channel.role)
        answers.append((channel, [is_possible, unusual(span, unit)]))
    return channels.refuse_sizes(file, answers)


def _read_curve(file: OpenedFile, specimen: Specimen, sentences: list[str]) -> CreepCompliance:
    """A compliance over time, where a column of temperature says several, at each of them."""
    curve = assign_role(file.table, "creep_compliance", file.options)
    columns = channels.require_answers(
        file, [assign_time_since_step(file.table, file.options), curve]
    )
    channels_chosen, values, temperature, notes = read_over_time(file, columns)
    return CreepCompliance(
        values["time"],
        values["creep_compliance"],
        si_unit(channels_chosen[1].unit.dimension).word,
        specimen,
        channels.make_source(
            file,
            [channel.message for channel in channels_chosen],
            [*file.table.notes, *notes, *sentences],
        ),
        temperature,
        units="SI",
    )


def _is_likely_column(file: OpenedFile, role: Role, min_score: float) -> bool:
    return max(score_columns(file.table, role, file.options).values(), default=0.0) >= min_score
