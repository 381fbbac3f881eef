"""Factors, fill values, starts and clocks that HDF5, MAT and text files state beside numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from kit.foreign.files import format_table, press_and_hold
from nptdms import ChannelObject, RootObject, TdmsWriter
from scipy.io import savemat

from dashpot.base.errors import ReadError
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

RATE = 20.0
TIME, DISPLACEMENT, FORCE = press_and_hold(RATE)
UNITS = {"time": "s", "displacement": "mm", "force": "N"}
COLUMNS = {"time": TIME, "displacement": DISPLACEMENT, "force": FORCE}


def hdf5(path: Path, *, leave: tuple[str, ...] = (), of_file: dict[str, Any] | None = None,
         stored: Any = FORCE, **attributes: dict[str, Any]) -> Path:  # fmt: skip
    """The record, `stored` being its force; attributes are those of each dataset by its name."""
    with h5py.File(path, "w") as file:
        file.attrs.update(of_file or {})
        for name, values in COLUMNS.items():
            if name not in leave:
                data = file.create_dataset(name, data=stored if name == "force" else values)
                data.attrs["units"] = UNITS[name]
                data.attrs.update(attributes.get(name, {}))
    return path


# the CF conventions


def pack_force(scale: float, offset: float, kind: str) -> np.ndarray:
    return np.round((FORCE - offset) / scale).astype(kind)


@pytest.mark.parametrize("kind", ["i2", "i4", "f4", "f8"])
@pytest.mark.parametrize(("scale", "offset"), [(1e-3, 0.0), (2e-3, 5.0), (0.1, 0.0)])
def test_scale_and_offset_of_cf_are_applied(
    tmp_path: Path, kind: str, scale: float, offset: float
) -> None:
    values = {"scale_factor": scale, **({"add_offset": offset} if offset else {})}
    path = hdf5(tmp_path / "a.h5", stored=pack_force(scale, offset, kind), force=values)
    test = read_relaxation(path)
    np.testing.assert_allclose(test.force, FORCE, atol=0.51 * scale)
    assert not test.source.cautions  # a rule of the format: nothing is in doubt
    assert any("scale_factor" in note for note in test.source.notes)


@pytest.mark.parametrize("scale", ["0.001", b"1e-3"])
def test_a_scale_that_is_written_as_text_is_applied(tmp_path: Path, scale: str | bytes) -> None:
    path = hdf5(
        tmp_path / "a.h5", stored=pack_force(1e-3, 0.0, "i4"), force={"scale_factor": scale}
    )
    np.testing.assert_allclose(read_relaxation(path).force, FORCE, atol=0.51e-3)


def test_a_scale_that_is_no_number_is_refused(tmp_path: Path) -> None:
    path = hdf5(
        tmp_path / "a.h5", stored=pack_force(1e-3, 0.0, "i4"), force={"scale_factor": "x10"}
    )
    with pytest.raises(ReadError, match="'x10', which is no number"):
        read_relaxation(path)


def test_a_scale_of_named_fields_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    fields = np.dtype([("time", "f8"), ("displacement", "f8"), ("force", "f8")])
    with h5py.File(path, "w") as file:
        data = file.create_dataset("data", data=np.zeros(len(FORCE), fields))
        data.attrs["scale_factor"] = np.array([1.0, 1.0, 10.0])
    with pytest.raises(ReadError, match="named fields and states scale_factor"):
        read_relaxation(path)


@pytest.mark.parametrize(
    "values",
    [
        {"_FillValue": np.int32(-9990)}, {"missing_value": np.array([-9990, 7])},
        {"valid_range": np.array([-100, 1 << 20])}, {"valid_min": -100},
        {"_FillValue": np.float32(-9990), "scale_factor": 1.0},
    ],
)  # fmt: skip
def test_fill_values_are_no_numbers(tmp_path: Path, values: dict[str, Any]) -> None:
    scale = 1e-3
    stored = pack_force(scale, 0.0, "i4")
    gaps = [700, 710, 711]
    stored[gaps] = -9990
    path = hdf5(tmp_path / "a.h5", stored=stored, force={"scale_factor": scale, **values})
    if values.get("scale_factor"):
        path = hdf5(tmp_path / "b.h5", stored=np.where(stored == -9990, -9990, FORCE), force=values)
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, np.delete(TIME, gaps))
    np.testing.assert_allclose(test.force, np.delete(FORCE, gaps), atol=scale)


def test_a_zero_of_the_clock_as_cf_writes_it(tmp_path: Path) -> None:
    values = {"units": "milliseconds since 2026-03-01 08:00:00"}
    path = hdf5(tmp_path / "a.h5", time=values)
    with h5py.File(path, "r+") as file:
        file["time"][...] = 1e3 * TIME
    np.testing.assert_allclose(read_relaxation(path).time, TIME, atol=1e-9)


# one rule for fill values, full scales, signs and steps


def write_hdf5(path: Path, values: Any, message: dict[str, Any], of_file: dict[str, Any]) -> None:
    hdf5(path, stored=values, force=message, of_file=of_file)


def write_tdms(path: Path, values: Any, message: dict[str, Any], of_file: dict[str, Any]) -> None:
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([RootObject(of_file)] + [
            ChannelObject("a", name, values if name == "force" else column, properties={
                "unit_string": UNITS[name], **(message if name == "force" else {})})
            for name, column in COLUMNS.items()
        ])  # fmt: skip


def write_matlab(path: Path, values: Any, message: dict[str, Any], of_file: dict[str, Any]) -> None:
    content = {name: {"data": column, "unit": UNITS[name]} for name, column in COLUMNS.items()}
    content["force"] |= {"data": values, **message}
    savemat(path, content | of_file, appendmat=False)


WRITERS = {"hdf5": write_hdf5, "tdms": write_tdms, "matlab": write_matlab}
STATED = {
    "parts of full scale": (FORCE / 50, {"full_scale": 50.0}, {}, "full_scale = 50"),
    "counts": (np.round(FORCE * 655), {"FullScale": 50.0}, {}, "FullScale = 50"),
    "full scale in the file": (FORCE / 50, {}, {"force_full_scale": 50.0}, "full_scale = 50"),
    "gain in the file": (FORCE, {}, {"force_gain": 10.0}, "force_gain = 10"),
    "x10": (FORCE, {"scale": "x10"}, {}, "scale = x10"),
    "multiply": (FORCE, {"multiply_by": 10.0}, {}, "multiply_by = 10"),
    "turned": (FORCE, {"polarity": "inverted"}, {}, "polarity = inverted"),
    "formula": (FORCE / 10, {"calibration": "y = 10*x"}, {}, "calibration = y = 10"),
    "words and a formula": (FORCE / 10, {"cal": "F = 10 N/V * U"}, {}, "cal = F = 10 N/V"),
}
UNCHANGED = {
    "full scale": {"full_scale": 50.0}, "polarity": {"polarity": "normal"},
    "range": {"range": 20.0}, "sign": {"sign": 1.0}, "date": {"calibration": "2026-01-07"},
    "certificate": {"calibration": "DKD-K-12345 of 07.01.2026"},
}  # fmt: skip


@pytest.mark.parametrize("form", WRITERS)
@pytest.mark.parametrize("case", STATED)
def test_read_asks_what_changes_the_numbers_in_every_format(
    tmp_path: Path, form: str, case: str
) -> None:
    values, message, of_file, says = STATED[case]
    WRITERS[form](tmp_path / "a", values, message, of_file)
    with pytest.raises(ReadError, match=f"stated beside its numbers, .*{says}"):
        read_relaxation(tmp_path / "a")


@pytest.mark.parametrize("form", WRITERS)
@pytest.mark.parametrize("values", UNCHANGED.values(), ids=UNCHANGED)
def test_read_takes_what_changes_no_number(
    tmp_path: Path, form: str, values: dict[str, Any]
) -> None:
    WRITERS[form](tmp_path / "a", FORCE, values, {})
    assert not read_relaxation(tmp_path / "a").source.cautions


@pytest.mark.parametrize("form", WRITERS)
@pytest.mark.parametrize("name", ["fill_value", "NoData", "missing"])
def test_fill_values_of_any_name_are_no_numbers(tmp_path: Path, form: str, name: str) -> None:
    gone = (TIME > 20) & (TIME < 20.3)
    WRITERS[form](tmp_path / "a", np.where(gone, -12345.0, FORCE), {name: -12345.0}, {})
    test = read_relaxation(tmp_path / "a")
    np.testing.assert_allclose(test.force, FORCE[~gone])
    assert any("'force' are stated to be none" in note for note in test.source.notes)


@pytest.mark.parametrize("form", WRITERS)
def test_a_rate_that_contradicts_the_stated_step_is_a_caution(tmp_path: Path, form: str) -> None:
    held = COLUMNS.pop("time")
    try:
        WRITERS[form](tmp_path / "a", FORCE, {"dt": 1 / RATE}, {})
    finally:
        COLUMNS["time"] = held
    assert not read_relaxation(tmp_path / "a", options=ReadOptions(rate=RATE)).source.cautions
    other = read_relaxation(tmp_path / "a", options=ReadOptions(rate=10.0))
    assert any("where --rate 10Hz is given" in note for note in other.source.cautions)


# factors that no rule of the format applies

FACTORS = {
    "scale": 0.1, "Gain": 10.0, "slope": 0.5, "calibration": 2.5, "sensitivity": "22.5 mV/N",
    "offset": 0.5, "Cal_Factor": "10", "calibration_coefficients": np.array([0.0, 0.1]),
    "Faktor": "0,1", "force_scale": 3.0, "counts_per_N": 10.0, "scalefactor": 0.1,
    "divisor": 10, "polynomial": [0.0, 0.1], "lever_ratio": 2.0, "bias": -2.0,
    "amplification": np.array([200.0]),
}  # fmt: skip
NEUTRAL = {
    "scale": 1.0, "gain": "1", "offset": 0.0, "calibration_date": "2026-01-07", "bias": 0,
    "calibration": "certificate A", "full_scale": 500.0, "serial": 4711, "coefficients": [0.0, 0.0],
}  # fmt: skip


@pytest.mark.parametrize(("name", "value"), FACTORS.items(), ids=FACTORS.keys())
def test_hdf5_asks_about_a_stated_factor(tmp_path: Path, name: str, value: Any) -> None:
    path = hdf5(tmp_path / "a.h5", force={name: value})
    with pytest.raises(ReadError, match=rf"stated beside its numbers, {name} = "):
        read_relaxation(path)
    assert any(name in question.message for question in inspect_file(path).questions)
    sure = ReadOptions(units={"force": "N"})
    np.testing.assert_allclose(read_relaxation(path, options=sure).force, FORCE)
    tenfold = ReadOptions(units={"force": "10N"})
    np.testing.assert_allclose(read_relaxation(path, options=tenfold).force, 10 * FORCE)


@pytest.mark.parametrize(("name", "value"), list(NEUTRAL.items())[:-1])
def test_hdf5_accepts_attributes_that_change_no_number(
    tmp_path: Path, name: str, value: Any
) -> None:
    test = read_relaxation(hdf5(tmp_path / "a.h5", force={name: value}))
    np.testing.assert_allclose(test.force, FORCE)
    assert not test.source.cautions


def test_a_factor_of_the_whole_file_is_a_caution_or_that_of_its_column(tmp_path: Path) -> None:
    whole = hdf5(tmp_path / "a.h5", of_file={"gain": 10.0})
    assert any("gain = 10" in note for note in read_relaxation(whole).source.cautions)
    named = hdf5(tmp_path / "b.h5", of_file={"force_gain": 10.0})
    with pytest.raises(ReadError, match="force_gain = 10"):
        read_relaxation(named)


def test_mat_asks_about_factors_of_structs(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    fields = {
        name: {"data": values, "unit": UNITS[name], **({"gain": 10.0} if name == "force" else {})}
        for name, values in COLUMNS.items()
    }
    savemat(path, {"run": fields})
    with pytest.raises(ReadError, match="gain = 10"):
        read_relaxation(path)
    savemat(
        path,
        {"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_N": FORCE, "force_scale": 0.1},
    )
    with pytest.raises(ReadError, match=r"force_scale = 0\.1"):
        read_relaxation(path)
    savemat(path, {"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_N": FORCE, "gain": 10.0})
    assert any("gain = 10" in note for note in read_relaxation(path).source.cautions)


# clocks


RATES = {
    "sample_rate": RATE, "SamplingRate": RATE, "fs": RATE, "dt": 1 / RATE,
    "sampling_interval_ms": 1e3 / RATE, "wf_increment": 1 / RATE, "sample_rate_kHz": RATE / 1e3,
    "SampleInterval": f"{1e3 / RATE:g} ms",
}  # fmt: skip


@pytest.mark.parametrize(("name", "value"), RATES.items(), ids=RATES.keys())
@pytest.mark.parametrize("of", ["file", "dataset"])
def test_hdf5_asks_for_the_rate_of_a_clock_attribute(
    tmp_path: Path, name: str, value: Any, of: str
) -> None:
    message = {"of_file": {name: value}} if of == "file" else {"force": {name: value}}
    path = hdf5(tmp_path / "a.h5", leave=("time",), **message)
    assert recognise(path).kind == "relaxation"
    with pytest.raises(ReadError, match=f"--rate {RATE:g}Hz"):
        read_relaxation(path)
    np.testing.assert_allclose(
        read_relaxation(path, options=ReadOptions(rate=RATE)).time, TIME, atol=1e-9
    )


TEXTS = {
    "an interval": "Sampling interval: 50 ms\ndisplacement [mm];force [N]",
    "an interval in German": "Abtastintervall [s]: 0,05\ndisplacement [mm];force [N]",
    "a rate": "Sample rate: 20 Hz\ndisplacement [mm];force [N]",
    "nothing": "displacement [mm];force [N]",
    "dt": "# dt = 0.05 s\ndisplacement [mm];force [N]",
}


@pytest.mark.parametrize("head", TEXTS.values(), ids=TEXTS.keys())
def test_a_hold_without_a_clock_is_no_cld(tmp_path: Path, head: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(format_table(head, (DISPLACEMENT, FORCE)))
    assert recognise(path).kind == "relaxation"
    requested = "--rate 1000Hz" if head == TEXTS["nothing"] else f"--rate {RATE:g}Hz"
    with pytest.raises(ReadError, match=requested):
        read_relaxation(path)


def test_read_asks_about_a_time_in_metres(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(
        format_table("Time (m);displacement [mm];force [N]", (TIME / 60, DISPLACEMENT, FORCE))
    )
    assert recognise(path).kind == "relaxation"
    with pytest.raises(ReadError, match="'Time' is labelled 'm'"):
        read_relaxation(path)


def test_a_press_and_release_without_a_clock_is_a_cld(tmp_path: Path) -> None:
    x = np.concatenate([np.linspace(0, 8, 200), np.linspace(8, 0, 200)])
    path = tmp_path / "a.csv"
    path.write_text(format_table("displacement [mm];force [N]", (x, x + 0.1 * x**2)))
    assert recognise(path).kind == "cld"


@pytest.mark.parametrize(
    "name", ["t0", "start_time", "StartOffset", "wf_start_offset", "delay_s", "trigger_offset"]
)
def test_hdf5_refuses_channels_with_different_starts(tmp_path: Path, name: str) -> None:
    for message in ({"displacement": {name: 0.0}, "force": {name: 0.1}}, {"force": {name: 0.1}}):
        path = hdf5(tmp_path / "a.h5", leave=("time",), **message)
        with pytest.raises(ReadError, match=f"start at different times.*{name} = 0.1"):
            read_relaxation(path, options=ReadOptions(rate=RATE))
    both = hdf5(tmp_path / "b.h5", displacement={name: 0.1}, force={name: 0.1})
    np.testing.assert_allclose(read_relaxation(both).force, FORCE)


def test_hdf5_refuses_groups_with_different_starts(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        for name in ("displacement", "force"):
            group = file.create_group(name)
            group.attrs["start_time"] = 0.1 * (name == "force")
            data = group.create_dataset("values", data=COLUMNS[name])
            data.attrs["units"] = UNITS[name]
    with pytest.raises(ReadError, match="start at different times"):
        read_relaxation(path, options=ReadOptions(rate=RATE))


def test_hdf5_asks_about_a_calibration_group(tmp_path: Path) -> None:
    path = hdf5(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        file["calibration/force"] = 0.1
        file["calibration/displacement"] = 1.0
    with pytest.raises(ReadError, match=r"calibration_force = 0\.1"):
        read_relaxation(path)


def test_channels_of_other_rates_are_refused(tmp_path: Path) -> None:
    values = {"displacement": {"sample_rate": 10.0}, "force": {"sample_rate": RATE}}
    path = hdf5(tmp_path / "a.h5", leave=("time",), **values)
    with pytest.raises(ReadError, match="different rates"):
        read_relaxation(path, options=ReadOptions(rate=RATE))


@pytest.mark.parametrize("kind", ["text", "numpy"])
def test_instants_of_hdf5_are_a_clock(tmp_path: Path, kind: str) -> None:
    stamps = np.datetime64("2026-03-01T08:00:00", "us") + np.round(1e6 * TIME).astype("m8[us]")
    path = hdf5(tmp_path / "a.h5", leave=("time",))
    with h5py.File(path, "r+") as file:
        if kind == "text":
            file["time"] = [str(item) + "Z" for item in stamps]
        else:
            file["time"] = stamps.astype(h5py.opaque_dtype(stamps.dtype))
    np.testing.assert_allclose(read_relaxation(path).time, TIME, atol=1e-6)
