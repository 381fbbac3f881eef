"""Specimens that share one file: in blocks, under a column of labels, or in parallel columns.

Each is a segment, which ``--file-part segment=N`` chooses. Which one is meant is a question.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import FloatArray, IndexArray, slices
from dashpot.base.errors import ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE
from dashpot.reading.columns.header_units import split_unit
from dashpot.reading.columns.kind_detection import detect_table_kind
from dashpot.reading.columns.role_assignment import (
    RoleAssignment,
    assign_role,
    format_column,
    join_words,
)
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable, LoadedColumns, Question
from dashpot.reading.text import cells

_PAIRS: tuple[tuple[Role, Role], ...] = (("displacement", "force"), ("strain", "stress"))
_WORDS = (
    r"(?:test ?)?(?:specimen|sample|pi[e]ce)|seal|gasket|probe|probek[öo]rper|pr[üu]fk[öo]rper"
    r"|pr[üu]fling|pr[üu]fteil|muster|dichtung|[ée]prouvette|[ée]chantillon|joint|provino|campione"
    r"|probeta|muestra|pr[óo]bka|vzorek|monster|proefstuk|prov|试样|样品|試験片"
)
_NAME = compile_on_use(
    rf"(?:{_WORDS})[ _.\-]*(?:id|no\.?|nr\.?|n°|#|number|nummer|name|label|code|bezeichnung)?",
    re.IGNORECASE,
)
"""The name of a column with the specimen of each row."""
_LETTER = compile_on_use(r"(?:([A-W])[ _\-](\w.*)|(.*\w)[ _\-]([A-W]))")
"""A signal whose specimen is a letter before or behind it; X, Y and Z are axes."""
_LINE = compile_on_use(rf"\W*(?:{_WORDS})\b.{{0,80}}", re.IGNORECASE)
"""A line above a block that names its specimen."""
_MAX_SPECIMENS = 256
"""Specimens of one file, at most; a column of more labels counts rows."""
_MIN_ROWS = 8
"""Rows of a specimen, at least."""
_RESTART_SHARE = 0.02
"""Part of the first record within which the clock of the next begins."""
_STORAGE_SCORE = 2.5
"""Lowest score of a name for a storage modulus."""
_SHARED_ROWS_SHARE = 0.1
"""Part of the rows in which two channels hold the same numbers, from which on it is noted."""
_DELIMITERS = {"tab": "\t", "semicolon": ";", "comma": ",", "blanks": " ", "pipe": "|"}
LABELS = "labels of "
"""Start of a header line that names the numbers of a column, 1, 2, ..."""


def adapt_table(table: FileTable, raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table with its specimens as segments, and complex viscosities as moduli."""
    if any("visc" in name or "visk" in name or "eta" in name or "η" in name or "度" in name
           for name in (column.name.casefold() for column in table.columns)):  # fmt: skip
        from dashpot.extensions.formats.complex_viscosity import convert_viscosities

        table = convert_viscosities(table, options)
    _refuse_storage_alone(table, options)
    if any(column.content == "number" and not column.unit for column in table.columns):
        from dashpot.extensions.formats.validity_columns import note_invalid_rows

        table = note_invalid_rows(table)
    return separate_specimens(table, raw, options)


def _refuse_storage_alone(table: FileTable, options: ReadOptions) -> None:
    """Refuse a sweep of storage without loss.

    Raises
    ------
    ReadError
    """
    scores = [vocabulary.matches(column.name).get("storage", 0.0) for column in table.columns]
    if (
        max(scores, default=0.0) < _STORAGE_SCORE
        or detect_table_kind(table, ReadOptions(kind=options.kind))[0] != "unclear"
    ):
        return
    loss_roles: tuple[Role, ...] = ("loss", "loss_factor", "loss_angle", "phase")
    if any(getattr(options, role, None) for role in loss_roles):
        return
    frequency, storage = (assign_role(table, role, options) for role in ("frequency", "storage"))
    if isinstance(frequency, RoleAssignment) and isinstance(storage, RoleAssignment):
        raise ReadError(
            f"holds a storage modulus alone, {format_column(table.columns, storage.index)} over "
            "frequency: the loss is not known, and a model needs it. Export loss modulus, loss "
            "factor or loss angle beside it, or name its column: --column loss=NAME"
        )


def separate_specimens(table: FileTable, raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table with each specimen of the file as a segment, and a question if several.

    A column that is named for the specimen parts the rows by its labels. Columns of equal names
    but for a number or a group part the columns. A clock that begins anew parts the rows where it
    does, unless the rows are evenly sampled at a rate that is given.
    """
    if isinstance(table.load, _SpecimenLoader):
        return table
    kind, _ = detect_table_kind(table, ReadOptions(kind=options.kind))
    if kind in KINDS_OF_FILE and KINDS_OF_FILE[kind].by_hand:  # its reader distinguishes specimens
        return table
    labels = _read_labels(table, raw)
    if labels is not None:
        return _part_by_labels(table, *labels, options)
    sets = _find_column_sets(table, options)
    if sets:
        return _part_by_columns(table, sets, options)
    return replace(table, load=_SpecimenLoader(table, options))


def format_labels(labels: Sequence[str]) -> tuple[list[int], str]:
    """Return the number of each label, from 1, and how a header lists them.

    >>> format_labels(["A", "B", "A"])
    ([1, 2, 1], '1 = A; 2 = B')
    """
    numbers = {label: i for i, label in enumerate(dict.fromkeys(labels), start=1)}
    labels_text = "; ".join(f"{i} = {label}" for label, i in list(numbers.items())[:_MAX_SPECIMENS])
    return [numbers[label] for label in labels], labels_text


def names_specimen(name: str) -> bool:
    """Return whether a column of this name holds the specimen of each row.

    >>> names_specimen("Specimen No."), names_specimen("Prüfkörper"), names_specimen("Sample rate")
    (True, True, False)
    """
    return _NAME.fullmatch(name.strip()) is not None


@dataclass(frozen=True, eq=False)
class _SpecimenLoader:
    """Loader of the columns of a table, with a segment for each specimen.

    Attributes
    ----------
    order : array or None
        Row indices by specimen; None does not change the rows.
    """

    table: FileTable
    options: ReadOptions
    order: IndexArray | None = None
    starts: tuple[int, ...] = (0,)
    names: tuple[str, ...] = ("",)
    cache: dict[str, tuple[int, ...]] = field(default_factory=dict)

    def __call__(self, indexes: Sequence[int]) -> LoadedColumns:
        """Return the columns, with a question if the rows belong to several specimens."""
        if self.order is not None:
            loaded_columns = self.table.load(indexes)
            lines = tuple(
                (new, loaded_columns.line(int(old)))
                for new, old in _list_runs(self.order, loaded_columns.lines)
            ) if loaded_columns.lines else ()  # fmt: skip
            return replace(
                loaded_columns, values=loaded_columns.values[self.order], starts=self.starts,
                segments=self.names,
                lines=lines, above=(),
            )  # fmt: skip
        if self.options.rate or not indexes:
            return self.table.load(indexes)
        column_indices, roles = tuple(indexes), self._find_roles()
        selected = self.options.segment is not None
        if not roles or not (selected or set(roles) <= set(column_indices)):
            return self.table.load(indexes)
        other_forces = [] if selected or self.table.large else self._find_other_forces(roles)
        added_indices = [
            i for i in dict.fromkeys([*roles, *other_forces]) if i not in column_indices
        ]
        loaded_columns = self.table.load([*column_indices, *added_indices])
        loaded_columns = self._note_shared_rows(
            loaded_columns, [*column_indices, *added_indices], roles[-1], other_forces
        )
        signals = loaded_columns.values[
            :, [[*column_indices, *added_indices].index(i) for i in roles]
        ]
        loaded_columns = (
            replace(loaded_columns, values=loaded_columns.values[:, : len(column_indices)])
            if added_indices
            else loaded_columns
        )
        return self._part_by_clock(loaded_columns, signals)

    def _find_roles(self) -> tuple[int, ...]:
        """Return the columns of clock and signals of a test; none if they are missing."""
        if "roles" not in self.cache:
            self.cache["roles"] = ()
            for pair in _PAIRS:
                try:
                    answers = [
                        assign_role(self.table, role, self.options) for role in ("time", *pair)
                    ]
                except ReadError:  # a column of another file is named
                    break
                indexes = [a.index for a in answers if isinstance(a, RoleAssignment)]
                if len(indexes) == len(set(indexes)) == 3:
                    self.cache["roles"] = tuple(indexes)
                    break
        return self.cache["roles"]

    def _find_other_forces(self, roles: Sequence[int]) -> list[int]:
        """Return the columns that may be the force or stress of the test as well."""
        columns, force_column = self.table.columns, roles[-1]
        role = next(pair[1] for pair in _PAIRS if self._has_pair(pair, roles))
        return [
            i
            for i, column in enumerate(columns)
            if i != force_column
            and column.content == "number"
            and (column.unit or "") == (columns[force_column].unit or "")
            and vocabulary.matches(column.name).get(role, 0.0) >= vocabulary.MIN_SCORE
        ][:4]

    def _has_pair(self, pair: tuple[Role, Role], roles: Sequence[int]) -> bool:
        answer = assign_role(self.table, pair[1], self.options)
        return isinstance(answer, RoleAssignment) and answer.index == roles[-1]

    def _note_shared_rows(
        self,
        loaded_columns: LoadedColumns,
        indexes: Sequence[int],
        force_column: int,
        other_indices: Sequence[int],
    ) -> LoadedColumns:
        """Return the columns with a note where two channels hold the same numbers in a part of all.

        Constant numbers are not labels: two channels may both rest at zero.
        """
        if not other_indices:
            return loaded_columns
        values = loaded_columns.values[:, indexes.index(force_column)]
        is_changing = np.diff(values, prepend=np.nan) != 0
        notes = []
        for other in other_indices:
            is_same = (loaded_columns.values[:, indexes.index(other)] == values) & is_changing
            count, rows = int(np.count_nonzero(is_same)), len(values)
            if (
                _SHARED_ROWS_SHARE * rows
                <= count
                < (1 - _SHARED_ROWS_SHARE) * np.count_nonzero(is_changing)
            ):
                pair = [format_column(self.table.columns, i) for i in (force_column, other)]
                first = int(np.argmax(is_same))
                notes.append(
                    f"{pair[0]} and {pair[1]} hold the same numbers in {count} of {rows} rows, "
                    f"first at {loaded_columns.format_row_position(first)}, and others elsewhere: "
                    "two sensors do not; was one copied from the other?"
                )
        return (
            replace(loaded_columns, notes=(*loaded_columns.notes, *notes))
            if notes
            else loaded_columns
        )

    def _part_by_clock(self, loaded_columns: LoadedColumns, signals: FloatArray) -> LoadedColumns:
        time = signals[:, 0]
        if len(loaded_columns.starts) > 1:
            restarts = [
                start for start in loaded_columns.starts[1:] if time[start] < time[start - 1]
            ]
            if self.options.segment is not None or not restarts:
                return loaded_columns
            names = _name_blocks(loaded_columns, self.table.header)
            message = (
                f"{len(names)} segments ({_list_names(names)}), and the clock starts again at "
                f"{loaded_columns.format_row_position(restarts[0])}"
            )
            return replace(
                loaded_columns,
                segments=names,
                questions=(*loaded_columns.questions, (None, _make_question(names, message))),
            )
        fall_indices = np.flatnonzero(np.diff(time) < 0)
        if not 0 < fall_indices.size < _MAX_SPECIMENS or not _begins_anew(
            time, signals, fall_indices + 1
        ):
            return loaded_columns
        starts = (0, *(fall_indices + 1).tolist())
        parts = slices(starts, len(time))
        if any(part.stop - part.start < _MIN_ROWS or np.ptp(time[part]) <= 0 for part in parts):
            return loaded_columns  # rows of padding
        names = ("",) * len(starts)
        i, unit_word = int(fall_indices[0]), self.table.columns[self._find_roles()[0]].unit
        unit = f" {unit_word}" if unit_word else ""
        message = (
            f"time falls from {time[i]:.9g}{unit} to {time[i + 1]:.9g}{unit} at "
            f"{loaded_columns.format_row_position(i + 1)}, where the clock begins anew "
            f"({fall_indices.size} such place{'s' * (fall_indices.size > 1)})"
        )
        split_columns = replace(loaded_columns, starts=starts, segments=names, above=())
        if self.options.segment is not None:
            return split_columns
        return replace(
            split_columns,
            questions=(*loaded_columns.questions, (None, _make_question(names, message))),
        )


def _make_question(names: Sequence[str], message: str, reason: str = "") -> Question:
    """Return the question which specimen is meant; its answers are as they are typed."""
    reason = reason or "tests of several specimens, or repeats, stand below each other"
    answers = tuple((name, f"segment={i}") for i, name in enumerate(names, start=1))
    message = (
        f"{message}: {reason}; choose one, for example --file-part segment=1, or fit all of them: "
        "dashpot batch FILE -o lot"
    )
    return Question(message, "--file-part segment=N", choices=len(names), answers=answers)


def _list_names(names: Sequence[str]) -> str:
    labels = [
        f"{i} {name}".strip() if name != str(i) else name for i, name in enumerate(names, start=1)
    ]
    return ", ".join(labels[:8]) + (" ..." if len(labels) > 8 else "")


def _name_blocks(loaded_columns: LoadedColumns, header: Sequence[str]) -> tuple[str, ...]:
    """Return the names of blocks: their own, or the specimen in the lines above each."""
    headers = (
        [header, *loaded_columns.above[1:]]
        if len(loaded_columns.above) == len(loaded_columns.starts)
        else []
    )
    lines = [next(filter(_LINE.fullmatch, block_header), "") for block_header in headers]
    names = [" ".join(re.sub(r'["\t;,#=]+', " ", line).split())[:40] for line in lines]
    if all(names) and len(set(names)) == len(names) and not any(loaded_columns.segments):
        return tuple(names)
    return loaded_columns.segments


def _list_runs(order: IndexArray, lines: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return where in a new order of rows a run of them begins, and its row in the old one."""
    firsts = {first for first, _ in lines}
    breaks = np.flatnonzero(np.diff(order) != 1) + 1
    further_starts = [int(np.flatnonzero(order == first)[0]) for first in firsts]
    run_starts = sorted({0, *breaks.tolist(), *further_starts})
    return [(run_start, int(order[run_start])) for run_start in run_starts]


def _begins_anew(time: FloatArray, signals: FloatArray, starts: IndexArray) -> bool:
    """Return whether clock and signals return to their start, as in a series of records.

    If one test continues, as after a counter overflow, its signals do not return to their start.
    """
    firsts, last_times = time[starts], time[starts - 1]
    if np.any(np.abs(firsts - time[0]) > _RESTART_SHARE * (last_times[0] - time[0])):
        return False
    distance_from_start, distance_from_last = (
        np.abs(signals[starts] - signals[other]) for other in (0, starts - 1)
    )
    change = np.nanmax(signals, axis=0) - np.nanmin(signals, axis=0)
    returns = (distance_from_last > _RESTART_SHARE * change) & (
        distance_from_start < distance_from_last
    )
    # the column of the clock is one of them
    return bool(
        np.all(returns | (distance_from_last <= _RESTART_SHARE * change))
        and np.all(returns.sum(axis=1) > 1)
    )


# A column of labels.


def _read_labels(table: FileTable, raw: RawFile) -> tuple[int, list[str]] | None:
    """Return the column that names the specimen of each row, and its labels; None without one."""
    for index, column in enumerate(table.columns):
        if column.unit or not names_specimen(split_unit(column.name)[0]):
            continue
        labels = None
        if column.content == "number":
            numbers = table.load([index]).values[:, 0]
            label_words = _read_stated_words(table.header, column.name)
            labels = [
                "" if np.isnan(value) else label_words.get(f"{value:g}", f"{value:g}")
                for value in numbers.tolist()
            ]
        elif column.content == "text" and table.format == "text":
            labels = _read_text_labels(table, raw, index)
        labels = labels and _fill_down(labels)
        if labels and _are_specimens(labels):
            return index, labels
    return None


def _are_specimens(labels: Sequence[str]) -> bool:
    """Return whether labels are few, and each of several rows."""
    names, counts = np.unique(np.asarray(labels), return_counts=True)
    return 1 < len(names) <= _MAX_SPECIMENS and int(counts.min()) >= _MIN_ROWS


def _fill_down(labels: Sequence[str]) -> list[str]:
    """Return labels, each holding for the blank cells below it."""
    filled_cells, last_cell = [], ""
    for label in labels:
        last_cell = label or last_cell
        filled_cells.append(last_cell)
    first = next((label for label in filled_cells if label), "")
    return [label or first for label in filled_cells]


def _read_stated_words(header: Sequence[str], name: str) -> dict[str, str]:
    """Return the words that a header lists for the numbers of a column."""
    line = next((line for line in header if line.startswith(f"{LABELS}{name}: ")), "")
    pairs = (part.partition(" = ") for part in line.partition(": ")[2].split("; "))
    return {number: word for number, _, word in pairs if number}


def _read_text_labels(table: FileTable, raw: RawFile, index: int) -> list[str] | None:
    """Return the cells of a column of text by the lines of the table's rows."""
    numbers = [i for i, column in enumerate(table.columns) if column.content == "number"]
    delimiter = _DELIMITERS.get(table.delimiter)
    if not numbers or delimiter is None:
        return None
    loaded_columns = table.load(numbers[:1])
    try:
        text = raw.head(raw.size).decode(table.encoding or "utf-8")
    except UnicodeDecodeError:
        return None
    lines = re.split(r"\r\n|\r|\n", text.removeprefix("\ufeff"))
    labels: list[str] = []
    run_ends = (*(first for first, _ in loaded_columns.lines[1:]), len(loaded_columns.values))
    for (first, line), stop in zip(loaded_columns.lines, run_ends, strict=True):
        for cell_line in lines[line - 1 : line - 1 + stop - first]:
            row = cells.split(cell_line, delimiter, trim=False)
            labels.append(row[index].strip() if index < len(row) else "")
    return labels if len(labels) == len(loaded_columns.values) else None


def _part_by_labels(
    table: FileTable, index: int, labels: Sequence[str], options: ReadOptions
) -> FileTable:
    codes, _ = format_labels(labels)
    names = tuple(dict.fromkeys(labels))
    order = np.argsort(np.asarray(codes), kind="stable")
    counts = np.bincount(codes, minlength=len(names) + 1)[1:]
    starts = (0, *np.cumsum(counts)[:-1].tolist())
    loader = _SpecimenLoader(table, options, order, starts, names)
    column = format_column(table.columns, index)
    message = f"holds {len(names)} specimens by its column {column} ({_list_names(names)})"
    questions = (
        ()
        if options.segment is not None
        else (_make_question(names, message, "one is fitted at a time"),)
    )
    return replace(table, load=loader, questions=(*table.questions, *questions))


# Blocks of columns of several specimens.


def _split_set(name: str) -> list[tuple[str, str]]:
    """Return the possible splits of a name into specimen and signal.

    >>> _split_set("seal_1.force"), _split_set("Force 2"), _split_set("B Force")
    ([('seal_1', 'force'), ('1', 'seal_.force')], [('2', 'Force ')], [('B', 'Force')])
    """
    splits = []
    owner, dot, stem = name.rpartition(".")
    if dot and owner and stem:
        splits.append((owner, stem))
    numbers = list(re.finditer(r"(?<![^\W\d_])\d{1,3}(?!\d)|\d{1,3}\Z", name))
    splits += [(m[0], name[: m.start()] + name[m.end() :]) for m in numbers]
    lettered = _LETTER.fullmatch(name)
    if lettered:
        first, suffix, before, last = lettered.groups()
        splits.append((first or last, suffix or before))
    return splits


def _find_column_sets(table: FileTable, options: ReadOptions) -> dict[str, list[int]]:
    """Return columns by specimen where each has its own displacement and force.

    Empty where the user names columns, or the names do not part them.
    """
    if options.time or any(getattr(options, role) for pair in _PAIRS for role in pair):
        return {}
    sets_by_split: dict[int, dict[str, dict[str, int]]] = {}
    stems = [split_unit(column.name)[0] if column.name else "" for column in table.columns]
    for index, (column, stem) in enumerate(zip(table.columns, stems, strict=True)):
        if column.content != "number":
            continue
        for split_index, (owner, signal) in enumerate(_split_set(stem)):
            sets_by_split.setdefault(split_index, {}).setdefault(owner, {}).setdefault(
                signal.strip(" _-#"), index
            )
    for sets in (*sets_by_split.values(), _find_repeated_names(table, stems)):
        complete = {owner: signals for owner, signals in sets.items() if _is_a_test(signals)}
        if (
            1 < len(complete) <= _MAX_SPECIMENS
            and len({frozenset(s) for s in complete.values()}) == 1
        ):
            return {owner: list(signals.values()) for owner, signals in complete.items()}
    return {}


def _find_repeated_names(table: FileTable, stems: Sequence[str]) -> dict[str, dict[str, int]]:
    """Return columns by how often their name stood before."""
    sets: dict[str, dict[str, int]] = {}
    name_counts: dict[str, int] = {}
    for index, (column, stem) in enumerate(zip(table.columns, stems, strict=True)):
        if stem and column.content == "number":
            name_counts[stem] = name_counts.get(stem, 0) + 1
            sets.setdefault(str(name_counts[stem]), {})[stem] = index
    return sets


def _is_a_test(signals: Sequence[str] | dict[str, int]) -> bool:
    """Return whether names say both signals of a test."""
    scores = [vocabulary.matches(name) for name in signals]
    return any(
        all(any(score.get(role, 0.0) >= vocabulary.MIN_SCORE for score in scores) for role in pair)
        for pair in _PAIRS
    )


def _part_by_columns(
    table: FileTable, sets: dict[str, list[int]], options: ReadOptions
) -> FileTable:
    names = list(sets)
    if options.segment is None:
        answers = [assign_role(table, role, options) for role in ("force", "stress")]
        if not any(isinstance(answer, Question) and answer.choices for answer in answers):
            return replace(table, load=_SpecimenLoader(table, options))
        labels = [
            ", ".join(table.columns[j].label(j + 1) for j in sorted(sets[name])[:4])
            for name in names[:8]
        ]
        if len(set(labels)) < len(labels):  # equal names
            labels = [f"columns {join_words([str(j + 1) for j in sorted(sets[n])])}" for n in names]
        labels_text = "; ".join(f"{i} {label}" for i, label in enumerate(labels[:8], start=1))
        ellipsis = "; ..." if len(names) > 8 else ""
        question = _make_question(
            names, f"{len(names)} sets of columns could each be the test ({labels_text}{ellipsis})",
            "tests of several specimens, or channels of several sensors, stand side by side",
        )  # fmt: skip
        # roles are proposed for the first, so that one question is asked
        return replace(_leave_set(table, sets, names[0]), questions=(*table.questions, question))
    if options.segment > len(names):
        raise ReadError(
            f"--file-part segment={options.segment}, but the file has {len(names)} sets of columns "
            f"({_list_names(names)})"
        )
    count = options.segment

    def load(indexes: Sequence[int]) -> LoadedColumns:
        loaded_columns = table.load(indexes)
        return replace(loaded_columns, starts=(0,) * count, segments=tuple(names[:count]))

    return replace(_leave_set(table, sets, names[count - 1]), load=load)


def _leave_set(table: FileTable, sets: dict[str, list[int]], name: str) -> FileTable:
    """Return the table with the columns of one specimen and the common columns."""
    others = {i for indexes in sets.values() for i in indexes} - set(sets[name])
    return replace(
        table,
        columns=tuple(
            replace(column, content="blank") if i in others else column
            for i, column in enumerate(table.columns)
        ),
    )
