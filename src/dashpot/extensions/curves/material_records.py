"""Records of strain and stress: which test they are, their reading, and their sizes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.checks import Check
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.checks import (
    modulus_of_a_rubber,
    strain_not_large,
    strain_not_small,
)
from dashpot.reading.columns.role_assignment import RoleAssignment, assign_role
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.header_metadata import add_specimen_temperature
from dashpot.reading.readers.relaxation import load_signals
from dashpot.reading.readers.size_checks import stress_of_a_rubber
from dashpot.registry import find_handler
from dashpot.signals.segments import (
    classify_load_history,
    find_rising_sign,
    is_held_throughout,
)

MATERIAL: tuple[Role, ...] = ("time", "strain", "stress")
_REST_SHARE, _HOLD_SHARE = 0.02, 0.5
"""Largest motion of a held strain, of its range; shortest hold, of the record."""
_MIN_RELAXATION = 0.02
"""Part of its size by which a stress falls in a hold that shows relaxation."""
_OTHER_MOTIONS = ("cld", "cyclic")
_HELD_REASON = "its strain is held while its stress goes on"


def is_stress_record(file: OpenedFile) -> bool:
    """Return whether the columns of strain and stress are found, or ambiguous."""
    assignments = [assign_role(file.table, role, file.options) for role in MATERIAL[1:]]
    return all(
        isinstance(assignment, RoleAssignment) or assignment.choices for assignment in assignments
    )


def recognise_material_record(
    record: Sequence[FloatArray], rows: Sequence[FloatArray] | None
) -> tuple[str, str] | None:
    """Return the kind of test that strain and stress show, and why; None of an elastic curve.

    Harmonic cycles are loops. A constant stress with a changing strain is creep. A strain that is
    held, once or in several steps, for half of the record is a relaxation.

    Parameters
    ----------
    record : (time, strain, stress)
        Empty where there is no clock, or the file leaves open which column is what.
    rows : (row number, strain, stress), or None
        The same without a clock, which shows a hold and loops. It does not show creep: the plateau
        of a foam looks like it.
    """
    if not (motion := record or rows):
        return None
    if not record and _has_relaxing_holds(motion[0], *(signal[::-1] for signal in motion[1:])):
        return "modulus", _HELD_REASON + ", from the last row to the first"
    time, strain, stress = motion
    is_harmonic = find_handler("record rule", "cyclic")
    if is_harmonic is not None and is_harmonic(*motion):
        return "cyclic", "it goes to and fro, and never rests"
    load_history = classify_load_history(time, strain, stress)
    is_stress_held = is_held_throughout(stress) and load_history not in _OTHER_MOTIONS
    if record and (load_history == "creep" or is_stress_held):
        return "creep", "its stress is held while its strain goes on"
    if load_history != "relaxation":
        return None
    is_at_rest = np.abs(strain - median(strain)) < _REST_SHARE * np.ptp(strain)
    is_held = record and np.mean(is_at_rest) >= _HOLD_SHARE
    return (
        ("modulus", _HELD_REASON) if is_held or _has_relaxing_holds(time, strain, stress) else None
    )


def _has_relaxing_holds(time: FloatArray, strain: FloatArray, stress: FloatArray) -> bool:
    """Return whether holds after moves fill half of the record, and the stress falls in most.

    After an unloading it may rise, so only holds after a loading count.
    """
    _, segments = find_rising_sign(time, strain)
    held_samples, relaxing_count, loaded_count = 0, 0, 0
    for previous, hold in pairwise(segments):
        if hold.kind != "hold" or previous.kind == "hold":
            continue
        part = stress[hold.first : hold.last + 1]
        held_samples += len(part)
        if previous.kind == "load":
            tenth = max(len(part) // 10, 1)
            first, last = abs(float(part[:tenth].mean())), abs(float(part[-tenth:].mean()))
            relaxing_count += first - last > _MIN_RELAXATION * first
            loaded_count += 1
    return held_samples >= _HOLD_SHARE * len(time) and 2 * relaxing_count > loaded_count


def read_strain_and_stress(file: OpenedFile, specimen: Specimen) -> dict[str, Any]:
    """Return time, strain, stress, specimen and source of a record, by their names, in SI units.

    Raises
    ------
    ReadError
        If a column is not found or has no unit, time does not increase, or a unit makes a size that
        no such test has.
    """
    channels_chosen = channels.choose_channels(file, channels.add_time_role(file, *MATERIAL[1:]))
    values, notes = load_signals(file, channels_chosen)
    refuse_material_sizes(file, channels_chosen, values["strain"], values["stress"])
    specimen, sentences = add_specimen_temperature(file, specimen, channels_chosen)
    source = channels.make_source(file, [c.message for c in channels_chosen], [*notes, *sentences])
    signals = {name: values[name] for name in ("time", "strain", "stress")}
    return {**signals, "specimen": specimen, "source": source}


def refuse_creep_sizes(
    file: OpenedFile, channels_chosen: Sequence[Channel], strain: FloatArray, stress: FloatArray
) -> None:
    """As :func:`refuse_material_sizes`, for a strain with an arbitrary zero."""
    refuse_material_sizes(file, channels_chosen, strain, stress, zero_known=False)


def refuse_material_sizes(
    file: OpenedFile,
    channels_chosen: Sequence[Channel],
    strain: FloatArray,
    stress: FloatArray,
    *,
    zero_known: bool = True,
) -> None:
    """Ask again for units that give an implausible strain, stress or modulus of rubber.

    Parameters
    ----------
    file : OpenedFile
    channels_chosen : sequence of Channel
        The last two are those of strain and stress.
    strain, stress : array, shape (n,)
        As a ratio, and Pa.
    zero_known : bool
        Whether the strain counts from the specimen at rest, which that of a creep may not.

    Raises
    ------
    ReadError
    """
    strain_channel, stress_channel = channels_chosen[-2:]
    max_strain, max_stress = (float(np.abs(signal).max(initial=0.0)) for signal in (strain, stress))
    strain_unit = strain_channel.unit.word
    strain_checks: list[Check] = [strain_not_large(max_strain, strain_unit)]
    if zero_known:
        strain_checks.append(strain_not_small(max_strain, strain_unit))
    stress_checks: list[Check] = [stress_of_a_rubber(max_stress, stress_channel.unit.word)]
    if max_strain > 0:
        stress_checks.append(modulus_of_a_rubber(max_stress / max_strain, stress_channel.unit.word))
    channels.refuse_sizes(file, [(strain_channel, strain_checks), (stress_channel, stress_checks)])
