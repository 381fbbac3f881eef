"""A recorded displacement: the recursion is exact, and the correlation form is the recursion."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError, FitError
from dashpot.numerics.design_matrices import displacement_correlation
from dashpot.numerics.design_matrices.block import DelayedForce, Evaluation
from dashpot.numerics.design_matrices.displacement_correlation import (
    Force,
    correlate_displacement,
    upper_factor,
)
from dashpot.numerics.design_matrices.recorded_motion import (
    build_recorded_block,
    compute_arm_columns,
)
from dashpot.numerics.exponential_fit import Solution, certificate, solve, solve_orders
from dashpot.solids.maxwell import arm_response

TIME = np.arange(6001) / 150
GENERATOR = np.random.default_rng(5)


def ramp_hold() -> np.ndarray:
    x = 8e-3 * np.minimum(TIME, 1.0) + GENERATOR.normal(0, 1e-6, len(TIME))
    x[0] = 0
    return x


def steps_and_chirp() -> np.ndarray:
    x = 3e-3 * np.minimum(TIME, 0.7) + 2e-3 * np.clip(TIME - 12, 0, 1.3)
    return x + 2e-4 * np.sin(2 * np.pi * (0.1 + 0.05 * TIME) * TIME) * (TIME > 20)


HISTORIES = {"ramp and hold": ramp_hold(), "steps and chirp": steps_and_chirp()}
ARMS = {
    1: ([80.0], [3.0]),
    2: ([117.5, 17.8], [0.5021, 16.416]),
    3: ([90.0, 60.0, 40.0], [0.25, 2.0, 18.0]),
    4: ([90.0, 80.0, 60.0, 50.0], [0.1, 0.6, 3.0, 18.0]),
}


def force_of(x: np.ndarray, arms: int, *, sd: float = 5e-3, time: np.ndarray = TIME) -> np.ndarray:
    k, tau = ARMS[arms]
    total = 196.5 * x
    for stiffness, t in zip(k, tau, strict=True):
        total = total + stiffness * arm_response(time, x, t)
    return total + sd * np.random.default_rng(arms).standard_normal(len(x))


def same(solution: Solution, full: Solution) -> None:
    assert solution.sse == pytest.approx(full.sse, rel=1e-9)
    np.testing.assert_allclose(solution.log_tau, full.log_tau, atol=1e-8)
    np.testing.assert_allclose(solution.arms, full.arms, rtol=1e-8)
    np.testing.assert_allclose(solution.fixed, full.fixed, rtol=1e-6, atol=1e-8)


def test_columns_are_boltzmann_superposition() -> None:
    """Every straight segment of displacement adds its own ramp and hold."""
    time = np.cumsum(GENERATOR.uniform(0.01, 0.2, 60))
    x = np.concatenate(([0.0], GENERATOR.standard_normal(59)))
    tau = np.array([0.05, 1.3])
    q, p = compute_arm_columns(time, x, tau)
    direct = np.zeros_like(q)
    for i in range(1, len(time)):
        start, stop, slope = time[i - 1], time[i], (x[i] - x[i - 1]) / (time[i] - time[i - 1])
        for j, t in enumerate(tau):
            rising = np.clip(time - start, 0, stop - start)
            direct[:, j] += (
                slope * t * (1 - np.exp(-rising / t)) * np.exp(-np.clip(time - stop, 0, None) / t)
            )
    np.testing.assert_allclose(q, direct, atol=1e-12)
    h = 1e-6
    ahead, behind = (compute_arm_columns(time, x, tau * np.exp(d))[0] for d in (h, -h))
    np.testing.assert_allclose(p, (ahead - behind) / (2 * h), atol=1e-8)


@pytest.mark.parametrize("count", [2, 3, 31, 32, 33, 150, 1024, 1025, 3000])
def test_uniform_recursion_equals_the_general_recursion(count: int) -> None:
    time = np.arange(count) / 10
    x = np.random.default_rng(count).standard_normal(count)
    every = np.array([0.03, 2.0, 500.0])
    q, p = compute_arm_columns(time, x, every)
    for column, tau in zip(q.T, every, strict=True):
        np.testing.assert_allclose(column, arm_response(time, x, tau), atol=1e-13 * count)
    h = 1e-5
    ahead, behind = (compute_arm_columns(time, x, every * np.exp(d))[0] for d in (h, -h))
    np.testing.assert_allclose(p, (ahead - behind) / (2 * h), atol=1e-8)


@given(
    log_tau=st.lists(st.floats(np.log(0.02), np.log(300)), min_size=2, max_size=2, unique=True),
    start=st.integers(0, 3000),
    stop=st.integers(3500, 6001),
    history=st.sampled_from(sorted(HISTORIES)),
)
@settings(max_examples=12, deadline=None)
def test_gram_matrix_is_that_of_every_sample(
    log_tau: list[float], start: int, stop: int, history: str
) -> None:
    x = HISTORIES[history]
    block = build_recorded_block(
        TIME, x, force_of(x, 2), window=slice(start, stop), offset="offset", drift="drift"
    )
    assert block.rotated_basis
    tau = np.exp(np.array(log_tau))
    rows = block.exact.evaluate(np.log(tau))
    assert len(rows.target) == stop - start
    dense = np.column_stack((rows.fixed, rows.arms, rows.d_arms, rows.target))
    scale = np.linalg.norm(dense, axis=0)
    # an arm that has died before the window is rounding beside the displacement
    scale = np.maximum(scale, 0.1 * scale[0] * (scale < scale[0]))
    seen = correlate_displacement(TIME, x, rows.fixed, start=start, stop=stop)
    gram = seen.gram(tau, Force.from_motion(seen, rows.target), derivative=True)
    np.testing.assert_allclose(
        gram / scale / scale[:, None], dense.T @ dense / scale / scale[:, None], atol=1e-9
    )
    p = dense.shape[1] - 1 - len(tau)
    values = seen.gram(tau, Force.from_motion(seen, rows.target), derivative=False)
    retained = np.r_[:p, -1]
    np.testing.assert_allclose(values, gram[np.ix_(retained, retained)], rtol=1e-12)


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("window", [(0, 6001), (1, 6001), (40, 5000), (2500, 5999)])
def test_the_column_of_a_late_force_is_that_of_every_sample(
    history: str, window: tuple[int, int]
) -> None:
    x, here = HISTORIES[history], slice(*window)
    block = build_recorded_block(
        TIME, x, force_of(x, 2), window=here, offset="offset", drift="drift"
    )
    tau = np.array([0.004, 0.5, 200.0])
    arms = block.exact.evaluate(np.log(tau)).arms
    late = DelayedForce.from_arms(
        arms, np.array([30.0, 20.0, 10.0]), tau, 200.0, np.gradient(x, TIME)[here]
    )
    result = block.with_delay("delay", late).evaluate(np.log([0.1, 5.0]))
    every = block.exact.with_column("delay", late.column).evaluate(np.log([0.1, 5.0]))
    short, long = (
        np.column_stack((rows.fixed, rows.arms, rows.d_arms, rows.target))
        for rows in (result, every)
    )
    scale = np.linalg.norm(long, axis=0)
    scale = np.maximum(scale, 0.1 * scale[0] * (scale < scale[0]))
    np.testing.assert_allclose(
        short.T @ short / scale / scale[:, None], long.T @ long / scale / scale[:, None], atol=1e-10
    )


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("arms", [1, 2, 3, 4])
def test_correlated_optimum_is_the_full_optimum(history: str, arms: int) -> None:
    x = HISTORIES[history]
    block = build_recorded_block(TIME, x, force_of(x, arms), offset="offset")
    solution = solve([block], arms)
    assert solution.converged
    same(solution, solve([block.exact], arms, log_tau_start=solution.log_tau))


def test_hold_only_window_with_drift() -> None:
    x = HISTORIES["ramp and hold"]
    force = force_of(x, 2) + 0.02 * TIME
    block = build_recorded_block(TIME, x, force, window=slice(160, None), drift="drift")
    solution = solve([block], 2)
    same(solution, solve([block.exact], 2, log_tau_start=solution.log_tau))
    assert solution.coefficient("drift") == pytest.approx(0.02, rel=0.05)
    assert solution.samples == len(TIME) - 160


def test_the_optimum_is_scipys_with_lfilter() -> None:
    from scipy.optimize import least_squares
    from scipy.signal import lfilter

    x = HISTORIES["steps and chirp"]
    force = force_of(x, 2)
    h, steps = TIME[1], np.diff(x, prepend=0.0)

    def residual(p: np.ndarray) -> np.ndarray:
        model = p[0] * x
        for k, tau in ((p[1], np.exp(p[3])), (p[2], np.exp(p[4]))):
            a = np.exp(-h / tau)
            model = model + k * lfilter([(1 - a) * tau / h], [1, -a], steps)
        return model - force

    start = [196.5, 117.5, 17.8, np.log(0.5), np.log(16)]
    dense = least_squares(residual, start, x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    solution = solve([build_recorded_block(TIME, x, force)], 2)
    assert solution.sse == pytest.approx(2 * dense.cost, rel=1e-9)
    np.testing.assert_allclose(solution.log_tau, dense.x[3:], atol=1e-5)


def test_any_grid_and_weights_take_the_recursion() -> None:
    rng = np.random.default_rng(2)
    keep = np.sort(rng.choice(len(TIME), 1500, replace=False))
    keep[0] = 0
    time, x = TIME[keep], HISTORIES["steps and chirp"][keep]
    sd = np.where(time < 10, 2e-3, 2e-2)
    force = force_of(x, 2, sd=0.0, time=time) + sd * rng.standard_normal(len(time))
    block = build_recorded_block(time, x, force, weights=1 / sd)
    assert block.exact is block
    solution = solve([block], 2)
    assert solution.converged
    np.testing.assert_allclose(solution.tau, [0.5021, 16.416], rtol=0.3)
    assert solution.sse == pytest.approx(len(time), rel=0.15)
    orders = solve_orders([block], 2)
    assert [order.order for order in orders] == [0, 1, 2]
    assert orders[2].sse == pytest.approx(solution.sse, rel=1e-9)


def make_jittered_record(count: int, history: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A long record on a clock of its own, its displacement, and weights."""
    time = np.sort(GENERATOR.uniform(0, 40, count))
    x = np.interp(time, TIME, HISTORIES[history]) + 1e-3
    return time, x, np.where(time < 10, 1 / 2e-3, 1 / 2e-2)


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("arms", [1, 2, 3, 4])
def test_reduced_optimum_is_the_full_optimum(history: str, arms: int) -> None:
    time, x, weights = make_jittered_record(5000, history)
    force = force_of(x, arms, sd=0.0, time=time) + GENERATOR.standard_normal(5000) / weights
    block = build_recorded_block(
        time, x, force, offset="offset", weights=weights, window=slice(40, 4900)
    )
    assert len(block.evaluate(np.zeros(1)).target) < 120
    assert block.samples == block.exact.samples == 4860
    solution = solve([block], arms)
    full = solve([block.exact], arms, log_tau_start=solution.log_tau)
    assert solution.sse == pytest.approx(full.sse, rel=1e-10)
    np.testing.assert_allclose(solution.log_tau, full.log_tau, atol=1e-8)
    np.testing.assert_allclose(solution.arms, full.arms, rtol=1e-8)


@pytest.mark.parametrize(("doubtful", "correlated"), [(3000, True), (3001, False)])
def test_weights_that_end_in_ones_leave_the_rest_correlated(
    doubtful: int, correlated: bool
) -> None:
    """As every sample says, with a column more, and where just half of the record is doubted."""
    x = HISTORIES["steps and chirp"]
    force = force_of(x, 2)
    weights = np.where(np.arange(6001) < doubtful, 0.3 + 0.7 * TIME / TIME[-1], 1.0)
    here, bump = slice(40, None), np.sin(TIME)
    block = build_recorded_block(
        TIME, x, force, window=here, offset="offset", weights=weights, columns={"bump": bump}
    )
    assert block.rotated_basis == correlated
    assert block.samples == block.exact.samples == 6001 - 40
    assert len(block.exact.target) == 6001 - 40
    solution = solve([block], 2)
    same(solution, solve([block.exact], 2, log_tau_start=solution.log_tau))
    assert solution.fixed_names == ("k_inf", "offset", "bump")
    bare = build_recorded_block(TIME, x, force, window=here, offset="offset", weights=weights)
    wider = solve([bare.with_column("bump", (weights * bump)[here])], 2)
    same(wider, solution)


@pytest.mark.parametrize("count", [1, 30, 300])
def test_recorded_block_retains_a_few_doubtful_samples(count: int) -> None:
    """A column that no arm resembles, too, in fewer rows than the kernels span."""
    x, here = HISTORIES["steps and chirp"], slice(40, None)
    sample = np.arange(6001)
    weights = np.where(sample < 40 + count, 0.2, 1.0)
    bump = {"bump": 1.0 * (sample % 7 == 5)}
    block = build_recorded_block(
        TIME, x, force_of(x, 2), window=here, weights=weights, columns=bump
    )
    solution = solve([block], 2)
    same(solution, solve([block.exact], 2, log_tau_start=solution.log_tau))


def test_weights_before_the_window_do_not_matter() -> None:
    x = HISTORIES["ramp and hold"]
    force, weights = force_of(x, 2), np.where(np.arange(6001) < 40, 0.1, 1.0)
    here = slice(40, None)
    weighted = build_recorded_block(TIME, x, force, window=here, weights=weights)
    same(solve([weighted], 2), solve([build_recorded_block(TIME, x, force, window=here)], 2))


def test_arms_far_slower_than_the_window_are_reduced() -> None:
    x = HISTORIES["ramp and hold"]
    force = force_of(x, 2)
    low, high = build_recorded_block(TIME, x, force).window
    data_blocks = [
        build_recorded_block(TIME, x, force, tau_range=(low, n * high)) for n in (10.0, 10.001)
    ]
    assert [block.rotated_basis for block in data_blocks] == [True, False]
    same(solve(data_blocks[:1], 2), solve(data_blocks[1:], 2))


@given(log_tau=st.lists(st.floats(np.log(0.02), np.log(300)), min_size=2, max_size=2, unique=True))
@settings(max_examples=15, deadline=None)
def test_reduced_columns_are_those_of_every_sample(log_tau: list[float]) -> None:
    time, x, weights = make_jittered_record(3000, "steps and chirp")
    block = build_recorded_block(time, x, force_of(x, 2, time=time), weights=weights)

    def gram(rows: Evaluation, floor: float) -> np.ndarray:
        every = np.column_stack((rows.fixed, rows.arms, rows.d_arms, rows.target))
        product = every.T @ every
        product[-1, -1] += floor
        return product

    at = np.array(log_tau)
    full = gram(block.exact.evaluate(at), 0.0)
    scale = np.sqrt(np.diagonal(full))
    difference = gram(block.evaluate(at), block.floor) - full
    assert np.abs(difference / scale / scale[:, None]).max() < 1e-10


def test_a_record_that_starts_loaded_is_reduced_too() -> None:
    x = HISTORIES["steps and chirp"] + 1e-3
    block = build_recorded_block(TIME, x, force_of(x, 2))
    assert not block.rotated_basis
    orders = solve_orders([block], 2)
    np.testing.assert_allclose(orders[2].tau, [0.5021, 16.416], rtol=0.1)
    full = solve([block.exact], 2, log_tau_start=orders[2].log_tau)
    assert orders[2].sse == pytest.approx(full.sse, rel=1e-10)


def test_exact_data_come_back_to_ten_digits_and_no_further_arm() -> None:
    x = HISTORIES["ramp and hold"]
    solution = solve([build_recorded_block(TIME, x, force_of(x, 2, sd=0.0))], 4)
    assert solution.order == 2
    np.testing.assert_allclose(solution.tau, [0.5021, 16.416], rtol=1e-9)
    np.testing.assert_allclose(solution.arms, [[117.5, 17.8]], rtol=1e-9)
    assert solution.sse < 1e-18


def test_orders_and_certificate_work_in_turning_coordinates() -> None:
    x = HISTORIES["steps and chirp"]
    block = build_recorded_block(TIME, x, force_of(x, 3), offset="offset")
    orders = solve_orders([block], 4)
    assert [order.order for order in orders][:4] == [0, 1, 2, 3]
    for order in orders[1:4]:
        gap = certificate([block], order).gap
        direct = certificate([block.exact], order).gap
        assert gap == pytest.approx(direct, rel=1e-3, abs=1e-6)
    assert certificate([block], orders[1]).gap > certificate([block], orders[3]).gap


def test_refusals_say_what_was_expected() -> None:
    x = HISTORIES["ramp and hold"]
    with pytest.raises(DataError, match="expected the same number"):
        build_recorded_block(TIME, x, x[:-1])
    with pytest.raises(DataError, match="at least 3 neighbouring samples"):
        build_recorded_block(TIME, x, x, window=slice(0, 2))
    with pytest.raises(DataError, match="neighbouring"):
        build_recorded_block(TIME, x, x, window=slice(0, 100, 2))


@pytest.mark.parametrize("derivative", [False, True])
def test_what_the_correlations_lose_to_rounding_comes_from_every_sample(
    monkeypatch: pytest.MonkeyPatch, derivative: bool
) -> None:
    """Of a hundred arms the least sums may lose more than a factor bears."""
    x = HISTORIES["ramp and hold"]
    block = build_recorded_block(TIME, x, force_of(x, 2), window=slice(1200, 6001), offset="offset")
    at = np.log(np.geomspace(1.0, 100.0, 4))
    closed = block.evaluate(at, derivative)

    def fail_rounding(gram: np.ndarray) -> np.ndarray:
        raise FitError("rounding")

    monkeypatch.setattr(displacement_correlation, "upper_factor", fail_rounding)
    sampled = block.evaluate(at, derivative)
    assert len(sampled.target) == len(closed.target)
    column_stack, two = (
        np.column_stack((model.fixed, model.arms, model.d_arms, model.target))
        for model in (closed, sampled)
    )
    scale = np.linalg.norm(two, axis=0)
    np.testing.assert_allclose(
        (column_stack / scale).T @ (column_stack / scale),
        (two / scale).T @ (two / scale),
        atol=1e-9,
    )


def test_what_is_no_sum_of_squares_has_no_factor() -> None:
    with pytest.raises(FitError, match="lie too far apart"):
        upper_factor(np.array([[1.0, 5.0], [5.0, 1.0]]))
