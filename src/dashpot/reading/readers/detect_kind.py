"""Detection of a file's kind, with its table open for the reader."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np

from dashpot.base import dataclass, replace, units
from dashpot.base.arrays import FloatArray, cache_on_record, validate_measured
from dashpot.base.errors import DataError, ReadError
from dashpot.reading.columns.kind_detection import RAMP, RECOGNISED, KindOfFile, kind_of
from dashpot.reading.columns.role_assignment import EXAMPLE, find_weight, handle, score_columns
from dashpot.reading.columns.vocabulary import DIMENSION, Role
from dashpot.reading.raw_file import RawFile, add_name_to_errors, like_json, open_raw
from dashpot.reading.read_options import PROFILE, ReadOptions, flag
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.relaxation import load_signals, moving_columns
from dashpot.registry import find_handler
from dashpot.signals.segments import classify_load_history

_SCHEMA = re.compile(rb'"schema"\s*:\s*"dashpot/([a-z-]+)@')
_HEAD = 1 << 16
"""Bytes in which the schema of a document stands; dashpot writes it first."""
_SHOWN: Mapping[str, str] = MappingProxyType({
    "cld": "it goes in and back at one speed, and never rests",
    "cyclic": "it goes to and fro, and never rests",
    "creep": "its force is held while its displacement goes on",
})  # fmt: skip
_HELD: Mapping[str, str] = MappingProxyType({"relaxation": "relaxation", "creep": "creep"})
"""What a record without a clock shows that nobody can use without one, and its kind."""
_LEAST = 8
"""Samples in which a motion may be seen."""
_MATERIAL: tuple[Role, ...] = ("strain", "stress")
_PART: tuple[Role, ...] = ("displacement", "force")
_FOLDERS = (
    ("project", "dashpot.toml", "it holds dashpot.toml"),
    ("lot", "part-*.parquet", "it holds the rows of a batch"),
)
OWN: Mapping[str, KindOfFile] = MappingProxyType({
    "fit": KindOfFile("a fit", "use dashpot predict, compare or export"),
    "model": KindOfFile("a solid", "use dashpot export"),
    "levels": KindOfFile("a fit over amplitude", "use dashpot export"),
    "hyperelastic": KindOfFile("a fit of a hyperelastic law", "use dashpot export"),
    "study": KindOfFile("a study of one seal", "use dashpot verify"),
    "job": KindOfFile("the inputs of a report", "use dashpot report"),
    "door": KindOfFile("a door", "use dashpot predict"),
    "profile": KindOfFile("a reading profile", "give it as --profile"),
    "machine": KindOfFile("a machine file", "use dashpot fit --machine"),
    "project": KindOfFile("a project", "use dashpot verify"),
    "lot": KindOfFile("a lot", "use dashpot compare with another lot"),
    "folder": KindOfFile("a folder", "use dashpot batch"),
})  # fmt: skip
"""What is no table of a test: what it is called, and which command wants it."""


@dataclass(frozen=True)
class Recognised:
    """Recognised kind of a file.

    Attributes
    ----------
    kind : str
        One of ``io.columns.kinds.FileKind``; of a document of dashpot's own the word of its schema,
        such as ``"fit"``; or ``"door"``, ``"profile"``, ``"project"``, ``"lot"``, ``"folder"``.
    reason : str
        What shows it.
    stored : bool
        Whether it is a result, or a record, that dashpot wrote as JSON.
    simulated : bool
        Whether a table says that it was made by simulation.
    on_a_base : bool
        Whether an acceleration is said to be that of the base: then nothing struck.
    """

    kind: str
    reason: str
    stored: bool = False
    simulated: bool = False
    on_a_base: bool = False

    @property
    def kind_title(self) -> str:
        """What such a file is called."""
        return "a shaken base with its mass" if self.on_a_base else get_kind_label(self.kind)

    @property
    def use(self) -> str:
        """Which command wants it, or why none does; empty where that is not known."""
        return get_kind_command(self.kind)


def get_kind_label(kind: str) -> str:
    """Return what a file of a kind is called, such as "a relaxation test".

    >>> get_kind_label("cyclic"), get_kind_label("fit"), get_kind_label("comparison")
    ('a cyclic run without a hold', 'a fit', 'a stored comparison')
    """
    kinds = RECOGNISED if kind in RECOGNISED else OWN
    if kind in kinds:
        return kinds[kind].what
    test = {
        "unclear": "no test that is known",
        "not-a-test": "no test",
        "aged": "a predicted aging",
        "slammed": "a predicted drop test",
    }
    return test.get(kind, f"a stored {kind.replace('-', ' ')}")


def get_kind_command(kind: str) -> str:
    """Return which command wants a file of a kind, or why none does; empty if that is not known."""
    kinds = RECOGNISED if kind in RECOGNISED else OWN
    return kinds[kind].use if kind in kinds else ""


def recognise(
    path: str | Path, options: ReadOptions | None = None, *, kind: str | None = None
) -> Recognised:
    """Return what a file or a folder is: by its columns and, of a record, by what moves in it.

    The table is left open: who reads the file next with the same options does not parse it again.

    Parameters
    ----------
    path : path
        ``-`` is stdin.
    options : ReadOptions, optional
        What the user said of the file; the columns named decide, and `kind` there overrules.
    kind : str, optional
        The same as ``options.kind``.

    Raises
    ------
    ReadError
        If there is no such file, it cannot be read, or there is no such kind.
    """
    options = options or ReadOptions()
    options = options if kind is None else replace(options, kind=kind)
    bare = open_or_identify(path, options)
    if isinstance(bare, Recognised):
        return bare
    # where the kind is said, only who reads the file next loads its numbers
    file = bare if options.kind else channels.read_once(bare)
    with add_name_to_errors(file.raw.name):
        kind, reason = recognise_opened(file)
        shaken = kind == "impact" and file.options.base_acceleration is not None
        detection = Recognised(kind, reason, simulated=file.table.simulated, on_a_base=shaken)
    channels.cache_open_file(path, file)
    return detection


def as_a_ramp(path: str | Path, options: ReadOptions | None = None) -> str:
    """Return the options that make a relaxation test of a file, as they are typed.

    Each role has the likeliest column that is free, and a unit where the file tells none; of fewer
    than three columns that could be one, and of what is no table, nothing is returned.
    """
    file = open_or_identify(path, options)
    if isinstance(file, Recognised):
        return ""
    free = [
        i for i, column in enumerate(file.table.columns) if column.content in {"number", "clock"}
    ]
    if len(free) < len(RAMP):
        return ""
    columns, names, lacking = file.table.columns, [], []
    for role in RAMP:
        scores = score_columns(file.table, role, file.options)
        able = [i for i in free if not _has_other_dimension(columns[i].unit, DIMENSION[role])]
        if not able:
            return ""
        at = max(able, key=lambda i: (scores.get(i, 0.0), -i))
        free.remove(at)
        names.append(f'{flag(role)}="{handle(columns, at)}"')
        word = file.unit_word(at, role)
        if columns[at].content == "number" and not (
            word and units.find_unit(word, DIMENSION[role])
        ):
            lacking.append(f"{role}={find_weight(word) or EXAMPLE[role]}")
    return " ".join([*names, *([f'--units "{",".join(lacking)}"'] if lacking else [])])


def _has_other_dimension(word: str | None, dimension: units.Dimension) -> bool:
    """Return whether a unit is known, and of no such quantity."""
    measured = units.dimensions(word or "")
    weighs = dimension == "force" and bool(find_weight(word))
    return bool(measured) and dimension not in measured and not weighs


@cache_on_record
def recognise_opened(file: OpenedFile) -> tuple[str, str]:
    """Return the kind of a table that is open, and why."""
    kind, reason = kind_of(file.table, file.options)
    if file.options.kind is not None:
        return kind, reason
    if kind == "relaxation":
        record = _record(file, _PART)
        shown = classify_load_history(*record) if record else ""
        return (shown, _SHOWN[shown]) if shown in _SHOWN else (kind, reason)
    if kind == "cld":
        rows = _load_signals_by_row(file, _PART)
        shown = classify_load_history(*rows) if rows else ""
        if shown in _HELD:
            return _HELD[shown], "its displacement or force is held; it has no clock"
    if kind == "stress-strain":
        recognise_material = find_handler("record rule", kind)
        motions = _record(file, _MATERIAL), _load_signals_by_row(file, _MATERIAL)
        return (recognise_material and recognise_material(*motions)) or (kind, reason)
    return kind, reason


def _load_signals_by_row(
    file: OpenedFile, pair: tuple[Role, ...]
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """What moves and pushes over their rows; None of a file that leaves open which they are."""
    try:
        chosen = channels.choose(file, pair)
        values, _ = channels.select_complete_rows(channels.load_test(file, chosen, _LEAST))
    except ReadError:
        return None
    signals = channels.convert_signals_to_si(values, chosen)
    displacement, force = (signals[role] for role in pair)
    return np.arange(len(displacement), dtype=float), displacement, force


def _record(file: OpenedFile, pair: tuple[Role, ...]) -> tuple[FloatArray, ...]:
    """Return time and signals; nothing of a record that asks or is broken: its reader says so."""
    try:
        chosen, clocks = moving_columns(file, *pair)
        values, _ = load_signals(file, chosen, clocks)
        return tuple(
            validate_measured(role, values[role], minimum=_LEAST) for role in ("time", *pair)
        )
    except (ReadError, DataError):
        return ()


def open_or_identify(path: str | Path, options: ReadOptions | None) -> OpenedFile | Recognised:
    """Return the open table of a file, or what it is if there is none.

    That is what dashpot itself, or a user for it, wrote, or a folder.

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
        return _folder(Path(path))
    raw = open_raw(path)
    detection = _document(raw) if like_json(raw.head(64)) else _toml(path)
    return channels.open_table(raw, options) if detection is None else detection


def _toml(path: str | Path) -> Recognised | None:
    """Return what a file that is called TOML states; None of one that is not."""
    if Path(path).suffix.casefold() != ".toml":
        return None
    from dashpot.reading.toml import tables_of

    _, tables = tables_of(path)
    if "door" in tables:
        return Recognised("door", "it has the table [door]")
    if "machine" in tables:
        return Recognised("machine", "it has the table [machine]")
    if tables.keys() <= PROFILE:
        return Recognised("profile", "it is TOML with tables of a profile")
    return Recognised("unclear", "it is TOML, of neither a door nor a profile")


def _document(raw: RawFile) -> Recognised | None:
    """Return the word of a document's schema; None of JSON that is not dashpot's own."""
    match = _SCHEMA.search(raw.head(_HEAD))
    if match is None:
        return None
    word = match[1].decode()
    return Recognised(word, f"its schema is dashpot/{word}", stored=True)


def _folder(path: Path) -> Recognised:
    for kind, mark, reason in _FOLDERS:
        if next(path.glob(mark), None) is not None:
            return Recognised(kind, reason)
    return Recognised("folder", "it is a folder")
