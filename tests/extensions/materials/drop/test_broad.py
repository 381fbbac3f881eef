"""A specimen of many arms, dropped by a generator of its own: one fast arm must not be trusted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dashpot as dp

K, MASS, SPEEDS, RATE = 400.0, 0.2, (0.3, 0.6, 1.0), 10_000
BROAD = (np.full(14, 0.05), np.geomspace(1e-3, 30, 14))
FEW = (np.array([0.25, 0.2, 0.1]), np.array([0.0125, 0.5, 16.0]))


def impact_force(speed: float, g: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Force of one impact, N, after 40 ms of nothing and before 0.6 s of it."""

    def move(_: float, y: np.ndarray) -> np.ndarray:
        force = K * (y[0] + y[2:].sum())
        return np.concatenate(([y[1], -force / MASS], g * y[1] - y[2:] / tau))

    def leaves(t: float, y: np.ndarray) -> float:
        return y[0] + y[2:].sum() if t > 1e-4 else 1.0

    leaves.terminal = True
    start = np.concatenate(([0.0, speed], np.zeros(len(g))))
    done = solve_ivp(move, (0, 0.2), start, events=leaves, rtol=1e-9, atol=1e-12, dense_output=True)
    y = done.sol(np.arange(int(done.t[-1] * RATE)) / RATE)
    return np.concatenate((np.zeros(400), K * (y[0] + y[2:].sum(axis=0)), np.zeros(6000)))


def fit_relaxation(g: np.ndarray, tau: np.ndarray, random: np.random.Generator) -> dp.Fit:
    """The fit of a relaxation test: 8 mm in 1 s, held for 40 s."""
    t = np.arange(0, 42, 1 / 250)
    since = np.clip(t - 1, 0, None)[:, None]
    ramped = np.minimum(since, 1.0)
    arms = g * tau * (np.exp(-(since - ramped) / tau) - np.exp(-since / tau))
    force = 8e-3 * K * (ramped[:, 0] + arms.sum(axis=1)) + 2e-3 * random.standard_normal(len(t))
    x = 8e-3 * ramped[:, 0] + 1e-7 * random.standard_normal(len(t))
    return dp.fit(dp.RelaxationTest(t, x, force, units="SI"))


@pytest.mark.slow
@pytest.mark.parametrize(("truth", "use"), [(FEW, "use"), (BROAD, "use with care")])
def test_impact_fit_with_one_arm_warns_for_a_broad_spectrum(
    tmp_path: Path, truth: tuple[np.ndarray, np.ndarray], use: str
) -> None:
    random = np.random.default_rng(0)
    force = np.concatenate([impact_force(speed, *truth) for speed in SPEEDS])
    force = force + 0.03 * random.standard_normal(len(force))
    rows = np.column_stack([np.arange(len(force)) / RATE, force])
    path = tmp_path / "slam.csv"
    np.savetxt(path, rows, "%.6f", ",", header="# slams\ntime [s],force [N]", comments="")
    fit = dp.fit(
        dp.read(path, kind="slam"),
        mass=MASS,
        drop=[f"{speed}m/s" for speed in SPEEDS],
        relaxation=[fit_relaxation(*truth, random)],
    )
    assert fit.verdict.use == use
    assert (
        "spectrum_has_gaps" in {failed_check.name for failed_check in fit.verdict.failed_checks}
    ) == (use != "use")
