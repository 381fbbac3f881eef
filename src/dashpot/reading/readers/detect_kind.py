"""Detection of a file's kind, with its table open for the reader."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np

from dashpot.base import replace, units
from dashpot.base.arrays import FloatArray, cache_on_record, validate_measured
from dashpot.base.errors import DataError, ReadError
from dashpot.reading.columns.file_kinds import (
    RAMP_ROLES,
    RecognisedKind,
    identify_json,
)
from dashpot.reading.columns.kind_detection import detect_table_kind
from dashpot.reading.columns.role_assignment import (
    EXAMPLE,
    find_weight,
    quote_column,
    score_columns,
)
from dashpot.reading.columns.vocabulary import DIMENSION, Role
from dashpot.reading.raw_file import add_name_to_errors, looks_like_json, open_raw
from dashpot.reading.read_options import PROFILE, ReadOptions, flag
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.relaxation import load_signals, moving_columns
from dashpot.registry import call_handler, find_handler
from dashpot.signals.segments import classify_load_history

_FOLDER_KINDS = (
    ("project", "dashpot.toml", "it holds dashpot.toml"),
    ("lot", "part-*.parquet", "it holds the rows of a batch"),
)
_MOTION_REASONS: Mapping[str, str] = MappingProxyType({
    "cld": "it goes in and back at one speed, and never rests",
    "cyclic": "it goes to and fro, and never rests",
    "harmonic": "it goes to and fro, and never rests",
    "creep": "its force is held while its displacement goes on",
})  # fmt: skip
_REASONS_WITHOUT_CLOCK: Mapping[str, str] = MappingProxyType({
    "relaxation": "its displacement is held; it has no clock",
    "harmonic": "it goes to and fro; it has no clock",
    "creep": "its force is held; it has no clock",
})  # fmt: skip
"""Reasons why a kind needs a clock, by the loading that a record without one shows."""
_MIN_SAMPLES = 8
"""Fewest samples that show a motion."""
_MATERIAL_ROLES: tuple[Role, ...] = ("strain", "stress")
_PART_ROLES: tuple[Role, ...] = ("displacement", "force")


def recognise(
    path: str | Path, options: ReadOptions | None = None, *, kind: str | None = None
) -> RecognisedKind:
    """Return the kind of a file or a folder: by its columns and, of a record, by its motion.

    The open table is cached: reading the file next with the same options does not parse it again.

    Parameters
    ----------
    path : path
        ``-`` is stdin.
    options : ReadOptions, optional
        Named columns decide, and a stated `kind` overrules them.
    kind : str, optional
        The same as ``options.kind``.

    Raises
    ------
    ReadError
        If there is no such file, it cannot be read, or there is no such kind.
    """
    options = options or ReadOptions()
    options = options if kind is None else replace(options, kind=kind)
    opened_file = open_or_identify(path, options)
    if isinstance(opened_file, RecognisedKind):
        return opened_file
    # where the kind is said, only who reads the file next loads its numbers
    file = opened_file if options.kind else channels.read_once(opened_file)
    with add_name_to_errors(file.raw.name):
        kind, reason = recognise_opened(file)
        is_base_excited = kind == "impact" and file.options.base_acceleration is not None
        detection = RecognisedKind(
            kind, reason, simulated=file.table.simulated, on_a_base=is_base_excited
        )
    channels.cache_open_file(path, file)
    return detection


def describe_unknown_test(path: str | Path, reason: str, options: ReadOptions) -> str:
    """Return why a file is no known test, and the options that name its columns."""
    column_options = suggest_relaxation_options(path, options)
    hint = (
        f"If it is a test of a seal, name its columns: {column_options}."
        if column_options
        else "A test of a seal has time, displacement and force."
    )
    return f"{path} is no test that dashpot knows: {reason}. {hint}"


def suggest_relaxation_options(path: str | Path, options: ReadOptions | None = None) -> str:
    """Return the command-line options that read a file as a relaxation test.

    Each role gets its likeliest free column, and a unit where the file states none. The text is
    empty for fewer than three possible columns, and without a table.
    """
    file = open_or_identify(path, options)
    if isinstance(file, RecognisedKind):
        return ""
    free = [
        i for i, column in enumerate(file.table.columns) if column.content in {"number", "clock"}
    ]
    if len(free) < len(RAMP_ROLES):
        return ""
    columns, names, missing_units = file.table.columns, [], []
    for role in RAMP_ROLES:
        scores = score_columns(file.table, role, file.options)
        candidates = [i for i in free if not _has_other_dimension(columns[i].unit, DIMENSION[role])]
        if not candidates:
            return ""
        index = max(candidates, key=lambda i: (scores.get(i, 0.0), -i))
        free.remove(index)
        names.append(f'{flag(role)}="{quote_column(columns, index)}"')
        unit = file.unit_word(index, role)
        if columns[index].content == "number" and not (
            unit and units.find_unit(unit, DIMENSION[role])
        ):
            missing_units.append(f"{role}={find_weight(unit) or EXAMPLE[role]}")
    return " ".join([*names, *([f'--units "{",".join(missing_units)}"'] if missing_units else [])])


def _has_other_dimension(word: str | None, dimension: units.Dimension) -> bool:
    """Return whether a unit is known and not of this dimension."""
    dimensions = units.dimensions(word or "")
    is_mass_unit = dimension == "force" and bool(find_weight(word))
    return bool(dimensions) and dimension not in dimensions and not is_mass_unit


@cache_on_record
def recognise_opened(file: OpenedFile) -> tuple[str, str]:
    """Return the kind of a table that is open, and why."""
    kind, reason = detect_table_kind(file.table, file.options)
    if file.options.kind is not None:
        return kind, reason
    if kind in {"relaxation", "cld"}:
        load = _load_motion if kind == "relaxation" else _load_signals_by_row
        record = load(file, _PART_ROLES)
        loading: str = classify_load_history(*record) if record else ""
        if record and loading != "cld" and _has_motion_at_end(record[1]):
            # turns of cycles of few samples, or of small ones beside large ones, look held
            is_harmonic = find_handler("record rule", "cyclic")
            loading = "harmonic" if is_harmonic and is_harmonic(*record) else loading
        reasons = _MOTION_REASONS if kind == "relaxation" else _REASONS_WITHOUT_CLOCK
        if loading in reasons:
            return loading.replace("harmonic", "cyclic"), reasons[loading]
    if kind == "stress-strain":
        recognise_material = find_handler("record rule", kind)
        motions = _load_motion(file, _MATERIAL_ROLES), _load_signals_by_row(file, _MATERIAL_ROLES)
        return (recognise_material and recognise_material(*motions)) or (kind, reason)
    return kind, reason


def _has_motion_at_end(displacement: FloatArray) -> bool:
    last_tenth = displacement[-len(displacement) // 10 :]
    return bool(np.ptp(last_tenth) > 0.05 * np.ptp(displacement))


def _load_signals_by_row(
    file: OpenedFile, pair: tuple[Role, ...]
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return row number and the two signals; None where the columns are ambiguous."""
    try:
        channels_chosen = channels.choose_channels(file, pair)
        values, _ = channels.select_complete_rows(
            channels.load_test(file, channels_chosen, _MIN_SAMPLES)
        )
    except ReadError:
        return None
    signals = channels.convert_signals_to_si(values, channels_chosen)
    displacement, force = (signals[role] for role in pair)
    return np.arange(len(displacement), dtype=float), displacement, force


def _load_motion(file: OpenedFile, pair: tuple[Role, ...]) -> tuple[FloatArray, ...]:
    """Return time and signals; None if the record is ambiguous or invalid."""
    try:
        channels_chosen, clocks = moving_columns(file, *pair)
        values, _ = load_signals(file, channels_chosen, clocks)
        return tuple(
            validate_measured(role, values[role], minimum=_MIN_SAMPLES) for role in ("time", *pair)
        )
    except (ReadError, DataError):
        return ()


def open_or_identify(path: str | Path, options: ReadOptions | None) -> OpenedFile | RecognisedKind:
    """Return the open table of a file; of a document, a TOML file or a folder its kind.

    Raises
    ------
    ReadError
        If there is no such file, it cannot be read, or it is no TOML although it is called so.
    """
    options = (options or ReadOptions()).for_file(path)
    file = channels.pop_cached_file(path, options)
    if file is not None:
        return file
    if Path(path).is_dir():
        return _identify_folder(Path(path))
    raw = open_raw(path)
    detection = identify_json(raw) if looks_like_json(raw.head(64)) else _identify_toml(path)
    return channels.open_table(raw, options) if detection is None else detection


def _identify_toml(path: str | Path) -> RecognisedKind | None:
    """Return the kind of a file named .toml; None of any other."""
    if Path(path).suffix.casefold() != ".toml":
        return None
    from dashpot.reading.toml import read_tables

    _, tables = read_tables(path)
    if "door" in tables:
        return RecognisedKind("door", "it has the table [door]")
    if "machine" in tables:
        return RecognisedKind("machine", "it has the table [machine]")
    if tables.keys() <= PROFILE:
        return RecognisedKind("profile", "it is TOML with tables of a profile")
    is_limits = call_handler("recognise limits", "file", tables, default=None)
    return is_limits or RecognisedKind("unclear", "it is TOML of no door, machine or limits")


def _identify_folder(path: Path) -> RecognisedKind:
    for kind, file_mark, reason in _FOLDER_KINDS:
        if next(path.glob(file_mark), None) is not None:
            return RecognisedKind(kind, reason)
    return RecognisedKind("folder", "it is a folder")
