"""Questions about thousandfold errors of units; none about real tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import DashpotError
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.systems.door.read import read_door
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.solids.demo_seals import PAPER

TIME = np.linspace(0.0, 41.0, 411)


def press_seal(
    *, travel: float = 8e-3, force: float = 1.5, clock: float = 1.0
) -> dp.RelaxationTest:
    """1 s to 8 mm and 40 s held, with what is said of it times too much."""
    rise = np.clip(TIME, 0.0, 1.0)
    x = travel * rise
    return dp.RelaxationTest(
        time=clock * TIME, displacement=x, force=force * rise, units="SI", specimen=dp.Specimen()
    )


def door(tmp_path: Path) -> object:
    path = tmp_path / "door.toml"
    path.write_text('[door]\nwidth = "1.1mm"\nheight = "1.2mm"\n', "utf-8")
    return read_door(path)


SLIPS = {
    "mm as m": lambda _: press_seal(travel=8.0),
    "um as mm": lambda _: press_seal(travel=0.8),
    "N as kN, twice": lambda _: press_seal(force=1.5e6),
    "ms as s": lambda _: prepare(press_seal(clock=1e3)),
    "s as Ms": lambda _: press_seal(clock=1e6),
    "a length in mm": lambda _: dp.Specimen(length=100.0),
    "a height in mm": lambda _: dp.Specimen(height=20.0),
    "g as kg on two seals": lambda _: dp.systems.predict_frf(
        2 * PAPER, mass=104.0, frequency=[10.0]
    ),
    "an indenter in g": lambda _: Indenter(mass=5e3),
    "a radius in mm": lambda _: Indenter(radius=5.0),
    "a mass of tons": lambda _: dp.predict(PAPER, mass="104t", seals=2),
    "a door in mm": door,
}


@pytest.mark.parametrize("slip", SLIPS)
def test_reader_asks_about_a_thousandfold_slip(slip: str, tmp_path: Path) -> None:
    with pytest.raises(DashpotError, match=r"expected|is expected"):
        SLIPS[slip](tmp_path)


UNITS = {"time": "s", "displacement": "mm", "force": "N"}
ADHESIVES = {
    "shear_relaxation_0d1.xlsx": ("1", "3", "2"), "shear_relaxation_1.xlsx": ("1", "2", "3"),
    "shear_relaxation_2.xlsx": ("1", "2", "3"), "shear_relaxation_5.xlsx": ("1", "2", "3"),
    "shear_relaxation.xlsx": ("1", "2", "3"),
}  # fmt: skip
MUSCLES = [
    f"Avg{kind}_{ramp}s.csv"
    for kind in ("Relaxed", "RelaxedMavaSet", "pCa4.4")
    for ramp in ("0.1", "1", "10", "100")
]


def make_options(columns: tuple[str, str, str]) -> ReadOptions:
    time, force, displacement = columns
    return ReadOptions(time=time, force=force, displacement=displacement, units=UNITS)


def real(folder: Path) -> list[tuple[Path, ReadOptions]]:
    """Every relaxation record that we may read, its units stated as the source says them."""
    muscle = ReadOptions(units={"time": "s", "displacement": "um", "force": "mN"})
    return [
        *(
            (folder / "oca-cyclic-shear-relaxation" / name, make_options(c))
            for name, c in ADHESIVES.items()
        ),
        *((folder / "titin-ramp-hold" / value, muscle) for value in MUSCLES),
        (folder / "rheos-data-time" / "data_time.csv", make_options(("1", "3", "2"))),
    ]


def require_reading(path: Path, options: ReadOptions) -> None:
    assert len(read_relaxation(path, options=options).time) > 90, path


@pytest.mark.slow
def test_readers_accept_every_real_record(real_data: Path) -> None:
    pytest.importorskip("openpyxl")
    records = real(real_data)
    assert len(records) == 18
    for path, options in records:
        require_reading(path, options)
    hits = read_impact(
        real_data / "lvm-read" / "long_single_header_multi_ch.lvm",
        options=ReadOptions(units={"force": "N"}),
    )
    assert hits.starts == (0, 8192)


@pytest.mark.slow
def test_readers_accept_large_records(shared_data: Path) -> None:
    (machine,) = (shared_data / "formats" / "zwick").glob("*.TXT")
    require_reading(machine, ReadOptions(displacement="Standardweg", rate=10.0))
    require_reading(shared_data / "rheosafm-jpk-relaxation" / "AFM_relaxation.txt", ReadOptions())
