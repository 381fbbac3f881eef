"""Parquet and Arrow files: units and factors of fields, clocks, and damaged ones."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.foreign.files import press_and_hold

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.arrow_schema import read_schema_metadata
from dashpot.reading.formats import read_table
from dashpot.reading.raw_file import open_raw
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

WRITTEN = Path(__file__).parents[2] / "data" / "pyarrow"
TIME, DISPLACEMENT, FORCE = press_and_hold(20.0)


@pytest.mark.parametrize("name", ["bench.parquet", "bench.arrow"])
def test_units_stand_in_the_metadata_of_fields(name: str) -> None:
    result = inspect_file(WRITTEN / name)
    assert [(c.name, c.unit) for c in result.columns] == [
        ("time", "s"), ("travel", "mm"), ("load", "kN"),
    ]  # fmt: skip
    test = read_relaxation(WRITTEN / name)
    assert test.time[-1] == pytest.approx(29.95)
    assert test.displacement.max() == pytest.approx(2e-3)
    assert test.force.max() == pytest.approx(100, rel=0.02)


UNITS = {"time": "s", "travel": "mm", "force": "N"}
FACTORS = {
    "of its column": ({"force.gain": "10"}, "gain = 10"),
    "named for its column": ({"force_gain": "10"}, "force_gain = 10"),
    "in JSON": ({"channels": json.dumps({"force": {"scale": 10}})}, "scale = 10"),
    "in a list": ({"s": json.dumps([{"name": "force", "gain": 7}])}, "gain = 7"),
    "offset": ({"force:offset": "0.5"}, "offset = 0.5"),
    "pandas": ({"pandas": json.dumps({"attributes": {"force": {"slope": 2}}})}, "slope = 2"),
    "full scale of parts": ({"force.full_scale": "5000 N"}, None),
    "full scale of counts": ({"force.full_scale": "5"}, "full_scale = 5"),
    "another unit": ({"force_unit": "daN"}, "N or daN"),
    "another unit in JSON": ({"units": json.dumps({"travel": "cm"})}, "mm or cm"),
}  # fmt: skip


def write_with_metadata(path: Path, metadata: dict[str, str]) -> Path:
    data = {"time": TIME, "travel": DISPLACEMENT, "force": FORCE}
    message = {f"{name}.unit": unit for name, unit in UNITS.items()}
    pl.DataFrame(data).write_parquet(path, metadata={**message, **metadata})
    return path


@pytest.mark.parametrize(("metadata", "says"), FACTORS.values(), ids=FACTORS)
def test_read_asks_what_metadata_of_the_file_state_of_a_column(
    tmp_path: Path, metadata: dict[str, str], says: str | None
) -> None:
    path = write_with_metadata(tmp_path / "a", metadata)
    if says is None:
        assert not read_relaxation(path).source.cautions
        return
    with pytest.raises(ReadError, match=says):
        read_relaxation(path)


@pytest.mark.parametrize(
    "metadata", [{"gain": "10"}, {"setup": json.dumps({"amplifier": {"gain": 10}})}]
)
def test_a_factor_of_the_whole_file_is_a_caution(tmp_path: Path, metadata: dict[str, str]) -> None:
    test = read_relaxation(write_with_metadata(tmp_path / "a", metadata))
    assert any("gain = 10" in note for note in test.source.cautions)


def test_fill_values_are_no_numbers(tmp_path: Path) -> None:
    gone = (TIME > 20) & (TIME < 20.3)
    data = {"time_s": TIME, "travel_mm": DISPLACEMENT, "force_N": np.where(gone, -12345.0, FORCE)}
    stated = {"force_N.fill_value": "-12345"}
    pl.DataFrame(data).write_parquet(tmp_path / "a", metadata=stated)
    test = read_relaxation(tmp_path / "a")
    np.testing.assert_allclose(test.force, FORCE[~gone])
    assert any("'force_N' are stated to be none" in note for note in test.source.notes)


@pytest.mark.parametrize(("steps", "says"), [
    ((0.05, 0.1), "sampled at different rates"), ((0.05, 0.05), None),
])  # fmt: skip
def test_steps_of_fields_are_compared_with_the_rate(
    tmp_path: Path, steps: tuple[float, float], says: str | None
) -> None:
    data = {"travel_mm": DISPLACEMENT, "force_N": FORCE}
    stated = {f"{name}.dt": str(step) for name, step in zip(data, steps, strict=True)}
    pl.DataFrame(data).write_parquet(tmp_path / "a", metadata=stated)
    if says:
        with pytest.raises(ReadError, match=says):
            read_relaxation(tmp_path / "a", options=ReadOptions(rate=20.0))
        return
    assert not read_relaxation(tmp_path / "a", options=ReadOptions(rate=20.0)).source.cautions
    other = read_relaxation(tmp_path / "a", options=ReadOptions(rate=10.0))
    assert any("20 Hz, where --rate 10Hz is given" in note for note in other.source.cautions)


def test_a_force_of_words_is_a_caution_where_another_takes_its_place(tmp_path: Path) -> None:
    words = [f"{force:.3f} N" for force in FORCE]
    data = {"time_s": TIME, "travel_mm": DISPLACEMENT, "force": words, "force ref_N": 2 * FORCE}
    pl.DataFrame(data).write_parquet(tmp_path / "a")
    test = read_relaxation(tmp_path / "a")
    assert any("'force' holds no numbers" in note for note in test.source.cautions)


def test_a_stream_of_arrow_is_read(tmp_path: Path) -> None:
    data = {"time_s": TIME, "travel_mm": DISPLACEMENT, "force_N": FORCE}
    pl.DataFrame(data).write_ipc_stream(tmp_path / "a")
    np.testing.assert_allclose(read_relaxation(tmp_path / "a").force, FORCE)


def test_read_asks_about_a_factor() -> None:
    with pytest.raises(ReadError, match="gain = 10"):
        read_relaxation(WRITTEN / "gain.parquet")


@pytest.mark.parametrize("kind", ["parquet", "ipc"])
def test_units_stand_in_names_and_instants_are_a_clock(tmp_path: Path, kind: str) -> None:
    began = np.datetime64("2026-03-01T08:00:00", "us")
    instants = began + np.round(TIME * 1e6).astype("timedelta64[us]")
    frame = pl.DataFrame({"time": instants, "travel [mm]": DISPLACEMENT, "force_kN": FORCE / 1e3})
    path = tmp_path / "a"
    (frame.write_parquet if kind == "parquet" else frame.write_ipc)(path)
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, TIME, atol=1e-9)
    np.testing.assert_allclose(test.force, FORCE, atol=1e-9)


def test_read_asks_for_missing_units(tmp_path: Path) -> None:
    pl.DataFrame({"time": TIME, "travel": DISPLACEMENT, "force": FORCE}).write_parquet(
        tmp_path / "a"
    )
    with pytest.raises(ReadError, match="--units"):
        read_relaxation(tmp_path / "a")
    options = ReadOptions(units={"time": "s", "displacement": "mm", "force": "N"})
    assert read_relaxation(tmp_path / "a", options=options).force.max() > 1


@pytest.mark.parametrize("kind", ["parquet", "ipc"])
def test_twelve_million_numbers_fit(tmp_path: Path, kind: str) -> None:
    many = pl.DataFrame({"time_s": np.arange(4e6)}).with_columns(
        pl.col("time_s").alias("travel_mm"), pl.col("time_s").alias("force_N"),
    )  # fmt: skip
    (many.write_parquet if kind == "parquet" else many.write_ipc)(tmp_path / "a")
    table = read_table(open_raw(tmp_path / "a"), ReadOptions())
    assert table.load([2]).values[-1, 0] == 4e6 - 1


def test_too_many_numbers_are_refused_before_they_are_read(tmp_path: Path) -> None:
    many = pl.select(pl.repeat(0.0, 1 << 25).alias("force_N")).with_columns(time_s=0.0)
    many.write_parquet(tmp_path / "a")
    assert (tmp_path / "a").stat().st_size < 1 << 20
    with pytest.raises(ReadError, match="the columns hold 67108864 numbers in all"):
        read_relaxation(tmp_path / "a")


@pytest.mark.parametrize("size", [6, 100, 1000])
def test_a_cut_file_is_refused(tmp_path: Path, size: int) -> None:
    for name in ("bench.parquet", "bench.arrow"):
        (tmp_path / name).write_bytes((WRITTEN / name).read_bytes()[:size])
        with pytest.raises(ReadError):
            read_relaxation(tmp_path / name)


@given(st.binary(max_size=200))
@settings(deadline=None)
def test_broken_metadata_says_nothing(data: bytes) -> None:
    assert len(read_schema_metadata(b"\xff\xff\xff\xff" + data)) == 2


def test_blank_cells_are_no_numbers(tmp_path: Path) -> None:
    values = [None if 300 < i < 305 else float(force) for i, force in enumerate(FORCE)]
    data = BytesIO()
    pl.DataFrame({"time_s": TIME, "travel_mm": DISPLACEMENT, "force_N": values}).write_parquet(data)
    (tmp_path / "a").write_bytes(data.getvalue())
    assert len(read_relaxation(tmp_path / "a").force) == len(TIME) - 4
