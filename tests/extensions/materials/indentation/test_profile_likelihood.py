"""Profile intervals: their ends, their slices, and what a line says of them."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.extensions.materials.indentation.profile_likelihood import compute_profile
from dashpot.numerics.inference.covariance_estimate import Estimate, estimate, white_noise
from dashpot.numerics.least_squares import Parameter, Problem, Rows, require_optimum

TIME = np.linspace(0.0, 10.0, 400)
TRUTH = np.array([2.0, 1.0, 0.7])  # plateau, arm, relaxation time


def decay(y: np.ndarray) -> Problem:
    """A plateau and one arm; theta is ln tau."""

    def model(theta: np.ndarray) -> Rows:
        arm = np.exp(-TIME / np.exp(theta[0]))
        turned = arm * TIME / np.exp(theta[0])
        columns = np.stack((np.ones_like(TIME), arm), axis=1)
        return Rows(y, columns, lambda beta: (beta[1] * turned)[:, None])

    return Problem(model, [Parameter(-5.0, 5.0)], positive=True)


def noisy(seed: int, sd: float = 0.02) -> np.ndarray:
    force = TRUTH[0] + TRUTH[1] * np.exp(-TIME / TRUTH[2])
    return force + sd * np.random.default_rng(seed).standard_normal(len(TIME))


def ends(expected: Estimate, index: int = 0) -> tuple[float, float]:
    """Of a profile interval."""
    profile = compute_profile(expected, index)
    low, high = (float(profile[i].estimate.optimum.theta[index]) for i in (0, -1))
    return low, high


def test_a_profile_of_a_nearly_linear_theta_is_its_interval() -> None:
    best = require_optimum(decay(noisy(11, sd=0.002)), [np.zeros(1)])
    uncertainty = estimate(best, noises=[white_noise(best)])
    half = uncertainty.quantile() * uncertainty.standard_error[0]
    low, high = ends(uncertainty)
    np.testing.assert_allclose([best.theta[0] - low, high - best.theta[0]], half, rtol=0.02)


def test_a_profile_ends_where_the_deviance_is_that_of_the_level() -> None:
    """A poorly known arm: the ends are no longer even, and each is where the cost says."""
    y = noisy(12, sd=0.3)
    best = require_optimum(decay(y), [np.zeros(1)])
    noise = white_noise(best)
    uncertainty = estimate(best, noises=[noise])
    for end in ends(uncertainty):
        held = decay(y).solve_linear(np.array([end]))
        t = np.sqrt((held.cost - best.cost) / noise.power)
        assert t == pytest.approx(uncertainty.quantile(), rel=0.01)


def test_profile_slice_equals_the_problem_with_one_fixed_parameter() -> None:
    """Two arms: the others descend, and know nothing of an error of what is held."""
    draw = np.random.default_rng(14).standard_normal(len(TIME))
    y = np.exp(-TIME / 0.2) + np.exp(-TIME / 1.2) + 0.01 * draw

    def model(theta: np.ndarray) -> Rows:
        return Rows(y, np.exp(-TIME[:, None] / np.exp(theta)))

    problem = Problem(model, [Parameter(-6.0, 6.0)] * 2, positive=True)
    best = require_optimum(problem, [np.array([-1.6, 0.2])])
    uncertainty = estimate(best, noises=[white_noise(best)])
    slices = compute_profile(uncertainty, 0)
    roots = [item.root for item in slices]
    assert roots[0] == pytest.approx(uncertainty.quantile(), rel=0.01)
    assert min(roots) == roots[len(slices) // 2] == 0
    for root, held in slices:
        theta = held.optimum.theta
        again = require_optimum(problem.fix_parameter(0, theta[0]), [best.theta[1:]])
        np.testing.assert_allclose(theta[1:], again.theta, atol=1e-3)
        assert root**2 == pytest.approx(
            (again.cost - best.cost) / uncertainty.noises[0].power, rel=1e-2, abs=1e-6
        )
        assert held.standard_error[0] == 0
        assert (held.standard_error[1:] < uncertainty.standard_error[1:]).all()


def test_a_profile_that_nothing_ends_goes_to_the_range() -> None:
    y = noisy(13, sd=0.5)[:30]

    def model(theta: np.ndarray) -> Rows:
        return Rows(y, np.exp(-TIME[:30] / np.exp(theta[0]))[:, None])

    best = require_optimum(Problem(model, [Parameter(-3.0, 6.0)], positive=True), [np.ones(1)])
    assert ends(estimate(best))[1] == 6.0
