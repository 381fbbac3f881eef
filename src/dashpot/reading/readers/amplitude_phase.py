"""From two amplitudes with two phases, as a shaker's controller writes them, to their ratio."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.amplitude_phase_pairs import AmplitudePhaseColumns, two_signals
from dashpot.reading.columns.role_assignment import find_column, format_column, handle
from dashpot.reading.read_options import flag
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.table import Column, LoadedColumns

_SEVERAL = 8
"""Lines that show how far a phase goes."""
_TURN, _TURNS = 2 * np.pi, 60.0
"""How far a phase goes in radians, once around; and unwrapped, over ten modes."""


def as_a_ratio(file: OpenedFile) -> OpenedFile:
    """Return a file of two signals, each by amplitude and phase, as one of the response they make.

    That is a motion over a force, or the motion of a mass over that of its base. Any other file is
    returned as it is.

    Raises
    ------
    ReadError
        If it is not said which of two motions is the base, or a phase has no unit.
    """
    pair = two_signals(file.table, file.options)
    if pair is None:
        return file
    over, under = _sort_signal_pair(file, pair)
    columns = file.table.columns
    lines = file.find_unambiguous_column("frequency")
    if lines is None:
        return file
    radian = [file.unit(phase_columns.phase, "phase").factor for phase_columns in (over, under)]
    unit = f"({columns[over.size].unit})/({columns[under.size].unit})"
    name = f"{columns[over.size].name} over {columns[under.size].name}"
    wanted = [lines.index, over.size, over.phase, under.size, under.phase]

    def load(indexes: Sequence[int]) -> LoadedColumns:
        loaded = file.table.load(wanted)
        frequency, size, phase, size_under, phase_under = loaded.values.T
        angles = (over.phase, phase, radian[0]), (under.phase, phase_under, radian[1])
        for index, angle, factor in angles:
            refuse_angle(file, index, angle, factor)
        turned = radian[0] * phase - radian[1] * phase_under
        share = np.divide(size, size_under, out=np.full(len(size), np.nan), where=size_under > 0)
        matrix = np.column_stack([frequency, share * np.cos(turned), share * np.sin(turned)])
        return replace(loaded, values=matrix[:, list(indexes)])

    table = replace(
        file.table,
        columns=(
            columns[lines.index],
            Column(f"real part of {name}", unit),
            Column(f"imaginary part of {name}", unit),
        ),
        load=load,
    )
    named = replace(file.options, frequency="1", real="2", imaginary="3", coherence=None)
    return replace(file, table=table, options=named)


def _sort_signal_pair(
    file: OpenedFile, pair: tuple[AmplitudePhaseColumns, AmplitudePhaseColumns]
) -> tuple[AmplitudePhaseColumns, AmplitudePhaseColumns]:
    """The signal above and the one below: a force, or the motion of the base."""
    first, second = pair
    if first.pushes or second.pushes:
        return (second, first) if first.pushes else (first, second)
    columns, named = file.table.columns, file.options.base_acceleration
    if named is not None:
        index = find_column(columns, named, flag("base_acceleration"))
        below = [phase_columns.size == index for phase_columns in pair]
    else:
        below = [
            vocabulary.has_word(columns[phase_columns.size].name, vocabulary.OF_BASE)
            for phase_columns in pair
        ]
    if sum(below) == 1:
        return (second, first) if below[0] else (first, second)
    raise ReadError(
        f"{format_column(columns, first.size)} and {format_column(columns, second.size)} are two "
        "motions; say "
        f"which of them is the base, for example {flag('base_acceleration')}="
        f'"{handle(columns, first.size)}"'
    )


def refuse_angle(file: OpenedFile, index: int, phase: FloatArray, radian: float) -> None:
    """Ask for the unit of a phase that goes over one turn of the other unit, unless it was said."""
    stated = file.options.unit_of("phase", file.table.columns[index].name)
    reach = float(np.nanmax(np.abs(phase), initial=0.0))
    if stated or len(phase) < _SEVERAL or reach == 0:
        return
    in_degrees = radian != 1.0
    if reach <= _TURN if in_degrees else reach > _TURNS:
        word, other = ("deg", "rad") if in_degrees else ("rad", "deg")
        raise ReadError(
            f"the phase goes to {reach:.3g}, in {word} as the file has it: is the unit {other}? "
            f'Then add --units "phase={other}"; if it is meant so, say it: --units "phase={word}"'
        )
