"""Each way in which a fit can deceive: the record that does it, and the sentence it gets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.fits import restrict_to_noise

from dashpot.base.checks import Check
from dashpot.base.errors import Status
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.checks import solid
from dashpot.fitting.relaxation import fit
from dashpot.numerics.inference.model_order import OrderChoice
from dashpot.preprocessing import checks as record_checks
from dashpot.solids.maxwell import GeneralizedMaxwell

NOISE = 5e-3


def record_of(
    seal: GeneralizedMaxwell,
    *,
    rate: float = 100.0,
    ramp: float = 1.0,
    hold: float = 40.0,
    noise: float = NOISE,
    seed: int = 0,
) -> RampHold:
    t = np.arange(-100, round((ramp + hold) * rate) + 1) / rate
    force = seal.ramp_hold_force(t, depth=8e-3, ramp_time=ramp)
    force = force + noise * np.random.default_rng(seed).standard_normal(len(t))
    return RampHold(
        t, 8e-3 * np.clip(t / ramp, 0, 1), force, 0.0, ramp, ramp + hold, 8e-3, force_noise=noise
    )


@pytest.fixture
def test(paper_seal: GeneralizedMaxwell) -> RampHold:
    return record_of(paper_seal)


def get_check(result: Fit, name: str) -> Check:
    return next(check for check in result.checks if check.name == name)


def test_fit_passes_all_checks_for_a_valid_test(test: RampHold) -> None:
    result = fit(test)
    # a machine of which nothing is known leaves the end of the hold open by some per cent
    assert [check.name for check in result.checks if check.failed] == ["hold_long_enough"]
    assert result.verdict.use == "use"
    assert len({check.name for check in result.checks}) == len(result.checks)
    assert all(check.message for check in result.checks)
    longer = record_of(GeneralizedMaxwell(196.5, (117.5, 17.8), (0.5, 10.0)))
    assert fit(longer).ok


def test_a_clipped_force(test: RampHold) -> None:
    result = fit(replace(test, force=np.minimum(test.force, 1.9)), arms=2)
    check = get_check(result, "force_not_clipped")
    assert check.failed
    assert "is clipped at 1.9 N" in check.message
    assert "Use a larger range of the sensor" in check.message_with_remedy
    assert not result.ok
    assert record_checks.force_not_clipped(test).passed
    spring = record_of(GeneralizedMaxwell(200.0), noise=0.0)
    assert record_checks.force_not_clipped(
        spring
    ).passed  # it stands at its peak, and so does the plate


def test_a_force_below_the_resolution(test: RampHold) -> None:
    coarse = replace(test, force=np.round(test.force / 0.2) * 0.2)
    check = get_check(fit(coarse, arms=1), "force_resolved")
    assert check.failed
    assert check.value is not None
    assert check.value < 20
    assert "cannot show a decay. Press deeper" in check.message_with_remedy
    fine = record_checks.force_resolved(np.round(test.force * 1280) / 1280)
    assert fine.passed
    assert fine.value == pytest.approx(np.ptp(test.force) * 1280, rel=0.01)


def test_a_coarse_encoder_widens_the_intervals(paper_seal: GeneralizedMaxwell) -> None:
    test = record_of(paper_seal, rate=500.0)
    coarse = replace(test, displacement=np.round(test.displacement / 2e-4) * 2e-4)
    check = get_check(fit(coarse, arms=2), "depth_resolved")
    assert check.failed
    assert "Use a finer encoder" in check.message_with_remedy
    sharp, blunt = (
        np.sqrt(restrict_to_noise(fit(item, arms=2)).covariance[0, 0]) for item in (test, coarse)
    )
    assert blunt > 2 * sharp
    assert blunt == pytest.approx(
        1.36,
        rel=0.3,  # the scatter of 40 records of any phase and depth
    )
    by_hold = fit(coarse, arms=2, method="hold").standard_error
    assert by_hold["k"][0] >= 117.5 * 2e-4 / np.sqrt(6) / 8e-3 * 0.99


def test_a_plate_that_creeps(test: RampHold) -> None:
    creeping = replace(test, displacement=test.displacement * (1 + 1e-3 * test.time.clip(0)))
    check = get_check(fit(creeping, arms=2), "hold_is_still")
    assert check.passed  # the recorded motion is fitted
    assert "The fit uses the recorded motion" in check.message
    assert record_checks.hold_is_still(creeping, method="hold").failed


def test_a_hold_too_short_for_the_ramp(paper_seal: GeneralizedMaxwell) -> None:
    check = get_check(fit(record_of(paper_seal, hold=6.0), arms=1), "hold_outlasts_ramp")
    assert check.failed
    assert "Hold longer, or ramp faster." in check.message_with_remedy


def test_a_hold_too_short_for_the_slowest_arm(paper_seal: GeneralizedMaxwell) -> None:
    """Judged by how the force may still fall, not by the arms that the fit has."""
    check = get_check(fit(record_of(paper_seal, hold=15.0)), "hold_long_enough")
    assert check.failed
    # 17.8 N/m at 16.4 s fall by 1/e of it per factor e of time, and a drift may add to it
    assert 17.8 * np.exp(-1) / 203 < check.value < 0.05
    assert "k_inf is extrapolated" in check.message
    assert get_check(fit(record_of(paper_seal, hold=15.0), arms=1), "hold_long_enough").failed


def test_a_ramp_with_too_few_samples(paper_seal: GeneralizedMaxwell) -> None:
    check = get_check(fit(record_of(paper_seal, rate=5.0), arms=1), "ramp_sampled")
    assert check.failed
    assert "An arm as fast as the ramp cannot be seen. Sample faster." in check.message_with_remedy


def test_a_force_that_rises_is_not_fitted_silently(test: RampHold) -> None:
    swelling = replace(test, force=test.force + 0.02 * np.clip(test.time - 1.0, 0, None))
    for method in ("full", "hold"):
        result = fit(swelling, method=method)  # type: ignore[arg-type]
        assert result.status is Status.FORCE_RISES
        assert not result.ok
        assert "No relaxing part does that" in get_check(result, "force_relaxes").message
        assert "a relaxing seal cannot do that" in result.status.value


def test_a_drift_of_the_rig_is_no_rise(test: RampHold) -> None:
    drifting = replace(test, force=test.force + 2e-4 * test.time)
    assert get_check(fit(drifting), "force_relaxes").passed


def test_strain_check_fails_over_a_fifth_of_the_height(test: RampHold) -> None:
    deep = replace(test, specimen=Specimen(height=0.02))
    check = get_check(fit(deep, arms=2), "strain_small")
    assert check.failed
    assert check.value == pytest.approx(0.4)
    assert "k_inf is a secant stiffness" in check.message
    assert record_checks.strain_small(replace(test, specimen=Specimen(height=0.05))).passed
    assert record_checks.strain_small(test).passed is None


def test_arms_that_merge() -> None:
    close = GeneralizedMaxwell(196.5, (60.0, 60.0), (2.0, 2.6))
    result = fit(record_of(close, noise=1e-6, rate=200.0), arms=2)
    assert result.model.arms == 2
    check = get_check(result, "arms_distinct")
    assert check.failed
    assert "cannot separate two arms. Use 1 arm." in check.message_with_remedy


def test_more_arms_than_the_data_support(test: RampHold) -> None:
    result = fit(test, arms=4)
    assert result.status is not Status.CONVERGED
    check = get_check(result, "arms_supported")
    if result.model.arms > 2:
        assert check.failed
        assert "cannot be separated from noise" in check.message
        assert "Use fewer arms" in check.message_with_remedy


def test_an_arm_slower_than_the_hold() -> None:
    slow = GeneralizedMaxwell(100.0, (80.0,), (90.0,))
    result = fit(record_of(slow, noise=1e-4), arms=1)
    assert result.status is Status.TAU_AT_BOUND
    check = get_check(result, "tau_inside_window")
    assert check.failed
    assert "outside what the record can show" in check.message


def test_a_seal_that_flows_has_no_equilibrium() -> None:
    fluid = GeneralizedMaxwell(0.0, (200.0,), (20.0,))
    result = fit(record_of(fluid), arms=1)
    check = get_check(result, "k_inf_positive")
    assert check.failed
    assert "It may be zero" in check.message
    assert result.status is not Status.CONVERGED


def test_residuals_check_detects_a_remaining_curve(test: RampHold) -> None:
    check = get_check(fit(test, arms=1), "residuals_white")
    assert check.failed
    assert "The model misses part of the curve" in check.message
    smooth = np.convolve(np.random.default_rng(1).standard_normal(len(test.time) + 80), np.ones(81))
    filtered = replace(test, force=test.force + 1e-3 * smooth[80:-80], force_noise=1e-2)
    assert "was filtered, or drifts" in get_check(fit(filtered, arms=2), "residuals_white").message


def test_residuals_check_detects_slow_wandering(test: RampHold) -> None:
    random = np.random.default_rng(5)
    walk = np.cumsum(random.standard_normal(len(test.time)))
    result = fit(replace(test, force=test.force + 1e-3 * walk), arms=2)
    check = get_check(result, "residuals_steady")
    assert check.failed
    assert "The force wanders slowly" in check.message
    assert get_check(fit(test, arms=2), "residuals_steady").passed


def test_what_a_step_would_have_made_of_the_ramp(paper_seal: GeneralizedMaxwell) -> None:
    check = get_check(fit(record_of(paper_seal, noise=0.0), arms=2), "ramp_accounted_for")
    assert check.passed
    assert check.value == pytest.approx(-0.5664, abs=1e-4)
    assert "k_1 by -57 %, k_2 by -3 %" in check.message


def test_an_arm_lost_in_the_ramp() -> None:
    quick = GeneralizedMaxwell(196.5, (150.0, 20.0), (0.03, 5.0))
    check = get_check(fit(record_of(quick, rate=1000.0, noise=1e-3), arms=2), "fast_arm_visible")
    assert check.failed
    assert "Only the product b = k tau is known" in check.message


def test_drift_that_hides_a_slow_arm() -> None:
    slow = GeneralizedMaxwell(180.0, (15.0,), (35.0,))
    loose = replace(record_of(slow, noise=2e-2), machine=Machine(drift=1.0))
    check = get_check(fit(loose, arms=1), "drift_distinguished_from_arm")
    assert check.failed
    assert "Record a longer baseline before contact" in check.message_with_remedy
    # eq. 5 has no ramp to distinguish them either
    assert get_check(fit(loose, arms=1, method="hold"), "drift_distinguished_from_arm").failed
    single = fit(record_of(slow), arms=1, method="hold", nuisance=())
    without = get_check(single, "drift_distinguished_from_arm")
    assert without.passed is None
    assert "No drift is fitted" in without.message


def test_rules_that_disagree_say_so() -> None:
    agreed = solid.order_agreed(OrderChoice(2, 2, 2))
    assert agreed.passed
    assert agreed.message == "BIC and significance choose 2 arms."
    torn = solid.order_agreed(OrderChoice(1, 3, 1))
    assert torn.failed
    assert "BIC supports 3 arms, the significance of k and tau 1 arm; 1 arm taken" in torn.message


def test_a_choice_at_the_end_of_what_was_tried_says_so(test: RampHold) -> None:
    check = get_check(fit(test, max_arms=1), "order_agreed")
    assert check.failed
    assert "That is the most that was tried. Ask for more than 1 arms." in check.message_with_remedy
    assert get_check(fit(test), "order_agreed").passed


def test_eq_5_and_the_recorded_motion_disagree(test: RampHold) -> None:
    """A ramp that eases in and out is no ideal ramp: eq. 5 misreads it."""
    s = np.clip(test.time / test.ramp_end, 0, 1)
    eased = 8e-3 * s**4
    seal = GeneralizedMaxwell(196.5, (117.5, 17.8), (0.502, 16.4))
    result = fit(replace(test, displacement=eased, force=seal.force(test.time, eased)), arms=2)
    check = get_check(result, "hold_and_full_agree")
    assert check.failed
    assert "Use the fit of ramp and hold" in check.message_with_remedy
    assert result.model.k[0] == pytest.approx(117.5, rel=1e-5)
    assert get_check(fit(test, arms=2), "hold_and_full_agree").passed


def test_the_worst_of_several_tests_speaks(test: RampHold, paper_seal: GeneralizedMaxwell) -> None:
    again = record_of(paper_seal, seed=1)
    clipped = replace(again, force=np.minimum(again.force, 1.9))
    check = get_check(fit([test, clipped], arms=2), "force_not_clipped")
    assert check.failed
    assert check.message.startswith("In test 2 of 2, the force is clipped")


def test_a_test_of_nothing_but_noise_informs_no_frequency(test: RampHold) -> None:
    noise = np.random.default_rng(3).standard_normal(len(test.time))
    result = fit(replace(test, force=noise, force_noise=1.0))
    check = get_check(result, "valid_band_exists")
    assert check.failed
    assert "Reduce the noise, press deeper, or hold longer." in check.message_with_remedy
    assert result.band[0] == result.band[1]
    whole = fit(test)
    assert (
        f"The valid band of this test is {whole.band[0]:.2g} to 0.32 Hz"
        in get_check(whole, "valid_band_exists").message
    )
