"""Numbers of a whole column at once, where all have as many decimals: their digits, read as words.

Eight characters are one word of a processor, and three products of words make eight digits one
number. Up to fifteen digits and a power of ten are exact doubles, so that their quotient is the
nearest double, as Python's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray

_WORD, _SEEN = 8, 16
"""Characters of a word, and of the end of each cell that are looked at."""
_DIGITS = 15
_ZEROS, _TO_HIGH, _HIGH = (int(pair * _WORD, 16) for pair in ("30", "76", "80"))


_TOGETHER = (
    (10 * 2**8 + 1, 8, 0x00FF00FF00FF00FF),
    (100 * 2**16 + 1, 16, 0x0000FFFF0000FFFF),
    (10_000 * 2**32 + 1, 32, 0xFFFFFFFF),
)
"""How digits become twos, fours and eight: the earlier count so many times, and which bits stay."""


def _make_byte_masks(stop: int) -> IndexArray:
    """The bits of a word that are a cell's, by its length; it begins `stop` before the end."""
    others = (min(max(stop - length, 0), _WORD) for length in range(_SEEN + 1))
    return np.array([2**64 - 2 ** (8 * other) for other in others], np.uint64)


_KEPT = _make_byte_masks(_WORD), _make_byte_masks(_SEEN)


@dataclass(frozen=True, eq=False)
class PartedLines:
    """Lines of one width: the text, where each cell ends and its length, column by column.

    So much stands before the lines in the text that what is looked at is there.
    """

    text: bytes
    ends: IndexArray
    lengths: IndexArray

    def numbers(self, indexes: Sequence[int], points: bytes) -> FloatArray | None:
        """Return some columns, None unless each is digits around one of the points at one place."""
        ends, lengths = self.ends[list(indexes)], self.lengths[list(indexes)]
        signed = b"-" in self.text
        if signed:
            minus = np.frombuffer(self.text, np.uint8)[ends - lengths] == ord("-")
            lengths -= minus
        alike: dict[tuple[int, int], list[int]] = {}
        for place, (end, length) in enumerate(zip(ends[:, 0], lengths[:, 0], strict=True)):
            first = self.text[end - length : end]
            at = max(map(first.find, points))
            # the point, and how many characters it and its decimals are
            alike.setdefault((first[at], len(first) - at) if at >= 0 else (0, 0), []).append(place)
        values = np.empty(ends.shape)
        for (point, behind), places in alike.items():
            number = self._parse_whole_numbers(
                ends[places].ravel(), lengths[places].ravel(), point, behind
            )
            if number is None:
                return None
            values[places] = (number / 10 ** max(behind - 1, 0)).reshape(len(places), -1)
        if signed:
            np.negative(values, out=values, where=minus)
        return values.T

    def _parse_whole_numbers(
        self, end: IndexArray, length: IndexArray, point: int, behind: int
    ) -> IndexArray | None:
        """The digits of cells as whole numbers, None unless all are written so."""
        longest, pointed = int(length.max()), behind > 0
        if length.min() <= pointed or longest - pointed > _DIGITS:
            return None
        ending = np.ndarray(len(self.text) - _SEEN + 1, f"V{_SEEN}", self.text, strides=(1,))
        words = ending[end - _SEEN].view("<u8").reshape(-1, 2).T
        number = np.zeros(1, np.uint64)
        for stop, word, values in zip((_WORD, _SEEN), words[::-1], _KEPT, strict=True):
            if longest > stop - _WORD:
                digits = (word ^ _ZEROS) & values.take(length)
                if not _merge_digits(digits, stop - behind, point):
                    return None
                number = digits * 10 ** (stop - _WORD) + number
        if pointed:  # which counts as a zero so far
            number -= number // 10**behind * (9 * 10 ** (behind - 1))
        return number.view(np.int64)


def _merge_digits(word: IndexArray, place: int, point: int) -> bool:
    """Make one number of eight digits, if they are, but for the point if its place is within."""
    if 0 <= place < _WORD:
        stands = (point ^ ord("0")) << 8 * place
        if (word & 0xFF << 8 * place != stands).any():
            return False
        word ^= stands
    if int(np.bitwise_or.reduce((word + _TO_HIGH) | word)) & _HIGH:
        return False
    for by, bits, index in _TOGETHER:
        word *= by
        word >>= bits
        word &= index
    return True


def split_line_cells(lines: bytes, sign: int) -> PartedLines | None:
    """Return whole lines whose cells a sign parts, None unless all have as many.

    Of blanks any number parts two cells, or stands before the first.
    """
    text = b" " * _SEEN + lines
    codes = np.frombuffer(text, np.uint8)
    ended, signs = codes == ord("\n"), codes == sign
    signs |= ended
    if sign == ord(" "):
        turns = np.flatnonzero(signs[1:] != signs[:-1]) + 1
        begins, ends = turns[::2], turns[1::2]
    else:
        ends = np.flatnonzero(signs)
        begins = np.append(_SEEN, ends[:-1] + 1)
    rows = int(np.count_nonzero(ended))
    width, odd = divmod(len(ends), rows) if rows else (0, 1)
    if odd or not width or not ended[ends[width - 1 :: width]].all():
        return None
    return PartedLines(text, ends.reshape(-1, width).T, (ends - begins).reshape(-1, width).T)
