"""Profile likelihood against brute force: scipy fits everything else again at each value."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import Solution, solve
from dashpot.numerics.inference.profile_likelihood import (
    Coordinate,
    ProfileTarget,
    compute_profiles,
)
from dashpot.numerics.log_tau_descent import Stack

TIME = np.linspace(0.0, 10.0, 400)
NOISE = 0.02


@pytest.fixture(scope="module")
def problem() -> tuple[Stack, Solution, np.ndarray]:
    """Two arms, the slow one nearly a constant: skewed likelihoods."""
    random = np.random.default_rng(4)
    values = 1.0 + 0.8 * np.exp(-TIME / 0.3) + 0.3 * np.exp(-TIME / 9.0)
    values = values + NOISE * random.standard_normal(len(TIME))
    block = build_hold_block(TIME, values)
    return Stack([block]), solve([block], 2), values


def brute(values: np.ndarray, optimum: Solution, held: str, at: float) -> float:
    """SSE of the best fit, nothing negative, with one coordinate held, from several starts."""
    c, k1, k2 = optimum.beta
    a, b = optimum.log_tau

    def solid(q: np.ndarray) -> tuple[float, ...]:
        if held == "c":
            return at, q[0], q[1], q[2], q[3]
        if held == "ln tau":
            return q[0], q[1], q[2], q[3], at
        return q[0], q[1], float(np.exp(at - q[3])), q[2], q[3]

    def residual(q: np.ndarray) -> np.ndarray:
        c_, k1_, k2_, a_, b_ = solid(q)
        return c_ + k1_ * np.exp(-TIME / np.exp(a_)) + k2_ * np.exp(-TIME / np.exp(b_)) - values

    first = {"c": [k1, k2, a, b], "ln tau": [c, k1, k2, a], "ln b": [c, k1, a, b]}[held]
    # the slow arm follows the value that is held, wholly or in part
    variant = at - (b + np.log(k2)) if held == "ln b" else 0.0
    shifts = {0.0, variant, 0.7 * variant, -1.0, 1.0}
    starts = [np.array(first) + shift * np.array([0, 0, 0, 1]) for shift in sorted(shifts)]
    relaxing = 1 if held == "ln tau" else 2  # ln tau has any sign
    lowest = np.concatenate((np.zeros(4 - relaxing), np.full(relaxing, -np.inf)))
    fits = [
        least_squares(residual, s, bounds=(lowest, np.inf), xtol=1e-14, ftol=1e-14, gtol=1e-14)
        for s in starts
    ]
    return 2.0 * min(fit.cost for fit in fits)


@pytest.mark.parametrize(
    ("held", "coordinate", "index", "step"),
    [
        ("c", Coordinate.LINEAR, 0, 0.02),
        ("ln tau", Coordinate.LOG_TAU, 1, 0.1),
        ("ln b", Coordinate.LOG_B, 1, 0.1),
    ],
)
def test_profile_is_the_brute_force_refit(
    problem: tuple[Stack, Solution, np.ndarray],
    held: str,
    coordinate: Coordinate,
    index: int,
    step: float,
) -> None:
    stack, optimum, values = problem
    profile_target = ProfileTarget(coordinate, index, step=step, scale=NOISE**2)
    ((value, deviance),) = compute_profiles(stack, optimum, [profile_target], limit=11.0)
    assert np.all(np.diff(value) > 0)
    best = int(np.argmin(deviance))
    assert deviance[best] == 0.0
    assert np.all(np.diff(deviance[best:]) >= -1e-6)
    assert np.all(np.diff(deviance[: best + 1]) <= 1e-6)
    lowest = brute(values, optimum, held, float(value[best]))
    for at, result in list(zip(value, deviance, strict=True))[:: max(1, len(value) // 8)]:
        expected = (brute(values, optimum, held, float(at)) - lowest) / NOISE**2
        assert result == pytest.approx(expected, abs=2e-3, rel=2e-3)


def test_a_side_the_data_leave_open_ends_at_the_window(
    problem: tuple[Stack, Solution, np.ndarray],
) -> None:
    stack, optimum, _ = problem
    profile_target = ProfileTarget(Coordinate.LOG_TAU, 1, step=0.1, scale=1e3)
    ((value, deviance),) = compute_profiles(stack, optimum, [profile_target], limit=11.0)
    assert deviance.max() < 11.0
    assert (value[0], value[-1]) == pytest.approx(stack.bounds)


def test_where_the_noise_is_louder_the_same_sse_means_less(
    problem: tuple[Stack, Solution, np.ndarray],
) -> None:
    """A noise that grows with tau opens the upper side and leaves the lower one alone."""
    stack, optimum, _ = problem

    def relative_gain(beta: np.ndarray, log_tau: np.ndarray) -> float:
        return float(np.exp(2.0 * max(log_tau[1] - optimum.log_tau[1], 0.0)))

    profile_targets = [
        ProfileTarget(Coordinate.LOG_TAU, 1, step=0.1, scale=NOISE**2, relative_gain=noise)
        for noise in (None, relative_gain)
    ]
    plain, met = compute_profiles(stack, optimum, profile_targets, limit=11.0)
    best = float(optimum.log_tau[1])
    for value, deviance in zip(*met, strict=True):
        quiet = float(np.interp(value, *plain))
        if value <= best:
            assert deviance == pytest.approx(quiet, abs=0.05, rel=0.02)
        elif value < plain[0][-1]:
            assert deviance == pytest.approx(
                quiet / np.exp(2.0 * (value - best)), abs=0.05, rel=0.05
            )
    assert plain[1][-1] > 11.0
    assert met[1][met[0] > best].max() < 11.0
    assert met[0][-1] == pytest.approx(stack.bounds[1])


@pytest.mark.parametrize("seed", [1, 7, 14])
def test_an_arm_that_the_data_do_without_may_be_anything(seed: int) -> None:
    """Of two arms fitted to one, the spare one has no ends, nor the plateau a lower one."""
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(TIME))
    values = 1.0 + 0.8 * np.exp(-TIME / 0.3) + noise
    block = build_hold_block(TIME, values)
    solution = solve([block], 2)
    assert solution.order == 2
    arm = int(np.argmin(solution.arms[0]))
    coordinates = (Coordinate.LINEAR, 0), (Coordinate.LINEAR, 1 + arm), (Coordinate.LOG_B, arm)
    profile_targets = [
        ProfileTarget(kind, index, step=0.02, scale=NOISE**2) for kind, index in coordinates
    ]
    profile_targets.append(ProfileTarget(Coordinate.LOG_TAU, arm, step=0.2, scale=NOISE**2))
    plateau, *individual = compute_profiles(Stack([block]), solution, profile_targets, limit=11.0)
    without = (solve([block], 1).sse - solution.sse) / NOISE**2
    assert without < 2.0
    for value, deviance in individual:
        assert value[0] < value[-1]
        assert max(deviance[0], deviance[-1]) == pytest.approx(without, abs=0.02)
        assert deviance.max() < 2.0
    assert plateau[0][0] == 0.0
    assert plateau[1][0] == pytest.approx(without, abs=0.02)
    assert plateau[1][-1] > 11.0
    # so slow that it is a plateau, so slow that its b is none, too fast to show
    later = TIME[1:]  # a strain takes time: no sample meets all of an arm at once
    stack = np.stack((np.ones(len(later)), np.exp(-later / 0.3)), axis=1)
    single = np.linalg.lstsq(stack, values[1:], rcond=None)[1][0]
    for held, k, tau in ((0, 0.2, 1e6), (2, 1e-7, 1e9), (2, 1e3, 1e-9)):
        columns = np.column_stack((stack, np.exp(-later / tau)))
        rest = values[1:] - k * columns[:, held]
        residual = np.linalg.lstsq(np.delete(columns, held, axis=1), rest, rcond=None)[1][0]
        assert residual <= single * (1 + 1e-3)


def test_an_arm_that_is_needed_has_ends_though_another_is_spare() -> None:
    """A spare arm does not take the place of a slow one whose tau is known to a fifth."""
    noise = NOISE * np.random.default_rng(3).standard_normal(len(TIME))
    block = build_hold_block(
        TIME, 1.0 + 0.8 * np.exp(-TIME / 0.3) + 0.3 * np.exp(-TIME / 4.0) + noise
    )
    solution = solve([block], 3)
    assert solution.order == 3
    slow = int(np.argmin(np.abs(solution.log_tau - np.log(4.0))))
    profile_target = ProfileTarget(Coordinate.LINEAR, 1 + slow, step=0.02, scale=NOISE**2)
    ((value, deviance),) = compute_profiles(Stack([block]), solution, [profile_target], limit=11.0)
    assert deviance[0] > 11.0
    assert value[0] > 0.05
