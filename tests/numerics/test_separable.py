"""The separable solver: derivatives, optimum, refusals."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError, FitError
from dashpot.extensions.curves.dynamic.fit import make_frequency_block
from dashpot.numerics.design_matrices.block import DataBlock, design_block
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import certificate, compute_full_jacobian, solve, solve_orders
from dashpot.numerics.log_tau_descent import Stack, descend, solve_at
from dashpot.numerics.nonnegative_least_squares import nonnegative_columns, solve_nonnegative

TIME = np.arange(4001) / 100


def decay(tau: list[float], k: list[float], *, k_inf: float = 1.0) -> np.ndarray:
    return k_inf + np.exp(-TIME[:, None] / np.array(tau)) @ np.array(k)


def noise(seed: int, sd: float = 1e-2) -> np.ndarray:
    return sd * np.random.default_rng(seed).standard_normal(len(TIME))


def two_depths() -> list[DataBlock]:
    """Two tests that share relaxation times and a drift, with stiffnesses of their own."""
    blocks = [
        build_hold_block(
            TIME,
            scale * decay([0.5, 9.0], [2.0, share]) + noise(i) + 1e-3 * TIME,
            depth=1.0,
            ramp_time=0.5,
            k_inf=f"k_inf@{i}",
            drift="drift",
        )
        for i, (scale, share) in enumerate([(1.0, 1.0), (3.0, 0.5)])
    ]
    return [replace(block, arm_group=f"k@{i}") for i, block in enumerate(blocks)]


@given(st.lists(st.floats(-2.0, 3.5), min_size=1, max_size=3, unique=True))
@settings(max_examples=20, deadline=None)
def test_gradient_and_curvature_are_those_of_the_reduced_residual(log_tau: list[float]) -> None:
    theta = np.sort(np.array(log_tau))
    if len(theta) > 1 and np.diff(theta).min() < 0.4:
        return
    stack = Stack(two_depths())

    def residual(at: np.ndarray) -> np.ndarray:
        rows = stack.evaluate(at, derivative=False)
        target, phi = rows.target, rows.phi
        return target - phi @ np.linalg.lstsq(phi, target, rcond=None)[0]

    point = solve_at(stack, theta)
    h = 1e-5
    jacobian = np.column_stack(
        [
            (residual(theta + h * unit) - residual(theta - h * unit)) / (2 * h)
            for unit in np.eye(len(theta))
        ]
    )
    r = residual(theta)
    assert point.sse == pytest.approx(r @ r, rel=1e-9)
    np.testing.assert_allclose(point.gradient, jacobian.T @ r, rtol=1e-4, atol=1e-6 * r @ r)
    scale = np.abs(point.curvature).max()
    np.testing.assert_allclose(point.curvature, jacobian.T @ jacobian, rtol=1e-4, atol=1e-6 * scale)
    step = 1e-6 * np.arange(1, len(theta) + 1)
    variant = solve_at(stack, theta + step)
    np.testing.assert_allclose(point.step_ahead(step).beta, variant.beta, rtol=1e-7, atol=1e-8)
    # and not by chance: the step is seen
    if len(theta) == 1:
        assert np.abs(variant.beta - point.beta).max() > 1e-7


def test_full_jacobian_is_the_derivative_of_the_model() -> None:
    blocks = two_depths()
    solution = solve(blocks, 2)
    jacobian = compute_full_jacobian(blocks, solution)
    assert jacobian.names == (
        "k_inf@0", "drift", "k_inf@1",
        "k_1@0", "k_2@0", "k_1@1", "k_2@1",
        "ln_tau_1", "ln_tau_2",
    )  # fmt: skip
    stack = Stack(blocks)
    parameters = np.concatenate((solution.fixed, solution.arms.ravel(), solution.log_tau))

    def model(p: np.ndarray) -> np.ndarray:
        return stack.evaluate(p[-2:], derivative=False).phi @ p[:-2]

    for i, column in enumerate(jacobian.matrix.T):
        step = np.zeros(len(parameters))
        step[i] = 1e-6
        slope = (model(parameters + step) - model(parameters - step)) / 2e-6
        np.testing.assert_allclose(column, slope, atol=1e-7 * np.abs(slope).max())
    # at the optimum the residual is orthogonal to every column
    dual_gradient = jacobian.matrix.T @ jacobian.residual
    norms = np.linalg.norm(jacobian.matrix, axis=0) * np.linalg.norm(jacobian.residual)
    assert np.abs(dual_gradient / norms).max() < 1e-9


def test_stacked_optimum_is_scipys() -> None:
    from scipy.optimize import least_squares

    blocks = [replace(block.exact, arm_group=block.arm_group) for block in two_depths()]
    solution = solve(two_depths(), 2)
    stack = Stack(blocks)

    def residual(p: np.ndarray) -> np.ndarray:
        rows = stack.evaluate(p[-2:], derivative=False)
        return rows.phi @ p[:-2] - rows.target

    start = np.concatenate((solution.fixed, solution.arms.ravel(), solution.log_tau)) * 1.1
    dense = least_squares(residual, start, x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    assert solution.sse == pytest.approx(2 * dense.cost, rel=1e-9)
    np.testing.assert_allclose(solution.log_tau, dense.x[-2:], atol=1e-5)
    assert solution.samples == 2 * len(TIME)


def test_no_junk_arm_on_clean_data() -> None:
    clean = decay([3.0], [2.0])
    for arms in (1, 2, 3):
        solution = solve([build_hold_block(TIME, clean)], arms)
        assert solution.order == 1
        assert solution.requested_arms == arms
        assert solution.converged
        np.testing.assert_allclose(solution.tau, [3.0], rtol=1e-10)
        np.testing.assert_allclose(solution.arms, [[2.0]], rtol=1e-10)
    orders = solve_orders([build_hold_block(TIME, clean)], 4)
    assert [order.order for order in orders] == [0, 1]


@pytest.mark.parametrize("tau", [2e-3, 3000.0])
def test_an_arm_outside_the_window_is_never_called_converged(tau: float) -> None:
    data = decay([3.0, tau], [2.0, 1.5]) + noise(1, 1e-3)
    solution = solve([build_hold_block(TIME, data)], 2)
    low, high = np.exp(solution.bounds)
    assert solution.order < 2 or not solution.converged or (low < solution.tau).all()
    assert (solution.tau >= low).all()
    assert (solution.tau <= high * (1 + 1e-12)).all()
    assert solution.at_bound.any() == (not solution.converged)


def test_rising_data_have_no_positive_arm() -> None:
    solution = solve([build_hold_block(TIME, 5 - np.exp(-TIME / 3) + noise(2))], 2)
    assert solution.order == 0
    assert solution.sse > 0
    signed = solve([build_hold_block(TIME, 5 - np.exp(-TIME / 3) + noise(2))], 1, signed=True)
    assert signed.arms[0, 0] == pytest.approx(-1, abs=0.02)


def test_equilibrium_stiffness_is_never_negative() -> None:
    data = decay([2.0, 20.0], [2.0, 1.0], k_inf=-0.05) + noise(3, 1e-3)
    solution = solve([build_hold_block(TIME, data)], 2)
    assert solution.coefficient("k_inf") >= 0
    assert (solution.arms > 0).all()
    free = solve([build_hold_block(TIME, data, k_inf="level")], 2)
    assert free.coefficient("level") == pytest.approx(-0.05, abs=0.02)
    assert free.sse < solution.sse


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("sd", [0.2, 1e-2, 1e-4])
def test_solve_orders_omits_no_order_with_gain(seed: int, sd: float) -> None:
    generator = np.random.default_rng(seed)
    tau = 0.1 * np.cumprod(generator.uniform(2, 8, 3))
    block = build_hold_block(TIME, decay(list(tau), [1.0, 0.3, 0.5]) + noise(seed, sd))
    every = solve_orders([block], 6)
    some = solve_orders([block], 6, negligible=20.0)
    assert [s.sse for s in some[:-1]] == [s.sse for s in every[: len(some) - 1]]
    spare = len(TIME) - len(every)
    for residual in every[len(some) - 1 :]:
        assert some[-2].sse - residual.sse < 20.0 * some[-2].sse / spare
    # the orders beyond are there for the asking, from one start each
    solutions = solve_orders([block], 6, negligible=20.0, every_order=True)
    assert [s.sse for s in solutions[: len(some)]] == [s.sse for s in some]
    assert all(b.sse < a.sse for a, b in pairwise(solutions))
    # it is not stopped for nothing, nor late
    before = [some[i].sse - some[i + 1].sse for i in range(len(some) - 2)]
    assert all(gain > 20.0 * some[i + 1].sse / len(TIME) for i, gain in enumerate(before[:-1]))


def test_solve_orders_agree_with_single_solves() -> None:
    data = decay([0.3, 2.0, 15.0], [1.0, 1.0, 1.0]) + noise(4, 1e-3)
    block = build_hold_block(TIME, data)
    orders = solve_orders([block], 3)
    assert [order.order for order in orders] == [0, 1, 2, 3]
    assert all(b.sse < a.sse for a, b in pairwise(orders))
    for order in orders:
        single = solve([block], order.order)
        assert single.sse == pytest.approx(order.sse, rel=1e-12)
        np.testing.assert_allclose(single.log_tau, order.log_tau, atol=1e-9)
    np.testing.assert_allclose(orders[3].tau, [0.3, 2.0, 15.0], rtol=0.02)


@given(force=st.floats(-6, 6), clock=st.floats(-3, 3))
@settings(max_examples=15, deadline=None)
def test_units_of_force_and_time_do_not_matter(force: float, clock: float) -> None:
    """SSE scales with force squared, arms with force, relaxation times with the clock."""
    data = decay([0.5, 9.0], [2.0, 1.0]) + noise(12)
    solution = solve([build_hold_block(TIME, data)], 2)
    other = solve([build_hold_block(TIME * 10**clock, data * 10**force)], 2)
    assert other.sse == pytest.approx(solution.sse * 100**force, rel=1e-9)
    np.testing.assert_allclose(other.tau, solution.tau * 10**clock, rtol=1e-9)
    np.testing.assert_allclose(other.arms, solution.arms * 10**force, rtol=1e-8)


@given(st.permutations(range(3)))
@settings(max_examples=6, deadline=None)
def test_the_order_of_the_blocks_does_not_matter(order: list[int]) -> None:
    blocks = [
        build_hold_block(TIME, decay([0.5, 9.0], [2.0, 1.0]) + noise(20 + i)) for i in range(3)
    ]
    solution, other = solve(blocks, 2), solve([blocks[i] for i in order], 2)
    assert other.sse == pytest.approx(solution.sse, rel=1e-11)
    np.testing.assert_allclose(other.log_tau, solution.log_tau, atol=1e-9)


def test_solve_of_duplicate_tests_doubles_the_sse() -> None:
    block = build_hold_block(TIME, decay([0.5, 9.0], [2.0, 1.0]) + noise(30))
    solution, two = solve([block], 2), solve([block, block], 2)
    assert two.sse == pytest.approx(2 * solution.sse, rel=1e-11)
    np.testing.assert_allclose(two.log_tau, solution.log_tau, atol=1e-9)


def test_results_repeat_to_the_last_digit() -> None:
    block = build_hold_block(TIME, decay([0.3, 15.0], [1.0, 1.0]) + noise(5))
    assert solve([block], 3, thorough=True) == solve([block], 3, thorough=True)


@pytest.mark.parametrize("seed", range(4))
def test_solve_near_the_optimum_returns_the_same_optimum(seed: int) -> None:
    force = decay([0.2, 0.5, 9.0], [1.0, 0.9, 0.6]) + noise(seed, 3e-2)
    block = build_hold_block(TIME, force)
    solution = solve([block], 3, negligible=20.0)
    neighbour = solve([block], 3, near_log_tau=solution.log_tau + 0.05, negligible=20.0)
    np.testing.assert_allclose(neighbour.log_tau, solution.log_tau, atol=1e-7)
    assert neighbour.evaluations < solution.evaluations
    # where more arms gain more than that, what is near is one start of many
    few = solve([block], 2, near_log_tau=np.log([0.3, 9.0]), negligible=20.0)
    assert few.sse > 1.01 * solution.sse
    assert few.log_tau.tolist() == solve([block], 2, negligible=20.0).log_tau.tolist()


def test_descend_for_the_sse_ends_sooner_with_the_same_value() -> None:
    stack = Stack([build_hold_block(TIME, decay([0.2, 1.1, 9.0], [1.0, 0.4, 0.6]) + noise(1))])
    start = np.log([0.1, 2.0, 5.0])
    whole, flat = descend(stack, start), descend(stack, start, cost_tolerance=1e-6)
    assert whole is not None
    assert flat is not None
    assert flat.evaluations < whole.evaluations
    total = stack.floor + whole.point.sse
    assert 0 <= flat.point.sse - whole.point.sse < 1e-5 * total


def test_certificate_proves_an_optimum_and_finds_a_missing_arm() -> None:
    # two thousand samples of exact data: nothing is left to gain
    clean = build_hold_block(TIME, decay([0.5, 9.0], [1.0, 2.0]))
    assert certificate([clean], solve([clean], 2)).optimal
    noisy = build_hold_block(TIME, decay([0.5, 9.0], [1.0, 2.0]) + noise(6, 1e-3))
    short = certificate([noisy], solve([noisy], 1))
    assert not short.optimal
    assert short.gap > 0.5
    assert short.dual_gradient > 0
    assert short.tau is not None
    full = certificate([noisy], solve([noisy], 2))
    assert full.gap < 1e-2
    # the bound is never beaten by more arms
    more = solve([noisy], 4)
    best = solve([noisy], 2)
    assert (best.sse - more.sse) / best.sse <= full.gap * (1 + 1e-3) + 1e-9


def test_certificate_agrees_with_dense_nonnegative_least_squares() -> None:
    from scipy.optimize import nnls

    data = decay([0.5, 9.0], [1.0, 2.0]) + noise(7, 1e-2)
    block = build_hold_block(TIME[::20], data[::20])
    solution = solve([block], 1)
    tau = np.geomspace(*block.window, 400)
    columns = np.column_stack((np.ones(len(block.target)), np.exp(-TIME[::20, None] / tau)))
    gap = 1 - nnls(columns, data[::20])[1] ** 2 / solution.sse
    assert certificate([block], solution).gap == pytest.approx(gap, rel=1e-4)


@pytest.mark.parametrize("seed", range(12))
def test_global_optimum_without_a_start(seed: int) -> None:
    """A quick version of benchmarks/global_optimum.py: nothing random does better."""
    generator = np.random.default_rng(seed)
    arms = 1 + seed % 4
    tau = 0.08 * 4.5 ** np.arange(arms) * np.exp(generator.uniform(0, 0.4, arms))
    k = np.exp(generator.uniform(np.log(0.05), 0, arms))
    data = np.round((decay(list(tau), list(k)) + noise(seed, 1e-3)) * 1280) / 1280
    block = build_hold_block(TIME, data)
    stack = Stack([block])
    solution = solve([block], arms)
    for _ in range(10):
        local = descend(stack, np.sort(generator.uniform(*stack.bounds, arms)))
        if local is not None and (local.point.beta >= 0).all():
            assert solution.sse <= (local.point.sse + stack.floor) * (1 + 1e-6)


def test_stack_joins_frequency_data_and_a_hold() -> None:
    omega = 2 * np.pi * np.geomspace(0.005, 20, 40)
    k, tau = np.array([2.0, 1.0]), np.array([0.5, 9.0])
    x = 1j * omega[:, None] * tau
    stiffness = 1.0 + (x / (1 + x)) @ k + 1j * omega * 0.01
    generator = np.random.default_rng(8)
    sd = 1e-3
    stiffness = stiffness + sd * (generator.standard_normal((2, 40)).T @ [1, 1j])
    weight = np.full(40, 1 / sd)
    spectrum = make_frequency_block(omega, stiffness, weights=(weight, weight), dashpot=True)
    hold = build_hold_block(TIME, decay([0.5, 9.0], [2.0, 1.0]) + noise(9), weights=TIME * 0 + 100)
    solution = solve([spectrum], 2)
    np.testing.assert_allclose(solution.tau, tau, rtol=0.02)
    assert solution.coefficient("b") == pytest.approx(0.01, rel=0.05)
    joint = solve([spectrum, hold], 2)
    np.testing.assert_allclose(joint.tau, tau, rtol=0.02)
    assert joint.fixed_names == ("k_inf", "b")
    assert joint.sse == pytest.approx(80 + len(TIME), rel=0.1)
    h = 1e-6
    ahead, behind = (spectrum.evaluate(np.log(tau) + d, False).arms for d in (h, -h))
    np.testing.assert_allclose(
        spectrum.evaluate(np.log(tau)).d_arms, (ahead - behind) / (2 * h), rtol=1e-6, atol=1e-4
    )


@given(seed=st.integers(0, 1000), rows=st.integers(12, 30), columns=st.integers(1, 10))
@settings(max_examples=40, deadline=None)
def test_nonnegative_least_squares_is_scipys(seed: int, rows: int, columns: int) -> None:
    from scipy.optimize import nnls

    generator = np.random.default_rng(seed)
    a, y = generator.standard_normal((rows, columns)), generator.standard_normal(rows)
    expected, norm = nnls(a, y)
    result = solve_nonnegative(a.T @ a, a.T @ y)
    np.testing.assert_allclose(result, expected, atol=1e-8)
    active = nonnegative_columns(a, y, np.ones(columns, dtype=bool))
    rest = y - a[:, active] @ np.linalg.lstsq(a[:, active], y, rcond=None)[0]
    assert np.linalg.norm(rest) == pytest.approx(norm, rel=1e-9)


def test_refusals_say_what_was_expected() -> None:
    block = build_hold_block(TIME, decay([1.0], [1.0]))
    with pytest.raises(FitError, match="expected a number >= 0"):
        solve([block], -1)
    with pytest.raises(FitError, match="at least one block"):
        solve([], 1)
    with pytest.raises(FitError, match="2 starting values"):
        solve([block], 2, log_tau_start=np.zeros(3))
    with pytest.raises(FitError, match="use fewer arms or a longer record"):
        solve([build_hold_block(TIME[:5], TIME[:5])], 3)
    with pytest.raises(DataError, match="one column per name"):
        design_block(np.zeros(3), np.zeros((3, 2)), ("k_inf",), lambda t, d: (t, t), (1.0, 2.0))
