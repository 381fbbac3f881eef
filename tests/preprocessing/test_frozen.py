"""Detection of frozen readings, distinguished from converter steps and noiseless simulations."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.datamodel.relaxation import find_quantum
from dashpot.signals.stuck_channel import find_stuck_runs

TIME = np.arange(8000) / 200.0
DECAY = 1.5 + 0.1 * np.exp(-TIME / 8) + 0.2 * np.exp(-TIME / 0.5)


def read(noise: float, count: float, seed: int = 0) -> np.ndarray:
    values = DECAY + noise * np.random.default_rng(seed).standard_normal(len(TIME))
    return np.round(values / count) * count if count else values


@given(
    ratio=st.floats(0.0, 8.0), count=st.sampled_from([1e-4, 1e-3, 4e-3, 2e-2]), seed=st.integers(0)
)
def test_frozen_runs_accepts_converter_noise(ratio: float, count: float, seed: int):
    values = read(ratio * count, count, seed % 2**32)
    assert len(find_stuck_runs(values, time_since_ramp=TIME)) == 0


@pytest.mark.parametrize("tau", [0.02, 0.2, 2.0, 20.0])
def test_frozen_runs_accepts_a_noiseless_simulation_at_rest(tau):
    values = 1.0 + 0.3 * np.exp(-TIME / tau)
    assert len(find_stuck_runs(values, time_since_ramp=TIME)) == 0
    assert len(find_stuck_runs(np.ones(8000), time_since_ramp=TIME)) == 0


@given(
    noise=st.sampled_from([0.6, 1.0, 2.0, 5.0]),
    count=st.sampled_from([0.0, 1e-3]),
    first=st.integers(200, 7000),
    length=st.integers(150, 4000),
)
def test_frozen_runs_detects_a_freeze_with_its_ends(noise, count, first, length):
    values = read(1e-3 * noise, count)
    last = min(first + length, len(values)) - 1
    values[first : last + 1] = values[first]
    index_array = find_stuck_runs(values, time_since_ramp=TIME)
    assert len(index_array) == 1
    # a neighbour may happen to read the same
    assert np.abs(index_array[0] - (first, last)).max() <= 5


def test_frozen_runs_detects_a_noiseless_channel_that_stops():
    values = read(0.0, 0.0)
    values[3000:] = values[3000]
    np.testing.assert_array_equal(find_stuck_runs(values, time_since_ramp=TIME), [[3000, 7999]])


def test_a_leap_after_equal_readings_is_a_fault_only_at_rest():
    values = read(0.0, 1e-3)
    # on .5 s of 40 s it changes by counts
    values[20:60] = values[20]
    assert find_stuck_runs(values).tolist() == [[20, 59]]
    driven = np.zeros(len(values), dtype=bool)
    assert len(find_stuck_runs(values, is_at_rest=driven)) == 0


@pytest.mark.parametrize("rate", [10, 20, 50, 250])
@pytest.mark.parametrize(
    "knots",
    [
        ((0, 0), (1, 0), (2, 2), (12, 2), (13, 4), (23, 4), (24, 2), (40, 2)),
        ((0, 0), (1, 0), (3, 4), (4, 8), (44, 8)),
        ((0, 0), (1, 0), (2, 8), (3, 0), (5, 0), (6, 8), (46, 8)),
    ],
)
def test_a_path_as_it_was_sent_is_in_no_counts(knots, rate):
    time = np.arange(0, knots[-1][0], 1 / rate)
    path = np.interp(time, *np.array(knots, dtype=float).T)
    assert find_quantum(1e-3 * path) <= 0.003 * 1e-3 * path.max()
    # behind a converter it is: .0371 mm divides no step of it
    if rate == 250:
        counted = np.round(path / 0.0371) * 0.0371
        assert find_quantum(counted) == pytest.approx(0.0371, rel=1e-6)
