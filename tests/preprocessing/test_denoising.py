"""The motion behind an encoder's counts and noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.denoising import (
    MAX_FLICKER_COUNTS,
    _estimate_count_noise,
    _remove_flicker,
    denoise_displacement,
    denoise_values,
    interpolate_counts,
)
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import BROAD


def test_the_staircase_of_an_encoder_is_read_between_its_counts() -> None:
    t = np.arange(0, 3.0, 1e-3)
    # a servo that eases in and out
    true = 8e-3 * np.clip(t - 0.5, 0, 1) ** 2 * (3 - 2 * np.clip(t - 0.5, 0, 1))
    counted = np.round(true / 2e-5) * 2e-5
    read = interpolate_counts(t, counted, 2e-5)
    moving = (t > 0.6) & (t < 1.4)
    assert np.std((counted - true)[moving]) > 5e-6
    assert np.std((read - true)[moving]) < 3e-6
    assert np.abs(read - true).max() < 1.2e-5
    assert read[-1] == counted[-1]
    assert read[0] == counted[0]


def test_a_turn_within_a_count_is_doubtful_and_a_steady_motion_is_not() -> None:
    count, t = 2e-5, np.arange(0, 2.0, 1e-3)
    counted = np.round(4e-3 * (1 - np.abs(t - 1)) / count) * count
    noise = _estimate_count_noise(t, counted, count)
    steady = (np.abs(t - 1) > 0.05) & (np.abs(t - 1) < 0.9)
    assert noise[steady] == pytest.approx(noise[500], rel=1e-9)
    # at the turn the velocity changes by 8 mm/s while a reading stays
    assert noise[1000] > 2 * noise[500]


def test_a_constant_reading_stays_constant() -> None:
    flat = np.full(50, 3e-3)
    assert (interpolate_counts(np.arange(50.0), flat, 2e-5) == flat).all()


def test_a_flicker_of_the_reading_is_no_motion() -> None:
    t = np.arange(0, 3.0, 1e-3)
    true = 8e-3 * np.clip(t - 0.5, 0, 1)
    shaken = true + 5e-6 * np.random.default_rng(2).standard_normal(len(t))
    counted = np.round(shaken / 2e-5) * 2e-5
    held = t > 1.6
    assert np.std(counted[held]) > 3e-6
    read = interpolate_counts(t, counted, 2e-5)
    assert np.std(read[held]) < 1e-7
    assert np.std((read - true)[(t > 0.55) & (t < 1.45)]) < 4e-6


@pytest.mark.parametrize("hertz", [5.0, 15.0, 25.0])
def test_the_top_of_a_swing_is_no_flicker(hertz: float) -> None:
    """A servo's overshoot at 250 Hz: the median of seven readings took 21 um off its top."""
    t = np.arange(0, 2.0, 4e-3)
    true = 7e-3 + 1e-4 * np.exp(-3 * t) * np.sin(2 * np.pi * hertz * t)
    read = interpolate_counts(t, np.round(true / 1e-6) * 1e-6, 1e-6)
    off = np.abs(read - true)[3:-3]
    assert off[:100].max() < 2e-6  # while the swing is large
    assert off.max() < 3.5e-6


@pytest.mark.parametrize(("counts", "retained"), [(1, False), (MAX_FLICKER_COUNTS + 0.5, True)])
def test_flicker_of_one_count_is_removed(counts: float, retained: bool) -> None:
    values = np.zeros(21)
    values[10] = counts * 1e-6
    assert bool(_remove_flicker(values, 1e-6)[10]) is retained


def test_the_running_median_is_that_of_seven_neighbours() -> None:
    """Exchanges that order every row of noughts and ones order every row (D. E. Knuth)."""
    bits = (np.arange(128)[:, None] >> np.arange(7) & 1).astype(float).ravel()
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(bits, 3, mode="edge"), 7)
    np.testing.assert_array_equal(_remove_flicker(bits, 1.0), np.median(windows, axis=1))


def test_noise_is_averaged_where_the_motion_is_straight() -> None:
    t = np.arange(0, 10.0, 1e-3)
    true = 8e-3 * np.clip(t - 0.5, 0, 1)
    seen = true + 5e-6 * np.random.default_rng(1).standard_normal(len(t))
    read, sd = denoise_values(seen, 5e-6)
    off = read - true
    assert np.std(off[(t > 3) & (t < 9)]) < 0.3e-6  # the hold
    assert np.std(off[(t > 0.7) & (t < 1.3)]) < 1e-6  # the ramp
    corner = np.abs(t - 0.5) < 0.05
    assert np.abs(off[corner]).max() < 4 * 5e-6  # no rounder than the noise hides
    assert np.mean(sd[(t > 3) & (t < 9)] < 0.2e-6) > 0.95
    assert np.mean(np.abs(off) < 4 * sd) > 0.9


@settings(max_examples=20, deadline=None)
@given(slope=st.floats(-5, 5), start=st.floats(-5, 5))
def test_a_straight_line_stays_straight(slope: float, start: float) -> None:
    line = start + slope * np.arange(300.0)
    read, _ = denoise_values(line, 0.1)
    assert read == pytest.approx(line, abs=1e-9)


def test_what_is_larger_than_the_noise_stays() -> None:
    step = np.where(np.arange(400) < 200, 0.0, 1.0)
    assert denoise_values(step, 1e-3)[0] == pytest.approx(step)


def test_denoise_displacement_returns_a_perfect_encoder_unchanged() -> None:
    rig = replace(Rig(), encoder=0.0, position_noise=0.0)
    held = prepare(simulate_relaxation(BROAD, rig=rig).test)
    x, sd = denoise_displacement(replace(held, displacement_noise=0.0))
    assert (x == held.displacement[: len(x)]).all()
    assert (sd == 0).all()


def test_a_noisy_encoder_spoils_the_fit_and_denoising_mends_it() -> None:
    """Errors in variables: 10 um of noise makes the arms unrecognisable."""
    rig = replace(Rig(), encoder=0.0, position_noise=1e-5)
    held = prepare(simulate_relaxation(BROAD, seed=0, rig=rig).test)
    x, _ = denoise_displacement(held)
    clean = fit(replace(held, displacement=np.append(x, held.displacement[len(x) :])), arms=3)
    # the slow arms are Table 1's
    assert clean.model.tau[1:] == pytest.approx((0.502, 16.4), rel=0.05)
    assert clean.model.k[1:] == pytest.approx((117.5, 17.8), rel=0.05)
    assert clean.estimate.residual.rms < 4.7e-3
