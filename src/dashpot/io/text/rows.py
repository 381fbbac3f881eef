"""The numbers of a text table, block by block: fast where rows are plain, patient where not."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.io.table import Loaded
from dashpot.io.text import cells as cell
from dashpot.io.text.dialect import Dialect

_PATIENT = 64
_MENTIONED = 50
_HEADING = 2000


@dataclass
class _Gathered:
    """What has been read so far."""

    parts: list[FloatArray] = field(default_factory=list)
    rows: int = 0
    starts: list[int] = field(default_factory=lambda: [0])
    segments: list[str] = field(default_factory=lambda: [""])
    lines: list[tuple[int, int]] = field(default_factory=list)
    words: dict[str, list[int]] = field(default_factory=dict)
    between: list[tuple[int, str]] = field(default_factory=list)

    def note(self, word: str, line: int) -> None:
        """Count a word in the place of a number; a few are enough to tell."""
        if word not in self.words and len(self.words) >= _MENTIONED:
            return
        places = self.words.setdefault(word, [0])
        places[0] += 1
        if len(places) <= 3:
            places.append(line)

    def add(self, values: FloatArray, line: int) -> None:
        if self.rows and not _remark(self.between):
            self.starts.append(self.rows)
            self.segments.append(title([text for _, text in self.between]))
        self.between.clear()
        known = self.lines[-1] if self.lines else (0, line)
        if not self.lines or known[1] + self.rows - known[0] != line:
            self.lines.append((self.rows, line))
        self.parts.append(values)
        self.rows += len(values)


def _remark(between: Sequence[tuple[int, str]]) -> bool:
    """Whether there is nothing between two rows, or but one comment: no new segment."""
    lines = [text for _, text in between]
    return not lines or (
        len(lines) == 1 and re.match(r"\s*[#%$!]", lines[0]) is not None and not title(lines)
    )


def load_rows(
    blocks: Iterator[str], dialect: Dialect, indexes: Sequence[int], *, first: str = ""
) -> Loaded:
    """Return the columns `indexes` of the table, from blocks of whole lines.

    `first` is the name of the first segment.

    Raises
    ------
    ReadError
        If a line holds more numbers than there are columns.
    """
    got = _Gathered(segments=[first])
    reader = _Reader(dialect, tuple(indexes))
    line = 1
    skipped = dialect.first
    for block in blocks:
        text = block
        if skipped:
            cut = _after_lines(text, skipped)
            passed = text.count("\n", 0, cut)
            skipped -= passed
            line += passed
            text = text[cut:]
        if text:
            reader.read(text, line, got)
            line += text.count("\n")
    values = _assembled(got, len(indexes))
    notes = []
    for token, (count, *places) in got.words.items():
        at = ", ".join(f"line {line}" for line in places)
        many = f" and {count - len(places)} more" if count > len(places) else ""
        notes.append(f"'{token}' stands for a missing number at {at}{many}")
    if got.between and got.rows:
        number, words = got.between[0]
        notes.append(
            f"what follows the table is no row and was passed over ({len(got.between)} lines) "
            f"from line {number}: '{words.strip()[:40]}'"
        )
    return Loaded(values, tuple(got.starts), tuple(got.segments), tuple(got.lines), tuple(notes))


def _assembled(got: _Gathered, width: int) -> FloatArray:
    """The parts as one array, each column in one piece; a part is let go once it is copied."""
    values = np.empty((got.rows, width), order="F")
    row = got.rows
    while got.parts:
        part = got.parts.pop()
        values[row - len(part) : row] = part
        row -= len(part)
    return values


def _after_lines(text: str, count: int) -> int:
    position = 0
    for _ in range(count):
        position = text.find("\n", position) + 1
        if position == 0:
            return len(text)
    return position


_TITLE = re.compile(
    r"\W*(?:segment|step|schritt|stage|test|run|block|record|interval)(?:\s*(?:name|no|nr))?\W*\s*[:=\t]\s*(.+)",
    re.IGNORECASE,
)


def title(lines: Sequence[str]) -> str:
    """A segment's name from the lines above it: ``# segment: pause`` is "pause"."""
    named = [match[1] for line in lines if (match := _TITLE.match(line))]
    return named[-1].strip(' \t",;')[:60] if named else ""


class _Reader:
    """Reads blocks of lines for one dialect and one choice of columns."""

    def __init__(self, dialect: Dialect, indexes: tuple[int, ...]) -> None:
        self.dialect = dialect
        self.indexes = indexes
        sign = dialect.delimiter
        self.plain = not sign.startswith("fixed") and not any(
            dialect.contents[i] == "clock" for i in indexes
        )
        self.blanks = sign == " "
        self.swaps_comma = dialect.mark != "."
        if self.swaps_comma and sign == ",":
            self.plain = False
        if len(sign) == 1 and not self.blanks:
            s = re.escape(sign)
            # a blank cell becomes nan, whether alone, quoted or padded
            self.blank = re.compile(rf"(?:(?<={s})|(?<=\n)|\A)[ ]*(?={s}|\n)")

    def read(self, text: str, line: int, got: _Gathered) -> None:
        """Read whole lines; a block that is not plain is halved until the odd lines are alone."""
        values = self._fast(text) if self.plain else None
        if values is not None:
            got.add(values, line)
            return
        count = text.count("\n")
        if self.plain and count > _PATIENT:
            cut = _after_lines(text, count // 2)
            self.read(text[:cut], line, got)
            self.read(text[cut:], line + count // 2, got)
            return
        run: list[list[float]] = []
        for number, text_line in enumerate(text.split("\n")[:-1], start=line):
            found = self._patient(text_line, number, got, begun=bool(run))
            if found is not None:
                run.append(found)
                continue
            if run:
                got.add(np.array(run), number - len(run))
                run = []
            self._between(text_line, number, got)
        if run:
            got.add(np.array(run), line + text.count("\n") - len(run))

    def _fast(self, text: str) -> FloatArray | None:
        plain = self._plain(text)
        if plain is None or self.blanks:
            return None if plain is None else self._parse(plain)
        if not self._same_width(plain):
            return None
        values = self._parse(plain)
        if values is None and self.blank.search(plain):
            values = self._parse(self.blank.sub("nan", plain))
        return values

    def _plain(self, text: str) -> str | None:
        """The text without quotes and with decimal points, None if that is not surely the same."""
        if '"' in text:
            if self.blanks or (self.swaps_comma and self.dialect.delimiter == ","):
                return None
            text = text.replace('"', "")
        if self.swaps_comma:
            if "." in text and self.dialect.mark == ",":  # points group the thousands
                return None
            text = text.replace(",", ".")
        return text

    def _same_width(self, text: str) -> bool:
        """Whether every line has as many delimiters as the table needs, or one at its end."""
        codes = np.frombuffer(text.encode("latin-1", "replace"), dtype=np.uint8)
        ends = np.flatnonzero(codes == 10)
        signs = np.flatnonzero(codes == ord(self.dialect.delimiter))
        counts = np.diff(np.searchsorted(signs, ends), prepend=0)
        return (
            len(counts) > 0
            and bool((counts == counts[0]).all())
            and counts[0] >= len(self.dialect.contents) - 1
        )

    def _parse(self, text: str) -> FloatArray | None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "no data": a block of blank lines
            try:
                values = np.loadtxt(
                    io.StringIO(text),
                    delimiter=None if self.blanks else self.dialect.delimiter,
                    comments=None,
                    ndmin=2,
                    usecols=None if self.blanks else self.indexes,
                )
            except (ValueError, IndexError, OverflowError):
                return None
        if len(values) != text.count("\n"):  # blank lines: the line numbers would be wrong
            return None
        if self.blanks:
            if values.shape[1] != len(self.dialect.contents):
                return None
            values = values[:, list(self.indexes)]
        return values

    def _patient(
        self, line: str, number: int, got: _Gathered, *, begun: bool
    ) -> list[float] | None:
        """The numbers of one line, None if it is no row; `begun` if the line before was one."""
        row = self.dialect.row(line)
        below = got.rows and got.between and not begun
        if row is None or (below and not self._full(row)):  # "Maximum;8.0;1.9" below the table
            return None
        values = []
        for i in self.indexes:
            value = self.dialect.value(row[i], i)
            values.append(np.nan if value is None else value)
            if value is None and row[i]:
                got.note(row[i][:20], number)
        return values

    def _between(self, line: str, number: int, got: _Gathered) -> None:
        """Keep a line that is no row: a heading of the next segment, or what ends the file."""
        if re.search(r"\w", line):
            self._refuse_wide(line, number, got)
            if len(got.between) < _HEADING:
                got.between.append((number, line[:200]))

    def _full(self, row: Sequence[str]) -> bool:
        """Whether no word stands where a number is expected."""
        return all(
            cell.is_missing(row[i]) or self.dialect.value(row[i], i) is not None
            for i in self.dialect.numbers
        )

    def _refuse_wide(self, line: str, number: int, got: _Gathered) -> None:
        cells = cell.split(line, self.dialect.delimiter)
        width = len(self.dialect.contents)
        found = cell.numeric(cells, self.dialect.mark)
        if got.rows and len(cells) > width and sum(found) > len(self.dialect.numbers):
            raise ReadError(
                f"line {number} has {len(cells)} cells where the table has {width}: "
                f"'{line.strip()[:60]}'; the table changes there, split the file at that line"
            )
