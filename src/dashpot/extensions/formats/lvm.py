"""LabVIEW measurement files (LVM) of several segments, with or without time columns."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from decimal import Decimal, InvalidOperation
from itertools import chain

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.extensions.formats.common_clock import SampledChannel, interpolate_to_slowest
from dashpot.reading.columns.header_units import split_unit
from dashpot.reading.raw_file import RawFile, TimeBudget
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import Column, Content, FileTable, LoadedColumns, Question, make_loader
from dashpot.reading.text import cells as cell
from dashpot.reading.text.cells import Mark
from dashpot.reading.text.dialect import Dialect, decode_blocks, find_encoding
from dashpot.reading.text.rows import load_rows

_HEAD = 1 << 20
_RATE_TOLERANCE = 1e-4
"""Relative uncertainty of a rate that needs no note."""
_END = "***End_of_Header***"
_KEYS = re.compile(
    r"^(Separator|Decimal_Separator|X_Columns|Channels|Samples|Y_Unit_Label|X0|Delta_X|Notes|X_Value)"
    r"(?:[\t,]|$)(.*)$",
    re.MULTILINE,
)


@dataclass(frozen=True)
class _LvmHead:
    """The header of one segment, its cells as text."""

    channels: int
    names: tuple[str, ...]
    samples: tuple[int, ...]
    units: tuple[str, ...]
    start: tuple[float, ...]
    step: tuple[float, ...]
    half_digit: float


@dataclass(frozen=True)
class _LvmRows:
    """The rows under the headers, and whether their time (column 0) is counted."""

    dialect: Dialect
    clocks: tuple[int, ...]
    time_is_counted: bool
    segments: tuple[_LvmHead, ...]

    def __post_init__(self) -> None:
        if not self.signals():
            raise ReadError("no rows of numbers under the LVM header")

    def signals(self) -> list[int]:
        return [i for i in self.dialect.numbers if i not in self.clocks]

    def load(
        self, blocks: Callable[[], Iterator[str]], indexes: Sequence[int], time_budget: TimeBudget
    ) -> LoadedColumns:
        column_indices = [i for i in indexes if not (self.time_is_counted and i == 0)]
        read_indices = column_indices or self.signals()[:1]
        loaded_columns = load_rows(blocks, self.dialect, read_indices, time_budget=time_budget)
        loaded_columns = _split_stacked_records(loaded_columns, self.segments)
        if len(column_indices) == len(indexes):
            return loaded_columns
        column = dict(zip(column_indices, loaded_columns.values.T, strict=False))
        column[0] = _compute_row_times(loaded_columns, self.segments)
        return replace(loaded_columns, values=np.column_stack([column[i] for i in indexes]))


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the channels of an LVM file; each segment, and each record stacked in one, parts.

    Where the file holds no column of time it is counted from ``X0`` and ``Delta_X``. Records of
    ``Samples`` rows that follow one another under a single header become segments of their own.

    Raises
    ------
    ReadError
        If the header is not that of an LVM file, or its segments differ in their channels.
    """
    encoding = options.encoding or find_encoding(raw.head(_HEAD))
    is_encoding_detected = options.encoding is None
    first = next(decode_blocks([raw.head(_HEAD)], encoding, detected=is_encoding_detected), "")
    lines = first.split("\n")
    top = _find_first_row(lines)
    sign = "," if re.search(r"^Separator[\t,]Comma", first, re.MULTILINE) else "\t"
    decimal_mark = _mark(first, lines[top : top + 50], sign, options)
    segments = _read_segments(
        decode_blocks(raw.blocks(), encoding, detected=is_encoding_detected), sign, decimal_mark
    )
    names, clocks = _read_column_names(lines[top - 1], sign)
    counted = not any(_has_clock_value(line, clocks, sign) for line in lines[top : top + 20])
    dialect = Dialect(
        sign,
        decimal_mark,
        _classify_columns(names, clocks, lines[top : top + 200], sign, decimal_mark),
        top,
    )
    rows = _LvmRows(dialect, tuple(clocks), counted, tuple(segments))
    columns = _make_columns(names, clocks, segments[0], dialect.contents)

    def blocks() -> Iterator[str]:
        return decode_blocks(raw.blocks(), encoding, detected=is_encoding_detected)

    if _has_different_steps(segments[0], len(columns)):
        header = tuple(filter(str.strip, lines[: top - 2]))
        return replace(
            _resample(blocks, rows, columns, names, raw.patience),
            header=header,
            simulated="simulated" in "\n".join(header).casefold(),
        )
    asks = counted and options.rate is None
    notes, questions = _note_rounded_step(segments[0]) if asks else ((), ())

    def load(indexes: Sequence[int]) -> LoadedColumns:
        return rows.load(blocks, indexes, raw.patience)

    return FileTable(
        format="LVM",
        columns=tuple(columns),
        load=load,
        encoding=encoding,
        delimiter="comma" if sign == "," else "tab",
        decimal="comma" if decimal_mark == "," else "point",
        header=tuple(filter(str.strip, lines[: top - 2])),
        notes=notes,
        simulated="simulated" in "\n".join(lines[: top - 2]).casefold(),
        questions=questions,
    )


def _resample(
    blocks: Callable[[], Iterator[str]],
    rows: _LvmRows,
    columns: Sequence[Column],
    names: Sequence[str],
    time_budget: TimeBudget,
) -> FileTable:
    """Return channels of several rates on one clock.

    Raises
    ------
    ReadError
        If the file holds several segments, or no channel of a test shows itself.
    """
    head = rows.segments[0]
    signal_indices = [i for i in range(len(names)) if i not in rows.clocks]
    steps = dict(zip(signal_indices, head.step, strict=False))
    starts = dict(zip(signal_indices, head.start, strict=False))
    stepped_indices = [
        i for i in signal_indices if i in steps and steps[i] > 0 and i in rows.dialect.numbers
    ]
    if len(rows.segments) > 1 or len(stepped_indices) < 2:
        raise ReadError("channels have different Delta_X; export them at one rate")
    loaded_columns = load_rows(blocks, rows.dialect, stepped_indices, time_budget=time_budget)
    channels = []
    for i, values in zip(stepped_indices, loaded_columns.values.T, strict=True):
        count = int(np.flatnonzero(np.isfinite(values)).max(initial=-1)) + 1
        if count > 1:
            time = starts.get(i, 0.0) + steps[i] * np.arange(count, dtype=float)
            channels.append((i, SampledChannel(columns[i].name, time, values[:count])))
    notes = list(loaded_columns.notes)
    table = interpolate_to_slowest([channel for _, channel in channels], notes)
    return FileTable(
        format="LVM",
        columns=(Column("X_Value", "s"), *(columns[i] for i, _ in channels)),
        load=make_loader(table),
        notes=tuple(notes),
    )


def _find_first_row(lines: Sequence[str]) -> int:
    """Return the line of the first row: two below the end of the second header."""
    header_ends = [i for i, line in enumerate(lines) if line.startswith(_END)]
    if len(header_ends) < 2 or header_ends[1] + 1 >= len(lines):
        raise ReadError(f"an LVM file without two '{_END}' lines and channel names")
    return header_ends[1] + 2


def _read_column_names(line: str, sign: str) -> tuple[list[str], list[int]]:
    """Return the names of the columns, without the comment, and which are clocks."""
    names = cell.split(line, sign)
    if names and names[-1].casefold() == "comment":
        names.pop()
    return names, [i for i, name in enumerate(names) if name.casefold().startswith("x_value")]


def _mark(head: str, rows: Sequence[str], sign: str, options: ReadOptions) -> Mark:
    """Return the decimal mark stated, or else (old writers) the one that the rows use."""
    if options.decimal is not None:
        return "," if options.decimal == "," else "."
    separator_match = re.search(r"^Decimal_Separator[\t,]\s*\"?([.,])", head, re.MULTILINE)
    if separator_match:
        return "," if separator_match[1] == "," else "."
    return "," if sign != "," and any("," in row and "." not in row for row in rows) else "."


def _read_segments(blocks: Iterable[str], sign: str, decimal_mark: Mark) -> list[_LvmHead]:
    heads = [
        _read_segment(header, decimal_mark)
        for header in _read_headers(blocks, sign)
        if "Channels" in header
    ]
    if len({segment.channels for segment in heads}) != 1:
        raise ReadError("the LVM segments differ in their channels; export them apart")
    for difference, group in (
        ("units", {segment.units for segment in heads} - {()}),
        ("names of channels", {segment.names for segment in heads} - {()}),
    ):
        if len(group) > 1:
            first, other = sorted(group)[:2]
            raise ReadError(
                f"the LVM segments differ in their {difference}: {', '.join(filter(None, first))} "
                f"and {', '.join(filter(None, other))}; export them apart"
            )
    return heads


def _read_headers(blocks: Iterable[str], sign: str) -> list[dict[str, list[str]]]:
    """Return the values of each header: the cells after its keys."""
    headers: list[dict[str, list[str]]] = [{}]
    with_keys = (block for block in blocks if "\nDelta_X" in block or "\nChannels" in block)
    for key, cells in chain.from_iterable(map(_KEYS.findall, with_keys)):
        if key == "Channels" and key in headers[-1]:
            headers.append({})
        headers[-1][key] = [text.strip() for text in cells.split(sign)]
    return headers


def _read_segment(header: dict[str, list[str]], decimal_mark: Mark) -> _LvmHead:
    def numbers(key: str) -> tuple[float, ...]:
        values = (cell.number(text, decimal_mark) for text in header.get(key, []) if text)
        return tuple(value for value in values if value is not None)

    step = next((text for text in header.get("Delta_X", []) if text), "")
    count = numbers("Channels")
    return _LvmHead(
        channels=int(count[0]) if count else 0,
        names=tuple(header.get("X_Value", [])),
        samples=tuple(int(value) for value in numbers("Samples")),
        units=tuple(header.get("Y_Unit_Label", [])),
        start=numbers("X0"),
        step=numbers("Delta_X"),
        half_digit=_get_half_digit(step.replace(",", ".")),
    )


def _get_half_digit(text: str) -> float:
    """Half of the last digit printed."""
    try:
        exponent = Decimal(text).as_tuple().exponent
    except InvalidOperation:
        return 0.0
    return 0.5 * 10.0**exponent if isinstance(exponent, int) and abs(exponent) < 300 else 0.0


def _has_different_steps(segment: _LvmHead, columns: int) -> bool:
    """Return whether the channels with samples differ in their time step."""
    steps_with_samples = {
        step for step, n in zip(segment.step, segment.samples, strict=False) if n > 0
    }
    return len(set(segment.step[:columns])) > 1 and len(steps_with_samples) > 1


def _has_clock_value(line: str, clocks: Sequence[int], sign: str) -> bool:
    row = cell.split(line, sign)
    return bool(clocks) and clocks[0] < len(row) and bool(row[clocks[0]])


def _classify_columns(
    names: Sequence[str], clocks: Sequence[int], rows: Sequence[str], sign: str, decimal_mark: Mark
) -> tuple[Content, ...]:
    """Return the content of each column; "blank" if all rows are."""
    cell_rows = [cell.split(row, sign) for row in rows if row.strip()]
    contents: list[Content] = []
    for i in range(len(names)):
        numbers = any(
            i < len(row) and cell.number(row[i], decimal_mark) is not None for row in cell_rows
        )
        contents.append(
            "number" if numbers and i not in clocks[1:] else "blank" if not numbers else "text"
        )
    return tuple(contents)


def _make_columns(
    names: Sequence[str], clocks: Sequence[int], segment: _LvmHead, contents: Sequence[Content]
) -> list[Column]:
    """Names, and the unit labels above the channels."""
    columns = []
    for i, name in enumerate(names):
        if i in clocks:
            columns.append(Column("X_Value", "s", "number" if i == clocks[0] else "text"))
            continue
        # the labels follow the key "Y_Unit_Label" itself, so that they stand one to the left
        channel_index = i - (1 if len(clocks) > 1 else sum(c < i for c in clocks))
        unit = dict(enumerate(segment.units)).get(channel_index, "")
        stem, inner = split_unit(name)
        columns.append(Column(stem if inner and not unit else name, unit or inner, contents[i]))
    return columns


def _note_rounded_step(segment: _LvmHead) -> tuple[tuple[str, ...], tuple[Question, ...]]:
    """Return a note where the step is printed with so few digits that the rate is uncertain."""
    if not segment.step or segment.step[0] <= 0:
        message = "there is no column of time and no Delta_X; give the rate, --rate 1000Hz"
        return (), (Question(message, "--rate RATE"),)
    rate = 1 / segment.step[0]
    step_error = segment.half_digit / segment.step[0]
    if step_error < _RATE_TOLERANCE or abs(rate - round(rate)) < 1e-6 * rate:
        return (), ()
    message = (
        f"Delta_X = {segment.step[0]:g} s is rounded: the rate is {rate:.2f} Hz, give or take "
        f"{step_error * rate:.1f} Hz; if you know it, say it, for example --rate "
        f"{_round_sampling_rate(rate)}Hz"
    )
    return (message,), ()


def _round_sampling_rate(rate: float) -> int:
    """Return the nearby power of two, common as a sampling rate, else the integer."""
    power = 2 ** round(np.log2(rate)) if rate > 1 else 1
    return power if abs(power / rate - 1) < 1e-3 else max(1, round(rate))


def _list_parts(
    loaded_columns: LoadedColumns, segments: Sequence[_LvmHead]
) -> Iterator[tuple[int, int, _LvmHead]]:
    """First row, end and header of each part; a segment without a header has the last one."""
    segment_ends = (*loaded_columns.starts[1:], len(loaded_columns.values))
    for k, (start, stop) in enumerate(zip(loaded_columns.starts, segment_ends, strict=True)):
        yield start, stop, segments[min(k, len(segments) - 1)]


def _split_stacked_records(
    loaded_columns: LoadedColumns, segments: Sequence[_LvmHead]
) -> LoadedColumns:
    """Split each segment that holds several records of ``Samples`` rows."""
    starts: list[int] = []
    notes = list(loaded_columns.notes)
    for start, stop, segment in _list_parts(loaded_columns, segments):
        length = max(segment.samples, default=0)
        count = (stop - start) // length if length > 1 else 1
        if count > 1 and (stop - start) % length == 0:
            notes.append(f"{count} records of {length} samples stand under one header; parted")
            starts += range(start, stop, length)
        else:
            starts.append(start)
    names = ("",) * len(starts)
    return replace(loaded_columns, starts=tuple(starts), segments=names, notes=tuple(notes))


def _compute_row_times(loaded_columns: LoadedColumns, segments: Sequence[_LvmHead]) -> FloatArray:
    """Time of every row, from X0 and Delta_X of its segment; NaN without, requested before use."""
    time = np.full(len(loaded_columns.values), np.nan)
    for start, stop, segment in _list_parts(loaded_columns, segments):
        if segment.step:
            origin = segment.start[0] if segment.start else 0.0
            time[start:stop] = origin + segment.step[0] * np.arange(stop - start)
    return time
