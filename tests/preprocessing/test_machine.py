"""Corrections of the recorded motion by a stated machine."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit.trials import DISTURBANCES, KINDS, Bench, Seal, record, relaxation_test, trial

import dashpot as dp
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.checks import motion_measured
from dashpot.preprocessing.denoising import denoise_displacement
from dashpot.preprocessing.prepare import prepare
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import from_json, to_json

pytestmark = pytest.mark.once

PAPER = Seal.of_arms(196.5, (117.5, 17.8), (0.5021, 16.416))
OMEGA = 2 * np.pi * 12.7
RATE = 250.0


def fit_bench(bench: Bench, machine: dp.Machine | None = None, seed: int = 0) -> dp.Fit:
    test = relaxation_test(record(PAPER, bench, seed=seed))
    return fit_tests(prepare(test, machine=machine), arms=2)


def test_the_give_of_the_machine_is_off_the_motion():
    item = record(PAPER, Bench(compliance=50e-6, rate=RATE).perfect())
    test = prepare(relaxation_test(item), machine=dp.Machine(compliance=50e-6))
    np.testing.assert_allclose(test.displacement, item.compression[-len(test.time) :], atol=2e-9)
    held = item.compression[-len(test.time) :][test.hold]
    assert test.depth == pytest.approx(held.mean(), rel=1e-4)
    travel = item.displacement[-len(test.time) :]
    np.testing.assert_allclose(test.travel[test.displacement > 0], travel[test.displacement > 0])
    message = next(step for step in test.steps if step.name == "machine")
    assert "5e-05 m/N" in message.message


STIFF = Seal.of_arms(2000.0, (800.0, 600.0), (1.0, 30.0))
SOFT_MACHINE = Bench(compliance=33e-6, rate=RATE)


def read_named(name: str, seal: Seal, folder: Path) -> dp.RelaxationTest:
    """Return the test of a seal on the soft machine, from a file with this name of the motion."""
    test = relaxation_test(record(seal, SOFT_MACHINE))
    rows = np.column_stack([test.time, 1e3 * test.displacement, test.force])
    header = f"time [s],{name} [mm],force [N]"
    np.savetxt(folder / "seal.csv", rows, delimiter=",", header=header, comments="", fmt="%.6f")
    return dp.read(folder / "seal.csv")


@pytest.mark.parametrize(
    "name",
    ["Crosshead", "crosshead position", "Traverse", "Traversenweg", "Kolbenweg", "Stroke",
     "piston stroke", "Actuator displacement", "ストローク"],
)  # fmt: skip
def test_prepare_doubts_a_motion_named_for_a_soft_machine(name, tmp_path):
    test = read_named(name, STIFF, tmp_path)
    doubt = next(c for c in test.prepare().checks if c.name == "machine_deflection_small")
    assert doubt.failed
    assert "a crosshead or piston" in doubt.message
    stated = test.prepare(machine=dp.Machine(compliance=33e-6))
    assert all(check.name != "machine_deflection_small" for check in stated.checks)


def test_a_fit_to_a_crosshead_needs_the_compliance(tmp_path):
    test = read_named("crosshead", STIFF, tmp_path)
    doubtful, stated = dp.fit(test), dp.fit(test, machine=dp.Machine(compliance=33e-6))
    ends = [fit.evidence.end_of_hold for fit in (doubtful, stated)]
    truths = [STIFF.relaxation(np.array([end.end_time])).item() for end in ends]
    assert ends[0].k_end[1] < truths[0]  # too soft: limits that no one may rely on
    assert doubtful.verdict.use == "use with care"
    assert ends[1].k_end[0] < truths[1] < ends[1].k_end[1]
    assert stated.verdict.use == "use"


@pytest.mark.parametrize("name", ["displacement", "laser", "Weg", "extensometer"])
def test_prepare_does_not_doubt_another_motion(name, tmp_path):
    test = read_named(name, STIFF, tmp_path)
    assert all(c.name != "machine_deflection_small" for c in test.prepare().checks)


def test_prepare_accepts_the_crosshead_over_a_soft_seal(tmp_path):
    test = read_named("crosshead", PAPER, tmp_path)
    check = next(c for c in test.prepare().checks if c.name == "machine_deflection_small")
    assert check.passed


def test_encoder_step_is_detected_after_compliance_correction():
    test = relaxation_test(record(PAPER, Bench(compliance=50e-6, hold=10.0)))
    ramp_hold = prepare(test, machine=dp.Machine(compliance=50e-6))
    assert ramp_hold.encoder_step == pytest.approx(20e-6)
    x, _ = denoise_displacement(ramp_hold)
    item = record(PAPER, Bench(compliance=50e-6, hold=10.0).perfect())
    assert np.abs(x - item.compression[-len(x) :]).max() < 10e-6


def test_a_rig_that_is_not_described_changes_nothing():
    test = relaxation_test(record(PAPER, Bench(hold=5.0, rate=RATE)))
    plain, ramp_hold = prepare(test), prepare(test, machine=dp.Machine())
    assert np.array_equal(plain.displacement, ramp_hold.displacement)
    assert plain.travel is plain.displacement
    assert plain.steps == ramp_hold.steps


def test_compliance_correction_restores_the_stiffness():
    fit = fit_bench(Bench(rate=RATE))
    bench = Bench(compliance=50e-6, rate=RATE)
    silent, expected = fit_bench(bench), fit_bench(bench, dp.Machine(compliance=50e-6))
    assert silent.model.k_inf / fit.model.k_inf - 1 == pytest.approx(-0.0098, abs=0.001)
    assert expected.model.k_inf / fit.model.k_inf == pytest.approx(1, abs=1e-3)
    np.testing.assert_allclose(expected.model.k, fit.model.k, rtol=2e-3)


def test_force_filter_is_detected_as_delay_and_corrected_by_name():
    def loss(fit: dp.Fit) -> float:
        return float(fit.model.loss(omega=OMEGA))

    # K'' is a hundredth of K' here: 1 % of it is a delay of 1.3 us
    intact = loss(fit_bench(Bench()))
    bench = Bench(force_filter=10.0)
    unnamed = fit_bench(bench)
    (late,) = [quantity.value for quantity in unnamed.estimate.nuisance if quantity.name == "delay"]
    assert late == pytest.approx(1 / (2 * np.pi * 10.0), rel=0.02)
    (message,) = [step.message for step in unnamed.provenance.steps if step.name == "lag"]
    assert re.fullmatch(
        r"put the motion behind a low-pass of 1\d(\.\d)? ms, as the force comes", message
    )
    assert "clocks_agree" in [check.name for check in unnamed.checks if check.failed]
    assert loss(unnamed) / intact == pytest.approx(1, abs=0.005)
    assert loss(fit_bench(bench, dp.Machine(force_filter=10.0))) / intact == pytest.approx(
        1, abs=0.01
    )


def test_a_machine_that_gives_more_than_it_moves_is_a_wrong_unit():
    test = relaxation_test(record(PAPER, Bench(hold=5.0, rate=RATE)))
    with pytest.raises(dp.DataError, match="check the unit of the compliance"):
        prepare(test, machine=dp.Machine(compliance=50e-3))


def failures(disturbance: str | None, solids: slice) -> list[str]:
    bench = Bench() if disturbance is None else DISTURBANCES[disturbance]
    tests = (prepare(relaxation_test(trial(kind, seed=0, bench=bench))) for kind in KINDS[solids])
    return [check.name for test in tests for check in test.checks if check.failed]


@pytest.mark.parametrize("disturbance", [None, "hum", "late 1 ms", "compliance", "drift"])
def test_a_motion_that_was_sampled_well_is_not_doubted(disturbance):
    assert set(failures(disturbance, slice(0, None, 2))) <= {"baseline_recorded"}


@pytest.mark.parametrize("disturbance", ["coarse 250 Hz", "coarse 500 Hz"])
def test_a_motion_finer_than_the_sampling_is_doubted(disturbance):
    # the first ramp of the trials lasts 0.2 s: 10 set-points
    assert failures(disturbance, slice(0, 7)).count("motion_resolved") == 7


def test_a_still_hold_is_named_as_a_doubt_and_not_as_a_fault():
    still = prepare(relaxation_test(record(PAPER, Bench(rate=RATE))))
    check = next(check for check in still.checks if check.name == "motion_measured")
    assert check.passed is None
    assert "its step of 20 um hides the change" in check.message


def test_motion_check_of_a_constant_negative_force_omits_the_share():
    ready = prepare(relaxation_test(record(PAPER, Bench(rate=RATE))))
    resting = replace(
        ready, force=np.full_like(ready.force, -2.0),
        displacement=np.full_like(ready.displacement, ready.displacement[-1]),
    )  # fmt: skip
    message = motion_measured(resting).message
    assert "would change the force by 2 mN over" in message


@pytest.mark.parametrize(
    "wrong", [{"sync": -1.0}, {"drift": np.nan}, {"compliance": np.inf}, {"force_filter": 0.0}]
)
def test_a_rig_of_nonsense_is_refused(wrong):
    with pytest.raises(dp.DataError, match="expected a number"):
        dp.Machine(**wrong)


def test_a_ramp_and_hold_has_no_oven():
    test = relaxation_test(record(PAPER, Bench(hold=5.0, rate=RATE)))
    with pytest.raises(dp.DataError, match="oven= does not suit a ramp and hold"):
        prepare(test, machine=dp.Machine(oven="1K"))


def test_a_described_rig_survives_the_archive():
    test = relaxation_test(record(PAPER, Bench(hold=5.0, rate=RATE)))
    ramp_hold = prepare(test, machine=dp.Machine(sync=5e-4, compliance=50e-6))
    again = from_json(to_json(ramp_hold))
    assert again.machine == ramp_hold.machine
    job = Job("seal.csv", machine=ramp_hold.machine)
    assert from_json(to_json(job)) == job
    assert np.array_equal(again.displacement, ramp_hold.displacement)
