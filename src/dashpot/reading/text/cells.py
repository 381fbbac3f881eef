"""Cells of a text table: number, complex number, clock time, missing value or word."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.lazy import compile_on_use
from dashpot.reading.columns.header_units import remove_quotes, split_unit
from dashpot.reading.table import Question

# Numbers, missing values and words.


Mark: TypeAlias = Literal[".", ",", ".,"]
"""Decimal mark; ``".,"`` is a file that uses both, one per cell."""

_NUMBER_PATTERNS: dict[Mark, str] = {
    ".": r"[+-]?(?:\d++\.?\d*+|\.\d++)",
    ",": r"[+-]?(?:\d++(?:,\d++)?|,\d++)",
    ".,": r"[+-]?(?:\d++[.,]?\d*+|[.,]\d++)",
}
_EXPONENT = r"(?:[eEdD][+-]?\d{1,4})?"
_PLAIN = {
    decimal_mark: compile_on_use(rf"\A{name}{_EXPONENT}\Z")
    for decimal_mark, name in _NUMBER_PATTERNS.items()
}
_ALL_PLAIN = {
    decimal_mark: compile_on_use(rf"\A(?:{name}{_EXPONENT}\n)++\Z")
    for decimal_mark, name in _NUMBER_PATTERNS.items()
}
# a group that gives nothing back (`)++`) is lost in Python 3.11.2 from the second match on
GROUPS: dict[Mark, str] = {
    ".": r"(?:[,'\u2019 \u00a0\u2009\u202f]\d{3})+",
    ",": r"(?:[.'\u2019 \u00a0\u2009\u202f]\d{3})+",
}
"""The thousands behind the first digits of a number, by its decimal mark."""
_GROUPED = {
    decimal_mark: compile_on_use(
        rf"\A[+-]?[1-9]\d{{0,2}}{groups}(?:{re.escape(decimal_mark)}\d*+)?\Z"
    )
    for decimal_mark, groups in GROUPS.items()
}
EITHER_WAY = compile_on_use(r"\A[+-]?[1-9]\d{0,2}([.,])\d{3}\Z")
"""``1,234``: a thousand or one and a bit."""

MISSING = compile_on_use(
    r"\A(?:nan|n\.?/?a\.?|na|null|nil|none|-+|\.+|_+|\*+|\?+|#.*|[<>]+|—|–|[+-]?inf(?:inity)?"
    r"|[+-]?(?:over|under)\w*|[+-]?ov[rfl]\w*|[+-]?ol|sat\w*|[+-]?1[.,]#\w+|nv|err\w*|invalid|bad)\Z",
    re.IGNORECASE,
)
_FIRST_CHARACTERS = frozenset("0123456789+-.,")
_BLANKS = compile_on_use(r"\"([^\"]*)\"|(\S+)")


def number(cell: str, decimal_mark: Mark) -> float | None:
    """Return the number in a cell, or None."""
    if _PLAIN[decimal_mark].match(cell):
        return float(cell.replace(",", ".").replace("d", "e").replace("D", "e"))
    if _is_grouped(cell, decimal_mark):
        integer_text, _, part = cell.partition("." if decimal_mark == "." else ",")
        return float(re.sub(r"[^\d+-]", "", integer_text) + "." + part)
    return None


def is_number(cell: str, decimal_mark: Mark) -> bool:
    """Return whether :func:`number` finds one in a cell."""
    if cell[:1] not in _FIRST_CHARACTERS and cell[:1].isascii():  # most cells that are none, soon
        return False
    return _PLAIN[decimal_mark].match(cell) is not None or _is_grouped(cell, decimal_mark)


def _is_grouped(cell: str, decimal_mark: Mark) -> bool:
    grouped = _GROUPED.get(decimal_mark)
    return grouped is not None and grouped.match(cell) is not None


def is_missing(cell: str) -> bool:
    """Return whether a cell is blank or a word for "no value", such as NaN, n/a, OVER or ----."""
    return not cell or MISSING.match(cell) is not None


def split(line: str, delimiter: str, *, trim: bool = True) -> list[str]:
    """Return the cells of a line, without trailing blank cells if `trim`.

    A delimiter of one blank stands for any run of blanks; a longer one holds the column
    breaks of a fixed-width table, as ``"fixed:9,18"``.
    """
    if delimiter == " ":
        if '"' not in line:
            return line.split()
        return [quoted or unquoted for quoted, unquoted in _BLANKS.findall(line)]
    if delimiter.startswith("fixed:"):
        cells = _split_fixed_width(line, [int(position) for position in delimiter[6:].split(",")])
    elif '"' in line:
        cells = _split_quoted_cells(line, delimiter)
    else:
        cells = [cell.strip() for cell in line.split(delimiter)]
    return drop_trailing_blanks(cells) if trim else cells


def drop_trailing_blanks(cells: list[str]) -> list[str]:
    """Return the cells, without blank ones at the end any more."""
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _split_fixed_width(line: str, breaks: Sequence[int]) -> list[str]:
    """Return the cells between the breaks; by blanks, so too many or few, if a word crosses one."""
    if any(len(line[position - 1 : position + 1].strip()) == 2 for position in breaks):
        return line.split()
    return [line[a:b].strip() for a, b in itertools.pairwise([0, *breaks, None])]


def split_by_alignment(line: str, template: str) -> list[str]:
    """Return the cells of a line in the columns of a full row, missing ones blank.

    Returns no cells unless each stands under one cell of the row, the last under its last: only
    then do the gaps show which is missing.
    """
    spans = [match.span() for match in re.finditer(r"\S+", template)]
    cells = [""] * len(spans)
    last = -1
    for match in re.finditer(r"\S+", line):
        overlapping = [i for i, (a, b) in enumerate(spans) if match.start() < b and a < match.end()]
        if len(overlapping) != 1 or overlapping[0] <= last:
            return []
        last = overlapping[0]
        cells[last] = match[0]
    return cells if last == len(spans) - 1 else []


def _split_quoted_cells(line: str, delimiter: str) -> list[str]:
    import csv

    try:
        rows = list(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error:
        rows = [line.split(delimiter)]
    return [remove_quotes(cell) for cell in rows[0]] if rows else []


def numeric(cells: Sequence[str], decimal_mark: Mark) -> list[bool]:
    """Return which cells hold a number."""
    if are_plain(cells, decimal_mark):
        return [True] * len(cells)
    return [is_number(cell, decimal_mark) for cell in cells]


def are_plain(cells: Sequence[str], decimal_mark: Mark) -> bool:
    """Whether there are cells, and each is a number without marks of thousands: one look at all."""
    return _ALL_PLAIN[decimal_mark].match("\n".join([*cells, ""])) is not None


# Columns of clock times.


_DAY = 86400.0
_LONGEST_CLOCK_STEP = 60.0
"""The longest step, s, over which a fall of the clock is midnight and not another start."""
_CLOCK = compile_on_use(
    r"\A(?:(\d{4}([./-])\d\d?\2\d\d?|\d\d?([./-])\d\d?\3(?:\d{4}|\d\d)"
    r"|\d\d?[-. ]{1,2}[^\W\d_]{3,9}\.?[- ]\d{4})[ T_]\s{0,9})?"
    r"(\d{1,4}):(\d\d)(?::(\d\d)(?:[.,](\d{1,12})|:(\d{3}))?|([.,]\d{1,12}))?"
    r"(?:\s{0,3}([AaPp])\.?[Mm]\.?)?(?:Z|([+-])(\d\d):?(\d\d))?\Z"
)
_SECONDS = compile_on_use(r"\A\d\d(?:[.,]\d{1,12})?\Z")
_DATE = compile_on_use(
    r"\A(?:\d{4}([./-])\d\d?\1\d\d?|\d\d?([./-])\d\d?\2(?:\d{4}|\d\d)"
    r"|\d\d?[-. ]{1,2}[^\W\d_]{3,9}\.?[- ]\d{4})\Z"
)
_ORDERS = ("dmy", "mdy", "ymd")
_MONTHS = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"]
_GERMAN = {"mär": "mar", "mai": "may", "okt": "oct", "dez": "dec"}


class Timestamp(NamedTuple):
    """Timestamp in a cell: its date as written, the seconds of its day, and its parts.

    ``12:30`` alone can be hours and minutes or minutes and seconds: its parts are "", and its
    seconds those of the first.
    """

    date: str
    seconds: float
    parts: str


def parse_clock_time(cell: str) -> Timestamp | None:
    """Parse a clock time such as ``09:18:09.717``, ``1/5/2024 9:18:09 PM`` or ``18:09.7``."""
    match = _CLOCK.match(cell) if cell[:1].isdigit() else None
    if match is None:
        return None
    date, _, _, first, second, third_number, part, thousandths, tenths, half_day, sign, *zone = (
        match.groups(default="")
    )
    if tenths:  # a fraction belongs to seconds: these are minutes before them
        return Timestamp(date, 60.0 * int(first) + float(f"{second}.{tenths[1:]}"), "ms")
    hours = int(first) % 12 + 12 * (half_day in "Pp") if half_day else int(first)
    seconds = 60.0 * (60 * hours + int(second)) + float(
        f"{third_number or 0}.{part or thousandths or 0}"
    )
    east = 60.0 * (60 * int(zone[0]) + int(zone[1])) if sign else 0.0  # an hour lost in autumn
    seconds += east if sign == "-" else -east
    return Timestamp(date, seconds, "hms" if third_number or half_day or date else "")


def parse_clock_or_date(cell: str) -> Timestamp | None:
    """Parse a cell of a column of clock times; a date alone is its midnight."""
    return parse_clock_time(cell) or (Timestamp(cell, 0.0, "hms") if _DATE.match(cell) else None)


@dataclass(frozen=False)
class ClockColumn:
    """Parser of the clock times of one column; `apply_day_changes` then completes the dates.

    `order` is what the header or the user says of it: "ms", "hm", "dmy", "mdy" or "".
    """

    order: str
    rows: int = 0
    dates: list[tuple[int, str]] = field(default_factory=list)
    doubtful: str = ""
    _minutes: dict[str, Timestamp | None] = field(default_factory=dict)

    def many(self, cells: Sequence[str]) -> list[Timestamp] | None:
        """Return the times of many cells, None unless each ends in seconds; only `add` counts them.

        What stands before the seconds is understood once a minute.
        """
        if self.order == "ms":
            return None
        timestamps, moments = self._minutes, []
        for cell in cells:
            head, _, seconds_text = cell.rpartition(":")
            if head not in timestamps:
                timestamps[head] = parse_clock_time(f"{head}:00") if ":" in head else None
            minute = timestamps[head]
            if minute is None or not _SECONDS.match(seconds_text):
                return None
            seconds = minute.seconds + float(seconds_text.replace(",", "."))
            moments.append(Timestamp(minute.date, seconds, "hms"))
        return moments

    def add(self, timestamps: Sequence[Timestamp]) -> FloatArray:
        """Return the seconds of the next cells, of which :meth:`many` said this."""
        date = self.dates[-1][1] if self.dates else None
        for row, timestamp in enumerate(timestamps, start=self.rows):
            if timestamp.date != date:
                date = timestamp.date
                self.dates.append((row, date))
        self.rows += len(timestamps)
        return np.array([timestamp.seconds for timestamp in timestamps])

    def seconds(self, cell: str) -> float | None:
        """Return the next cell as seconds of the day, or None."""
        self.rows += 1
        timestamp = parse_clock_or_date(cell)
        if timestamp is None:
            return None
        if not self.dates or self.dates[-1][1] != timestamp.date:
            self.dates.append((self.rows - 1, timestamp.date))
        minutes = self.order == "ms"
        if timestamp.parts == ("hms" if minutes else "") and self.order != "hm":
            self.doubtful = self.doubtful or cell
        return timestamp.seconds / 60.0 if minutes and not timestamp.parts else timestamp.seconds

    def apply_day_changes(self, values: FloatArray) -> tuple[list[int], list[Question]]:
        """Add the days to the seconds; return the rows where midnight passes, and what to ask."""
        if self.doubtful:
            has_seconds = self.doubtful.count(":") > 1
            explanation = (
                "is said to be minutes and seconds, but has three parts; if they are hours, "
                'minutes and seconds, add --units "time=hh:mm:ss"'
                if has_seconds
                else "can be hours and minutes or minutes and seconds; say which with "
                '--units "time=hh:mm" or --units "time=mm:ss"'
            )
            message = f"a time such as '{self.doubtful}' {explanation}"
            return [], [Question(message, '--units "time=mm:ss"')]
        if not any(date for _, date in self.dates):
            return self._over_midnight(values), []
        return [], self._add_days(values)

    def _over_midnight(self, values: FloatArray) -> list[int]:
        steps = np.diff(values)
        nights = (steps < 0) & (np.abs(steps + _DAY) <= _LONGEST_CLOCK_STEP)
        values[1:] += _DAY * np.cumsum(nights)
        return [int(row) for row in np.flatnonzero(nights) + 1]

    def _add_days(self, values: FloatArray) -> list[Question]:
        words = list(dict.fromkeys(date for _, date in self.dates))
        orders = (self.order,) if self.order in _ORDERS else _ORDERS
        possible_days = [days for order in orders if (days := _days(words, order))]
        # days since the first are all that a record of one clock needs
        if len({tuple(day - days[0] for day in days) for days in possible_days}) != 1:
            return [_which_date(words, is_possible=bool(possible_days))]
        day = dict(zip(words, possible_days[0], strict=True))
        stops = [row for row, _ in self.dates[1:]] + [len(values)]
        for (start, word), stop in zip(self.dates, stops, strict=True):
            values[start:stop] += _DAY * day[word]
        return []


def _days(words: list[str], order: str) -> list[int]:
    """Days since 1970 of dates in an order; none if one of them is no day."""
    days = [day for word in words if (day := _day(word, order)) is not None]
    return days if len(days) == len(words) else []


def _which_date(words: list[str], *, is_possible: bool) -> Question:
    if not is_possible:
        names = (word for word in words if any(_day(word, order) for order in _ORDERS))
        wrong = next((word for word in words if word not in set(names)), words[-1]) or "no date"
        message = (
            f"the dates of the clock, such as '{wrong}', are not all days of one calendar; "
            "correct them, or give --rate 1000Hz (the true one) if the rows are evenly sampled"
        )
        return Question(message, "--rate RATE")
    message = (
        f"the dates '{words[0]}' and '{words[1]}' can be read day first or month first; say "
        'which with --units "time=d/m/y" or --units "time=m/d/y"'
    )
    return Question(message, '--units "time=d/m/y"')


def _day(word: str, order: str) -> int | None:
    """Days since 1970 of a date in an order; None if it is no day."""
    from datetime import date  # rare, and costs time to import

    parts = [part for part in re.split(r"[-./ ]", word) if part]
    is_year = [len(part) == 4 for part in parts]
    if len(parts) != 3 or (any(is_year) and not is_year[order.index("y")]):
        return None
    if "." in word and order != "dmy" and not is_year[0]:
        return None  # with points the day comes first
    year, month, day = (parts[order.index(letter)] for letter in "ymd")
    abbreviation = month[:3].casefold()
    try:
        number = (
            _MONTHS.index(_GERMAN.get(abbreviation, abbreviation)) + 1
            if month.isalpha()
            else int(month)
        )
        century = 2000 * (len(year) == 2)
        return (date(century + int(year), number, int(day)) - date(1970, 1, 1)).days
    except ValueError:
        return None


# Complex numbers, ``(1.5-2j)`` or ``1.5 - 2i``, split into two cells.


_DELIMITERS = ("\t", ";", "|", ",")
_MIN_ROWS = 3
"""Rows by which such a column is known."""
_MIN_COMPLEX_SHARE = 0.8
"""Part of the lines from the first such row on that hold a complex number, at least."""
_MAX_HEADER_LINES = 3
"""Lines directly above the table that may contain names and units."""
_PLACEHOLDER = "\0"


def _build_complex_pattern(decimal_mark: str) -> re.Pattern[str]:
    mantissa = rf"(?:\d{{1,40}}(?:{decimal_mark}\d{{0,40}})?|{decimal_mark}\d{{1,40}})"
    size = rf"{mantissa}(?:[eEdD][+-]?\d{{1,4}})?"
    return compile_on_use(
        rf"(?<![\w.])\"?\(?[ ]?(?P<real>[+-]?{size})[ ]?(?P<sign>\+-|[+-])[ ]?"
        rf"(?:(?P<before>{size})\*?[ijIJ]|[ijIJ]\*?(?P<behind>{size}))[ ]?\)?\"?(?![\w.])"
    )


_COMPLEX_PATTERNS = (_build_complex_pattern(r"\."), _build_complex_pattern(","))


def holds_complex(head: str) -> bool:
    r"""Return whether some of the first lines hold complex numbers in their cells.

    >>> holds_complex("f,H\n1,(1+2j)\n2,(2-1j)\n3,(0-1j)"), holds_complex("f,H\n1,2")
    (True, False)
    """
    return any(sum(1 for _ in pattern.finditer(head)) >= _MIN_ROWS for pattern in _COMPLEX_PATTERNS)


def parted_cells(text: str) -> str | None:
    r"""Return a table with two cells, real and imaginary part, for each complex one.

    The names above are those of the cell with "real" and "imaginary" behind them, the units stay.
    None if hardly any row holds a complex number.

    >>> parted_cells("f [Hz],H [1/kg]\n1,(1+2j)\n2,(2-1j)\n3,(0-1j)").splitlines()[:2]
    ['f [Hz],H real [1/kg],H imaginary [1/kg]', '1,1,+2']
    """
    lines = text.split("\n")
    for pattern in _COMPLEX_PATTERNS:
        rows = [i for i, line in enumerate(lines) if pattern.search(line)]
        if len(rows) < _MIN_ROWS:
            continue
        filled = [i for i in range(rows[0], len(lines)) if lines[i].strip()]
        if len(rows) < _MIN_COMPLEX_SHARE * len(filled):
            continue
        bare_line = pattern.sub(_PLACEHOLDER, lines[rows[0]]).strip()
        sign = next((delimiter for delimiter in _DELIMITERS if delimiter in bare_line), " ")
        cell_kinds = _split_complex_cell(bare_line, sign)
        for i in rows:
            lines[i] = _with_parts(lines[i], pattern, sign)
        _part_names(lines, rows[0], cell_kinds, sign)
        return "\n".join(lines)
    return None


def _split_complex_cell(line: str, sign: str) -> list[str]:
    return line.split() if sign == " " else [part.strip() for part in line.split(sign)]


def _with_parts(line: str, pattern: re.Pattern[str], delimiter: str) -> str:
    def parts(match: re.Match[str]) -> str:
        sign = "-" if match["sign"] == "+-" else match["sign"]
        return f"{match['real']}{delimiter}{sign}{match['before'] or match['behind']}"

    if delimiter != " ":
        return pattern.sub(parts, line)
    delimiter = "\t"  # names with their units hold blanks
    return delimiter.join(pattern.sub(parts, line).split())


def _part_names(lines: list[str], first: int, cell_kinds: list[str], sign: str) -> None:
    """Give each complex column two names, and two units."""
    has_complex = False
    for i in range(max(first - _MAX_HEADER_LINES, 0), first):
        cells = _split_complex_cell(lines[i].lstrip("#% "), sign)
        if len(cells) != len(cell_kinds):
            continue
        widened: list[str] = []
        for cell, cell_kind in zip(cells, cell_kinds, strict=True):
            if _PLACEHOLDER not in cell_kind:
                widened.append(cell)
            elif has_complex:
                widened += [cell, cell]
            else:
                name, unit = split_unit(cell)
                unit = f" [{unit}]" if unit else ""
                widened += [f"{name} real{unit}", f"{name} imaginary{unit}"]
        lines[i] = ("\t" if sign == " " else sign).join(widened)
        has_complex = True
