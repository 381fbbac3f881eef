"""Table of the named arrays of a binary file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import lru_cache
from itertools import chain

import numpy as np

from dashpot.base import dataclass, replace, units
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Caution
from dashpot.extensions.formats.attribute_factors import (
    describe_full_scale,
    factors_among,
    names_factor,
    select_channel_words,
    split_full_scale,
    words_of_name,
)
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.header_units import split_unit
from dashpot.reading.table import Column, FileTable, make_loader

_RATES = {
    "fs", "rate", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "sr",
    "samplerates", "samplingrates", "samplespersecond", "acquisitionrate", "scanrate", "abtastrate",
    "abtastfrequenz", "messrate", "fsample", "fsampling",
}  # fmt: skip
_STEPS = {
    "dt", "ts", "deltat", "timestep", "sampletime", "deltax", "increment", "samplinginterval",
    "sampleinterval", "sampleperiod", "samplingperiod", "samplingtime", "timeincrement",
    "abtastintervall", "abtastzeit", "timedelta", "tsample",
}  # fmt: skip
_STARTS = {
    "t0", "starttime", "startoffset", "tstart", "delay", "timeoffset", "wfstartoffset", "start",
    "wfstarttime", "timestart", "begin", "xoffset", "x0", "timedelay", "triggeroffset", "xstart",
    "triggerdelay", "timelag", "lag", "latency", "timeshift", "skew", "timestamp", "starttimestamp",
    "acquisitionstart", "recordingstart", "begintime", "timezero", "timeorigin", "startx", "tzero",
    "starttimeutc", "startdate", "startdatetime", "startzeit", "startvalue", "firsttime",
}  # fmt: skip
"""Attributes that say when a signal begins, without signs."""
_OTHER_RATE = 0.01
"""Largest relative difference between the given and the stated rate."""
_MAX_CALIBRATION_NUMBERS = 64
"""Numbers of a calibration, at most: more are a signal."""
_WINDOWS = ("window", "fenster", "exp_decay", "expdecay")


@dataclass(frozen=True, eq=False)
class NamedArray:
    """Array with its name and unit as found."""

    name: str
    values: FloatArray | ComplexArray
    unit: str | None = None
    stated_factor: str = ""
    """Stated factor that is not applied, such as "gain = 10"."""
    stated_start: str = ""
    """Stated start, such as "t0 = 0.1"."""


def gather(
    arrays: Sequence[NamedArray],
    *,
    format_: str,
    notes: Sequence[str] = (),
    rate: float | None = None,
    header: Sequence[str] = (),
) -> FileTable:
    """Return the arrays of the commonest length as one table; single numbers become hints.

    A sampling rate in the file that differs from the given `rate` becomes a caution.

    A complex array becomes two columns, named after it: its real and its imaginary part.

    Raises
    ------
    ReadError
        If no two arrays, nor one wide array, could be a test.
    """
    vectors = _list_vectors(arrays)
    if not vectors:
        raise ReadError(f"no numeric channels found in this {format_} file")
    counts = Counter(array.values.size for array in vectors)
    length = max(counts, key=lambda size: (counts[size] > 1, counts[size] * size))
    named_arrays = [array for array in vectors if array.values.size == length]
    other_names = [array.name for array in vectors if array.values.size != length]
    skipped_note = (
        f"{len(other_names)} arrays of another length than {length} were passed over: "
        + ", ".join(other_names[:5])
    )
    _require_common_clock(arrays, named_arrays)
    factors, cautions = _stated_factors(arrays, named_arrays)
    return FileTable(
        format=format_,
        columns=tuple(map(_make_column, named_arrays, factors)),
        load=make_loader(np.column_stack([array.values for array in named_arrays])),
        notes=(
            *notes,
            *([skipped_note] if other_names else []),
            *cautions,
            *contradict_rate(arrays, rate),
        ),
        hints=rate_hints(arrays),
        header=(*header, *_window_lines(arrays)),
    )


def window_line(name: str, value: object) -> str:
    """Return a header line for the window that a file states; "" for other attributes."""
    return f"{name}: {value}" if any(word in name.casefold() for word in _WINDOWS) else ""


def _window_lines(arrays: Sequence[NamedArray]) -> list[str]:
    """Return header lines for the window stated in single numbers."""
    single = [
        array
        for array in arrays
        if np.size(array.values) == 1 and not np.iscomplexobj(array.values)
    ]
    lines = [
        window_line(array.name, f"{float(np.squeeze(array.values)):g} {array.unit or ''}".strip())
        for array in single
    ]
    return [line for line in lines if line]


def _make_column(array: NamedArray, factor: str) -> Column:
    name, unit = (array.name, array.unit) if array.unit else split_unit(array.name)
    return Column(name, unit, factor=factor)


def _stated_factors(
    arrays: Sequence[NamedArray], columns: Sequence[NamedArray]
) -> tuple[list[str], list[Caution]]:
    """Return stated factors of columns, and those that belong to no column.

    A single number named for a factor belongs to the column that it is named for (``force_gain``),
    or inside whose struct or dataset it stands (``force.gain``).
    """
    factors = [
        [text] if (text := column.stated_factor or _full_scale_of(column, arrays, columns)) else []
        for column in columns
    ]
    cautions = []
    for array in arrays:
        if np.size(array.values) > _MAX_CALIBRATION_NUMBERS or np.iscomplexobj(array.values):
            continue
        stem, _, last = array.name.rpartition(".")
        if any(array.name == column.name for column in columns):
            continue
        owner_name = stem.rpartition(".")[2]
        if not names_factor(last) and names_factor(owner_name):  # a group "calibration" of numbers
            stem, last = stem.rpartition(".")[0], f"{owner_name}_{last}"
        text = factors_among({last: array.values})
        if not text:
            continue
        column_indices = _find_scaled_columns(stem, last, columns)
        for column_index in column_indices:
            factors[column_index].append(text)
        if not column_indices:
            cautions.append(
                Caution(f"the file states {array.name}{text[len(last) :]}; it is not applied")
            )
    return [" and ".join(factor) for factor in factors], cautions


def _full_scale_of(
    column: NamedArray, arrays: Sequence[NamedArray], columns: Sequence[NamedArray]
) -> str:
    """Return the full scale that a single number states of a column which cannot be in its unit."""
    for array in arrays:
        stem, _, last = array.name.rpartition(".")
        owner = split_full_scale(last) if np.size(array.values) == 1 else None
        if owner is None or np.iscomplexobj(array.values):
            continue
        is_same_name = words_of_name(owner) == words_of_name(split_unit(column.name)[0])
        is_of_column = (
            is_same_name
            if owner
            else any(columns[i] is column for i in _find_scaled_columns(stem, "", columns))
        )
        text = describe_full_scale(column.values.real, last, array.values) if is_of_column else ""
        if text:
            return text
    return ""


def _find_scaled_columns(stem: str, last: str, columns: Sequence[NamedArray]) -> list[int]:
    """Return the columns to which a stated factor belongs, by its name and position."""
    words = select_channel_words(last)
    if words:
        return [
            i
            for i, column in enumerate(columns)
            if words_of_name(split_unit(column.name.rpartition(".")[2])[0]) == words
        ]
    column_indices = [
        i for i, column in enumerate(columns) if column.name.rpartition(".")[0] == stem
    ]
    single = column_indices if stem and len(column_indices) == 1 else []
    return [i for i, column in enumerate(columns) if stem and column.name == stem] or single


def _require_common_clock(arrays: Sequence[NamedArray], columns: Sequence[NamedArray]) -> None:
    """Refuse channels of which it is stated that they start, or are sampled, otherwise."""
    signals = [
        column for column in columns if vocabulary.matches(column.name).get("time", 0.0) < 1.5
    ]
    starts = {signal.stated_start.rpartition(" = ")[2] or "0" for signal in signals}
    if len(starts) > 1:
        channels_text = ", ".join(
            f"'{signal.name}' {signal.stated_start or 'says nothing'}" for signal in signals[:6]
        )
        raise ReadError(
            f"the channels are said to start at different times ({channels_text}): export them on "
            "one clock, as a column of time"
        )
    names = {column.name for column in columns}
    refuse_different_rates([a for a in arrays if a.name.rpartition(".")[0] in names])


def refuse_different_rates(arrays: Sequence[NamedArray]) -> None:
    """Refuse single numbers that state different sampling rates of channels.

    Raises
    ------
    ReadError
    """
    rates = {float(f"{rate:.6g}") for array in arrays if (rate := _read_rate(array))}
    if len(rates) > 1:
        rates_text = ", ".join(f"{rate:g} Hz" for rate in sorted(rates)[:6])
        raise ReadError(
            f"the channels are said to be sampled at different rates ({rates_text}); export them "
            "at one"
        )


def _list_vectors(arrays: Sequence[NamedArray]) -> list[NamedArray]:
    """Vectors as they are; a matrix as one vector for each of its columns."""
    arrays_split = []
    for array in chain.from_iterable(map(_split_parts, arrays)):
        values = np.squeeze(np.asarray(array.values, dtype=float))
        if values.ndim == 1:
            arrays_split.append(replace(array, values=values))
        elif values.ndim == 2 and min(values.shape) <= 64:
            column_values = values if values.shape[0] >= values.shape[1] else values.T
            arrays_split += [
                replace(array, name=f"{array.name} {i + 1}", values=column_values[:, i])
                for i in range(column_values.shape[1])
            ]
    return [array for array in arrays_split if array.values.size >= 2]


def _split_parts(array: NamedArray) -> tuple[NamedArray, ...]:
    if not np.iscomplexobj(array.values):
        return (array,)
    real = np.asarray(np.real(array.values), dtype=float)
    imaginary = np.asarray(np.imag(array.values), dtype=float)
    return (
        replace(array, name=f"{array.name} real", values=real),
        replace(array, name=f"{array.name} imaginary", values=imaginary),
    )


def contradict_rate(arrays: Sequence[NamedArray], stated_rate: float | None) -> list[Caution]:
    """Note a sampling rate in the file that differs from the user's."""
    stated_rates = (
        {array.name: rate for array in arrays if (rate := _read_rate(array))} if stated_rate else {}
    )
    return [
        Caution(
            f"the file says {name}, which is {rate:g} Hz, where --rate {stated_rate:g}Hz is given"
        )
        for name, rate in stated_rates.items()
        if stated_rate and abs(rate / stated_rate - 1) > _OTHER_RATE
    ][:1]


def rate_hints(arrays: Sequence[NamedArray]) -> tuple[str, ...]:
    """Return the sampling rates stated in single numbers, each once."""
    hints: dict[str, str] = {}
    for array in arrays:
        rate = _read_rate(array)
        if rate > 0:
            value = float(np.squeeze(array.values))
            unit = f" {array.unit}" if array.unit else ""
            hints.setdefault(
                f"{rate:.10g}",
                f"the file says {array.name} = {value:g}{unit}; if that is right, add "
                f"--rate {rate:.10g}Hz",
            )
    return tuple(hints.values())


def _read_rate(array: NamedArray) -> float:
    """The sampling rate, Hz, stated by a single number of this name, 0 if none."""
    if np.size(array.values) != 1 or np.iscomplexobj(array.values):
        return 0.0
    return stated_rate(array.name.rpartition(".")[2], float(np.squeeze(array.values)), array.unit)


@lru_cache(maxsize=4096)
def stated_rate(name: str, value: float, unit: str | None = None) -> float:
    """Return the sampling rate, Hz, stated by a number of this name, 0 if none.

    Its unit is a suffix of the name, as in ``dt_ms``, or separate; by default it is SI.

    >>> stated_rate("sample_rate_kHz", 2.0), stated_rate("dt", 0.01), stated_rate("mass", 1.0)
    (2000.0, 100.0, 0.0)
    """
    stem, inner = _split_name_and_unit(name)
    word = "".join(c for c in stem.casefold() if c.isalpha())
    word = word.removeprefix("wf").removeprefix("ni")
    if word in _RATES and value > 0:
        size = units.find_unit(unit or inner or "Hz", "frequency")
        return value * size.factor if size else 0.0
    if word in _STEPS and value > 0:
        size = units.find_unit(unit or inner or "s", "time")
        return 1 / (value * size.factor) if size else 0.0
    return 0.0


@lru_cache(maxsize=4096)
def names_start(name: str) -> bool:
    """Whether a name means the start of a signal; its unit may follow it.

    >>> names_start("t0"), names_start("delay_s"), names_start("start_of_test")
    (True, True, False)
    """
    spelled = (
        "".join(filter(str.isalnum, text.casefold()))
        for text in (name, _split_name_and_unit(name)[0])
    )
    return not _STARTS.isdisjoint(spelled)


def _split_name_and_unit(name: str) -> tuple[str, str | None]:
    """Return the name of a rate or a step, and the unit behind it."""
    stem, inner = split_unit(name)
    if inner:
        return stem, inner
    head, _, tail = name.rpartition("_")
    text = head and (units.find_unit(tail, "time") or units.find_unit(tail, "frequency"))
    return (head, tail) if text else (name, None)


def convert_to_floats(values: object) -> FloatArray | ComplexArray | None:
    """Return an array of numbers as floats or complex numbers; None for other types."""
    array = np.asarray(values)
    if array.dtype.kind == "c":
        return array.astype(complex)
    return array.astype(float) if array.dtype.kind in "iufb" else None
