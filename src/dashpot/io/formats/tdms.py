"""NI TDMS files through npTDMS: scaled, with each channel's own start offset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.io.child import limits
from dashpot.io.options import ReadOptions
from dashpot.io.source import Raw, extra
from dashpot.io.table import Column, FileTable, in_memory

_UNITS = ("unit_string", "NI_UnitDescription", "Unit", "unit", "Units")
_SCALED = ("NI_Scal", "NI_Number_Of_Scales")
"""How the properties begin by which a channel, its group or its file says that it is scaled."""
_WHOLE = 0.01
"""Share of a sample by which channels may be apart before one is shifted."""


@dataclass(frozen=True, eq=False)
class _TdmsChannel:
    name: str
    unit: str | None
    values: FloatArray
    step: float | None
    offset: float


def read(raw: Raw, options: ReadOptions) -> FileTable:
    """Return the channels of a TDMS file, one segment for each group.

    Raises
    ------
    ReadError
        If groups hold different channels (name one with ``--part sheet``), or channels of one group
        differ in rate or length.
    """
    nptdms = extra("nptdms", "npTDMS", "TDMS files")
    with raw.open() as stream:
        if raw.size > limits.VALUES:  # a number takes a byte at least: less cannot hold too many
            _within(nptdms.TdmsFile.read_metadata(stream))
            stream.seek(0)
        file = nptdms.TdmsFile.read(stream)
    _within(file)
    groups = _groups(file, options.sheet)
    notes: list[str] = []
    blocks = [_block(channels, notes) for channels in groups.values()]
    first = next(iter(groups.values()))
    columns = [Column(c.name, c.unit) for c in first]
    if blocks[0].shape[1] > len(first):
        columns.insert(0, Column("time", "s"))
    starts = np.cumsum([0, *(len(block) for block in blocks[:-1])])
    return FileTable(
        format="TDMS",
        columns=tuple(columns),
        load=in_memory(np.concatenate(blocks), tuple(map(int, starts)), tuple(groups)),
        notes=tuple(dict.fromkeys(notes)),
    )


def _within(file: Any) -> None:
    limits.within(sum(len(c) for g in file.groups() for c in g.channels()), "the channels hold")


def _groups(file: Any, sheet: str | None) -> dict[str, list[_TdmsChannel]]:
    """The groups that hold numbers, or the one named; all with the same channels."""
    scaled = _scaled(file)
    found = {one.name: _channels(one, scaled=scaled or _scaled(one)) for one in file.groups()}
    groups = {name: channels for name, channels in found.items() if channels}
    if sheet is not None:
        if sheet not in groups:
            raise ReadError(f"--part sheet={sheet}: the groups are {_list(groups)}")
        groups = {sheet: groups[sheet]}
    if not groups:
        raise ReadError("this TDMS file holds no numeric channels")
    if len({tuple((c.name, c.unit) for c in channels) for channels in groups.values()}) > 1:
        raise ReadError(
            f"groups {_list(groups)} hold different channels; choose one with --part sheet="
            f'"{next(iter(groups))}"'
        )
    return groups


def _scaled(of: Any) -> bool:
    return any(key.startswith(_SCALED) for key in of.properties)


def _channels(group: Any, *, scaled: bool) -> list[_TdmsChannel]:
    found = []
    for channel in group.channels():
        # to look for a scale takes npTDMS longer than all else that it does here
        bare = not (scaled or channel.scaler_data_types or _scaled(channel))
        values = np.asarray(channel.raw_data if bare else channel[:])
        if values.size and values.dtype.kind in "iuf":
            properties = channel.properties
            unit = next(
                (str(properties[key]) for key in _UNITS if str(properties.get(key, "")).strip()),
                None,
            )
            step = properties.get("wf_increment")
            offset = float(properties.get("wf_start_offset", 0.0))
            found.append(
                _TdmsChannel(
                    channel.name, unit, values.astype(float), float(step) if step else None, offset
                )
            )
    return found


def _block(channels: list[_TdmsChannel], notes: list[str]) -> FloatArray:
    """One group as rows: with its time in front if the channels carry it."""
    steps = {channel.step for channel in channels}
    if len(steps) > 1:
        listed = ", ".join(f"'{c.name}' {c.step} s" for c in channels[:6])
        raise ReadError(
            f"channels are sampled at different steps ({listed}); export them at one rate"
        )
    step = steps.pop()
    if step is None:
        sizes = sorted({channel.values.size for channel in channels})
        if len(sizes) > 1:
            raise ReadError(f"channels differ in length ({sizes}) and have no clock")
        return np.column_stack([channel.values for channel in channels])
    time = _common(channels, step)
    return np.column_stack([time, *(_aligned(c, time, step, notes) for c in channels)])


def _common(channels: list[_TdmsChannel], step: float) -> FloatArray:
    """The times at which every channel was sampled."""
    start = max(channel.offset for channel in channels)
    end = min(channel.offset + step * (channel.values.size - 1) for channel in channels)
    count = int(np.floor((end - start) / step + 1e-6)) + 1
    if count < 2:
        raise ReadError("the channels do not overlap in time (wf_start_offset)")
    return start + step * np.arange(count, dtype=float)


def _aligned(channel: _TdmsChannel, time: FloatArray, step: float, notes: list[str]) -> FloatArray:
    """A channel's samples at the common times; its own where they fall together."""
    shift = (time[0] - channel.offset) / step
    whole = round(shift)
    if abs(shift - whole) <= _WHOLE:
        if whole:
            notes.append(f"'{channel.name}' starts {whole} samples before the others: aligned")
        return channel.values[whole : whole + len(time)]
    notes.append(
        f"'{channel.name}' starts {shift:.2f} samples before the others: shifted by straight lines "
        "between its samples, which dulls what is near half the sampling rate"
    )
    own = channel.offset + step * np.arange(channel.values.size)
    return np.interp(time, own, channel.values)


def _list(groups: dict[str, list[_TdmsChannel]]) -> str:
    return ", ".join(f"'{name}'" for name in list(groups)[:8])
