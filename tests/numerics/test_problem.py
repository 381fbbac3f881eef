"""The least-squares problem: derivatives, optima with sign constraints, covariance and priors."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.slopes import hold_slopes
from scipy.optimize import least_squares, nnls

from dashpot.base.errors import DataError, FitError
from dashpot.extensions.materials.systematic_error import estimate_parameter_shift
from dashpot.numerics.inference.covariance_estimate import estimate, score, white_noise
from dashpot.numerics.least_squares import (
    Optimum,
    Parameter,
    Problem,
    Rows,
    _is_predicted,
    require_optimum,
    stack_real_rows,
)
from dashpot.numerics.nonnegative_least_squares import MANY_COLUMNS, solve_linear

TIME = np.linspace(0.0, 10.0, 400)
TRUTH = np.array([2.0, 1.0, 0.7])  # plateau, arm, relaxation time


def decay(y: np.ndarray, *, slopes: bool = True) -> Problem:
    """A plateau and one arm; theta is ln tau."""

    def model(theta: np.ndarray) -> Rows:
        arm = np.exp(-TIME / np.exp(theta[0]))
        A = np.stack((np.ones_like(TIME), arm), axis=1)
        turned = arm * TIME / np.exp(theta[0])
        return Rows(y, A, (lambda beta: (beta[1] * turned)[:, None]) if slopes else None)

    return Problem(model, [Parameter(-5.0, 5.0)], positive=True)


def noisy(seed: int, sd: float = 0.02) -> np.ndarray:
    force = TRUTH[0] + TRUTH[1] * np.exp(-TIME / TRUTH[2])
    return force + sd * np.random.default_rng(seed).standard_normal(len(TIME))


@pytest.mark.parametrize("slopes", [True, False])
def test_the_optimum_is_that_of_a_library_over_everything(slopes: bool) -> None:
    y = noisy(1)
    optimum = require_optimum(decay(y, slopes=slopes), [np.array([1.5])])

    def compute_residual(x: np.ndarray) -> np.ndarray:
        return x[1] + x[2] * np.exp(-TIME / np.exp(x[0])) - y

    other = least_squares(compute_residual, [0.0, 1.0, 1.0], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    np.testing.assert_allclose(optimum.values, other.x, rtol=1e-5 if not slopes else 1e-7)
    assert optimum.cost == pytest.approx(2 * other.cost, rel=1e-10)
    assert optimum.stationary


@given(st.floats(-3, 3), st.integers(0, 50))
@settings(max_examples=20, deadline=None)
def test_the_gradient_is_that_of_the_projected_cost(theta: float, seed: int) -> None:
    problem, h = decay(noisy(seed)), 1e-5
    here = problem.solve_linear(np.array([theta]))
    costs = [problem.solve_linear(np.array([theta + sign * h])).cost for sign in (-1, 1)]
    slope = (costs[1] - costs[0]) / (2 * h)
    assert 2 * here.gradient[0] == pytest.approx(slope, rel=1e-4, abs=1e-6 * here.cost + 1e-8)


def test_the_slope_is_the_difference_of_the_model() -> None:
    hold_slopes(decay(noisy(0)), np.array([0.3]), TRUTH[:2])
    wrong = decay(noisy(0)).model(np.array([0.3]))._replace(slope=lambda beta: np.ones((400, 1)))
    with pytest.raises(AssertionError, match="theta 0"):
        hold_slopes(Problem(lambda _: wrong, [Parameter()]), np.array([0.3]), TRUTH[:2])


def test_a_start_in_a_bad_place_is_not_followed() -> None:
    y = noisy(2)
    starts = [np.array([item]) for item in (-4.9, 0.0, 4.9)]
    both = [decay(y).solve(starts, screening_steps=screening_steps) for screening_steps in (0, 3)]
    assert both[0] is not None
    assert both[1] is not None
    assert both[1].cost == pytest.approx(both[0].cost, rel=1e-10)


def test_valleys_do_not_repeat_a_visited_valley() -> None:
    """Valleys at 0 and 3 in sizes of 10; the third start leads to the first."""
    theta = []

    def model(at: np.ndarray) -> Rows:
        theta.append(x := at[0] / 10)
        slope = np.array([[(x - 3) + x, 0.0]]).T / 10
        return Rows(-np.array([x * (x - 3), 1.0]), np.empty((2, 0)), lambda _: slope)

    problem = Problem(model, [Parameter(-50.0, 80.0, 10.0)])
    starts = [np.array([item]) for item in (-9.0, 39.0, 8.0)]
    optimums = problem.find_optima(starts, same_distance=0.1)
    np.testing.assert_allclose([optimum.theta[0] for optimum in optimums], [0.0, 30.0], atol=1e-8)
    # within `is_same_unit` of the first it is left
    assert 1e-4 < abs(theta[-1]) < 0.1
    assert len(problem.find_optima(starts)) == 3


def test_a_parameter_stays_in_its_range() -> None:
    optimum = require_optimum(
        Problem(decay(noisy(3)).model, [Parameter(0.5, 2.0)], positive=True), [np.array([9.0])]
    )
    assert optimum.theta[0] == 0.5
    low, high, _ = optimum.problem.bounds
    assert ((optimum.theta <= low) | (optimum.theta >= high)).any()
    assert optimum.stationary


def test_sizes_of_parameters_do_not_change_the_optimum() -> None:
    y = noisy(4)
    base = decay(y)

    def model(theta: np.ndarray) -> Rows:
        rows = base.model(theta / 1e4)
        assert rows.slope is not None
        slope = rows.slope
        return rows._replace(slope=lambda beta: slope(beta) / 1e4)

    scaled = Problem(model, [Parameter(-5e4, 5e4, 1e4)], positive=True)
    optimum, other = require_optimum(base, [np.ones(1)]), require_optimum(scaled, [np.full(1, 1e4)])
    assert other.theta[0] / 1e4 == pytest.approx(optimum.theta[0], rel=1e-9)
    uncertainty = estimate(other)
    assert uncertainty.standard_error[0] == pytest.approx(
        1e4 * estimate(optimum).standard_error[0], rel=1e-6
    )


def test_exact_data_are_followed_to_rounding() -> None:
    optimum = require_optimum(decay(noisy(0, sd=0.0)), [np.array([1.0])])
    np.testing.assert_allclose(optimum.values, [np.log(0.7), 2.0, 1.0], rtol=1e-10)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("off", "retained"), [(0.249, True), (0.251, False)])
def test_hessian_correction_is_reused_if_it_predicts_the_fall(
    off: float, retained: bool, sign: int
) -> None:
    """A parabola whose J'J lacks 1 of 3: the true fall, and one that is a quarter off."""
    step, gradient = np.array([-1.0]), np.array([3.0])
    lacking, curvature = np.eye(1), 2 * np.eye(1)
    fall = -float(step @ (2 * gradient + (curvature + lacking) @ step))
    old = SimpleNamespace(sse=10.0, gradient=gradient, curvature=curvature)
    new = SimpleNamespace(sse=10.0 - fall * (1 + sign * off))
    assert _is_predicted(lacking, old, new, step) is retained
    assert _is_predicted(None, old, new, step)


def test_where_a_model_says_nothing_no_descent_begins_and_none_ends() -> None:
    y = noisy(5)

    def model(theta: np.ndarray) -> Rows:
        if theta[0] > 1.0:
            raise DataError("beyond")
        return decay(y).model(theta)

    problem = Problem(model, [Parameter(-5, 5)], positive=True)
    assert problem.solve([np.array([2.0])]) is None
    with pytest.raises(FitError, match="says nothing"):
        require_optimum(problem, [np.array([2.0])])
    optimum = require_optimum(problem, [np.array([2.0]), np.array([0.9])])
    assert optimum.theta[0] == pytest.approx(
        require_optimum(decay(y), [np.zeros(1)]).theta[0], abs=1e-8
    )


def test_gauge_selects_one_of_equivalent_optima() -> None:
    """Two thetas of which only the sum counts; their difference is meant to be one."""
    y = noisy(6)

    def model(theta: np.ndarray) -> Rows:
        rows = decay(y).model(theta.sum(keepdims=True))
        assert rows.slope is not None
        slope = rows.slope
        return rows._replace(slope=lambda beta: np.repeat(slope(beta), 2, axis=1))

    def gauge(theta: np.ndarray) -> np.ndarray:
        return theta.mean() + np.array([0.5, -0.5])

    optimum = require_optimum(
        Problem(model, [Parameter(), Parameter()], True, gauge=gauge), [np.zeros(2)]
    )
    assert optimum.theta[0] - optimum.theta[1] == pytest.approx(1.0)
    assert optimum.theta.sum() == pytest.approx(
        require_optimum(decay(y), [np.zeros(1)]).theta[0], abs=1e-6
    )


@given(st.integers(0, 2**31), st.integers(1, 40), st.booleans())
@settings(max_examples=60, deadline=None)
def test_solve_linear_with_sign_constraints_equals_a_library(seed: int, q: int, free: bool) -> None:
    """Few and many columns; one of them may be free, as plus and minus for the library."""
    generator = np.random.default_rng(seed)
    A = generator.standard_normal((q + 20, q))
    y = generator.standard_normal(q + 20)
    must = np.ones(q, dtype=bool)
    must[0] = not free
    beta, basis = solve_linear(A, y, must)
    columns = np.column_stack((A, -A[:, ~must]))
    assert (beta[must] >= 0).all()
    norm = np.linalg.norm(y - A @ beta)
    assert norm == pytest.approx(nnls(columns, y)[1], rel=1e-9)
    np.testing.assert_allclose(basis().T @ basis(), np.eye(basis().shape[1]), atol=1e-12)
    assert np.linalg.norm(y - basis() @ (basis().T @ y)) == pytest.approx(norm, rel=1e-9)


@pytest.mark.parametrize("q", [MANY_COLUMNS, MANY_COLUMNS + 1])
def test_few_and_many_nearly_dependent_columns_are_solved_alike(q: int) -> None:
    t = np.geomspace(1e-3, 1e3, 90)
    A = np.exp(-t[:, None] / np.geomspace(1e-3, 1e3, q))
    y = 1 / (1 + t**0.3)
    beta, _ = solve_linear(A, y, positive=True)
    assert (beta >= 0).all()
    assert np.linalg.norm(y - A @ beta) == pytest.approx(nnls(A, y)[1], rel=1e-6)


@pytest.mark.parametrize("rows", [90, 400])
@pytest.mark.parametrize("per_decade", [4, 8, 12])
def test_columns_whose_signs_are_rounding_lose_nothing_of_exact_data(
    rows: int, per_decade: int
) -> None:
    t, tau = np.geomspace(1e-3, 1e3, rows), np.geomspace(1e-4, 1e4, 8 * per_decade + 1)
    A = np.exp(-t[:, None] / tau)
    y = A @ np.exp(-(np.log(tau) ** 2) / 20)
    beta, _ = solve_linear(A, y, positive=True)
    assert (beta >= 0).all()
    assert np.linalg.norm(y - A @ beta) < 2e-8 * np.linalg.norm(y)


@pytest.mark.parametrize("positive", [True, False])
def test_of_dependent_columns_the_first_carries_the_weight(positive: bool) -> None:
    beta, basis = solve_linear(np.ones((5, 2)), np.full(5, 3.0), positive)
    np.testing.assert_allclose(beta, [3.0, 0.0], atol=1e-12)
    assert basis().shape == (5, 1)


@pytest.mark.parametrize(("separate", "rank"), [(3e-14, 1), (1e-12, 2)])
def test_columns_are_dependent_where_rounding_parts_them(separate: float, rank: int) -> None:
    A = np.ones((6, 2))
    A[0, 1] += separate
    assert solve_linear(A, np.arange(6.0))[1]().shape == (6, rank)


def test_more_columns_than_rows_are_dependent() -> None:
    A = np.random.default_rng(0).standard_normal((3, 5))
    beta, basis = solve_linear(A, np.ones(3))
    np.testing.assert_allclose(A @ beta, 1.0)
    assert basis().shape == (3, 3)


def test_a_column_of_nothing_has_no_coefficient() -> None:
    beta, _ = solve_linear(np.array([[1.0, 0.0], [1.0, 0.0]]), np.ones(2))
    np.testing.assert_allclose(beta, [1.0, 0.0])


def line(y: np.ndarray, priors: np.ndarray | None = None) -> Problem:
    x = np.linspace(-1, 1, len(y))
    A = np.stack((np.ones_like(x), x), axis=1)
    if priors is not None:
        return Problem(
            lambda _: Rows(np.append(y, 0.0), np.vstack((A, [0.0, 1 / priors]))), priors=1
        )
    return Problem(lambda _: Rows(y, A))


def test_estimate_of_a_line_equals_the_textbook() -> None:
    generator = np.random.default_rng(7)
    y = 3 + 2 * np.linspace(-1, 1, 200) + generator.standard_normal(200)
    best = require_optimum(line(y))
    uncertainty = estimate(best, noises=[white_noise(best)])
    x = np.linspace(-1, 1, 200)
    variance = best.sse / 198
    np.testing.assert_allclose(uncertainty.standard_error**2, variance / np.array([200, x @ x]))
    two = uncertainty.derive_quantity(lambda beta: np.array([beta[0] + beta[1], beta[0] * 2]))
    np.testing.assert_allclose(
        two.standard_error**2, variance * np.array([1 / 200 + 1 / (x @ x), 4 / 200]), rtol=1e-8
    )
    assert uncertainty.dof == 198
    assert uncertainty.quantile() == pytest.approx(1.972, abs=1e-3)


def test_estimate_with_a_prior_is_narrower() -> None:
    """A normal prior on the slope, of the noise's own standard deviation, and its posterior."""
    generator = np.random.default_rng(8)
    y = 3 + generator.standard_normal(50)
    best = require_optimum(line(y, priors=np.float64(1.0)))
    assert len(best.residual) == 50
    uncertainty = estimate(best, noises=[white_noise(best, variance=1.0)])
    x = np.linspace(-1, 1, 50)
    assert uncertainty.covariance[1, 1] == pytest.approx(1 / (x @ x + 1))
    assert best.sse < best.cost


def test_estimate_uses_the_noise_of_each_record() -> None:
    generator = np.random.default_rng(9)
    y = np.concatenate((generator.standard_normal(100), 10 * generator.standard_normal(300)))
    A = np.repeat([[1.0, 0.0], [0.0, 1.0]], [100, 300], axis=0)
    uncertainty = estimate(require_optimum(Problem(lambda _: Rows(y, A))), parts=[100, 300])
    ratio = uncertainty.standard_error * np.sqrt([100, 300])
    np.testing.assert_allclose(ratio, [1.0, 10.0], rtol=0.25)
    assert len(uncertainty.noises) == 2


def test_estimate_gives_no_error_at_zero_unless_requested() -> None:
    y = noisy(1) - 3.0  # no plateau
    best = require_optimum(decay(y), [np.zeros(1)])
    assert best.beta[0] == 0
    assert estimate(best).standard_error[1] == 0
    bound = estimate(best, is_bounded=np.array([True, False]))
    assert bound.standard_error[1] > 0


def test_a_theta_that_is_held_has_no_error_and_takes_none() -> None:
    best = require_optimum(decay(noisy(2)), [np.zeros(1)])
    free, held = estimate(best), estimate(best, is_fixed=np.array([True]))
    assert held.standard_error[0] == 0
    assert (held.standard_error[1:] < free.standard_error[1:]).all()
    np.testing.assert_array_equal(
        estimate(best, is_fixed=np.array([False])).covariance, free.covariance
    )


def test_derived_quantity_of_undetermined_parameters_is_undetermined() -> None:
    x = np.linspace(-1, 1, 50)
    A = np.column_stack((x, np.ones(50), np.ones(50)))
    best = require_optimum(Problem(lambda _: Rows(x + 1, A)))
    uncertainty = estimate(best, noises=[white_noise(best, variance=1.0)])
    derived_quantity = uncertainty.derive_quantity(
        lambda values: np.array([2 * values[0], values[0] + values[1]])
    )
    np.testing.assert_allclose(derived_quantity.covariance, [[4 / (x @ x), 0.0], [0.0, np.inf]])


def test_a_systematic_error_moves_as_the_refit_does() -> None:
    y, small = noisy(10), 1e-4 * np.sin(TIME)
    best = require_optimum(decay(y), [np.zeros(1)])
    uncertainty = estimate(best)
    refitted = require_optimum(decay(y + small), [best.theta])
    by = estimate_parameter_shift(uncertainty, -small)
    np.testing.assert_allclose(by, refitted.values - best.values, rtol=0.02, atol=1e-6)
    assert (uncertainty.add_parameter_error(by).standard_error > uncertainty.standard_error).all()


@pytest.mark.parametrize("sd", [0.0, 0.01])
def test_the_score_prefers_what_is_there(sd: float) -> None:
    """A second arm that is not there, and one that is, beside a floor of rounding."""

    def arms(count: int, y: np.ndarray) -> Optimum:
        def model(theta: np.ndarray) -> Rows:
            A = np.exp(-TIME[:, None] / np.exp(theta))
            return Rows(y, np.column_stack((np.ones_like(TIME), A)))

        span = np.log([0.2, 3.0, 1.0])[:count]
        return require_optimum(Problem(model, [Parameter(-4, 4)] * count, positive=True), [span])

    for truth in (1, 2):
        y = 2 + np.exp(-TIME / 0.3) + (truth == 2) * np.exp(-TIME / 4)
        y = y + sd * np.random.default_rng(14).standard_normal(len(y))
        armss = [arms(n, y) for n in (1, 2, 3)]
        scores = [score(item, len(y), rounding_sse=100 * item.rounding_sse) for item in armss]
        assert int(np.argmin(scores)) + 1 == truth


def test_complex_rows_are_real_ones_twice() -> None:
    np.testing.assert_array_equal(stack_real_rows(np.array([1 + 2j, 3 - 4j])), [1, 3, 2, -4])
    assert stack_real_rows(np.ones((2, 3), dtype=complex)).shape == (4, 3)
