"""Data in the metric of their noise, against dense generalised least squares."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import toeplitz

from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block, build_recorded_block
from dashpot.numerics.exponential_fit import compute_full_jacobian, solve
from dashpot.numerics.inference import correlated_noise
from dashpot.numerics.inference.correlated_noise import (
    ROWS_PER_BATCH,
    Noise,
    NoiseGain,
    compute_averaging_length,
    compute_blockwise_qr,
    whitened_block,
)

STEP = 0.02
TIME = STEP * np.arange(600)
TAU = np.array([0.4, 3.0])
K = np.array([120.0, 40.0])
DEPTH, RAMP = 8e-3, 1.0


@pytest.mark.parametrize("rows", [3, 7, ROWS_PER_BATCH, ROWS_PER_BATCH + 1, 3 * ROWS_PER_BATCH + 9])
def test_a_factor_by_pieces_is_a_factor(rows: int) -> None:
    tall = np.random.default_rng(rows).standard_normal((rows, 7))
    basis, factor = compute_blockwise_qr(tall)
    np.testing.assert_allclose(basis @ factor, tall, atol=1e-12)
    np.testing.assert_allclose(basis.T @ basis, np.eye(min(rows, 7)), atol=1e-12)


def make_hold_block(noise: np.ndarray | float = 0.0) -> DataBlock:
    """Eq. 5 on a hold of 12 s, every sample a row."""
    mean = TAU / RAMP * -np.expm1(-RAMP / TAU)
    force = DEPTH * (200.0 + np.exp(-TIME[:, None] / TAU) @ (K * mean))
    return build_hold_block(TIME, force + noise, depth=DEPTH, ramp_time=RAMP, compress=False)


def make_recorded_block(noise: np.ndarray | float = 0.0) -> DataBlock:
    """A ramp and hold by its recorded motion, with a tare and a drift."""
    x = DEPTH * np.clip(TIME / RAMP, 0.0, 1.0)
    columns = build_recorded_block(TIME, x, 0 * TIME).exact.evaluate(np.log(TAU))
    force = 200.0 * x + columns.arms @ K
    return build_recorded_block(TIME, x, force + noise, offset="offset", drift="drift").exact


def slow(correlation: float, variance: float = 1e-4) -> Noise:
    """Autoregressive noise with this correlation time, s, given by its autocovariance."""
    rho = float(np.exp(-STEP / correlation))
    gamma = variance * rho ** np.arange(len(TIME))
    return Noise(len(TIME), gamma, (1 + rho) / (1 - rho), 2 * (1 - rho))


def white(variance: float = 1e-4) -> Noise:
    return Noise(len(TIME), np.array([variance]), 1.0, 2.0)


@pytest.mark.parametrize("make", [make_hold_block, make_recorded_block])
def test_in_the_metric_of_white_noise_the_fit_is_least_squares(
    make: Callable[[np.ndarray], DataBlock],
) -> None:
    exact = make(1e-2 * np.random.default_rng(0).standard_normal(len(TIME)))
    block = whitened_block(exact, white())
    plain = [solve([exact], n) for n in (0, 1, 2)]
    metric = [solve([block], n) for n in (0, 1, 2)]
    for item, other in zip(plain, metric, strict=True):
        np.testing.assert_allclose(item.log_tau, other.log_tau, atol=1e-6)
        np.testing.assert_allclose(item.fixed, other.fixed, rtol=1e-6, atol=1e-8)
    falls = -np.diff([element.sse for element in plain]) / 1e-4
    np.testing.assert_allclose(-np.diff([element.sse for element in metric]), falls, rtol=1e-6)


def test_the_columns_are_those_of_the_record_at_any_relaxation_time() -> None:
    """In the metric of unit white noise the inner products are the record's own."""
    exact = make_recorded_block()
    block = whitened_block(exact, white(1.0))
    at = np.log([0.05, 0.17, 0.9, 4.4, 30.0, 100.0])
    mine, theirs = block.evaluate(at), exact.evaluate(at)
    for value, other in ((mine.arms, theirs.arms), (mine.d_arms, theirs.d_arms)):
        scale = np.sqrt(np.diag(other.T @ other))
        difference = (value.T @ value - other.T @ other) / np.outer(scale, scale)
        assert np.abs(difference).max() < 1e-6
    np.testing.assert_allclose(mine.target @ mine.arms, theirs.target @ theirs.arms, rtol=1e-6)


@pytest.mark.parametrize(("make", "better"), [(make_hold_block, 1.5), (make_recorded_block, 1.0)])
def test_whitened_block_has_the_errors_of_generalised_least_squares(
    make: Callable[[], DataBlock], better: float
) -> None:
    """The dense inverse of Gamma: nothing is gained, and no more than a tenth is lost."""
    exact, noise = make(), slow(0.5)
    solution = solve([exact], 2)
    block = whitened_block(exact, noise)
    jacobian = compute_full_jacobian([exact], solution).matrix
    best = np.linalg.inv(jacobian.T @ np.linalg.solve(toeplitz(noise.autocovariance), jacobian))
    weighted = compute_full_jacobian([block], solution).matrix
    mine = np.linalg.inv(weighted.T @ weighted)
    loss = np.sqrt(np.diag(mine) / np.diag(best))
    assert np.all(loss > 1 - 1e-6)
    assert np.all(loss < 1.1)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    plain = inverse @ jacobian.T @ toeplitz(noise.autocovariance) @ jacobian @ inverse
    # on a hold, plain least squares knows far less of the fast arm
    fast = len(block.fixed_names)
    assert plain[fast, fast] > better * mine[fast, fast]


def test_averaging_length_follows_the_noise_of_each_record() -> None:
    """Against the dense form, under slow noise and beside it white: means of 4 and of 1."""
    records, noises = [make_hold_block(), make_recorded_block()], [slow(8.0), white()]
    assert [compute_averaging_length(noise) for noise in noises] == [4, 1]
    solution = solve(records, 2)
    gain = NoiseGain(records, noises, solution)
    jacobian = compute_full_jacobian(records, solution).matrix
    rows = np.split(np.arange(len(jacobian)), [len(TIME)])
    for step in np.eye(jacobian.shape[1]):
        change, met = jacobian @ step, 0.0
        for part, noise in zip(rows, noises, strict=True):
            gamma = np.zeros(len(TIME))
            gamma[: len(noise.autocovariance)] = noise.autocovariance
            met += change[part] @ toeplitz(gamma) @ change[part]
        assert gain.compute_step_gain(step) == pytest.approx(met / (change @ change), rel=0.05)


@pytest.mark.parametrize("make", [make_hold_block, make_recorded_block])
@pytest.mark.parametrize(("correlation", "few", "most"), [(0.5, 1, 1.0), (2, 2, 1.02), (8, 4, 1.3)])
def test_averaging_of_neighbours_loses_little_information(
    make: Callable[[], DataBlock],
    correlation: float,
    few: int,
    most: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Noise up to twenty times as slow as the fast arm, of 20 samples, which loses most."""
    exact, noise = make(), slow(correlation)
    solution = solve([exact], 2)

    def errors() -> np.ndarray:
        jacobian = compute_full_jacobian([whitened_block(exact, noise)], solution).matrix
        return np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))

    as_it_is = errors()
    assert compute_averaging_length(noise) == few
    monkeypatch.setattr(correlated_noise, "compute_averaging_length", lambda _: 1)
    assert np.all(as_it_is <= most * errors() * (1 + 1e-9))


@given(
    correlation=st.floats(0.03, 3.0),
    ripple=st.floats(0.0, 20.0),
)
def test_no_direction_is_trusted_better_than_under_white_noise(
    correlation: float, ripple: float
) -> None:
    """However little a filter left above its cut-off, and whatever hum there is below."""
    lag = STEP * np.arange(len(TIME))
    gamma = 1e-4 * np.exp(-0.5 * (lag / correlation) ** 2) * np.cos(ripple * lag)
    exact = make_hold_block()
    block = whitened_block(exact, Noise(len(TIME), gamma, 1.0, 2.0))
    at = np.log(np.array([0.05, 0.4, 3.0, 20.0]))
    mine = block.evaluate(at, derivative=False).arms
    theirs = exact.evaluate(at, derivative=False).arms
    excess = np.linalg.eigvalsh(mine.T @ mine - theirs.T @ theirs / 1e-4)
    assert excess.max() <= 1e-6 * np.sum(theirs**2) / 1e-4


@pytest.mark.parametrize("make", [make_hold_block, make_recorded_block])
def test_the_noise_that_meets_a_change_is_its_dense_quadratic_form(
    make: Callable[[], DataBlock],
) -> None:
    exact, noise = make(), slow(0.5)
    solution = solve([exact], 2)
    noise_gain = NoiseGain([exact], [noise], solution)
    jacobian = compute_full_jacobian([exact], solution).matrix
    dense = toeplitz(noise.autocovariance)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    for step in inverse:
        change = jacobian @ step
        assert noise_gain.compute_step_gain(step) == pytest.approx(
            change @ dense @ change / (change @ change), rel=0.02
        )
    beta, log_tau = solution.beta, solution.log_tau
    before = exact.evaluate(log_tau)
    for shift in np.array([[0.0, 1.2], [0.4, 0.0], [-0.3, -0.5]]):
        variant = log_tau + shift
        after = exact.evaluate(variant)
        change = np.concatenate((after.fixed - before.fixed, after.arms - before.arms), axis=1)
        change = change @ beta
        assert noise_gain.evaluate(beta, variant) == pytest.approx(
            change @ dense @ change / (change @ change), rel=0.02
        )


def test_white_noise_meets_every_change_alike() -> None:
    exact = make_hold_block(1e-2 * np.random.default_rng(1).standard_normal(len(TIME)))
    solution = solve([exact], 2)
    noise_gain = NoiseGain([exact], [white(0.3)], solution)
    assert noise_gain.compute_step_gain(np.array([1.0, -2.0, 0.3, 0.1, 0.7])) == pytest.approx(0.3)
    assert noise_gain.evaluate(1.1 * solution.beta, solution.log_tau + 0.2) == pytest.approx(0.3)


def test_the_fall_of_the_deviance_under_slow_noise_is_chance() -> None:
    """One arm more than the truth, 60 seeds: half the falls are next to nothing, none convinces."""
    rho = float(np.exp(-STEP / 0.5))
    rng = np.random.default_rng(3)
    falls = []
    for _ in range(60):
        drawn = np.sqrt(1 - rho**2) * rng.standard_normal(len(TIME))
        drawn[0] /= np.sqrt(1 - rho**2)
        for i in range(1, len(TIME)):
            drawn[i] += rho * drawn[i - 1]
        block = whitened_block(make_hold_block(1e-2 * drawn), slow(0.5))
        falls.append(solve([block], 2).sse - solve([block], 3).sse)
    assert np.median(falls) < 1.0
    assert max(falls) < 11.83
