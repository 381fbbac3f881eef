"""Where the table of numbers is in a text, and how its cells are parted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

from dashpot.io.table import Content
from dashpot.io.text import cells as cell
from dashpot.io.text.cells import Mark

_DELIMITERS = ("\t", ";", ",", "|", " ", ":")
_MARKS: tuple[Mark, ...] = (".", ",", ".,")
_SAMPLE = 60
_LONGEST = 1 << 15
"""Characters in a row; a longer line is no row of a test."""


@dataclass(frozen=True)
class Dialect:
    """How the rows of a table are written.

    Attributes
    ----------
    delimiter : str
        One character; ``" "`` is any run of blanks; ``"fixed:9,18"`` a fixed width.
    mark : str
        Decimal mark.
    contents : tuple of str
        What each column holds.
    first : int
        Line of the first row, counted from 0.
    """

    delimiter: str
    mark: Mark
    contents: tuple[Content, ...]
    first: int = 0

    @cached_property
    def numbers(self) -> tuple[int, ...]:
        """The columns that hold numbers or clock times."""
        return tuple(i for i, held in enumerate(self.contents) if held in {"number", "clock"})

    def row(self, line: str) -> list[str] | None:
        """The cells of a line, one per column, if it is a row of the table; else None."""
        if len(line) > _LONGEST:
            return None
        found = cell.split(line, self.delimiter)
        width = len(self.contents)
        if not found or any(cell.number(c, self.mark) is not None for c in found[width:] if c):
            return None
        if self.contents[0] == "blank" and found[0]:
            return None  # a word where every row is blank: a key of the header
        found = found[:width] + [""] * (width - len(found))
        return found if self._has_numbers(found) else None

    def _has_numbers(self, found: Sequence[str]) -> bool:
        """Whether there are numbers enough, and more than words, where numbers are expected."""
        filled = blank = words = 0
        for i in self.numbers:
            if self.value(found[i], i) is not None:
                filled += 1
            elif cell.is_missing(found[i]):
                blank += 1
            elif i == self.numbers[0]:
                return False  # "Mean;1.2;3.4"
            else:
                words += 1
        # a heading that holds a number or two has more words than numbers
        return filled > words and 2 * (filled + blank) > len(self.numbers)

    def value(self, text: str, column: int) -> float | None:
        """The number in a cell of a column, or None."""
        if self.contents[column] == "clock":
            return cell.clock(text)
        return cell.number(text, self.mark)


def find_dialect(
    lines: Sequence[str], *, delimiter: str | None = None, decimal: str | None = None
) -> Dialect | None:
    """Return the dialect of the longest table in the lines, or None if there is no table.

    Every delimiter and decimal mark is tried on lines from the start, the middle and the end;
    the pair under which most cells of equally wide neighbouring lines are numbers is taken.
    """
    windows = list(_windows(lines))
    best: Dialect | None = None
    highest = 0.0
    marks = [mark for mark in _MARKS if decimal in {None, mark}]
    for sign, mark, window in product(_delimiters(windows, delimiter), marks, windows):
        if _stands_in(sign, window):
            score, contents = _best_run(window, sign, mark, above=highest)
            if contents:
                highest, best = score, Dialect(sign, mark, contents)
    return None if best is None else _from_the_top(lines, best)


def _delimiters(windows: Sequence[Sequence[str]], given: str | None) -> tuple[str, ...]:
    """What to try: the one given, else all, and a fixed width for cells that may be blank."""
    if given == "fixed":
        return tuple(dict.fromkeys(map(_fixed, windows)))
    if given is not None:
        return (given,)
    return tuple(dict.fromkeys((*_DELIMITERS, *(_fixed(_digits(window)) for window in windows))))


def _stands_in(sign: str, window: Sequence[str]) -> bool:
    return len(sign) > 1 or sign == " " or any(sign in line for line in window)


def _windows(lines: Sequence[str]) -> Iterator[list[str]]:
    full = [line for line in lines if line.strip() and len(line) <= _LONGEST]
    if len(full) <= 3 * _SAMPLE:
        yield full
        return
    for part in (0.3, 0.6, 1.0):
        stop = max(_SAMPLE, int(part * len(full)))
        yield full[stop - _SAMPLE : stop]


def _best_run(
    lines: Sequence[str], sign: str, mark: Mark, *, above: float
) -> tuple[float, tuple[Content, ...]]:
    """Score and columns of the best run of lines of one width, if it scores above `above`."""
    rows = [cell.split(line, sign, trim=False) for line in lines]
    best: tuple[float, tuple[Content, ...]] = (above, ())
    if len(rows) * max(map(len, rows), default=0) <= above:  # even if all cells were numbers
        return best
    for run in _runs(rows, mark):
        contents = _contents(run, mark)
        numbers = sum(held in {"number", "clock"} for held in contents)
        words = sum(held == "text" for held in contents)
        score = len(run) * (numbers - 2.0 * words)
        # a lone number on each of a few lines is a header more often than a table
        score -= 0.5 * len(run) if numbers == 1 else 0.0
        if numbers and score > best[0]:
            best = (score, contents)
    return best


def _runs(rows: Sequence[list[str]], mark: Mark) -> Iterator[list[list[str]]]:
    """Runs of neighbouring rows that could belong to one table."""
    run: list[list[str]] = []
    mask: list[bool] = []
    for row in rows:
        is_number = [cell.number(c, mark) is not None or cell.clock(c) is not None for c in row]
        if run and any(is_number) and _alike(mask, is_number, row):
            run.append(row)
            mask += is_number[len(mask) :]
            continue
        if run:
            yield run
        run, mask = ([row], is_number) if any(is_number) else ([], [])
    if run:
        yield run


def _alike(mask: list[bool], is_number: list[bool], row: list[str]) -> bool:
    """Whether a row fits under those before it: numbers or blanks where numbers were."""
    if abs(len(mask) - len(is_number)) > max(1, len(mask) // 2):
        return False
    fits = hits = 0
    for was, now, text in zip(mask, is_number, row, strict=False):
        fits += was == now or cell.is_missing(text)
        hits += was and now
    shared = min(len(mask), len(row))
    return hits > 0 and fits >= shared - (shared > 2)


def _contents(run: Sequence[Sequence[str]], mark: Mark) -> tuple[Content, ...]:
    width = Counter(len(row) for row in run).most_common(1)[0][0]
    columns = ([row[i] for row in run if i < len(row) and row[i]] for i in range(width))
    held = [_content(column, mark) for column in columns]
    while held and held[-1] == "blank":
        held.pop()
    return tuple(held)


def _content(cells: Sequence[str], mark: Mark) -> Content:
    """What the filled cells of a column hold, most of them."""
    others = [text for text in cells if cell.number(text, mark) is None]
    numbers = len(cells) - len(others)
    missing = sum(map(cell.is_missing, others))
    clocks = sum(cell.clock(text) is not None for text in others)
    if missing == len(cells):
        return "blank"
    if clocks > numbers and clocks + missing >= 0.6 * len(cells):
        return "clock"
    return "number" if numbers + missing >= 0.6 * len(cells) else "text"


def _from_the_top(lines: Sequence[str], dialect: Dialect) -> Dialect | None:
    """The same dialect with the first line of its first steady run of rows."""
    needed, first, steady = 3, -1, 0
    fallback = -1
    for i, line in enumerate(lines):
        if not line.strip():
            continue
        if dialect.row(line) is None:
            first, steady = -1, 0
            continue
        if steady == 0:
            first = i
            fallback = i if fallback < 0 else fallback
        steady += 1
        if steady == needed:
            return replace(dialect, first=first)
    return replace(dialect, first=fallback) if fallback >= 0 else None


def _digits(lines: Sequence[str]) -> list[str]:
    """The lines that hold digits and hardly a word."""
    return [
        line
        for line in lines
        if "\t" not in line and sum(map(str.isdigit, line)) > 2 * sum(map(str.isalpha, line))
    ]


def _fixed(lines: Sequence[str]) -> str:
    """Column breaks where every line is blank and the next character is not."""
    width = max((len(line) for line in lines), default=0)
    blank = [all(i >= len(line) or line[i] == " " for line in lines) for i in range(width)]
    begin = blank.index(False) if False in blank else width
    breaks = [i for i in range(begin + 1, width) if blank[i - 1] and not blank[i]]
    return "fixed:" + ",".join(map(str, breaks)) if breaks else " "


def ambiguous_commas(lines: Sequence[str], dialect: Dialect) -> str | None:
    """Return a cell such as ``1,234`` if the commas of the whole sample can be read either way."""
    example = None
    for text in _with_commas(lines, dialect):
        if not cell.EITHER_WAY.match(text):  # 0,5 or 1,234.5 or 1,234,567 settles it
            return None
        example = example or text
    return example


def _with_commas(lines: Sequence[str], dialect: Dialect) -> Iterator[str]:
    """The cells with commas where numbers are expected."""
    for line in lines:
        if "," in line and (dialect.delimiter != "," or '"' in line):
            row = dialect.row(line) or [""] * len(dialect.contents)
            yield from (row[i] for i in dialect.numbers if "," in row[i])
