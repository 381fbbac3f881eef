"""Relaxation tests in strain and stress: moduli in Pa, by an integration of their own."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import DashpotError, ReadError
from dashpot.cli import main
from dashpot.extensions.curves.datamodel.stress_relaxation import StressRelaxationTest
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.extensions.curves.modulus.stress_relaxation import convert_sentence
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.workflow.bench_tests import fit_files

E_INF, ARMS = 3.0, ((1.2, 1.0), (0.8, 15.0))
"""MPa; MPa and s."""
TIME = np.round(np.arange(0, 200, 0.1), 6)
STRAIN = 0.1 * np.clip((TIME - 2) / 2, 0, 1)


def integrated_stress(strain: np.ndarray, step: float) -> np.ndarray:
    """MPa, exact for a strain that is straight between samples."""
    stress = E_INF * strain
    for modulus, tau in ARMS:
        arm, decay = np.zeros_like(strain), np.exp(-step / tau)
        for i in range(1, len(strain)):
            rise = (strain[i] - strain[i - 1]) * tau / step * (1 - decay)
            arm[i] = arm[i - 1] * decay + modulus * rise
        stress = stress + arm
    return stress


STRESS = integrated_stress(STRAIN, 0.1) + np.random.default_rng(0).normal(0, 8e-4, len(TIME))


def write_record(path, head="Time [s];Strain [%];Stress [MPa]", strain=100.0, stress=1.0):
    rows = zip(TIME, strain * STRAIN, stress * STRESS, strict=True)
    path.write_text("\n".join([head, *(f"{t:.2f};{e:.9g};{s:.9g}" for t, e, s in rows)]) + "\n")
    return path


def fit_file(path, options=None):
    return fit_files((path,), options=options)[0]


@pytest.mark.parametrize(
    ("head", "strain", "stress"),
    [
        ("Time [s];Strain [%];Stress [MPa]", 100.0, 1.0),
        ("Zeit [s];Dehnung [mm/mm];Spannung [kPa]", 1.0, 1e3),
        ("time (s);compressive strain (%);compressive stress (N/mm²)", -100.0, -1.0),
    ],
)
def test_fit_of_strain_and_stress_gives_moduli(tmp_path, head, strain, stress) -> None:
    path = write_record(tmp_path / "relax.csv", head, strain, stress)
    assert inspect_file(path).kind == "modulus"
    test = read_modulus(path)
    assert isinstance(test, StressRelaxationTest)
    np.testing.assert_allclose(test.stress, np.sign(stress) * 1e6 * STRESS, atol=1)
    fit = dp.fit(test)
    assert fit.unit == "Pa"
    assert fit.verdict.use == "use"
    assert fit.model.k_inf == pytest.approx(1e6 * E_INF, rel=5e-3)
    np.testing.assert_allclose(fit.model.k, [1e6 * modulus for modulus, _ in ARMS], rtol=0.02)
    np.testing.assert_allclose(fit.model.tau, [tau for _, tau in ARMS], rtol=0.02)
    assert fit.estimate.residual.rms == pytest.approx(800, rel=0.05)
    assert not any(" N/mm" in check.message or "mN" in check.message for check in fit.checks)


def test_fit_of_strain_and_stress_is_that_of_a_specimen(tmp_path) -> None:
    """Of 20 mm by 50 mm²: k = E A / L."""
    path = write_record(tmp_path / "relax.csv")
    material = fit_file(path)
    units = {"displacement": "0.2mm", "force": "50N"}
    part = fit_file(path, ReadOptions(displacement="Strain", force="Stress", units=units))
    assert part.unit == "N/m"
    assert part.model.k_inf == pytest.approx(material.model.k_inf * 50e-6 / 20e-3, rel=2e-3)


@pytest.mark.parametrize("solver", ["abaqus", "ansys"])
def test_export_of_strain_and_stress_writes_a_material(tmp_path, solver) -> None:
    fit = fit_file(write_record(tmp_path / "relax.csv"))
    fit.save(tmp_path / "fit.json")
    assert json.loads((tmp_path / "fit.json").read_text())["unit"] == "Pa"
    with pytest.raises(SystemExit) as ended:
        main(["export", str(tmp_path / "fit.json"), "--to", solver, "-o", str(tmp_path / "deck"),
              "--form", "prony", "--unit-system", "mm-t-s", "--temperature", "23degC"])  # fmt: skip
    assert ended.value.code in {0, None}
    shares = [modulus / (E_INF + sum(m for m, _ in ARMS)) for modulus, _ in ARMS]
    text = (tmp_path / "deck").read_text()
    assert "MPa" in text
    numbers = [float(n) for n in re.findall(r"0\.\d{6,}", text.splitlines()[-1] + text)]
    for share in shares:
        assert min(abs(number - share) for number in numbers) < 0.005


def test_fit_draws_strain_and_stress(tmp_path) -> None:
    path = write_record(tmp_path / "relax.csv")
    with pytest.raises(SystemExit):
        main(["fit", str(path), "--plot", str(tmp_path / "fit.svg")])
    assert "stress, MPa" in (tmp_path / "fit.svg").read_text()


def test_fit_refuses_several_in_stress(tmp_path) -> None:
    paths = [write_record(tmp_path / name) for name in ("a.csv", "b.csv")]
    with pytest.raises(DashpotError, match="fitted alone"):
        fit_files(paths)


def test_read_asks_about_a_strain_in_the_wrong_unit(tmp_path) -> None:
    path = write_record(tmp_path / "relax.csv", strain=1.0)  # fractions under %
    with pytest.raises(ReadError, match="--units strain=1"):
        read_modulus(path)
    fit = fit_file(path, ReadOptions(units={"strain": "1"}))
    assert fit.model.k_inf == pytest.approx(1e6 * E_INF, rel=5e-3)


def test_convert_sentence_speaks_of_stress() -> None:
    text = "The force drifts by 2 mN/s and 1.5 N at 8 mm, 0.3 µm of it noise; 2.5 N/mm, 12 s."
    wanted = "The stress drifts by 2 kPa/s and 1.5 MPa at 800 %, 0.03 % of it noise; 2.5 MPa, 12 s."
    assert convert_sentence(text) == wanted


# -- which test a record is, and its sizes --------------------------------------------------------


def write_columns(path, head, *columns):
    rows = (";".join(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def write_motion(path, corners, stop, head="Time [s];Strain [%];Stress [MPa]", relaxing=True):
    t = np.round(np.arange(0, stop, 0.1), 6)
    strain = np.interp(t, *zip(*corners, strict=True))
    stress = integrated_stress(strain, 0.1) if relaxing else E_INF * strain
    stress = stress + np.random.default_rng(3).normal(0, 8e-4, len(t))
    return write_columns(path, head, t, 100 * strain, stress)


STEPS = [(0, 0), (10, 0), (11, 0.04), (70, 0.04), (71, 0.08), (130, 0.08), (131, 0.12), (190, 0.12)]
DOWN = [(0, 0), (10, 0), (12, 0.1), (70, 0.1), (72, 0.05), (130, 0.05), (132, 0.1), (300, 0.1)]
CYCLES = [(0, 0), (10, 0), (12, 0.1), (14, 0), (16, 0.1), (18, 0), (30, 0), (32, 0.1), (300, 0.1)]


SQUARE = [(0, 0), (10, 0), (11, 0.1), (40, 0.1), (41, 0), (70, 0), (71, 0.1), (100, 0.1), (101, 0),
          (130, 0), (131, 0.1), (160, 0.1)]  # fmt: skip


@pytest.mark.parametrize(
    "corners", [STEPS, DOWN, CYCLES, SQUARE], ids=["steps", "down", "cycles", "square"]
)
def test_relaxation_in_several_holds_is_one_model(tmp_path, corners) -> None:
    """The strain is followed from its first sample on."""
    path = write_motion(tmp_path / "holds.csv", corners, corners[-1][0])
    assert inspect_file(path).kind == "modulus"
    fit = fit_file(path)
    t = np.array([1.0, 5.0, 20.0, 50.0])
    truth = E_INF + sum(m * np.exp(-t / tau) for m, tau in ARMS)
    np.testing.assert_allclose(fit.model.relaxation(t), 1e6 * truth, rtol=0.01)
    assert fit.verdict.use != "do not use"


def test_steps_of_an_elastic_specimen_stay_an_elastic_curve(tmp_path) -> None:
    path = write_motion(tmp_path / "steps.csv", STEPS, 190, relaxing=False)
    assert inspect_file(path).kind == "stress-strain"


@pytest.mark.parametrize(
    "head", ["t [s];ε [-];σ [MPa]", "t [s];strain [-];σ [MPa]", "t [s];γ [-];τ [MPa]"]
)
def test_stress_next_to_a_strain_is_no_modulus(tmp_path, head) -> None:
    """In the ramp's middle, where every stress is above zero."""
    rows = slice(25, None)
    path = write_columns(tmp_path / "relax.csv", head, TIME[rows], STRAIN[rows], STRESS[rows])
    assert isinstance(read_modulus(path), StressRelaxationTest)
    assert fit_file(path).verdict.use != "use"
    whole = write_columns(tmp_path / "whole.csv", head, TIME, STRAIN, STRESS)
    assert fit_file(whole).model.k_inf == pytest.approx(1e6 * E_INF, rel=5e-3)


def test_hold_without_a_clock_needs_its_rate(tmp_path) -> None:
    path = write_columns(tmp_path / "relax.csv", "Strain [%];Stress [MPa]", 100 * STRAIN, STRESS)
    with pytest.raises(ReadError, match="--rate"):
        fit_file(path)
    fit = fit_file(path, ReadOptions(rate=10.0))
    assert fit.model.k_inf == pytest.approx(1e6 * E_INF, rel=5e-3)


def test_a_plateau_of_a_foam_without_a_clock_is_an_elastic_curve(tmp_path) -> None:
    strain = np.linspace(0, 0.6, 400)
    stress = 0.02 * np.tanh(strain / 0.03) + 0.4 * np.maximum(strain - 0.5, 0) ** 2
    path = write_columns(tmp_path / "foam.csv", "Strain [%];Stress [MPa]", 100 * strain, stress)
    assert inspect_file(path).kind == "stress-strain"


@pytest.mark.parametrize(
    ("head", "strain", "stress", "requested"),
    [
        ("Time [s];Strain [mm/mm];Stress [MPa]", 100.0, 1.0, "strain=%"),
        ("Time [s];Strain [%];Stress [MPa]", 100.0, 1e3, "stress=MPa"),
        ("Time [s];Strain [%];Stress [kPa]", 100.0, 1.0, "stress=kPa"),
    ],
)
def test_relaxation_of_no_rubber_raises_a_question(tmp_path, head, strain, stress, requested):
    with pytest.raises(ReadError, match=requested):
        read_modulus(write_record(tmp_path / "relax.csv", head, strain, stress))


def test_relaxation_at_a_small_strain_raises_no_question(tmp_path) -> None:
    path = write_record(tmp_path / "relax.csv", strain=10.0, stress=0.1)  # 1 %
    fit = fit_file(path)
    assert fit.model.k_inf == pytest.approx(1e6 * E_INF, rel=5e-3)


def test_creep_of_no_rubber_raises_a_question(tmp_path) -> None:
    t = np.arange(0, 100, 0.1)
    stress = 400 * np.clip((t - 2) / 1, 0, 1)  # kPa, called MPa
    strain = 10 * np.clip((t - 2) / 1, 0, 1) * (1 + 0.2 * (1 - np.exp(-np.maximum(t - 3, 0) / 10)))
    path = write_columns(
        tmp_path / "creep.csv", "Time [s];Strain [%];Stress [MPa]", t, strain, stress
    )
    with pytest.raises(ReadError, match="stress=MPa"):
        fit_file(path)


def test_hold_from_its_last_row_to_its_first_is_refused(tmp_path) -> None:
    rows = slice(None, None, -1)
    columns = (TIME[rows], 100 * STRAIN[rows], STRESS[rows])
    path = write_columns(tmp_path / "relax.csv", "Time [s];Strain [%];Stress [MPa]", *columns)
    with pytest.raises(ReadError, match="time"):
        fit_file(path)
