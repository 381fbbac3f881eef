"""Fits of records whose truth is known: the virtual rig, and noise that is not white."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from kit.fits import formal_errors, restrict_to_noise
from scipy.signal import lfilter

from dashpot.base.errors import Status
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.fitting.nuisance_priors import build_load_cell_priors
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell

pytestmark = pytest.mark.once

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def benchmark(name: str) -> ModuleType:
    """A benchmark script as a module; its name may be that of an installed package."""
    sys.path.insert(0, str(BENCHMARKS))
    try:
        spec = spec_from_file_location(f"benchmark_{name}", BENCHMARKS / f"{name}.py")
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(BENCHMARKS))
    return module


coverage, order = benchmark("coverage"), benchmark("order")

TRUTH = np.array((196.5, 117.5, 17.8, 59.0 / 117.5, 292.2 / 17.8))


def estimates(result: Fit) -> tuple[np.ndarray, np.ndarray]:
    model, error = result.model, formal_errors(result)
    return (
        np.array((model.k_inf, *model.k, *model.tau)),
        np.array((error["k_inf"], *error["k"], *error["tau"])),
    )


def check_table_1(result: Fit) -> None:
    assert result.model.arms == 2
    assert result.status is Status.CONVERGED
    value, error = estimates(result)
    assert np.all(np.abs(value - TRUTH) < 3.5 * error)
    assert np.all(np.abs(value / TRUTH - 1) < (0.01, 0.01, 0.04, 0.01, 0.04))


@pytest.mark.parametrize("seed", range(3))
def test_the_rig_gives_table_1_back(paper_seal: GeneralizedMaxwell, seed: int) -> None:
    check_table_1(fit(prepare(simulate_relaxation(paper_seal, seed=seed).test)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3, 20))
def test_the_rig_gives_table_1_back_over_20_seeds(
    paper_seal: GeneralizedMaxwell, seed: int
) -> None:
    check_table_1(fit(prepare(simulate_relaxation(paper_seal, seed=seed).test)))


@pytest.mark.parametrize("encoder", [2e-5, 1e-4])
def test_intervals_cover_encoder_errors(paper_seal: GeneralizedMaxwell, encoder: float) -> None:
    """A quiet load cell: what is wrong comes from the steps of the encoder."""
    rig = Rig(noise=3e-4, hum=0.0, vibration=0.0, encoder=encoder)
    sim = simulate_relaxation(paper_seal, depth=7.987e-3, rig=rig, seed=1)
    value, error = estimates(fit(prepare(sim.test), arms=2))
    assert np.all(np.abs(value - TRUTH) < 3.5 * error)
    assert error[0] / value[0] > 0.35 * encoder / np.sqrt(6) / 8e-3


@pytest.mark.parametrize("name", ["white", "10hz", "ar20ms", "ar500ms"])
def test_intervals_cover_the_truth_under_correlated_noise(name: str) -> None:
    """25 seeds at 200 Hz; the benchmark has 1000 at 1 kHz."""
    hits = [coverage.covered(coverage.NOISES[name], seed, rate=200.0) for seed in range(25)]
    assert np.mean(hits) > 0.88


@pytest.mark.parametrize("seed", [100, 122])
def test_a_profile_counts_the_noise_that_it_meets_on_its_way(seed: int) -> None:
    """Slow noise took these plateaus for higher: the way down leads to slower arms, where it is
    louder than at the optimum.
    """
    test = coverage.record(coverage.SEAL, coverage.NOISES["ar500ms"], seed, rate=200.0)
    result = fit(test, arms=2)
    low, high = result.estimate.noise_only.intervals(result.model, 0.95)["k_inf"]
    assert low < coverage.SEAL.k_inf < high
    # the standard error at the optimum knows nothing of that
    error = np.sqrt(restrict_to_noise(result).covariance[0, 0])
    assert result.model.k_inf - 2.0 * error > coverage.SEAL.k_inf


def test_naive_intervals_would_not_cover() -> None:
    """The same residuals taken for white noise: the error that the sandwich repairs."""
    noise = coverage.NOISES["10hz"]
    hits = []
    for seed in range(15):
        record = coverage.record(coverage.SEAL, noise, seed, rate=200.0)
        result = fit(record, arms=2, method="hold", nuisance=coverage.KNOWN_CLOCKS)
        value, error = estimates(restrict_to_noise(result))
        hits.append(
            np.abs(value - TRUTH)
            < 1.96 * error / np.sqrt(result.estimate.residual.variance_inflation)
        )
    assert np.mean(hits) < 0.75


@pytest.mark.slow
@pytest.mark.parametrize("name", list(coverage.NOISES))
def test_coverage_is_nominal_for_every_noise(name: str) -> None:
    hits = [coverage.covered(coverage.NOISES[name], seed) for seed in range(1000)]
    share = np.mean(hits, axis=0)
    assert np.all(share > 0.93)
    assert np.all(share < 0.975)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["white", "ar20ms"])
def test_of_a_cell_that_is_not_named_any_drift_is_covered(name: str) -> None:
    """As often as they say, where it drifts as it may; one that stands still would be held more."""
    hits = []
    for seed in range(200):
        test = coverage.record(coverage.SEAL, coverage.NOISES[name], seed, rate=200.0)
        drift = (
            build_load_cell_priors(test).limit_drift.sd
            * np.random.default_rng((seed, 7)).standard_normal()
        )
        drifted = replace(test, force=test.force + drift * test.time)
        result = fit(drifted, arms=2, method="hold", nuisance=coverage.KNOWN_CLOCKS)
        bounds = result.estimate.noise_only.intervals(result.model, 0.95)
        ends = np.array((bounds["k_inf"], *bounds["k"], *bounds["tau"]))
        hits.append((ends[:, 0] <= TRUTH) & (ends[:, 1] >= TRUTH))
    share = np.mean(hits, axis=0)
    assert np.all(share > 0.9)
    assert np.all(share < 0.985)


@pytest.mark.parametrize("arms", [1, 2, 3])
@pytest.mark.parametrize("name", list(coverage.NOISES))
def test_the_right_number_of_arms(name: str, arms: int) -> None:
    result = [order.chosen(arms, coverage.NOISES[name], seed) for seed in range(3)]
    assert result == [arms] * 3


@pytest.mark.parametrize("seed", [17, 28, 66])
def test_arms_as_fast_as_the_noise_are_counted_in_its_metric(seed: int) -> None:
    """Seeds of which plain least squares supports two arms, by one rule or the other."""
    test = coverage.record(order.SEALS[3], coverage.NOISES["ar500ms"], seed, rate=order.RATE)
    result = fit(test, method="hold")
    assert result.model.arms == 3
    check = {check.name: check for check in result.checks}
    assert check["order_agreed"].passed
    assert "in its own metric" in check["order_agreed"].message
    assert [score.significant for score in result.evidence.orders[1:4]] == [True] * 3
    # that an arm is needed is not that it is known
    located = bool(
        np.all(np.array(result.standard_error["tau"]) < 0.5 * np.array(result.model.tau))
    )
    assert check["arms_supported"].passed is located
    assert located or "the record rejects fewer arms" in check["arms_supported"].message


@pytest.mark.parametrize("name", ["white", "10hz"])
def test_even_noise_needs_no_metric(name: str) -> None:
    result = fit(
        coverage.record(order.SEALS[2], coverage.NOISES[name], 0, rate=200.0), method="hold"
    )
    message = next(check.message for check in result.checks if check.name == "order_agreed")
    assert "metric" not in message


@pytest.mark.parametrize("arms", [1, 2])
@pytest.mark.parametrize("rate", [20.0, 1000.0])
def test_no_arm_too_many_under_slow_noise_at_any_rate(rate: float, arms: int) -> None:
    noise = coverage.NOISES["ar500ms"]
    tests = [coverage.record(order.SEALS[arms], noise, seed, rate=rate) for seed in range(4)]
    assert [fit(test, method="hold").model.arms for test in tests] == [arms] * 4


def test_fit_weights_each_test_by_its_noise() -> None:
    names = ("ar500ms", "white", "2hz")
    tests = [
        coverage.record(order.SEALS[3], coverage.NOISES[name], seed, rate=100.0)
        for seed, name in enumerate(names)
    ]
    assert fit(tests, method="hold").model.arms == 3


@pytest.mark.slow
@pytest.mark.parametrize("arms", [1, 2, 3])
@pytest.mark.parametrize("name", list(coverage.NOISES))
def test_the_right_number_of_arms_in_97_of_100(name: str, arms: int) -> None:
    result = [order.chosen(arms, coverage.NOISES[name], seed) for seed in range(100)]
    assert result.count(arms) >= 97


def test_hidden_fast_arm_lies_outside_the_valid_band(paper_seal: GeneralizedMaxwell) -> None:
    """Reference 0.5: an arm of 12.5 ms leaves next to no trace in a hold after a 1 s ramp."""
    hidden = paper_seal + GeneralizedMaxwell(0.0, (50.0,), (0.0125,))
    result = fit(prepare(simulate_relaxation(hidden, seed=2).test), arms=2, method="hold")
    assert result.band[1] < 0.4
    assert result.model.loss_factor(omega=2 * np.pi * 12.71) < 0.02
    assert hidden.loss_factor(omega=2 * np.pi * 12.71) > 0.07


def test_41_000_rows_cost_tens_of_milliseconds(paper_seal: GeneralizedMaxwell) -> None:
    test = prepare(simulate_relaxation(paper_seal, seed=1).test)
    fit(test, arms=2)
    costs = []
    for _ in range(3):
        start = time.process_time()
        fit(test, arms=2)
        costs.append(time.process_time() - start)
    assert min(costs) < 0.35  # a generous ceiling for a loaded machine; about 0.09 measured


@pytest.mark.parametrize("seed", range(4))
def test_contact_error_widens_the_intervals(seed: int) -> None:
    """A micrometre of contact error moves k_1 by 0.05 %, many times its error without it."""
    made = simulate_relaxation(PAPER, rig=Rig(gap=0.5e-3), seed=seed)
    prepared = prepare(made.test)
    assert prepared.contact_error > 0
    result = restrict_to_noise(fit(prepared, arms=2))
    sure = restrict_to_noise(fit(replace(prepared, contact_error=0.0), arms=2))
    error = formal_errors(result)
    assert error["k"][0] > 1.25 * sure.standard_error["k"][0]
    assert abs(result.model.k[0] - PAPER.k[0]) < 3.5 * error["k"][0]
    assert abs(result.model.k_inf - PAPER.k_inf) < 3.5 * error["k_inf"]


def test_in_parallel_doubles_stiffness_and_error() -> None:
    item = fit(prepare(simulate_relaxation(PAPER, seed=0).test), arms=2)
    two = item.in_parallel(2)
    assert two.model == 2 * item.model
    assert two.standard_error["k"] == pytest.approx([2 * se for se in item.standard_error["k"]])
    assert two.standard_error["tau"] == pytest.approx(item.standard_error["tau"])
    assert two.steps[-1].message == f"2 in parallel of fit {item._identity}"


def test_what_was_taken_out_of_the_motion_is_a_step() -> None:
    prepared = prepare(simulate_relaxation(PAPER, hold_time=10.0, seed=0).test)
    (step,) = [step for step in fit(prepared, arms=1).steps if step.name == "motion"]
    assert "counts of 20 um" in step.message
    assert not [s for s in fit(prepared, arms=1, method="hold").steps if s.name == "motion"]


def test_fit_tries_more_arms_than_auto_on_request() -> None:
    # a delay that may be 5 ms does for a fast arm
    prepared = prepare(simulate_relaxation(PAPER, seed=4).test, machine=Machine(sync=1e-3))
    auto, requested = fit(prepared), fit(prepared, arms=5)
    tried = [order.arms for order in auto.evidence.orders]
    assert tried == [0, 1, 2, 3]
    assert requested.model.arms > max(tried)
    assert requested.evidence.orders[-1].sse < auto.evidence.orders[-1].sse


@pytest.mark.parametrize(("memory", "most"), [(1.0, 1.7), (3.0, 2.0)])
def test_intervals_bear_a_wander_that_the_scatter_hides(memory: float, most: float) -> None:
    """A tenth of the scatter wanders over seconds: three to five times the error of slow arms."""
    n, rate, seal = 20_500, 500, GeneralizedMaxwell(196.5, (117.5, 17.8), (0.5021, 16.416))
    time = np.arange(n) / rate
    x = 8e-3 * np.clip(time - 1, 0, 1)
    clean, decay = seal.force(time, x), np.exp(-1 / rate / memory)
    away = []
    for seed in range(24):
        rng = np.random.default_rng(seed)
        steps = rng.standard_normal(n + 10_000) * np.sqrt(1 - decay**2)
        wander = lfilter([0.1], [1.0, -decay], steps)[-n:]
        force = clean + 3e-3 * (rng.standard_normal(n) + wander)
        result = fit(
            prepare(RelaxationTest(time=time, displacement=x, force=force, units="SI")),
            arms=2,
            method="hold",
        )
        error, model = formal_errors(result), result.model
        away.append(
            [
                (model.k_inf - seal.k_inf) / error["k_inf"],
                (model.k[1] - seal.k[1]) / error["k"][1],
                (model.tau[1] - seal.tau[1]) / error["tau"][1],
            ]
        )
    assert np.sqrt(np.mean(np.square(away), axis=0)).max() < most
