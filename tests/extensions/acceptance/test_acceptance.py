"""Limits held against fits and reports: intervals, words, pages, documents and exit codes."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.cli import main
from dashpot.extensions.acceptance.datamodel import Acceptance
from dashpot.extensions.acceptance.result_values import find_value
from dashpot.workflow.recommended_solid import recommend_solid

K_INF, K, TAU, DEPTH, RAMP = 200.0, 60.0, 2.0, 4e-3, 0.1
"""Of the simulated seal with one arm: N/m, s, m."""
SEEDS = 200


def _record(seed: int, noise: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, displacement and force of a ramp and hold, by the closed form of one arm."""
    t = np.arange(-0.5, 10.0, 0.01)
    x = DEPTH * np.clip(t / RAMP, 0.0, 1.0)

    def arm(s: np.ndarray) -> np.ndarray:
        return K * TAU * DEPTH / RAMP * -np.expm1(-np.clip(s, 0.0, None) / TAU)

    force = K_INF * x + np.where(t < RAMP, arm(t), arm(t) - arm(t - RAMP))
    return t - t[0], x, force + noise * np.random.default_rng(seed).standard_normal(t.size)


def _fit(seed: int = 0, noise: float = 2e-2) -> dp.Fit:
    """Return the fit of such a record on a machine without faults."""
    machine = dp.Machine(sync=1e-6, drift=1e-9, compliance=0.0, creep=1e-12, rest=1e7)
    return dp.fit(*_record(seed, noise), units="s, m, N", arms=1, machine=machine)


@pytest.fixture(scope="module")
def fit() -> dp.Fit:
    return _fit()


@pytest.fixture(scope="module")
def study() -> dp.Study:
    test, hits = dp.simulate("relaxation", seed=3), dp.simulate("impact", seed=4)
    return dp.report(test, hits, mass="104g", seals=2)


def _judge(result: object, *limits: str) -> Acceptance:
    return dp.files.read_limits(*limits).judge(result)


def test_stiffness_at_a_time_has_the_error_of_the_closed_form(fit: dp.Fit) -> None:
    """To first order: g' C g with g = (1, exp(-t/tau), k t/tau exp(-t/tau)), by hand."""
    small = 1e-4 * fit.covariance
    estimate = replace(fit.estimate, covariance=small, noise_covariance=0.36 * small, profiles=())
    # without limits at the end of the hold the covariance is all that is known
    evidence = replace(fit.evidence, end_of_hold=None)
    bare = replace(fit, estimate=estimate, evidence=evidence)
    assert fit.estimate.parameters == ("k_inf", "k_1", "ln_tau_1")
    (k,), (tau,), t = fit.model.k, fit.model.tau, 4.0
    gradient = np.array([1.0, math.exp(-t / tau), k * t / tau * math.exp(-t / tau)])
    error = math.sqrt(gradient @ small @ gradient)
    value = find_value(bare, "stiffness at 4s")
    assert value.fact.value == pytest.approx(fit.model.k_inf + k * math.exp(-t / tau), rel=1e-12)
    assert value.fact.high - value.fact.value == pytest.approx(1.96 * error, rel=1e-3)
    assert value.spread == "random"
    assert value.noise_share == pytest.approx(0.6, rel=1e-3)


def test_the_end_of_the_hold_has_the_interval_of_the_fit(fit: dp.Fit) -> None:
    end = fit.evidence.end_of_hold
    assert end is not None
    value = find_value(fit, "k_end")
    assert (value.fact.low, value.fact.high) == pytest.approx(end.k_end, rel=1e-9)


def test_a_bound_is_open_to_no_number_of_tests(fit: dp.Fit) -> None:
    """k_inf is at most so much, however often the seal is tested."""
    (limit,) = _judge(fit, "k_inf >= 0.15N/mm").limits
    assert (limit.outcome, limit.spread, limit.additional_tests) == ("open", "bound", None)
    assert limit.explanation.startswith("Repeating the test does not decide it: its interval")
    (below,) = _judge(fit, "k_inf <= 0.5N/mm").limits
    assert below.outcome == "met"


def test_a_limit_is_open_outside_the_valid_band(fit: dp.Fit) -> None:
    (limit,) = _judge(fit, "loss factor at 500Hz <= 500%").limits
    assert limit.outcome == "open"
    assert "valid band" in limit.explanation


def test_a_stiffness_before_the_ramp_shows_it_has_no_upper_limit(fit: dp.Fit) -> None:
    fastest = 1 / (2 * math.pi * fit.band[1])
    early = find_value(fit, f"stiffness at {fastest / 100!r}s")
    assert math.isnan(early.fact.high)
    assert early.fact.low <= float(fit.solid.relaxation(fastest))
    value = early.fact.value / 1e3
    (most,) = _judge(fit, f"stiffness at {fastest / 100!r}s <= {2 * value}N/mm").limits
    assert most.outcome == "open"
    assert "shorter than the test shows" in most.remedy
    (least,) = _judge(fit, f"stiffness at {fastest / 100!r}s >= {value / 2}N/mm").limits
    assert least.outcome == "met"


def test_a_share_above_one_needs_its_sign(fit: dp.Fit) -> None:
    with pytest.raises(DataError, match="8 would be 800 %; write 8% if that is meant"):
        _judge(fit, "loss factor at 0.1Hz <= 8")
    assert _judge(fit, "loss factor at 0.1Hz <= 800%").limits[0].upper == 8


def test_an_empty_limit_and_a_result_without_values_are_refused() -> None:
    with pytest.raises(DataError, match="a limit is empty"):
        dp.files.read_limits("")
    with pytest.raises(DataError, match="this kind of result takes no limits"):
        find_value(object(), "x")


def test_further_tests_follow_from_the_interval(fit: dp.Fit) -> None:
    """A limit at half the distance of the upper end: four tests in all, of noise alone."""
    estimate = replace(fit.estimate, noise_covariance=None)
    noisy = replace(fit, estimate=estimate)
    fact = find_value(noisy, "k_1").fact
    middle = fact.value + 0.5001 * (fact.high - fact.value)
    (limit,) = _judge(noisy, f"k_1 <= {middle!r}N/m").limits
    assert limit.additional_tests == 3


def test_force_is_that_of_the_record(fit: dp.Fit) -> None:
    t, x, force = _record(0, 0.0)
    study = dp.report(dp.RelaxationTest(t, x, _record(0, 2e-3)[2], units="SI"), arms=1)
    at = 0.5 + RAMP + 4.0
    value = find_value(study, "force at 4s").fact
    assert value.value == pytest.approx(float(np.interp(at, t, force)), rel=2e-3)
    assert value.low < float(np.interp(at, t, force)) < value.high


def test_a_report_judges_what_its_first_screen_shows(study: dp.Study) -> None:
    shown = {answer.quantity: answer for answer in recommend_solid(study).mass_values}
    for name, quantity in (("frequency", "frequency"), ("damping", "damping"), ("peak", "peak")):
        fact = find_value(study, name).fact
        answer = shown[quantity]
        assert (fact.value, fact.low, fact.high) == (answer.value, answer.low, answer.high)


def test_the_seal_misses_where_one_limit_is_missed(study: dp.Study) -> None:
    result = _judge(study, "frequency >= 1Hz", "damping >= 50%")
    assert result.word == "misses"
    assert result.use == study.verdict.use
    assert result.headline == "misses 1 of 2 limits"
    assert [limit.outcome for limit in result.limits] == ["met", "missed"]
    assert _judge(study, "frequency >= 1Hz").word == "meets"


def test_what_is_not_to_be_used_decides_nothing(fit: dp.Fit) -> None:
    check = dp.Check("spoilt", False, "It is spoilt.", grade="stop")
    spoilt = replace(fit, evidence=replace(fit.evidence, checks=(*fit.checks, check)))
    assert spoilt.verdict.use == "do not use"
    result = _judge(spoilt, "k_end >= 0.0001N/mm")
    assert result.word == "open"
    assert "not to be used" in result.limits[0].explanation


def test_unknown_values_are_refused_with_those_that_there_are(fit: dp.Fit) -> None:
    with pytest.raises(DataError, match="there are k_end, stiffness at TIME"):
        _judge(fit, "strength >= 3N")
    with pytest.raises(DataError, match="twice"):
        _judge(fit, "k_end >= 1N/m", "k_end >= 1N/mm")


def test_two_expressions_of_one_quantity_are_its_two_limits(fit: dp.Fit) -> None:
    (limit,) = _judge(fit, "k_end <= 1N/mm", "k_end >= 1N/m").limits
    assert (limit.lower, limit.upper) == (1.0, 1000.0)
    assert limit.limit_text == "1 N/m to 1 N/mm"  # each as it was stated


@pytest.mark.slow
def test_limits_at_the_truth_are_decided_wrongly_in_few_records():
    """A limit just beyond the truth may be called met, one just within it missed, in 5 %."""
    truths = {"stiffness at 4s": K_INF + K * math.exp(-4 / TAU), "k_1": K}
    wrong = dict.fromkeys(truths, 0)
    for seed in range(SEEDS):
        fit = _fit(seed)
        for name, truth in truths.items():
            (above,) = _judge(fit, f"{name} >= {truth * (1 + 1e-9)!r}N/m").limits
            (below,) = _judge(fit, f"{name} <= {truth * (1 - 1e-9)!r}N/m").limits
            wrong[name] += (above.outcome == "met") + (below.outcome == "met")
    assert max(wrong.values()) <= 0.08 * SEEDS, wrong


def test_fit_prints_writes_and_ends_by_its_limits(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    t, x, force = _record(1, 2e-3)
    rows = "\n".join(f"{a:.4f},{1e3 * b:.6f},{c:.6f}" for a, b, c in zip(t, x, force, strict=True))
    path.write_text(f"time [s],displacement [mm],force [N]\n{rows}\n")
    limits = tmp_path / "limits.toml"
    limits.write_text('[k_end]\nlower = "0.05N/mm"\ncpk = 1.33\n')
    page = tmp_path / "fit.html"
    words = ["fit", str(path), "--limits", str(limits), "--strict"]
    run = CliRunner().invoke(main, [*words, "-o", str(page)])
    assert run.exit_code == 0, run.output
    assert "Seal: meets the limit" in run.stdout.splitlines()[1:4]
    html = page.read_text("utf-8")
    assert 'id="limits"' in html
    assert html.index('id="verdict"') < html.index('id="limits"') < html.index('id="numbers"')

    run = CliRunner().invoke(main, [*words, "--limit", "k_1 <= 1N/m", "--json"])
    assert run.exit_code == 1
    document = json.loads(run.stdout)
    assert document["schema"].startswith("dashpot/fit@")
    acceptance = document["acceptance"]
    assert acceptance["schema"] == "dashpot/acceptance@1"
    assert (acceptance["model"], acceptance["seal"]) == ("use", "misses")
    assert [limit["outcome"] for limit in acceptance["limits"]] == ["met", "missed"]
    assert acceptance["limits"][0]["lower"] == pytest.approx(50.0)

    run = CliRunner().invoke(main, ["fit", str(path), "--limit", "k_1 => 1N/m"])
    assert run.exit_code == 2
    assert "expected a quantity" in run.stderr


def test_a_limit_file_is_recognised_with_the_option_that_takes_it(tmp_path: Path) -> None:
    limits, other = tmp_path / "limits.toml", tmp_path / "other.toml"
    limits.write_text('[damping]\nlower = "3%"\n[k_end]\nupper = "0.2N/mm"\ncpk = 1.33\n')
    other.write_text('[damping]\nlowest = "3%"\n')
    shown = CliRunner().invoke(main, ["inspect", str(limits)]).output
    assert "limits.toml: limits (its tables state limits: damping, k_end)" in shown
    assert "--limits" in shown
    refused = CliRunner().invoke(main, ["fit", str(limits)])
    assert refused.exit_code == 2
    assert (
        "is a file of acceptance limits: use dashpot fit --limits or dashpot report"
        in refused.stderr
    )
    assert dp.inspect(other).kind == "unclear"
