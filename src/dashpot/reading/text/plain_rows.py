"""Blocks of plain rows of equal width, parsed by NumPy with exact decimals."""

from __future__ import annotations

import io
import re
import struct
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import ClassVar

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.lazy import compile_on_use
from dashpot.reading.text import cells as cell
from dashpot.reading.text.cells import ClockColumn
from dashpot.reading.text.dialect import Dialect

# Numbers of a whole column at once, where all have as many decimals: their digits, read as words.
#
# Eight characters are one word of a processor, and three products of words make eight digits one
# number. Up to fifteen digits and a power of ten are exact doubles, so that their quotient is the
# nearest double, as Python's own.


_WORD_BYTES, _SEEN_BYTES = 8, 16
"""Characters of a word, and of the end of each cell that are looked at."""
_DIGITS = 15
_ZEROS, _TO_HIGH, _HIGH = (int(pair * _WORD_BYTES, 16) for pair in ("30", "76", "80"))


_DIGIT_PAIRS = (
    (10 * 2**8 + 1, 8, 0x00FF00FF00FF00FF),
    (100 * 2**16 + 1, 16, 0x0000FFFF0000FFFF),
    (10_000 * 2**32 + 1, 32, 0xFFFFFFFF),
)
"""Multipliers and masks that merge digits into twos, fours and eights."""


def _make_byte_masks(stop: int) -> IndexArray:
    """The bits of a word that are a cell's, by its length; it begins `stop` before the end."""
    byte_counts = (min(max(stop - length, 0), _WORD_BYTES) for length in range(_SEEN_BYTES + 1))
    return np.array([2**64 - 2 ** (8 * other) for other in byte_counts], np.uint64)


_BYTE_MASKS = _make_byte_masks(_WORD_BYTES), _make_byte_masks(_SEEN_BYTES)


@dataclass(frozen=True, eq=False)
class SplitLines:
    """Lines of one width: the text, with end and length of each cell, column by column.

    So much stands before the lines in the text that what is looked at is there.
    """

    text: bytes
    ends: IndexArray
    lengths: IndexArray

    def numbers(self, indexes: Sequence[int], points: bytes) -> FloatArray | None:
        """Return some columns, None unless each is digits around one of the points at one place."""
        cell_ends, lengths = self.ends[list(indexes)], self.lengths[list(indexes)]
        signed = b"-" in self.text
        if signed:
            minus = np.frombuffer(self.text, np.uint8)[cell_ends - lengths] == ord("-")
            lengths -= minus
        indices_by_layout: dict[tuple[int, int], list[int]] = {}
        for index, (end, length) in enumerate(zip(cell_ends[:, 0], lengths[:, 0], strict=True)):
            first = self.text[end - length : end]
            at = max(map(first.find, points))
            # the point, and how many characters it and its decimals are
            indices_by_layout.setdefault(
                (first[at], len(first) - at) if at >= 0 else (0, 0), []
            ).append(index)
        values = np.empty(cell_ends.shape)
        for (point, digits_after), indices in indices_by_layout.items():
            number = self._parse_whole_numbers(
                cell_ends[indices].ravel(), lengths[indices].ravel(), point, digits_after
            )
            if number is None:
                return None
            values[indices] = (number / 10 ** max(digits_after - 1, 0)).reshape(len(indices), -1)
        if signed:
            np.negative(values, out=values, where=minus)
        return values.T

    def _parse_whole_numbers(
        self, end: IndexArray, length: IndexArray, point: int, digits_after: int
    ) -> IndexArray | None:
        """Return the digits of cells as whole numbers, None unless all are written so."""
        longest, has_point = int(length.max()), digits_after > 0
        if length.min() <= has_point or longest - has_point > _DIGITS:
            return None
        ending = np.ndarray(
            len(self.text) - _SEEN_BYTES + 1, f"V{_SEEN_BYTES}", self.text, strides=(1,)
        )
        words = ending[end - _SEEN_BYTES].view("<u8").reshape(-1, 2).T
        number = np.zeros(1, np.uint64)
        for stop, word, values in zip(
            (_WORD_BYTES, _SEEN_BYTES), words[::-1], _BYTE_MASKS, strict=True
        ):
            if longest > stop - _WORD_BYTES:
                digits = (word ^ _ZEROS) & values.take(length)
                if not _merge_digits(digits, stop - digits_after, point):
                    return None
                number = digits * 10 ** (stop - _WORD_BYTES) + number
        if has_point:  # which counts as a zero so far
            number -= number // 10**digits_after * (9 * 10 ** (digits_after - 1))
        return number.view(np.int64)


def _merge_digits(word: IndexArray, point_index: int, point: int) -> bool:
    """Make one number of eight digits, if they are, but for the point if its place is within."""
    if 0 <= point_index < _WORD_BYTES:
        point_byte = (point ^ ord("0")) << 8 * point_index
        if (word & 0xFF << 8 * point_index != point_byte).any():
            return False
        word ^= point_byte
    if int(np.bitwise_or.reduce((word + _TO_HIGH) | word)) & _HIGH:
        return False
    for by, bits, index in _DIGIT_PAIRS:
        word *= by
        word >>= bits
        word &= index
    return True


def split_line_cells(lines: bytes, sign: int) -> SplitLines | None:
    """Return lines split at a delimiter; None unless all have the same number of cells.

    Of blanks any number parts two cells, or stands before the first.
    """
    text = b" " * _SEEN_BYTES + lines
    codes = np.frombuffer(text, np.uint8)
    is_line_end, signs = codes == ord("\n"), codes == sign
    signs |= is_line_end
    if sign == ord(" "):
        turns = np.flatnonzero(signs[1:] != signs[:-1]) + 1
        cell_starts, stops = turns[::2], turns[1::2]
    else:
        stops = np.flatnonzero(signs)
        cell_starts = np.append(_SEEN_BYTES, stops[:-1] + 1)
    rows = int(np.count_nonzero(is_line_end))
    width, remainder = divmod(len(stops), rows) if rows else (0, 1)
    if remainder or not width or not is_line_end[stops[width - 1 :: width]].all():
        return None
    return SplitLines(text, stops.reshape(-1, width).T, (stops - cell_starts).reshape(-1, width).T)


# Blocks of plain rows, which NumPy reads: of one width, with nothing but numbers and times wanted.
#
# Columns of even decimals are read by their digits, and where all cells are numbers as JSON writes
# them, msgspec reads them in half the time. Both round as NumPy and Python do, to the nearest
# double; what they are not sure to read alike they never get.


_MIN_CHARACTERS = 1 << 19
"""Characters of tables, of all that a process reads, over which msgspec is worth its import."""
_NEGATIVE_ZERO = compile_on_use(rb"-0(?=[\s,])")
"""JSON has no negative integer zero: msgspec would read 0."""


class PlainRows:
    """Parser of blocks of plain rows for one dialect and some columns, where possible."""

    characters_read: ClassVar[int] = 0

    def __init__(
        self,
        dialect: Dialect,
        indexes: tuple[int, ...],
        clocks: Mapping[int, ClockColumn] | None = None,
    ) -> None:
        self.dialect = dialect
        self.indexes = indexes
        self.clocks = clocks or {}
        sign = dialect.delimiter
        self.blanks = sign == " "
        self.swaps_comma = dialect.mark != "."
        self.possible = (
            sign.isascii()
            and not sign.startswith("fixed")
            and not (self.blanks and self.clocks)
            and not (self.swaps_comma and sign == ",")
        )
        if self.possible and not self.blanks:
            s = re.escape(sign)
            # a blank cell becomes nan, whether alone, quoted or padded
            self.blank = compile_on_use(rf"(?:(?<={s})|(?<=\n)|\A)[ ]*(?={s}|\n)")
            self.next_to_blank = (" ", sign * 2, f"{sign}\n", f"\n{sign}", "\n\n")
            # a comma that parts no cells must not come to part them
            commas = "." if self.swaps_comma else "!"
            self.as_json = bytes.maketrans(f",{sign}\n".encode(), f"{commas},,".encode())
            self.groups = _grouped_between(s, dialect.mark)
        self.even = True
        """Whether all numbers so far have the decimals of their column's first."""
        self.commas: set[int] = set()
        """Places whose thousands commas part."""

    def read(self, text: str) -> FloatArray | None:
        """Return the numbers of whole lines, None if one of them is not surely a plain row."""
        unquoted = self._remove_quotes(text)
        if unquoted is None or not self.clocks:
            return None if unquoted is None else self._numbers_even_grouped(unquoted)
        cleaned_text, cells = self._without_clocks(unquoted)
        timestamps = {index: self.clocks[index].many(texts) for index, texts in cells.items()}
        if not timestamps or None in timestamps.values():
            return None
        values = self._numbers_even_grouped(cleaned_text)
        if values is not None:
            for index, moments in timestamps.items():
                values[:, index] = self.clocks[index].add(moments or ())
        return values

    def _without_clocks(self, text: str) -> tuple[str, dict[int, list[str]]]:
        """The text with zeros for clock times, and those by place; none where lines differ."""
        sign = self.dialect.delimiter
        rows = [line.split(sign) for line in text.split("\n")[:-1]]
        if len(set(map(len, rows))) != 1:
            return text, {}
        columns = {index: self.indexes[index] for index in self.clocks}
        if len(rows[0]) <= max(columns.values()):
            return text, {}
        cells = {index: [row[i].strip() for row in rows] for index, i in columns.items()}
        for row in rows:
            for i in columns.values():
                row[i] = "0"
        return "\n".join(map(sign.join, rows)) + "\n", cells

    def _numbers_even_grouped(self, unquoted: str) -> FloatArray | None:
        values = self._numbers(unquoted)
        if values is not None or self.blanks or self.groups is None:
            return values
        matches = list(self.groups.finditer(unquoted))
        values = self._numbers(self.groups.sub(_join_digit_groups, unquoted)) if matches else None
        if values is not None and self.dialect.mark == ".":
            codes = _codes(unquoted)
            cell_ends = np.flatnonzero((codes == ord(self.dialect.delimiter)) | (codes == 10))
            # a comma in quotes that parts no cells is a blank by now
            at = [match.end() for match in matches if "," in match[2] or " " in match[2]]
            width = int(np.searchsorted(cell_ends, unquoted.find("\n"))) + 1
            columns = set((np.searchsorted(cell_ends, at) % width).tolist())
            self.commas |= {index for index, i in enumerate(self.indexes) if i in columns}
        return values

    def _numbers(self, unquoted: str) -> FloatArray | None:
        # beside decimal commas points group the thousands
        if self.dialect.mark == "," and "." in unquoted:
            return None
        raw = _latin(unquoted)
        lines, width = None, len(self.dialect.contents)
        if self.even or not self.blanks:
            lines = split_line_cells(raw, ord(self.dialect.delimiter))
        if lines is not None and (len(lines.ends) < width or lines.lengths[width:].any()):
            lines = None
        if lines is not None and self.even:
            # between blanks a line with a word is no row, whatever column is wanted
            read = range(width) if self.blanks else self.indexes
            values = lines.numbers(read, self.dialect.mark.encode())
            if values is not None:
                return values[:, self.indexes] if self.blanks else values
            self.even = False
        if self.blanks:
            return self._parse(unquoted)
        if lines is None:
            return None
        values = self._from_json(raw, len(lines.ends) - width)
        if values is None:
            values = self._parse(unquoted)
        if values is None and self._has_blanks(unquoted):
            values = self._with_blanks(unquoted)
        return values

    def _has_blanks(self, text: str) -> bool:
        """Whether a cell is blank; first by its neighbours, for the pattern tries every place."""
        has_blank = any(name in text for name in self.next_to_blank)
        return (has_blank or text[:1] in {self.dialect.delimiter, "\n"}) and bool(
            self.blank.search(text)
        )

    def _with_blanks(self, text: str) -> FloatArray | None:
        """The numbers of lines with blank cells, None if one of the lines is blank, perhaps."""
        values = self._parse(self.blank.sub("nan", text))
        blank = values is not None and np.isnan(values).all(axis=1).any()
        return None if blank else values

    def _remove_quotes(self, text: str) -> str | None:
        """The text without quotes, a blank for each delimiter in them; None if a line ends there.

        None, too, where blanks part the cells. Only numbers are read of it: what is no Latin letter
        may be lost.
        """
        if '"' not in text:
            return text
        if self.blanks:
            return None
        sign = self.dialect.delimiter
        codes = _codes(text)
        quotes = np.flatnonzero(codes == ord('"'))
        signs = np.flatnonzero((codes == ord(sign)) | (codes == 10))
        if len(quotes) != 2 * len(signs):  # else all are quoted
            quoted_signs = signs[np.searchsorted(quotes, signs) % 2 == 1]
            if (codes[quoted_signs] == 10).any():
                return None
            if quoted_signs.size:
                codes = codes.copy()
                codes[quoted_signs] = 32
                text = codes.tobytes().decode("latin-1")
        return text.replace('"', "")

    def _from_json(self, raw: bytes, extra_cells: int) -> FloatArray | None:
        """Return the numbers of lines of one width, None unless each is written as JSON has it."""
        PlainRows.characters_read += len(raw)
        if PlainRows.characters_read < _MIN_CHARACTERS and "msgspec" not in sys.modules:
            return None
        sign = self.dialect.delimiter.encode()
        if extra_cells > 1:
            raw = raw.replace(sign * extra_cells + b"\n", sign + b"\n")
        text = _NEGATIVE_ZERO.sub(
            b"-0.0", raw.translate(self.as_json, b"\n" if extra_cells else b"")
        )
        import msgspec  # not before it pays

        try:
            numbers = _decode()(b"[%b]" % text[:-1])
        except (ValueError, msgspec.MsgspecError):
            return None
        if not numbers:  # blank lines
            return None
        values = np.frombuffer(struct.pack(f"{len(numbers)}d", *numbers))
        return values.reshape(-1, len(self.dialect.contents))[:, self.indexes]

    def _parse(self, text: str) -> FloatArray | None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "no data": a block of blank lines
            try:
                values = np.loadtxt(
                    io.StringIO(text.replace(",", ".") if self.swaps_comma else text),
                    delimiter=None if self.blanks else self.dialect.delimiter,
                    comments=None,
                    ndmin=2,
                    usecols=None if self.blanks else self.indexes,
                )
            except (ValueError, IndexError, OverflowError):
                return None
        if len(values) != line_count(text):  # blank lines: the line numbers would be wrong
            return None
        if self.blanks:
            if values.shape[1] != len(self.dialect.contents):
                return None
            values = values[:, list(self.indexes)]
        return values


def _grouped_between(sign: str, decimal_mark: cell.Mark) -> re.Pattern[str] | None:
    """Finds cells with grouped thousands; none where both marks are decimal."""
    if decimal_mark not in cell.GROUPS:
        return None
    digits, rest = r"[ ]*+[+-]?[1-9]\d{0,2}", rf"(?:{re.escape(decimal_mark)}\d*+)?[ ]*+"
    return compile_on_use(
        rf"((?:(?<=[{sign}\n])|\A){digits})({cell.GROUPS[decimal_mark]})(?={rest}[{sign}\n])"
    )


def _join_digit_groups(match: re.Match[str]) -> str:
    return match[1] + "".join(filter(str.isdigit, match[2]))


@cache
def _decode() -> Callable[[bytes], list[float]]:
    import msgspec  # what a single file of usual size need not wait for

    return msgspec.json.Decoder(list[float]).decode


def line_count(text: str) -> int:
    """Return how many lines end in a text."""
    return int(np.count_nonzero(_codes(text) == 10))


def _codes(text: str) -> np.ndarray:
    return np.frombuffer(_latin(text), dtype=np.uint8)


def _latin(text: str) -> bytes:
    return text.encode("latin-1", "replace")
