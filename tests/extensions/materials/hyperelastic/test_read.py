"""Stress over strain from files: a clock is kept where it is sound, and not asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.foreign.files import format_table, press_and_hold
from kit.kinds import csv

import dashpot as dp
from dashpot.base.errors import ReadError
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.extensions.materials.hyperelastic.read import read_stress_strain

PULL = np.linspace(0, 50, 40)
CLOCK = np.arange(40) / 4


def write_tension(folder: Path, head: str, clock: np.ndarray) -> Path:
    path = folder / "pull.csv"
    path.write_text(csv(f"{head},strain [%],stress [MPa]", clock, PULL, np.sqrt(PULL)))
    return path


def test_read_stress_strain_keeps_a_valid_clock(tmp_path: Path) -> None:
    test = read_stress_strain(write_tension(tmp_path, "time [s]", CLOCK), "uniaxial")
    np.testing.assert_allclose(test.time, CLOCK)


@pytest.mark.parametrize(
    ("head", "clock", "message"),
    [("time", CLOCK, "has no unit"), ("time [s]", CLOCK % 5, "time falls from 4.75 s")],
    ids=["no unit", "starts again"],
)
def test_read_stress_strain_omits_an_invalid_clock_with_a_note(
    tmp_path: Path, head: str, clock: np.ndarray, message: str
) -> None:
    test = read_stress_strain(write_tension(tmp_path, head, clock), "uniaxial")
    assert test.time is None
    assert len(test.stress) == len(PULL)
    (note,) = [note for note in test.source.notes if "the clock is left out" in note]
    assert message in note


def test_read_cld_asks_for_the_unit_of_the_clock(tmp_path: Path) -> None:
    path = tmp_path / "press.csv"
    path.write_text(csv("time,displacement [mm],force [N]", CLOCK, PULL / 5, PULL / 10))
    with pytest.raises(ReadError, match="has no unit"):
        read_cld(path)


def write_foam_compression(
    folder: Path, across: str, ratio: float = 0.15, sign: float = 1.0, along: float = 1.0
):
    """Pressed by 40 %, a foam of one Poisson's ratio, with its strain sideways."""
    stretch = np.linspace(1.0, 0.6, 40)
    strain, sideways = 100 * (stretch - 1), 100 * (stretch**-ratio - 1)
    stress = stretch - stretch ** (-1 - 4 * ratio)
    path = folder / "press.csv"
    columns = (along * strain, sign * sideways, stress)
    path.write_text(csv(f"axial strain [%],{across},stress [MPa]", *columns))
    return path


@pytest.mark.parametrize(
    "across", ["lateral strain [%]", "transverse strain [%]", "Querdehnung [%]", "Strain Width [%]"]
)
def test_a_strain_sideways_shows_poissons_ratio(tmp_path: Path, across: str) -> None:
    test = read_stress_strain(write_foam_compression(tmp_path, across), "uniaxial")
    assert test.stretch.min() == pytest.approx(0.6)
    assert test.poisson == pytest.approx(0.15, abs=1e-9)
    assert any("shows Poisson's ratio 0.15" in note for note in test.source.notes)


def test_sizes_of_a_piece_that_was_pressed_show_it_too(tmp_path: Path) -> None:
    path = write_foam_compression(tmp_path, "lateral strain [%]", along=-1.0)
    assert read_stress_strain(path, "uniaxial", is_compression=True).poisson == pytest.approx(0.15)


@pytest.mark.parametrize(("ratio", "sign"), [(0.61, 1.0), (0.15, -1.0)])
def test_read_stress_strain_asks_about_an_impossible_lateral_strain(
    tmp_path: Path, ratio: float, sign: float
) -> None:
    with pytest.raises(ReadError, match=r"expected 0 to 0\.6\. Check its unit and its sign"):
        read_stress_strain(
            write_foam_compression(tmp_path, "lateral strain [%]", ratio, sign), "uniaxial"
        )


@pytest.mark.parametrize(
    ("units", "strain", "stress", "lengths"),
    [("%,MPa", 100.0, 1.0, "displacement=0.01mm,force=N"), ("1,kPa", 1.0, 1e3, "force=0.001N")],
)
def test_a_relaxation_in_strain_and_stress_is_refused_with_the_line_that_fits_it(
    tmp_path: Path, units: str, strain: float, stress: float, lengths: str
) -> None:
    time, displacement, force = press_and_hold(20.0)
    names = [
        f"{name} [{unit}]"
        for name, unit in zip(("Strain", "Stress"), units.split(","), strict=True)
    ]
    head = ";".join(["Time [s]", *names])
    columns = [time, displacement / 80 * strain, force / 10 * stress]
    (tmp_path / "a.csv").write_text(format_table(head, columns), "utf-8")
    with pytest.raises(ReadError, match=r"relaxation test in strain and stress") as error:
        read_stress_strain(tmp_path / "a.csv", "uniaxial")
    assert lengths in str(error.value)
    text = str(error.value).partition('--units "')[2].partition('"')[0]
    stated = dict(pair.split("=") for pair in text.split(","))
    test = dp.read(
        tmp_path / "a.csv", columns={"displacement": "Strain", "force": "Stress"}, units=stated
    )
    assert test.force.max() / test.displacement.max() == pytest.approx(
        force.max() / 10 / (0.1 * 1e-3), rel=1e-4
    )
    record = dp.read(tmp_path / "a.csv", test="uniaxial", kind="stress-strain")
    assert type(record).__name__ == "StressStrainTest"


@pytest.mark.parametrize(
    ("lines", "mode"),
    [
        (["# equibiaxial test"], "equibiaxial"),
        (["Method: Bi-axial extension"], "equibiaxial"),
        (["Pure shear, 23 degC"], "planar"),
        (["Volumetric compression of a cylinder"], "volumetric"),
        (["Uniaxial tension"], "uniaxial"),
        (["Specimen 3"], "uniaxial"),
        (["After a biaxial test:", "uniaxial tension"], "uniaxial"),
    ],
)
def test_the_header_names_the_mode_where_no_option_does(
    tmp_path: Path, lines: list[str], mode: str
) -> None:
    path = tmp_path / "a.csv"
    rows = (f"{strain},{0.01 * strain}" for strain in range(0, 60, 3))
    path.write_text("\n".join([*lines, "strain [%],nominal stress [MPa]", *rows]))
    test = read_stress_strain(path, None)
    assert test.mode == mode
    is_named = any("as its header says" in note for note in test.source.notes)
    assert is_named == (len(lines) == 1 and lines[0] != "Specimen 3")
    assert read_stress_strain(path, "uniaxial").mode == "uniaxial"


def test_a_strain_that_goes_on_is_no_relaxation(tmp_path: Path) -> None:
    strain = np.linspace(0, 50, 200)
    columns = [strain / 5, strain, 0.01 * strain]
    head = "Time [s];Strain [%];Stress [MPa]"
    (tmp_path / "a.csv").write_text(format_table(head, columns), "utf-8")
    assert len(dp.read(tmp_path / "a.csv", test="uniaxial").stress) == 200
