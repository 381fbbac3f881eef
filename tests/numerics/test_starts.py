"""Starting points: the grid, and the cached sampling."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations, product

import numpy as np
import pytest

from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import solve
from dashpot.numerics.log_tau_descent import (
    ColumnGrid,
    Grid,
    Stack,
    find_best_pair,
    find_best_point,
    find_best_triple,
)

TIME = np.arange(3000) / 100
GENERATOR = np.random.default_rng(3)
SETS = {1: find_best_point, 2: find_best_pair, 3: find_best_triple}


def record(arms: int) -> np.ndarray:
    tau = 0.1 * 7.0 ** np.arange(arms) * np.exp(GENERATOR.uniform(-0.5, 0.5, arms))
    clean = 2 + np.exp(-TIME[:, None] / tau) @ GENERATOR.uniform(0.5, 2, arms)
    return clean + 0.05 * GENERATOR.standard_normal(len(TIME))


@pytest.mark.parametrize("arms", SETS)
@pytest.mark.parametrize("seen", [1, 2, 3])
def test_the_best_set_of_grid_points_is_that_of_brute_force(arms: int, seen: int) -> None:
    stack = Stack([build_hold_block(TIME, record(seen))])
    grid = Grid(stack, 16)
    rows = stack.evaluate(grid.log_tau, derivative=False)
    target, phi = rows.target, rows.phi

    def best_of(sets: Iterable[tuple[int, ...]]) -> tuple[int, ...]:
        best, where = np.inf, ()
        for chosen in sets:
            columns = phi[:, [0, *(1 + i for i in chosen)]]
            beta = np.linalg.lstsq(columns, target, rcond=None)[0]
            sse = float(np.square(target - columns @ beta).sum())
            if (beta[1:] > 0).all() and sse < best:
                best, where = sse, chosen
        return where

    if arms < 3:
        where = best_of(combinations(range(16), arms))
    else:
        where = best_of(combinations(range(0, 16, 3), 3))
        near = [range(max(i - 2, 0), min(i + 3, 16)) for i in where]
        where = best_of(chosen for chosen in product(*near) if len(set(chosen)) == 3 and where)
    result = SETS[arms](grid)
    if not where:
        assert result is None
    else:
        assert result is not None
        step = grid.log_tau[1] - grid.log_tau[0]
        off = np.abs(np.sort(result) - grid.log_tau[sorted(where)]).max()
        assert off <= (step if arms == 2 else 0)


def test_a_pair_is_started_from_between_the_grid_points() -> None:
    from_start, from_points = [], []
    for _ in range(24):
        stack = Stack([build_hold_block(TIME, record(2))])
        grid = Grid(stack, 48)
        start, log_tau = find_best_pair(grid), solve(stack.blocks, 2).log_tau
        assert start is not None
        from_start.append(np.abs(start - log_tau).max())
        from_points.append(np.abs(grid.log_tau[:, None] - log_tau).min(axis=0).max())
    # a pair that the noise hides is found elsewhere, so the middle one is asked
    assert np.median(from_start) < 0.5 * np.median(from_points)


def test_rising_data_have_no_set_of_positive_arms() -> None:
    grid = Grid(Stack([build_hold_block(TIME, 1 - np.exp(-TIME / 3))]), 12)
    assert all(best_set(grid) is None for best_set in SETS.values())


def test_cached_lattice_equals_a_new_one() -> None:
    records = [record(2) for _ in range(3)]
    blocks = [
        *(build_hold_block(TIME, y) for y in records),
        *(build_hold_block(TIME, y, k_inf=None) for y in records[:2]),
        *(build_hold_block(2 * TIME, y) for y in records[:2]),
        *(
            build_hold_block(TIME, y, depth=2.0, ramp_time=c)
            for y in records[:2]
            for c in (0.5, 1.0)
        ),
        *(build_hold_block(TIME, y, depth=2.0, ramp_time=1.0, drift="d") for y in records[:2]),
        *(build_hold_block(TIME, y, depth=2.0, ramp_time=1.0, ramp=True) for y in records[:2]),
        *(build_hold_block(TIME, y) for y in records),
    ]
    for block in blocks:
        stack = Stack([block])
        grid = Grid(stack)
        lattice, target = ColumnGrid.from_stack(stack, grid.log_tau)
        np.testing.assert_array_equal(grid.columns, lattice.rows.T)
        np.testing.assert_array_equal(grid.moment, lattice.rows @ target)
        np.testing.assert_array_equal(grid.gram, lattice.gram)


def test_weighted_and_uneven_blocks_use_no_cached_sampling() -> None:
    y = record(2)
    weights = 1 + np.exp(-TIME)
    assert build_hold_block(TIME, y).sampling is not None
    assert build_hold_block(TIME, y, weights=weights).sampling is None
    assert build_hold_block(TIME**1.1, y).sampling is None
    # the second of two such fits is its own
    first = solve([build_hold_block(TIME**1.1, y)], 2)
    again = solve([build_hold_block(TIME**1.2, y)], 2)
    assert np.abs(first.log_tau - again.log_tau).max() > 0.01
