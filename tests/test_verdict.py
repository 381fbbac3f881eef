"""The verdict: a perfect pair fails nothing, and what must not be used says so first."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import click
import numpy as np
import pytest
from click.testing import CliRunner
from kit import handmade
from kit.fits import a_fit, replace_fields
from kit.trials import DISTURBANCES, KINDS, LAWS, trial
from kit.verdicts import evaluate_record, failures, table

import dashpot as dp
from dashpot.base.checks import Check, Remedy, select_gravest_check, verdict
from dashpot.base.errors import Status
from dashpot.cli._command import verb
from dashpot.cli._command_result import CommandResult
from dashpot.cli._options import result_options
from dashpot.fitting.identification.identify import identify
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, PAPER, PAPER_MASS
from dashpot.text_output import results
from dashpot.text_output.layout import Text, format_for_screen
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.mass_on_seals import predict_frf
from dashpot.workflow.job import BlockOnSeals
from dashpot.workflow.json_archive import from_json, to_json
from dashpot.workflow.study import characterise

pytestmark = pytest.mark.once

NOTE = Check("a_note", False, "A note.", grade="note")
LIMIT = Check("a_limit", False, "A limit.", remedy=Remedy("Do this."))
STOP = Check("a_stop", False, "A stop.", grade="stop", remedy=Remedy("Do that.", "band", "1:5Hz"))
OPEN = Check("open", None, "not checked", grade="stop")


# -- the rule -------------------------------------------------------------------------------------


def test_the_gravest_failure_decides() -> None:
    assert verdict([OPEN, NOTE]).use == "use"
    assert verdict([OPEN, NOTE]).failed_checks == ()
    assert verdict([NOTE, LIMIT]).use == "use with care"
    outcome = verdict([NOTE, LIMIT, STOP])
    assert (outcome.use, outcome.failed_checks) == ("do not use", (STOP, LIMIT))
    assert outcome.message == "A stop. Do that. 1 more check failed."


def test_select_gravest_check_of_several_tests() -> None:
    assert select_gravest_check([OPEN, replace(OPEN, passed=True)]).passed
    assert select_gravest_check([OPEN]).passed is None
    assert select_gravest_check([LIMIT]) is LIMIT
    check = select_gravest_check([LIMIT, STOP, NOTE])
    assert (check.grade, check.message) == ("stop", "In test 2 of 3, a stop.")


# -- what must pass -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("seal", "mass"), [(PAPER, PAPER_MASS), pytest.param(BROAD, BROAD_MASS, id="broad")]
)
def test_a_noise_free_perfect_pair_fails_nothing(seal: dp.GeneralizedMaxwell, mass: float) -> None:
    """The broad seal's fast arms are out of the bench's reach, so its first prediction misses."""
    bench = simulate_relaxation(seal, rig=Rig().noise_free(), seed=1).test
    hammer = simulate_impact(seal, mass=mass, hits=5, rig=Hammer().noise_free(), seed=1).test
    frf = estimate_frf(hammer, mass=mass)
    study = characterise(bench, frf, impact=hammer, block=BlockOnSeals(mass, 2))
    assert study.verdict.use == "use", study.verdict
    checks = [*study.fit.checks, *frf.checks, *study.joint.checks, *study.joint_comparison.checks]
    if seal is PAPER:
        checks += study.every_check
    assert [check for check in checks if check.failed] == []
    assert study.fit.ok
    assert study.joint.ok
    printed = format_for_screen(results.render_study(study), study.verdict, checks, verbose=False)
    assert click.unstyle(printed[0]).startswith("Use: ")
    document = json.loads(to_json(study))
    assert document["verdict"] == {
        "verdict_grade": "use", "message": study.verdict.message, "failed_checks": [],
    }  # fmt: skip
    assert document["comparison"]["verdict"]["message"] == study.comparison.message
    assert from_json(to_json(study)).verdict == study.verdict


# -- what must not --------------------------------------------------------------------------------


def make_ramp_hold(force: np.ndarray, *, hold: float = 40.0, noise: float = 1e-3) -> dp.RampHold:
    random = np.random.default_rng(5)
    time = np.linspace(-1.0, 1.0 + hold, len(force))
    record = dp.RelaxationTest(
        time=time - time[0],
        displacement=8e-3 * np.clip(time, 0, 1),
        force=force + noise * random.standard_normal(len(time)),
        units="SI",
    )
    return prepare(record)


def answer(solid: dp.GeneralizedMaxwell, *, hold: float = 40.0) -> np.ndarray:
    time = np.linspace(-1.0, 1.0 + hold, round(100 * (2 + hold)) + 1)
    return solid.force(time, 8e-3 * np.clip(time, 0, 1))


def test_a_residual_of_500_noise_sd_is_not_to_be_used() -> None:
    clean = answer(PAPER)
    wave = 0.7 * np.sin(np.linspace(0, 60, len(clean))) * (np.arange(len(clean)) > 200)
    fitted_tests = fit_tests(make_ramp_hold(clean + wave), arms=2)
    assert fitted_tests.estimate.residual.rms > 0.4
    assert fitted_tests.verdict.use == "do not use"
    assert "force_residual_small" in {check.name for check in fitted_tests.verdict.failed_checks}
    assert not fitted_tests.ok


def test_a_hold_that_ends_early_tells_its_end_and_no_equilibrium_stiffness() -> None:
    """What is used is the stiffness at the end of the hold; k_inf is at most so much."""
    flowing = dp.GeneralizedMaxwell(30.0, (150.0,), (60.0,))
    fitted_tests = fit_tests(make_ramp_hold(answer(flowing, hold=4.0), hold=4.0, noise=5e-3))
    low, high = fitted_tests.intervals()["k_inf"]
    assert low == 0
    assert high > 93
    (k_inf,) = [fact for fact in fitted_tests.facts if fact.name == "k_inf"]
    assert k_inf.error is None
    assert k_inf.is_at_most
    assert fitted_tests.stiffness_limits is not None
    low, high = fitted_tests.stiffness_limits["k_end"]
    assert 0.9 * flowing.relaxation(4.0) < low < flowing.relaxation(4.0) < high
    assert high < 1.1 * flowing.relaxation(4.0)
    # of an arm of 60 s a hold of 4 s shows the loss nowhere: the stiffness alone is known
    assert {check.name for check in fitted_tests.verdict.failed_checks} == {
        "loss_factor_determined"
    }
    assert fitted_tests.band[0] > 0.03  # not at rest
    outside = {check.name for check in fitted_tests.checks if check.passed is False}
    assert {"hold_long_enough", "k_inf_positive"} <= outside


def test_no_arms_on_a_force_that_relaxes_is_not_to_be_used() -> None:
    falling = dp.GeneralizedMaxwell(90.0, (120.0,), (5.0,))
    fitted_tests = fit_tests(make_ramp_hold(answer(falling)), arms=0)
    assert fitted_tests.verdict.use == "do not use"
    assert "arms_where_force_relaxes" in {
        check.name for check in fitted_tests.verdict.failed_checks
    }
    assert not fitted_tests.ok
    assert str(fitted_tests).startswith("Do not use: ")


def test_tests_that_disagree_have_not_converged() -> None:
    bench = prepare(simulate_relaxation(PAPER, seed=3).test)
    other = predict_frf(2.6 * PAPER, mass=PAPER_MASS, frequency=np.arange(5, 40, 0.05))
    other = replace(other, averages=5, sd=0.002 * np.abs(other.value))
    joint = identify(other, tests=[bench], mass=PAPER_MASS, seals=2)
    assert joint.status is Status.TESTS_DISAGREE
    assert joint.verdict.use != "use"
    assert not joint.ok


# -- of a study -----------------------------------------------------------------------------------


def test_study_verdict_is_that_of_its_final_model() -> None:
    study = handmade.study()
    spoilt = replace(study, joint=replace_fields(study.joint, checks=(STOP,)))
    assert spoilt.verdict.use == "do not use"
    assert STOP in spoilt.verdict.failed_checks
    # what the relaxation test alone missed, the joint fit has mended
    missed = replace(study.comparison, checks=(STOP,))
    assert STOP not in replace(study, comparison=missed).verdict.failed_checks
    single = replace(study, comparison=missed, joint=None, joint_comparison=None)
    assert single.verdict.failed_checks[0] is STOP


def test_a_prediction_that_nothing_has_tested_is_used_with_care() -> None:
    bench = simulate_relaxation(PAPER, hold_time=10.0, seed=1).test
    outcome = characterise(bench, block=BlockOnSeals(PAPER_MASS, 2)).verdict
    assert outcome.use == "use with care"
    assert [check.name for check in outcome.failed_checks] == ["prediction_in_valid_band"]
    assert "Measure it with a hammer" in outcome.message


# -- in words and in exit codes -------------------------------------------------------------------


@pytest.mark.parametrize(("check", "code"), [(OPEN, 0), (NOTE, 0), (LIMIT, 1), (STOP, 1)])
def test_strict_heeds_what_limits_the_use(check: Check, code: int) -> None:
    command = verb("story", "", result_options())(
        lambda **_: CommandResult({}, Text(["text"]), (check,))
    )
    assert CliRunner().invoke(command, ["--strict"]).exit_code == code
    assert CliRunner().invoke(command, []).exit_code == 0


def test_the_first_line_of_a_fit_is_its_verdict_and_the_optimiser_stands_below() -> None:
    fit = replace_fields(handmade.study().fit, checks=(STOP, OPEN, NOTE))
    printed = format_for_screen(results.render_fit(fit), fit.verdict, fit.checks, verbose=True)
    lines = click.unstyle("\n".join(printed)).splitlines()
    assert lines[0] == "Do not use: a stop. Do that."
    assert any(line.split()[:1] == ["optimiser"] for line in lines)
    assert "1 failed, 1 note, 1 not applicable" in "\n".join(lines)
    assert lines[-2:] == ["  !! (see line 1) (--band 1:5Hz) a_stop", "  - A note. a_note"]
    document = json.loads(to_json(fit))
    assert document["ok"] is False
    assert [check["passed"] for check in document["checks"]] == [False, None, False]
    assert [check["grade"] for check in document["checks"]] == ["stop", "stop", "note"]


def test_check_details_follow_the_verdict() -> None:
    why = "It fell by 88 % in all, and " + "on and " * 30 + "on."
    check = Check("level", False, f"The end falls. {why}", remedy=Remedy("Go on.", "hold", "9s"))
    verdicts = verdict((check,))
    assert str(verdicts).startswith("Use with care: the end falls.")
    lines = click.unstyle(
        "\n".join(format_for_screen(Text(["text"]), verdicts, (check,)))
    ).splitlines()
    below = " ".join(lines[lines.index("text") + 2 :])
    assert below.startswith("  ! (see line 1) It fell by 88 %")
    assert "(--hold 9s)" in below
    assert "The end falls" not in below
    assert "Go on" not in below


# -- against records whose truth is known ---------------------------------------------------------


def test_verdict_of_a_few_valid_records_is_use() -> None:
    outcomes = [evaluate_record(trial(kind, seed=0)) for kind in KINDS[::5]]
    assert sum(outcome.use == "use" for outcome in outcomes) >= 7, failures(outcomes)
    assert not [outcome for outcome in outcomes if outcome.wrong and outcome.use == "use"]


def test_a_few_nonlinear_records_are_not() -> None:
    for law in ("cubic", "foam"):
        outcome = evaluate_record(trial(KINDS[14], seed=1, law=law))
        assert outcome.use != "use" or not outcome.wrong, outcome


@pytest.mark.slow
def test_verdict_of_valid_records_is_use() -> None:
    outcomes = [evaluate_record(trial(kind, seed=seed)) for kind in KINDS for seed in range(3)]
    print(table({"sound": outcomes}), failures(outcomes), sep="\n")
    assert np.mean([outcome.use == "use" for outcome in outcomes]) >= 0.8


@pytest.mark.slow
def test_disturbed_records_whose_result_is_wrong_are_not_to_be_used() -> None:
    """Also those that are sound but for what the record cannot show, such as a slow arm."""
    kinds = [KINDS[i] for i in (14, 16, 18, 19, 20)]
    groups = {
        name: [
            evaluate_record(trial(kind, seed=seed, bench=bench))
            for kind in kinds
            for seed in range(2)
        ]
        for name, bench in DISTURBANCES.items()
    }
    groups |= {
        law: [
            evaluate_record(trial(kind, seed=seed, law=law)) for kind in kinds for seed in range(2)
        ]
        for law in LAWS
        if law != "linear"
    }
    print(table(groups))
    wrong = [item for group in groups.values() for item in group if item.wrong]
    assert np.mean([item.use != "use" for item in wrong]) >= 0.9


@pytest.mark.parametrize("relative", [0.01, 0.5, 3.0, math.inf])
@pytest.mark.parametrize("method", ["full", "joint", "frf"])
@pytest.mark.parametrize("unit", ["N/m", "Pa"])
def test_headline_of_a_fit_is_sentences_at_any_error(relative, method, unit):
    """Where no error was known, it read "From 0.004 to 28 Hz."."""
    fit = a_fit(dp.GeneralizedMaxwell(200.0, (100.0,), (0.5,)), relative=relative)
    fit = replace_fields(fit, method=method, unit=unit, band=(0.004, 28.0))
    first, *_ = re.split(r"(?<=\.) (?=[A-Z])", fit.verdict.message)
    quantity = "modulus" if unit == "Pa" else "stiffness"
    assert re.match(rf"From 0\.004 to 28 Hz the (error of the )?{quantity} is ", first)
    assert ("±" in first) == (relative < 1)
