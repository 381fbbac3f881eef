"""Files of tests at several temperatures: one fit of them, and predictions at any of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit import cold

import dashpot as dp
from dashpot.base.errors import FitError
from dashpot.extensions.projects.project import create, record
from dashpot.extensions.projects.verification import verify
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.write import write_relaxation
from dashpot.report import html
from dashpot.simulation.impact import simulate_impact
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.workflow import EXAMPLES, fit_files, predict_files
from dashpot.workflow.job import BlockOnSeals, Job, ShiftChoices
from dashpot.workflow.json_archive import from_json, to_json
from dashpot.workflow.study import characterise

pytestmark = pytest.mark.once

MASS, BAND = 0.1148, (8.0, 18.0)


@pytest.fixture(scope="module")
def bench(tmp_path_factory) -> tuple[Path, Path]:
    """A warm and a cold record whose files do not say so."""
    folder = tmp_path_factory.mktemp("bench")
    files = folder / "warm.csv", folder / "cold.csv"
    for file, test in zip(files, cold.records("hidden", (23.0, 0.0), 0), strict=True):
        bare = dp.RelaxationTest(test.time, test.displacement, test.force, units="SI")
        file.write_text(write_relaxation(bare))
    return files


@pytest.fixture(scope="module")
def pair_fit(bench) -> dp.Fit:
    return fit_files(bench, temperatures=(296.15, 273.15))[0]


def test_temperatures_stand_in_the_order_of_the_files(bench, pair_fit):
    assert [round(shift.temperature, 2) for shift in pair_fit.temperatures.shifts] == [
        273.15,
        296.15,
    ]
    assert pair_fit.temperatures.shifts[0].log10_a_t == pytest.approx(
        cold.log10_a(273.15), abs=0.01
    )
    swapped, _ = fit_files(bench, temperatures=(273.15, 296.15))
    assert swapped.verdict.use == "do not use"
    # the closest solid explains neither by a shift alone
    failed = {check.name for check in swapped.checks if check.failed}
    assert {"thermorheologically_simple", "vertical_shift_plausible"} <= failed


def test_fit_files_detects_another_seal_among_cold_tests(bench, pair_fit, tmp_path):
    assert pair_fit.verdict.use == "use"
    cool = read_relaxation(bench[1])
    other = tmp_path / "other.csv"
    other.write_text(write_relaxation(replace(cool, force=0.75 * cool.force)))
    mixed, _ = fit_files((bench[0], other), temperatures=(296.15, 273.15))
    assert "vertical_shift_plausible" in {check.name for check in mixed.verdict.failed_checks}


def test_fit_files_applies_one_temperature_to_all_files(bench):
    with pytest.raises(dp.DataError, match=r"given 3 times for 2 files"):
        fit_files(bench, temperatures=(1.0, 2.0, 3.0))
    item, _ = fit_files(bench[:1], temperatures=(296.15,))
    assert item.specimen.temperature == 296.15


def test_fit_files_uses_the_requested_reference_temperature(bench):
    result, _ = fit_files(
        bench, temperatures=(296.15, 273.15), shifting=ShiftChoices(reference=273.15)
    )
    assert result.temperatures.reference == 273.15
    assert result.temperatures.shifts[1].log10_a_t == pytest.approx(-cold.log10_a(273.15), abs=0.01)
    with pytest.raises(dp.FitError, match="no test is of the reference temperature 10 degC"):
        fit_files(bench, temperatures=(296.15, 273.15), shifting=ShiftChoices(reference=283.15))
    with pytest.raises(dp.FitError, match="--shifts are for sweeps"):
        fit_files(bench, temperatures=(296.15, 273.15), shifting=ShiftChoices(at=283.15))


@pytest.mark.parametrize("celsius", [23.0, 0.0, 10.0])
def test_a_prediction_at_a_temperature_is_within_its_bounds(bench, pair_fit, celsius):
    kelvin = celsius + 273.15
    made = predict_files(
        pair_fit, bench, block=BlockOnSeals(MASS, 2), band=BAND, temperature=kelvin
    )
    assert made.to_dict()["temperature"] == pytest.approx(kelvin)
    f = made.limits.frequency
    stiffness = np.array([cold.complex_stiffness("hidden", item, celsius) for item in f])
    omega = 2 * np.pi * f
    true = omega**2 / np.abs(2 * stiffness - MASS * omega**2)
    low, high = made.limits.unmeasured
    assert np.mean((low <= true) & (true <= high)) > 0.95
    frf = dp.systems.predict_frf(pair_fit, mass=MASS, seals=2, frequency=f, temperature=kelvin)
    assert (low <= 1.0001 * np.abs(frf.value)).all()
    assert (np.abs(frf.value) <= 1.0001 * high).all()
    assert "temperature_tested" not in {check.name for check in made.checks if check.failed}


def test_predict_files_takes_record_temperatures_from_the_fit(bench, pair_fit):
    again = from_json(to_json(pair_fit))
    prediction = predict_files(again, bench, block=BlockOnSeals(MASS, 2), band=BAND)
    low, high = prediction.limits.peak_frequency
    fine = np.linspace(*BAND, 4001)
    stiffness = np.array([cold.complex_stiffness("hidden", f, 23.0) for f in fine])
    omega = 2 * np.pi * fine
    assert low < fine[np.argmax(omega**2 / np.abs(2 * stiffness - MASS * omega**2))] < high
    # a machine of which nothing is said may move it by so much unseen
    assert high - low < 0.5


def test_predict_files_refuses_extrapolation_from_two_temperatures(bench, pair_fit):
    with pytest.raises(dp.DataError, match="third temperature"):
        predict_files(pair_fit, block=BlockOnSeals(MASS), band=BAND, temperature=263.15)


def test_predict_frf_refuses_a_temperature_for_a_bare_model(pair_fit):
    with pytest.raises(dp.DataError, match="a solid has no temperature"):
        dp.systems.predict_frf(pair_fit.model, mass=MASS, temperature=273.15)


def test_the_document_of_a_fit_says_its_temperatures(pair_fit):
    temperature = json.loads(to_json(pair_fit))["temperature"]
    assert temperature["reference"] == 296.15
    assert temperature["law"]["kind"] == "free"
    assert {"temperature", "log10_a_t", "se", "b_t"} <= set(temperature["shifts"][0])


def test_the_main_job_takes_a_cold_test_too(bench, tmp_path):
    job = Job(
        str(bench[1]),
        other_tests=(str(bench[0]),),
        temperatures=(273.15, 296.15),
        mass=MASS,
        seals=2,
    )
    project = create(tmp_path / "seal")
    study, _ = record(project, job, page=html)
    # what is shown is the test of the solid's own temperature
    assert study.prepared.specimen.temperature == pytest.approx(296.15)
    assert [other_test.specimen.temperature for other_test in study.other_tests] == [
        pytest.approx(273.15)
    ]
    assert study.fit.model.arms == 3
    page = html(study)
    assert "One model at several temperatures" in page
    assert "three are needed" in page
    assert not [check for check in verify(project, page=html) if check.failed]


def test_a_hammer_joins_tests_at_several_temperatures():
    tests = cold.records("hidden", (23.0, 0.0), 0)
    model = dp.GeneralizedMaxwell(*cold.HIDDEN)
    hits = simulate_impact(model, mass=MASS, seals=2, seed=1).test
    study = characterise(
        tests[0], estimate_frf(hits), tests=tests[1:], block=BlockOnSeals(MASS, 2.0)
    )
    assert abs(study.comparison.predicted_hz / study.comparison.measured_hz - 1) < 2e-3
    assert study.joint is not None
    assert study.joint.verdict.use == "use"
    stiffness = study.joint.model.complex_stiffness(omega=2 * np.pi * cold.RESONANCE)
    true = cold.complex_stiffness("hidden")
    assert stiffness.imag == pytest.approx(true.imag, rel=0.02)
    assert study.joint.at("0degC").k_inf < study.joint.model.k_inf


def test_characterise_shifts_a_hammer_test_at_another_temperature():
    tests = cold.records("hidden", (23.0, 0.0), 0)
    model = dp.GeneralizedMaxwell(*cold.HIDDEN)
    there = model.shift_to_temperature(10 ** cold.log10_a(283.15), 283.15 / cold.REFERENCE)
    hits = simulate_impact(there, mass=MASS, seals=2, seed=1).test
    study = characterise(
        tests[0],
        estimate_frf(hits),
        tests=tests[1:],
        block=BlockOnSeals(MASS, 2.0),
        impact_temperature="10degC",
    )
    assert abs(study.comparison.predicted_hz / study.comparison.measured_hz - 1) < 3e-3
    true = cold.complex_stiffness("hidden", celsius=10.0)
    stiffness = study.joint.model.complex_stiffness(omega=2 * np.pi * cold.RESONANCE)
    assert stiffness.real == pytest.approx(true.real, rel=3e-3)
    assert stiffness.imag == pytest.approx(true.imag, rel=0.04)
    folder = study.joint.at("23degC").complex_stiffness(omega=2 * np.pi * cold.RESONANCE)
    assert folder.imag == pytest.approx(cold.complex_stiffness("hidden").imag, rel=0.08)


def test_temperature_figure_draws_every_test_with_one_model(bench, pair_fit):
    records = [prepare(item) for item in cold.records("hidden", (23.0, 0.0), 0)]
    picture = dp.plot.temperatures(pair_fit, records)
    forces, shifts = (strip[0] for strip in picture.strips)
    labels = {mark.label for mark in forces.marks}
    assert {"0 °C", "23 °C", "one model"} <= labels
    assert shifts.title.startswith("shift factors")
    with pytest.raises(dp.DataError, match="one temperature"):
        dp.plot.temperatures(fit(records[0], arms=1), records)


def test_sweeps_at_one_temperature_each_form_one_master_curve(tmp_path: Path) -> None:
    head, *rows = EXAMPLES["sweeps.csv"]().splitlines()[2:]
    warm: dict[int, list[str]] = {}
    for row in rows:
        *cells, celsius = row.split(",")
        warm.setdefault(round(float(celsius) / 5) * 5, []).append(",".join(cells))
    files = []
    for celsius, lines in warm.items():
        files.append(tmp_path / f"{celsius}.csv")
        files[-1].write_text("\n".join([head.rpartition(",")[0], *lines]))
    kelvin = [celsius + 273.15 for celsius in warm]
    separate, _ = fit_files(files, arms=6, temperatures=kelvin)
    (tmp_path / "all.csv").write_text(EXAMPLES["sweeps.csv"]())
    together, _ = fit_files([tmp_path / "all.csv"], arms=6)
    assert separate.model.tau == pytest.approx(together.model.tau, rel=0.02)
    with pytest.raises(FitError, match="says no temperature"):
        fit_files(files[:2], arms=6)
