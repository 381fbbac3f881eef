"""The simulated transducer, read back by the reader of calibrations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran

from dashpot.base.errors import DataError
from dashpot.extensions.formats.ati import read_calibration
from dashpot.extensions.gauges.transducer import Daq, Instrument, Transducer, nano, write_gauges
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER


def normal(*newton: float) -> np.ndarray:
    load = np.zeros((6, len(newton)))
    load[2] = newton
    return load


def test_gauge_count_is_one_1280th_of_a_newton():
    # R4: resolution 1/1280 N; 2.117728 N -> 2711 counts; a relaxation of 0.5336 N -> 683
    lsb = Daq().lsb
    step = np.array(nano(crosstalk=0.0))[2] * lsb
    np.testing.assert_allclose(step, [1 / 1280, 0, 1 / 1280, 0, 1 / 1280, 0], atol=1e-15)
    assert round(2.117728 / step[0]) == 2711
    assert round(0.5336 / step[0]) == 683


def test_voltages_go_back_to_the_load_through_the_file(tmp_path):
    twin = Transducer()
    (tmp_path / "a.cal").write_text(twin.calibration())
    calibration = read_calibration(tmp_path / "a.cal")
    np.testing.assert_allclose(calibration.matrix, twin.matrix, rtol=1e-12)
    np.testing.assert_allclose(calibration.axis_range, twin.limit)
    load = np.random.default_rng(0).normal(size=(6, 5))
    unloaded = twin.volts(np.zeros((6, 1)))[:, 0]
    assert np.abs(unloaded).max() > 0.1  # the bias, and the plate's weight
    np.testing.assert_allclose(
        calibration.compute_load(twin.volts(load), unloaded), load, atol=1e-12
    )


def test_what_passes_the_range_is_flagged():
    # R4: 70.1 N, or 50.1 N across, is saturated
    twin = Transducer()
    assert twin.find_saturated(normal(69.9, 70.1, -70.1))[2].tolist() == [False, True, True]
    across = np.zeros((6, 2))
    across[:2] = np.array([[49.9, 50.1], [49.9, 50.1]]) / np.sqrt(2)
    assert twin.find_saturated(across)[0].tolist() == [False, True]
    assert not twin.find_saturated(across)[2:].any()
    with pytest.raises(DataError, match="six rows of six numbers that can be inverted"):
        Transducer(matrix=((1.0,) * 6,) * 6)


def test_the_angle_of_a_misaligned_plate_is_in_the_record(tmp_path):
    twin = Instrument(misaligned=np.radians(2.0), towards=0.7)
    made = simulate_relaxation(PAPER, hold_time=2.0, rig=Rig())
    volts = twin.read(made.test.time, made.truth.force, rig=Rig().noise_free())
    expected = np.array(twin.transducer.matrix) @ (volts - volts[:, :100].mean(axis=1)[:, None])
    x, y, z = expected[:3, -500:].mean(axis=1)
    assert np.degrees(np.arctan2(np.hypot(x, y), z)) == pytest.approx(2.0, abs=0.02)
    assert z == pytest.approx(made.truth.force[-500:].mean() * np.cos(np.radians(2.0)), abs=1e-3)


def test_a_gauge_late_in_the_scan_is_late_in_the_record():
    # the axial gauges of channels 1 and 5 are 20 us apart; counts of 305 uV leave 1 us
    time = np.arange(1000) / 1000.0
    twin = Instrument(Transducer(nano(crosstalk=0.0), bias=(0.0,) * 6, tool=0.0))
    quiet = replace(Rig().noise_free(), baseline=0.0)
    volts = twin.read(time, 68.3 * time, rig=quiet)[:, :-1]
    late = (volts[4] - volts[0]).mean() / (68.3 / 3 / 2.56)
    assert late == pytest.approx(20e-6, abs=1e-6)


@pytest.mark.parametrize(("rate", "corner"), [(1000.0, 0.0), (100.0, 0.0), (100.0, 20.0)])
def test_instrument_reports_aliases(rate: float, corner: float):
    twin = Instrument(daq=Daq(rate=rate, filter=corner))
    rig = replace(Rig(), hum_frequency=60.0)
    limitations = twin.list_limitations(np.array([1.0]), rig)
    assert len(limitations) == (rate == 100.0)
    if limitations:
        size = 3.0 / np.sqrt(1 + (60 / corner) ** 4) if corner else 3.0
        assert f"hum of 60 Hz shows at 40 Hz, {size:.3g} mN" in limitations[0]
    assert "beyond its range in Fz" in twin.list_limitations(np.array([71.0]), rig)[0]


def test_a_fit_of_the_voltages_gives_the_seal_back(tmp_path):
    made = simulate_relaxation(PAPER, rig=Rig(), seed=3)
    volts = Instrument().read(made.test.time, made.truth.force, rig=Rig(), seed=3)
    write_gauges(made.test, volts, tmp_path / "a.csv", comments=["simulated"])
    (tmp_path / "a.cal").write_text(Transducer().calibration())
    test = read_relaxation(
        tmp_path / "a.csv", options=ReadOptions(calibration=str(tmp_path / "a.cal"))
    )
    fit = fit_tests(test)
    assert fit.model.arms == 2
    assert fit.model.k_inf == pytest.approx(PAPER.k_inf, rel=2e-3)
    np.testing.assert_allclose(fit.model.k, PAPER.k, rtol=0.03)
    np.testing.assert_allclose(fit.model.tau, PAPER.tau, rtol=0.05)


@pytest.mark.once
def test_the_command_writes_voltages_calibration_and_truth(tmp_path):
    words = "simulate relaxation --hold 3s --gauges --misaligned 2deg --antialias 200Hz -o"
    done = ran(*words.split(), tmp_path / "a.csv")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "a.csv").read_text().count("G5 [V]") == 1
    assert '"filter": 200.0' in (tmp_path / "a.truth.json").read_text()
    shown = ran("inspect", tmp_path / "a.csv", "--calibration", tmp_path / "a.cal")
    assert shown.exit_code == 0, shown.output
    assert "calibration of SIMULATED" in shown.output
    for words, message in [
        ("impact --gauges", "--gauges is for a relaxation test or a motion, not for impact"),
        ("relaxation --misaligned 2deg", "--misaligned is for the transducer and its card"),
        ("relaxation --follow a.csv", "replayed by 'dashpot simulate motion --follow FILE'"),
        ("relaxation --gauges", "the calibration of the gauges lies beside the file"),
        ("motion", "replayed by 'dashpot simulate motion --follow FILE'"),
    ]:
        out = "-" if "--gauges" in words and "impact" not in words else tmp_path / "b.csv"
        bad = ran("simulate", *words.split(), "-o", out)
        assert bad.exit_code == 2
        assert message in " ".join(bad.output.split())
