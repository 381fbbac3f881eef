"""Covariance under correlated noise against simulation, and Student's t against SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from dashpot.base.student_t import t_quantile
from dashpot.numerics.inference.correlated_noise import (
    Noise,
    ResidualSeries,
    autocovariance,
    compute_initial_sequence,
    estimate_noise,
    geyer_cut,
    make_directions,
    noise_gain_ratio,
    sandwich,
    white,
)


def autoregressive(rng: np.random.Generator, n: int, rho: float) -> np.ndarray:
    steps = rng.standard_normal(n) * np.sqrt(1 - rho**2)
    values = np.empty(n)
    value = rng.standard_normal()
    for i in range(n):
        value = rho * value + steps[i]
        values[i] = value
    return values


def test_autocovariance_is_the_plain_sum() -> None:
    r = np.random.default_rng(1).standard_normal(137)
    plain = [r[: len(r) - lag] @ r[lag:] / len(r) for lag in range(len(r))]
    np.testing.assert_allclose(autocovariance(r), plain, atol=1e-14)
    np.testing.assert_allclose(autocovariance(r, 20), plain[:20], atol=1e-14)


@pytest.mark.parametrize(("cycles", "late"), [(0.2, True), (0.4, True), (3.0, False)])
def test_autocovariance_correction_is_independent_of_the_cutoff(cycles: float, late: bool) -> None:
    """Three rounds of the plain sums, whether or not a third of the lags shows the cut."""
    n = 400
    wave = np.sin(2 * np.pi * cycles * np.arange(n) / n)
    residual = wave - wave.mean()
    gamma = autocovariance(residual)
    taken = 1.0 - np.arange(n) / n  # of a constant, whose column of Q is 1 / sqrt(n)
    retained = gamma[: geyer_cut(gamma)]
    for _ in range(3):
        kappa = max(1.0, 2.0 * retained.sum() / retained[0] - 1.0)
        inputs = gamma + gamma[0] * min(kappa, n / 2.0) * taken / n
        retained = inputs[: geyer_cut(inputs)]
    assert (len(retained) > n // 3) is late
    noise = estimate_noise(residual, np.ones((n, 1)))
    np.testing.assert_allclose(noise.autocovariance, retained, atol=1e-12)


def test_the_cut_stops_where_a_pair_of_lags_falls_to_zero() -> None:
    assert geyer_cut(np.array([1.0, 0.5, 0.2, 0.1, -0.2, 0.1, 0.5, 0.5])) == 4
    assert geyer_cut(np.array([1.0, -2.0, 0.0, 0.0])) == 1
    assert geyer_cut(np.array([1.0, 0.5, 0.4, 0.3])) == 4


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.95, 0.999])
@pytest.mark.parametrize("n", [1, 2, 3, 4, 50, 5000])
def test_lag_by_lag_is_the_sequence_up_to_its_cut(n: int, memory: float) -> None:
    noise = autoregressive(np.random.default_rng(n), n, memory)
    whole = autocovariance(noise)
    result, _ = compute_initial_sequence(noise)
    np.testing.assert_allclose(result, whole[: geyer_cut(whole)], atol=1e-13)


def test_kappa_of_white_and_of_autoregressive_noise() -> None:
    rng = np.random.default_rng(2)
    assert estimate_noise(rng.standard_normal(20_000)).kappa == pytest.approx(1.0, abs=0.1)
    rho = 0.9
    noise = estimate_noise(autoregressive(rng, 100_000, rho))
    assert noise.kappa == pytest.approx((1 + rho) / (1 - rho), rel=0.15)
    assert noise.durbin_watson == pytest.approx(2 * (1 - rho), rel=0.05)
    assert noise.effective == pytest.approx(100_000 / noise.kappa)


def test_a_wander_lost_in_the_scatter_shows_in_means() -> None:
    """A tenth of the scatter that remembers 500 samples: eleven times the power at slow arms."""
    n, memory, share = 20_000, 500, 0.1
    result, outcome = [], []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        scatter, decay = rng.standard_normal(n), np.exp(-1 / memory)
        steps = rng.standard_normal(2 * n) * np.sqrt(1 - decay**2)
        wander = lfilter([1.0], [1.0, -decay], steps)[n:]
        result.append(estimate_noise(scatter + share * wander).power)
        outcome.append(estimate_noise(scatter).power)
    assert np.median(result) == pytest.approx(1 + 2 * share**2 * memory, rel=0.35)
    assert np.mean(np.array(result) > 3) > 0.9
    assert np.mean(np.array(outcome) < 1.3) > 0.95


def test_means_that_show_nothing_leave_the_correlations_of_neighbours() -> None:
    rng = np.random.default_rng(3)
    noise = estimate_noise(autoregressive(rng, 5000, 0.6))
    assert len(noise.autocovariance) < 100
    assert noise.kappa == pytest.approx(4.0, rel=0.25)


def test_white_noise_scales_by_n_less_p() -> None:
    r = np.random.default_rng(3).standard_normal(50)
    noise = estimate_noise(r, np.random.default_rng(4).standard_normal((50, 5)))
    assert noise.autocovariance[0] == pytest.approx(r @ r / 45, rel=0.02)


@pytest.mark.parametrize(("records", "shared"), [(6, True), (1, False)])
def test_autocovariance_correction_counts_shared_parameters_once(
    records: int, shared: bool
) -> None:
    """White noise in short records of a common cubic: four residuals are lost, not four of each."""
    n, powers, kappas = 240 // records, [], []
    for seed in range(300):
        x = np.random.default_rng(seed).uniform(-1, 1, 240)
        J = x[:, None] ** np.arange(4)
        r = np.random.default_rng(seed + 1000).standard_normal(240)
        residual = r - J @ np.linalg.lstsq(J, r, rcond=None)[0]
        expected = make_directions(np.split(J, records), is_shared=shared)
        noises = [
            estimate_noise(part, columns)
            for part, columns in zip(np.split(residual, records), expected.columns, strict=True)
        ]
        powers += [noise.autocovariance[0] for noise in noises]
        kappas += [noise.kappa for noise in noises]
        assert sum(columns.absorbed_count for columns in expected.columns) == pytest.approx(4)
        assert n == noises[0].samples
    assert np.mean(powers) == pytest.approx(1.0, rel=0.03)
    # chance alone lets short records look correlated
    assert np.median(kappas) < 1.25


def test_directions_shared_with_the_covariance_take_the_same_from_the_noise() -> None:
    rng = np.random.default_rng(8)
    time = np.linspace(0.0, 40.0, 4000)
    jacobian = np.stack((np.ones(4000), np.exp(-time / 2), time * np.exp(-time / 2)), axis=1)
    expected = make_directions([jacobian, np.diag([1e-3, 2.0, 5.0])])
    covariance = sandwich([jacobian[:, :2]], [Noise(4000, 0.9 ** np.arange(200), 19.0, 0.2)])
    shared = make_directions([jacobian[:, :2]])
    residual = ResidualSeries(autoregressive(rng, 4000, 0.98))
    noise = estimate_noise(residual.values, jacobian)
    # a residual that was asked already, without columns, answers as a new one
    assert len(estimate_noise(residual).autocovariance) < len(noise.autocovariance)
    result = estimate_noise(residual, expected.columns[0])
    np.testing.assert_allclose(result.autocovariance, noise.autocovariance, rtol=1e-9)
    assert result.kappa > 20.0
    # transforms once padded for many lags serve few
    shared.columns[0].spectra(8000)
    again = sandwich(shared, [Noise(4000, 0.9 ** np.arange(200), 19.0, 0.2)])
    np.testing.assert_allclose(again, covariance, rtol=1e-9)


def test_rounding_is_not_noise() -> None:
    ripple = 1e-16 * np.sin(np.linspace(0, 3, 1000))
    assert estimate_noise(ripple).kappa > 100
    assert estimate_noise(ripple, rounding=1e-12).kappa == 1.0
    assert estimate_noise(np.zeros(10)).kappa == 1.0


def test_sandwich_of_white_noise_is_the_textbook_covariance() -> None:
    jacobian = np.random.default_rng(4).standard_normal((200, 3))
    noise = Noise(200, np.array([0.3]), 1.0, 2.0)
    textbook = 0.3 * np.linalg.inv(jacobian.T @ jacobian)
    np.testing.assert_allclose(sandwich([jacobian], [noise]), textbook, rtol=1e-12)
    np.testing.assert_allclose(white(jacobian, 0.3), textbook, rtol=1e-12)


def test_sandwich_is_the_dense_toeplitz_form() -> None:
    rng = np.random.default_rng(5)
    jacobian = np.cumsum(rng.standard_normal((150, 3)), axis=0)
    gamma = 0.8 ** np.arange(12)
    lag = np.abs(np.subtract.outer(np.arange(150), np.arange(150)))
    toeplitz = np.where(lag < 12, gamma[np.minimum(lag, 11)], 0.0)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    dense = inverse @ jacobian.T @ toeplitz @ jacobian @ inverse
    covariance = sandwich([jacobian], [Noise(150, gamma, 9.0, 0.4)])
    np.testing.assert_allclose(covariance, dense, rtol=2e-2)


@pytest.mark.parametrize("lags", [2, 5, 8, 9])
def test_the_noise_of_few_lags_is_the_dense_toeplitz_form(lags: int) -> None:
    jacobian = np.cumsum(np.random.default_rng(5).standard_normal((150, 3)), axis=0)
    gamma = 1.0 - np.arange(lags) / lags  # of means over so many white values
    lag = np.abs(np.subtract.outer(np.arange(150), np.arange(150)))
    toeplitz = np.maximum(1.0 - lag / lags, 0.0)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    dense = inverse @ jacobian.T @ toeplitz @ jacobian @ inverse
    covariance = sandwich([jacobian], [Noise(150, gamma, 1.0, 2.0)])
    np.testing.assert_allclose(covariance, dense, rtol=1e-9)


def test_covariance_is_robust_to_a_nearly_undetermined_parameter() -> None:
    """A slow arm beside a spring and a drift: their sum is known, and so are all other arms."""
    time = np.linspace(0, 1, 20_000)
    decays = np.exp(-time[:, None] / np.array([0.01, 0.03, 0.1, 0.3, 30.0]))
    jacobian = np.column_stack((np.ones_like(time), time, decays))
    steps = np.cumsum(np.random.default_rng(1).standard_normal((5, len(time))), axis=1)
    noise = Noise(len(time), np.array([2.0, 0.5]), 1.5, 1.5)
    covariance = sandwich([jacobian], [noise], other_columns=[lambda columns: steps @ columns])
    orthonormal, triangle = np.linalg.qr(jacobian)
    shifted, variant = orthonormal[1:].T @ orthonormal[:-1], steps @ orthonormal
    middle = 2.0 * np.eye(7) + 0.5 * (shifted + shifted.T) + variant.T @ variant
    expected = np.linalg.solve(triangle, np.linalg.solve(triangle, middle).T)
    size = np.sqrt(np.diag(expected))
    assert size[0] > 1e3 * size[3]
    assert np.linalg.eigvalsh(covariance / np.outer(size, size))[0] > -1e-12
    np.testing.assert_allclose(covariance, expected, rtol=1e-8)


def test_covariance_uses_the_noise_of_each_record() -> None:
    rng = np.random.default_rng(6)
    quiet, met = rng.standard_normal((2, 100, 2))
    noises = [Noise(100, np.array([0.01]), 1.0, 2.0), Noise(100, np.array([4.0]), 1.0, 2.0)]
    h = np.linalg.inv(quiet.T @ quiet + met.T @ met)
    expected = h @ (0.01 * quiet.T @ quiet + 4.0 * met.T @ met) @ h
    np.testing.assert_allclose(sandwich([quiet, met], noises), expected, rtol=1e-12)


def test_what_the_data_do_not_determine_is_infinitely_uncertain() -> None:
    column = np.random.default_rng(7).standard_normal(100)
    other = np.random.default_rng(8).standard_normal(100)
    jacobian = np.column_stack((column, 2 * column, other, 0 * other))
    covariance = white(jacobian, 1.0)
    assert np.isinf(np.diag(covariance)[[0, 1, 3]]).all()
    swept = other - column * (column @ other) / (column @ column)
    assert covariance[2, 2] == pytest.approx(1 / (swept @ swept))


def test_intervals_of_a_mean_cover_under_correlated_noise() -> None:
    """The mean of AR(1) noise, 400 seeds: naive intervals miss, the sandwich's cover."""
    rng = np.random.default_rng(9)
    column = np.ones((2000, 1))
    hits, naive_hits = 0, 0
    for _ in range(400):
        r = autoregressive(rng, 2000, 0.9)
        mean = r.mean()
        noise = estimate_noise(r - mean, column)
        error = np.sqrt(sandwich([column], [noise])[0, 0])
        hits += abs(mean) < t_quantile(0.95, noise.effective - 1.0) * error
        naive_hits += abs(mean) < 1.96 * r.std() / np.sqrt(2000)
    assert 0.92 <= hits / 400 <= 0.98
    assert naive_hits / 400 < 0.6


@pytest.mark.parametrize("dof", [1.0, 1.5, 2.0, 7.3, 46.0, 199.0, 201.0, 4e4, 1e6])
@pytest.mark.parametrize("level", [0.5, 0.6827, 0.95, 0.99, 0.999])
def test_student_quantile_is_scipys(dof: float, level: float) -> None:
    from scipy.stats import t

    assert t_quantile(level, dof) == pytest.approx(t.ppf(0.5 + level / 2, dof), rel=1e-7)


def test_t_quantile_is_infinite_for_less_than_one_degree_of_freedom() -> None:
    assert t_quantile(0.95, 0.5) == np.inf
    assert t_quantile(0.95, -3.0) == np.inf
    assert t_quantile(0.95, np.inf) == pytest.approx(1.959963985, rel=1e-6)


def test_white_noise_is_even_and_slow_noise_is_not() -> None:
    """The dense eigenvalues of (J'J)^-1 J' Gamma J, whatever the columns' units."""
    t = np.linspace(0.0, 1.0, 400)
    jacobian = np.exp(-t[:, None] / [0.02, 0.2, 2.0]) * [1.0, 1e3, 1e-3]

    def ratio(columns: np.ndarray, noise: Noise) -> float:
        expected = make_directions([columns])
        return noise_gain_ratio(expected, [expected.compute_record_gain(0, noise)])

    assert ratio(jacobian, Noise(400, np.array([0.5]), 1.0, 2.0)) == pytest.approx(1.0)
    gamma = 0.97 ** np.arange(200) - 0.97**200
    lag = np.abs(np.arange(400)[:, None] - np.arange(400))
    toeplitz = np.where(lag < 200, gamma[np.minimum(lag, 199)], 0.0)
    basis = np.linalg.qr(jacobian)[0]
    shares = np.linalg.eigvalsh(basis.T @ toeplitz @ basis)
    noise = Noise(400, gamma, 60.0, 0.06)
    assert ratio(jacobian, noise) == pytest.approx(shares[-1] / shares[0], rel=1e-6)
    assert shares[-1] > 5 * shares[0]
    assert ratio(np.zeros((400, 2)), noise) == 1.0
