"""Dialect of a delimited text: encoding, position of the table, separators."""

from __future__ import annotations

import codecs
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain, islice, product, zip_longest

from dashpot.base import dataclass, replace
from dashpot.base.errors import ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.reading.columns import vocabulary
from dashpot.reading.table import Content
from dashpot.reading.text import cells as cell
from dashpot.reading.text.cells import Mark, parse_clock_or_date, parse_clock_time

# Position of the table, and separators.


_DELIMITERS = ("\t", ";", ",", "|", " ", ":")
_MARKS: tuple[Mark, ...] = (".", ",", ".,")
_SAMPLE = 60
MAX_LENGTH = 1 << 21
"""Characters in a row or a heading; a longer line is neither."""
COLUMNS = 100_000
"""Cells of a line by which a table is looked for."""
_SAMPLED = 1 << 18
"""Characters of a window of lines, which are fewer where they are long."""
_ALIGNED = 1 << 13
"""Characters of a row of fixed width; nobody aligns a longer one."""
_DIGITS = set("0123456789+-.,:eE")
_DIGIT_SAMPLE_ROWS = 5
"""Rows that show how many digits all are printed with."""
_PARTS = compile_on_use(r"[\t;,| ]+")


@dataclass(frozen=True)
class Dialect:
    """Dialect of the rows of a table.

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
    cells : int
        Cells in most rows, blank ones at the end counted; 0 if that is not known.
    """

    delimiter: str
    mark: Mark
    contents: tuple[Content, ...]
    first: int = 0
    cells: int = 0

    @cached_property
    def numbers(self) -> tuple[int, ...]:
        """The columns of numbers or clock times."""
        return tuple(i for i, content in enumerate(self.contents) if content in {"number", "clock"})

    @cached_property
    def _has_clock(self) -> bool:
        return "clock" in self.contents

    def row(self, line: str, template: str = "") -> list[str] | None:
        """Return the cells of a line, one per column, if it is a row of the table; else None.

        Where blanks part the cells, a full row like `template` shows which are blank.
        """
        if len(line) > MAX_LENGTH:
            return None
        parts = cell.split(line, self.delimiter, trim=False)
        if self.delimiter == " " and len(parts) < self.cells:
            parts = cell.split_by_alignment(line, template)
        has_all_cells, width = len(parts) == self.cells, len(self.contents)
        if not cell.drop_trailing_blanks(parts) or not (has_all_cells or self._ends_well(parts)):
            return None
        if self.contents[0] == "blank" and parts[0] and not cell.is_number(parts[0], self.mark):
            return None  # a word where every row is blank: a key of the header
        parts = parts[:width] + [""] * (width - len(parts))
        return parts if self._is_plain(parts) or self._has_numbers(parts) else None

    def _ends_well(self, names: Sequence[str]) -> bool:
        """Return whether a row of another width has all its numbers, and no number behind them."""
        following_names = names[len(self.contents) :]
        reaches_last_number = not self.numbers or len(names) > self.numbers[-1]
        return reaches_last_number and not any(
            cell.is_number(c, self.mark) for c in following_names
        )

    def _is_plain(self, names: Sequence[str]) -> bool:
        """Return whether there is a plain number wherever one is expected."""
        return not self._has_clock and cell.are_plain([names[i] for i in self.numbers], self.mark)

    def _has_numbers(self, names: Sequence[str]) -> bool:
        """Whether there are numbers enough, and more than words, where numbers are expected."""
        filled = blank = words = stated_count = 0
        for i in self.numbers:
            if self._is_value(names[i], i):
                filled += 1
                if 2 * filled > len(self.numbers):  # whatever the others hold
                    return True
            elif cell.is_missing(names[i]):
                blank += 1
                stated_count += any(map(str.isalpha, names[i]))
            elif i == self.numbers[0]:
                return False  # "Mean;1.2;3.4"
            else:
                words += 1
        if stated_count and stated_count == len(self.numbers):  # NaN in every place
            return True
        # a heading that holds a number or two has more words than numbers
        return filled > words and 2 * (filled + blank) > len(self.numbers)

    def resembles_row(self, line: str) -> bool:
        """Return whether a line that is no row begins or is filled with numbers, however parted."""
        parts = Counter(part.strip('"') for part in _PARTS.split(line[:MAX_LENGTH].strip()))
        numbers = sum(count for part, count in parts.items() if looks_like_number(part))
        words = sum(count for part, count in parts.items() if not cell.is_missing(part)) - numbers
        if numbers > words and (numbers >= len(self.numbers) or words == 0 < numbers - 1):
            return True
        cells = cell.split(line, self.delimiter)
        return self.delimiter != " " and len(cells) > 1 and looks_like_number(cells[0])

    def is_cut_off(self, lines: Sequence[str]) -> bool:
        """Return whether the last number of the last line has fewer decimals than the others.

        Too few are fewer than all rows before it have, at least four.
        """
        rows = [line for line in lines if line.strip()]
        if len(rows) < _DIGIT_SAMPLE_ROWS:
            return False
        before, last = (self._decimals(line) for line in rows[-2:])
        if not (before and last) or last[:-1] != before[:-1]:
            return False
        last_cell_before, shorter = before[-1], last[-1]
        if last_cell_before is None or shorter is None or shorter >= last_cell_before:
            return False
        return all(self._decimals(line)[-1:] == [last_cell_before] for line in rows[:-2])

    def _decimals(self, line: str) -> list[int | None]:
        return [decimals(text, self.mark) for text in cell.split(line, self.delimiter)]

    def _is_value(self, text: str, column: int) -> bool:
        """Return whether :meth:`value` finds one."""
        if self.contents[column] == "clock":
            return parse_clock_or_date(text) is not None
        return cell.is_number(text, self.mark)

    def value(self, text: str, column: int) -> float | None:
        """Return the number in a cell of a column, or None."""
        if self.contents[column] == "clock":
            timestamp = parse_clock_or_date(text)
            return None if timestamp is None else timestamp.seconds
        return cell.number(text, self.mark)


def find_dialect(
    lines: Sequence[str], *, delimiter: str | None = None, decimal: str | None = None
) -> Dialect | None:
    """Return the dialect of the longest table in the lines, or None if there is no table.

    Every delimiter and decimal mark is tried on lines from the start, the middle and the end;
    the pair under which most cells of equally wide neighbouring lines are numbers is taken.
    """
    windows = list(_windows(lines))
    decimal_marks = [decimal_mark for decimal_mark in _MARKS if decimal in {None, decimal_mark}]
    signs = _delimiters(windows, delimiter)
    plain_dialects = [_find_plain_dialect(window, signs, decimal_marks) for window in windows]
    cell_counts = [
        len(window) * dialect.cells if dialect else 0
        for dialect, window in zip(plain_dialects, windows, strict=True)
    ]
    best = plain_dialects[cell_counts.index(max(cell_counts))] if cell_counts else None
    highest: float = max(cell_counts, default=0)
    rest = [
        window for dialect, window in zip(plain_dialects, windows, strict=True) if dialect is None
    ]
    max_numbers = {sign: [_most_numbers(sign, window) for window in rest] for sign in signs}
    for sign, decimal_mark, (i, window) in product(signs, decimal_marks, enumerate(rest)):
        if max_numbers[sign][i] > highest:
            score, dialect = _find_best_run(window, sign, decimal_mark, min_score=highest)
            if dialect is not None:
                highest, best = score, dialect
    dialect = None if best is None else _extend_to_first_row(lines, best)
    if dialect is not None and (dialect.mark, decimal) == (".", None) and dialect.delimiter != ",":
        dialect = _determine_decimal_mark(lines, dialect)
    return None if dialect is None else _fill_blank_columns(lines, dialect)


def is_overlong(line: str) -> bool:
    """Return whether a line has more characters or cells than are looked at."""
    return len(line) > MAX_LENGTH or (len(line) > COLUMNS and most_cells(line) > COLUMNS)


def most_cells(line: str) -> int:
    """Return the cells of a line by the delimiter that makes the most."""
    return 1 + max(map(line.count, _DELIMITERS))


def _fill_blank_columns(lines: Sequence[str], dialect: Dialect) -> Dialect:
    """The dialect, with the columns that were blank where it was found and hold numbers elsewhere.

    Such is a temperature that is written once for each block.
    """
    blank_row: tuple[Content, ...] = ("blank",)
    contents = (*dialect.contents, *blank_row * (dialect.cells - len(dialect.contents)))
    blank = [i for i, content in enumerate(contents) if content == "blank"]
    if not blank or dialect.delimiter == " ":
        return dialect
    texts: dict[int, list[str]] = {i: [] for i in blank}
    for line in lines[dialect.first :]:
        row = cell.split(line, dialect.delimiter, trim=False)
        if len(row) == len(contents):
            for i in blank:
                texts[i] += filter(None, [row[i]])
    contents_by_column = {i: _content(texts[i], dialect.mark) for i in blank if texts[i]}
    filled = {i: name for i, name in contents_by_column.items() if name in {"number", "clock"}}
    if not filled:
        return dialect
    width = max(len(dialect.contents), max(filled) + 1)
    merged = tuple(filled.get(i, content) for i, content in enumerate(contents[:width]))
    return replace(dialect, contents=merged)


def _determine_decimal_mark(lines: Sequence[str], dialect: Dialect) -> Dialect:
    """The dialect with a decimal comma, if more rows have it: 0,000 above 1,234 shows which."""
    other = replace(dialect, mark=",")
    if not any(other.row(line) for line in lines[: dialect.first]):
        return dialect
    other = _extend_to_first_row(lines, other) or dialect
    return other if other.first < dialect.first else dialect


def _delimiters(windows: Sequence[Sequence[str]], text: str | None) -> tuple[str, ...]:
    """Return the delimiters to try: the one given, else all, and a fixed width."""
    if text == "fixed":
        return tuple(dict.fromkeys(map(_find_column_breaks, windows)))
    if text is not None:
        return (text,)
    if any(map(_has_groups, windows)):
        return tuple(sign for sign in _DELIMITERS if sign != " ")
    aligned = [window for window in windows if any(" " in line for line in window)]
    return tuple(
        dict.fromkeys((*_DELIMITERS, *(_find_column_breaks(_digits(window)) for window in aligned)))
    )


def _has_groups(window: Sequence[str]) -> bool:
    """Whether blanks between the numbers in cells that tabs part group thousands, all of them."""
    lines = (line for line in window if "\t" in line and len(line.split()) > 1 + line.count("\t"))
    texts = chain.from_iterable(cell.split(line, "\t") for line in lines)
    grouped_texts = [text for text in texts if len(text.split()) > 1]
    numbers = [text for text in grouped_texts if all(map(looks_like_number, text.split()))]
    return bool(numbers) and all(
        cell.is_number(text, ".") or cell.is_number(text, ",") for text in numbers
    )


def _find_plain_dialect(
    window: Sequence[str], signs: Sequence[str], decimal_marks: Sequence[Mark]
) -> Dialect | None:
    """Return the dialect if every cell of a window is a plain number, else None.

    No other makes more of it: in plain numbers stands no delimiter but their comma.
    """
    for sign in signs if window else ():
        if sign == " " or sign.startswith("fixed:") or not all(sign in line for line in window):
            continue
        rows = [cell.split(line, sign, trim=False) for line in window]
        width = len(rows[0])
        if any(len(row) != width for row in rows):
            continue
        cells = [*chain.from_iterable(rows)]
        for decimal_mark in decimal_marks:
            # under a point 1,234 may be a thousand
            if cell.are_plain(cells, decimal_mark) and (
                decimal_mark == "." or not all(all(cell.numeric(row, ".")) for row in rows)
            ):
                cell_contents: list[Content] = ["number"] * width
                return Dialect(sign, decimal_mark, tuple(cell_contents), cells=width)
    return None


def _most_numbers(sign: str, window: Sequence[str]) -> int:
    """Return the largest possible count of numbers of a window for a delimiter."""
    if sign == " " or sign.startswith("fixed:"):
        widest = max((len(line.split()) + line.count('"') for line in window), default=0)
        return len(window) * max(widest, 1 + sign.count(",") + (sign != " "))
    widest = max((line.count(sign) for line in window), default=0)
    return len(window) * (1 + widest) if widest else 0


def _windows(lines: Sequence[str]) -> Iterator[list[str]]:
    first = [*islice(filter(_is_looked_at, lines), 3 * _SAMPLE + 1)]
    if len(first) <= 3 * _SAMPLE:
        yield _sample_lines(first)
        return
    for part in (0.3, 0.6, 1.0):
        before = reversed(lines[: int(part * len(lines))])
        window = [*islice(filter(_is_looked_at, before), _SAMPLE)][::-1]
        yield _sample_lines(window if len(window) == _SAMPLE else first[:_SAMPLE])


def _is_looked_at(line: str) -> bool:
    return bool(line.strip()) and (len(line) <= COLUMNS or not is_overlong(line))


def _sample_lines(window: list[str]) -> list[str]:
    """Return the lines of a window: of thousands of columns the last few are enough."""
    size, count = 0, 0
    while count < len(window) and (count < _DIGIT_SAMPLE_ROWS or size < _SAMPLED):
        count += 1
        size += len(window[-count])
    return window[len(window) - count :]


def _find_best_run(
    lines: Sequence[str], sign: str, decimal_mark: Mark, *, min_score: float
) -> tuple[float, Dialect | None]:
    """Score and dialect of the best run of lines of one width, if it scores above `min_score`."""
    rows = [cell.split(line, sign, trim=False) for line in lines]
    best: tuple[float, Dialect | None] = (min_score, None)
    for run in _runs(rows, decimal_mark):
        score, dialect = _score_run(run, sign, decimal_mark, min_score=best[0])
        if dialect.numbers and score > best[0]:
            best = score, dialect
    return best


def _score_run(
    run: Sequence[list[str]], sign: str, decimal_mark: Mark, *, min_score: float
) -> tuple[float, Dialect]:
    """Return the score of a run of lines as a table, exact above `min_score`, and its dialect."""
    cells = Counter(map(len, run)).most_common(1)[0][0]
    columns = [[*filter(None, column)] for column in list(zip_longest(*run))[:cells]]
    contents = [_content(column, decimal_mark) for column in columns]
    while contents and contents[-1] == "blank":
        contents.pop()
    dialect = Dialect(sign, decimal_mark, tuple(contents), cells=cells)
    if len(run) * len(dialect.numbers) <= min_score:  # even without a word
        return min_score, dialect
    texts = (columns[i] for i, content in enumerate(contents) if content == "text")
    words = sum(2.0 if _hides_numbers(column) else 0.5 for column in texts)
    # a lone number on each of a few lines is a header more often than a table
    lone = 0.5 if len(dialect.numbers) == 1 else 0.0
    return len(run) * (len(dialect.numbers) - words - lone), dialect


def decimals(text: str, decimal_mark: Mark) -> int | None:
    """Return the number of digits after the decimal mark; None if the cell is no number."""
    if not cell.is_number(text, decimal_mark):
        return None
    mark_index = max(map(text.rfind, decimal_mark))
    return len(text) - mark_index - 1 if mark_index >= 0 else 0


def looks_like_number(text: str) -> bool:
    """Whether a cell is made of digits and their marks: a number, a time, two glued numbers."""
    return not text.isalpha() and set(text) <= _DIGITS and any(map(str.isdigit, text))


def _hides_numbers(cells: Sequence[str]) -> bool:
    """Return whether most words of a column are numbers that another delimiter would part."""
    parts = [[part for part in _PARTS.split(text) if part] for text in cells]
    glued = sum(len(part) > 1 and all(map(looks_like_number, part)) for part in parts)
    return 2 * glued > len(cells)


def _runs(rows: Sequence[list[str]], decimal_mark: Mark) -> Iterator[list[list[str]]]:
    """Runs of neighbouring rows that could belong to one table."""
    run: list[list[str]] = []
    mask: list[bool] = []
    for row in rows:
        is_number = cell.numeric(row, decimal_mark)
        if not all(is_number):
            is_number = [
                is_numeric or parse_clock_time(c) is not None
                for is_numeric, c in zip(is_number, row, strict=True)
            ]
        if run and any(is_number) and _is_similar_row(mask, is_number, row):
            run.append(row)
            mask += is_number[len(mask) :]
            continue
        if run:
            yield run
        run, mask = ([row], is_number) if any(is_number) else ([], [])
    if run:
        yield run


def _is_similar_row(mask: list[bool], is_number: list[bool], row: list[str]) -> bool:
    """Return whether a row fits under those before it: numbers or blanks where numbers were."""
    if abs(len(mask) - len(is_number)) > max(1, len(mask) // 2):
        return False
    fits = hits = 0
    for was_number, is_now_number, text in zip(mask, is_number, row, strict=False):
        fits += was_number == is_now_number or cell.is_missing(text)
        hits += was_number and is_now_number
    shared = min(len(mask), len(row))
    return hits > 0 and fits >= shared - (shared > 2)


def _content(cells: Sequence[str], decimal_mark: Mark) -> Content:
    """Return the content of most filled cells of a column."""
    if cell.are_plain(cells, decimal_mark):
        return "number"
    other_texts = [text for text in cells if not cell.is_number(text, decimal_mark)]
    numbers = len(cells) - len(other_texts)
    missing = sum(map(cell.is_missing, other_texts))
    clocks = sum(parse_clock_time(text) is not None for text in other_texts)
    if missing == len(cells):
        return "blank"
    if clocks > numbers and clocks + missing >= 0.6 * len(cells):
        return "clock"
    return "number" if numbers + missing >= 0.6 * len(cells) else "text"


def _extend_to_first_row(lines: Sequence[str], dialect: Dialect) -> Dialect | None:
    """Return the same dialect with the first line of its first steady run of rows."""
    needed_rows, first, steady = 3, -1, 0
    fallback = -1
    for i, line in enumerate(lines):
        if not line.strip():
            continue
        row = dialect.row(line)
        if row is None or (not steady and row == [str(i + 1) for i in range(len(row))]):
            first, steady = -1, 0  # 1;2;3 numbers the columns
            continue
        if steady == 0:
            first = i
            fallback = i if fallback < 0 else fallback
        steady += 1
        if steady == needed_rows:
            return replace(dialect, first=first)
    return replace(dialect, first=fallback) if fallback >= 0 else None


def _digits(lines: Sequence[str]) -> list[str]:
    """Return the lines with digits and hardly a word."""
    return [
        line
        for line in lines
        if "\t" not in line and sum(map(str.isdigit, line)) > 2 * sum(map(str.isalpha, line))
    ]


def _find_column_breaks(lines: Sequence[str]) -> str:
    """Column breaks where every line is blank and the next character is not."""
    width = max((len(line) for line in lines), default=0)
    if width > _ALIGNED:
        return " "
    blank = [all(i >= len(line) or line[i] == " " for line in lines) for i in range(width)]
    start = blank.index(False) if False in blank else width
    breaks = [i for i in range(start + 1, width) if blank[i - 1] and not blank[i]]
    return "fixed:" + ",".join(map(str, breaks)) if breaks else " "


# Encoding: only names and units depend on it, never the digits.


_BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip
_LONGEST_LINE = 1 << 23
_EIGHT_BIT = ("cp1252", "cp1250", "cp1254", "cp1251", "cp932", "cp949", "big5")


def find_encoding(head: bytes) -> str:
    """Return the codec for the first bytes of a text file.

    Byte-order marks, then UTF-16 by its zero bytes, then strict UTF-8, then the code page under
    which most of the words are words that a test machine says.
    """
    for byte_order_mark, name in _BYTE_ORDER_MARKS:
        if head.startswith(byte_order_mark):
            return name
    zeros = head.count(0) if 0 in head else 0
    if zeros > 0.2 * len(head):
        name = "utf-16-le" if head[1::2].count(0) >= head[0::2].count(0) else "utf-16-be"
        text = head[: len(head) // 2 * 2].decode(name, "replace")
        plain_count = sum(" " <= c < "\u02ff" or c in "\t\r\n" for c in text)
        return name if plain_count > 0.7 * len(text) else "utf-8"
    if head.isascii():
        return "utf-8"
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return _code_page(head)
    return "utf-8"


def _code_page(head: bytes) -> str:
    # only lines with a letter beyond ASCII can show, and the first few hundred are enough
    lines = head.splitlines()
    # the last may be cut within a character
    whole_lines = lines[:-1] if len(lines) > 1 and not head.endswith((b"\r", b"\n")) else lines
    not_ascii = b"\n".join([line for line in whole_lines if not line.isascii()][:200])
    scored = []
    for rank, name in enumerate(("gb18030", *_EIGHT_BIT)):
        try:
            text = not_ascii.decode(name)
        except UnicodeDecodeError:
            continue
        scored.append((_score_text(text, name), -rank, name))
    return max(scored)[2] if scored else "latin-1"


def _score_text(text: str, codec: str) -> float:
    """Return how much a decoded text reads like names and units of a lab."""
    words = (word for word in re.findall(r"[^\W\d_]+", text) if not word.isascii())
    score = sum((weight * count(word, codec) for word in words for weight, count in _WORDS), 0.0)
    rest, unit_count = _UNITS.subn("", text)
    return score + unit_count - 2.0 * len(_DEBRIS.findall(rest))


def _eastern(word: str) -> int:
    return sum(c > "\u2e80" for c in word)


_WORDS: tuple[tuple[float, Callable[[str, str], float]], ...] = (
    (10.0, lambda word, _: word.casefold() in vocabulary.FIRST),
    # half a word in Chinese is a European word misread
    (-3.0, lambda word, _: 0 < _eastern(word) < max(2, len(word))),
    # of GB 2312: in the rest of GBK the second byte may be an ASCII character, the C of a degree
    (
        1.0,
        lambda word, codec: (
            codec == "gb18030" and len(word.encode("gb2312", "ignore")) == 2 * len(word) > 2
        ),
    ),
    (-0.5, lambda word, _: any(map(str.isupper, word[1:])) and any(map(str.islower, word))),
    (-0.2, lambda word, _: sum(c in "þðýÞÐÝ" for c in word)),
    (-0.3, lambda word, _: sum("\u0400" <= c <= "\u04ff" for c in word) * (len(word) < 3)),
)
"""Evidence of non-ASCII words for a code page, with weights."""
_UNITS = compile_on_use(r"(?:°[CF]?|[µμ][mNsV]|(?<![A-Za-zÀ-ɏ])[cdkm]?[ms][²³])(?![^\W\d_])")
_DEBRIS = compile_on_use(r"(?<=[^\W\d_])[³¹¿œŸž¡£¥]|[¤¦¨¸¯](?=\w)|[\x80-\x9f\ufffd\ue000-\uf8ff]")


def decode_blocks(
    blocks: Iterable[bytes], encoding: str, *, detected: bool = False
) -> Iterator[str]:
    """Decode blocks of bytes to text with one kind of line end, each ending with a line end.

    Where the encoding was `detected`, not given, a stray byte becomes a question mark: it stands in
    a word, never in a number.

    Raises
    ------
    ReadError
        If the bytes are not in it.
    """
    decoder = codecs.getincrementaldecoder(encoding)("replace" if detected else "strict")
    rest = ""
    try:
        for block in blocks:
            text = rest + decoder.decode(block)
            ended = text.rstrip("\r")  # what follows them shows what they end
            complete_length = max(ended.rfind("\n"), ended.rfind("\r")) + 1
            rest = text[complete_length:]
            if complete_length:
                yield _ends(text[:complete_length])
            elif len(rest) > _LONGEST_LINE:
                raise ReadError(
                    f"a line of more than {_LONGEST_LINE >> 20} million characters; this is no "
                    "text of rows, or its line ends were lost: export it again"
                )
        rest += decoder.decode(b"", final=True)
    except UnicodeDecodeError as error:
        raise ReadError(
            f"byte 0x{error.object[error.start]:02X} is not {encoding}; "
            "give the file's encoding with --text-format encoding=cp1252"
        ) from None
    except UnicodeError as error:  # such as UTF-16 without the mark that it begins with
        raise ReadError(
            f"the text is not {encoding} ({error}); give the file's encoding, for example "
            "--text-format encoding=cp1252, or leave it out"
        ) from None
    if rest:
        yield _ends(rest) + "\n"


def _ends(text: str) -> str:
    if "\u2212" in text:
        text = text.replace("\u2212", "-")  # a typeset minus
    if "\ufeff" in text:
        text = text.replace("\ufeff", "")  # where files were joined
    if "\r" not in text:
        return text
    text = text.replace("\r\n", "\n")
    return text if "\r" not in text else re.sub(r"(?<!\r)\r+\n", "\n", text).replace("\r", "\n")
