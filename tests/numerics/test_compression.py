"""A compressed record and the full record are one fit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.numerics.design_matrices.data_compression import plan_compression, uniform_step
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import solve

DEPTH, RAMP = 8e-3, 1.0
GENERATOR = np.random.default_rng(11)
UNIFORM = np.arange(20001) / 500
GRIDS: dict[str, np.ndarray] = {
    "uniform": UNIFORM,
    "late start": UNIFORM + 0.0137,
    "jittered": UNIFORM + np.clip(GENERATOR.normal(0, 0.3, len(UNIFORM)), -0.9, 0.9) / 1000,
    "gappy": UNIFORM[(UNIFORM < 1.3) | ((UNIFORM > 2) & (UNIFORM < 9)) | (UNIFORM > 20)],
    "log-spaced": np.geomspace(1e-3, 40, 6000),
}
GRIDS["jittered"][0] = 0.0
ARMS = {
    1: ((80.0,), (3.0,)),
    2: ((117.5, 17.8), (0.5021, 16.416)),
    3: ((90.0, 40.0, 20.0), (0.25, 2.0, 18.0)),
    4: ((90.0, 60.0, 40.0, 30.0), (0.08, 0.5, 3.0, 18.0)),
}


def compute_hold(time: np.ndarray, k_inf: float, k: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """The hold as paper eq. 5 says it, arms summed one by one."""
    force = np.full(len(time), k_inf)
    for stiffness, t in zip(k, tau, strict=True):
        force += stiffness * t / RAMP * (1 - np.exp(-RAMP / t)) * np.exp(-time / t)
    return DEPTH * force


def noisy(time: np.ndarray, arms: int, sd: np.ndarray | float = 0.01) -> np.ndarray:
    k, tau = ARMS[arms]
    return compute_hold(time, 196.5, np.array(k), np.array(tau)) + sd * np.random.default_rng(
        arms
    ).standard_normal(len(time))


def dense(time: np.ndarray, force: np.ndarray, sd: np.ndarray | float, start: np.ndarray):
    """Slow and obvious: scipy on every sample and every parameter at once, then polished."""
    from scipy.optimize import least_squares

    arms = (len(start) - 1) // 2

    def residual(p: np.ndarray) -> np.ndarray:
        return (compute_hold(time, p[0], p[1 : arms + 1], np.exp(p[arms + 1 :])) - force) / sd

    result = least_squares(
        residual, start, jac="3-point", x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    return result.x, float(np.square(residual(result.x)).sum())


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("arms", [1, 2, 3, 4])
def test_compressed_optimum_is_the_full_optimum(grid: str, arms: int) -> None:
    time = GRIDS[grid]
    force = noisy(time, arms)
    block = build_hold_block(time, force, depth=DEPTH, ramp_time=RAMP)
    assert len(block.target) < 300
    solution = solve([block], arms)
    assert solution.converged
    # the full record, every sample a row, descended from the compressed optimum
    full = solve([block.exact], arms, log_tau_start=solution.log_tau)
    assert full.samples == solution.samples == len(time)
    assert solution.sse == pytest.approx(full.sse, rel=1e-10)
    np.testing.assert_allclose(solution.log_tau, full.log_tau, atol=1e-8)
    np.testing.assert_allclose(solution.arms, full.arms, rtol=1e-8)
    np.testing.assert_allclose(solution.fixed, full.fixed, rtol=1e-8)


@pytest.mark.parametrize("arms", [1, 2, 3])
def test_the_optimum_is_scipys_on_every_sample(arms: int) -> None:
    time = GRIDS["uniform"][::4]
    force = noisy(time, arms)
    solution = solve([build_hold_block(time, force, depth=DEPTH, ramp_time=RAMP)], arms)
    k, tau = ARMS[arms]
    x, sse = dense(time, force, 1.0, np.concatenate(([196.5], k, np.log(tau))))
    assert solution.sse == pytest.approx(sse, rel=1e-10)
    assert solution.sse <= sse * (1 + 1e-11)
    # scipy stops where the SSE is flat: its parameters are good to about 1e-6
    np.testing.assert_allclose(solution.log_tau, x[arms + 1 :], atol=2e-5)


def test_weighted_record() -> None:
    time = GRIDS["uniform"]
    sd = 0.002 * (1 + 4 * np.exp(-time / 3))
    force = noisy(time, 2, sd)
    block = build_hold_block(time, force, depth=DEPTH, ramp_time=RAMP, weights=1 / sd)
    solution = solve([block], 2)
    full = solve([block.exact], 2, log_tau_start=solution.log_tau)
    assert len(block.target) < 300
    assert solution.sse == pytest.approx(full.sse, rel=1e-10)
    assert solution.sse == pytest.approx(len(time), rel=0.05)
    np.testing.assert_allclose(solution.log_tau, full.log_tau, atol=1e-8)


@pytest.mark.parametrize("grid", ["uniform", "jittered"])
def test_ramp_and_hold(grid: str) -> None:
    time = GRIDS[grid]
    k, tau = np.array(ARMS[2][0]), np.array(ARMS[2][1])
    rising = np.minimum(time, RAMP)[:, None]
    falling = np.maximum(time - RAMP, 0)[:, None]
    shape = (tau * -np.expm1(-rising / tau) * np.exp(-falling / tau)) @ k
    clean = DEPTH / RAMP * (196.5 * rising[:, 0] + shape)
    force = clean + 0.3 + 0.01 * GENERATOR.standard_normal(len(time))
    block = build_hold_block(time, force, depth=DEPTH, ramp_time=RAMP, ramp=True, offset="offset")
    solution = solve([block], 2)
    full = solve([block.exact], 2, log_tau_start=solution.log_tau)
    assert len(block.target) < 400
    assert solution.sse == pytest.approx(full.sse, rel=1e-10)
    np.testing.assert_allclose(solution.log_tau, full.log_tau, atol=1e-8)
    np.testing.assert_allclose(np.exp(solution.log_tau), tau, rtol=0.1)
    assert solution.coefficient("offset") == pytest.approx(0.3, abs=0.01)


@given(log_tau=st.floats(np.log(4e-3), np.log(400)), grid=st.sampled_from(sorted(GRIDS)))
@settings(max_examples=40, deadline=None)
def test_inner_products_of_any_decay_survive(log_tau: float, grid: str) -> None:
    time = GRIDS[grid] - GRIDS[grid][0]
    plan = plan_compression(time)
    tau = np.exp(log_tau)
    values = np.exp(-time / tau)
    z, floor = plan.project(values)
    at_nodes = plan.root_weight * np.exp(-plan.nodes / tau)
    norm = np.linalg.norm(values)
    # values become the model at the nodes, and what is set aside is rounding
    assert np.linalg.norm(z - at_nodes) < 2e-10 * norm
    assert floor < (2e-10 * norm) ** 2
    other = np.exp(-time / 3.0)
    direct = values @ other
    assert at_nodes @ (plan.root_weight * np.exp(-plan.nodes / 3.0)) == pytest.approx(
        direct, rel=1e-12
    )


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_projection_is_orthogonal(seed: int) -> None:
    values = np.random.default_rng(seed).standard_normal((2, 5000))
    z, floor = plan_compression(np.arange(5000.0)).project(values)
    np.testing.assert_allclose((z * z).sum(axis=1) + floor, (values * values).sum(axis=1))


@pytest.mark.parametrize("count", [301, 417, 3400, 27_000, 60_001])
@pytest.mark.parametrize("sd", [1.0, 1e-2, 1e-3, 1e-6])
def test_the_floor_is_what_the_nodes_leave_however_small(count: int, sd: float) -> None:
    time = np.arange(count) / 100
    noise = sd * GENERATOR.standard_normal((2, count))
    plan = plan_compression(time)
    assert plan.samples == count
    z, floor = plan.project(50 + 3 * np.exp(-time / 2) + noise)
    # the decay and the constant live at the nodes: only noise is set aside
    within, aside = plan.project(noise)
    np.testing.assert_allclose(floor, aside, rtol=1e-9 / min(sd, 1e-2))
    np.testing.assert_allclose(aside + np.square(within).sum(axis=1), np.square(noise).sum(axis=1))
    decay = plan.root_weight * (50 + 3 * np.exp(-plan.nodes / 2))
    np.testing.assert_allclose(z - within, np.stack((decay, decay)), rtol=1e-10, atol=1e-9)


def test_small_records_stay_raw() -> None:
    time = np.arange(200) / 10
    plan = plan_compression(time)
    values = GENERATOR.standard_normal(200)
    z, floor = plan.project(values)
    np.testing.assert_array_equal(z, values)
    assert floor == 0
    block = build_hold_block(time, values)
    assert block.exact is block


@pytest.mark.parametrize(
    ("time", "step"),
    [
        (np.arange(1000) * 1e-3 + 123.4, 1e-3),
        (np.round(np.arange(1000) / 3, 4), None),
        (np.geomspace(1, 2, 500), None),
    ],
)
def test_uniform_up_to_rounding(time: np.ndarray, step: float | None) -> None:
    result = uniform_step(time)
    assert result == pytest.approx(step) if step else result is None


BadCall = Callable[[], object]


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: build_hold_block(np.array([0.0, 1, 1, 2]), np.zeros(4)), "strictly increasing"),
        (lambda: build_hold_block(np.array([-1.0, 0, 1]), np.zeros(3)), "from 0 on"),
        (lambda: build_hold_block(np.arange(4.0), np.zeros(3)), "time has"),
        (
            lambda: build_hold_block(np.arange(4.0), np.zeros(4), weights=np.array([1.0, 0, 1, 1])),
            "must be > 0",
        ),
        (
            lambda: build_hold_block(
                np.arange(4.0), np.zeros(4), depth=1.0, ramp_time=9.0, ramp=True
            ),
            "some on the ramp and some on the hold",
        ),
    ],
)
def test_refusals_say_what_was_expected(call: BadCall, sentence: str) -> None:
    with pytest.raises(DataError, match=sentence):
        call()
