"""The farthest non-negative coefficients within a ball of the data."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize, nnls

from dashpot.base.errors import FitError
from dashpot.numerics.nonnegative_least_squares import NonnegativeConfidenceRegion


def relaxation_columns(per_decade: int = 64) -> tuple[np.ndarray, np.ndarray]:
    """Unit columns of decays on a fine grid, nearly parallel, and data of three of them."""
    t = np.linspace(0, 40, 400)
    tau = np.geomspace(0.05, 400, int(4 * per_decade))
    columns = np.column_stack([np.ones(len(t)), np.exp(-t[:, None] / tau)])
    target = 200 + 100 * np.exp(-t / 0.5) + 20 * np.exp(-t / 16.0)
    target = target + 0.05 * np.random.default_rng(4).standard_normal(len(t))
    return columns / np.linalg.norm(columns, axis=0), target


def test_confidence_region_least_squares_equals_scipy_nnls() -> None:
    columns, target = relaxation_columns()
    least = NonnegativeConfidenceRegion(columns, target).least()
    other = nnls(columns, target)[0]
    assert (least >= 0).all()
    ours, theirs = (np.sum((columns @ s - target) ** 2) for s in (least, other))
    assert ours == pytest.approx(theirs, rel=1e-10)
    again = NonnegativeConfidenceRegion(columns, target).least(least + 0.1)
    assert np.sum((columns @ again - target) ** 2) == pytest.approx(theirs, rel=1e-10)


def test_the_farthest_point_lies_on_the_ball_and_none_is_farther() -> None:
    """Against the conditions of the optimum: w <= 0 off the support, 0 on it."""
    columns, target = relaxation_columns()
    best = NonnegativeConfidenceRegion(columns, target).least()
    squared = float(np.sum((columns @ best - target) ** 2)) + 0.01
    draw = np.random.default_rng(1)
    for _ in range(6):
        aim = draw.standard_normal(columns.shape[1])
        farthest_point = NonnegativeConfidenceRegion(columns, target).find_farthest_point(
            aim, squared, best
        )
        residual = target - columns @ farthest_point
        assert (farthest_point >= 0).all()
        assert residual @ residual == pytest.approx(squared, rel=1e-9)
        on = farthest_point > 0
        multiplier = -float(columns[:, on][:, 0] @ residual) / aim[on][0]
        gain = columns.T @ residual + multiplier * aim
        assert multiplier > 0
        assert np.abs(gain[on]).max() < 1e-6
        assert gain[~on].max() < 1e-6


def test_few_columns_agree_with_a_general_solver() -> None:
    draw = np.random.default_rng(2)
    columns = draw.uniform(0, 1, (30, 5))
    columns /= np.linalg.norm(columns, axis=0)
    target = columns @ [1.0, 0.0, 2.0, 0.0, 0.5] + 0.1 * draw.standard_normal(30)
    best = NonnegativeConfidenceRegion(columns, target).least()
    squared = float(np.sum((columns @ best - target) ** 2)) + 0.1
    aim = draw.standard_normal(5)
    general = minimize(
        lambda s: -aim @ s,
        best,
        jac=lambda s: -aim,
        bounds=[(0, None)] * 5,
        constraints={
            "type": "ineq",
            "fun": lambda s: squared - np.sum((columns @ s - target) ** 2),
        },
        tol=1e-12,
    )
    assert aim @ NonnegativeConfidenceRegion(columns, target).find_farthest_point(
        aim, squared, best
    ) == pytest.approx(-general.fun, rel=1e-6)


def test_an_aim_that_the_best_ignores_is_still_reached() -> None:
    """No weight of the best lies on the first column; what may be there is not zero."""
    columns, target = relaxation_columns(8)
    target = target - 200.5
    best = NonnegativeConfidenceRegion(columns, target).least()
    assert best[0] == 0
    aim = np.zeros(len(best))
    aim[0] = 1.0
    squared = 1.5 * float(np.sum((columns @ best - target) ** 2))
    assert (
        NonnegativeConfidenceRegion(columns, target).find_farthest_point(aim, squared, best)[0] > 0
    )
    assert (
        (NonnegativeConfidenceRegion(columns, target).find_farthest_point(-aim, squared, best)[0])
        == 0
    )
    assert (
        NonnegativeConfidenceRegion(columns, target).find_farthest_point(0 * aim, squared, best)
        == best
    ).all()


def test_equal_columns_do_not_turn_in_a_circle() -> None:
    columns, target = relaxation_columns(8)
    twice = np.column_stack((columns, columns))
    best = NonnegativeConfidenceRegion(twice, target).least()
    squared = float(np.sum((twice @ best - target) ** 2)) + 0.01
    once = NonnegativeConfidenceRegion(columns, target).least()
    assert np.sum((twice @ best - target) ** 2) == pytest.approx(
        np.sum((columns @ once - target) ** 2), rel=1e-9
    )
    aim = np.zeros(len(best))
    aim[[0, columns.shape[1]]] = 1.0
    farthest_point = NonnegativeConfidenceRegion(twice, target).find_farthest_point(
        aim, squared, best
    )
    single = NonnegativeConfidenceRegion(columns, target).find_farthest_point(
        aim[: columns.shape[1]], squared, once
    )
    assert aim @ farthest_point == pytest.approx(single[0], rel=1e-6)


def test_fewer_samples_than_terms_bound_nothing() -> None:
    """Two samples and three terms: the third could grow for ever and be taken back."""
    columns = np.array([[1.0, 0.0, 0.6], [0.0, 1.0, 0.8]])
    target = columns @ [1.0, 1.0, 0.0]
    with pytest.raises(FitError, match="too few samples"):
        NonnegativeConfidenceRegion(columns, target).find_farthest_point(
            np.array([-1.0, -1.0, 5.0]), 1.0, np.array([1.0, 1.0, 0.0])
        )


def test_confidence_region_answer_is_independent_of_earlier_queries() -> None:
    """Faces that are remembered, grown and shrunk are those that are factored anew."""
    columns, target = relaxation_columns(16)
    requested = NonnegativeConfidenceRegion(columns, target)
    best = requested.least()
    squared = float(np.sum((columns @ best - target) ** 2)) + 0.01
    draw, t = np.random.default_rng(3), np.geomspace(0.01, 1000, columns.shape[1])
    aims = [draw.standard_normal(columns.shape[1]) for _ in range(8)]
    aims += [np.exp(-value / t) for value in np.geomspace(0.1, 100, 40)]
    for aim in aims:
        before, anew = requested, NonnegativeConfidenceRegion(columns, target)
        reach = aim @ anew.find_farthest_point(aim, squared, best)
        assert aim @ before.find_farthest_point(aim, squared, best) == pytest.approx(
            reach, rel=1e-9
        )
