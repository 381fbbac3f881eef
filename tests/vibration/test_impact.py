"""From hammer hits to an FRF: the known FRF comes back, and what cannot be trusted is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dashpot.base.checks import Remedy
from dashpot.base.errors import DataError
from dashpot.base.student_t import t_quantile
from dashpot.datamodel.frf import FRF, Hit, Kind
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.vibration.impact.amplitude_trend import fit_amplitude_trend
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.mass_on_seals import model_modes, predict_frf

pytestmark = pytest.mark.once

MASS = 0.1040426
NOISE = (5e-3, 0.02)


def error(frf, model, mass=MASS, low=5.0, high=50.0):
    true = predict_frf(model, mass=mass, frequency=frf.frequency, shift=frf.shift)
    lines = (frf.frequency >= low) & (frf.frequency <= high)
    return np.abs(frf.value / true.value - 1)[lines].max()


def check(frf, name):
    (result,) = [check for check in frf.checks if check.name == name]
    return result


# -- the known FRF ------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [0, 1])
def test_a_long_record_returns_equation_7(paper_seal, seed):
    rig = replace(Hammer().noise_free(), record=32.0, duration=(0.015, 0.015))
    test = simulate_impact(paper_seal, mass=MASS, hits=1, rig=rig, seed=seed).test
    assert error(estimate_frf(test), 2 * paper_seal) < 3e-4


def test_without_an_anti_alias_filter_the_edges_of_the_pulse_alias(strike, paper_seal):
    def compute_error_at_rate(rate):
        test = strike(record=32.0, rate=rate, before=0.1, on_sample=True)
        return error(estimate_frf(test), 2 * paper_seal)

    assert compute_error_at_rate(1000) == pytest.approx(0.023, rel=0.05)
    assert compute_error_at_rate(2048) < 3e-3
    assert compute_error_at_rate(4096) < 4e-4


@pytest.mark.parametrize(("end", "most"), [("1e-6", 2e-4), ("1e-4", 2e-3)])
def test_the_exponential_window_is_exact_on_the_shifted_line(strike, paper_seal, end, most):
    test = strike(record=2.0, rate=8192)
    frf = estimate_frf(test, window=f"exponential:{end}", band=(5, 50))
    assert frf.shift == pytest.approx(-np.log(float(end)) / 2.0, rel=1e-3)
    assert error(frf, 2 * paper_seal) < most
    on_axis = predict_frf(2 * paper_seal, mass=MASS, frequency=frf.frequency)
    assert np.abs(frf.value / on_axis.value - 1).max() > 0.5


def test_the_exponential_window_is_as_gentle_as_the_decay_allows(strike, broad_seal, paper_seal):
    ringing = estimate_frf(strike(record=2.0), window="exponential")
    decay = np.exp(-2 * (0.354171 + ringing.shift))
    assert 0.003 < decay < 0.02
    decayed = estimate_frf(strike(2 * broad_seal, 0.114829829, record=8.0), window="exponential")
    assert decayed.shift == 0
    assert any("not needed" in step.message for step in decayed.steps)


@pytest.mark.parametrize("window", ["force+exponential:0.01", "none", "exponential:0.01", "force"])
def test_offsets_do_not_reach_the_frf(strike, window):
    plain = estimate_frf(strike(record=4.0, rate=4096), window=window, band=(2, 60))
    offset = estimate_frf(
        strike(record=4.0, rate=4096, offset=(0.3, -2.0)), window=window, band=(2, 60)
    )
    np.testing.assert_allclose(offset.value, plain.value, rtol=1e-9)


def test_the_force_window_keeps_the_whole_pulse(strike):
    plain = estimate_frf(strike(record=4.0))
    windowed = estimate_frf(strike(record=4.0), window="force")
    np.testing.assert_allclose(windowed.value, plain.value, rtol=1e-12)


def test_the_force_window_takes_noise_away(strike, paper_seal):
    test = strike(record=20.0, hits=5, noise=(0.05, 0.0))
    assert error(estimate_frf(test, window="force"), 2 * paper_seal, low=14) < 0.5 * error(
        estimate_frf(test), 2 * paper_seal, low=14
    )


def test_continuous_record_and_separate_records_give_the_same_frf(strike, broad_seal):
    test = strike(2 * broad_seal, 0.114829829, record=8.0, hits=4, noise=NOISE)
    joined = ImpactTest(
        time=np.arange(len(test.force)) / 2048,
        force=test.force,
        acceleration=test.acceleration,
        units="SI",
    )
    frf, together = estimate_frf(test), estimate_frf(joined)
    assert together.averages == 4
    assert [hit.accepted for hit in together.hits] == [True] * 4
    assert [hit.time for hit in together.hits] == pytest.approx([0.1, 8.1, 16.1, 24.1], abs=2e-3)
    assert frf.modes()[0].damping_ratio == pytest.approx(
        together.modes()[0].damping_ratio, rel=2e-3
    )


def test_tests_in_several_files_are_averaged(strike):
    frf = estimate_frf([strike(seed=1), strike(seed=2), strike(seed=3)])
    assert frf.averages == 3
    assert [hit.name for hit in frf.hits] == ["1", "2", "3"]


def test_estimate_frf_accepts_record_length_and_pretrigger(strike):
    frf = estimate_frf(strike(record=8.0), record=4.0, pretrigger=0.05)
    assert np.diff(frf.frequency) == pytest.approx(0.25)
    # the record begins in the middle of the 15 ms pulse
    assert frf.record == pytest.approx(4.0 - 0.05 - 0.0075, abs=1e-3)
    assert frf.pulse == pytest.approx(0.015 * np.sqrt(0.25 - 2 / np.pi**2), rel=0.02)


# -- signs --------------------------------------------------------------------------------------


def test_passive_receptance_has_negative_imaginary_values(strike):
    receptance = estimate_frf(strike(record=32.0), band=(2, 50)).to(Kind.RECEPTANCE)
    assert (receptance.value.imag < 0).all()


@pytest.mark.parametrize(("hammer", "accelerometer"), [(-1, 1), (1, -1), (-1, -1)])
def test_estimate_frf_detects_and_reports_polarity(strike, hammer, accelerometer):
    test = strike(record=4.0, hits=3, noise=NOISE)
    plain = estimate_frf(test)
    turned = estimate_frf(
        replace(test, force=hammer * test.force, acceleration=accelerometer * test.acceleration)
    )
    np.testing.assert_allclose(turned.value, plain.value, rtol=1e-9)
    names = [step.name for step in turned.steps]
    assert ("hammer_sign" in names) == (hammer < 0)
    assert ("polarity" in names) == (accelerometer < 0)


def test_estimate_frf_refuses_opposite_polarity_unless_stated(strike):
    test = strike(record=4.0, hits=3, noise=NOISE)
    both = replace(
        test, acceleration=np.vstack((test.acceleration, -test.acceleration)), channels=()
    )
    with pytest.raises(DataError, match=r"opposite polarity.*acceleration 2 against.*\(1, -1\)"):
        estimate_frf(both)
    frf = estimate_frf(both, polarity=(1, -1))
    np.testing.assert_allclose(frf.value, estimate_frf(test).value, rtol=1e-9)


def wandering(test: ImpactTest, size: float, seed: int) -> ImpactTest:
    """The test with a random walk of its own on every accelerometer in every record."""
    random, drift = np.random.default_rng(seed), np.zeros_like(test.acceleration)
    for record in test.records():
        steps = random.standard_normal((len(drift), len(test.time[record])))
        drift[:, record] = size * np.cumsum(steps, axis=1) / np.sqrt(steps.shape[1])
    return replace(test, acceleration=test.acceleration + drift)


def test_drifting_accelerometers_are_not_of_opposite_polarity(strike):
    test = strike(hits=4, noise=NOISE)
    pair = replace(test, acceleration=np.vstack([test.acceleration] * 2), channels=())
    for seed in range(6):
        frf = estimate_frf(wandering(pair, 1.0, seed))
        assert "polarity" not in [step.name for step in frf.steps]
        assert frf.modes()[0].frequency == pytest.approx(12.71, abs=0.01)


# -- what can be trusted ------------------------------------------------------------------------


def swaying(strike, hits=4):
    """Hits on a block that sways at 2 Hz by itself, out of step with the hits."""
    test, random = strike(record=16.0, hits=hits, noise=NOISE), np.random.default_rng(5)
    sway = np.concatenate(
        [
            40 * np.sin(4 * np.pi * test.time[record] + random.uniform(0, 6.28))
            for record in test.records()
        ]
    )
    return replace(test, acceleration=test.acceleration + sway)


def test_frf_checks_use_the_resonance_in_the_requested_band(strike):
    frf = estimate_frf(swaying(strike), resonance_band=(5, 50), mass=MASS)
    assert "(12.63 Hz)" in check(frf, "coherence").message
    assert check(frf, "coherence").passed
    assert check(frf, "resonance").value == pytest.approx(12.71, abs=0.02)
    assert frf.frequency[0] < 1  # the lines stay
    low = estimate_frf(swaying(strike), resonance_band=(1.0, 4.0))
    assert check(low, "coherence").failed


def struck_alike(strike, paper_seal, *, softens, damps=0.0, hits=6):
    """Single hits of 1 to 8 in height on seals that soften, or damp more, per doubling."""
    made = []
    for i, height in enumerate(np.geomspace(0.5, 4.0, hits)):
        doublings = np.log2(height)
        seal = (1 - softens * doublings) * paper_seal
        seal = replace(seal, b=0.1 * (1 + damps * doublings))
        hit = strike(2 * seal)
        noise = 0.02 * np.random.default_rng(i).standard_normal(hit.acceleration.shape)
        made.append(
            replace(hit, force=height * hit.force, acceleration=height * hit.acceleration + noise)
        )
    return estimate_frf(made)


def test_hits_of_all_heights_agree_on_a_linear_seal(strike, paper_seal):
    assert check(struck_alike(strike, paper_seal, softens=0.0), "amplitude_linear").passed
    few = estimate_frf(strike(hits=3, noise=NOISE))
    assert check(few, "amplitude_linear").passed is None


def test_amplitude_check_states_the_softening_per_doubling(strike, paper_seal):
    message = check(struck_alike(strike, paper_seal, softens=0.01), "amplitude_linear")
    assert message.failed
    assert "change the stiffness by -1 % per doubling" in message.message
    damped = check(struck_alike(strike, paper_seal, softens=0.0, damps=0.2), "amplitude_linear")
    assert damped.failed


@pytest.mark.slow
def test_a_trend_is_not_seen_where_there_is_none(strike, paper_seal):
    checks = [
        check(estimate_frf(strike(record=8.0, hits=5, noise=NOISE, seed=s)), "amplitude_linear")
        for s in range(60)
    ]
    assert sum(item.failed for item in checks) <= 2


def test_frf_of_a_single_hit_has_no_coherence(strike):
    frf = estimate_frf(strike())
    assert frf.coherence is None
    assert frf.sd is None
    assert check(frf, "coherence").passed is None
    assert "single hit" in check(frf, "coherence").message
    assert check(frf, "hits_enough").failed


def test_three_good_hits_are_enough(strike):
    frf = estimate_frf(strike(hits=3, noise=NOISE))
    assert check(frf, "hits_enough").passed
    assert check(frf, "coherence").passed
    assert check(frf, "hits_agree").passed


def test_frf_checks_state_the_required_record_length(strike):
    frf = estimate_frf(strike(record=4.0, hits=3, noise=NOISE))
    long_enough, lines = check(frf, "record_long_enough"), check(frf, "lines_in_half_power_band")
    assert long_enough.failed
    assert long_enough.limit == pytest.approx(6 / 0.354171, rel=0.02)
    assert lines.failed
    assert lines.remedy == Remedy("Record 17 s after each hit.", "hit-length", "17s")
    assert lines.value == pytest.approx(0.112747 * 4, rel=0.02)


@pytest.mark.parametrize(("milliseconds", "level"), [(10, -0.131), (20, -0.529)])
def test_excitation_check_uses_the_force_at_the_resonance(strike, milliseconds, level):
    """A half-sine's spectrum, cos(pi f T) / (1 - (2 f T)^2), at 12.71 Hz."""
    frf = estimate_frf(strike(hits=3, pulse=milliseconds / 1000, on_sample=True))
    assert check(frf, "hammer_excites").passed
    # the nearest line stands at 12.75 Hz
    assert check(frf, "hammer_excites").value == pytest.approx(level, abs=0.006)
    # the first zero of the spectrum is at 1.5 / T, 20 dB down somewhat below
    assert 0.8 < frf.frequency[-1] * milliseconds / 1500 < 0.95


def test_excitation_check_reports_a_soft_tip(strike, paper_seal):
    frf = estimate_frf(strike(hits=3, pulse=0.1, noise=(0.0, 1e-4)), band=(2, 40))
    excites = check(frf, "hammer_excites")
    assert excites.failed
    assert excites.remedy == Remedy("Use a harder tip.")


def test_a_heavily_damped_seal_needs_no_more(strike, broad_seal):
    frf = estimate_frf(strike(2 * broad_seal, 0.114829829, hits=3, noise=NOISE), mass=0.114829829)
    assert [c.message for c in frf.checks if c.failed] == []


@pytest.mark.parametrize(
    ("gain", "message"),
    [
        (1 / 9.80665, "looks like g, not m/s"),
        (9.80665, "looks like m/s^2, not g"),
        (1.2, "is wrong by a factor of"),
    ],
)
def test_the_mass_line_finds_unit_slips(strike, gain, message):
    test = strike(hits=3, noise=NOISE)
    frf = estimate_frf(replace(test, acceleration=gain * test.acceleration), mass=MASS)
    assert check(frf, "high_frequency_mass_agrees").failed
    assert message in check(frf, "high_frequency_mass_agrees").message


def test_the_mass_line_confirms_a_good_calibration(strike):
    assert check(
        estimate_frf(strike(hits=3, noise=NOISE), mass=MASS), "high_frequency_mass_agrees"
    ).passed


def test_a_turned_sign_shows_in_the_mass_line(strike):
    frf = estimate_frf(strike(hits=3, noise=NOISE), mass=MASS, polarity=(-1,))
    assert (
        "polarity of the hammer or of the accelerometers is wrong"
        in check(frf, "high_frequency_mass_agrees").message
    )


def test_the_random_error_is_the_scatter(strike, paper_seal):
    """Over many tests the real and imaginary parts scatter as the sd says."""
    frfs = [
        estimate_frf(
            strike(record=4.0, rate=512, hits=4, noise=(0.02, 0.1), seed=seed), band=(4, 40)
        )
        for seed in range(24)
    ]
    scatter = np.array([frf.value for frf in frfs]).std(axis=0) / np.sqrt(2)
    stated = np.sqrt(np.mean([frf.sd**2 for frf in frfs], axis=0))
    ratio = (scatter / stated)[np.abs(frfs[0].frequency - 12.7) > 1]
    assert np.median(ratio) == pytest.approx(1.0, abs=0.2)


def test_a_mode_lies_within_its_error(strike):
    true = 12.70975, 0.00443503
    z = []
    for seed in range(6):
        (mode,) = estimate_frf(strike(record=4.0, hits=4, noise=NOISE, seed=seed)).modes()
        z.append((mode.frequency - true[0]) / mode.frequency_se)
        z.append((mode.damping_ratio - true[1]) / mode.damping_ratio_se)
    assert np.sqrt(np.mean(np.square(z))) < 2
    assert np.abs(z).max() < 4


# -- choices ------------------------------------------------------------------------------------


def test_hits_are_accepted_and_rejected_by_name(strike):
    test = strike(hits=4, noise=NOISE)
    frf = estimate_frf(test, reject=["2"])
    assert [hit.accepted for hit in frf.hits] == [True, False, True, True]
    others = ImpactTest.__dict__["records"](test)
    keep = np.r_[others[0], others[2], others[3]]
    n = len(test.force) // 4
    rest = ImpactTest(
        test.time[keep],
        test.force[keep],
        test.acceleration[:, keep],
        starts=(0, n, 2 * n),
        units="SI",
    )
    np.testing.assert_allclose(frf.value, estimate_frf(rest).value, rtol=1e-9)


def test_a_rejected_hit_can_be_forced_in(strike, paper_seal):
    rig = replace(Hammer(), record=4.0, double_hits=(1,))
    test = simulate_impact(paper_seal, mass=MASS, hits=4, rig=rig).test
    assert [hit.accepted for hit in estimate_frf(test).hits] == [True, False, True, True]
    assert estimate_frf(test, accept=["2"]).averages == 4


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({"estimator": "H3"}, "expected one of H1, H2, Hv, Hs"),
        ({"window": "hann"}, "does not suit a hammer test"),
        ({"window": "exponential:2"}, "more than 0 and less than 1"),
        ({"window": "none:1"}, "does not suit"),
        ({"reject": ["7"]}, "there is no hit '7'; the hits are 1"),
        ({"reject": ["1"]}, "no hit is left to average. hit 1: rejected by name"),
        ({"combine": "median"}, "expected 'mean', 'weighted' or a channel: acceleration 1"),
        ({"polarity": (1, 1)}, r"expected \+1 or -1 for each of the 1 accelerometers"),
        ({"record": 0.05}, "expected more than the 0.1 s before"),
        ({"mass": 0}, "mass = 0 kg; expected a number > 0"),
        ({"pretrigger": -1}, "expected a time >= 0"),
        ({"band": (12.0, 12.1)}, "lines between 12 and 12.1 Hz"),
    ],
)
def test_choices_that_cannot_be_are_refused(strike, choice, message):
    with pytest.raises(DataError, match=message):
        estimate_frf(strike(), **choice)


def test_no_blow_no_frf():
    quiet = np.random.default_rng(0).standard_normal(4000)
    with pytest.raises(DataError, match="no hammer hit found"):
        estimate_frf(ImpactTest(np.arange(4000) / 1000, 0.01 * quiet, quiet[None], units="SI"))


def test_tests_that_do_not_belong_together_are_refused(strike):
    with pytest.raises(DataError, match="sampled at 2048 and 1024 Hz"):
        estimate_frf([strike(), strike(rate=1024)])
    with pytest.raises(DataError, match="name the columns alike"):
        estimate_frf([strike(), replace(strike(), channels=("left",))])
    with pytest.raises(DataError, match="no hammer test given"):
        estimate_frf([])


# -- the virtual hammer -------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["paper", "broad"])
@pytest.mark.parametrize("combine", ["mean", "weighted"])
def test_the_simulated_seals_come_back(paper_seal, broad_seal, name, combine):
    seal, mass = (paper_seal, MASS) if name == "paper" else (broad_seal, 0.114829829)
    simulated = simulate_impact(seal, mass=mass, hits=5, rig=replace(Hammer(), record=8.0))
    frf = estimate_frf(simulated.test, combine=combine, mass=mass)
    (true,) = model_modes(2 * seal, mass)
    mode = frf.modes()[0]
    assert mode.frequency == pytest.approx(true.frequency, rel=1e-4)
    assert mode.damping_ratio == pytest.approx(true.damping_ratio, rel=0.01)
    assert mode.modal_mass == pytest.approx(true.modal_mass, rel=0.01)
    assert check(frf, "high_frequency_mass_agrees").passed
    arm, length = 0.05, 0.12
    eccentric = [e * arm / (length**2 / 12) for e in simulated.truth.eccentricities]
    assert check(frf, "hits_centred").value == pytest.approx(np.abs(eccentric).max(), rel=0.1)


def test_a_high_pass_in_the_hammer_is_noticed(strike):
    test = strike(record=8.0)
    dt, corner = 1 / 2048, 0.5
    tau = 1 / (2 * np.pi * corner)
    force = np.zeros_like(test.force)
    for i in range(1, len(force)):
        force[i] = (force[i - 1] + test.force[i] - test.force[i - 1]) / (1 + dt / tau)
    (hit,) = estimate_frf(replace(test, force=force)).hits
    assert hit.accepted
    (message,) = [reason for reason in hit.reasons if "base line" in reason]
    assert "high pass at 0.5 Hz" in message


def test_the_result_is_an_frf_with_its_story(strike):
    frf = estimate_frf(strike(hits=3, noise=NOISE), window="exponential:0.1", estimator="Hv")
    assert isinstance(frf, FRF)
    assert frf.quantity is Kind.ACCELERANCE
    assert [step.name for step in frf.steps] == ["cut", "exponential_window", "estimate"]
    assert frf.frequency[0] > 0


def test_hits_have_resonance_and_amplitude(strike, paper_seal):
    """A mass on a seal: velocity F / m after the pulse, and so an amplitude of F / (m omega)."""
    frf = struck_alike(strike, paper_seal, softens=0.01)
    peaks = np.array([hit.peak for hit in frf.hits])
    X = np.array([hit.amplitude for hit in frf.hits])
    assert X / X[0] == pytest.approx(peaks / peaks[0], rel=0.03)
    assert [hit.modal_mass for hit in frf.hits] == pytest.approx(6 * [MASS], rel=0.03)
    trend = fit_amplitude_trend(frf.hits)
    assert trend.stiffness == pytest.approx(-0.01, rel=0.15)
    assert trend.amplitudes == pytest.approx((0.55 * X.min(), 0.55 * X.max()))


def test_trend_of_hits_has_the_published_error():
    """Published numbers: five hits over 1:4, eight over 1:2.5, 0.1 % scatter of the frequency."""
    rng = np.random.default_rng(1)
    for count, wide, published in ((5, 4.0, 0.0054), (8, 2.5, 0.0055)):
        sizes = np.geomspace(1.0, wide, count)

        def compute_trend(change, count=count, sizes=sizes):
            f = 12.7 * sizes ** (change / np.log(4)) * (1 + 1e-3 * rng.normal(size=count))
            return fit_amplitude_trend(
                [
                    Hit(str(i), 0.0, True, (), 1.0, 0.0, hz, 0.03, 0.1, 1e-3 * X)
                    for i, (hz, X) in enumerate(zip(f, sizes, strict=True))
                ]
            )

        every = [compute_trend(published) for _ in range(400)]
        assert np.sqrt(
            np.mean([item.detectable_stiffness_change**2 for item in every])
        ) == pytest.approx(published, rel=0.06)
        seen = [
            abs(model.stiffness) > t_quantile(0.95, count - 2) * model.stiffness_line.se
            for model in every
        ]
        assert np.mean(seen) == pytest.approx(0.8, abs=0.06)
