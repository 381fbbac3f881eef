r"""What the header of a file states of an exponential window.

Analysers multiply a response by :math:`e^{-at}` so that it dies within the record. A header says
so by the time constant 1/a, by the decay rate a, or by what the window leaves at the end of the
record.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from math import log
from typing import NamedTuple

from dashpot.base import units
from dashpot.base.errors import ReadError
from dashpot.reading.read_options import ReadOptions, flag

_NUMBER = re.compile(r"(?<![\w.])[-+]?\d++(?:[.,]\d++)?+(?:[eE][-+]?\d++)?+")
_LONGEST = 200
_WINDOW = re.compile(r"window|fenster|fen[eê]tre|weighting|bewertung", re.IGNORECASE)
_EXPONENTIAL = re.compile(r"\bexp(?:o\b|\b|[._ ]|onen)", re.IGNORECASE)
_DECAY = re.compile(
    r"decay|damping|d[aä]mpfung|abkling|time[ _]?const|zeitkonst|\btau\b|_tau|end[ _]?value"
    r"|endwert",
    re.IGNORECASE,
)
_OTHERS = re.compile(r"averag|mittel|moving|smooth|filter|coherence", re.IGNORECASE)
_NONE = re.compile(
    r"\b(?:no|none|off|aus|kein\w*|false|not used|uniform|rectang\w*)\b", re.IGNORECASE
)
_RATE = re.compile(r"rate|1/s|s\^?-1|rad/s", re.IGNORECASE)
_END = re.compile(r"end[ _]?value|endwert|%", re.IGNORECASE)


class StatedWindow(NamedTuple):
    """An exponential window that a file states.

    Attributes
    ----------
    rate : float or None
        Its decay a, 1/s; None where the file states the window and not how fast it decays.
    says : str
        The lines that state it.
    """

    rate: float | None
    says: str


def stated_window(header: Sequence[str], record: float | None = None) -> StatedWindow | None:
    """Return the exponential window that the lines of a header state; None if they state none.

    Parameters
    ----------
    header : sequence of str
    record : float, optional
        Length of a record, s: a window that is stated by its end value decays over that.
    """
    lines = [_strip_comment_marks(line) for line in header]
    lines = [line for line in lines if _WINDOW.search(line) or _DECAY.search(line)]
    lines = [line for line in lines if not _OTHERS.search(line)]
    stated = [line for line in lines if _EXPONENTIAL.search(line) or _decaying_window(line)]
    stated = [line for line in stated if not _NONE.search(line)]
    if not stated:
        return None
    rates = list(_rates([*stated, *(line for line in lines if line not in stated)], record))
    says = f"'{stated[0]}'"
    if any(rate == 0 for rate in rates):
        return None
    if rates and max(rates) < 1.01 * min(rates):
        return StatedWindow(rates[0], says)
    return StatedWindow(None, says)


def window_rate(
    header: Sequence[str], options: ReadOptions, record: float | None = None
) -> tuple[float | None, bool, tuple[str, ...]]:
    """Return the decay rate of a window, 1/s, whether one is stated at all, and notes.

    What the user says wins over the header; the rate is None where neither gives it.
    """
    if options.window_decay is not None:
        rate = 1 / options.window_decay if options.window_decay > 0 else 0.0
        return rate, rate > 0, ()
    window = stated_window(header, record)
    if window is None:
        return None, False, ()
    if window.rate is None:
        return None, True, (f"the header states an exponential window: {window.says}",)
    note = f"exponential window of {1 / window.rate:.4g} s: {window.says} in the header"
    return window.rate, True, (note,)


def refuse_unknown_rate(says: str) -> None:
    """Ask for the time constant of a window that an FRF carries and its file leaves open.

    Raises
    ------
    ReadError
    """
    raise ReadError(
        f"{says}, and not how fast it decays; give its time constant, for example "
        f"{flag('window_decay')} 2s, or {flag('window_decay')} 0s if the values are free of it"
    )


def _strip_comment_marks(line: str) -> str:
    """A line without its marks."""
    marks = " \t#%$!/*;'"
    return " ".join(line[:_LONGEST].replace('"', " ").lstrip(marks).rstrip(" \t;'").split())


def _decaying_window(line: str) -> bool:
    """Whether a line gives a window a decay, which an exponential one alone has."""
    return bool(_WINDOW.search(line) and _DECAY.search(line) and _NUMBER.search(line))


def _rates(lines: Sequence[str], record: float | None) -> Iterator[float]:
    """The decay rates that lines give, 1/s, each by its own number and unit."""
    for line in lines:
        number = _NUMBER.search(re.sub(r"[\[(][^\])]*[\])]", " ", line))
        if number is None or not (_DECAY.search(line) or _EXPONENTIAL.search(line)):
            continue
        value = float(number[0].replace(",", "."))
        if value == 0:
            yield 0.0
        elif value > 0:
            yield from _rate(line, value, number[0], record)


def _rate(line: str, value: float, typed: str, record: float | None) -> Iterator[float]:
    """The decay rate of one line; nothing where its unit does not show."""
    words = re.findall(r"[\[(]([^\])]*)[\])]", line)
    behind = line.partition(typed)[2].split()
    words += [behind[0].strip("[]();,")] if behind else []
    if _END.search(line):
        part = value / 100 if "%" in line else value
        if record is not None and 0 < part < 1:
            yield -log(part) / record
        return
    for word in words:
        unit = units.find_unit(word, "time")
        if unit is not None:
            yield 1 / (value * unit.factor)
            return
        if word.replace(" ", "") in {"1/s", "s^-1", "s-1", "1/sec", "rad/s", "/s"}:
            yield value
            return
