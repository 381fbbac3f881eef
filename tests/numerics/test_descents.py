"""Descents side by side: Newton's, with what a large residual adds to the curvature."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import solve
from dashpot.numerics.inference.profile_likelihood import (
    BatchedDescent,
    Coordinate,
    ProfileTarget,
    SolvedTrials,
    compute_profiles,
)
from dashpot.numerics.least_squares import (
    Objective,
    Parameter,
    Problem,
    Rows,
    _compute_trial,
    descend,
    require_optimum,
)
from dashpot.numerics.log_tau_descent import Stack

SHARES = np.array([-0.75, -0.4, 0.0, 0.6])
CURVATURE = np.array([[4.0, 1.0], [1.0, 3.0]])


def parabola(log_tau: np.ndarray, share: np.ndarray) -> SolvedTrials:
    """An SSE about the origin whose curvature is 1 + share times J'J."""
    bent = share[:, None, None] * CURVATURE
    pull = -((CURVATURE + bent) @ log_tau[:, :, None])[..., 0]
    sse = 100.0 - np.vecdot(log_tau, pull)
    count = len(log_tau)
    return SolvedTrials(sse, np.zeros((count, 1)), pull, np.tile(CURVATURE, (count, 1, 1)), bent)


def trials_needed(descents: BatchedDescent) -> np.ndarray:
    """Trials that each descent takes to its end."""
    on, needed = np.arange(len(SHARES)), np.zeros(len(SHARES), int)
    while on.size:
        trial = descents.positions[on] + descents.steps[on]
        done = descents.take(trial, parabola(trial, SHARES[on]), on)
        needed[on] += 1
        on = on[~done]
    return needed


def test_a_parabola_takes_two_trials_whatever_the_residual_adds() -> None:
    descents = BatchedDescent(np.tile([0.3, -0.2], (4, 1)), 1, np.full(4, 1e-9))
    # where it begins, and where the whole curvature sends it
    assert np.all(trials_needed(descents) == 2)
    assert [descents.best(i)[0] for i in range(4)] == pytest.approx([100.0] * 4, abs=1e-8)


@pytest.mark.parametrize(("share", "believed"), [(-0.89, True), (-0.91, False)])
def test_a_curvature_that_the_residual_all_but_cancels_is_not_believed(
    share: float, believed: bool
) -> None:
    descents = BatchedDescent(np.array([[0.01, 0.0]]), 1, np.array([1e-9]))
    here, on = descents.positions.copy(), np.array([0])
    descents.take(here, parabola(here, np.array([share])), on)
    newton, gauss = np.array([-0.01, 0.0]), (1.0 + share) * np.array([-0.01, 0.0])
    assert descents.steps[0] == pytest.approx(newton if believed else gauss, rel=1e-4, abs=1e-8)


def test_after_a_move_that_failed_the_next_goes_a_quarter_as_far() -> None:
    descents = BatchedDescent(np.array([[1.2, 0.0]]), 1, np.array([1e-9]))
    here, on = descents.positions.copy(), np.array([0])
    descents.take(here, parabola(here, SHARES[2:3]), on)
    went = float(np.abs(descents.steps).max())
    assert went == pytest.approx(1.2, rel=1e-4)
    worse = parabola(np.array([[3.0, 0.0]]), SHARES[2:3])
    descents.take(here + descents.steps, worse, on)
    assert float(np.abs(descents.steps).max()) == pytest.approx(0.25 * went)
    assert np.all(descents.positions == here)


@pytest.mark.parametrize(
    ("held", "coordinate", "index"),
    [("c", Coordinate.LINEAR, 0), ("k", Coordinate.LINEAR, 1), ("ln b", Coordinate.LOG_B, 0)],
)
def test_profile_with_too_few_arms_equals_brute_force_refit(
    held: str, coordinate: Coordinate, index: int
) -> None:
    time = np.linspace(0.0, 10.0, 400)
    values = 1.0 + 0.8 * np.exp(-time / 0.3) + 0.5 * np.exp(-time / 4.0)
    block = build_hold_block(time, values)
    solution = solve([block], 1)
    scale = solution.sse / 8.0
    profile_target = ProfileTarget(coordinate, index, step=0.02, scale=scale)
    ((value, deviance),) = compute_profiles(Stack([block]), solution, [profile_target], limit=20.0)
    c, k, ln_tau = *solution.beta, solution.log_tau[0]

    def compute_refit_cost(at: float) -> float:
        def residual(q: np.ndarray) -> np.ndarray:
            solid = {"c": (at, *q), "k": (q[0], at, q[1]), "ln b": (q[0], np.exp(at - q[1]), q[1])}
            level, stiffness, arm = solid[held]
            return level + stiffness * np.exp(-time / np.exp(arm)) - values

        start = np.array([k if held == "c" else c, ln_tau])
        fit = least_squares(
            residual, start, bounds=([0.0, -np.inf], np.inf), xtol=1e-14, gtol=1e-14
        )
        return 2.0 * float(fit.cost)

    rises = deviance < 16.0
    assert rises.sum() > 8
    expected = [(compute_refit_cost(at) - solution.sse) / scale for at in value[rises]]
    assert deviance[rises] == pytest.approx(np.array(expected), abs=2e-3, rel=1e-3)


@pytest.mark.parametrize(("carried", "sensed"), [(1.001e-12, 1.001e-12), (0.999e-12, 1e-12)])
def test_the_steps_of_a_parameter_that_has_faded_are_damped_as_if_it_carried_a_little(
    carried, sensed
):
    """Else damping would not shorten them, and a refused step would stop all others first."""

    class Point:
        theta, gradient = np.zeros(2), np.array([0.0, 1e-12])
        curvature = np.diag([1.0, carried])

    wide = [-10.0, -10.0], [10.0, 10.0]
    step = _compute_trial(Point(), None, 10.0, wide)
    assert step[1] == pytest.approx(-1e-12 / (carried + 10.0 * sensed), rel=1e-9)


@pytest.mark.parametrize(
    ("refused", "gained", "damping"),
    [(True, 0.749, 1.0), (True, 0.751, 0.5), (False, 0.749, 0.1), (False, 0.751, 0.1)],
)
def test_after_a_refused_step_damping_falls_slowly_and_not_where_little_was_gained(
    refused, gained, damping
):
    """Of the fall that the accepted step promised it gains so much; damping then is so many times
    what it was, as the length of the next step shows."""
    at, first = [], 10.0 if refused else 1.0
    step = 1 / (1 + first)
    falls = [0.0, *[-1.0] * (2 * refused), gained * step * (2 - step), 5.0]

    class Point:
        beta, gradient, curvature = np.empty(0), -np.ones(1), np.eye(1)

    def point(theta, _):
        here = Point()
        here.theta, here.sse = theta, 10.0 - falls[len(at)]
        at.append(float(theta[0]))
        return here

    objective = Objective(point, np.full(1, -9.0), np.full(1, 9.0))
    # a step that raises the SSE is followed by one from where it ends, which is none better
    descend(objective, np.zeros(1), damping=1.0, limit=2 + refused)
    assert at[-2] == pytest.approx(step)
    assert at[-1] - at[-2] == pytest.approx(1 / (1 + damping * first))


def test_a_descent_follows_a_valley_that_bends():
    """Rosenbrock's, thirty times as narrow: a step along it ends on its side."""
    taken = []

    def model(theta):
        taken.append(theta)
        x, y = theta
        J = np.array([[-600.0 * x, 300.0], [-1.0, 0.0]])
        return Rows(-np.array([300.0 * (y - x * x), 1.0 - x]), np.empty((2, 0)), lambda _: J)

    optimum = require_optimum(
        Problem(model, [Parameter(-3.0, 3.0)] * 2), [np.array([-1.2, 1.0])], max_steps=200
    )
    assert optimum.theta == pytest.approx(np.ones(2), abs=1e-9)
    assert optimum.stationary
    assert len(taken) < 200
