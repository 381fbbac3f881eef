"""Tables of pandas, polars and xarray, mappings of arrays, and arrays, as records."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest
import xarray as xr
from kit.foreign.files import press_and_hold

import dashpot as dp
from dashpot.base.errors import DataError, ReadError

TIME, DISPLACEMENT, FORCE = press_and_hold(20.0)
COLUMNS = {"time [s]": TIME, "displacement [mm]": DISPLACEMENT, "force [N]": FORCE}
BARE = {"t": TIME, "x": DISPLACEMENT, "F": FORCE}


def stated_in_attributes() -> pd.DataFrame:
    frame = pd.DataFrame(BARE)
    frame.attrs["units"] = {"t": "s", "x": "mm", "F": "N"}
    return frame


def dataset(**of_force: Any) -> xr.Dataset:
    return xr.Dataset(
        {
            "force": ("time", FORCE, {"units": "N", **of_force}),
            "displacement": ("time", DISPLACEMENT, {"units": "mm"}),
        },
        coords={"time": ("time", TIME, {"units": "s"})},
    )


def make_time_stamped_frame() -> pd.DataFrame:
    began = np.datetime64("2026-03-01T08:00:00", "ns")
    index = pd.DatetimeIndex(began + np.round(TIME * 1e9).astype("timedelta64[ns]"))
    return pd.DataFrame({"travel_mm": DISPLACEMENT, "force_N": FORCE}, index=index)


def twice() -> pd.DataFrame:
    """Two columns of one name, as a join leaves them."""
    frame = pd.DataFrame(COLUMNS)
    return pd.concat([frame, frame[["force [N]"]]], axis=1)


def levels() -> pd.DataFrame:
    frame = pd.DataFrame(COLUMNS)
    frame.columns = pd.MultiIndex.from_tuples([("run 1", name) for name in COLUMNS])
    return frame


FRAMES = {
    "pandas": pd.DataFrame(COLUMNS), "polars": pl.DataFrame(COLUMNS), "mapping": dict(COLUMNS),
    "attributes": stated_in_attributes(), "xarray": dataset(),
    "instants": make_time_stamped_frame(),
    "words beside": pd.DataFrame(COLUMNS).assign(remark="a"),
    "instants of a zone": make_time_stamped_frame().tz_localize("Europe/Berlin"),
    "objects": pd.DataFrame(COLUMNS).astype(object),
    "nullable": pd.DataFrame(COLUMNS).astype("Float64"),
    "one name twice": twice(), "names of two levels": levels(),
    "lists": {name: list(values) for name, values in COLUMNS.items()},
}  # fmt: skip


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_read_takes_a_table_in_memory(frame: Any) -> None:
    test = dp.read(frame)
    np.testing.assert_allclose(test.force, FORCE, rtol=1e-14)
    np.testing.assert_allclose(test.time, TIME, atol=1e-9)
    np.testing.assert_allclose(test.displacement, DISPLACEMENT * 1e-3, rtol=1e-12)


def test_read_asks_for_units_of_a_table_with_the_line_to_type() -> None:
    with pytest.raises(ReadError, match=r"DataFrame: .* has no unit.*\(Python: dp\.read\(frame, "):
        dp.read(pd.DataFrame(BARE))
    message = dp.read(pd.DataFrame(BARE), units={"time": "s", "displacement": "mm", "force": "N"})
    np.testing.assert_allclose(message.force, FORCE)


def test_blank_cells_of_a_table_are_no_numbers() -> None:
    gone = (TIME > 20) & (TIME < 20.3)
    test = dp.read(pd.DataFrame(COLUMNS | {"force [N]": np.where(gone, np.nan, FORCE)}))
    np.testing.assert_allclose(test.force, FORCE[~gone])


def test_a_factor_in_attributes_is_a_caution() -> None:
    assert any("gain = 10" in note for note in dp.read(dataset(gain=10.0)).source.cautions)


def test_read_refuses_a_table_without_a_test() -> None:
    with pytest.raises(DataError, match=r"no column of numbers"):
        dp.read(pd.DataFrame({"a": ["b"]}))
    with pytest.raises(DataError, match=r"differ in length .*'force' 3"):
        dp.read({"time": TIME, "force": FORCE[:3]})
    with pytest.raises(ReadError) as error:
        dp.read({"time [s]": TIME})
    assert tempfile.gettempdir() not in str(error.value)


def test_fit_takes_tables_and_arrays_as_records() -> None:
    test = dp.RelaxationTest(TIME, DISPLACEMENT, FORCE, units="s, mm, N")
    expected = dp.fit(test, arms=2).model.k_inf
    arrays = dp.fit(TIME, DISPLACEMENT, FORCE, units="s, mm, N", arms=2)
    assert arrays.model.k_inf == pytest.approx(expected, rel=1e-9)
    assert dp.fit(pd.DataFrame(COLUMNS), arms=2).model.k_inf == pytest.approx(expected, rel=1e-9)
    message = dp.fit(pd.DataFrame(BARE), arms=2, units={"t": "s", "x": "mm", "F": "N"})
    assert message.model.k_inf == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("make", [pd.Series, pl.Series, xr.DataArray, np.array, list])
def test_fit_takes_columns_of_tables_as_arrays(make: Callable[[Any], Any]) -> None:
    """A Series was "no record that is fitted", where its values alone were."""
    test = dp.simulate("relaxation", hold="2s", rate="100Hz", noise_free=True)
    arrays = (test.time, 1e3 * test.displacement, test.force)
    fit = dp.fit(*map(make, arrays), units="s, mm, N", arms=1)
    assert fit.model == dp.fit(*arrays, units="s, mm, N", arms=1).model
    with pytest.raises(dp.DataError, match=r"units=\"s, mm, N\""):
        dp.fit(*map(make, arrays))


@pytest.mark.parametrize("make", [pd.Series, pl.Series, xr.DataArray])
def test_single_column_of_a_table_is_refused_with_what_to_give(make: Callable[[Any], Any]) -> None:
    for function in (dp.read, dp.inspect, dp.fit):
        with pytest.raises(dp.DataError, match=r"dp\.fit\(time, displacement, force, units="):
            function(make([1.0, 2.0]))
    with pytest.raises(dp.DataError, match="some that are no numbers"):
        dp.fit(make(["a", "b"]), make([1.0, 2.0]), make([1.0, 2.0]), units="SI")


def test_fit_shows_the_line_to_type_for_arrays() -> None:
    with pytest.raises(DataError, match=r"arrays have no units. Say them: dp\.fit\(time, "):
        dp.fit(TIME, DISPLACEMENT, FORCE)
    with pytest.raises(DataError, match=r"2 arrays are no test\. Give three"):
        dp.fit(TIME, FORCE, units="s, N")


@pytest.mark.parametrize("stated", ["daN", "kN", "lbf"])
def test_read_refuses_a_unit_that_contradicts_the_name(stated: str) -> None:
    frame = pd.DataFrame(COLUMNS)
    frame.attrs["units"] = {"force [N]": stated}
    with pytest.raises(ReadError, match=f"two units, N or {stated}"):
        dp.read(frame)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_inspect_takes_a_table_in_memory(frame: Any) -> None:
    assert dp.inspect(frame).kind == "relaxation"


def test_lists_and_units_by_role_are_arrays() -> None:
    units = {"time": "s", "displacement": "mm", "force": "N"}
    fit = dp.fit(list(TIME), list(DISPLACEMENT), list(FORCE), units=units, arms=1)
    assert fit.model == dp.fit(TIME, DISPLACEMENT, FORCE, units="s, mm, N", arms=1).model
    with pytest.raises(DataError, match="time, displacement, force"):
        dp.fit(TIME, DISPLACEMENT, FORCE, units={"time": "s"})
    with pytest.raises(DataError, match="one by one"):
        dp.fit([dp.read(FRAMES["pandas"])])


CLOCK = np.round(np.arange(0, 100, 0.1), 6)
STRAIN = 0.1 * np.clip((CLOCK - 5) / 2, 0, 1)


def material_stress(strain: np.ndarray) -> np.ndarray:
    """MPa: a spring of 3 and an arm of 1 with 10 s, exact for straight lines between samples."""
    arm, decay = np.zeros_like(strain), np.exp(-0.01)
    for i in range(1, len(strain)):
        arm[i] = decay * arm[i - 1] + (strain[i] - strain[i - 1]) * 100 * (1 - decay)
    noise = np.random.default_rng(5).normal(0, 2e-4, len(strain))
    return 3 * strain + arm + noise


STRESS = material_stress(STRAIN)
TABLE = pd.DataFrame({"time [s]": CLOCK, "strain": 100 * STRAIN, "stress": STRESS})
UNITS = {"strain": "%", "stress": "MPa"}


@pytest.mark.parametrize("units", ["s, %, MPa", {"time": "s", **UNITS}])
def test_fit_takes_arrays_of_strain_and_stress(units: Any) -> None:
    fit = dp.fit(CLOCK, 100 * STRAIN, STRESS, units=units)
    assert fit.unit == "Pa"
    assert fit.model.k_inf == pytest.approx(3e6, rel=0.01)
    assert dp.fit(TABLE, units=UNITS).model == fit.model


def test_fit_takes_arrays_of_loops() -> None:
    strain = 0.1 + 0.05 * np.sin(2 * np.pi * 0.25 * CLOCK)
    stress = material_stress(strain - 0.1) + 0.3
    material = dp.fit(CLOCK, 100 * strain, stress, units="s, %, MPa")
    part = dp.fit(CLOCK, 20 * strain, 50 * stress, units="s, mm, N")
    omega = 2 * np.pi * 0.25
    true = 3 + 10j * omega / (1 + 10j * omega)
    assert (material.unit, part.unit) == ("Pa", "N/m")
    assert complex(material.linear[0]) == pytest.approx(1e6 * true, rel=0.01)
    assert complex(part.linear[0]) == pytest.approx(2500 * true, rel=0.01)


@pytest.mark.parametrize(
    ("frame", "line"),
    [
        (TABLE, 'dp.read(frame, units={"strain": "%", "stress": "MPa"})'),
        (
            TABLE.rename(columns={"strain": "strain [%]", "stress": "stress [MPa]"}).assign(
                **{"strain B [%]": 110 * STRAIN}
            ),
            'dp.read(frame, columns={"strain": "strain"})',
        ),
        (
            pd.DataFrame({"strain [%]": 100 * STRAIN, "stress [MPa]": STRESS}),
            'dp.read(frame, rate="1000Hz")',
        ),
        (
            pd.DataFrame({
                "specimen": np.repeat(["A", "B"], len(CLOCK)), "time [s]": np.tile(CLOCK, 2),
                "strain [%]": np.tile(100 * STRAIN, 2), "stress [MPa]": np.tile(STRESS, 2),
            }),
            'dp.read(frame, part={"segment": 1})',
        ),
    ],
    ids=["units", "column", "rate", "specimen"],
)  # fmt: skip
def test_errors_of_a_table_show_the_line_to_type(frame: Any, line: str) -> None:
    with pytest.raises(ReadError) as caught:
        dp.read(frame)
    assert line in str(caught.value)
    if "1000Hz" not in line:  # an example of a rate, not the rate
        assert eval(line, {"dp": dp, "frame": frame}) is not None  # noqa: S307


@pytest.mark.parametrize("keywords", [{"test": "uniaxial"}, {"mass": "5g"}, {"role": "stop"}])
def test_read_refuses_keywords_of_another_kind(keywords: dict[str, str]) -> None:
    with pytest.raises(DataError, match=f"{next(iter(keywords))}= is for .*kind="):
        dp.read(TABLE, units=UNITS, **keywords)
    assert dp.read(TABLE, units=UNITS, kind="stress-strain", test="uniaxial").mode == "uniaxial"


def test_units_of_a_table_may_be_listed_in_the_order_of_its_columns():
    time = np.linspace(0.0, 10.0, 100)
    table = {"t": time, "x": 5 * np.minimum(time, 1), "F": np.minimum(time, 1) * np.exp(-time / 9)}
    listed = dp.read(table, units="s, mm, N")
    named = dp.read(table, units={"t": "s", "x": "mm", "F": "N"})
    assert np.array_equal(listed.displacement, named.displacement)
    with pytest.raises(DataError, match="units lists 2 units, and the table has 3 columns"):
        dp.read(table, units="s, mm")


@pytest.mark.parametrize("function", [dp.read, dp.inspect])
def test_a_bare_array_is_refused_with_what_to_give(function):
    with pytest.raises(DataError, match=r"shape \(20, 3\) has no names of columns"):
        function(np.zeros((20, 3)))
