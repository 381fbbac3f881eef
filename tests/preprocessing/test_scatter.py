"""Noise and quantum of a channel."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.datamodel.relaxation import find_quantum
from dashpot.signals.noise import estimate_robust_scatter, remove_spikes, scatter, spikes


@pytest.mark.parametrize("even", [True, False])
def test_white_noise_is_measured_whatever_the_trend(even: bool):
    random = np.random.default_rng(0)
    t = np.arange(5000) / 100 if even else np.cumsum(random.uniform(0.001, 0.02, 5000))
    noise = 0.3 * random.standard_normal(5000)
    trend = 20 * np.exp(-t / 10) + 2 * t
    assert scatter(t, trend + noise) == pytest.approx(0.3, rel=0.04)
    assert estimate_robust_scatter(t, trend + noise) == pytest.approx(0.3, rel=0.06)
    assert scatter(t, 2 * t - 3) == pytest.approx(0.0, abs=1e-9)


def test_few_samples_have_no_scatter():
    assert scatter(np.arange(4.0), np.array([0.0, 1.0, 0.0, 1.0])) == 0.0
    assert estimate_robust_scatter(np.arange(4.0), np.array([0.0, 1.0, 0.0, 1.0])) == 0.0


@given(step=st.floats(1e-7, 1e-1), size=st.integers(5, 60))
def test_quantum_of_a_rounded_wave_is_recovered(step: float, size: int):
    wave = size * step * np.sin(np.arange(4000) / 500)
    assert find_quantum(np.round(wave / step) * step) == pytest.approx(step, rel=1e-6)


def test_what_is_smooth_or_constant_has_no_quantum():
    t = np.arange(4000) / 1000
    assert find_quantum(np.sin(t)) == 0.0
    assert find_quantum(np.zeros(100)) == 0.0


def test_a_perfect_ramp_is_not_taken_for_a_converter():
    t = np.arange(42000) / 1000
    ramp = 8e-3 * np.clip(t - 1.5, 0, 1)
    assert find_quantum(ramp) == 0.0
    assert find_quantum(np.round(ramp / 2e-5) * 2e-5) == pytest.approx(2e-5)


def test_a_lone_sample_is_a_spike_and_a_corner_is_none():
    t = np.arange(2000) / 100
    force = np.where(t < 5, 0.0, np.exp(-(t - 5) / 3)) + np.clip(t - 4, 0, 1) * (t < 5)
    force = force + 1e-3 * np.random.default_rng(0).standard_normal(2000)
    assert not spikes(t, force).any()
    hit = force.copy()
    hit[[100, 700, 1500]] += [3.0, -3.0, 3.0]
    assert list(np.flatnonzero(spikes(t, hit))) == [100, 700, 1500]
    np.testing.assert_allclose(remove_spikes(t, hit), force, atol=0.02)


def test_scatter_of_a_subsample_equals_that_of_neighbours():
    """The samples that are asked lie far apart; a wave between them is no scatter."""
    t = np.arange(1_000_000) / 1e4
    noise = np.random.default_rng(1).normal(0, 0.3, len(t))
    wave = 50 * np.sin(2 * np.pi * t)
    assert scatter(t, wave + noise) == pytest.approx(0.3, rel=0.01)
    assert scatter(t, wave) < 1e-4
