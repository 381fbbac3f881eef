"""Non-negative least squares: optimality conditions and an oracle."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.numerics.nonnegative_least_squares import solve_nonnegative


@given(st.integers(0, 2**31), st.integers(1, 40), st.sampled_from([0.0, 0.3, 3.0]))
@settings(max_examples=60, deadline=None)
def test_the_optimality_conditions_hold(seed: int, n: int, noise: float) -> None:
    generator = np.random.default_rng(seed)
    a = generator.standard_normal((n + 5, n))
    y = a @ np.maximum(generator.standard_normal(n), 0.0)
    y = y + noise * generator.standard_normal(len(y))
    x = solve_nonnegative(a.T @ a, a.T @ y)
    slope = a.T @ (y - a @ x)
    scale = np.linalg.norm(a, axis=0).max() * np.linalg.norm(y) + 1e-12
    assert (x >= 0).all()
    assert slope.max() <= 1e-9 * scale
    assert np.abs(slope[x > 0]).max(initial=0.0) <= 1e-9 * scale


@pytest.mark.parametrize("per_decade", [2, 4, 8])
def test_exponentials_are_solved_as_by_scipy(per_decade: int) -> None:
    """Nearly dependent columns of unit length; the sum of squares is the judge."""
    from scipy.optimize import nnls

    t = np.geomspace(1e-4, 1e4, 120)
    tau = np.geomspace(1e-4, 1e4, 8 * per_decade + 1)
    a = np.exp(-t[:, None] / tau)
    a = a / np.linalg.norm(a, axis=0)
    y = 1 / (1 + t**0.2) + 0.003 * np.random.default_rng(0).standard_normal(len(t))
    x = solve_nonnegative(a.T @ a, a.T @ y)
    assert (x >= 0).all()
    assert np.linalg.norm(a @ x - y) == pytest.approx(nnls(a, y)[1], rel=1e-8)


def test_nothing_fits_what_points_away() -> None:
    np.testing.assert_array_equal(solve_nonnegative(np.eye(3), -np.ones(3)), np.zeros(3))
