"""Batched solver: the optimum of each single fit, and a status for each record."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError, FitError
from dashpot.extensions.batch.arrays.batched_solver import solve_many, solve_separately
from dashpot.extensions.batch.arrays.shared_sampling import (
    SharedSampling,
    make_hold_family,
    make_recorded_family,
)
from dashpot.numerics.design_matrices.recorded_motion import build_recorded_block
from dashpot.numerics.exponential_fit import solve

TIME = np.arange(3001) / 100
X = 8e-3 * np.minimum(TIME, 1.0)
FAMILIES = {
    "step": lambda: make_hold_family(TIME, depth=1.0, ramp_time=0.0),
    "hold": lambda: make_hold_family(TIME, depth=1.0, ramp_time=0.5),
    "ramp and hold": lambda: make_hold_family(TIME, depth=8e-3, ramp_time=1.0, ramp=True),
    "recorded": lambda: make_recorded_family(TIME, X),
    "recorded hold": lambda: make_recorded_family(TIME, X, window=slice(100, None)),
}


def records(
    family: SharedSampling, arms: int, count: int, seed: int, *, noise: float = 2e-3
) -> np.ndarray:
    """Random solids seen through the family's own columns, plus noise."""
    generator = np.random.default_rng(seed)
    out = []
    for _ in range(count):
        tau = 0.12 * 6.0 ** np.arange(arms) * np.exp(generator.uniform(0, 0.6, arms))
        k = generator.uniform(0.3, 1.5, arms)
        rows = family.build_block(np.zeros(len(TIME))).exact.evaluate(np.log(tau), False)
        clean = 2 * rows.fixed[:, 0] + rows.arms @ k
        full = np.zeros(len(TIME))
        full[-len(clean) :] = clean
        out.append(full + noise * np.ptp(clean) * generator.standard_normal(len(full)))
    return np.array(out)


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("arms", [1, 2, 3])
def test_batched_solver_has_the_optimum_of_each_single_fit(name: str, arms: int) -> None:
    family = FAMILIES[name]()
    data = records(family, arms, 12, seed=arms)
    many = solve_many(family, data, arms)
    for row, values in enumerate(data):
        solution = solve([family.build_block(values)], arms)
        assert many.order[row] == solution.order
        assert many.converged[row] == solution.converged
        n = solution.order
        assert many.sse[row] == pytest.approx(solution.sse, rel=1e-9)
        np.testing.assert_allclose(many.log_tau[row, :n], solution.log_tau, atol=1e-7)
        np.testing.assert_allclose(many.arms[row, :n], solution.arms[0], rtol=1e-6)
        np.testing.assert_allclose(many.fixed_coefficients[row], solution.fixed, rtol=1e-7)


@pytest.mark.parametrize("name", ["step", "ramp and hold", "recorded"])
@pytest.mark.parametrize(("seen", "arms", "noise"), [(2, 2, 0.1), (1, 2, 0.01), (3, 3, 0.03)])
def test_batched_solver_has_the_optimum_of_doubtful_single_fits(
    name: str, seen: int, arms: int, noise: float
) -> None:
    family = FAMILIES[name]()
    data = records(family, seen, 10, seed=7, noise=noise)
    many = solve_many(family, data, arms)
    for row, values in enumerate(data):
        solution = solve([family.build_block(values)], arms)
        assert many.order[row] == solution.order
        assert many.sse[row] == pytest.approx(solution.sse, rel=1e-8)


@pytest.mark.parametrize("name", ["step", "hold", "ramp and hold"])
@pytest.mark.parametrize("tau", [0.03, 0.5, 7.0, 250.0])
def test_columns_in_the_space_of_a_sampling_are_those_at_its_nodes(name: str, tau: float) -> None:
    family = FAMILIES[name]()
    space = family.space
    count = space.basis.shape[1]
    assert count < 50 < len(space.basis)
    np.testing.assert_allclose(space.basis.T @ space.basis, np.eye(count), atol=1e-12)
    for at_nodes, chosen in zip(
        family.template.evaluate(np.log([tau]))[2:],
        space.node_columns.evaluate(np.log([tau]))[2:],
        strict=True,
    ):
        norm = np.linalg.norm(at_nodes)
        np.testing.assert_allclose(
            space.basis @ (space.inverse @ chosen), at_nodes, atol=1e-11 * norm
        )


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("relative", [0.1, 1e-3, 1e-5])
def test_quiet_and_noisy_records_have_the_sse_of_every_sample(name: str, relative: float) -> None:
    family = FAMILIES[name]()
    data = records(family, 2, 6, seed=2, noise=relative)
    many = solve_many(family, data, 2)
    assert relative == 0.1 or (many.order == 2).all()
    for row in np.flatnonzero(many.order == 2):
        exact = family.build_block(data[row]).exact.evaluate(many.log_tau[row], False)
        rest = (
            exact.target - exact.fixed @ many.fixed_coefficients[row] - exact.arms @ many.arms[row]
        )
        assert many.sse[row] == pytest.approx(rest @ rest, rel=1e-9)


def test_batched_solver_isolates_a_bad_record() -> None:
    family = make_hold_family(TIME, depth=1.0, ramp_time=0.0)
    data = records(family, 2, 6, seed=3)
    good = solve_many(family, data, 2)
    data = data.copy()
    data[1, 7] = np.nan
    data[2] = 0.0
    data[3] = -data[3]
    data[4] = 1e300
    many = solve_many(family, data, 2)
    assert many.is_finite.tolist() == [True, False, True, True, False, True]
    assert many.order[1] == -1
    assert np.isnan(many.log_tau[1]).all()
    assert np.isnan(many.sse[1])
    assert many.order[2] == 0
    assert many.order[3] == 0
    for row in (0, 5):
        np.testing.assert_allclose(many.log_tau[row], good.log_tau[row], rtol=1e-11)
        assert many.sse[row] == pytest.approx(good.sse[row], rel=1e-11)


def test_clean_records_with_fewer_arms_return_fewer() -> None:
    family = make_hold_family(TIME, depth=1.0, ramp_time=0.0)
    data = 1 + 2 * np.exp(-TIME / np.array([[3.0], [0.7]]))
    many = solve_many(family, data, 2)
    assert many.order.tolist() == [1, 1]
    np.testing.assert_allclose(np.exp(many.log_tau[:, 0]), [3.0, 0.7], rtol=1e-9)
    assert np.isnan(many.log_tau[:, 1]).all()


def test_more_records_than_a_chunk_and_more_arms_than_the_first_look() -> None:
    time = np.arange(120) / 10
    generator = np.random.default_rng(0)
    data = 1 + np.exp(-time / generator.uniform(0.5, 3, (600, 1)))
    data += 1e-3 * generator.standard_normal(data.shape)
    many = solve_many(make_hold_family(time, depth=1.0, ramp_time=0.0), data, 1)
    assert many.converged.all()
    assert (many.order == 1).all()
    five = solve_many(make_hold_family(time, depth=1.0, ramp_time=0.0), data[:2], 5)
    assert (five.order >= 1).all()


def test_batched_solver_accepts_records_without_shared_terms() -> None:
    time = np.sort(np.random.default_rng(1).uniform(0, 20, 400))
    x = np.minimum(time, 1.0)
    force = np.vstack(
        [build_recorded_block(time, x, 0 * x).exact.evaluate(np.log([2.0]), False).arms.T]
    )
    data = force + x + 1e-3 * np.random.default_rng(2).standard_normal((3, 400))
    many = solve_separately(lambda y: build_recorded_block(time, x, y), data, 1, fixed_count=1)
    assert many.converged.all()
    np.testing.assert_allclose(np.exp(many.log_tau), 2.0, rtol=0.02)
    with pytest.raises(DataError, match="uniform grid"):
        make_recorded_family(time, x)


def test_refusals_say_what_was_expected() -> None:
    with pytest.raises(FitError, match="at least one"):
        solve_many(make_hold_family(TIME, depth=1.0, ramp_time=0.0), np.zeros((1, len(TIME))), 0)
    with pytest.raises(FitError, match="use fewer arms or longer records"):
        solve_many(make_hold_family(TIME[:4], depth=1.0, ramp_time=0.0), np.zeros((1, 4)), 3)
