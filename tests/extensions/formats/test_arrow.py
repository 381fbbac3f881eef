"""Parquet and Arrow files: units and factors of fields, clocks, and damaged ones."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.foreign.files import press_and_hold

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.arrow_schema import read_field_metadata
from dashpot.reading.formats import read_table
from dashpot.reading.raw_file import open_raw
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

WRITTEN = Path(__file__).parents[2] / "data" / "pyarrow"
TIME, MOVED, FORCE = press_and_hold(20.0)


@pytest.mark.parametrize("name", ["bench.parquet", "bench.arrow"])
def test_units_stand_in_the_metadata_of_fields(name: str) -> None:
    found = inspect_file(WRITTEN / name)
    assert [(c.name, c.unit) for c in found.columns] == [
        ("time", "s"), ("travel", "mm"), ("load", "kN"),
    ]  # fmt: skip
    test = read_relaxation(WRITTEN / name)
    assert test.time[-1] == pytest.approx(29.95)
    assert test.displacement.max() == pytest.approx(2e-3)
    assert test.force.max() == pytest.approx(100, rel=0.02)


def test_read_asks_about_a_factor() -> None:
    with pytest.raises(ReadError, match="gain = 10"):
        read_relaxation(WRITTEN / "gain.parquet")


@pytest.mark.parametrize("kind", ["parquet", "ipc"])
def test_units_stand_in_names_and_instants_are_a_clock(tmp_path: Path, kind: str) -> None:
    began = np.datetime64("2026-03-01T08:00:00", "us")
    instants = began + np.round(TIME * 1e6).astype("timedelta64[us]")
    frame = pl.DataFrame({"time": instants, "travel [mm]": MOVED, "force_kN": FORCE / 1e3})
    path = tmp_path / "a"
    (frame.write_parquet if kind == "parquet" else frame.write_ipc)(path)
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, TIME, atol=1e-9)
    np.testing.assert_allclose(test.force, FORCE, atol=1e-9)


def test_read_asks_for_missing_units(tmp_path: Path) -> None:
    pl.DataFrame({"time": TIME, "travel": MOVED, "force": FORCE}).write_parquet(tmp_path / "a")
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
    assert isinstance(read_field_metadata(b"\xff\xff\xff\xff" + data), dict)


def test_blank_cells_are_no_numbers(tmp_path: Path) -> None:
    values = [None if 300 < i < 305 else float(force) for i, force in enumerate(FORCE)]
    data = BytesIO()
    pl.DataFrame({"time_s": TIME, "travel_mm": MOVED, "force_N": values}).write_parquet(data)
    (tmp_path / "a").write_bytes(data.getvalue())
    assert len(read_relaxation(tmp_path / "a").force) == len(TIME) - 4
