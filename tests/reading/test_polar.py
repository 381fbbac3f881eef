"""A complex modulus by its size and angle is read as its storage and loss."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dashpot.base.errors import ReadError
from dashpot.extensions.amplitude.read import read_amplitude
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file

pytestmark = pytest.mark.once

F = np.geomspace(1, 100, 12)
DELTA = 0.2 + 0.05 * np.sin(F)
SIZE = 300 * F**0.1
STORAGE, LOSS = SIZE * np.cos(DELTA), SIZE * np.sin(DELTA)
ANGLES = {"deg": np.degrees(DELTA), "rad": DELTA}


def write_columns(folder: Path, header: str, *columns: np.ndarray) -> Path:
    path = folder / "sweep.csv"
    rows = zip(*(column.tolist() for column in columns), strict=True)
    path.write_text("\n".join([header, *(",".join(map(repr, row)) for row in rows)]) + "\n")
    return path


@pytest.mark.parametrize(
    ("size", "angle"),
    [
        ("Dynamic stiffness (N/mm)", "Loss angle (deg)"),
        ("Dynamic stiffness (N/mm)", "Phase (deg)"),
        ("|K*| (N/mm)", "delta (rad)"),
        ("Kdyn [N/mm]", "Verlustwinkel [deg]"),
        ("Dyn. Steifigkeit [N/mm]", "Phase angle [rad]"),
        ("Complex modulus (MPa)", "Phase angle (rad)"),
        ("|G*| (MPa)", "tan delta"),
        ("Complex shear modulus (MPa)", "Loss factor"),
        ("Storage modulus (MPa)", "Loss angle (deg)"),
        ("K' (N/mm)", "tan delta"),
    ],
)
def test_size_and_angle_are_storage_and_loss(tmp_path: Path, size: str, angle: str) -> None:
    base = STORAGE if size[0] == "S" or "'" in size else SIZE
    second = next((v for unit, v in ANGLES.items() if unit in angle[-5:-1]), np.tan(DELTA))
    unit = 1e6 if "MPa" in size else 1e3
    header = f"{size},{angle}"
    path = write_columns(tmp_path, f"Frequency (Hz),{header}", F, base, second)
    assert inspect_file(path).kind == "dma"
    assert not inspect_file(path).questions
    swept = read_dynamic(path)
    tone = np.full(12, 10.0)
    path = write_columns(tmp_path, f"Frequency (Hz),Amplitude (mm),{header}", tone, F, base, second)
    assert inspect_file(path).kind == "strain-sweep"
    for test in (swept, read_amplitude(path)):
        np.testing.assert_allclose(test.storage, unit * STORAGE, rtol=1e-12)
        np.testing.assert_allclose(test.loss, unit * LOSS, rtol=1e-12)
        assert ("cosine" in " ".join(test.source.notes)) == (base is SIZE)


def test_read_dynamic_asks_about_an_ambiguous_stiffness(tmp_path: Path) -> None:
    path = write_columns(
        tmp_path, "Frequency (Hz),Stiffness (N/mm),tan delta", F, SIZE, np.tan(DELTA)
    )
    with pytest.raises(
        ReadError, match='say which: --column storage="Stiffness" or --column magnitude='
    ):
        read_dynamic(path)
    of_size = read_dynamic(path, options=ReadOptions(magnitude="Stiffness"))
    np.testing.assert_allclose(of_size.storage, 1e3 * STORAGE, rtol=1e-12)
    of_part = read_dynamic(path, options=ReadOptions(storage="Stiffness"))
    np.testing.assert_allclose(of_part.storage, 1e3 * SIZE, rtol=1e-12)


@pytest.mark.parametrize(
    ("unit", "angle", "message"),
    [
        ("deg", -ANGLES["deg"], "sign turned"),
        ("rad", ANGLES["deg"], "is the unit deg"),
        ("deg", ANGLES["rad"], "is the unit rad"),
        ("deg", 80 + ANGLES["deg"], "90 deg"),
    ],
)
def test_what_is_no_loss_angle_is_refused(
    tmp_path: Path, unit: str, angle: np.ndarray, message: str
) -> None:
    path = write_columns(tmp_path, f"Frequency (Hz),|K*| (N/mm),Phase ({unit})", F, SIZE, angle)
    with pytest.raises(ReadError, match=message):
        read_dynamic(path)


@pytest.mark.parametrize("size", ["Magnitude (N/mm)", "Amplitude ((m/s^2)/N)", "Mag (g/N)"])
def test_a_magnitude_and_a_phase_stay_an_frf(tmp_path: Path, size: str) -> None:
    path = write_columns(tmp_path, f"Frequency (Hz),{size},Phase (deg)", F, SIZE, ANGLES["deg"])
    assert inspect_file(path).kind == "frf"
    named = ReadOptions(magnitude="2", phase="3")
    assert inspect_file(path, options=named).kind == "frf"


@pytest.mark.parametrize("word", ["Transmissibility", "Amplitude", "Betrag"])
@pytest.mark.parametrize("units", [("-", "rad"), ("g/g", "deg")])
def test_the_phase_of_a_magnitude_is_no_magnitude(
    tmp_path: Path, word: str, units: tuple[str, str]
) -> None:
    """A phase that is named for the magnitude that it belongs to raises no question."""
    header = f"Frequency (Hz),{word} magnitude ({units[0]}),{word} phase ({units[1]})"
    path = write_columns(tmp_path, header, F, np.full(len(F), 1.2), np.full(len(F), -0.1))
    inspection = inspect_file(path)
    assert inspection.kind in {"transmissibility", "frf"}
    roles = {column.name: column.role for column in inspection.columns}
    assert roles[f"{word} phase"] == "phase"
    assert not any("could each be" in question for question in map(str, inspection.questions))
