"""Rows of a text table, parsed block by block: fast if plain, cell by cell otherwise."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Sequence

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.base.provenance import Caution
from dashpot.reading.raw_file import TimeBudget
from dashpot.reading.table import Column, LoadedColumns, Question
from dashpot.reading.text import cells as cell
from dashpot.reading.text.cells import ClockColumn
from dashpot.reading.text.dialect import MAX_LENGTH, Dialect, looks_like_number
from dashpot.reading.text.header import find_header_change
from dashpot.reading.text.plain_rows import PlainRows, line_count

# Decimal or thousands mark, as in ``1.600``, by the whole column.


_SMALL = compile_on_use(r"\A[+-]?[1-9]\d{0,2}\Z")
_FIRST_ROWS, _MAX_ROWS, _MAX_CELLS = 1 << 11, 1 << 14, 1 << 20
"""Numbers of rows that are read first, and at most at once; fewer for a wide table."""
_MAX_CACHED = 1 << 12
"""Cached texts of a column."""


def find_undecided_columns(values: FloatArray) -> set[int]:
    """Return the columns whose points could part thousands, as far as their values show.

    A number below one, above a thousand or with more than three decimals was printed with a
    decimal point, or without any mark; and beside a grouped 1.600 stands a whole number. Hardly
    a column is left.
    """
    width = values.shape[1]
    undecided, is_whole_number = np.arange(width), np.zeros(width, bool)
    max_rows, stop = min(_MAX_ROWS, max(1, _MAX_CELLS // max(1, width))), 0
    while stop < len(values) and undecided.size:
        start, stop = stop, stop + min(max_rows, max(_FIRST_ROWS, stop))
        part = np.abs(values[start:stop, undecided])
        is_counted = np.isfinite(part) & (part > 0)
        is_unusual = is_counted & ((part < 1) | (part >= 1e3))
        digits = np.where(is_counted & ~is_unusual, part, 1.0) * 1e3
        is_unusual |= np.abs(digits - np.round(digits)) > 0.01
        is_whole_number[undecided] |= (is_counted & (part == np.floor(part))).any(axis=0)
        undecided = undecided[~is_unusual.any(axis=0)]
    return set(undecided[is_whole_number[undecided]].tolist())


@dataclass(frozen=False)
class _Marks:
    """Marks of the numbers in one column, as far as they have been read."""

    decimal: str
    decimal_mark_example: str = ""
    other_mark_example: str = ""
    has_small_number: bool = False
    is_ungrouped: bool = False
    has_groups: bool = False
    seen_cells: set[str] = field(default_factory=set)

    def is_redundant(self, text: str) -> bool:
        """Return whether a cell adds no information.

        Repeated texts add no information; of a counter a few rows are enough. Nor, where the
        decimal mark is sure, does a cell without another mark.
        """
        if self.has_groups or text in self.seen_cells:
            return True
        return self.is_ungrouped and not any(c in text for c in ".," if c != self.decimal)

    def add(self, text: str) -> None:
        match = cell.EITHER_WAY.match(text)
        if match and match[1] in self.decimal:
            self.decimal_mark_example = self.decimal_mark_example or text
        elif match:
            self.other_mark_example = self.other_mark_example or text
        elif _SMALL.match(text):
            self.has_small_number = True
        else:  # 1,234.5 shows what groups; 1.6, and 1600 without any mark, what does not
            mark_count = sum(c in ".," for c in text)
            self.has_groups |= mark_count > 1
            self.is_ungrouped |= mark_count == 1 or len(text) > 3

    def question(self) -> str:
        """Return a cell that can be read two ways, or ""."""
        if self.has_groups:
            return ""
        if self.other_mark_example and (
            self.decimal == "."
            or not (self.decimal_mark_example or self.has_small_number or self.is_ungrouped)
        ):
            return self.other_mark_example
        # beside 800, 1.600 was hardly printed with three decimals
        return self.decimal_mark_example if self.has_small_number and not self.is_ungrouped else ""


def find_ambiguous_marks(
    blocks: Iterator[str],
    dialect: Dialect,
    indexes: Sequence[int],
    commas: Collection[int],
    points: Collection[int],
) -> list[Question]:
    """Return what to ask of columns, from the text itself.

    Parameters
    ----------
    blocks : iterator of str
        Rows of the table.
    commas, points : collection of int
        Places in `indexes` of the columns where commas were met beside decimal points, and of
        those whose points could part thousands.
    """  # fmt: skip
    columns = {index: _Marks(dialect.mark) for index in {*commas, *points}}
    for block in blocks if columns else ():
        cells = block.count("\n") + block.count(dialect.delimiter)
        # where every cell has its point, or none has, one row shows how it is used
        is_consistent = block.count(".") in {0, cells} and not commas
        lines = [block.partition("\n")[0]] if is_consistent else block.split("\n")[:-1]
        _add_rows(lines, dialect, indexes, columns)
        if all(
            m.has_groups or (m.is_ungrouped and index not in commas) for index, m in columns.items()
        ):
            break
    return [
        _which_mark(text) for column_marks in columns.values() if (text := column_marks.question())
    ]


def _add_rows(
    lines: Sequence[str], dialect: Dialect, indexes: Sequence[int], columns: dict[int, _Marks]
) -> None:
    column_by_index = {index: indexes[index] for index in columns}
    for line in lines:
        parts = cell.split(line, dialect.delimiter)
        if all(
            i < len(parts) and columns[p].is_redundant(parts[i]) for p, i in column_by_index.items()
        ):
            continue
        row = dialect.row(line)
        if row is None:
            continue
        for index, column_marks in columns.items():
            text = row[indexes[index]]
            if len(column_marks.seen_cells) < _MAX_CACHED:
                column_marks.seen_cells.add(text)
            if cell.number(text, dialect.mark) is not None:
                column_marks.add(text)


def _which_mark(example: str) -> Question:
    digits = re.sub("[.,]", "", example)
    example_mark = "," if "," in example else "."
    other = "." if example_mark == "," else ","
    value = example.replace(",", ".")
    message = (
        f"numbers such as '{example}' can mean {value} or {digits}; say which with "
        f'--text-format decimal="{example_mark}" ({value}) or --text-format decimal="{other}" '
        f"({digits})"
    )
    return Question(message, "--text-format decimal=MARK")


_MAX_FOREIGN_LINES = 64
_MAX_MENTIONED = 50
_HEADING = 2000
_WIDE, _NARROW = 16, 1 << 15
"""Lines of a heading that are kept whole, and characters of the others."""
_TAIL = 4096
_DATE_DIGITS = 4
"""Digits that a date has and a label has not."""


@dataclass(frozen=True)
class Heading:
    """Heading of the first segment: the columns, and the format of their clock times."""

    columns: tuple[Column, ...] = ()
    clocks: tuple[str, ...] = ()
    title: str = ""


@dataclass(frozen=False)
class _Gathered:
    """Rows and notes that have been read so far."""

    parts: list[FloatArray] = field(default_factory=list)
    rows: int = 0
    starts: list[int] = field(default_factory=lambda: [0])
    segments: list[str] = field(default_factory=lambda: [""])
    lines: list[tuple[int, int]] = field(default_factory=list)
    words: dict[str, list[int]] = field(default_factory=dict)
    lines_between: list[tuple[int, str]] = field(default_factory=list)
    remarks: list[tuple[int, str]] = field(default_factory=list)
    questions: list[tuple[int | None, Question]] = field(default_factory=list)
    headers: list[tuple[str, ...]] = field(default_factory=lambda: [()])

    def count_word(self, word: str, line: int) -> None:
        """Count a word in the place of a number; a few are enough to show."""
        if word not in self.words and len(self.words) >= _MAX_MENTIONED:
            return
        line_numbers = self.words.setdefault(word, [0])
        line_numbers[0] += 1
        if len(line_numbers) <= 3:
            line_numbers.append(line)

    def add(self, values: FloatArray, line: int) -> None:
        """Add rows that stand on one line after the other, from this line on."""
        items = self.lines[-1] if self.lines else (0, line)
        if not self.lines or items[1] + self.rows - items[0] != line:
            self.lines.append((self.rows, line))
        self.parts.append(values)
        self.rows += len(values)

    def end_segment(self, odd: str | None) -> None:
        """End a segment where lines stand between the rows, unless they are but one remark.

        `odd` is the fault of a header there, None if there is no header.
        """
        texts = [text for _, text in self.lines_between]
        if odd or not _remark(texts):
            self.starts.append(self.rows)
            self.segments.append(title(texts))
            self.headers.append(tuple(texts))
        if odd is None:
            self.remarks.append(self.lines_between[-1])
        self.lines_between.clear()

    def notes(self) -> list[str]:
        """Return notes on the skipped lines and their places."""
        notes = []
        for token, (count, *numbers) in self.words.items():
            at = ", ".join(f"line {line}" for line in numbers)
            unlisted_text = f" and {count - len(numbers)} more" if count > len(numbers) else ""
            message = f"'{token}' stands for a missing number at {at}{unlisted_text}"
            misread = any(map(str.isdigit, token)) and not cell.is_missing(token)
            notes.append(Caution(message) if misread else message)
        if self.remarks:
            number, words = self.remarks[0]
            count_text = f" ({len(self.remarks)} such lines)" if len(self.remarks) > 1 else ""
            notes.append(
                f"line {number} is a remark between rows{count_text}: '{words.strip()[:60]}'"
            )
        if self.lines_between and self.rows:
            number, words = self.lines_between[0]
            notes.append(
                f"what follows the table is no row and was passed over ({len(self.lines_between)} "
                f"lines) from line {number}: '{words.strip()[:40]}'"
            )
        return notes


def _remark(lines: Sequence[str]) -> bool:
    """Return whether lines between two rows are but one comment: no new segment."""
    comment = len(lines) == 1 and re.match(r"\A\s*+[#%$!]", lines[0]) is not None
    return comment and not title(lines)


def load_rows(
    blocks: Callable[[], Iterator[str]],
    dialect: Dialect,
    indexes: Sequence[int],
    heading: Heading | None = None,
    *,
    is_decimal_certain: bool = True,
    time_budget: TimeBudget | None = None,
) -> LoadedColumns:
    """Return the columns `indexes` of the table, from blocks of whole lines.

    Unless `is_decimal_certain`, numbers that can be read two ways become questions.
    Reading may cost what `time_budget` is left.

    Raises
    ------
    ReadError
        If a line between the rows holds numbers as they do, but more or fewer; or if it takes too
        long.
    """
    time_budget = time_budget or TimeBudget(None)
    with time_budget.count_time_spent():
        return _load_columns(
            blocks,
            dialect,
            indexes,
            heading or Heading(),
            time_budget,
            is_decimal_certain=is_decimal_certain,
        )


def _load_columns(
    blocks: Callable[[], Iterator[str]],
    dialect: Dialect,
    indexes: Sequence[int],
    heading: Heading,
    time_budget: TimeBudget,
    *,
    is_decimal_certain: bool,
) -> LoadedColumns:
    gathered = _Gathered(segments=[heading.title])
    reader = _Reader(dialect, tuple(indexes), heading, gathered, time_budget)
    first = tail = ""
    line = dialect.first + 1
    for text in _drop_first_lines(blocks(), dialect.first):
        line += reader.read(text, line)
        first = first or text.partition("\n")[0]
        tail = (tail + text[-_TAIL:])[-_TAIL:]
    values = _merge_parts(gathered, len(indexes))
    notes = [*gathered.notes(), *reader.finish(values)]
    last = tail.rstrip().split("\n")[1:]
    if not gathered.lines_between:
        notes += _labels(first, "".join(last[-1:]), dialect, heading)
    complete = gathered.lines_between or gathered.rows - gathered.starts[-1] < 2
    if not complete and dialect.is_cut_off(last):
        values = values[:-1]
        notes.append("the last row is cut off within its last number and was left out")
    if not is_decimal_certain:
        points = find_undecided_columns(values)
        table_lines = _tolerate_foreign_lines(
            _drop_first_lines(blocks(), dialect.first), time_budget, dialect.first + 1
        )
        commas = reader.grouped | reader.plain.commas
        questions = find_ambiguous_marks(table_lines, dialect, indexes, commas, points)
        gathered.questions += [(None, question) for question in questions]
    starts, names = tuple(gathered.starts), tuple(gathered.segments)
    return LoadedColumns(
        values,
        starts,
        names,
        tuple(gathered.lines),
        tuple(notes),
        tuple(gathered.questions),
        tuple(gathered.headers),
    )


def _labels(first: str, last: str, dialect: Dialect, heading: Heading) -> list[str]:
    """Note columns of labels that end otherwise than they begin: other runs, or no row at all."""
    notes: list[str] = []
    top, bottom = dialect.row(first), dialect.row(last)
    if top is None or bottom is None:
        return notes
    for i, (content, start, end) in enumerate(zip(dialect.contents, top, bottom, strict=True)):
        digits = max(sum(map(str.isdigit, text)) for text in (start, end))
        if content == "text" and "" not in {start, end} and start != end and digits < _DATE_DIGITS:
            name = heading.columns[i].label(i + 1) if heading.columns else str(i + 1)
            notes.append(f"column '{name}' begins with '{start[:20]}' and ends with '{end[:20]}'")
    return notes[:2]


def _merge_parts(collected: _Gathered, width: int) -> FloatArray:
    """The parts as one array, each column in one piece; a part is freed once it is copied."""
    values = np.empty((collected.rows, width), order="F")
    row = collected.rows
    while collected.parts:
        part = collected.parts.pop()
        values[row - len(part) : row] = part
        row -= len(part)
    return values


def _drop_first_lines(blocks: Iterator[str], first: int) -> Iterator[str]:
    """The text below the first lines, block by block."""
    for block in blocks:
        remaining_block = _after_lines(block, first)
        first -= block.count("\n", 0, remaining_block)
        text = block[remaining_block:]
        if text:
            yield text


def _tolerate_foreign_lines(
    blocks: Iterator[str], time_budget: TimeBudget, line: int
) -> Iterator[str]:
    for text in blocks:
        time_budget.check_time_limit(line)
        yield text
        line += line_count(text)


def _after_lines(text: str, count: int) -> int:
    position = 0
    for _ in range(count):
        position = text.find("\n", position) + 1
        if position == 0:
            return len(text)
    return position


_TITLE = compile_on_use(
    r"\A\W{0,80}(?:segment|step|schritt|stage|test|run|block|record|interval)"
    r"(?:\s{0,9}(?:name|no|nr))?\W{0,80}?[:=\t]\s*+(.+)",
    re.IGNORECASE,
)


def title(lines: Sequence[str]) -> str:
    """Return a segment's name from the lines above it: ``# segment: pause`` is "pause"."""
    titles = [match[1] for line in lines if (match := _TITLE.match(line))]
    return titles[-1].strip(' \t",;')[:60] if titles else ""


class _Reader:
    """Reader of blocks of lines for one dialect and some columns, into collected parts."""

    def __init__(
        self,
        dialect: Dialect,
        indexes: tuple[int, ...],
        heading: Heading,
        collected: _Gathered,
        time_budget: TimeBudget,
    ) -> None:
        self.patience = time_budget
        self.dialect = dialect
        self.indexes = indexes
        self.heading = heading
        self.got = collected
        self.clocks = {
            index: ClockColumn(heading.clocks[i] if heading.clocks else "")
            for index, i in enumerate(indexes)
            if dialect.contents[i] == "clock"
        }
        self.plain = PlainRows(dialect, indexes, self.clocks)
        self.grouped: set[int] = set()
        self.like = ""
        self.changed = ""
        self.headers: dict[tuple[str, ...], str | None] = {}
        self.odd: dict[str, bool] = {}
        self.no_rows: set[str] = set()

    def read(self, text: str, line: int) -> int:
        """Read whole lines and return how many they are.

        A block that is not plain is halved until the odd lines are alone.
        """
        values = self.plain.read(text) if self.plain.possible else None
        if values is not None:
            self._add(values, line)
            return len(values)
        self.patience.check_time_limit(line)
        count = line_count(text)
        if self.plain.possible and count > _MAX_FOREIGN_LINES:
            half_block = _after_lines(text, count // 2)
            self.read(text[:half_block], line)
            self.read(text[half_block:], line + count // 2)
            return count
        run: list[list[float]] = []
        lines = text.split("\n")[:-1]
        self._find_like(lines)
        for number, raw in enumerate(lines, start=line):
            if number % _MAX_FOREIGN_LINES == 0:
                self.patience.check_time_limit(number)
            row = self._parse_row(raw, follows_row=bool(run)) if raw not in self.no_rows else None
            if row is not None:
                run.append(self._numbers(row, number))
                continue
            if run:
                self._add(np.array(run), number - len(run))
                run = []
            self._add_other_line(raw, number)
        if run:
            self._add(np.array(run), line + len(lines) - len(run))
        return count

    def finish(self, values: FloatArray) -> list[str]:
        """Judge the end of the file and the clocks; return notes."""
        lines_between = self.got.lines_between
        if self.got.rows and lines_between and self._is_malformed_row(lines_between[0]):
            number, text = lines_between[0]
            parts = cell.split(text, self.dialect.delimiter)
            cut_off = len(lines_between) == 1 and len(parts) < len(self.dialect.contents)
            if not parts[0][:1].isalpha() and not cut_off:  # else a summary, or a cut-off row
                self._refuse_row(number, text)
        notes = []
        for index, clock in self.clocks.items():
            nights, questions = clock.apply_day_changes(values[:, index])
            self.got.questions += [(None, question) for question in questions]
            notes += [f"the clock passes midnight at row {row + 1}" for row in nights[:3]]
        return notes

    def _add(self, values: FloatArray, line: int) -> None:
        """Add rows, after the lines before them are classified."""
        gathered = self.got
        if gathered.rows and gathered.lines_between:
            single = len(gathered.lines_between) == 1
            for item in (gathered.lines_between[0], gathered.lines_between[-1]):
                if self._is_malformed_row(item) or (single and looks_like_number(item[1].strip())):
                    self._refuse_row(*item)
            change = self._find_header_change()
            self.changed = self.changed if change is None else change  # it holds until the next
            before = len(gathered.starts)
            gathered.end_segment(change)
            if self.changed and len(gathered.starts) > before:
                advice = f"read what stands before it with --file-part segment={before}"
                message = f"{self.changed}; split the file there, or {advice}"
                gathered.questions.append((before, Question(message, "--file-part segment=N")))
        gathered.lines_between.clear()
        gathered.add(values, line)

    def _find_header_change(self) -> str | None:
        """Return how a second header differs from the first; None if there is none."""
        if not self.heading.columns:
            return ""
        texts = tuple(text for _, text in self.got.lines_between)
        if texts not in self.headers and len(self.headers) < _MAX_MENTIONED:
            self.headers[texts] = self._compare_header(texts)
        difference = self.headers[texts] if texts in self.headers else self._compare_header(texts)
        number = self.got.lines_between[-1][0]
        return difference and f"line {number} ends a second header, {difference}"

    def _compare_header(self, texts: Sequence[str]) -> str | None:
        return find_header_change(texts, self.dialect, self.heading.columns, self.indexes)

    def _find_like(self, lines: Sequence[str]) -> None:
        """Complete row, which shows the positions of blank cells."""
        if self.dialect.delimiter == " ":
            full_lines = (line for line in lines if len(line.split()) == self.dialect.cells)
            self.like = next(full_lines, self.like)

    def _parse_row(self, line: str, *, follows_row: bool) -> list[str] | None:
        """Return the cells of a line; None if it is no row. The line before may have been one."""
        row = self.dialect.row(line, self.like)
        if row is None and len(self.no_rows) < _MAX_MENTIONED and self.dialect.delimiter != " ":
            self.no_rows.add(line)  # a header may stand above every few rows
        has_gap = self.got.rows and self.got.lines_between and not follows_row
        if row is None or (has_gap and not self._is_full(row)):  # "Maximum;8.0;1.9" below the table
            return None
        return row

    def _numbers(self, row: Sequence[str], number: int) -> list[float]:
        """Return the numbers wanted of a row."""
        values = []
        for index, i in enumerate(self.indexes):
            clock = self.clocks.get(index)
            value = clock.seconds(row[i]) if clock else self.dialect.value(row[i], i)
            values.append(np.nan if value is None else value)
            if value is None and row[i]:
                self.got.count_word(row[i][:20], number)
            if self.dialect.mark == "." and "," in row[i] and value is not None and not clock:
                self.grouped.add(index)
        return values

    def _add_other_line(self, line: str, number: int) -> None:
        """Keep a line that is no row: the heading of the next segment, or the end of the file."""
        lines_between = self.got.lines_between
        if re.search(r"\w", line):
            if len(lines_between) >= _HEADING:
                lines_between.pop()
            lines_between.append(
                (number, line[: MAX_LENGTH if len(lines_between) < _WIDE else _NARROW])
            )

    def _is_full(self, row: Sequence[str]) -> bool:
        """Return whether there is no word in place of a number."""
        return all(
            cell.is_missing(row[i]) or self.dialect.value(row[i], i) is not None
            for i in self.dialect.numbers
        )

    def _is_malformed_row(self, pair: tuple[int, str]) -> bool:
        """Return whether a line looks like a row but cannot be parsed as one."""
        text = pair[1]
        if text not in self.odd:
            comment = re.match(r"\A\s*+[#%$!]", text) is not None
            is_malformed = not comment and self.dialect.resembles_row(text)
            if len(self.odd) >= _MAX_MENTIONED:
                return is_malformed
            self.odd[text] = is_malformed
        return self.odd[text]

    def _refuse_row(self, number: int, line: str) -> None:
        parts = cell.split(line, self.dialect.delimiter)
        width = self.dialect.cells or len(self.dialect.contents)
        line_text = f"'{line.strip()[:60]}'"
        if len(parts) in {width, len(self.dialect.contents)}:
            malformed_cell = self._find_malformed_cell(parts)
            raise ReadError(
                f"line {number} has the {len(parts)} cells of the table, but {malformed_cell}: "
                f"{line_text}; "
                "correct that line or take it out, or split the file there"
            )
        raise ReadError(
            f"line {number} has {len(parts)} cell{'s' * (len(parts) != 1)} where the table has "
            f"{width}: {line_text}; which one is missing, added or not parted cannot be known: "
            "correct that line or take it out, or split the file there"
        )

    def _find_malformed_cell(self, names: Sequence[str]) -> str:
        """Return the malformed cell of a line with as many cells as a row."""
        contents = self.dialect.contents
        for i in self.dialect.numbers:
            text = names[i] if i < len(names) else ""
            if not cell.is_missing(text) and self.dialect.value(text, i) is None:
                expected = "a time" if contents[i] == "clock" else "a number"
                return f"'{text[:20]}' in column {i + 1}, where {expected} is expected"
        if contents[0] == "blank" and names and names[0]:
            return f"'{names[0][:20]}' in column 1, which is blank in every row"
        return "too few of them are numbers"
