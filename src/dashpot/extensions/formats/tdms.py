"""NI TDMS files through npTDMS: scaled, with the start offset of each channel."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace, units
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Caution
from dashpot.extensions.formats.array_table import (
    NamedArray,
    contradict_rate,
    names_start,
    rate_hints,
    refuse_different_rates,
    stated_rate,
    window_line,
)
from dashpot.extensions.formats.attribute_factors import (
    apply_attributes,
    concerns_numbers,
    describe_full_scale,
    factors_among,
    select_channel_words,
    split_full_scale,
    words_of_name,
)
from dashpot.extensions.formats.common_clock import SampledChannel, interpolate_to_slowest
from dashpot.reading.columns.header_units import split_unit
from dashpot.reading.raw_file import RawFile, import_extra
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits
from dashpot.reading.table import Column, FileTable, make_loader

_UNITS = ("unit_string", "NI_UnitDescription", "Unit", "unit", "Units")
_SCALED = ("NI_Scal", "NI_Number_Of_Scales")
"""Prefixes of the properties that state a scaling of a channel, group or file."""
_SCALE_TYPE = re.compile(r"NI_Scale\[\d+\]_Scale_Type")
_KNOWN_SCALES = {
    "Polynomial", "Linear", "RTD", "Strain", "Table", "Thermistor", "Thermocouple", "Add",
    "Subtract", "AdvancedAPI",
}  # fmt: skip
"""The scales that npTDMS applies."""
_UNSET = -2 * 10**18
"""Start, ns since 1970, up to which it counts as unset: LabVIEW's zero is in 1904."""
_NUMBERS = "iuf"
"""The kinds of numeric arrays."""
_PATH = re.compile(r"/'((?:[^']|'')*)'/'((?:[^']|'')*)'")
"""Path of a channel: the names of its group and of the channel."""
_NONE = np.empty(0)
_SHIFT_TOLERANCE = 0.01
"""Offset between channels, in samples, up to which none is shifted."""


@dataclass(frozen=True, eq=False)
class _TdmsChannel:
    name: str
    unit: str | None
    values: FloatArray
    step: float | None
    offset: float
    start: int | None = None
    """Stated start, ns since 1970; None without."""
    stated_start: str = ""
    """A start that another property than the format's own states."""
    factor: str = ""


_Groups: TypeAlias = dict[str, list[_TdmsChannel]]


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the channels of a TDMS file, one segment for each group.

    Raises
    ------
    ReadError
        If groups hold different channels (name one with ``--file-part sheet``), or channels of one
        group differ in length and have no clock.
    """
    import_extra("nptdms", "npTDMS", "TDMS files")
    from dashpot.extensions.formats.tdms_segments import SegmentReader

    notes: list[str] = []
    with raw.open() as stream:
        file = SegmentReader(stream)
        file.read_metadata()
        objects = file.object_metadata
        limits.check_value_count(
            sum(item.num_values for item in objects.values()), "the channels hold"
        )
        _refuse_unknown_scales(objects)
        is_converted = _is_scaled(objects) or any(map(_is_stamped, objects.values()))
        groups = _choose_groups(
            _read_scaled_channels(stream, objects, notes)
            if is_converted
            else _read_stored_channels(file, notes),
            options.sheet,
        )
        window_lines = [
            line
            for item in objects.values()
            for key, value in item.properties.items()
            if (line := window_line(str(key), value))
        ]
    blocks = [_make_block(channels, notes) for channels in groups.values()]
    first = next(iter(groups.values()))
    factors = _note_stated_factors(objects, first, notes)
    columns = [Column(c.name, c.unit, factor=c.factor or factors.get(c.name, "")) for c in first]
    rates = _list_stated_rates(objects)
    stated_rates = [rate for rate in rates if ".wf_" not in rate.name]
    refuse_different_rates([rate for rate in stated_rates if _PATH.match(rate.name)])
    notes += contradict_rate(stated_rates, options.rate)
    if blocks[0].shape[1] > len(first):
        columns.insert(0, Column("time", "s"))
    starts = np.cumsum([0, *(len(block) for block in blocks[:-1])])
    return FileTable(
        format="TDMS",
        columns=tuple(columns),
        load=make_loader(np.concatenate(blocks), tuple(map(int, starts)), tuple(groups)),
        notes=tuple(dict.fromkeys(notes)),
        header=tuple(dict.fromkeys(window_lines)),
        hints=rate_hints(rates),
    )


def _choose_groups(new_channels: _Groups, sheet: str | None) -> _Groups:
    """Return the groups with numbers, or the one named; all with the same channels."""
    groups = {name: channels for name, channels in new_channels.items() if channels}
    if sheet is not None:
        if sheet not in groups:
            raise ReadError(f"--file-part sheet={sheet}: the groups are {_list(groups)}")
        groups = {sheet: groups[sheet]}
    if not groups:
        raise ReadError("this TDMS file holds no numeric channels")
    if len({tuple((c.name, c.unit) for c in channels) for channels in groups.values()}) > 1:
        raise ReadError(
            f"groups {_list(groups)} hold different channels; choose one with --file-part sheet="
            f'"{next(iter(groups))}"'
        )
    return groups


def _is_scaled(objects: Mapping[str, Any]) -> bool:
    """Return whether a channel, its group or the file states that its data need scaling."""
    return any(
        item.scaler_data_types or any(key.startswith(_SCALED) for key in item.properties)
        for item in objects.values()
    )


def _refuse_unknown_scales(objects: Mapping[str, Any]) -> None:
    """Refuse a scale that npTDMS does not know: its data would be unscaled."""
    for path, item in objects.items():
        if item.properties.get("NI_Scaling_Status", "unscaled") == "scaled":
            continue  # applied already
        for key, kind in item.properties.items():
            if _SCALE_TYPE.fullmatch(key) and str(kind) not in _KNOWN_SCALES:
                raise ReadError(
                    f"'{path}' is scaled by '{kind}' ({key}), a scale that is not known here: its "
                    "numbers would be counts; let the program that recorded it write scaled "
                    "values, or export the file as text"
                )


def _is_stamped(item: Any) -> bool:
    """Return whether a channel holds instants."""
    return getattr(item.data_type, "__name__", "") == "TimeStamp"


def _note_stated_factors(
    objects: Mapping[str, Any], channels: Sequence[_TdmsChannel], notes: list[str]
) -> dict[str, str]:
    """Return stated factors of channels; note those that belong to no channel."""
    owners = {tuple(words_of_name(split_unit(c.name)[0])): c for c in channels}
    factors: dict[str, str] = {}
    for path, item in objects.items():
        if _PATH.fullmatch(path):
            continue
        for key, value in item.properties.items():
            factors_text, full_scale = _list_factors({key: value}), split_full_scale(str(key))
            words = (
                select_channel_words(str(key)) if full_scale is None else words_of_name(full_scale)
            )
            owner = owners.get(tuple(words))
            if owner and full_scale:
                factors_text = describe_full_scale(owner.values, str(key), value)
            if factors_text and owner:
                factors[owner.name] = factors_text
            elif factors_text:
                note = f"'{path}' states {factors_text}; no factor is applied to the numbers"
                notes.append(Caution(note))
    return factors


def _list_stated_rates(objects: Mapping[str, Any]) -> list[NamedArray]:
    """Return the sampling rates in properties that are not the format's own."""
    return [
        NamedArray(f"{path}.{key}", np.array(float(value)))
        for path, item in objects.items()
        for key, value in item.properties.items()
        if isinstance(value, int | float) and stated_rate(key, 1.0) > 0
    ]


def _list_factors(properties: Mapping[str, Any]) -> str:
    """Return the factors stated in properties, without those that the format itself defines."""
    return factors_among(_list_foreign_properties(properties))


def _list_foreign_properties(properties: Mapping[str, Any]) -> dict[str, Any]:
    """Return the properties that the format itself does not define."""
    return {key: value for key, value in properties.items() if not key.startswith(("NI_", "wf_"))}


def _read_stored_channels(file: Any, notes: list[str]) -> _Groups:
    """Return the channels of a file as they are stored.

    The channel objects of npTDMS need twice the memory of their data, so they are not created here.
    """
    objects: Mapping[str, Any] = file.object_metadata
    parts: dict[str, list[FloatArray]] = {}
    for path, item in objects.items():
        kind = getattr(item.data_type, "nptype", None)
        if kind is not None and kind.kind in _NUMBERS:
            parts[path] = []
    for chunk in file.read_raw_data():
        for path, part in chunk.channel_data.items():
            if path in parts:
                parts[path].append(part.data)
    groups: _Groups = {}
    for path, arrays in parts.items():
        values = np.concatenate(arrays) if len(arrays) > 1 else arrays[0] if arrays else _NONE
        if values.size:
            group, name = _split_path(path)
            channel = _make_channel(name, objects[path].properties, values, notes)
            groups.setdefault(group, []).append(channel)
    return groups


def _split_path(path: str) -> list[str]:
    """Return the names of a channel's group and of the channel."""
    match = _PATH.fullmatch(path)
    if match is None:
        raise ReadError(f"this TDMS file keeps numbers under '{path}', which names no channel")
    return [group.replace("''", "'") for group in match.groups()]


def _read_scaled_channels(stream: Any, objects: Mapping[str, Any], notes: list[str]) -> _Groups:
    """Return the channels of a file as npTDMS scales them, instants as seconds since the first."""
    from nptdms import TdmsFile

    stream.seek(0)
    groups: _Groups = {}
    for group in TdmsFile.read(stream, raw_timestamps=True).groups():
        instants: list[tuple[int, Any]] = []
        channels = groups.setdefault(group.name, [])
        for channel in group.channels():
            values = channel[:]
            properties = objects[channel.path].properties  # as the first segment states them
            if hasattr(values, "as_datetime64"):
                instants.append((len(channels), values.as_datetime64("ns")))
                values = np.zeros(len(values))
                properties = {"unit_string": "s"}
            values = np.asarray(values)
            if values.size and values.dtype.kind in _NUMBERS:
                channels.append(_make_channel(channel.name, properties, values, notes))
        nonempty_instants = [(channel_index, item) for channel_index, item in instants if len(item)]
        first = min((item[0] for _, item in nonempty_instants), default=None)
        for channel_index, value in nonempty_instants:
            seconds = (value - first) / np.timedelta64(1, "s")
            channels[channel_index] = replace(channels[channel_index], values=seconds)
    return groups


def _make_channel(
    name: str, properties: Mapping[str, Any], values: FloatArray, notes: list[str]
) -> _TdmsChannel:
    unit = next((text for key in _UNITS if (text := str(properties.get(key, ""))).strip()), None)
    step = float(properties.get("wf_increment") or 0.0)
    offset = float(properties.get("wf_start_offset", 0.0))
    values = values.astype(float, copy=False)
    abscissa_unit = units.find_unit(
        str(properties.get("wf_xunit_string", "")).strip() or "s", "time"
    )
    entries = {
        key: value
        for key, value in _list_foreign_properties(properties).items()
        if concerns_numbers(key)
    }
    values, factor = apply_attributes(name, values, entries, notes)
    start = _start(properties.get("wf_start_time"))
    names = (key for key in properties if names_start(key) and not key.startswith("wf_"))
    text = ", ".join(f"{key} = {properties[key]}" for key in names)
    if not step or abscissa_unit is None:  # over frequency it has no clock
        return _TdmsChannel(name, unit, values, None, offset, start, text, factor)
    clock = abscissa_unit.factor * step, abscissa_unit.factor * offset
    return _TdmsChannel(name, unit, values, *clock, start, text, factor)


def _start(start: Any) -> int | None:
    """Return a stated start, ns since 1970; None if missing or the zero of LabVIEW's clock."""
    if hasattr(start, "as_datetime64"):
        start = start.as_datetime64("ns")
    if not isinstance(start, np.datetime64) or np.isnat(start):
        return None
    nanoseconds = int(start.astype("datetime64[ns]").astype(np.int64))
    return nanoseconds if nanoseconds > _UNSET else None


def _apply_start_times(channels: list[_TdmsChannel]) -> list[_TdmsChannel]:
    """Return the channels, each later by as much as its stated start is after the first one's.

    A channel without a start time began with the first.
    """
    if len({channel.stated_start for channel in channels}) > 1:
        starts_text = ", ".join(
            f"'{c.name}' {c.stated_start or 'says nothing'}" for c in channels[:6]
        )
        raise ReadError(
            f"the channels are said to start at different times ({starts_text}), and not by "
            "wf_start_time, which would be applied: export them on one clock"
        )
    starts = [channel.start for channel in channels if channel.start is not None]
    first = min(starts, default=0)
    delays = [1e-9 * ((channel.start or first) - first) for channel in channels]
    if not any(delays):
        return channels
    if all(channel.step is None for channel in channels):
        raise ReadError(
            f"the channels start up to {max(delays):.6g} s apart (wf_start_time) and have no "
            "clock: when each sample was taken is not known; export them on one clock"
        )
    return [
        replace(channel, offset=channel.offset + delay)
        for channel, delay in zip(channels, delays, strict=True)
    ]


def _make_block(channels: list[_TdmsChannel], notes: list[str]) -> FloatArray:
    """One group as rows: with its time in front if the channels carry it."""
    channels = _apply_start_times(channels)
    steps = {channel.step for channel in channels}
    if len(steps) > 1:
        return _make_block_of_rates(channels, notes)
    step, sizes = steps.pop(), sorted({channel.values.size for channel in channels})
    values, offset = [channel.values for channel in channels], channels[0].offset
    if step is None:
        if len(sizes) > 1:
            raise ReadError(f"channels differ in length ({sizes}) and have no clock")
        return np.array(values).T
    if sizes == sizes[:1] != [1] and all(channel.offset == offset for channel in channels):
        return np.array([offset + step * np.arange(sizes[0], dtype=float), *values]).T
    time = _find_common_times(channels, step)
    return np.array([time, *(_align_channel(c, time, step, notes) for c in channels)]).T


def _make_block_of_rates(channels: list[_TdmsChannel], notes: list[str]) -> FloatArray:
    """Return one group of several rates as rows on one clock."""
    if any(channel.step is None for channel in channels):
        steps_text = ", ".join(f"'{c.name}' {c.step} s" for c in channels[:6])
        raise ReadError(
            f"channels are sampled at different steps ({steps_text}); export them at one rate"
        )
    sampled_channels = [
        SampledChannel(
            c.name, c.offset + (c.step or 0.0) * np.arange(c.values.size, dtype=float), c.values
        )
        for c in channels
    ]
    return interpolate_to_slowest(sampled_channels, notes)


def _find_common_times(channels: list[_TdmsChannel], step: float) -> FloatArray:
    """Return the times at which every channel was sampled."""
    start = max(channel.offset for channel in channels)
    end = min(channel.offset + step * (channel.values.size - 1) for channel in channels)
    count = int(np.floor((end - start) / step + 1e-6)) + 1
    if count < 2:
        raise ReadError("the channels do not overlap in time (wf_start_time, wf_start_offset)")
    return start + step * np.arange(count, dtype=float)


def _align_channel(
    channel: _TdmsChannel, time: FloatArray, step: float, notes: list[str]
) -> FloatArray:
    """Return a channel's samples at the common times, interpolated unless they coincide."""
    shift = (time[0] - channel.offset) / step
    whole_samples = round(shift)
    if abs(shift - whole_samples) <= _SHIFT_TOLERANCE:
        if whole_samples:
            notes.append(
                f"'{channel.name}' starts {whole_samples} samples before the others: aligned"
            )
        return channel.values[whole_samples : whole_samples + len(time)]
    notes.append(
        f"'{channel.name}' starts {shift:.2f} samples before the others: shifted by straight lines "
        "between its samples, which dulls what is near half the sampling rate"
    )
    values = channel.offset + step * np.arange(channel.values.size)
    return np.interp(time, values, channel.values)


def _list(groups: _Groups) -> str:
    return ", ".join(f"'{name}'" for name in list(groups)[:8])
