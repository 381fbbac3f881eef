"""Machine files: written from blank tests, read back, and used by fits."""

from __future__ import annotations

import datetime as dt
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from kit.fits import list_failed_checks
from kit.foreign.blank_rigs import (
    Rig,
    draw_rig,
    draw_seal,
    make_empty,
    make_seal_test,
    make_spring,
    make_stop,
)

import dashpot as dp
from dashpot.base.errors import DataError, ReadError
from dashpot.cli import main
from dashpot.datamodel.machine import Machine, MachineCalibration
from dashpot.extensions.blank_tests.datamodel import BlankTest, MachineFit
from dashpot.extensions.blank_tests.fit import fit_blank_tests
from dashpot.extensions.blank_tests.machine_file import read_machine_file, render_machine_file
from dashpot.workflow.json_archive import from_json, to_json

SLOW = Rig(rate=200.0, hum_frequency=33.3)


def write_csv(path: Path, channels: tuple[np.ndarray, ...]) -> Path:
    t, x, force = channels
    np.savetxt(path, np.column_stack((t, 1e3 * x, force)), delimiter=",", fmt="%.7f",
               header="time [s],displacement [mm],force [N]", comments="")  # fmt: skip
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("blank")
    for name, make in (("stop", make_stop), ("spring", make_spring), ("empty", make_empty)):
        write_csv(place / f"{name}.csv", make(SLOW, 1))
    write_csv(place / "seal.csv", make_seal_test(SLOW, draw_seal(1), 1))
    return place


def measure(rig: Rig, seed: int) -> MachineFit:
    records = [
        BlankTest(*make(rig, seed), units="SI") for make in (make_stop, make_spring, make_empty)
    ]
    return fit_blank_tests(records, spring_stiffness=1e3)


def run(*words: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(folder)
    result = CliRunner().invoke(main, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_a_document_keeps_the_errors_of_the_machine() -> None:
    result = measure(SLOW, 1)
    again = from_json(to_json(result))
    assert again.machine == result.machine
    assert again.reported_values == result.reported_values
    assert again.verdict == result.verdict


def test_fit_writes_a_machine_file_that_fit_reads(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = ("stop.csv", "spring.csv", "empty.csv")
    text = run("fit", *files, "--spring-stiffness", "1N/mm", "--label", "date=2026-11-01",
               "-o", "rig.toml", folder=folder, monkeypatch=monkeypatch)  # fmt: skip
    assert "Use: the machine: compliance" in text.replace("\n", " ")
    written = (folder / "rig.toml").read_text()
    assert 'files = ["stop.csv", "spring.csv", "empty.csv"]' in written
    assert 'roles = ["stop", "spring", "empty"]' in written
    assert re.search(r'sha256 = \["[0-9a-f]{64}"', written)
    machine = dp.read(folder / "rig.toml")
    assert isinstance(machine, Machine)
    expected = machine.calibration
    assert expected is not None
    assert expected.gain == pytest.approx(SLOW.gain, rel=4e-3)
    assert expected.delay == pytest.approx(SLOW.delay, abs=5 * (machine.sync or 0.0))
    assert machine.compliance == pytest.approx(SLOW.compliance, rel=5e-3)
    days = (dt.datetime.now(dt.UTC).date() - dt.date(2026, 11, 1)).days
    assert expected.source == (
        f"machine file rig.toml, measured 2026-11-01 ({days} day{'s' * (days != 1)} ago)"
    )
    run("fit", "seal.csv", "--machine", "rig.toml", "--machine", "rest=30min", "-o", "seal.json",
        folder=folder, monkeypatch=monkeypatch)  # fmt: skip
    assert "machine file rig.toml, measured 2026-11-01" in (folder / "seal.json").read_text()
    fit = dp.fit(dp.read(folder / "seal.csv"), machine=replace(machine, rest=1800.0))
    low, high = fit.stiffness_limits["k_end"]
    assert low < draw_seal(1).relaxed(60.0) < high
    assert json.loads((folder / "seal.json").read_text())["model"]["k_inf"] == pytest.approx(
        fit.model.k_inf, rel=1e-6
    )


def test_report_names_the_machine_file(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "known.toml").write_text(render_machine_file(measure(SLOW, 1), date="2026-10-30"))
    run("report", "seal.csv", "--mass", "104g", "--seals", "2", "--machine", "known.toml", "-o",
        "seal.html", folder=folder, monkeypatch=monkeypatch)  # fmt: skip
    assert "machine file known.toml, measured 2026-10-30 (" in (folder / "seal.html").read_text()


def test_machine_comes_back_from_its_file(tmp_path: Path) -> None:
    result = measure(draw_rig(3), 3).machine
    path = tmp_path / "rig.toml"
    path.write_text(render_machine_file(measure(draw_rig(3), 3)))
    again = read_machine_file(path)
    for name in ("sync", "drift", "compliance", "creep"):
        assert getattr(again, name) == pytest.approx(getattr(result, name), rel=1e-6)
    assert result.calibration is not None
    assert again.calibration is not None
    for name in ("delay", "gain", "gain_error", "compliance_error", "settling"):
        assert getattr(again.calibration, name) == pytest.approx(
            getattr(result.calibration, name), rel=1e-6
        )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[blank]\n", r"the table \[machine\] is missing"),
        ("[machine]\nsinc = '1ms'\n", "'sinc' is unknown; known are sync"),
        ("[machine]\ncompliance = '40 N'\n", "compliance = "),
        ("[machine]\ngain = 25\n", "gain = 25; expected 0.1 to 10"),
        ("[machine]\ngain-error = -1.0\n", "gain-error = -1; expected a number >= 0"),
        ("[machine]\ndelay = '1ms'\n[blank]\ndate = 'May'\n", "expected year-month-day"),
        ("[machine]\ncreep = '-1um'\n", "creep"),
        ("[machine]\n[other]\n", r"\[other\] is unknown"),
        ("machine = 3\n", "expected a table of keys"),
        ("[machine]\ngain = 1.01\n", "gain = 1.01 without its standard error"),
        (
            "[machine]\ngain = 1.01\ngain-error = 0.1\n",
            "gain-error has no effect without compliance",
        ),
        ("[machine]\ncompliance-error = '1um/N'\n", "compliance-error has no effect"),
        (
            "[machine]\ngain-error = 0.1\ngain_error = 0.2\n",
            "gain-error are one key",
        ),
        ("[machine]\ndelay = '1ms'\n[blank]\ndate = 2999-01-01\n", "days ahead"),
        ("[machine]\ndelay = '1ms'\n[blank]\nverdict = 'do not use'\n", "Repeat them"),
        (
            "[machine]\ndelay = '1ms'\n[blank]\nverdict = 'good'\n",
            "expected 'use'",
        ),
    ],
)
def test_wrong_machine_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(text)
    with pytest.raises(ReadError, match=message):
        read_machine_file(path)


def test_machine_file_by_hand_needs_no_origin(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[machine]\ncompliance = '50um/N'\nrest = '10min'\n")
    assert read_machine_file(path) == dp.Machine(compliance="50um/N", rest="10min")


def test_machine_file_by_hand_gives_a_compliance_the_usual_error(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[machine]\ncompliance = '50um/N'\ndelay = '1ms'\n[blank]\ndate = 2026-01-02\n")
    expected, plain = read_machine_file(path), dp.Machine(compliance="50um/N")
    assert expected.give_sd(8e-3, 2.0) == pytest.approx(plain.give_sd(8e-3, 2.0))
    assert expected.calibration is not None
    assert "measured 2026-01-02 (" in expected.calibration.source


def test_calibration_takes_gain_delay_and_settling_off_a_record() -> None:
    rig = replace(SLOW, noise=1e-5, displacement_noise=0.0, hum=0.0, drift=0.0, compliance=0.0)
    seal = draw_seal(2)
    plain = replace(rig, gain=1.0, delay=0.0, creep=0.0)
    expected = MachineCalibration(delay=rig.delay, gain=rig.gain, settling=rig.creep)
    read, true = (
        dp.fit(dp.RelaxationTest(*make_seal_test(each, seal, 2), units="SI"), machine=machine)
        for each, machine in ((rig, Machine(calibration=expected)), (plain, None))
    )
    assert read.model.k_inf == pytest.approx(true.model.k_inf, rel=2e-4)
    assert read.model.k_inf == pytest.approx(seal.k_inf, rel=1e-3)


def test_limits_shrink_to_a_half_and_hold_the_truth_with_the_machine_file() -> None:
    widths, held = [], 0
    for seed in range(6):
        rig, seal = replace(draw_rig(seed), rate=200.0, hum_frequency=33.3), draw_seal(seed)
        test = dp.RelaxationTest(*make_seal_test(rig, seal, seed), units="SI")
        machine = replace(measure(rig, seed).machine, rest=1800.0)
        limits = [
            dp.fit(test, machine=each).stiffness_limits["k_end"]
            for each in (dp.Machine(rest=1800.0), machine)
        ]
        widths.append((limits[1][1] - limits[1][0]) / (limits[0][1] - limits[0][0]))
        held += limits[1][0] <= seal.relaxed(60.0) <= limits[1][1]
    assert held >= 5
    assert np.median(widths) < 0.5


@pytest.mark.parametrize("seed", [1, 21, 26, 36])
def test_contact_error_does_not_bend_the_law_of_a_calibrated_machine(seed: int) -> None:
    """The contact of these is off by one to three standard errors, or the load cell drifts."""
    rig, seal = replace(draw_rig(seed), rate=200.0, hum_frequency=33.3), draw_seal(seed)
    test = dp.RelaxationTest(*make_seal_test(rig, seal, seed), units="SI")
    fit = dp.fit(test, machine=replace(measure(rig, seed).machine, rest=1800.0))
    assert not list_failed_checks(fit) & {"loss_factor_determined", "tangent_determined"}
    low, high = fit.stiffness_limits["k_end"]
    assert low <= seal.relaxed(60.0) <= high


def test_document_of_a_machine_without_calibration_is_as_before() -> None:
    assert "calibration" not in dp.Machine(sync="1ms").to_dict()


def test_machine_file_is_refused_where_nothing_is_corrected() -> None:
    with pytest.raises(DataError, match=r"does not suit a creep test. State .* --machine sync="):
        measure(SLOW, 1).machine.refuse_unused("sync", subject="a creep test")


def test_role_for_no_file_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    result = CliRunner().invoke(
        main, ["fit", "stop.csv", "--kind", "blank", "--role", "stopp.csv:stop"]
    )
    assert result.exit_code != 0
    assert "suits none of the files: stop.csv" in result.output
    stated = CliRunner().invoke(
        main, ["fit", "stop.csv", "--kind", "blank", "--role", "stop.csv:stop"]
    )
    assert stated.exit_code == 0, stated.output


def test_spring_of_no_stiffness_is_refused_as_a_spring(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    words = ["fit", "stop.csv", "spring.csv", "--spring-stiffness", "0N/mm"]
    assert "spring stiffness = 0 N/m; expected" in CliRunner().invoke(main, words).output


def test_python_reads_and_fits_blank_tests(folder: Path) -> None:
    records = [dp.read(folder / f"{name}.csv", kind="blank") for name in ("stop", "spring")]
    result = dp.fit(*records, spring_stiffness="1N/mm")
    assert [record.file for record in result.records] == ["stop.csv", "spring.csv"]
    assert result.plot().strips
    with pytest.raises(DataError, match="role"):
        dp.read(folder / "stop.csv", kind="blank", role="wall")
