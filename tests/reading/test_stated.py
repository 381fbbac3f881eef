"""The temperature stated in the header of a file, and lines that only resemble it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit.look_alikes import truth

from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.bench_tests import read_test


def read(path: Path, *header: str, specimen: Specimen | None = None) -> RelaxationTest:
    rows = "".join(f"{t:.5f};{x:.5f};{f:.5f}\n" for t, x, f in zip(*truth(), strict=True))
    path.write_text("\n".join([*header, "Time (s);Position (mm);Load (N)", rows]))
    return read_relaxation(path, specimen=specimen)


@pytest.mark.parametrize(
    ("line", "celsius"),
    [
        ("# temperature: 0 degC", 0.0),
        ("Temperature:\t30.0 °C", 30.0),
        ('"Temperatur"\t22\t"°C"', 22.0),
        ("Prüftemperatur [°C]; 23,5", 23.5),
        ("Test temperature (K) = 273.15", 0.0),
        ("Chamber Temperature,-20,°C", -20.0),
        ("specimen_temperature: 50 °F", 10.0),
        ("Temp. 23 °C / 50 % r. H.", 23.0),
        ("Temperature: 23 °C ± 2 °C", 23.0),
        ("试验温度: 40 ℃", None),  # a word that is not known beside it
        ("温度: 40 ℃", 40.0),
    ],
)
def test_a_line_of_the_header(tmp_path: Path, line: str, celsius: float | None) -> None:
    temperature = read(tmp_path / "a.csv", line).specimen.temperature
    assert temperature == (None if celsius is None else pytest.approx(celsius + 273.15, abs=1e-9))


@pytest.mark.parametrize(
    "line",
    [
        "Temperature: 23",
        "Temperature: 20 to 30 °C",
        "Temperature: 20..30 °C",
        "Glass transition temperature: -55 °C",
        "Set temperature: 40 °C",
        "Max. temperature: 90 °C",
        "Temperature limit: 90 °C",
        "Temperature sensor 2: 23 °C",
        "Temperature correction: 0.1 K/min",
        "Template: 23 °C",
        "Conditioned at 23 °C for 2 h",
        "T: 23 °C",
    ],
)
def test_a_line_that_says_another_thing(tmp_path: Path, line: str) -> None:
    test = read(tmp_path / "a.csv", line)
    assert test.specimen.temperature is None
    assert test.source is not None
    assert "temperature" not in " ".join(test.source.notes)


def test_two_temperatures_are_none(tmp_path: Path) -> None:
    lines = ("Chamber temperature: 0 °C", "Sample temperature: 2 °C")
    test = read(tmp_path / "a.csv", *lines)
    assert test.specimen.temperature is None
    assert test.source is not None
    assert any("no temperature is taken from it" in note for note in test.source.notes)
    assert read(tmp_path / "a.csv", lines[0], lines[0]).specimen.temperature == 273.15


def test_what_no_rubber_is_tested_at_is_not_taken(tmp_path: Path) -> None:
    test = read(tmp_path / "a.csv", "Temperature: 2300 °C")
    assert test.specimen.temperature is None
    assert test.source is not None
    assert any("which is not taken" in note for note in test.source.notes)


@pytest.mark.parametrize(("celsius", "noted"), [(23.0, True), (0.51, True), (0.49, False)])
def test_the_user_is_believed(tmp_path: Path, celsius: float, noted: bool) -> None:
    specimen = Specimen(temperature=celsius + 273.15, notes="kept")
    test = read(tmp_path / "a.csv", "Temperature: 0 °C", specimen=specimen)
    stated = 273.15 if noted else None
    assert test.specimen == replace(specimen, stated_temperature=stated)
    assert test.source is not None
    assert any("as given" in note for note in test.source.notes) == noted


def with_column(path: Path, kelvin: np.ndarray, unit: str = "K") -> RelaxationTest:
    test = simulate_relaxation(PAPER, hold_time=10.0, rig=Rig(rate=100.0)).test
    columns = np.column_stack((test.time, 1e3 * test.displacement, test.force, kelvin))
    head = f"time [s],displacement [mm],force [N],temperature [{unit}]"
    np.savetxt(path, columns, delimiter=",", fmt="%.8g", header=head, comments="")
    return read_relaxation(path)


def test_a_column_of_temperature_says_it_and_how_far_it_rose(tmp_path: Path) -> None:
    count = len(simulate_relaxation(PAPER, hold_time=10.0, rig=Rig(rate=100.0)).test.time)
    risen = with_column(tmp_path / "a.csv", np.linspace(272.65, 274.65, count)).specimen
    assert risen.temperature == pytest.approx(273.65, abs=0.01)
    assert risen.warmed == pytest.approx(2.0, rel=1e-3)
    checks = {check.name: check for check in prepare(read_relaxation(tmp_path / "a.csv")).checks}
    assert checks["temperature_held"].failed
    other = read_relaxation(tmp_path / "a.csv", specimen=Specimen(temperature=296.15))
    assert other.specimen.temperature == 296.15
    assert {check.name: check for check in prepare(other).checks}["temperature_as_stated"].failed
    # what rubber is not tested at, and what has no unit, is not taken
    assert with_column(tmp_path / "b.csv", np.zeros(count)).specimen == Specimen()
    path = tmp_path / "a.csv"
    path.write_text(path.read_text().replace(" [K]", ""))
    assert read_relaxation(path).specimen == Specimen()


def test_the_first_line_says_that_the_file_was_overruled() -> None:
    test = simulate_relaxation(PAPER, rig=Rig(rate=100.0)).test
    overruled = Specimen(temperature=346.55, stated_temperature=296.15)
    result = fit(prepare(replace(test, specimen=overruled)), arms=2, law="linear")
    assert "The file says 23 degC, and 73.4 degC was given" in result.verdict.message


def test_stated_temperature_keeps_other_specimen_data(tmp_path: Path) -> None:
    test = read(tmp_path / "a.csv", "Temperature: 0 °C", specimen=Specimen(length=0.1))
    assert test.specimen == Specimen(length=0.1, temperature=273.15)


def test_sweeps_and_curves_take_it_too(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = "".join(f"{f},{1 + f},{0.1 * f}\n" for f in np.geomspace(0.1, 10, 9))
    path.write_text("# temperature: 40 degC\nFrequency [Hz],E' [MPa],E'' [MPa]\n" + rows)
    sweep = read_test(path)
    assert isinstance(sweep, DynamicTest)
    assert sweep.specimen.temperature == 313.15
    path.write_text(
        "# temperature: 40 degC\nFrequency [Hz],E' [MPa],E'' [MPa],Temperature [degC]\n"
        + rows.replace("\n", ",20\n")
    )
    sweep = read_test(path)
    assert isinstance(sweep, DynamicTest)
    assert sweep.specimen.temperature is None
    assert sweep.temperature is not None
    curve = "".join(f"{t},{1 + 1 / t}\n" for t in np.geomspace(0.1, 10, 9))
    path.write_text("# temperature: 40 degC\ntime [s],E(t) [MPa]\n" + curve)
    assert read_modulus(path).specimen.temperature == 313.15
