"""Real files of real labs."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from dashpot.base.errors import ReadError
from dashpot.datamodel.frf import Kind
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

HAMMER = "lvm-read/long_single_header_multi_ch.lvm"


def test_jpk_record(shared_data: Path) -> None:
    path = shared_data / "rheosafm-jpk-relaxation" / "AFM_relaxation.txt"
    inspection = inspect_file(path)
    assert (inspection.kind, inspection.rows, inspection.even) == ("relaxation", 76600, True)
    assert [(s.name, s.rows) for s in inspection.segments] == [
        ("extend", 800), ("pause", 75000), ("retract", 800),
    ]  # fmt: skip
    assert inspection.rate == pytest.approx(5000.0)
    start = time.process_time()
    test = read_relaxation(path)
    assert time.process_time() - start < 1.0
    assert test.force.max() == pytest.approx(2.197e-6, rel=1e-3)
    assert test.time[0] == 1e-4
    held = read_relaxation(path, options=ReadOptions(segment=2))
    assert np.ptp(held.displacement) > 0.15e-6  # the hold is not one


def test_two_hits_of_a_hammer(real_data: Path) -> None:
    with pytest.raises(ReadError, match=r"column 'F' is labelled 'g'.*--units \"hammer=N\""):
        read_impact(real_data / HAMMER)
    test = read_impact(real_data / HAMMER, options=ReadOptions(units={"force": "N"}))
    assert test.starts == (0, 8192)
    assert test.channels == ("m_1", "m_2")
    hits = [int(np.argmax(np.abs(test.force[record]))) for record in test.records()]
    assert all(80 < hit < 90 for hit in hits)
    assert test.force.min() == pytest.approx(-18.03, abs=0.01)
    np.testing.assert_allclose(test.acceleration[:, 0], [0.234571, 0.244440])
    assert not list((real_data / "lvm-read").glob("*.pkl"))


@pytest.mark.parametrize(
    ("name", "rows", "names"),
    [
        ("multi_time_column", 3, ("Voltage", "Acceleration")),
        ("no_decimal_separator", 4, ("ax", "ay", "az")),
        ("short", 10, ("Excitation (Trigger)", "Response (Trigger)")),
        ("with_comments", 9, ("Volume (ml)",)),
        ("with_empty_fields", 7, ("Dev0/Ai0", "Dev0/Ai2", "Dev0/Ai0 1")),
    ],
)
def test_lvm_varieties(real_data: Path, name: str, rows: int, names: tuple[str, ...]) -> None:
    inspection = inspect_file(real_data / "lvm-read" / f"{name}.lvm")
    assert inspection.format == "LVM"
    assert inspection.rows == rows
    numbers = {c.name for c in inspection.columns if c.first and c.first[0] is not None}
    assert set(names) <= numbers


def test_a_short_lvm_with_decimal_commas(real_data: Path) -> None:
    test = read_impact(real_data / "lvm-read" / "short.lvm")
    np.testing.assert_allclose(test.force[:3], [0.914018, 0.537321, 0.616905])
    assert test.rate == pytest.approx(25600.0)


def test_testxpert(shared_data: Path) -> None:
    (path,) = (shared_data / "formats" / "zwick").glob("*.TXT")
    inspection = inspect_file(path)
    assert inspection.rows == 5734
    assert [c.unit for c in inspection.columns] == ["s", "N", "mm", "mm", "mm", "mm"]
    with pytest.raises(ReadError, match="could each be the displacement"):
        read_relaxation(path)
    # its clock was scrambled before it was published
    with pytest.raises(ReadError, match=r"time falls from .* line 24"):
        read_relaxation(path, options=ReadOptions(displacement="Standardweg"))
    options = ReadOptions(displacement="Standardweg", rate=10.0)
    assert read_relaxation(path, options=options).force[0] == 0.576537916


def test_titin_asks_for_its_units(real_data: Path) -> None:
    path = real_data / "titin-ramp-hold" / "AvgRelaxed_1s.csv"
    with pytest.raises(ReadError, match=r"'Time' \(time\) has no unit"):
        read_relaxation(path)
    units = {"time": "s", "displacement": "um", "force": "mN"}
    test = read_relaxation(path, options=ReadOptions(units=units))
    assert test.displacement.max() == pytest.approx(1.175e-6, rel=1e-2)


def test_a_file_without_a_header(real_data: Path) -> None:
    path = real_data / "rheos-data-time" / "data_time.csv"
    with pytest.raises(ReadError, match="looks like time"):
        read_relaxation(path)
    options = ReadOptions(
        time="1",
        displacement="2",
        force="3",
        units={"time": "s", "displacement": "mm", "force": "N"},
    )
    assert len(read_relaxation(path, options=options).time) == 101


def test_workbook_without_a_header(real_data: Path) -> None:
    path = real_data / "oca-cyclic-shear-relaxation" / "shear_relaxation_0d1.xlsx"
    options = ReadOptions(
        time="1",
        displacement="2",
        force="3",
        units={"time": "s", "displacement": "mm", "force": "N"},
    )
    test = read_relaxation(path, options=options)
    assert len(test.time) == 432
    assert test.displacement[1] == pytest.approx(0.0202e-3)


def test_dma_records(real_data: Path) -> None:
    master = read_dynamic(real_data / "pyvisco-master-curves" / "freq_user_master.csv")
    assert len(master.frequency) == 206
    assert master.storage[0] == pytest.approx(88.79651575665739e6)
    raw = read_dynamic(real_data / "pyvisco-master-curves" / "freq_user_raw.csv")
    assert len(raw.frequency) == 210
    assert raw.temperature[0] == pytest.approx(273.15 - 49.9612)


def test_a_workbook_of_a_dma(shared_data: Path) -> None:
    eplexor = read_dynamic(shared_data / "formats" / "rheometer_dma" / "freq_Eplexor_raw.xls")
    assert len(eplexor.frequency) == 210
    assert eplexor.storage[0] == pytest.approx(4956.183187381401e6)
    assert eplexor.temperature[0] == pytest.approx(273.15 - 50.0363)


def require_refusal(path: Path, reason: str) -> None:
    assert inspect_file(path).kind == "not-a-test"
    with pytest.raises(ReadError, match=f"is not a test: .*{reason}"):
        read_relaxation(path)


def test_a_flow_curve_is_refused(shared_data: Path) -> None:
    require_refusal(shared_data / "formats" / "rheometer_dma" / "flow_ramp.txt", "flow curve")


def test_a_power_spectral_density_is_refused(real_data: Path) -> None:
    require_refusal(real_data / "pyuff" / "sample_dataset58_psd.uff", "power spectral density")


def sent_on(path: Path, reason: str) -> None:
    assert inspect_file(path).kind == "modulus"
    with pytest.raises(
        ReadError, match=f"a relaxation modulus over time .*{reason}.*: use dashpot fit$"
    ):
        read_relaxation(path)


@pytest.mark.parametrize(
    "name", ["relaxation_test.csv", "stressrelaxation_hdpe_data.csv", "relaxation.json"]
)
def test_a_modulus_of_a_rheometer_is_sent_to_its_command(shared_data: Path, name: str) -> None:
    sent_on(shared_data / "formats" / "rheometer_dma" / name, "")


def test_a_modulus_over_time_is_sent_to_its_command(real_data: Path) -> None:
    path = real_data / "pyvisco-master-curves" / "time_user_master.csv"
    sent_on(path, ", over [0-9]+ decades")


def test_rheometer_headers(shared_data: Path) -> None:
    inspection = inspect_file(shared_data / "formats" / "rheometer_dma" / "relaxation_test.csv")
    names = [(c.name, c.unit) for c in inspection.columns]
    assert names == [
        ("Time", "s"), ("Shear Strain", "%"), ("Shear Stress", "Pa"), ("Relaxation Modulus", "Pa"),
    ]  # fmt: skip


@pytest.mark.parametrize("name", ["Sample_UFF58_ascii.uff", "Sample_UFF58b_bin.uff"])
def test_a_large_uff(shared_data: Path, name: str) -> None:
    assert inspect_file(shared_data / "formats" / "uff" / name).rows == 79292


def test_uff_varieties(real_data: Path) -> None:
    folder = real_data / "pyuff"
    sine = inspect_file(folder / "binary8byte.uff")
    assert (sine.rows, sine.columns[1].unit) == (250, "g")
    assert inspect_file(folder / "time-history-not-all-columns-filled.uff").rows == 13
    frf = read_frf(folder / "non_ascii_header.uff")
    assert frf.quantity is Kind.ACCELERANCE
    assert frf.value[1] == pytest.approx(-5.99924e-02 - 5.53260e-02j)


@pytest.mark.parametrize("number", range(1, 8))
def test_two_columns_of_anything(real_data: Path, number: int) -> None:
    path = real_data / "pyrespect-time-tests" / f"test{number}.dat"
    inspection = inspect_file(path)
    assert inspection.rows == sum(bool(line.strip()) for line in path.read_text().splitlines())
    assert len(inspection.columns) == 2
