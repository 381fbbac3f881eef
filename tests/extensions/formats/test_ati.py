"""Six gauge voltages to force and torque."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.gauges import cal
from kit.look_alikes import truth

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.ati import read_calibration
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation


@pytest.mark.parametrize("version", ["1.0", "1.1"])
@pytest.mark.parametrize("torque", ["N-mm", "N-m"])
@pytest.mark.parametrize("distance", ["mm", "m"])
def test_read_calibration_gives_one_matrix_for_both_versions(
    tmp_path: Path, version: str, torque: str, distance: str
) -> None:
    matrix = cal(tmp_path / "a.cal", version=version, torque=torque, distance=distance)
    result = read_calibration(tmp_path / "a.cal")
    np.testing.assert_allclose(result.matrix, matrix, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(result.axis_range, [50, 50, 70, 0.5, 0.5, 0.5])
    assert (result.serial, result.part) == ("FT00001", "SI-50-0.5")


def gauge_file(path: Path, matrix: np.ndarray, *, unit: str = "V", factor: float = 1.0) -> None:
    time, shifted, force = truth()
    load = np.zeros((6, len(time)))
    load[2] = force
    volts = (np.linalg.solve(matrix, load) + 0.1 * np.arange(6)[:, None]) / factor
    head = "Time [s],z [mm]," + ",".join(f"G{i} [{unit}]" for i in range(6)) + "\n"
    rows = "".join(
        ",".join(f"{v:.15g}" for v in row) + "\n"
        for row in np.column_stack([time, shifted, *volts])
    )
    path.write_text(head + rows)


@pytest.mark.parametrize(("unit", "factor"), [("V", 1.0), ("mV", 1e-3)])
def test_gauges_become_the_force(tmp_path: Path, unit: str, factor: float) -> None:
    matrix = cal(tmp_path / "a.cal", version="1.0")
    gauge_file(tmp_path / "a.csv", matrix, unit=unit, factor=factor)
    with pytest.raises(ReadError):
        read_relaxation(tmp_path / "a.csv")
    options = ReadOptions(calibration=str(tmp_path / "a.cal"))
    test = read_relaxation(tmp_path / "a.csv", options=options)
    np.testing.assert_allclose(test.force, truth()[2], atol=1e-9)  # the bias went in volts
    assert any("FT00001" in note for note in test.source.notes)


def test_overload_is_noted(tmp_path: Path) -> None:
    matrix = cal(tmp_path / "a.cal", version="1.1")
    result = read_calibration(tmp_path / "a.cal")
    volts = np.linalg.solve(matrix, np.array([[0], [0], [66.0], [0], [0], [0]]))
    load = result.compute_load(volts)
    assert load[2, 0] == pytest.approx(66.0)
    assert result.note_overloads(load) == [
        "Fz reaches 94 % of its range 70 N: a transducer may saturate before its limit"
    ]


def test_little_of_the_range_is_noted(tmp_path: Path) -> None:
    cal(tmp_path / "a.cal", version="1.1")
    result = read_calibration(tmp_path / "a.cal")
    # the paper's seal: 2.117728 N are 3 % of the range
    assert result.note_small_loads(np.full((6, 3), 2.117728), "Fz") == [
        (
            "Fz reaches 3 % of its range 70 N: what its maker states as a part of the range is 33 "
            "times that part of this load"
        )
    ]
    assert result.note_small_loads(np.full((6, 3), 3.49), "Fz")
    assert not result.note_small_loads(np.full((6, 3), 3.51), "Fz")
    assert not result.note_small_loads(np.zeros((6, 3)), "Fz")


def test_bad_calibrations(tmp_path: Path) -> None:
    path = tmp_path / "a.cal"
    for content, words in [
        (b"no xml", "not an ATI calibration"),
        (b"<a/>", "no FTSensor/Calibration"),
        (b'<!DOCTYPE x [<!ENTITY a "b">]><FTSensor/>', "not an ATI calibration"),
    ]:
        path.write_bytes(content)
        with pytest.raises(ReadError, match=words):
            read_calibration(path)
    with pytest.raises(ReadError, match="there is no such file"):
        read_calibration(tmp_path / "none.cal")
    cal(path, version="1.0", turn="30")
    with pytest.raises(ReadError, match="turns the axes"):
        read_calibration(path)
    cal(path, version="1.0")
    whole = path.read_text()
    path.write_text(whole.replace('Name="Fy"', 'Name="Fq"'))
    with pytest.raises(ReadError, match="axis Fy is missing"):
        read_calibration(path)
    path.write_text(whole.replace('ForceUnits="N"', 'ForceUnits="stone"'))
    with pytest.raises(ReadError, match="'stone' is no unit of force"):
        read_calibration(path)


def test_gauges_are_counted(tmp_path: Path) -> None:
    matrix = cal(tmp_path / "a.cal", version="1.1")
    gauge_file(tmp_path / "a.csv", matrix)
    text = (tmp_path / "a.csv").read_text()
    (tmp_path / "a.csv").write_text(text.replace("G5 [V]", "T5 [degC]"))
    options = ReadOptions(calibration=str(tmp_path / "a.cal"))
    with pytest.raises(ReadError, match="needs six columns of gauge voltages, found 5"):
        read_relaxation(tmp_path / "a.csv", options=options)
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(ReadError, match=r"--calibration \.\.\.,axis=Fq: expected one of Fx"):
        read_relaxation(
            tmp_path / "a.csv", options=ReadOptions(calibration=str(tmp_path / "a.cal"), axis="Fq")
        )
