"""Reader of FRFs, also from amplitude and phase of two signals."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.base.units import format_quantity
from dashpot.datamodel.frf import FRF, Kind
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.header_units import Ratio, bare_ratio, parse_response_unit, undecibel
from dashpot.reading.columns.kind_detection import (
    AmplitudePhaseColumns,
    find_amplitude_phase_pairs,
    is_motion_ratio,
    is_relative_transmissibility,
)
from dashpot.reading.columns.role_assignment import (
    RoleAssignment,
    assign_role,
    find_column,
    format_column,
    list_columns,
    quote_column,
)
from dashpot.reading.columns.vocabulary import Role, has_word
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.header_metadata import refuse_unknown_window_rate, window_rate
from dashpot.reading.table import Column, FileTable, LoadedColumns

# FRF as the ratio of two signals by amplitude and phase.


_MIN_PHASE_LINES = 8
"""Smallest number of lines that shows the range of a phase."""
_FULL_TURN, _MAX_UNWRAPPED = 2 * np.pi, 60.0
"""Range of a phase in radians, wrapped and unwrapped over ten modes."""


def make_ratio_file(file: OpenedFile) -> OpenedFile:
    """Return a file of two signals, each by amplitude and phase, as one of the response they make.

    That is a motion over a force, or the motion of a mass over that of its base. Any other file is
    returned as it is.

    Raises
    ------
    ReadError
        If the base among two motions is unknown, or a phase has no unit.
    """
    pair = find_amplitude_phase_pairs(file.table, file.options)
    if pair is None:
        return file
    numerator, denominator = _sort_signal_pair(file, pair)
    columns = file.table.columns
    lines = file.find_unambiguous_column("frequency")
    if lines is None:
        return file
    radian = [
        file.unit(phase_columns.phase, "phase").factor for phase_columns in (numerator, denominator)
    ]
    unit = f"({columns[numerator.amplitude].unit})/({columns[denominator.amplitude].unit})"
    name = f"{columns[numerator.amplitude].name} over {columns[denominator.amplitude].name}"
    column_indices = [
        lines.index,
        numerator.amplitude,
        numerator.phase,
        denominator.amplitude,
        denominator.phase,
    ]

    def load(indexes: Sequence[int]) -> LoadedColumns:
        loaded_columns = file.table.load(column_indices)
        frequency, size, phase, size_under, phase_under = loaded_columns.values.T
        angles = (numerator.phase, phase, radian[0]), (denominator.phase, phase_under, radian[1])
        for index, angle, factor in angles:
            refuse_angle(file, index, angle, factor)
        phase_difference = radian[0] * phase - radian[1] * phase_under
        share = np.divide(size, size_under, out=np.full(len(size), np.nan), where=size_under > 0)
        matrix = np.column_stack(
            [frequency, share * np.cos(phase_difference), share * np.sin(phase_difference)]
        )
        return replace(loaded_columns, values=matrix[:, list(indexes)])

    table = replace(
        file.table,
        columns=(
            columns[lines.index],
            Column(f"real part of {name}", unit),
            Column(f"imaginary part of {name}", unit),
        ),
        load=load,
    )
    ratio_options = replace(file.options, frequency="1", real="2", imaginary="3", coherence=None)
    return replace(file, table=table, options=ratio_options)


def _sort_signal_pair(
    file: OpenedFile, pair: tuple[AmplitudePhaseColumns, AmplitudePhaseColumns]
) -> tuple[AmplitudePhaseColumns, AmplitudePhaseColumns]:
    """Return the signal above and the one below: a force, or the motion of the base."""
    first, second = pair
    if first.is_force or second.is_force:
        return (second, first) if first.is_force else (first, second)
    columns, named_column = file.table.columns, file.options.base_acceleration
    if named_column is not None:
        index = find_column(columns, named_column, flag("base_acceleration"))
        is_base = [phase_columns.amplitude == index for phase_columns in pair]
    else:
        is_base = [
            vocabulary.has_word(columns[phase_columns.amplitude].name, vocabulary.OF_BASE)
            for phase_columns in pair
        ]
    if sum(is_base) == 1:
        return (second, first) if is_base[0] else (first, second)
    raise ReadError(
        f"{format_column(columns, first.amplitude)} and {format_column(columns, second.amplitude)} "
        f"are two motions; say which of them is the base, for example {flag('base_acceleration')}="
        f'"{quote_column(columns, first.amplitude)}"'
    )


def refuse_angle(file: OpenedFile, index: int, phase: FloatArray, radian: float) -> None:
    """Ask for the unit of a phase that exceeds one turn of the other unit, unless it is stated."""
    stated_unit = file.options.unit_of("phase", file.table.columns[index].name)
    max_phase = float(np.nanmax(np.abs(phase), initial=0.0))
    if stated_unit or len(phase) < _MIN_PHASE_LINES or max_phase == 0:
        return
    in_degrees = radian != 1.0
    if max_phase <= _FULL_TURN if in_degrees else max_phase > _MAX_UNWRAPPED:
        word, other = ("deg", "rad") if in_degrees else ("rad", "deg")
        raise ReadError(
            f"the phase goes to {max_phase:.3g}, in {word} as the file has it: is the unit "
            f"{other}? "
            f'Then add --units "phase={other}"; if it is meant so, say it: --units "phase={word}"'
        )


# FRF of a file.


PAIRS: tuple[tuple[Role, Role], ...] = (("real", "imaginary"), ("magnitude", "phase"))
"""The parts of a complex value."""
_MAX_FREQUENCY = 3e4
"""Hz; no hammer on rubber goes higher."""
_MAX_COHERENCE = 1.01
_STATED = compile_on_use(r"\A\W*+kind\s*+:\s*+(\w+)")


def read_frf(path: str | Path, *, options: ReadOptions | None = None) -> FRF:
    """Return the FRF in a UFF file, or in a text file as `write_frf` writes it.

    A text file of another origin needs frequency with real and imaginary part, or with
    magnitude and phase, and a unit such as ``(m/s^2)/N`` that shows the kind.

    Raises
    ------
    ReadError
        If there is no FRF in the file, or its kind or unit is left open.
    """
    with channels.open_file(path, options) as file:
        channels.refuse_other_kinds(
            file, ["frf", "transmissibility"], "an FRF is", stated_columns=["real", "magnitude"]
        )
        converted_file = make_ratio_file(file)
        return build_frf(converted_file, determine_frf_columns(converted_file))


def build_frf(file: OpenedFile, columns: FRFColumns) -> FRF:
    """Return the FRF of the chosen columns.

    Raises
    ------
    ReadError
        If its numbers cannot be those of an FRF.
    """
    index, (kind, factor, order), hertz, radian = columns
    loaded_columns = channels.load(file.table, range(len(file.table.columns)), None)
    column = {role: loaded_columns.values[:, i] for role, i in index.items()}
    value: ComplexArray = np.asarray(
        column["real"] + 1j * column["imaginary"]
        if "real" in index
        else _polar(file, index, column, radian)
    )
    if not value.any():
        raise ReadError("the FRF is 0 at every line; export its values, or name their columns")
    _refuse_high(file, index["frequency"], hertz * float(column["frequency"].max()))
    sd, notes = _deviation(file.table)
    notes += _lags(file.table, index)
    metadata = _comments(file.table.header)
    shift, remarks = _get_window_decay(file, metadata, hertz * column["frequency"])
    notes += remarks
    notes += [line for line in file.table.header if "sha256" in line]
    scale = _compute_derivative_factor(factor, order, hertz * column["frequency"], shift)
    names = [c.name for c in file.table.columns]
    return FRF(
        column["frequency"] * hertz, scale * value, kind,
        coherence=None
        if "coherence" not in column
        else _normalise_coherence(file, index["coherence"], column["coherence"]),
        sd=None if sd is None else loaded_columns.values[:, sd] * np.abs(scale),
        shift=shift, shift_sd=metadata.get("shift sd", 0.0), record=metadata.get("record"),
        averages=int(metadata.get("averages", 0)),
        source=(
            channels.make_source(file, names, (*file.table.notes, *notes, *loaded_columns.notes)),
        ),
        units="SI",
    )  # fmt: skip


def _get_window_decay(
    file: OpenedFile, metadata: Mapping[str, float], frequency: FloatArray
) -> tuple[float, list[str]]:
    """Return the decay of the exponential window that the values carry, 1/s, and notes.

    Raises
    ------
    ReadError
        If the file states a window, and neither it nor the user says how fast it decays.
    """
    if file.options.window_decay is None and "shift" in metadata:
        return metadata["shift"], []
    steps = np.diff(frequency)
    step = float(np.median(steps)) if steps.size else 0.0
    record = metadata.get("record") or (1 / step if step > 0 else None)
    decay, windowed, notes = window_rate(file.table.header, file.options, record)
    if windowed and decay is None:
        refuse_unknown_window_rate(notes[0])
    return decay or 0.0, list(notes)


def _lags(table: FileTable, index: Mapping[Role, int]) -> list[str]:
    """Return a note on a phase that is named as a lag, of opposite sign."""
    name = table.columns[index["phase"]].name if "phase" in index else ""
    if not has_word(name, ("lag", "nacheilung", "retard")):
        return []
    return [f"'{name}' is read as a phase: it must be negative where the response is late"]


def _deviation(table: FileTable) -> tuple[int | None, list[str]]:
    """The column of standard deviations, if there is one; of several none is taken, with a note."""
    indices = [i for i, c in enumerate(table.columns) if c.name.casefold() == "sd"]
    if len(indices) < 2:
        return next(iter(indices), None), []
    columns_text = " and ".join(str(i + 1) for i in indices)
    return None, [f"columns {columns_text} are called sd; none is taken"]


class FRFColumns(NamedTuple):
    """Columns of an FRF, its kind, and the factors of its units to SI."""

    columns: dict[Role, int]
    ratio: Ratio
    hertz: float
    radian: float


def determine_frf_columns(file: OpenedFile) -> FRFColumns:
    """Return the columns, units and kind of an FRF, which its values need.

    Raises
    ------
    ReadError
        If a column, its unit or the kind of the FRF is left open.
    """
    index = _columns(file)
    main: Role = "real" if "real" in index else "magnitude"
    requested, factors = [], {"phase": 1.0}
    ratio = None
    try:
        ratio = _determine_kind(file, main, index[main])
    except ReadError as error:
        requested.append(str(error))
    requested += _unlike_parts(file, index)
    roles: tuple[Role, ...] = ("frequency", "phase")
    for role in roles if main == "magnitude" else roles[:1]:
        try:
            factors[role] = file.unit(index[role], role).factor
        except ReadError as error:
            requested.append(str(error))
    if ratio is None or requested:
        raise ReadError("; ".join(requested))
    return FRFColumns(index, ratio, factors["frequency"], factors["phase"])


def _columns(file: OpenedFile) -> dict[Role, int]:
    """The columns of frequency and of one complex value, Cartesian or else polar, and coherence."""
    index: dict[Role, int] = {}
    options: dict[Role, str] = {}
    for role in ("frequency", *chain(*PAIRS), "coherence"):
        assignment = assign_role(file.table, role, file.options)
        if isinstance(assignment, RoleAssignment):
            index[role] = assignment.index
        elif assignment.choices:
            options[role] = assignment.message
    for pair in PAIRS:
        if {"frequency", *pair} <= index.keys() and "coherence" not in options:
            return {r: i for r, i in index.items() if r in {"frequency", "coherence", *pair}}
    raise ReadError("; ".join(options.values()) or _describe_missing_columns(file, index))


def _describe_missing_columns(file: OpenedFile, index: Mapping[Role, int]) -> str:
    """Return the message for columns that make no FRF."""
    columns_text = list_columns(file.table.columns)
    parts = {"magnitude", "phase"} & index.keys()
    if "frequency" in index and len(parts) == 1:
        part, other = ("magnitude", "phase") if "magnitude" in parts else ("phase", "magnitude")
        return (
            f"there is a {part} and no {other}: an FRF is both, and only both show stiffness "
            f"and damping; export the {other} too, or name its column with {flag(other)}=NAME; the "
            f"columns are {columns_text}"
        )
    return (
        "no frequency response found; expected columns such as 'frequency [Hz], "
        "real [(m/s^2)/N], imaginary [(m/s^2)/N]' (or magnitude and phase); the columns are "
        f"{columns_text}"
    )


def _comments(header: tuple[str, ...]) -> dict[str, float]:
    """Numbers such as ``# shift [1/s]: 0.5`` by their name."""
    entries = {}
    for line in header:
        match = re.match(
            r"\A\W*+(shift sd|shift|record|averages)\s*+(?:\[[^\]]*+\])?\s*+:"
            r"\s*+([-+.\deE]++)\s*+\Z",
            line,
        )
        if match:
            try:
                entries[match[1]] = float(match[2])
            except ValueError:
                continue
    return entries


def _determine_kind(file: OpenedFile, role: Role, index: int) -> Ratio:
    """Return the kind of the FRF from the unit, compared with a ``kind:`` comment."""
    column, word = file.table.columns[index], file.unit_word(index, role) or ""
    new_ratio = parse_response_unit(word)
    if new_ratio is None and is_motion_ratio(file.table):
        new_ratio = bare_ratio(word)
    if new_ratio is None:
        unit = f"the unit '{word}', which" if word else "no unit, and so"
        raise ReadError(
            f"'{column.name}' has {unit} makes no FRF; "
            "expected motion per force such as (m/s^2)/N, g/N, m/N, force per motion such as N/m, "
            "or motion per motion such as g/g or mm/g (of a mass over a base that moves); add "
            f'--units "{role}=(m/s^2)/N" or --units "{role}=g/g", or write it into the header'
        )
    stated_kind = _get_stated_kind(file.table, over_base=new_ratio.kind.over_base)
    if stated_kind is None or stated_kind is new_ratio.kind:
        return new_ratio
    if stated_kind.over_base and new_ratio.kind.over_base:
        return new_ratio._replace(kind=stated_kind)
    raise ReadError(
        f"the comment says {stated_kind.value}, but the unit '{column.unit}' is that of "
        f"{new_ratio.kind.value}; correct one of them"
    )


def _get_stated_kind(table: FileTable, *, over_base: bool) -> Kind | None:
    """Return the kind in a comment; a column name may add that a motion is relative."""
    words = [match[1] for line in table.header if (match := _STATED.match(line))]
    kind = next((Kind(word) for word in words if word in set(Kind)), None)
    relative = kind is None and over_base and is_relative_transmissibility(table)
    return Kind.RELATIVE_TRANSMISSIBILITY if relative else kind


def _compute_derivative_factor(
    factor: float, order: int, frequency: FloatArray, shift: float
) -> float | ComplexArray:
    """Return the factor, with a power of s, that makes both motions the same derivative."""
    if order == 0:
        return factor
    s = 2j * np.pi * frequency + shift
    if order < 0 and not s.all():
        raise ReadError(
            "the line at 0 Hz is of no use in a motion over one of a lower derivative; leave it "
            "out of the file"
        )
    return np.asarray(factor * s**order)


def _unlike_parts(file: OpenedFile, index: dict[Role, int]) -> list[str]:
    """Return a note if real and imaginary part have different units."""
    if "real" not in index:
        return []
    real, imaginary = (file.table.columns[index[role]] for role in ("real", "imaginary"))
    if file.options.unit_of("real", real.name) or not (real.unit and imaginary.unit):
        return []
    if parse_response_unit(real.unit) == parse_response_unit(imaginary.unit):
        return []
    message = f"the real part is in '{real.unit}', the imaginary part in '{imaginary.unit}'"
    advice = f'correct the header, or say it: --units "real={real.unit}"'
    return [f"{message}; expected one unit: {advice}"]


def _refuse_high(file: OpenedFile, index: int, highest_frequency: float) -> None:
    """Ask for the unit of a frequency, Hz, at which no seal is struck, unless it was said."""
    if highest_frequency > _MAX_FREQUENCY and not file.options.unit_of(
        "frequency", file.table.columns[index].name
    ):
        raise ReadError(
            f"the FRF goes to {format_quantity(highest_frequency, 'kHz')}, where no seal is "
            "struck: is the unit of "
            'frequency Hz? Then add --units "frequency=Hz"; if it is meant so, say it: '
            '--units "frequency=kHz"'
        )


def _normalise_coherence(file: OpenedFile, index: int, coherence: FloatArray) -> FloatArray:
    """Return a coherence from 0 to 1, whether it was written so or in per cent."""
    if file.unit_word(index, "coherence") == "%":
        return coherence / 100
    highest = float(np.nanmax(coherence, initial=0.0))
    if highest > _MAX_COHERENCE:
        raise ReadError(
            f"the coherence reaches {highest:.4g}; expected 0 to 1: if it is in per cent, add "
            '--units "coherence=%"'
        )
    return coherence


def _polar(
    file: OpenedFile, index: dict[Role, int], column: dict[Role, FloatArray], radian: float
) -> ComplexArray:
    magnitude, named_column = column["magnitude"], file.table.columns[index["magnitude"]]
    words = (named_column.unit, file.options.unit_of("magnitude", named_column.name))
    if any(undecibel(word) for word in words if word):
        magnitude = 10 ** (magnitude / 20)  # dB re 1 of the unit given by --units
    elif np.nanmin(magnitude, initial=0.0) < 0:
        raise ReadError(
            "the magnitude falls below 0, as decibels do: if they are, add what they are of, "
            '--units "magnitude=dB re (m/s^2)/N" or --units "magnitude=dB re g/g", or write it '
            "into the header"
        )
    refuse_angle(file, index["phase"], column["phase"], radian)
    return np.asarray(magnitude * np.exp(1j * column["phase"] * radian))
