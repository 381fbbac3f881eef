"""Readers of amplitude sweeps, storage and loss against amplitude, and of recorded loops."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep, LoopRecord, StressStrainLoops
from dashpot.reading.columns.kind_detection import (
    SINGLE_FREQUENCY_DECADES,
    assign_amplitude_column,
    group_values,
)
from dashpot.reading.columns.role_assignment import RoleAssignment, assign_role, list_columns
from dashpot.reading.columns.vocabulary import Role, has_word, normalise_name
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.header_metadata import add_specimen_temperature
from dashpot.reading.readers.inspect import list_unit_questions
from dashpot.reading.readers.relaxation import relaxation_in
from dashpot.reading.readers.sweep_columns import (
    SWEEP_OPTIONS,
    load_parts,
    sweep_columns,
)
from dashpot.reading.table import Question
from dashpot.registry import require_handler

# ASTM D5992 calls the double strain amplitude DSA
_SPAN = re.compile(
    r"(?<!\w)(?:(p|pk|peak|spitze|pico|picco|crête)(?: to | a | à | zu | |-|2|t)?\1|dsa"
    r"|(?:double|doppelte) (?:strain |displacement )?amplitude|doppelamplitude|schwingbreite)(?!\w)"
    r"|峰峰|[双両全]振幅"
)
_AMPLITUDES: tuple[Role, ...] = ("strain", "displacement")
_RMS = ("rms", "effektiv", "effektivwert", "eff")


def find_amplitude_column(file: OpenedFile) -> RoleAssignment:
    """Return the column of the amplitude of a sweep: of strain, else of displacement.

    Raises
    ------
    ReadError
        If there is none, or several could be it.
    """
    amplitude_options = assign_amplitude_column(file.table, file.options)
    for role in _AMPLITUDES:
        assignment = assign_role(file.table, role, amplitude_options)
        if isinstance(assignment, RoleAssignment):
            return assignment
        if assignment.choices:
            raise ReadError(assignment.message)
    raise ReadError(
        "no column of strain or displacement amplitude was found; name it with "
        "--column strain=NAME or displacement=NAME; the columns are "
        f"{list_columns(file.table.columns)}"
    )


def propose_amplitude(file: OpenedFile, roles: object) -> list[Question]:
    """Return the question of the amplitude, which an amplitude sweep alone has."""
    del roles
    return list_unit_questions(lambda: find_amplitude_column(file), "strain")


def get_amplitude_factor(name: str) -> tuple[float, str]:
    """Return the factor from numbers of that name to the amplitude of a cycle, and the words.

    >>> get_amplitude_factor("Strain p-p"), get_amplitude_factor("Double Strain Amplitude")[0]
    ((2.0, 'peak to peak'), 2.0)
    >>> get_amplitude_factor("Strain rms")[1], get_amplitude_factor("Strain amplitude")
    ('an rms', (1.0, ''))
    """
    if _SPAN.search(normalise_name(name)):
        return 2.0, "peak to peak"
    return (2**-0.5, "an rms") if has_word(name, _RMS) else (1.0, "")


_PART: tuple[Role, ...] = ("time", "displacement", "force")
_MATERIAL: tuple[Role, ...] = ("time", "strain", "stress")


def list_loop_roles(file: OpenedFile) -> tuple[Role, ...]:
    """Return the columns that loops are read from: of a part, or of a material without them."""

    def holds(roles: tuple[Role, ...]) -> bool:
        assignments = (assign_role(file.table, role, file.options) for role in roles[1:])
        return all(isinstance(assignment, RoleAssignment) for assignment in assignments)

    return _MATERIAL if holds(_MATERIAL) and not holds(_PART) else _PART


def read_loops(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> LoopRecord:
    """Return the hysteresis loops in a file, in SI units.

    Displacement and force belong to a part, strain and stress to a material.

    Raises
    ------
    ReadError
        If a column is not found or has no unit, or time does not increase.
    """
    with channels.open_file(path, options) as file:
        specimen = specimen or Specimen()
        if list_loop_roles(file) is _PART:
            return relaxation_in(file, specimen)
        signals = require_handler("read signals", "stress-strain")(file, specimen)
        return StressStrainLoops(**signals, units="SI")


_MAX_SELF_HEATING = 10.0
"""K that a rubber does not warm by itself from one visit of an amplitude to the next."""
_UNIT_OF_ROLE: dict[Role, str] = {"strain": "strain", "displacement": "m"}


def read_amplitude(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> AmplitudeSweep:
    """Return the amplitude sweep in a file, in SI units: strain as a ratio, displacement in m.

    Storage and loss (or storage and loss factor) against a column of strain or displacement
    amplitude (a column that says peak to peak, double amplitude or rms is turned into it, with a
    note), at one frequency or a few, in any order; frequencies that differ by less than an
    instrument's accuracy are equal. Rows that lack a number are omitted with a note.

    Raises
    ------
    ReadError
        If a column is not found or has no unit, the amplitude never changes, or the same amplitudes
        were met at several temperatures.
    """
    with channels.open_file(path, options) as file:
        channels.refuse_other_kinds(
            file,
            ["strain-sweep", "single-frequency"],
            "an amplitude sweep is",
            stated_columns=SWEEP_OPTIONS,
        )
        roles, ratio = sweep_columns(file)
        column = find_amplitude_column(file)
        channels_chosen = channels.add_units(file, [*roles, column])
        _, values, unit, notes = load_parts(file, channels_chosen, ratio)
        column_name = file.table.columns[column.index]
        factor, word = get_amplitude_factor(f"{column_name.name} {column_name.unit or ''}")
        amplitude = values[column.role] / factor
        if word:
            notes.append(f"'{column_name.name}' is {word}: over {factor:.3g} it is the amplitude")
        if not np.ptp(amplitude) > 0:
            raise ReadError(f"'{column_name.name}' never changes: it is no amplitude sweep")
        frequency = _find_tones(values["frequency"])
        _require_single_temperature(frequency, amplitude, values.get("temperature"))
        specimen, sentences = add_specimen_temperature(file, specimen or Specimen())
        return AmplitudeSweep(
            frequency,
            amplitude,
            values["storage"],
            values["loss"],
            unit,
            _UNIT_OF_ROLE[column.role],
            specimen,
            channels.make_source(file, [c.message for c in channels_chosen], (*notes, *sentences)),
            units="SI",
        )


def _find_tones(frequency: FloatArray) -> FloatArray:
    """Return the frequencies, each the median of a group with the same nominal one."""
    if not np.all(frequency > 0):
        return frequency
    tone = group_values(np.log10(frequency), SINGLE_FREQUENCY_DECADES)
    return np.array([np.median(frequency[tone == index]) for index in range(tone.max() + 1)])[tone]


def _require_single_temperature(
    frequency: FloatArray, amplitude: FloatArray, kelvin: FloatArray | None
) -> None:
    """Refuse amplitudes that were swept again at another temperature; warming with them is none."""
    if kelvin is None:
        return
    order = np.lexsort((amplitude, frequency))
    f, X, T = frequency[order], amplitude[order], kelvin[order]
    is_repeat = (f[1:] == f[:-1]) & (X[1:] <= 1.02 * X[:-1])
    if np.count_nonzero(np.abs(np.diff(T)[is_repeat]) > _MAX_SELF_HEATING) > 2:
        low, high = (convert_to_unit(float(value), "degC") for value in (T.min(), T.max()))
        raise ReadError(
            f"the same amplitudes at temperatures from {low:.3g} to {high:.3g} degC; expected one "
            "temperature: write each to a file of its own"
        )
