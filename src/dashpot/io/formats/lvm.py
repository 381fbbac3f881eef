"""LabVIEW measurement files (LVM): several segments, with or without columns of time."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw
from dashpot.io.table import Column, Content, Loaded, Question, Table
from dashpot.io.text import cells as cell
from dashpot.io.text.cells import Mark
from dashpot.io.text.dialect import Dialect
from dashpot.io.text.encoding import decoded, find_encoding
from dashpot.io.text.header import part_unit
from dashpot.io.text.rows import load_rows

_HEAD = 1 << 20
_SURE = 1e-4
"""Relative doubt of a rate that is not worth a word."""
_END = "***End_of_Header***"
_KEYS = re.compile(
    r"^(Separator|Decimal_Separator|X_Columns|Channels|Samples|Y_Unit_Label|X0|Delta_X|Notes)"
    r"(?:[\t,]|$)(.*)$",
    re.MULTILINE,
)


@dataclass(frozen=True)
class _Segment:
    """The header of one segment, its cells as text."""

    channels: int
    samples: tuple[int, ...]
    units: tuple[str, ...]
    start: tuple[float, ...]
    step: tuple[float, ...]
    half_digit: float


def read(raw: Raw, options: ReadOptions) -> Table:
    """Return the channels of an LVM file; each segment, and each record stacked in one, parts.

    Where the file holds no column of time it is counted from ``X0`` and ``Delta_X``. Records of
    ``Samples`` rows that follow one another under a single header become segments of their own.

    Raises
    ------
    ReadError
        If the header is not that of an LVM file, or its segments differ in their channels.
    """
    encoding = options.encoding or find_encoding(raw.head(_HEAD))
    found = options.encoding is None
    first = next(decoded([raw.head(_HEAD)], encoding, found=found), "")
    lines = first.split("\n")
    ends = [i for i, line in enumerate(lines) if line.startswith(_END)]
    if len(ends) < 2 or ends[1] + 1 >= len(lines):
        raise ReadError(f"an LVM file without two '{_END}' lines and channel names")
    sign = "," if re.search(r"^Separator[\t,]Comma", first, re.MULTILINE) else "\t"
    names = cell.split(lines[ends[1] + 1], sign)
    top = ends[1] + 2
    mark = _mark(first, lines[top : top + 50], sign, options)
    segments = _segments(decoded(raw.blocks(), encoding, found=found), sign, mark)
    if not segments or any(s.channels != segments[0].channels for s in segments):
        raise ReadError("the LVM segments differ in their channels; export them apart")
    comment = bool(names) and names[-1].casefold() == "comment"
    names = names[:-1] if comment else names
    clocks = [i for i, name in enumerate(names) if name.casefold().startswith("x_value")]
    counted = not any(_filled(line, clocks, sign) for line in lines[top : top + 20])
    dialect = Dialect(sign, mark, _contents(names, clocks, lines[top : top + 200], sign, mark), top)
    if not any(i not in clocks for i in dialect.numbers):
        raise ReadError("no rows of numbers under the LVM header")
    columns = _columns(names, clocks, segments[0], dialect.contents)
    notes, doubts = _rate(segments[0], counted)
    if len(set(segments[0].step[: len(columns)])) > 1 and _unlike(segments[0]):
        raise ReadError("channels have different Delta_X; export them at one rate")

    def load(indexes: Sequence[int]) -> Loaded:
        blocks = decoded(raw.blocks(), encoding, found=found)
        wanted = [i for i in indexes if not (counted and i == 0)]
        read_for = wanted or [next(i for i in dialect.numbers if i not in clocks)]
        loaded = _stacked(load_rows(blocks, dialect, read_for), segments)
        if not (counted and 0 in indexes):
            return loaded
        time = _counted(loaded, segments)
        stack = [time if i == 0 else loaded.values[:, wanted.index(i)] for i in indexes]
        return replace(loaded, values=np.column_stack(stack))

    return Table(
        format="LVM",
        columns=tuple(columns),
        load=load,
        encoding=encoding,
        delimiter="comma" if sign == "," else "tab",
        decimal="comma" if mark == "," else "point",
        header=tuple(line for line in lines[: ends[1]] if line.strip()),
        notes=() if options.rate is not None else tuple(notes),
        simulated=any("simulated" in line.casefold() for line in lines[: ends[1]]),
        doubts=() if options.rate is not None else doubts,
    )


def _mark(head: str, rows: Sequence[str], sign: str, options: ReadOptions) -> Mark:
    """The decimal mark stated, or else (old writers) the one that the rows use."""
    if options.decimal is not None:
        return "," if options.decimal == "," else "."
    said = re.search(r"^Decimal_Separator[\t,]\s*\"?([.,])", head, re.MULTILINE)
    if said:
        return "," if said[1] == "," else "."
    return "," if sign != "," and any("," in row and "." not in row for row in rows) else "."


def _segments(blocks: Iterable[str], sign: str, mark: Mark) -> list[_Segment]:
    found: list[_Segment] = []
    said: dict[str, list[str]] = {}
    for block in blocks:
        if "\nDelta_X" not in block and "\nChannels" not in block:
            continue
        for key, rest in _KEYS.findall(block):
            if key == "Channels" and said.get("Channels"):
                found.append(_segment(said, mark))
                said = {}
            said[key] = [text.strip() for text in rest.split(sign)]
    if said.get("Channels"):
        found.append(_segment(said, mark))
    return found


def _segment(said: dict[str, list[str]], mark: Mark) -> _Segment:
    def numbers(key: str) -> tuple[float, ...]:
        values = (cell.number(text, mark) for text in said.get(key, []) if text)
        return tuple(value for value in values if value is not None)

    step = next((text for text in said.get("Delta_X", []) if text), "")
    count = numbers("Channels")
    return _Segment(
        channels=int(count[0]) if count else 0,
        samples=tuple(int(value) for value in numbers("Samples")),
        units=tuple(said.get("Y_Unit_Label", [])),
        start=numbers("X0"),
        step=numbers("Delta_X"),
        half_digit=_half_digit(step.replace(",", ".")),
    )


def _half_digit(text: str) -> float:
    """Half of the last digit printed."""
    try:
        exponent = Decimal(text).as_tuple().exponent
    except InvalidOperation:
        return 0.0
    return 0.5 * 10.0**exponent if isinstance(exponent, int) and abs(exponent) < 300 else 0.0


def _unlike(segment: _Segment) -> bool:
    filled = [step for step, n in zip(segment.step, segment.samples, strict=False) if n > 0]
    return len(set(filled)) > 1


def _filled(line: str, clocks: Sequence[int], sign: str) -> bool:
    row = cell.split(line, sign)
    return bool(clocks) and clocks[0] < len(row) and bool(row[clocks[0]])


def _contents(
    names: Sequence[str], clocks: Sequence[int], rows: Sequence[str], sign: str, mark: Mark
) -> tuple[Content, ...]:
    """What each column holds; one that is blank in every row holds nothing."""
    cut = [cell.split(row, sign) for row in rows if row.strip()]
    contents: list[Content] = []
    for i in range(len(names)):
        numbers = any(i < len(row) and cell.number(row[i], mark) is not None for row in cut)
        contents.append(
            "number" if numbers and i not in clocks[1:] else "blank" if not numbers else "text"
        )
    return tuple(contents)


def _columns(
    names: Sequence[str], clocks: Sequence[int], segment: _Segment, contents: Sequence[Content]
) -> list[Column]:
    """Names, and the unit labels, which stand over the channels."""
    multi = len(clocks) > 1
    columns = []
    for i, name in enumerate(names):
        if i in clocks:
            repeated: Content = "text" if i != clocks[0] else "number"
            columns.append(Column("X_Value", "s", repeated))
            continue
        # the labels follow the key "Y_Unit_Label" itself, so that they stand one to the left
        place = i - (len([c for c in clocks if c < i]) if not multi else 1)
        unit = segment.units[place] if 0 <= place < len(segment.units) else ""
        stem, inner = part_unit(name)
        label = stem if inner and not unit else name
        columns.append(Column(label, unit or inner, contents[i]))
    return columns


def _rate(segment: _Segment, counted: bool) -> tuple[list[str], tuple[Question, ...]]:
    """A note where the step is printed with so few digits that the rate is uncertain."""
    if not counted:
        return [], ()
    if not segment.step or segment.step[0] <= 0:
        says = "there is no column of time and no Delta_X; give the rate, --rate 1000Hz"
        return [], (Question(says, "--rate RATE"),)
    rate = 1 / segment.step[0]
    doubt = segment.half_digit / segment.step[0]
    if doubt < _SURE or abs(rate - round(rate)) < 1e-6 * rate:
        return [], ()
    says = (
        f"Delta_X = {segment.step[0]:g} s is rounded: the rate is {rate:.2f} Hz, give or take "
        f"{doubt * rate:.1f} Hz; if you know it, say it, for example --rate {_likely(rate)}Hz"
    )
    return [says], ()


def _likely(rate: float) -> int:
    """The power of two nearby, which samplers love, else the whole number."""
    power = 2 ** round(np.log2(rate)) if rate > 1 else 1
    return power if abs(power / rate - 1) < 1e-3 else max(1, round(rate))


def _stacked(loaded: Loaded, segments: Sequence[_Segment]) -> Loaded:
    """Part each segment where it holds several records of ``Samples`` rows."""
    stops = (*loaded.starts[1:], len(loaded.values))
    starts: list[int] = []
    names: list[str] = []
    notes = list(loaded.notes)
    for k, (start, stop) in enumerate(zip(loaded.starts, stops, strict=True)):
        said = segments[min(k, len(segments) - 1)].samples
        length = max(said, default=0)
        count = (stop - start) // length if length > 1 else 1
        if count > 1 and (stop - start) % length == 0:
            notes.append(f"{count} records of {length} samples stand under one header; parted")
            starts += [start + j * length for j in range(count)]
            names += [""] * count
        else:
            starts.append(start)
            names.append("")
    return replace(loaded, starts=tuple(starts), segments=tuple(names), notes=tuple(notes))


def _counted(loaded: Loaded, segments: Sequence[_Segment]) -> FloatArray:
    """Time of every row, from X0 and Delta_X of its segment."""
    time = np.empty(len(loaded.values))
    stops = (*loaded.starts[1:], len(loaded.values))
    for k, (start, stop) in enumerate(zip(loaded.starts, stops, strict=True)):
        segment = segments[min(k, len(segments) - 1)]
        if not segment.step:
            time[start:stop] = np.nan  # asked for before it is used
            continue
        origin = segment.start[0] if segment.start else 0.0
        time[start:stop] = origin + segment.step[0] * np.arange(stop - start)
    return time
