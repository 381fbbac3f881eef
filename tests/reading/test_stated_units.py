"""A unit in a channel's name and one stated beside it, in every format that can state both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeAlias

import h5py
import numpy as np
import pytest
from kit.foreign.files import format_table, press_and_hold
from kit.mdf_files import Channel, Group, mdf3, mdf4
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from dashpot.base.errors import ReadError
from dashpot.reading.columns.header_units import state_unit
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.table import Column

TIME, DISPLACEMENT, FORCE = press_and_hold(20.0)
ARRAYS = (TIME, DISPLACEMENT, FORCE)
Named: TypeAlias = Sequence[tuple[str, str]]


def write_mdf4(path: Path, named: Named) -> None:
    group = [Channel(*pair) for pair in zip_three(named)]
    group[0] = Channel("t", TIME, named[0][1], kind=2, sync=1)
    path.write_bytes(mdf4([Group(group)]))


def write_mdf3(path: Path, named: Named) -> None:
    group = [Channel(*pair) for pair in zip_three(named)]
    group[0] = Channel("t", TIME, named[0][1], sync=1)
    path.write_bytes(mdf3(group))


def zip_three(named: Named) -> list[tuple[str, np.ndarray, str]]:
    return [(name, values, unit) for (name, unit), values in zip(named, ARRAYS, strict=True)]


def write_hdf5(path: Path, named: Named) -> None:
    with h5py.File(path, "w") as file:
        for name, values, unit in zip_three(named):
            file[name] = values
            file[name].attrs["units"] = unit


def write_tdms(path: Path, named: Named) -> None:
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([
            ChannelObject("test", name, values, properties={"unit_string": unit})
            for name, values, unit in zip_three(named)
        ])  # fmt: skip


def write_matlab(path: Path, named: Named) -> None:
    savemat(
        path, {name: {"data": values, "unit": unit} for name, values, unit in zip_three(named)},
        appendmat=False,
    )  # fmt: skip


def write_text(path: Path, named: Named) -> None:
    names, words = zip(*named, strict=True)
    rows = [names, words, *zip(*(map("{:.7g}".format, values) for values in ARRAYS), strict=True)]
    path.write_text("\n".join(map(";".join, rows)) + "\n", "utf-8")


def write_lvm(path: Path, named: Named) -> None:
    names, words = zip(*named[1:], strict=True)
    head = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
        "Decimal_Separator\t.\nMulti_Headings\tYes\nX_Columns\tOne\nTime_Pref\tRelative\n"
        "***End_of_Header***\t\n\t\nChannels\t2\t\nSamples\t" + f"{len(TIME)}\t" * 2
        + "\nY_Unit_Label\t" + "\t".join(words) + "\nX0\t0.0\t0.0\nDelta_X\t0.05\t0.05\n"
        "***End_of_Header***\t\t\nX_Value\t" + "\t".join(names) + "\tComment\n"
    )  # fmt: skip
    rows = zip(*(map("{:.7g}".format, values) for values in ARRAYS), strict=True)
    path.write_text(head + "\n".join(map("\t".join, rows)) + "\n", "utf-8")


WRITERS: dict[str, Callable[[Path, Named], None]] = {
    "mdf4": write_mdf4, "mdf3": write_mdf3, "hdf5": write_hdf5, "tdms": write_tdms,
    "matlab": write_matlab, "text": write_text, "lvm": write_lvm,
}  # fmt: skip
CONTRADICT = {
    "daN": [("time", "s"), ("travel", "mm"), ("force_N", "daN")],
    "German": [("time", "s"), ("Weg", "mm"), ("Kraft [N]", "kN")],
    "another quantity": [("time", "s"), ("travel", "mm"), ("force_N", "mm")],
    "cm": [("time", "s"), ("travel_mm", "cm"), ("force", "N")],
}  # fmt: skip
AGREE = [("time", "s"), ("travel_mm", "mm"), ("force_N", "Newton")]


@pytest.mark.parametrize("case", CONTRADICT)
@pytest.mark.parametrize("form", WRITERS)
def test_read_asks_about_a_name_that_contradicts_the_unit(
    tmp_path: Path, form: str, case: str
) -> None:
    WRITERS[form](tmp_path / "a", CONTRADICT[case])
    with pytest.raises(ReadError, match=" or "):
        read_relaxation(tmp_path / "a")
    assert any(" or " in question.message for question in inspect_file(tmp_path / "a").questions)
    units = {"displacement": "mm"} if case == "cm" else {"force": "N"}
    sure = ReadOptions(units=units, displacement="2" if form == "lvm" else None)
    assert read_relaxation(tmp_path / "a", options=sure).force.max() == pytest.approx(
        FORCE.max(), rel=1e-6
    )


@pytest.mark.parametrize("form", WRITERS)
def test_read_takes_a_unit_that_stands_twice(tmp_path: Path, form: str) -> None:
    WRITERS[form](tmp_path / "a", AGREE)
    test = read_relaxation(tmp_path / "a")
    assert test.force.max() == pytest.approx(FORCE.max(), rel=1e-6)
    assert test.displacement.max() == pytest.approx(8e-3, rel=1e-6)


@pytest.mark.parametrize("form", ["mdf4", "tdms"])
def test_read_takes_a_unit_from_the_name(tmp_path: Path, form: str) -> None:
    WRITERS[form](tmp_path / "a", [("time", "s"), ("travel_mm", ""), ("force [kN]", "")])
    assert read_relaxation(tmp_path / "a").force.max() == pytest.approx(1e3 * FORCE.max())


@pytest.mark.parametrize(
    ("name", "unit", "stated"),
    [
        ("Force", "N", "N"), ("Force (cell)", None, None), ("Force (cell)", "N", "N"),
        ("Channel_1", None, None), ("Acc_g", "m/s^2", "g or m/s^2"), ("F_N", "[N]", "N"),
        ("Load [N] x 1000", "N", "x 1000 N"), ("Temp_C", "K", "C or K"),
    ],
)  # fmt: skip
def test_state_unit_joins_what_contradicts(name: str, unit: str | None, stated: str | None) -> None:
    column = state_unit(Column(name, unit))
    assert (column.name, column.unit) == (name, stated)


def test_inspect_shows_stated_units(tmp_path: Path) -> None:
    write_text(tmp_path / "a", [("time", "s"), ("travel", "mm"), ("load", "g")])
    inspection = inspect_file(tmp_path / "a", options=ReadOptions(units={"force": "gf"}))
    assert [column.unit for column in inspection.columns] == ["s", "mm", "gf"]


@pytest.mark.parametrize(
    ("unit", "power"), [("N s/m", 1), ("N/(m/s)", 1), ("N/(m/s^2)", 2), ("N/m", 0), ("N*s/mm", 1)]
)
def test_impedance_and_apparent_mass_are_a_dynamic_stiffness(
    tmp_path: Path, unit: str, power: int
) -> None:
    frequency = np.linspace(5.0, 40.0, 200)
    s = 2j * np.pi * frequency
    stiffness = 0.1148 * ((2 * np.pi * 12.71) ** 2 + 2 * 0.02 * 2 * np.pi * 12.71 * s + s**2)
    value = stiffness / s**power / (1e3 if unit.endswith("mm") else 1.0)
    columns = [frequency, value.real, value.imag]
    head = f"Frequency [Hz];Real [{unit}];Imaginary [{unit}]"
    (tmp_path / "a").write_text(format_table(head, columns), "utf-8")
    frf = read_frf(tmp_path / "a")
    assert frf.quantity.value == "dynamic_stiffness"
    np.testing.assert_allclose(frf.value, stiffness, rtol=1e-5)
