"""Whether ``1.600`` is one and a bit or a thousand and six hundred: the whole column tells."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.reading.table import Question
from dashpot.reading.text import cells as cell
from dashpot.reading.text.dialect import Dialect

_SMALL = re.compile(r"\A[+-]?[1-9]\d{0,2}\Z")
_FIRST, _ROWS, _CELLS = 1 << 11, 1 << 14, 1 << 20
"""Rows that are looked at first, and at most at once, fewer of a wide table."""
_SEEN = 1 << 12
"""Texts of a column that are known again."""


def open_columns(values: FloatArray) -> set[int]:
    """Return the columns whose points could part thousands, as far as their values tell.

    A number below one, above a thousand or with more than three decimals was printed with a
    decimal point, or without any mark; and beside a grouped 1.600 stands a whole number. Hardly
    a column is left.
    """
    width = values.shape[1]
    left, whole = np.arange(width), np.zeros(width, bool)
    most, stop = min(_ROWS, max(1, _CELLS // max(1, width))), 0
    while stop < len(values) and left.size:
        start, stop = stop, stop + min(most, max(_FIRST, stop))
        part = np.abs(values[start:stop, left])
        stated = np.isfinite(part) & (part > 0)
        odd = stated & ((part < 1) | (part >= 1e3))
        digits = np.where(stated & ~odd, part, 1.0) * 1e3
        odd |= np.abs(digits - np.round(digits)) > 0.01
        whole[left] |= (stated & (part == np.floor(part))).any(axis=0)
        left = left[~odd.any(axis=0)]
    return set(left[whole[left]].tolist())


@dataclass
class _Marks:
    """How the numbers of one column are written, as far as they have been read."""

    decimal: str
    own: str = ""
    foreign: str = ""
    small: bool = False
    broken: bool = False
    grouped: bool = False
    seen: set[str] = field(default_factory=set)

    def is_redundant(self, text: str) -> bool:
        """Whether a cell adds nothing to what is known.

        What was said before tells nothing new: of a counter a few rows are enough. Nor, where the
        decimal mark is sure, does a cell without another mark.
        """
        if self.grouped or text in self.seen:
            return True
        return self.broken and not any(c in text for c in ".," if c != self.decimal)

    def add(self, text: str) -> None:
        match = cell.EITHER_WAY.match(text)
        if match and match[1] in self.decimal:
            self.own = self.own or text
        elif match:
            self.foreign = self.foreign or text
        elif _SMALL.match(text):
            self.small = True
        else:  # 1,234.5 shows what groups; 1.6, and 1600 without any mark, what does not
            marks = sum(c in ".," for c in text)
            self.grouped |= marks > 1
            self.broken |= marks == 1 or len(text) > 3

    def doubt(self) -> str:
        """A cell that can be read two ways, or ""."""
        if self.grouped:
            return ""
        if self.foreign and (self.decimal == "." or not (self.own or self.small or self.broken)):
            return self.foreign
        # beside 800, 1.600 was hardly printed with three decimals
        return self.own if self.small and not self.broken else ""


def ambiguous(
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
    columns = {place: _Marks(dialect.mark) for place in {*commas, *points}}
    for block in blocks if columns else ():
        cells = block.count("\n") + block.count(dialect.delimiter)
        # where every cell has its point, or none has, one row shows how it is used
        alike = block.count(".") in {0, cells} and not commas
        lines = [block.partition("\n")[0]] if alike else block.split("\n")[:-1]
        _add_rows(lines, dialect, indexes, columns)
        if all(m.grouped or (m.broken and place not in commas) for place, m in columns.items()):
            break
    return [_which_mark(text) for marks in columns.values() if (text := marks.doubt())]


def _add_rows(
    lines: Sequence[str], dialect: Dialect, indexes: Sequence[int], columns: dict[int, _Marks]
) -> None:
    wanted = {place: indexes[place] for place in columns}
    for line in lines:
        parts = cell.split(line, dialect.delimiter)
        if all(i < len(parts) and columns[p].is_redundant(parts[i]) for p, i in wanted.items()):
            continue
        row = dialect.row(line)
        if row is None:
            continue
        for place, marks in columns.items():
            text = row[indexes[place]]
            if len(marks.seen) < _SEEN:
                marks.seen.add(text)
            if cell.number(text, dialect.mark) is not None:
                marks.add(text)


def _which_mark(example: str) -> Question:
    digits = re.sub("[.,]", "", example)
    mark = "," if "," in example else "."
    other = "." if mark == "," else ","
    value = example.replace(",", ".")
    says = (
        f"numbers such as '{example}' can mean {value} or {digits}; say which with "
        f'--text decimal="{mark}" ({value}) or --text decimal="{other}" ({digits})'
    )
    return Question(says, "--text decimal=MARK")
