"""Columns of clock times: what a cell says, and what only the whole column can tell."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.reading.table import Question

_DAY = 86400.0
_STEP = 60.0
"""The longest step, s, over which a fall of the clock is midnight and not another start."""
_CLOCK = re.compile(
    r"\A(?:(\d{4}([./-])\d\d?\2\d\d?|\d\d?([./-])\d\d?\3(?:\d{4}|\d\d)"
    r"|\d\d?[-. ]{1,2}[^\W\d_]{3,9}\.?[- ]\d{4})[ T_]\s{0,9})?"
    r"(\d{1,4}):(\d\d)(?::(\d\d)(?:[.,](\d{1,12})|:(\d{3}))?|([.,]\d{1,12}))?"
    r"(?:\s{0,3}([AaPp])\.?[Mm]\.?)?(?:Z|([+-])(\d\d):?(\d\d))?\Z"
)
_SECONDS = re.compile(r"\A\d\d(?:[.,]\d{1,12})?\Z")
_DATE = re.compile(
    r"\A(?:\d{4}([./-])\d\d?\1\d\d?|\d\d?([./-])\d\d?\2(?:\d{4}|\d\d)"
    r"|\d\d?[-. ]{1,2}[^\W\d_]{3,9}\.?[- ]\d{4})\Z"
)
_ORDERS = ("dmy", "mdy", "ymd")
_MONTHS = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"]
_GERMAN = {"mär": "mar", "mai": "may", "okt": "oct", "dez": "dec"}


class Timestamp(NamedTuple):
    """One cell: its date as written, the seconds of its day, and its parts.

    ``12:30`` alone can be hours and minutes or minutes and seconds: its parts are "", and its
    seconds those of the first.
    """

    date: str
    seconds: float
    parts: str


def moment(cell: str) -> Timestamp | None:
    """Return what ``09:18:09.717``, ``1/5/2024 9:18:09 PM`` or ``18:09.7`` says, or None."""
    match = _CLOCK.match(cell) if cell[:1].isdigit() else None
    if match is None:
        return None
    date, _, _, first, second, third, part, thousandths, tenths, half, sign, *zone = match.groups(
        default=""
    )
    if tenths:  # a fraction belongs to seconds: these are minutes before them
        return Timestamp(date, 60.0 * int(first) + float(f"{second}.{tenths[1:]}"), "ms")
    hours = int(first) % 12 + 12 * (half in "Pp") if half else int(first)
    seconds = 60.0 * (60 * hours + int(second)) + float(f"{third or 0}.{part or thousandths or 0}")
    east = 60.0 * (60 * int(zone[0]) + int(zone[1])) if sign else 0.0  # an hour lost in autumn
    seconds += east if sign == "-" else -east
    return Timestamp(date, seconds, "hms" if third or half or date else "")


def instant(cell: str) -> Timestamp | None:
    """Return what a cell of a column of clock times says: a date alone is its midnight."""
    return moment(cell) or (Timestamp(cell, 0.0, "hms") if _DATE.match(cell) else None)


@dataclass
class ClockColumn:
    """Reads the cells of one column in their order; `apply_day_changes` then judges the whole.

    `order` is what the header or the user says of it: "ms", "hm", "dmy", "mdy" or "".
    """

    order: str
    rows: int = 0
    dates: list[tuple[int, str]] = field(default_factory=list)
    doubtful: str = ""
    _minutes: dict[str, Timestamp | None] = field(default_factory=dict)

    def many(self, cells: Sequence[str]) -> list[Timestamp] | None:
        """What many cells say, None unless each ends in seconds; only `add` counts them.

        What stands before the seconds is understood once a minute.
        """
        if self.order == "ms":
            return None
        timestamps, moments = self._minutes, []
        for cell in cells:
            head, _, tail = cell.rpartition(":")
            if head not in timestamps:
                timestamps[head] = moment(f"{head}:00") if ":" in head else None
            minute = timestamps[head]
            if minute is None or not _SECONDS.match(tail):
                return None
            seconds = minute.seconds + float(tail.replace(",", "."))
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
        """Return the seconds of the day that the next cell says, or None."""
        self.rows += 1
        timestamp = instant(cell)
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
        nights = (steps < 0) & (np.abs(steps + _DAY) <= _STEP)
        values[1:] += _DAY * np.cumsum(nights)
        return [int(row) for row in np.flatnonzero(nights) + 1]

    def _add_days(self, values: FloatArray) -> list[Question]:
        words = list(dict.fromkeys(date for _, date in self.dates))
        stated = (self.order,) if self.order in _ORDERS else _ORDERS
        possible = [days for order in stated if (days := _days(words, order))]
        # days since the first are all that a record of one clock needs
        if len({tuple(day - days[0] for day in days) for days in possible}) != 1:
            return [_which_date(words, possible=bool(possible))]
        day = dict(zip(words, possible[0], strict=True))
        stops = [row for row, _ in self.dates[1:]] + [len(values)]
        for (start, word), stop in zip(self.dates, stops, strict=True):
            values[start:stop] += _DAY * day[word]
        return []


def _days(words: list[str], order: str) -> list[int]:
    """Days since 1970 of dates in an order; none if one of them is no day."""
    days = [day for word in words if (day := _day(word, order)) is not None]
    return days if len(days) == len(words) else []


def _which_date(words: list[str], *, possible: bool) -> Question:
    if not possible:
        names = (word for word in words if any(_day(word, order) for order in _ORDERS))
        wrong = next((word for word in words if word not in set(names)), words[-1]) or "no date"
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

    parts = [part for part in re.split(r"[-./ ]", word) if part]
    whole = [len(part) == 4 for part in parts]
    if len(parts) != 3 or (any(whole) and not whole[order.index("y")]):
        return None
    if "." in word and order != "dmy" and not whole[0]:
        return None  # with points the day comes first
    year, month, day = (parts[order.index(letter)] for letter in "ymd")
    short = month[:3].casefold()
    try:
        number = _MONTHS.index(_GERMAN.get(short, short)) + 1 if month.isalpha() else int(month)
        century = 2000 * (len(year) == 2)
        return (date(century + int(year), number, int(day)) - date(1970, 1, 1)).days
    except ValueError:
        return None
