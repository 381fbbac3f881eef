"""Metadata in a file's header: specimen temperature, rest, exponential window."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import accumulate
from math import log
from typing import NamedTuple

import numpy as np

from dashpot.base import units
from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import DataError, ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.base.units import format_quantity
from dashpot.datamodel.shift_factors import SAME_TEMPERATURE
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.header_units import split_unit
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.table import LoadedColumns

# Specimen.


_NUMBER = compile_on_use(r"[-+]?\d++(?:[.,]\d++)?+(?![.,]?\d)")
_MAX_LENGTH = 120
_BESIDES = {
    "test", "testing", "specimen", "sample", "chamber", "oven", "ambient", "room", "air", "mean",
    "prüf", "proben", "prüfraum", "kammer", "raum",
}  # fmt: skip
"""Words beside which a temperature is that of the test; a set-point or a limit has others."""
_RESTS = {"rest", "rested", "resting", "ruhezeit", "ruhe", "repos", "recovery", "erholung"}
_BEFORE = {"before", "prior", "vor", "avant"}
"""Words of a line that says how long a specimen was left alone before its record."""
_AT = (["at"], ["bei"], ["@"], ["à"])
"""Words of a title before the temperature of the block under it."""


def add_specimen_temperature(
    file: OpenedFile, specimen: Specimen, test: Sequence[Channel] | None = None
) -> tuple[Specimen, list[str]]:
    """Return the specimen with the temperature stated in the file, and notes.

    A column of temperature beside those of a `test` says it by its middle, and how far it rose;
    else a line of the header such as ``# temperature: 0 degC`` or ``Prüftemperatur [°C]; 23,0``,
    which says nothing without a unit, with a range, or beside another that differs. What the user
    gave stands.
    """
    recorded, several_columns = (None, []) if test is None else _load_temperature_column(file, test)
    said_of, notes = _merge_stated_temperature(file, specimen, recorded)
    return said_of, [*several_columns, *notes]


def stated_rest(file: OpenedFile, specimen: Specimen) -> tuple[Specimen, list[str]]:
    """Return the specimen with the rest before its record that the header says, and notes.

    A line such as ``# rest before test: 10 min`` or ``Ruhezeit vor Versuch [s]; 600``; two that
    differ say nothing.
    """
    entries = {
        value: text
        for value, text in _quantities(file.table.header, "time", _rest_before)
        if value >= 0
    }
    if not entries:
        return specimen, []
    source = f"the header says {' and '.join(repr(line) for line in list(entries.values())[:2])}"
    if len(entries) > 1:
        return specimen, [f"{source}; no rest before the record is taken from it"]
    rest = next(iter(entries))
    return replace(specimen, rested=rest), [f"rest of {rest:g} s before the record: {source}"]


def _rest_before(name: str) -> bool:
    words = set(vocabulary.tokens(name))
    return bool(words & _RESTS and words & _BEFORE)


def _merge_stated_temperature(
    file: OpenedFile, specimen: Specimen, recorded: FloatArray | None
) -> tuple[Specimen, list[str]]:
    """Return the specimen with the temperature of a column, K, or else of the header, and notes."""
    source_text = "the header"
    entries = {kelvin: f"'{line}'" for kelvin, line in _temperatures(file.table.header)}
    if recorded is not None:
        source_text = "the file"
        median_value = round(median(recorded), 2)
        entries = {
            median_value: f"{format_quantity(median_value, 'degC')} in its column of temperature"
        }
        specimen = replace(specimen, warmed=_rise(recorded))
    if not entries:
        return specimen, []
    text = f"{source_text} says {' and '.join(list(entries.values())[:2])}"
    if specimen.temperature is not None:
        other_temperatures = [
            entry for entry in entries if abs(entry - specimen.temperature) >= SAME_TEMPERATURE
        ]
        if not other_temperatures:
            return specimen, []
        quantity = format_quantity(specimen.temperature, "degC")
        return (
            replace(specimen, stated_temperature=other_temperatures[0]),
            [f"{text}; the temperature is {quantity}, as given"],
        )
    if len(entries) > 1:
        return specimen, [f"{text}; no temperature is taken from it"]
    kelvin = next(iter(entries))
    try:
        resolved_specimen = replace(specimen, temperature=kelvin)
    except DataError as error:
        return replace(specimen, warmed=None), [f"{text}, which is not taken: {error}"]
    return resolved_specimen, [f"temperature {format_quantity(kelvin, 'degC')}: {text}"]


def _load_temperature_column(
    file: OpenedFile, used_channels: Sequence[Channel]
) -> tuple[FloatArray | None, list[str]]:
    """Return the column of temperature of a test, K, if there is one beside those taken, and notes.

    One without a unit is left alone, unless it was named; of several none is taken, with a note.

    Raises
    ------
    ReadError
        If the column was named and has no unit.
    """
    assignment, notes = channels.find_optional_column(file, "temperature")
    if assignment is None or assignment.index in {channel.index for channel in used_channels}:
        return None, notes
    try:
        (channel,) = channels.add_units(file, [assignment])
    except ReadError:
        if file.options.temperature is not None:
            raise
        return None, notes
    loaded_columns = channels.load(
        file.table, [channel.index], file.options.segment, refuse_questions=False
    )
    kelvin = channels.scale_to_si(loaded_columns.values[:, 0], channel.unit)
    kelvin = kelvin[np.isfinite(kelvin)]
    return kelvin if len(kelvin) else None, [
        *notes,
        *channels.describe_alternatives(file, [channel]),
    ]


def _rise(kelvin: FloatArray) -> float:
    """Return the rise of a straight line through the readings, from the first to the last."""
    relative_time = np.linspace(-0.5, 0.5, len(kelvin))
    square = float(relative_time @ relative_time)
    return float(relative_time @ kelvin) / square if square > 0 else 0.0


def temperatures_of_segments(file: OpenedFile, loaded_columns: LoadedColumns) -> FloatArray | None:
    """Return the temperature of each row, K, if the lines over its segments state several.

    A segment over which nothing is stated is as warm as the one before it.
    """
    temperature_sets = [
        {kelvin for kelvin, _ in _temperatures(lines, titles=True)}
        for lines in (file.table.header, *loaded_columns.above[1:])
    ]
    has_several = len(set().union(*temperature_sets)) > 1
    if (
        not has_several
        or not temperature_sets[0]
        or any(len(kelvin) > 1 for kelvin in temperature_sets)
    ):
        return None
    lengths = np.diff((*loaded_columns.starts, len(loaded_columns.values)))
    sums = accumulate((max(k, default=np.nan) for k in temperature_sets), _or_before)
    return np.repeat(list(sums), lengths)


def _or_before(default: float, stated_value: float) -> float:
    return default if np.isnan(stated_value) else stated_value


def _temperatures(header: tuple[str, ...], *, titles: bool = False) -> Iterator[tuple[float, str]]:
    """Each temperature of a line of its own or at the end of a title, K, and the line."""
    return _quantities(header, "temperature", _is_test_temperature, titles=titles)


def _quantities(
    header: tuple[str, ...],
    dimension: units.Dimension,
    is_name: Callable[[str], bool],
    *,
    titles: bool = False,
) -> Iterator[tuple[float, str]]:
    """Iterate over quantities, SI, whose name fulfils `is_name` in a header line, with the line."""
    for line in header:
        text = " ".join(line[:_MAX_LENGTH].replace('"', " ").strip(" \t#%$!/*;'").split())
        number = _NUMBER.search(text)
        if number is None:
            continue
        name, inner = split_unit(text[: number.start()].rstrip(" :=;,|"))
        following_words = text[number.end() :].lstrip(" ;,|[(").split()
        word = inner or (following_words[0].rstrip(";,|])") if following_words else "")
        unit = units.find_unit(word, dimension)
        titled = titles and len(following_words) == 1 and name.split()[-1:] in _AT
        if unit is not None and (titled or (is_name(name) and (not inner or not following_words))):
            yield float(number[0].replace(",", ".")) * unit.factor + unit.offset, text


def _is_test_temperature(name: str) -> bool:
    """Return whether a name is a temperature and no more than that of the test."""
    words = vocabulary.tokens(name)
    heads = [word for word in words if word not in _BESIDES]
    return len(heads) == 1 and any(
        "temperature" in vocabulary.FIRST.get(spelling, ())
        for spelling in (heads[0], *(heads[0].removeprefix(word) for word in _BESIDES))
    )


# Exponential window.
#
# Analysers multiply a response by :math:`e^{-at}` so that it dies within the record. A header says
# so by the time constant 1/a, by the decay rate a, or by what the window leaves at the end of the
# record.


_DECAY_NUMBER = compile_on_use(r"(?<![\w.])[-+]?\d++(?:[.,]\d++)?+(?:[eE][-+]?\d++)?+")
_LONGEST_COMMENT = 200
_WINDOW = compile_on_use(r"window|fenster|fen[eê]tre|weighting|bewertung", re.IGNORECASE)
_EXPONENTIAL = compile_on_use(r"\bexp(?:o\b|\b|[._ ]|onen)", re.IGNORECASE)
_DECAY = compile_on_use(
    r"decay|damping|d[aä]mpfung|abkling|time[ _]?const|zeitkonst|\btau\b|_tau|end[ _]?value"
    r"|endwert",
    re.IGNORECASE,
)
_OTHER_WINDOWS = compile_on_use(r"averag|mittel|moving|smooth|filter|coherence", re.IGNORECASE)
_NO_WINDOW = compile_on_use(
    r"\b(?:no|none|off|aus|kein\w*|false|not used|uniform|rectang\w*)\b", re.IGNORECASE
)
_RATE = compile_on_use(r"rate|1/s|s\^?-1|rad/s", re.IGNORECASE)
_END = compile_on_use(r"end[ _]?value|endwert|%", re.IGNORECASE)


class StatedWindow(NamedTuple):
    """Exponential window stated in a file.

    Attributes
    ----------
    rate : float or None
        Its decay a, 1/s; None where the file states the window and not how fast it decays.
    message : str
        The lines that state it.
    """

    rate: float | None
    message: str


def stated_window(header: Sequence[str], record: float | None = None) -> StatedWindow | None:
    """Return the exponential window that the header states; None if it states none.

    Parameters
    ----------
    header : sequence of str
    record : float, optional
        Length of a record, s: a window that is stated by its end value decays over that.
    """
    lines = [_strip_comment_marks(line) for line in header]
    lines = [line for line in lines if _WINDOW.search(line) or _DECAY.search(line)]
    lines = [line for line in lines if not _OTHER_WINDOWS.search(line)]
    window_lines = [line for line in lines if _EXPONENTIAL.search(line) or _decaying_window(line)]
    window_lines = [line for line in window_lines if not _NO_WINDOW.search(line)]
    if not window_lines:
        return None
    rates = list(
        _decay_rates([*window_lines, *(line for line in lines if line not in window_lines)], record)
    )
    message = f"'{window_lines[0]}'"
    if any(rate == 0 for rate in rates):
        return None
    if rates and max(rates) < 1.01 * min(rates):
        return StatedWindow(rates[0], message)
    return StatedWindow(None, message)


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
        return None, True, (f"the header states an exponential window: {window.message}",)
    note = f"exponential window of {1 / window.rate:.4g} s: {window.message} in the header"
    return window.rate, True, (note,)


def refuse_unknown_window_rate(message: str) -> None:
    """Ask for the time constant of a window that an FRF carries and its file leaves open.

    Raises
    ------
    ReadError
    """
    raise ReadError(
        f"{message}, and not how fast it decays; give its time constant, for example "
        f"{flag('window_decay')} 2s, or {flag('window_decay')} 0s if the values are free of it"
    )


def _strip_comment_marks(line: str) -> str:
    """Return a line without its marks."""
    comment_characters = " \t#%$!/*;'"
    return " ".join(
        line[:_LONGEST_COMMENT].replace('"', " ").lstrip(comment_characters).rstrip(" \t;'").split()
    )


def _decaying_window(line: str) -> bool:
    """Return whether a line gives a window a decay, which an exponential one alone has."""
    return bool(_WINDOW.search(line) and _DECAY.search(line) and _DECAY_NUMBER.search(line))


def _decay_rates(lines: Sequence[str], record: float | None) -> Iterator[float]:
    """The decay rates that lines give, 1/s, each by its own number and unit."""
    for line in lines:
        number = _DECAY_NUMBER.search(re.sub(r"[\[(][^\])]{0,60}[\])]", " ", line))
        if number is None or not (_DECAY.search(line) or _EXPONENTIAL.search(line)):
            continue
        value = float(number[0].replace(",", "."))
        if value == 0:
            yield 0.0
        elif value > 0:
            yield from _decay_rate(line, value, number[0], record)


def _decay_rate(line: str, value: float, number_text: str, record: float | None) -> Iterator[float]:
    """The decay rate of one line; nothing where its unit does not show."""
    words = re.findall(r"[\[(]([^\])]{0,60})[\])]", line)
    following_words = line.partition(number_text)[2].split()
    words += [following_words[0].strip("[]();,")] if following_words else []
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
