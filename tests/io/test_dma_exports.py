"""Dynamic tests as the instruments of several makers export them are read as what they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dashpot.io.readers.inspect import inspect_file
from dashpot.kinds.level.read import read_amplitude
from dashpot.records.dynamic import DynamicTest
from dashpot.workflow.fits import read_test

pytestmark = pytest.mark.once

F = np.geomspace(0.1, 100, 13)
STORAGE, LOSS = 6e6 * F**0.1, 8e5 * F**0.12
STRAIN = np.geomspace(1e-4, 5e-2, 12)
SOFT, LOST = 6e6 / (1 + (STRAIN / 0.01)), 5e5 + 0 * STRAIN


def rows(form: str, *columns: np.ndarray) -> str:
    return "".join(form % row + "\n" for row in zip(*columns, strict=True))


FREQUENCY = {
    "a header of steps, and a last column without a unit": (
        "Procedure name\tfrequency sweep\n[step]\nFrequency sweep - 1\n"
        "Step time\tTemperature\tOscillation frequency\tStorage modulus\tLoss modulus\tTan(delta)\n"
        "min\t°C\tHz\tMPa\tMPa\t\n"
        + rows("0.1\t23.0\t%.9g\t%.9g\t%.9g\t%.9g", F, STORAGE / 1e6, LOSS / 1e6, LOSS / STORAGE)
    ),
    "names with units behind a stroke, decimal commas": (
        "#IDENTITY;seal\n##Temp./°C;f/Hz;E'/MPa;E''/MPa;tan d\n"
        + rows("23.0;%.9g;%.9g;%.9g;%.9g", F, STORAGE / 1e6, LOSS / 1e6, LOSS / STORAGE).replace(
            ".", ","
        )
    ),
    "amplitudes of displacement and force, stiffness and phase": (
        "Results Table 1\n,Frequency,Displacement Amplitude,Force Amplitude,Dynamic Stiffness,Phase"
        "\n,(Hz),(mm),(N),(MPa),(°)\n"
        + rows(
            "1,%.9g,0.1,60,%.9g,%.9g",
            F, np.hypot(STORAGE, LOSS) / 1e6, np.degrees(np.arctan2(LOSS, STORAGE)),
        )
    ).replace("Dynamic Stiffness", "Complex Modulus"),
    "times, and a modulus of any mode": (
        "Index\tts\tt\tFreq\tDispl. Ampl.\tForce Ampl.\tM'\tM''\n"
        "[]\t[s]\t[s]\t[Hz]\t[µm]\t[N]\t[MPa]\t[MPa]\n"
        + rows("1\t%.9g\t2\t%.9g\t10\t3\t%.9g\t%.9g", F, F, STORAGE / 1e6, LOSS / 1e6)
    ),
}  # fmt: skip

AMPLITUDE = {
    "a percent sign first among the units": (
        "[step]\nAmplitude sweep - 1\n"
        "Oscillation strain\tFrequency\tStorage modulus\tLoss modulus\tTan(delta)\n"
        "%\tHz\tPa\tPa\t\n"
        + rows("%.9g\t10\t%.9g\t%.9g\t%.9g", 100 * STRAIN, SOFT, LOST, LOST / SOFT)
    ),
    "static beside dynamic strain": (
        "Probe: EPDM\n\n"
        "f [Hz]\tstat. Dehnung [%]\tdyn. Dehnung [%]\t|E*| [MPa]\tE' [MPa]\tE'' [MPa]\n"
        + rows(
            "10\t5\t%.9g\t%.9g\t%.9g\t%.9g",
            100 * STRAIN, np.hypot(SOFT, LOST) / 1e6, SOFT / 1e6, LOST / 1e6,
        )
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FREQUENCY)
def test_a_sweep_of_frequency(tmp_path: Path, name: str) -> None:
    path = tmp_path / "export.txt"
    path.write_text(FREQUENCY[name], encoding="utf-8")
    assert inspect_file(path).kind == "dma"
    test = read_test(path)
    assert isinstance(test, DynamicTest)
    np.testing.assert_allclose(test.frequency, F, rtol=1e-8)
    np.testing.assert_allclose(test.storage, STORAGE, rtol=1e-7)
    np.testing.assert_allclose(test.loss, LOSS, rtol=1e-7)


@pytest.mark.parametrize("name", AMPLITUDE)
def test_a_sweep_of_amplitude(tmp_path: Path, name: str) -> None:
    path = tmp_path / "export.txt"
    path.write_text(AMPLITUDE[name], encoding="utf-8")
    assert inspect_file(path).kind == "strain-sweep"
    test = read_amplitude(path)
    np.testing.assert_allclose(test.amplitude, STRAIN, rtol=1e-8)
    np.testing.assert_allclose(test.storage, SOFT, rtol=1e-7)


def test_blocks_under_titles_have_their_own_temperature(tmp_path: Path) -> None:
    path = tmp_path / "export.txt"
    header = "f [Hz];E' [MPa];E'' [MPa]\n"
    path.write_text(
        "".join(
            f"Frequency sweep at {warm} °C\n{header}"
            + rows("%.9g;%.9g;%.9g", F, STORAGE / 1e6, LOSS / 1e6)
            + "\n"
            for warm in (0, 23)
        ),
        encoding="utf-8",
    )
    test = read_test(path)
    assert isinstance(test, DynamicTest)
    assert test.temperature is not None
    assert sorted(set(np.round(test.temperature, 2))) == [273.15, 296.15]


def test_a_comment_before_a_tab_is_no_unit(tmp_path: Path) -> None:
    path = tmp_path / "export.txt"
    path.write_text(
        "%\tfrequency [Hz]\tE' [MPa]\tE'' [MPa]\n"
        + rows("%.9g\t%.9g\t%.9g", F, STORAGE / 1e6, LOSS / 1e6)
    )
    np.testing.assert_allclose(read_test(path).storage, STORAGE, rtol=1e-7)  # type: ignore[union-attr]
