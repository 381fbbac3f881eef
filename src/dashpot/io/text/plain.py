"""Blocks of plain rows, which NumPy reads: all of one width, with nothing but numbers wanted."""

from __future__ import annotations

import io
import re
import warnings

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.io.text.dialect import Dialect


class PlainRows:
    """Reads whole blocks for one dialect and one choice of columns, or says that it cannot."""

    def __init__(self, dialect: Dialect, indexes: tuple[int, ...]) -> None:
        self.dialect = dialect
        self.indexes = indexes
        sign = dialect.delimiter
        self.blanks = sign == " "
        self.swaps_comma = dialect.mark != "."
        self.possible = (
            not sign.startswith("fixed")
            and not any(dialect.contents[i] == "clock" for i in indexes)
            and not (self.swaps_comma and sign == ",")
        )
        if len(sign) == 1 and not self.blanks:
            s = re.escape(sign)
            # a blank cell becomes nan, whether alone, quoted or padded
            self.blank = re.compile(rf"(?:(?<={s})|(?<=\n)|\A)[ ]*(?={s}|\n)")

    def read(self, text: str) -> FloatArray | None:
        """Return the numbers of whole lines, None if one of them is not surely a plain row."""
        if '"' in text:
            unquoted = None if self.blanks else self._unquoted(text)
            if unquoted is None:
                return None
            text = unquoted
        if self.swaps_comma:
            if "." in text and self.dialect.mark == ",":  # points group the thousands
                return None
            text = text.replace(",", ".")
        if self.blanks:
            return self._parse(text)
        if not self._same_width(text):
            return None
        values = self._parse(text)
        if values is None and self.blank.search(text):
            values = self._parse(self.blank.sub("nan", text))
            if values is not None and np.isnan(values).all(axis=1).any():  # a blank line, perhaps
                return None
        return values

    def _unquoted(self, text: str) -> str | None:
        """The text without quotes, a blank for each delimiter in them; None if a line ends there.

        Only numbers are read of it: what is no Latin letter may be lost.
        """
        sign = self.dialect.delimiter
        if text.count('"') != 2 * (text.count(sign) + text.count("\n")):  # else all are quoted
            codes = _codes(text).copy()
            quotes = np.flatnonzero(codes == ord('"'))
            signs = np.flatnonzero((codes == ord(sign)) | (codes == 10))
            inside = signs[np.searchsorted(quotes, signs) % 2 == 1]
            if (codes[inside] == 10).any():
                return None
            if inside.size:
                codes[inside] = 32
                text = codes.tobytes().decode("latin-1")
        return text.replace('"', "")

    def _same_width(self, text: str) -> bool:
        """Whether every line has the delimiters of the table, and only blank cells behind it."""
        codes = _codes(text)
        ends = np.flatnonzero(codes == 10)
        signs = np.flatnonzero(codes == ord(self.dialect.delimiter))
        counts = np.diff(np.searchsorted(signs, ends), prepend=0)
        if not (len(counts) > 0 and bool((counts == counts[0]).all())):
            return False
        more = int(counts[0]) - (len(self.dialect.contents) - 1)
        behind = self.dialect.delimiter * more + "\n"
        return more == 0 or (more > 0 and text.count(behind) == len(counts))

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


def _codes(text: str) -> np.ndarray:
    return np.frombuffer(text.encode("latin-1", "replace"), dtype=np.uint8)
