"""From a prepared test to a solid: the paper's numbers, laws, intervals, refusals."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.fits import formal_errors, restrict_to_noise

from dashpot.base.errors import DataError, FitError, Status
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.parameter_estimate import Profile, profile_interval
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.nonlinear_ramp.linearity import HoldBlocks
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation import simulate_relaxation
from dashpot.solids.maxwell import GeneralizedMaxwell

TRUTH = (196.5, 117.5, 17.8, 59.0 / 117.5, 292.2 / 17.8)


def ideal(
    seal: GeneralizedMaxwell,
    *,
    rate: float = 100.0,
    ramp: float = 1.0,
    hold: float = 40.0,
    baseline: float = 0.0,
    depth: float = 8e-3,
    noise: float = 0.0,
    seed: int = 0,
    machine: Machine | None = None,
) -> RampHold:
    """A perfect ramp and hold, the force with white noise of this standard deviation."""
    t = np.arange(-round(baseline * rate), round((ramp + hold) * rate) + 1) / rate
    force = seal.ramp_hold_force(t, depth=depth, ramp_time=ramp)
    force = force + noise * np.random.default_rng(seed).standard_normal(len(t))
    return RampHold(
        time=t,
        displacement=depth * np.clip(t / ramp, 0.0, 1.0),
        force=force,
        onset=0.0,
        ramp_end=ramp,
        hold_end=ramp + hold,
        depth=depth,
        force_noise=noise,
        machine=machine or Machine(),
    )


def five(model: GeneralizedMaxwell) -> tuple[float, ...]:
    return (model.k_inf, *model.k, *model.tau)


def five_errors(result: Fit) -> np.ndarray:
    """Of the noise alone."""
    error = formal_errors(restrict_to_noise(result))
    return np.array([error["k_inf"], *error["k"], *error["tau"]])


# -- the paper ------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["full", "hold"])
@pytest.mark.parametrize("arms", ["auto", 2])
def test_table_1_comes_back_exactly(
    paper_seal: GeneralizedMaxwell, method: str, arms: int | str
) -> None:
    result = fit(ideal(paper_seal), arms=arms, method=method)  # type: ignore[arg-type]
    assert five(result.model) == pytest.approx(TRUTH, rel=1e-6)
    assert result.status is Status.CONVERGED
    assert result.evidence.certificate is not None
    assert result.estimate.residual.rms < 1e-9


def test_fit_of_one_arm_to_the_hold_reproduces_the_paper(paper_seal: GeneralizedMaxwell) -> None:
    result = fit(ideal(paper_seal), arms=1, method="hold", nuisance=())
    assert result.model.k_inf == pytest.approx(200.5, abs=0.05)
    assert result.model.k[0] == pytest.approx(35.2, abs=0.05)
    assert result.model.tau[0] == pytest.approx(4.015, abs=0.0015)
    assert result.model.arm_b[0] == pytest.approx(141.5, abs=0.05)


def test_fit_of_one_arm_to_the_full_history_reproduces_the_paper(
    paper_seal: GeneralizedMaxwell,
) -> None:
    result = fit(ideal(paper_seal, rate=1000.0), arms=1, nuisance=())
    assert result.model.k_inf == pytest.approx(202.2, abs=0.05)
    assert result.model.k[0] == pytest.approx(96.2, abs=0.05)
    assert result.model.tau[0] == pytest.approx(0.986, abs=0.0005)
    assert result.estimate.nuisance == ()


def test_fit_returns_every_order_for_comparison(paper_seal: GeneralizedMaxwell) -> None:
    result = fit(ideal(paper_seal, noise=5e-3), arms=2, method="hold", nuisance=())
    assert [order.arms for order in result.evidence.orders] == [0, 1, 2]
    assert result.evidence.orders[1].model.tau[0] == pytest.approx(4.0, abs=0.3)
    assert result.evidence.orders[2].model == result.model
    assert (
        result.evidence.orders[2].sse
        < result.evidence.orders[1].sse
        < result.evidence.orders[0].sse
    )
    assert result.estimate.residual.sse == pytest.approx(result.evidence.orders[2].sse, rel=1e-9)


def test_the_full_history_knows_fast_arms_twice_as_well(paper_seal: GeneralizedMaxwell) -> None:
    test = ideal(paper_seal, noise=5e-3, seed=3)
    full = formal_errors(restrict_to_noise(fit(test, arms=2, nuisance=())))
    hold = formal_errors(restrict_to_noise(fit(test, arms=2, method="hold", nuisance=())))
    assert 100 * hold["k"][0] / 117.5 == pytest.approx(0.65, abs=0.05)
    assert 100 * full["k"][0] / 117.5 == pytest.approx(0.28, abs=0.05)
    assert 100 * hold["tau"][0] / 0.502 == pytest.approx(0.60, abs=0.05)
    assert 100 * full["tau"][0] / 0.502 == pytest.approx(0.39, abs=0.05)


def test_eq_5_does_not_overflow_for_fast_arms() -> None:
    """Printed as in the paper, exp(c/tau) of this arm is exp(2000)."""
    fast = GeneralizedMaxwell(200.0, (300.0, 50.0), (5e-4, 2.0))
    result = fit(ideal(fast, rate=10_000.0, hold=10.0), arms=1, method="hold")
    assert result.model.tau[0] == pytest.approx(2.0, rel=1e-3)


# -- order ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_two_arms_are_chosen_with_5_mn_noise(paper_seal: GeneralizedMaxwell, seed: int) -> None:
    result = fit(ideal(paper_seal, noise=5e-3, seed=seed))
    assert result.model.arms == 2


@pytest.mark.slow
@pytest.mark.parametrize("method", ["full", "hold"])
def test_two_arms_are_chosen_in_95_of_100_seeds(
    paper_seal: GeneralizedMaxwell, method: str
) -> None:
    chosen = [
        fit(ideal(paper_seal, noise=5e-3, seed=seed), method=method).model.arms  # type: ignore[arg-type]
        for seed in range(100)
    ]
    assert chosen.count(2) >= 95


@pytest.mark.parametrize("method", ["full", "hold"])
@pytest.mark.parametrize("tau", [0.05, 0.5, 3.0, 16.0])
def test_a_noise_free_arm_never_grows_a_junk_arm(tau: float, method: str) -> None:
    seal = GeneralizedMaxwell(196.5, (50.0,), (tau,))
    result = fit(ideal(seal), method=method)  # type: ignore[arg-type]
    assert result.model.arms == 1
    assert result.model.tau[0] == pytest.approx(tau, rel=1e-6)
    again = fit(ideal(seal), arms=2, method=method)  # type: ignore[arg-type]
    assert again.status is not Status.CONVERGED


@pytest.mark.parametrize("noise", [0.0, 5e-3])
@pytest.mark.parametrize("arms", ["auto", 0])
def test_a_spring_is_a_model(noise: float, arms: int | str) -> None:
    result = fit(ideal(GeneralizedMaxwell(150.0), noise=noise), arms=arms)  # type: ignore[arg-type]
    assert result.model.arms == 0
    assert result.model.k_inf == pytest.approx(150.0, rel=1e-8 if noise == 0 else 1e-3)
    assert result.estimate.parameters == ("k_inf",)
    assert result.status is Status.CONVERGED
    assert result.intervals()["k"] == ()
    low, high = result.intervals()["k_inf"]
    assert low <= 150.0 * (1 + 1e-9)
    assert high >= 150.0 * (1 - 1e-9)


def test_more_arms_than_the_data_hold_are_not_converged(paper_seal: GeneralizedMaxwell) -> None:
    result = fit(ideal(paper_seal, noise=5e-3), arms=5)
    assert result.status is not Status.CONVERGED
    assert not result.ok


# -- laws -----------------------------------------------------------------------------------------


@settings(max_examples=15, deadline=None)
@given(
    k_inf=st.floats(10.0, 500.0),
    k=st.floats(10.0, 300.0),
    tau=st.floats(0.1, 8.0),
    depth=st.floats(1e-3, 2e-2),
)
def test_a_noise_free_seal_comes_back(k_inf: float, k: float, tau: float, depth: float) -> None:
    seal = GeneralizedMaxwell(k_inf, (k,), (tau,))
    result = fit(ideal(seal, depth=depth, rate=50.0), arms=1)
    assert five(result.model) == pytest.approx(five(seal), rel=1e-5)


@settings(max_examples=8, deadline=None)
@given(st.floats(0.1, 10.0), st.floats(0.01, 100.0))
def test_units_of_force_and_time_scale_through(force: float, slow: float) -> None:
    test, scaled = convert_units(force, slow)
    item, other = fit(test, arms=2), fit(scaled, arms=2)
    np.testing.assert_allclose(other.model.k, force * np.array(item.model.k), rtol=1e-5)
    np.testing.assert_allclose(other.model.tau, slow * np.array(item.model.tau), rtol=1e-5)
    np.testing.assert_allclose(five_errors(other)[1:3], force * five_errors(item)[1:3], rtol=1e-3)


def convert_units(force: float, slow: float) -> tuple[RampHold, RampHold]:
    seal = GeneralizedMaxwell(196.5, (117.5, 17.8), TRUTH[3:])
    test = ideal(seal, noise=5e-3, rate=20.0)
    return test, replace(
        test,
        force=force * test.force,
        force_noise=force * test.force_noise,
        time=slow * test.time,
        ramp_end=slow * test.ramp_end,
        hold_end=slow * test.hold_end,
    )


def test_rig_errors_scale_with_the_units() -> None:
    """The usual cell warms in 120 s, and usual clocks are 5 ms apart, in any unit of time."""
    still = Machine(sync=0.0, drift=0.0, compliance=0.0, creep=0.0, rest=1e9)
    item, other = (
        fit(replace(unit, machine=still), arms=2) for unit in convert_units(4.4482, 60.0)
    )
    here, there = formal_errors(item), formal_errors(other)
    # laid out in some hundred samples
    np.testing.assert_allclose(there["k"], 4.4482 * np.array(here["k"]), rtol=1e-2)
    np.testing.assert_allclose(there["tau"], 60 * np.array(here["tau"]), rtol=1e-2)
    assert here["tau"][1] > 1.03 * five_errors(item)[4]


def test_fit_recovers_offset_and_drift_without_bias(paper_seal: GeneralizedMaxwell) -> None:
    test = ideal(paper_seal, baseline=2.0)
    variant = replace(test, force=test.force + 0.05 + 2e-4 * (test.time - test.time[0]))
    result = fit(variant, arms=2)
    assert five(result.model) == pytest.approx(TRUTH, rel=1e-6)
    offset, drift, delay = result.estimate.nuisance
    assert (offset.name, offset.unit) == ("offset", "N")
    assert offset.value == pytest.approx(0.05, rel=1e-6)
    assert (drift.name, drift.unit) == ("drift", "N/s")
    assert drift.value == pytest.approx(2e-4, rel=1e-6)
    assert drift.standard_error >= 0.0
    assert (delay.name, delay.unit) == ("delay", "s")
    assert delay.value == pytest.approx(0.0, abs=1e-9)


def test_uneven_sampling_changes_nothing(paper_seal: GeneralizedMaxwell) -> None:
    even = ideal(paper_seal)
    late = np.geomspace(1.0, 41.0, 300)
    t = np.unique(np.concatenate((np.linspace(-0.5, 1.0, 121), late)))
    noise_gain_differs = replace(
        even,
        time=t,
        displacement=8e-3 * np.clip(t, 0.0, 1.0),
        force=paper_seal.ramp_hold_force(t, depth=8e-3, ramp_time=1.0),
    )
    assert five(fit(noise_gain_differs, arms=2).model) == pytest.approx(TRUTH, rel=1e-6)
    assert five(fit(noise_gain_differs, arms=2, method="hold").model) == pytest.approx(
        TRUTH, rel=1e-6
    )


def test_rounded_time_stamps_are_an_even_clock(paper_seal: GeneralizedMaxwell) -> None:
    test = ideal(paper_seal, rate=300.0, noise=5e-3)
    rounded = replace(test, time=np.round(test.time, 5))
    item, other = fit(test, arms=2), fit(rounded, arms=2)
    assert five(other.model) == pytest.approx(five(item.model), rel=1e-5)
    jittered = replace(test, time=test.time + 1e-3 * np.sin(1e4 * test.time))
    assert five(fit(jittered, arms=2).model) != pytest.approx(five(item.model), rel=1e-5)


def test_any_motion_is_fitted_in_full(paper_seal: GeneralizedMaxwell) -> None:
    """Two ramps, a creeping plate and a wobble: the recorded motion is the input."""
    t = np.arange(0, 4001) / 100.0
    x = 4e-3 * np.clip(t, 0, 1) + 4e-3 * np.clip(t - 10, 0, 1) + 2e-5 * t + 1e-4 * np.sin(t)
    test = RampHold(t, x, paper_seal.force(t, x), 0.0, 1.0, 40.0, 8e-3)
    result = fit(test, arms=2)
    assert five(result.model) == pytest.approx(TRUTH, rel=1e-6)
    with pytest.raises(
        FitError, match=r"no single ramp and hold; eq\. 5 does not apply: fit ramp and hold"
    ):
        fit(test, arms=2, method="hold")


def test_fit_of_several_tests_shares_one_model(paper_seal: GeneralizedMaxwell) -> None:
    slow = ideal(paper_seal, ramp=10.0, noise=5e-3, seed=1)
    fast = ideal(paper_seal, ramp=0.1, depth=4e-3, noise=5e-3, seed=2)
    both = fit([slow, fast], arms=2)
    errors = five_errors(both)
    assert np.all(np.abs(np.subtract(five(both.model), TRUTH)) < 4 * errors)
    for item in (slow, fast):
        assert np.all(errors < five_errors(fit(item, arms=2)))
    assert [nuisance.name for nuisance in both.estimate.nuisance] == [
        "offset of test 1", "drift of test 1", "delay of test 1",
        "offset of test 2", "drift of test 2", "delay of test 2",
    ]  # fmt: skip


def test_same_input_same_output(paper_seal: GeneralizedMaxwell) -> None:
    test = ideal(paper_seal, noise=5e-3)
    assert fit(test) == fit(test)
    assert fit(test, arms=2, thorough=True) == fit(test, arms=2, thorough=True)


# -- intervals ------------------------------------------------------------------------------------


def test_intervals_are_asymmetric_in_tau_and_widen_with_level(
    paper_seal: GeneralizedMaxwell,
) -> None:
    result = fit(ideal(paper_seal, noise=5e-3), arms=2, method="hold", nuisance=())
    assert result.estimate.profiles == ()
    narrow, wide = result.intervals(0.68), result.intervals(0.99)
    for tau, (low, high), (lower, higher) in zip(
        result.model.tau, narrow["tau"], wide["tau"], strict=True
    ):
        assert lower < low < tau < high < higher
        assert high * low == pytest.approx(tau**2, rel=1e-12)
    for b, (low, high) in zip(result.model.arm_b, narrow["b"], strict=True):
        assert low < b < high
    with pytest.raises(DataError, match="level = 95"):
        result.intervals(95)


def test_arm_inside_the_ramp_has_a_smaller_error_of_b_than_of_k() -> None:
    seal = GeneralizedMaxwell(196.5, (80.0, 20.0), (0.03, 5.0))
    result = fit(ideal(seal, rate=1000.0, noise=5e-3), arms=2)
    error = formal_errors(result)
    assert error["b"][0] / result.model.arm_b[0] < 0.4 * error["k"][0] / result.model.k[0]
    assert {check.name: check for check in result.checks}["fast_arm_visible"].failed


def test_a_doubtful_arm_gets_a_profile() -> None:
    seal = GeneralizedMaxwell(196.5, (50.0,), (150.0,))
    result = fit(ideal(seal, noise=5e-3, seed=1), arms=1)
    assert {profile.parameter for profile in result.estimate.profiles} == {
        "k_inf", "k_1", "ln_tau_1", "ln_b_1",
    }  # fmt: skip
    for profile in result.estimate.profiles:
        assert np.all(np.diff(profile.value) > 0)
        assert profile.deviance.min() == 0.0
    bounds = result.intervals(0.95)
    (low, high), (k_low, k_high) = bounds["tau"][0], bounds["k"][0]
    assert low < 150.0 < high
    assert k_low < 50.0 < k_high
    assert high / result.model.tau[0] > result.model.tau[0] / low  # the slow side is the open one


def test_superfluous_arm_has_unbounded_intervals(
    paper_seal: GeneralizedMaxwell,
) -> None:
    """Three arms of a seal that has two: a third so fast or so slow shows in no sample."""
    test = prepare(simulate_relaxation(paper_seal, seed=1).test)
    intervals = fit(test, arms=3).intervals()
    spare = intervals["tau"].index((0.0, np.inf))
    assert intervals["k"][spare] == intervals["b"][spare] == (0.0, np.inf)
    assert intervals["k_inf"][0] == 0.0
    assert intervals["k_inf"][1] == pytest.approx(
        fit(test, arms=2).intervals()["k_inf"][1], rel=2e-3
    )
    indices = [j for j in range(3) if j != spare]
    for name in ("k", "tau", "b"):
        assert all(0.0 < low < high < np.inf for low, high in (intervals[name][j] for j in indices))

    def force(k_inf: float, *third: float) -> np.ndarray:
        k, tau = third
        seal = GeneralizedMaxwell(k_inf, (*paper_seal.k, k), (*paper_seal.tau, tau))
        return seal.force(test.time, test.displacement)

    plain = paper_seal.force(test.time, test.displacement)
    k_inf = paper_seal.k_inf
    # stiffer than the seal and fast; of a b beyond its own and slow; in the place of the plateau
    for other in (force(k_inf, 1e4, 1e-7), force(k_inf, 1e-4, 1e8), force(0.0, k_inf, 1e8)):
        assert np.abs(other - plain).max() < 1e-2 * test.force_noise


def test_profile_interval_continues_past_a_local_maximum() -> None:
    profile = Profile("k_1", np.arange(6.0), np.array([1.0, 6.0, 2.0, 0.0, 2.0, 6.0]))
    assert profile_interval(profile, deviance_limit=4.0)[0] == -np.inf
    assert 4.0 < profile_interval(profile, deviance_limit=4.0)[1] < 5.0
    assert profile_interval(profile, deviance_limit=0.5)[0] > 2.0


def test_profile_and_covariance_agree_where_both_hold() -> None:
    from dashpot.fitting import parameter_errors as module

    seal = GeneralizedMaxwell(196.5, (50.0,), (3.0,))
    test = ideal(seal, noise=5e-3, seed=2)
    wald = fit(test, arms=1).intervals()
    before = module.MAX_WALD_SE
    try:
        module.MAX_WALD_SE = 0.0
        profiled = fit(test, arms=1)
    finally:
        module.MAX_WALD_SE = before
    assert len(profiled.estimate.profiles) == 4
    bounds = profiled.intervals()
    np.testing.assert_allclose(bounds["tau"][0], wald["tau"][0], rtol=1e-3)
    np.testing.assert_allclose(bounds["k"][0], wald["k"][0], rtol=1e-3)
    np.testing.assert_allclose(bounds["b"][0], wald["b"][0], rtol=1e-3)
    np.testing.assert_allclose(bounds["k_inf"], wald["k_inf"], rtol=1e-3)


# -- the band -------------------------------------------------------------------------------------


def test_the_paper_test_informs_its_band(paper_seal: GeneralizedMaxwell) -> None:
    low, high = fit(ideal(paper_seal, rate=1000.0, noise=5e-3, baseline=1.0), arms=2).band
    # the paper's is .004 Hz: there an arm slower than the hold may lose more than this one
    assert 0.004 < low < 0.01
    assert high == pytest.approx(0.32, rel=0.05)


def test_noise_and_slow_sampling_narrow_the_band(paper_seal: GeneralizedMaxwell) -> None:
    machine = Machine(sync=1e-3)
    clean = fit(ideal(paper_seal, ramp=0.1, noise=2e-3, machine=machine), arms=2).band
    noisy = fit(ideal(paper_seal, ramp=0.1, noise=0.5, machine=machine), arms=1)
    assert noisy.band[1] < 0.5 * clean[1]
    assert "loss_factor_determined" in {check.name for check in noisy.checks if check.failed}
    coarse = fit(ideal(paper_seal, ramp=0.1, rate=4.0, noise=2e-3, machine=machine), arms=2).band
    assert coarse[1] < clean[1]


def test_a_longer_hold_and_a_faster_ramp_widen_the_band(paper_seal: GeneralizedMaxwell) -> None:
    usual = fit(ideal(paper_seal, noise=2e-3), arms=2).band
    assert fit(ideal(paper_seal, hold=160.0, noise=2e-3), arms=2).band[0] < 0.9 * usual[0]
    # a late force looks like an arm of less damping: fast arms show where the delay is known
    known, unknown = (
        fit(ideal(paper_seal, ramp=0.1, noise=2e-3, machine=machine), arms=2).band[1]
        for machine in (Machine(sync=1e-4), Machine())
    )
    assert known > 2 * usual[1]
    assert unknown < 0.5 * known


# -- refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"arms": -1}, r'arms = -1; expected "auto" or a whole number of arms'),
        ({"arms": 1.5}, r'arms = 1.5; expected "auto" or a whole number'),
        ({"arms": "two"}, r"arms = 'two'; expected \"auto\""),
        ({"arms": True}, r"arms = True; expected"),
        ({"max_arms": -2}, r"max_arms = -2; expected a whole number >= 0"),
        ({"method": "lsq"}, "method = 'lsq'; expected one of full, hold"),
        ({"nuisance": ("tilt",)}, r"nuisance = \('tilt',\); expected a tuple of names"),
        ({"nuisance": "drift"}, r"nuisance = 'drift'; expected a tuple"),
    ],
)
def test_options_that_make_no_sense(
    paper_seal: GeneralizedMaxwell, options: dict[str, object], sentence: str
) -> None:
    with pytest.raises(FitError, match=sentence):
        fit(ideal(paper_seal, hold=5.0), **options)  # type: ignore[arg-type]


def test_what_is_no_relaxation_test_is_refused(paper_seal: GeneralizedMaxwell) -> None:
    with pytest.raises(FitError, match="relaxation tests, prepared or as read, found a str"):
        fit(["seal.csv"])  # type: ignore[list-item]
    with pytest.raises(FitError, match="there is no test to fit"):
        fit([])


def test_too_few_samples_for_the_arms(paper_seal: GeneralizedMaxwell) -> None:
    test = ideal(paper_seal, rate=1.0, hold=9.0)
    with pytest.raises(FitError, match="samples cannot determine"):
        fit(test, arms=6)


def test_auto_tries_no_more_than_a_short_record_can_determine(
    paper_seal: GeneralizedMaxwell,
) -> None:
    for hold in (7.0, 9.0, 12.0):
        result = fit(ideal(paper_seal, rate=1.0, hold=hold))
        assert len(result.evidence.orders) <= 1 + (result.estimate.residual.n - 4) // 2
    dense = fit(ideal(paper_seal, rate=1.0, hold=12.0), arms=5)
    assert dense.status is not Status.CONVERGED


def test_eq_5_is_refused_on_a_hold_that_drifts(paper_seal: GeneralizedMaxwell) -> None:
    test = ideal(paper_seal)
    creeping = replace(test, displacement=test.displacement * (1 + 5e-4 * test.time.clip(0)))
    with pytest.raises(
        FitError, match=r"drifts by .* fit ramp and hold instead, which takes the recorded"
    ):
        fit(creeping, method="hold")
    with pytest.raises(FitError, match="test 2 of 2: the displacement drifts"):
        fit([replace(test, force=0.5 * test.force), creeping], method="hold")


def test_the_fit_path_loads_no_scipy() -> None:
    code = """
import sys
import numpy as np
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.relaxation import fit
from dashpot.solids.maxwell import GeneralizedMaxwell
t = np.arange(0, 1001) / 50.0
x = 8e-3 * np.clip(t, 0, 1)
force = GeneralizedMaxwell(196.5, (117.5,), (0.5,)).force(t, x)
force += 5e-3 * np.random.default_rng(0).standard_normal(len(t))
found = fit(RampHold(t, x, force, 0.0, 1.0, 20.0, 8e-3))
found.intervals(); found.standard_error
heavy = {"scipy", "matplotlib", "pandas", "jinja2", "h5py"} & set(sys.modules)
assert not heavy, heavy
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_record_whose_slow_arms_outlast_the_hold_is_fitted() -> None:
    """Two arms beyond the window of the hold are one place there, and no start for it."""
    record = prepare(
        simulate_relaxation(
            GeneralizedMaxwell(196.5, (117.5, 17.8), (0.5021, 16.416)), seed=3, hold_time=4.0
        ).test
    )
    holds = HoldBlocks([record])
    high = np.log(holds.blocks[0].window[1])
    hold_residual = holds.compute_hold_residual(0, np.array([high + 0.5, high + 1.0]))
    assert float(np.std(hold_residual)) == pytest.approx(
        float(np.std(holds.compute_hold_residual(0, np.zeros(0)))), rel=1e-3
    )
