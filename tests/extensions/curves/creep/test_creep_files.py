"""Creep tests as benches and rheometers write them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from kit.kinds import csv

from dashpot.base.errors import ReadError
from dashpot.extensions.curves.creep.read import read_creep
from dashpot.extensions.curves.datamodel.creep import CreepCompliance, CreepTest
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.workflow.bench_tests import read_test

TIME = np.geomspace(0.02, 60.0, 40)
COMPLIANCE = 2.0 + 3.0 * -np.expm1(-TIME / 5.0)  # 1/MPa
STRESS = 5e-4  # MPa

RHEOMETER = {
    "Torque": ("µN.m", 1534.0 + 0 * TIME), "Velocity": ("rad/s", 0.001 / TIME),
    "Step time": ("min", TIME / 60), "Temperature": ("°C", 45.0 + 0 * TIME),
    "Axial force": ("N", 0.13 + 0 * TIME), "Gap": ("µm", 1000.0 + 0 * TIME),
    "Displacement": ("rad", 1e-4 * COMPLIANCE), "Run time": ("min", 2.0 + TIME / 60),
    "Time": ("min", TIME / 60), "Stress": ("MPa", STRESS + 0 * TIME),
    "Stress (step)": ("MPa", 0 * TIME), "Strain": ("%", 100 * STRESS * COMPLIANCE),
    "Strain (step)": ("%", 100 * STRESS * COMPLIANCE), "Compliance": ("1/MPa", COMPLIANCE),
}  # fmt: skip
"""The columns of a rheometer's creep step, as such files have them; the numbers are our own."""


def rheometer(*steps: str, leave_out: tuple[str, ...] = ()) -> str:
    """The text of an export with one table per step."""
    columns = {name: pair for name, pair in RHEOMETER.items() if name not in leave_out}
    head = "Filename\tgel.txt\nInstrument name\tan HR\nProcedure name\tCreep\n[File Parameters]\n"
    parts = [
        "\n".join(
            ["[step]", step, "\t".join(columns), "\t".join(unit for unit, _ in columns.values()),
             *("\t".join(f"{item:.12g}" for item in row)
               for row in zip(*(v for _, v in columns.values()), strict=True))]
        )
        for step in steps
    ]  # fmt: skip
    return head + "\n\n".join(parts) + "\n"


def write_text(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("reader", [read_creep, read_test])
def test_a_rheometers_export_is_a_creep_compliance(tmp_path: Path, reader) -> None:
    result = reader(write_text(tmp_path / "gel.txt", rheometer("Creep - 1")))
    assert isinstance(result, CreepCompliance)
    assert (result.unit, result.stiffness_unit) == ("1/Pa", "Pa")
    assert result.time == pytest.approx(TIME)
    assert result.compliance == pytest.approx(1e-6 * COMPLIANCE)
    assert result.source is not None
    assert any("Compliance" in line for line in result.source.columns)


def test_stress_and_strain_without_a_compliance_are_a_creep_test_of_a_material(
    tmp_path: Path,
) -> None:
    text = rheometer("Creep - 1", leave_out=("Compliance", "Stress (step)", "Strain (step)"))
    path = write_text(tmp_path / "gel.txt", text)
    creep = read_creep(path)
    assert isinstance(creep, CreepTest)
    assert creep.unit == "Pa"
    assert creep.force == pytest.approx(1e6 * STRESS + 0 * TIME)
    assert creep.displacement == pytest.approx(STRESS * COMPLIANCE)
    roles = {column.role for column in inspect_file(path).columns}
    assert {"time", "stress", "strain"} <= roles


def test_read_creep_asks_which_of_several_segments(tmp_path: Path) -> None:
    path = write_text(tmp_path / "gel.txt", rheometer("Creep - 1", "Creep recovery - 2"))
    with pytest.raises(ReadError, match=r"2 segments .*--file-part segment=1"):
        read_creep(path)
    creep = read_creep(path, options=ReadOptions(segment=1))
    assert len(creep.time) == len(TIME)


def test_json_steps_are_read_too(tmp_path: Path) -> None:
    heads = [{"name": n, "unit": u} for n, (u, _) in RHEOMETER.items()]
    values = np.column_stack([v for _, v in RHEOMETER.values()]).tolist()
    document = {"Results": [{"Properties": {"Name": "Creep"}, "DataSet": [
        {"Data": {"columns": heads, "values": values}}]}]}  # fmt: skip
    creep = read_creep(write_text(tmp_path / "gel.json", json.dumps(document)))
    assert isinstance(creep, CreepCompliance)
    assert creep.compliance == pytest.approx(1e-6 * COMPLIANCE)


def test_creep_compliance_of_a_specimen_has_its_unit(tmp_path: Path) -> None:
    path = write_text(tmp_path / "seal.csv", csv("time [s],compliance [mm/N]", TIME, COMPLIANCE))
    creep = read_creep(path)
    assert (creep.unit, creep.stiffness_unit) == ("m/N", "N/m")
    assert creep.compliance == pytest.approx(1e-3 * COMPLIANCE)


def test_who_names_the_columns_knows(tmp_path: Path) -> None:
    text = csv("t,a,b", TIME, 100 * STRESS * COMPLIANCE, STRESS + 0 * TIME)
    path = write_text(tmp_path / "bare.csv", text)
    options = ReadOptions(
        time="t", strain="a", stress="b", units={"time": "s", "strain": "%", "stress": "MPa"}
    )
    bench = read_test(path, options=options)
    assert isinstance(bench, CreepTest)
    assert bench.displacement == pytest.approx(STRESS * COMPLIANCE)
    curve = ReadOptions(time="t", creep_compliance="a", units={"t": "s", "a": "1/kPa"})
    assert read_test(path, options=curve).compliance == pytest.approx(0.1 * STRESS * COMPLIANCE)


def test_a_bench_that_says_creep_is_read_by_force_and_displacement(tmp_path: Path) -> None:
    text = "Procedure: creep\n" + csv(
        "time [s],displacement [mm],force [N],stress [MPa],strain [%]",
        TIME, COMPLIANCE, 1 + 0 * TIME, STRESS + 0 * TIME, COMPLIANCE,
    )  # fmt: skip
    bench = read_test(write_text(tmp_path / "seal.csv", text))
    assert isinstance(bench, CreepTest)
    assert bench.unit == "N/m"
    assert bench.force == pytest.approx(1.0)


def test_a_unit_that_is_no_compliance_is_named(tmp_path: Path) -> None:
    path = write_text(
        tmp_path / "seal.csv", csv("time [s],creep compliance [MPa]", TIME, COMPLIANCE)
    )
    options = ReadOptions(creep_compliance="2")
    with pytest.raises(ReadError, match=r"labelled 'MPa'.*material compliance.*1/MPa"):
        read_creep(path, options=options)


def test_read_creep_separates_curves_by_a_temperature_column(tmp_path: Path) -> None:
    item = len(TIME)
    head = "temperature [degC],time [s],creep compliance [1/MPa]"
    warm = np.repeat([23.0, 0.0], item)
    text = csv(head, warm, np.tile(TIME, 2), np.tile(COMPLIANCE, 2))
    bench = read_test(write_text(tmp_path / "creep.csv", text))
    assert isinstance(bench, CreepCompliance)
    assert bench.several_temperatures
    assert bench.select_temperature("0degC").compliance == pytest.approx(1e-6 * COMPLIANCE)
