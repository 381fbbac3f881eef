"""Readers of sweeps of complex stiffness at stated compressions and amplitudes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, Final, NamedTuple, get_args

import numpy as np

from dashpot.base import units
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray, IndexArray
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Source
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.frf import FRF, Kind
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.preload_map.preload_sweep import PreloadSweep, PreloadTable
from dashpot.extensions.preload_map.stiffness_lines import (
    MIN_FREQUENCIES,
    SAME_AMPLITUDE,
    SAME_COMPRESSION,
    SAME_TONE,
    group_levels,
)
from dashpot.extensions.preload_map.table_rule import (
    MOVING,
    SETTINGS,
    STATIC,
    find_length_column,
    get_length_word,
)
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.file_kinds import SWEEP_KINDS, get_kind_label
from dashpot.reading.columns.role_assignment import RoleAssignment, list_columns
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.inspect import list_unit_questions
from dashpot.reading.readers.sweep_columns import SWEEP_OPTIONS, load_parts, sweep_columns
from dashpot.reading.table import Question
from dashpot.registry import list_names, require_handler
from dashpot.signals.segments import Loading

KIND: Final = "preload-map"
_LOOPS = set(get_args(Loading)) & set(list_names("read record"))
"""Kinds of records of time, displacement and force that another extension reads as loops."""
_HEAVIEST = 5.0
"""Weight of a line at the resonance, at most: there other errors than noise are left."""
_MIN_LOOPS = 5
"""Loops of one setting of which the first and the last are left out."""
_MOTIONS = (Kind.RECEPTANCE, Kind.MOBILITY, Kind.ACCELERANCE)


def read_preload_table(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> PreloadTable:
    """Return the sweeps of a table of compression, amplitude, frequency, storage and loss.

    The amplitude may be missing; a column that says peak to peak, double amplitude or rms is
    turned into it, with a note. A frequency that one setting has twice begins a repeated sweep.

    Raises
    ------
    ReadError
        If a column is not found or has no unit, or the part is a material in Pa.
    """
    del specimen
    with channels.open_file(path, options) as file:
        table = _read_table(file)
        if table.compression is None:
            raise ReadError(
                "no column of static compression was found; call it 'compression [mm]'. The "
                f"columns are {list_columns(file.table.columns)}"
            )
        return PreloadTable(tuple(_split(table, table.compression)), table.source)


def propose_settings(
    file: channels.OpenedFile, roles: dict[int, tuple[str, str]]
) -> list[Question]:
    """Add compression, amplitude and loss factor to the proposed roles; return what they ask."""

    def propose() -> None:
        static = find_length_column(file.table, STATIC, file.options, excluded_words=MOVING)
        moving = find_length_column(file.table, MOVING, file.options)
        for index, name in ((static, STATIC[0]), (moving, MOVING[0])):
            if index is not None:
                roles[index] = name, "its name says so, its unit is a length"
        columns, ratio = sweep_columns(file)
        for column in columns:
            roles[column.index] = column.role, column.reason
        if ratio is not None:
            roles[ratio] = "loss factor", "its name says loss factor"

    return list_unit_questions(propose, STATIC[0])


class _StiffnessTable(NamedTuple):
    """Columns of a table, in SI; those that it lacks are None."""

    frequency: FloatArray
    value: ComplexArray
    compression: FloatArray | None
    amplitude: FloatArray | None
    source: Source
    weight: FloatArray | None = None


def _read_table(file: channels.OpenedFile, stated_settings: Sequence[str] = ()) -> _StiffnessTable:
    roles_wanted, ratio = sweep_columns(file)
    _require_units(file, roles_wanted)
    channels_chosen = channels.add_units(file, roles_wanted)
    loaded_columns, values, unit, notes = load_parts(file, channels_chosen, ratio)
    if unit != "N/m":
        raise ReadError(
            f"storage and loss are in {unit}, of a material; expected a stiffness, such as N/mm: "
            "multiply by area over height"
        )
    is_complete: BoolArray = np.asarray(np.isfinite(loaded_columns.values).all(axis=1))
    static = _load_length(file, is_complete, STATIC, excluded_words=MOVING)
    moving = _load_length(file, is_complete, MOVING)
    settings = [setting for setting in (static, moving) if setting is not None]
    used_columns = [role.index for role in roles_wanted] + [setting.column for setting in settings]
    if ratio is not None:
        used_columns.append(ratio)
    compression = None if static is None else static.values
    amplitude = None if moving is None else moving.values
    _refuse_lost_settings(
        file,
        is_complete,
        used_columns,
        {"compression": compression, "amplitude": amplitude},
        stated_settings,
    )
    if moving is not None:
        column = file.table.columns[moving.column]
        text = f"{column.name} {column.unit or ''}"
        factor, word = require_handler("over amplitude", "column")(text)
        amplitude = moving.values / factor
        if word:
            notes.append(f"'{column.name}' is {word}: over {factor:.3g} it is the amplitude")
    if compression is not None and compression.min() < 0 and compression.max() <= 0:
        compression = -compression
        notes.append("compression is negative throughout; its sign was turned")
    return _StiffnessTable(
        values["frequency"],
        values["storage"] + 1j * values["loss"],
        compression,
        amplitude,
        channels.make_source(
            file,
            [
                *(channel.message for channel in channels_chosen),
                *(setting.message for setting in settings),
            ],
            notes,
        ),
    )


class _LengthColumn(NamedTuple):
    """Column of a length: its number in the table, its values, m, and a note."""

    column: int
    values: FloatArray
    message: str


def _load_length(
    file: channels.OpenedFile,
    is_complete: BoolArray,
    words: Sequence[str],
    *,
    excluded_words: Sequence[str] = (),
) -> _LengthColumn | None:
    """Return the rows of the one column of a length of such a name; None if there is none."""
    index = find_length_column(file.table, words, file.options, excluded_words=excluded_words)
    if index is None:
        return None
    column = file.table.columns[index]
    unit = units.parse_unit(get_length_word(column, words, file.options) or "", "length")
    numbers = channels.load(file.table, [index], file.options.segment).values[is_complete, 0]
    if not np.isfinite(numbers).all():
        raise ReadError(f"'{column.name}' has no number in some rows of the sweeps")
    message = f"{words[0]}: {column.name} [{unit.word}]"
    return _LengthColumn(index, np.asarray(channels.scale_to_si(numbers, unit)), message)


def _require_units(file: channels.OpenedFile, roles_wanted: Sequence[RoleAssignment]) -> None:
    if any(file.unit_word(column.index, column.role) is None for column in roles_wanted):
        raise ReadError(
            "some columns have no unit. Write units into the header, as 'storage [N/mm]', or add "
            '--units "compression=mm,amplitude=mm,frequency=Hz,storage=N/mm,loss=N/mm" with yours'
        )


def _refuse_lost_settings(
    file: channels.OpenedFile,
    is_complete: BoolArray,
    used_columns: Sequence[int],
    settings: Mapping[str, FloatArray | None],
    stated_settings: Sequence[str],
) -> None:
    """Raise where columns of several levels would be lost.

    Those of a setting that is stated, and those that name one and are no length.
    """
    for name in stated_settings:
        levels = settings[name]
        if levels is not None and _has_several_levels(levels):
            raise ReadError(
                f"a column of the file has {name} values that differ: leave out --{name} for it"
            )
    missing_settings = [
        name
        for name, setting in settings.items()
        if setting is None and name not in stated_settings
    ]
    for index, column in enumerate(file.table.columns):
        is_setting = not set(SETTINGS).isdisjoint(vocabulary.tokens(column.name))
        if (
            not missing_settings
            or index in used_columns
            or not is_setting
            or column.content != "number"
        ):
            continue
        values = channels.load(file.table, [index], file.options.segment).values[is_complete, 0]
        if np.isfinite(values).all() and _has_several_levels(values):
            names = " or ".join(missing_settings)
            raise ReadError(
                f"{column.label(index + 1)} has several values, and is not taken for the {names}. "
                f"Convert it to a length and call it '{missing_settings[0]} [mm]', or give its "
                "unit "
                f'(--units "{missing_settings[0]}=mm"), or leave the column out'
            )


def _split(table: _StiffnessTable, compression: FloatArray) -> Iterator[PreloadSweep]:
    """Yield the sweeps of a table: one for each setting, and for each time that it was swept."""
    amplitudes = table.amplitude
    settings = group_levels(compression, SAME_COMPRESSION)[1]
    if amplitudes is not None:
        settings = settings * (len(amplitudes) + 1) + group_levels(amplitudes, SAME_AMPLITUDE)[1]
    for setting in dict.fromkeys(settings.tolist()):
        for indices in _split_sweeps(np.flatnonzero(settings == setting), table.frequency):
            yield PreloadSweep(
                table.frequency[indices],
                table.value[indices],
                float(compression[indices].mean()),
                None if amplitudes is None else float(amplitudes[indices].mean()),
                None if table.weight is None else table.weight[indices],
                table.source,
            )


def _split_sweeps(rows: IndexArray, frequency: FloatArray) -> list[IndexArray]:
    """Return the sweeps of one setting: where the frequency turns back, another begins.

    Frequencies in no order are one sweep.
    """
    steps = np.sign(np.diff(frequency[rows]))
    turns, direction = [0], 0.0
    for i, step in enumerate(steps.tolist(), 1):
        if step and direction and step != direction:
            turns.append(i)
            step = 0.0  # noqa: PLW2901 -- a jump back says nothing of the way that follows
        direction = step or (direction if turns[-1] != i else 0.0)
    parts = [rows[first:last] for first, last in zip(turns, [*turns[1:], len(rows)], strict=True)]
    return parts if min(map(len, parts)) >= MIN_FREQUENCIES else [rows]


def _has_several_levels(values: FloatArray) -> bool:
    return bool(group_levels(np.abs(values), SAME_AMPLITUDE)[1].max())


# -- files of any kind -----------------------------------------------------------------------------


def read_sweeps(
    files: Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    compressions: Sequence[tuple[str, float]] = (),
    amplitudes: Sequence[tuple[str, float]] = (),
    mass: float | None = None,
    seals: float = 1.0,
) -> tuple[PreloadSweep, ...]:
    """Return the sweeps of files: tables of storage and loss, FRFs, recorded loops.

    Parameters
    ----------
    files : sequence of path
    options : ReadOptions, optional
    compressions, amplitudes : sequence of (str, float)
        Pattern of a file's name, empty for all, and its stated value, m.
    mass, seals : float, optional
        kg and number: FRFs of motion over force are of this mass on `seals` parts, and its inertia
        is subtracted.

    Raises
    ------
    ReadError
        If a file cannot be read, is of no suitable kind, states no compression, or a pattern
        suits none.
    """
    names = [Path(path).name for path in files]
    for flag, stated_values in (("--compression", compressions), ("--amplitude", amplitudes)):
        for pattern, value in stated_values:
            if pattern and not any(fnmatch(name, pattern) for name in names):
                raise ReadError(
                    f"{flag} {pattern}:{convert_to_unit(value, 'mm'):g}mm suits none of the files: "
                    f"{', '.join(names)}. Write the name of a file"
                )
    sweeps: list[PreloadSweep] = []
    for path, name in zip(files, names, strict=True):
        stated_c, stated_x = _find_stated(name, compressions), _find_stated(name, amplitudes)
        stated_by_name = {"compression": stated_c, "amplitude": stated_x}
        roles = [role for role, value in stated_by_name.items() if value is not None]
        table = _load_file(path, options, roles, mass=mass, seals=seals)
        with add_name_to_errors(name):
            compression = table.compression
            if stated_c is not None:
                compression = np.full(len(table.frequency), stated_c)
            if compression is None:
                raise ReadError(
                    "the file says no compression. State it: --compression "
                    f"{name}:4mm, or write a column 'compression [mm]'"
                )
            if stated_x is not None:
                table = table._replace(amplitude=np.full(len(table.frequency), stated_x))
            sweeps += _split(table, compression)
    return tuple(sweeps)


def _find_stated(name: str, patterns_and_values: Sequence[tuple[str, float]]) -> float | None:
    """Return the last value whose pattern suits a file."""
    matching_values = [
        value for pattern, value in patterns_and_values if not pattern or fnmatch(name, pattern)
    ]
    return matching_values[-1] if matching_values else None


def _load_file(
    path: str | Path,
    options: ReadOptions | None,
    stated_settings: Sequence[str],
    *,
    mass: float | None,
    seals: float,
) -> _StiffnessTable:
    """Return the lines of a file of any suitable kind.

    Raises
    ------
    ReadError
        If it is none.
    """
    recognised_file = recognise(path, None if options is None else options.for_file(path))
    if recognised_file.kind in {KIND, *SWEEP_KINDS}:
        with channels.open_file(path, options) as file:
            channels.refuse_other_kinds(
                file, [KIND, *SWEEP_KINDS], "a sweep is", stated_columns=SWEEP_OPTIONS
            )
            return _read_table(file, stated_settings)
    if recognised_file.kind == "frf":
        with add_name_to_errors(Path(path).name):
            return _convert_frf(read_frf(path, options=options), mass, seals)
    if recognised_file.kind in _LOOPS:
        read_keywords: dict[str, Any] = {} if options is None else {"options": options}
        loops = require_handler("read record", recognised_file.kind)(path, read_keywords, {})
        if loops.unit != "N/m" or loops.amplitude_unit != "m":
            raise ReadError(f"{Path(path).name}: expected loops of force and displacement")
        is_settled = _find_settled_loops(loops.frequency, loops.amplitude)
        return _StiffnessTable(
            loops.frequency[is_settled],
            loops.value[is_settled],
            None,
            loops.amplitude[is_settled],
            loops.source,
        )
    raise ReadError(
        f"{Path(path).name} is {get_kind_label(recognised_file.kind)}. A map is of storage and "
        "loss stiffness over frequency, of FRFs, or of recorded loops"
    )


def _find_settled_loops(frequency: FloatArray, amplitude: FloatArray) -> BoolArray:
    """Return which loops are settled: the first and the last of each setting are not.

    They hold some of the change to the next setting, up to 0.3 % of the stiffness at 50 samples a
    loop. A setting of fewer than five loops keeps all.
    """
    tones = group_levels(frequency, SAME_TONE)[1]
    setting = tones * (len(amplitude) + 1) + group_levels(amplitude, SAME_AMPLITUDE)[1]
    starts = np.flatnonzero(np.diff(setting, prepend=setting[0] - 1))
    lengths = np.diff(starts, append=len(setting))
    is_long = lengths >= _MIN_LOOPS
    is_settled = np.ones(len(setting), dtype=bool)
    is_settled[starts[is_long]] = False
    is_settled[(starts + lengths - 1)[is_long]] = False
    return is_settled


def _convert_frf(frf: FRF, mass: float | None, seals: float) -> _StiffnessTable:
    """Return the stiffness of one part of an FRF, with the inertia of a mass taken off."""
    lines = frf.only(frf.usable)
    if lines.quantity.over_base:
        raise ReadError(
            "a transmissibility relates two motions; expected a force over a motion, or its inverse"
        )
    is_motion = lines.quantity in _MOTIONS
    if is_motion and mass is None:
        raise ReadError(
            "a motion over a force is of a mass on the part, and shows its inertia, too. State the "
            "mass: --mass 104g --seals 2"
        )
    source = frf.source[0] if frf.source else Source("FRF", "", "frf")
    receptance = lines.to(Kind.RECEPTANCE)
    direct = 1 / receptance.value
    if not is_motion or mass is None:
        return _StiffnessTable(lines.frequency, np.asarray(direct), None, None, source)
    value = direct + mass * lines.omega**2
    # a line errs by a part of the FRF: near the resonance that is the least part of the stiffness
    weight = np.minimum(np.abs(value) / np.abs(direct), _HEAVIEST)
    return _StiffnessTable(lines.frequency, np.asarray(value / seals), None, None, source, weight)
