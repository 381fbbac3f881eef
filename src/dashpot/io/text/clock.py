"""Columns of clock times: what a cell says, and what only the whole column can tell."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.io.table import Question

_DAY = 86400.0
_STEP = 60.0
"""The longest step, s, over which a fall of the clock is midnight and not another start."""
_CLOCK = re.compile(
    r"\A(?:(\d{4}-\d\d?-\d\d?|\d\d?[./-]\d\d?[./-]\d{4}|\d{4}[./]\d\d?[./]\d\d?)[ T_]\s{0,9})?"
    r"(\d{1,4}):(\d\d)(?::(\d\d)(?:[.,](\d{1,12})|:(\d{3}))?|([.,]\d{1,12}))?"
    r"Z?(?:\s{0,3}([AaPp])\.?[Mm]\.?)?\Z"
)


@dataclass(frozen=True)
class Moment:
    """One cell: its date as written, the seconds of its day, and its parts.

    ``12:30`` alone can be hours and minutes or minutes and seconds: its parts are "", and its
    seconds those of the first.
    """

    date: str
    seconds: float
    parts: str


def moment(cell: str) -> Moment | None:
    """Return what ``09:18:09.717``, ``1/5/2024 9:18:09 PM`` or ``18:09.7`` says, or None."""
    match = _CLOCK.match(cell)
    if match is None:
        return None
    date, first, second, third, part, thousandths, tenths, half = match.groups(default="")
    if tenths:  # a fraction belongs to seconds: these are minutes before them
        return Moment(date, 60.0 * int(first) + float(f"{second}.{tenths[1:]}"), "ms")
    hours = int(first) % 12 + 12 * (half in "Pp") if half else int(first)
    seconds = 60.0 * (60 * hours + int(second)) + float(f"{third or 0}.{part or thousandths or 0}")
    return Moment(date, seconds, "hms" if third or half or date else "")


@dataclass
class ClockColumn:
    """Reads the cells of one column in their order; `settled` then judges the whole.

    `order` is what the header or the user says of it: "ms", "hm", "dmy", "mdy" or "".
    """

    order: str
    rows: int = 0
    dates: list[tuple[int, str]] = field(default_factory=list)
    doubtful: str = ""

    def seconds(self, cell: str) -> float | None:
        """Return the seconds of the day that the next cell says, or None."""
        self.rows += 1
        found = moment(cell)
        if found is None:
            return None
        if not self.dates or self.dates[-1][1] != found.date:
            self.dates.append((self.rows - 1, found.date))
        minutes = self.order == "ms"
        if found.parts == ("hms" if minutes else "") and self.order != "hm":
            self.doubtful = self.doubtful or cell
        return found.seconds / 60.0 if minutes and not found.parts else found.seconds

    def settled(self, values: FloatArray) -> tuple[list[int], list[Question]]:
        """Add the days to the seconds; return the rows where midnight passes, and what to ask."""
        if self.doubtful:
            three = self.doubtful.count(":") > 1
            ways = (
                "is said to be minutes and seconds, but has three parts; if they are hours, "
                'minutes and seconds, add --units "time=hh:mm:ss"'
                if three
                else "can be hours and minutes or minutes and seconds; say which with "
                '--units "time=hh:mm" or --units "time=mm:ss"'
            )
            says = f"a time such as '{self.doubtful}' {ways}"
            return [], [Question(says, '--units "time=mm:ss"')]
        if not any(date for _, date in self.dates):
            return self._over_midnight(values), []
        return [], self._add_days(values)

    def _over_midnight(self, values: FloatArray) -> list[int]:
        steps = np.diff(values)
        falls = np.flatnonzero((steps < 0) & (np.abs(steps + _DAY) <= _STEP)) + 1
        for row in falls:
            values[row:] += _DAY
        return [int(row) for row in falls]

    def _add_days(self, values: FloatArray) -> list[Question]:
        words = list(dict.fromkeys(date for _, date in self.dates))
        stated = [self.order] if self.order in {"dmy", "mdy"} else ["dmy", "mdy"]
        days = {order: [_day(word, order) for word in words] for order in stated}
        possible = [order for order in stated if None not in days[order]]
        if not possible or (len(words) > 1 and len({*map(_spread, map(days.get, possible))}) > 1):
            return [_which_date(words, possible)]
        day = dict(zip(words, days[possible[0]], strict=True))
        stops = [row for row, _ in self.dates[1:]] + [len(values)]
        for (start, word), stop in zip(self.dates, stops, strict=True):
            values[start:stop] += _DAY * (day[word] or 0)
        return []


def _spread(days: list[int | None] | None) -> tuple[int, ...]:
    """Days since the first, which is all that a record of one clock needs."""
    known = [day or 0 for day in days or []]
    return tuple(day - known[0] for day in known)


def _which_date(words: list[str], possible: list[str]) -> Question:
    if not possible:
        wrong = next((w for w in words if _day(w, "dmy") is None), words[-1]) or "no date"
        says = (
            f"the dates of the clock, such as '{wrong}', are not all days of one calendar; "
            "correct them, or give --rate 1000Hz (the true one) if the rows are evenly sampled"
        )
        return Question(says, "--rate RATE")
    says = (
        f"the dates '{words[0]}' and '{words[1]}' can be read day first or month first; say "
        'which with --units "time=d/m/y" or --units "time=m/d/y"'
    )
    return Question(says, '--units "time=d/m/y"')


def _day(word: str, order: str) -> int | None:
    """Days since 1970 of a date in an order; None if it is no day."""
    from datetime import date  # rare, and costs time to import

    numbers = [int(part) for part in re.split(r"[-./]", word) if part]
    if len(numbers) != 3 or ("." in word and order == "mdy" and numbers[0] <= 31):
        return None  # nobody writes the month first with points
    if numbers[0] > 31:
        order = "ymd"
    year, month, day = (numbers[order.index(letter)] for letter in "ymd")
    try:
        return (date(year, month, day) - date(1970, 1, 1)).days
    except ValueError:
        return None
