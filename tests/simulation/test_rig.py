"""The virtual indentation rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.simulation.relaxation import simulate_path, simulate_relaxation
from dashpot.simulation.rig_errors import Rig, round_to_quantum
from dashpot.simulation.robot import Axis
from dashpot.solids.demo_seals import (
    BROAD,
    BROAD_MASS,
    HIDDEN,
    HIDDEN_MASS,
    PAPER,
    PAPER_MASS,
    SEALS,
)


def test_simulated_seals_have_the_published_stiffness(paper_seal):
    assert paper_seal == PAPER
    omega = 2 * np.pi * 12.71
    assert float(BROAD.storage(omega=omega)) == pytest.approx(364.878, rel=1e-5)
    assert float(BROAD.loss_factor(omega=omega)) == pytest.approx(0.056189, rel=1e-4)
    assert dict(SEALS) == {
        "paper": (PAPER, PAPER_MASS), "broad": (BROAD, BROAD_MASS), "hidden": (HIDDEN, HIDDEN_MASS),
    }  # fmt: skip


def test_a_noise_free_record_is_the_exact_answer_to_the_true_motion():
    made = simulate_relaxation(PAPER, rig=Rig().noise_free())
    test, truth = made.test, made.truth
    np.testing.assert_array_equal(test.displacement, truth.displacement)
    np.testing.assert_allclose(test.force, PAPER.force(test.time, test.displacement), atol=1e-12)
    # the lag is taken out by the ideal ramp: eq. 5 from its corners, once the axis has settled
    ideal = PAPER.ramp_hold_force(
        test.time - truth.onset, depth=8e-3, ramp_time=truth.ramp_end - truth.onset
    )
    settled = test.time > 3.0
    assert np.abs(test.force - ideal)[settled].max() < 1e-3


def test_the_default_record_is_that_of_the_reference_rig():
    made = simulate_relaxation(PAPER)
    test, truth = made.test, made.truth
    assert len(test.time) == 42501
    assert truth.ramp_end - truth.onset == pytest.approx(1.0, abs=1e-4)
    assert truth.onset == pytest.approx(1.5 + 2 * 0.6 / (2 * np.pi * 6) - 0.005, abs=2e-3)
    np.testing.assert_allclose(test.displacement / 0.02e-3, np.round(test.displacement / 0.02e-3))
    np.testing.assert_allclose(test.force * 1280, np.round(test.force * 1280), atol=1e-6)
    error = test.force - truth.force
    slope, offset = np.polyfit(test.time, error, 1)
    assert offset == pytest.approx(0.05, abs=2e-4)
    assert slope == pytest.approx(0.2e-3, abs=1e-5)
    rest = error - offset - slope * test.time
    assert rest.std() == pytest.approx(np.hypot(4e-3, np.hypot(3e-3, 1e-3) / 2**0.5), rel=0.02)
    spectrum = np.abs(np.fft.rfft(rest[: 40 * 1000])) / 20000
    assert spectrum[50 * 40] == pytest.approx(3e-3, rel=0.05)
    assert spectrum[37 * 40] == pytest.approx(1e-3, rel=0.1)
    assert test.source is None
    assert test.specimen.notes == "simulated"


def test_the_same_seed_is_the_same_record_and_another_is_another():
    first, again, other = (simulate_relaxation(PAPER, hold_time=2.0, seed=s) for s in (1, 1, 2))
    assert first.test == again.test
    assert first.truth == again.truth
    assert first.test != other.test


def test_hum_aliases_when_the_record_is_slow():
    rig = replace(Rig(rate=100.0).noise_free(), hum=3e-3, hum_frequency=60.0)
    made = simulate_relaxation(PAPER, rig=rig, hold_time=38.5)
    error = (made.test.force - made.truth.force)[:4000]
    peak = np.argmax(np.abs(np.fft.rfft(error)))
    assert peak / 40 == pytest.approx(40.0)


def test_a_record_faster_than_the_controller_lies_on_the_smooth_motion():
    slow = simulate_relaxation(PAPER, hold_time=1.0, rig=Rig().noise_free())
    fast = simulate_relaxation(PAPER, hold_time=1.0, rig=replace(Rig().noise_free(), rate=5000.0))
    np.testing.assert_allclose(fast.test.displacement[::5], slow.test.displacement, atol=1e-12)
    np.testing.assert_allclose(fast.test.force[::5], slow.test.force, atol=2e-5)


def test_contact_comes_after_the_gap():
    made = simulate_relaxation(PAPER, rig=replace(Rig().noise_free(), gap=0.5e-3))
    touched = made.truth.displacement > 0.5e-3
    assert np.abs(made.truth.force[~touched]).max() == 0.0
    assert made.truth.displacement[-1] == pytest.approx(8.5e-3, abs=1e-8)
    first = made.test.time[np.argmax(touched)]
    # half a millimetre into its travel the axis is still 4 ms behind its straight line
    assert 0 < first - made.truth.onset < 5e-3


@given(
    tilt=st.floats(1e-3, 0.05),
    gap=st.floats(0, 1e-3),
    position=st.floats(0, 1e-2),
)
def test_a_tilted_plate_presses_the_mean_of_its_slices(tilt: float, gap: float, position: float):
    rig = Rig(tilt=tilt, gap=gap)
    slices = (np.arange(20000) + 0.5) / 20000 * rig.length * np.tan(tilt)
    mean = np.maximum(position - gap - slices, 0.0).mean()
    assert rig.compression(np.array([position]))[0] == pytest.approx(mean, rel=1e-3, abs=1e-9)


def test_a_stiffening_seal_answers_to_the_cubic():
    rig = Rig(stiffening=7.2656e-4 / 0.15 * 1e6)
    pressed = rig.compression(np.array([8e-3]))[0]
    assert 0.15e3 * pressed == pytest.approx(0.15 * 8 + 7.2656e-4 * 8**3, rel=1e-9)


def test_the_load_cell_counts_and_clips():
    assert round(2.117728 * 1280) == 2711
    assert round_to_quantum(np.array([2.117728]), 1 / 1280)[0] == pytest.approx(2711 / 1280)
    made = simulate_relaxation(50 * PAPER, hold_time=1.0)
    assert made.test.force.max() == 70.0
    assert made.truth.force.max() > 100.0


def test_any_path_can_be_followed():
    test, position, force = simulate_path(
        PAPER, path=((1.0, 4e-3), (3.0, 4e-3), (4.0, 8e-3), (6.0, 8e-3)), rig=Rig(axis=Axis())
    )
    assert position[np.searchsorted(test.time, 4.4)] == pytest.approx(4e-3, abs=1e-6)
    assert position[-1] == pytest.approx(8e-3, abs=1e-6)
    assert force[-1] > 196.5 * 8e-3


@pytest.mark.parametrize("name", ["depth", "ramp_time", "hold_time"])
def test_an_impossible_test_is_refused(name: str):
    with pytest.raises(DataError, match=f"{name} = .*expected a number > 0"):
        simulate_relaxation(PAPER, **{name: 0.0})


@pytest.mark.parametrize(
    ("name", "value", "expected"), [("rate", 0.0, "> 0"), ("gap", -1e-3, ">= 0")]
)
def test_an_impossible_rig_is_refused(name: str, value: float, expected: str):
    with pytest.raises(DataError, match=f"rig {name} = .*expected a number {expected}"):
        Rig(**{name: value})
