"""Hum: lines in the force, found and taken off before anything is fitted."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.datamodel.relaxation import Hum, RampHold
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.preprocessing.signal_conditioning import hum_lines
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER

TIME = np.arange(20_000) / 1000.0
DECAY = 1.5 + 0.3 * np.exp(-TIME / 0.5) + 0.1 * np.exp(-TIME / 9.0)


def noisy(seed: int, noise: float = 4e-3) -> np.ndarray:
    return DECAY + noise * np.random.default_rng(seed).standard_normal(len(TIME))


def lines_of(force: np.ndarray, *, noise: float) -> tuple[Hum, ...]:
    """Of a hold as long as it says, behind two seconds of something else."""
    time = np.concatenate((np.arange(-2000, 0) / 1000, TIME))
    lines, total, _ = hum_lines(time, force, slice(2000, 2000 + len(force)), noise=noise)
    np.testing.assert_array_equal(total, sum((line.force(time) for line in lines), 0 * time))
    return lines


def default(seed: int) -> RampHold:
    return prepare(simulate_relaxation(PAPER, seed=seed).test)


@pytest.mark.parametrize(("frequency", "alias"), [(50.0, 50.0), (37.3, 37.3), (1050.0, 50.0)])
def test_hum_lines_are_detected_at_their_alias(frequency: float, alias: float) -> None:
    hum = 3e-3 * np.sin(2 * np.pi * frequency * TIME + 0.4)
    (result,) = lines_of(noisy(0) + hum, noise=4e-3)
    assert result.frequency == pytest.approx(alias, abs=2e-3)
    assert result.amplitude == pytest.approx(3e-3, rel=0.05)
    np.testing.assert_allclose(result.force(TIME), hum, atol=3e-4)


def test_a_prime_number_of_samples_finds_the_same_line() -> None:
    hum = 3e-3 * np.sin(2 * np.pi * 37.3 * TIME + 0.4)
    (even,), (prime,) = (lines_of((noisy(0) + hum)[:n], noise=4e-3) for n in (20_000, 19_997))
    assert prime.frequency == pytest.approx(even.frequency, abs=1e-4)
    assert prime.amplitude == pytest.approx(even.amplitude, rel=1e-3)


def test_hum_lines_of_different_size_are_separated() -> None:
    lines = Hum(50.0, 20e-3, 0.0, 0.0), Hum(51.0, 0.0, 1e-3, 0.0)
    force = noisy(1) + sum(line.force(TIME) for line in lines)
    result = lines_of(force, noise=4e-3)
    assert [response.frequency for response in result] == pytest.approx([50.0, 51.0], abs=5e-3)


def test_noise_and_relaxation_are_no_hum() -> None:
    assert not any(lines_of(noisy(seed), noise=4e-3) for seed in range(40))
    assert not lines_of(DECAY, noise=0.0)
    slow = noisy(2) + 5e-3 * np.sin(2 * np.pi * 0.2 * TIME)
    assert not lines_of(slow, noise=4e-3)  # four swings in the hold: relaxation may bend so


def test_the_default_rig_is_fitted_to_its_noise() -> None:
    """Its hum and shaking, counted as noise, made every interval 1.6 times too wide."""
    test = default(seed=1)
    assert sorted(response.frequency for response in test.hum) == pytest.approx(
        [37.0, 50.0], abs=2e-3
    )
    assert test.force_noise == pytest.approx(4e-3, rel=0.03)
    result = fit(test, arms=2)
    assert result.estimate.residual.variance_inflation < 1.2
    quiet = prepare(simulate_relaxation(PAPER, seed=1, rig=Rig(hum=0.0, vibration=0.0)).test)
    alike = np.array(result.standard_error["k"]) / fit(quiet, arms=2).standard_error["k"]
    np.testing.assert_allclose(alike, 1.0, atol=0.1)


def test_prepare_keeps_the_raw_reading() -> None:
    raw = simulate_relaxation(PAPER, seed=2).test
    test = prepare(raw)
    np.testing.assert_allclose(np.diff(test.reading), np.diff(raw.force), atol=1e-12)
    assert "hum taken off the force" in test.steps[-1].message


@pytest.mark.once
@pytest.mark.parametrize("jitter", [0.0, 1e-5])
def test_a_line_is_its_cosine_and_its_sine_on_any_clock(jitter: float) -> None:
    time = 3.0 + np.arange(2000) / 500 + jitter * np.sin(np.arange(2000.0))
    phase = 2 * np.pi * 49.7 * (time - 1.0)
    line = Hum(49.7, 0.3, -0.4, 1.0).force(time)
    assert line == pytest.approx(0.3 * np.cos(phase) - 0.4 * np.sin(phase), abs=1e-11)
