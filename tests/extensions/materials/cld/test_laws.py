"""The elastic law under load deflection, from records whose law and relaxation are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.cld import (
    ARMS,
    bulb,
    compute_relaxed_force,
    dashpot_and_arms,
    fit_of,
    press_cycles,
    stiffening,
)

import dashpot as dp
from dashpot.base.errors import DataError, FitError
from dashpot.extensions.materials.cld.equilibrium_curve import fit_relaxed_law
from dashpot.extensions.materials.cld.fit_files import apply_elastic_law
from dashpot.extensions.materials.cld.multi_speed_fit import fit_speeds
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.rate_dependence import fit_rate
from dashpot.workflow.json_archive import from_json, to_json

AT = np.array([1e-3, 2e-3, 4e-3, 6e-3, 7.5e-3])


def evaluate_record(truth, **how):
    return cld(dp.CLDTest(truth.displacement, truth.force, truth.time, units="SI"), **how)


pytestmark = pytest.mark.once
EXACT = {"noise": 0.0, "count": 0.0, "bias": 0.0}


@pytest.mark.parametrize("law", [stiffening, bulb])
@pytest.mark.parametrize("speed", [0.5e-3, 5e-3])
def test_the_law_is_that_of_the_truth_at_any_speed_and_loading_is_not(law, speed):
    outcome = evaluate_record(
        press_cycles(law, speed=speed, softening=0.0, rate=2e4 * speed, **EXACT)
    )
    relaxed = fit_relaxed_law(outcome, fit_of(law))
    slope = (law(AT + 1e-6) - law(AT - 1e-6)) / 2e-6
    # first contact is known to some 10 um where a force begins to rise between two samples
    assert (np.abs(relaxed.law.force(AT) - law(AT)) <= 1e-3 * law(AT) + 1e-5 * slope).all()
    assert relaxed.law.tangent(AT) == pytest.approx(slope, rel=0.02)
    assert abs(relaxed.residual_hysteresis) < 2e-4
    assert relaxed.hysteresis > 0.05
    loading = np.interp(AT, outcome.loading.compression, outcome.loading.force)
    assert np.abs(loading / law(AT) - 1).max() > 0.06
    assert all(
        check.passed for check in relaxed.checks if check.name != "stroke_within_relaxation_times"
    )


@pytest.mark.parametrize("seed", range(4))
def test_noise_counts_and_drift_leave_the_law_near(seed):
    outcome = evaluate_record(press_cycles(seed=seed, softening=0.0, drift=2e-4, count=2e-5))
    relaxed = fit_relaxed_law(outcome, fit_of(stiffening))
    assert relaxed.law.force(AT[2:]) == pytest.approx(stiffening(AT[2:]), rel=0.015)
    z = (relaxed.law.tangent(AT) - 150 - 3 * 7.2656e5 * AT**2) / relaxed.law.stiffness
    assert np.abs(z / relaxed.law.factor_se(AT)).max() < 5


def test_relaxed_law_separates_softening_from_relaxation():
    outcome = evaluate_record(press_cycles(softening=0.12, **EXACT))
    relaxed = fit_relaxed_law(outcome, fit_of(stiffening))
    assert relaxed.softening == pytest.approx(0.12 * (1 - np.exp(-2)), abs=1e-3)
    assert outcome.softening > relaxed.softening + 0.015


def test_relaxation_test_of_another_seal_leaves_hysteresis_or_another_force():
    outcome = evaluate_record(press_cycles(softening=0.0))
    half = tuple((g / 2, tau) for g, tau in ARMS)
    wrong = fit_relaxed_law(outcome, fit_of(stiffening, arms=half))
    assert "relaxation_explains_hysteresis" in {
        check.name for check in wrong.checks if check.failed
    }
    other = fit_relaxed_law(outcome, fit_of(stiffening, scale=1.1))
    agrees = next(check for check in other.checks if check.name == "relaxed_agrees")
    assert agrees.value == pytest.approx(1 / 1.1 - 1, abs=0.01)
    # of a fit to several depths, at each
    law = fit_relaxed_law(outcome, fit_of(stiffening)).law
    depths = tuple(
        fit_relaxed_law(outcome, fit_of(stiffening, depth=h)).checks[-1].value for h in (4e-3, 6e-3)
    )
    assert depths == pytest.approx(law.force([4e-3, 6e-3]) / stiffening(np.array([4e-3, 6e-3])) - 1)


def test_the_fit_with_the_law_is_the_tangent_where_a_mass_rests():
    relaxed = fit_relaxed_law(
        evaluate_record(press_cycles(softening=0.0, **EXACT)), fit_of(stiffening)
    )
    for held in (5e-3, 8e-3):
        fit = apply_elastic_law(fit_of(stiffening, depth=held), relaxed.law, checks=relaxed.checks)
        for x in (2.6e-3, 5e-3):
            solid = fit.model_at(x)
            assert solid.k_inf == pytest.approx(150 + 3 * 7.2656e5 * x**2, rel=0.01)
            assert np.array(solid.k) / solid.k_inf == pytest.approx([g for g, _ in ARMS])
        assert fit.model_at(held, secant=True).k_inf == pytest.approx(
            float(stiffening(np.array([held]))[0]) / held, rel=2e-3
        )
        assert relaxed.checks[0] in fit.checks
        assert from_json(to_json(fit)).elastic_law == fit.elastic_law


def test_what_has_no_clock_no_rest_or_no_depth_is_refused():
    truth = press_cycles(softening=0.0)
    fit = fit_of(stiffening)
    bare = cld(dp.CLDTest(truth.displacement, truth.force, units="SI"))
    with pytest.raises(FitError, match="no clock"):
        fit_relaxed_law(bare, fit)
    outcome = evaluate_record(truth)
    loose = replace(fit, solid=dp.GeneralizedMaxwell(0.0, (1.0,), (1.0,)))
    with pytest.raises(FitError, match="no stiffness at rest"):
        fit_relaxed_law(outcome, loose)
    law = fit_relaxed_law(outcome, fit).law
    with pytest.raises(DataError, match="at least as deep"):
        apply_elastic_law(fit_of(stiffening, depth=9e-3), law)
    with pytest.raises(DataError, match="no pressed part"):
        apply_elastic_law(replace(fit, elastic_law=None), law)


def record_at_speeds(speeds, law=bulb, **how):
    """Records of one seal, their sampling and rests as long as their strokes ask."""
    return [
        evaluate_record(
            press_cycles(law, speed=v, rate=max(5e3 * v, 2.0), rest=5.0, cycles=2, seed=i, **how)
        )
        for i, v in enumerate(speeds)
    ]


def test_fit_speeds_recovers_law_and_relaxation():
    """Softening of the first cycle and the free recovery in air are not taken for relaxation."""
    fit = fit_speeds(record_at_speeds((0.2e-3, 2e-3, 20e-3), softening=0.1))
    assert fit.model.arms == 2
    for j, (g, tau) in enumerate(ARMS):
        assert fit.model.k[j] / fit.model.k_inf == pytest.approx(g, rel=0.05)
        error = fit.standard_error["tau"][j]
        assert fit.model.tau[j] == pytest.approx(tau, abs=3.5 * error)
        assert error < 0.1 * tau
    softer = 1 - 0.1 * (1 - np.exp(-1 / 1.5))
    assert fit.elastic_law.force(AT[1:]) == pytest.approx(softer * bulb(AT[1:]), rel=0.01)
    assert fit.ok
    assert from_json(to_json(fit)).solid == fit.solid


def test_fit_speeds_recovers_one_arm_and_reports_close_speeds():
    (fit, near) = (
        fit_speeds(record_at_speeds(speeds, softening=0.0, arms=((0.3, 2.0),)), arms=1)
        for speeds in ((0.5e-3, 8e-3), (2e-3, 4e-3))
    )
    assert fit.model.k[0] / fit.model.k_inf == pytest.approx(0.3, rel=0.03)
    assert fit.model.tau[0] == pytest.approx(2.0, rel=0.05)
    assert {check.name for check in fit.checks if check.failed} == set()
    assert "speeds_spread" in {check.name for check in near.checks if check.failed}


def test_scatter_of_specimens_is_not_fitted_as_relaxation():
    slow, fast = record_at_speeds((0.5e-3, 8e-3), softening=0.0, arms=((0.3, 2.0),))
    other = replace(fast, force=1.03 * fast.force)
    fit = fit_speeds([slow, other], arms=1)
    assert "speeds_residual_small" in {check.name for check in fit.checks if check.failed}


def test_fit_speeds_refuses_one_speed():
    truth = press_cycles()
    outcome = evaluate_record(truth)
    with pytest.raises(FitError, match="one speed alone"):
        fit_speeds([outcome, outcome])
    bare = cld(dp.CLDTest(truth.displacement, truth.force, units="SI"))
    with pytest.raises(FitError, match="no clock"):
        fit_speeds([outcome, bare])


def with_relative_error(fit, part=0.05):
    """A fit whose stiffnesses and times are known to a part."""
    model = fit.model
    names = ("k_inf", "k_1", "k_2", "ln_tau_1", "ln_tau_2")
    sizes = np.array([model.k_inf, *model.k, 1.0, 1.0])
    estimate = replace(
        fit.estimate, parameters=names, covariance=np.diag((part * sizes) ** 2), profiles=()
    )
    return replace(fit, estimate=estimate)


def test_relaxed_law_propagates_the_error_of_the_relaxation():
    outcome, sure = evaluate_record(press_cycles(softening=0.0), at=6e-3), fit_of(stiffening)
    fit, at = with_relative_error(sure), 6e-3
    relaxed = fit_relaxed_law(outcome, fit)
    assert len(relaxed.perturbed_laws) == 8  # six axes of the relaxation or zeros, and the clock
    in_step = replace(outcome, delay_sd=0.0)
    exact = fit_relaxed_law(in_step, with_relative_error(sure, 1e-9))
    assert len(exact.perturbed_laws) == 7
    # the zeros alone
    zeros = exact.law.tangent(at) * outcome.contact_se, outcome.zero_se
    assert exact.force_se(at) == pytest.approx(np.linalg.norm(zeros), rel=0.1)
    assert relaxed.law.factor_se(at) > exact.law.factor_se(at)
    # one arm larger by a standard error, and nothing else
    k = (1.05 * sure.model.k[0], sure.model.k[1])
    more = replace(sure, solid=dp.GeneralizedMaxwell(sure.model.k_inf, k, sure.model.tau))
    off = abs(fit_relaxed_law(outcome, more).law.force(at) - relaxed.law.force(at))
    assert 0 < off < fit_relaxed_law(in_step, fit).force_se(at) < min(5 * off, relaxed.force_se(at))


def press_between(back, speed, arms=((0.3, 2.0),)):
    """Pressed twice from air, each time back to a part of the depth."""
    step, turns = 8e-3 / speed / 400, np.array([0.0, 1.0, back, 1.0, back])
    rows = 400 * np.cumsum(np.abs(np.diff(turns, prepend=-0.25)))
    time = step * np.arange(-50, round(rows[-1]) + 1)
    x = 8e-3 * np.interp(time / step, [-50, *(rows - 100)], [-0.125, *turns])
    force = compute_relaxed_force(stiffening(np.maximum(x, 0.0)), x > 0, arms, step)
    noise = 2e-3 * np.random.default_rng(1).standard_normal(len(x))
    return cld(dp.CLDTest(x, force + noise, time - time[0], units="SI"))


@pytest.mark.parametrize("back", [0.4, 0.0])
def test_relaxed_law_of_partial_cycles_equals_that_from_contact(back):
    """Where it comes back to no less than `back` of its depth: below that its secant alone."""
    records = [press_between(back, speed) for speed in (0.5e-3, 8e-3)]
    relaxation = fit_of(stiffening, arms=((0.3, 2.0),))
    x = np.linspace(max(back, 0.1) * 8e-3, 8e-3, 9)
    slope = (stiffening(x + 1e-6) - stiffening(x - 1e-6)) / 2e-6
    speeds = fit_speeds(records, arms=1)
    assert speeds.model.tau[0] == pytest.approx(2.0, rel=0.05)
    dashpot = fit_rate(records, speeds)
    assert np.isfinite(dashpot.damping_se).all()
    for law in (fit_relaxed_law(records[0], relaxation).law, speeds.elastic_law):
        assert law.force(x) == pytest.approx(stiffening(x), rel=0.01)
        assert law.tangent(x) == pytest.approx(slope, rel=0.05)


@pytest.mark.parametrize("speed", [1.1e-3, 2e-3])
def test_compression_counts_from_contact_behind_few_samples_of_air(speed):
    """.3 mm of air in 7 to 14 samples, from the first one on: 12 % of the force at 3.6 mm."""
    period = 2 * 6.3e-3 / speed
    time = np.arange(0.0, 4 * period, 0.02)
    plate = 6.3e-3 * (1 - np.abs(1 - 2 * time / period % 2))
    force = 500.0 * np.maximum(plate - 0.3e-3, 0.0)
    noise = 2e-3 * np.random.default_rng(3).standard_normal(len(time))
    outcome = evaluate_record(dp.CLDTest(plate, force + noise, time, units="SI"), at=3.6e-3)
    assert outcome.nominal.loading == pytest.approx(500.0 * 3.6e-3, rel=0.01)


def test_several_relaxation_tests_are_held_against_the_law_and_each_other():
    outcome = evaluate_record(press_cycles(softening=0.0), at=4e-3)
    shallow, deep = fit_of(stiffening, depth=4e-3), fit_of(stiffening, depth=8e-3)
    both = fit_relaxed_law(outcome, [deep, shallow])
    agreed = [check for check in both.checks if check.name == "relaxed_agrees"]
    assert [check.passed for check in agreed] == [True, True]
    assert both.relaxation == fit_relaxed_law(outcome, shallow).relaxation
    assert "relaxation_tests_agree" not in {check.name for check in both.checks if check.failed}
    slower = fit_of(stiffening, arms=((0.35, 1.5), (0.15, 16.0)))
    separate = fit_relaxed_law(outcome, [shallow, slower])
    assert "relaxation_tests_agree" in {check.name for check in separate.checks if check.failed}
    with pytest.raises(FitError, match="no fit"):
        fit_relaxed_law(outcome, [])


def test_a_dashpot_that_depends_on_compression_comes_back_from_four_speeds():
    arms = ((40.0, 0.1), (25.0, 1.5))
    tests = [
        evaluate_record(dashpot_and_arms(v, c=lambda x: 2 + 400 * x, arms=arms, seed=i))
        for i, v in enumerate((1e-4, 1e-3, 1e-2, 1e-1))
    ]
    fit = fit_speeds(tests, arms=1)
    rate = fit_rate(tests, fit)
    assert rate.law.force(AT) == pytest.approx(stiffening(AT), rel=0.02)
    assert rate.law.tangent(AT) == pytest.approx(150 + 3 * 7.2656e5 * AT**2, rel=0.02)
    for x in AT.tolist():
        c, error = rate.c(x)
        assert c == pytest.approx(2 + 400 * x, rel=0.02)
        assert abs(c - 2 - 400 * x) < 4 * error
    assert rate.k == pytest.approx([40.0, 25.0], rel=0.02)
    assert rate.tau == pytest.approx([0.1, 1.5], rel=0.02)
    assert rate.bic < -10
    assert rate.model_at(4e-3).b == rate.c(4e-3)[0]
    assert {check.name for check in rate.checks if check.failed} == {
        "single_relaxation_explains_speeds"
    }


def test_fit_rate_distinguishes_relaxation_from_a_dashpot():
    tests = record_at_speeds((0.2e-3, 2e-3, 20e-3), softening=0.0)
    rate = fit_rate(tests, fit_speeds(tests))
    assert rate.bic > 10
    assert "single_relaxation_explains_speeds" not in {
        check.name for check in rate.checks if check.failed
    }
