"""TDMS files whose segments disagree, whose scales are unknown, or whose clocks are instants."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from kit.foreign.files import press_and_hold
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

from dashpot.base.errors import ReadError
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.relaxation import read_relaxation

RATE = 20.0
TIME, DISPLACEMENT, FORCE = press_and_hold(RATE)
HALF = len(TIME) // 2
UNITS = {"Displacement": "mm", "Force": "N"}
BEGUN = np.datetime64("2026-03-01T08:00:00", "us")
LINEAR = {
    "NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Linear",
    "NI_Scale[0]_Linear_Slope": 1.0, "NI_Scale[0]_Linear_Y_Intercept": 0.0,
    "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF, "NI_Scaling_Status": "unscaled",
}  # fmt: skip


def segment(part: slice, **more: Any) -> list[ChannelObject]:
    """Both channels of a part of the record, `more` being of the force."""
    channels = []
    for name, values in (("Displacement", DISPLACEMENT), ("Force", FORCE)):
        specific = {"wf_increment": 1 / RATE, "unit_string": UNITS[name]}
        specific |= more if name == "Force" else {}
        specific = {key: value for key, value in specific.items() if value is not None}
        channels.append(ChannelObject("g", name, values[part], specific))
    return channels


def save(path: Path, *segments: list[Any]) -> Path:
    with TdmsWriter(str(path)) as writer:
        for objects in segments:
            writer.write_segment(objects)
    return path


FIRST, SECOND = slice(0, HALF), slice(HALF, None)

OTHERWISE: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "a step": ({}, {"wf_increment": 0.1}, "wf_increment"),
    "a unit": ({}, {"unit_string": "kN"}, "unit_string"),
    "a unit of time": ({}, {"wf_xunit_string": "ms"}, "wf_xunit_string"),
    "a start that leaves a gap": (
        {"wf_start_offset": 0.0}, {"wf_start_offset": 100.0}, "wf_start_offset",
    ),
    "a start of the day that leaves a gap": (
        {"wf_start_time": BEGUN}, {"wf_start_time": BEGUN + np.timedelta64(100, "s")},
        "wf_start_time",
    ),
    "a slope": (LINEAR, LINEAR | {"NI_Scale[0]_Linear_Slope": 10.0}, "Linear_Slope"),
    "a scale where there was none": ({}, LINEAR, "NI_"),
    "a status of scaling": (LINEAR, LINEAR | {"NI_Scaling_Status": "scaled"}, "NI_Scaling_Status"),
}  # fmt: skip


@pytest.mark.parametrize(
    ("before", "after", "words"), OTHERWISE.values(), ids=list(OTHERWISE.keys())
)
def test_segments_that_disagree_are_refused(
    tmp_path: Path, before: dict[str, Any], after: dict[str, Any], words: str
) -> None:
    path = save(tmp_path / "a.tdms", segment(FIRST, **before), segment(SECOND, **after))
    with pytest.raises(ReadError, match="segment 2 of the file says") as refused:
        read_relaxation(path)
    assert words in str(refused.value)
    assert "'g'" in str(refused.value)


def test_segments_whose_group_or_file_is_scaled_otherwise_are_refused(tmp_path: Path) -> None:
    for owner in (RootObject, lambda more: GroupObject("g", more)):
        path = save(
            tmp_path / "a.tdms",
            [owner(LINEAR), *segment(FIRST)],
            [owner(LINEAR | {"NI_Scale[0]_Linear_Slope": 10.0}), *segment(SECOND)],
        )
        with pytest.raises(ReadError, match="Linear_Slope = 10"):
            read_relaxation(path)


def test_tdms_joins_continuing_segments(tmp_path: Path) -> None:
    """The same properties again, others that mean nothing, and starts where the last one ended."""
    for before, after in (({}, {}), ({"minimum": 1.0}, {"minimum": 2.0, "wf_samples": HALF})):
        path = save(tmp_path / "a.tdms", segment(FIRST, **before), segment(SECOND, **after))
        test = read_relaxation(path)
        np.testing.assert_allclose(test.time, TIME, atol=1e-9)
        np.testing.assert_allclose(test.force, FORCE)
    later = HALF / RATE
    after_it = BEGUN + np.timedelta64(round(later * 1e6), "us")
    for key, starts in (
        ("wf_start_time", (BEGUN, after_it)),
        ("wf_start_offset", (5.0, 5 + later)),
    ):
        segments = [
            [
                ChannelObject("g", item.channel, item.data, {**item.properties, key: start})
                for item in segment(part)
            ]
            for part, start in zip((FIRST, SECOND), starts, strict=True)
        ]
        test = read_relaxation(save(tmp_path / "b.tdms", *segments))
        np.testing.assert_allclose(test.time - test.time[0], TIME, atol=1e-9)
        np.testing.assert_allclose(test.force, FORCE)


def test_a_unit_corrected_after_the_last_sample_is_that_of_all(tmp_path: Path) -> None:
    """As a program that edits a property appends a segment without samples."""
    edit = [ChannelObject("g", "Force", np.empty(0), {"unit_string": "kN"})]
    path = save(tmp_path / "a.tdms", segment(slice(None)), edit)
    np.testing.assert_allclose(
        read_relaxation(path, options=ReadOptions(units={"force": "N"})).force, FORCE
    )


@pytest.mark.parametrize("kind", ["Spline", "linear ", "Custom"])
@pytest.mark.parametrize("of", ["channel", "group"])
def test_tdms_refuses_an_unknown_scale(tmp_path: Path, kind: str, of: str) -> None:
    scale = {"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": kind}
    more = scale if of == "channel" else {}
    group = GroupObject("g", scale if of == "group" else {})
    path = save(tmp_path / "a.tdms", [group, *segment(slice(None), **more)])
    with pytest.raises(ReadError, match=f"scaled by '{kind}'"):
        read_relaxation(path)
    status = scale | {"NI_Scaling_Status": "scaled"}  # what is stored is scaled already
    path = save(tmp_path / "b.tdms", segment(slice(None), **status))
    np.testing.assert_allclose(read_relaxation(path).force, FORCE)


@pytest.mark.parametrize("late", [2, 10])
def test_a_channel_that_started_later_is_shifted(tmp_path: Path, late: int) -> None:
    """Its first samples were never taken: the others of those instants have no partner."""
    started = BEGUN + np.timedelta64(round(late / RATE * 1e6), "us")
    channels = [
        ChannelObject("g", name, values, {"wf_increment": 1 / RATE, "unit_string": UNITS[name],
                                          "wf_start_time": start})
        for name, values, start in (
            ("Displacement", DISPLACEMENT, BEGUN), ("Force", FORCE[late:], started)
        )
    ]  # fmt: skip
    test = read_relaxation(save(tmp_path / "a.tdms", channels))
    np.testing.assert_allclose(test.displacement, 1e-3 * DISPLACEMENT[late:], atol=1e-12)
    np.testing.assert_allclose(test.force, FORCE[late:])


def test_tdms_refuses_different_starts_without_a_clock(tmp_path: Path) -> None:
    channels = [
        ChannelObject("g", name, values, {"unit_string": unit, "wf_start_time": start})
        for name, unit, values, start in (
            ("Time", "s", TIME, BEGUN), ("Displacement", "mm", DISPLACEMENT, BEGUN),
            ("Force", "N", FORCE, BEGUN + np.timedelta64(100, "ms")),
        )
    ]  # fmt: skip
    with pytest.raises(ReadError, match=r"0\.1 s apart"):
        read_relaxation(save(tmp_path / "a.tdms", channels))


def test_instants_are_a_clock(tmp_path: Path) -> None:
    stamps = BEGUN + np.round(TIME * 1e6).astype("timedelta64[us]")
    channels = [
        ChannelObject("g", "Time", stamps),
        *(
            ChannelObject("g", name, values, {"unit_string": UNITS[name]})
            for name, values in (("Displacement", DISPLACEMENT), ("Force", FORCE))
        ),
    ]
    path = save(tmp_path / "a.tdms", channels)
    assert recognise(path).kind == "relaxation"
    np.testing.assert_allclose(read_relaxation(path).time, TIME, atol=1e-6)


@pytest.mark.parametrize(("name", "value"), [("Gain", 10.0), ("sensor_offset", 0.5)])
def test_tdms_asks_about_an_operator_gain(tmp_path: Path, name: str, value: float) -> None:
    path = save(tmp_path / "a.tdms", segment(slice(None), **{name: value}))
    with pytest.raises(ReadError, match=f"{name} = {value:g}, which no rule of this format"):
        read_relaxation(path)
    sure = ReadOptions(units={"force": "N"})
    np.testing.assert_allclose(read_relaxation(path, options=sure).force, FORCE)
    neutral = {name: 1.0 if name == "Gain" else 0.0}
    path = save(tmp_path / "b.tdms", segment(slice(None), **neutral))
    np.testing.assert_allclose(read_relaxation(path).force, FORCE)


def test_a_factor_of_a_group_is_a_caution(tmp_path: Path) -> None:
    path = save(tmp_path / "a.tdms", [GroupObject("g", {"Gain": 10.0}), *segment(slice(None))])
    source = read_relaxation(path).source
    assert any("Gain = 10" in note for note in source.cautions)


def write_rates(path: Path, **steps: int) -> Path:
    """Each channel with every so many samples of the record, and a temperature once a second."""
    arrays = {"Displacement": (DISPLACEMENT, "mm"), "Force": (FORCE, "N"), "Temp": (TIME, "degC")}
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([
            ChannelObject("g", name, values[:: steps.get(name, 1)], {
                "unit_string": unit, "wf_increment": steps.get(name, 1) / RATE})
            for name, (values, unit) in arrays.items()
        ])  # fmt: skip
    return path


@pytest.mark.parametrize("slow", ["Force", "Displacement"])
def test_channels_of_two_rates_stand_at_the_instants_of_the_slower(
    tmp_path: Path, slow: str
) -> None:
    test = read_relaxation(write_rates(tmp_path / "a", Temp=20, **{slow: 2}))
    np.testing.assert_allclose(test.time, TIME[::2])
    np.testing.assert_allclose(test.force, FORCE[::2])
    np.testing.assert_allclose(test.displacement, 1e-3 * DISPLACEMENT[::2], rtol=1e-12)
    assert any("sampled at different steps" in note for note in test.source.notes)


def test_a_slow_temperature_does_not_thin_the_record(tmp_path: Path) -> None:
    test = read_relaxation(write_rates(tmp_path / "a", Temp=20))
    np.testing.assert_allclose(test.force, FORCE)
