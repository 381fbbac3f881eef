"""The virtual hammer test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, PAPER, PAPER_MASS
from dashpot.vibration.mass_on_seals import predict_frf


def ratio(test):
    frequency = np.fft.rfftfreq(len(test.time), 1 / test.rate)
    return frequency, np.fft.rfft(test.acceleration, axis=1) / np.fft.rfft(test.force)


def test_the_frf_of_a_long_quiet_record_is_eq_7():
    made = simulate_impact(
        PAPER, mass=PAPER_MASS, hits=1, rig=Hammer(record=32.0).noise_free(), seed=3
    )
    frequency, result = ratio(made.test)
    band = (frequency >= 5) & (frequency <= 50)
    expected = predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=frequency[band])
    off = np.abs(result[0, band] / expected.value - 1)
    # what is left is the tail that 32 s cuts off
    assert np.median(off) < 3e-4
    longer = simulate_impact(
        PAPER, mass=PAPER_MASS, hits=1, rig=Hammer(record=64.0).noise_free(), seed=3
    )
    frequency, result = ratio(longer.test)
    band = (frequency >= 5) & (frequency <= 50)
    expected = predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=frequency[band])
    np.testing.assert_allclose(result[0, band], expected.value, rtol=3e-4)


def test_the_default_record_is_long_enough_for_the_papers_seal():
    # six time constants of 1/0.354171 s leave half a percent of the FRF uncertain
    assert Hammer().record - Hammer().pretrigger > 6 / 0.354171
    made = simulate_impact(PAPER, mass=PAPER_MASS)
    assert made.test.rate == pytest.approx(2048.0)
    assert len(made.test.records()) == 5
    assert made.test.acceleration.shape == (2, 5 * 40960)
    assert made.test.positions == (0.05, -0.05)
    for record, pulse in zip(made.test.records(), made.truth.hits, strict=True):
        assert made.test.force[record].max() == pytest.approx(pulse.peak, abs=0.06)
        assert 2.0 <= pulse.peak <= 5.0
        assert 0.010 <= pulse.duration <= 0.020


def test_quiet_before_the_hit():
    made = simulate_impact(BROAD, mass=BROAD_MASS, rig=Hammer(record=4.0).noise_free())
    for record in made.test.records():
        early = made.test.time[record] < 0.09
        assert np.abs(made.test.force[record][early]).max() < 1e-6
        assert np.abs(made.test.acceleration[:, record][:, early]).max() < 1e-4


def test_the_mean_of_both_accelerometers_does_not_rock():
    rig = replace(Hammer(record=16.0).noise_free(), eccentricity=10e-3)
    made = simulate_impact(BROAD, mass=BROAD_MASS, hits=1, rig=rig)
    frequency, result = ratio(made.test)
    band = (frequency >= 5) & (frequency <= 50)
    expected = predict_frf(2 * BROAD, mass=BROAD_MASS, frequency=frequency[band]).value
    np.testing.assert_allclose(result.mean(axis=0)[band], expected, rtol=1e-3)
    assert np.abs(result[0, band] / expected - 1).max() > 0.1
    rocking = np.abs(result[0] - result[1])[band]
    assert frequency[band][np.argmax(rocking)] == pytest.approx(16.57, abs=0.2)


def test_a_continuous_record_still_rings_when_struck_again():
    rig = Hammer(record=2.0).noise_free()
    simulated_impact = simulate_impact(PAPER, mass=PAPER_MASS, hits=3, rig=rig)
    joined = simulate_impact(PAPER, mass=PAPER_MASS, hits=3, rig=replace(rig, continuous=True))
    assert joined.test.starts == (0,)
    assert joined.test.time[-1] == pytest.approx(6.0, abs=1e-3)
    np.testing.assert_allclose(joined.test.force, simulated_impact.test.force, atol=1e-9)
    second = slice(4096, 4096 + 180)
    assert np.abs(simulated_impact.test.acceleration[0, second]).max() < 1e-4
    assert np.abs(joined.test.acceleration[0, second]).max() > 1.0
    # one long record obeys eq. 7 whatever still rings: nothing was lost between the hits
    long = simulate_impact(
        BROAD, mass=BROAD_MASS, hits=3, rig=replace(rig, record=5.0, continuous=True)
    )
    frequency, result = ratio(long.test)
    band = (frequency >= 8) & (frequency <= 20)
    expected = predict_frf(2 * BROAD, mass=BROAD_MASS, frequency=frequency[band]).value
    assert np.median(np.abs(result[0, band] / expected - 1)) < 1e-3


def test_a_double_hit_strikes_again_after_60_ms():
    rig = replace(Hammer(record=2.0).noise_free(), double_hits=(1,))
    made = simulate_impact(BROAD, mass=BROAD_MASS, hits=2, rig=rig)
    for i, record in enumerate(made.test.records()):
        pulse = made.truth.hits[i]
        late = made.test.time[record] > pulse.start + pulse.duration + 0.02
        again = made.test.force[record][late].max()
        assert again == pytest.approx(0.4 * pulse.peak if i else 0.0, abs=0.02)


def test_gains_offsets_and_noise_are_those_of_the_truth():
    made = simulate_impact(BROAD, mass=BROAD_MASS, hits=1, rig=Hammer(eccentricity=0.0))
    assert made.truth.gains == (1.01, 0.99)
    quiet = made.test.time < 0.09
    assert made.test.force[quiet].mean() == pytest.approx(0.02, abs=2e-3)
    assert made.test.acceleration[0, quiet].mean() == pytest.approx(0.05, abs=0.01)
    assert made.test.acceleration[0, quiet].std() == pytest.approx(0.02, rel=0.2)
    counts = made.test.force / (40.0 / 2**16)
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
    low = made.test.acceleration - made.test.acceleration[:, quiet].mean(axis=1)[:, None]
    slope = low[0] @ low[1] / (low[1] @ low[1])
    assert slope == pytest.approx(1.01 / 0.99, rel=1e-3)


def test_the_supply_passes_no_slow_motion():
    rig = Hammer(record=16.0).noise_free()
    straight = simulate_impact(BROAD, mass=BROAD_MASS, hits=1, rig=rig)
    passed = simulate_impact(BROAD, mass=BROAD_MASS, hits=1, rig=replace(rig, highpass=0.5))
    frequency, before = ratio(straight.test)
    _, after = ratio(passed.test)
    band = (frequency > 2) & (frequency < 40)
    expected = 1j * frequency[band] / (0.5 + 1j * frequency[band])
    np.testing.assert_allclose((after / before)[0, band], expected, rtol=2e-3)


def test_the_same_seed_is_the_same_record():
    rig = Hammer(record=2.0)
    first, again, other = (
        simulate_impact(BROAD, mass=BROAD_MASS, hits=2, rig=rig, seed=s) for s in (1, 1, 2)
    )
    assert first.test == again.test
    assert first.truth == again.truth
    assert first.test != other.test


@pytest.mark.parametrize("name", ["mass", "seals", "hits"])
def test_an_impossible_test_is_refused(name: str):
    with pytest.raises(DataError, match=f"{name} = .*expected a number > 0"):
        simulate_impact(PAPER, **{"mass": 0.1, name: 0})


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"rate": 0.0}, "expected a rate > 0"),
        ({"record": 0.1}, "expected more than the pretrigger, 0.1 s"),
        ({"duration": (0.0, 0.01)}, "expected a range above 0"),
        ({"rate": 200.0}, "fewer than 4 samples at 200 Hz; expected a rate of at least 400 Hz"),
    ],
)
def test_an_impossible_hammer_is_refused(options: dict[str, object], sentence: str):
    with pytest.raises(DataError, match=sentence):
        Hammer(**options)
