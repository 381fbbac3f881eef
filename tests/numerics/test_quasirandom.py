"""Quasi-random points: even in every direction, and better than random draws for quantiles."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.numerics.quasirandom import draw_normal, fill_unit_cube


@pytest.mark.parametrize("dimensions", [1, 2, 5, 14])
def test_points_lie_evenly_in_every_dimension(dimensions: int) -> None:
    points = fill_unit_cube(400, dimensions)
    assert points.shape == (400, dimensions)
    assert ((points >= 0) & (points < 1)).all()
    steps = np.abs(np.sort(points, axis=0) - (np.arange(400) + 0.5)[:, None] / 400)
    assert steps.max() < 0.04  # random points: 0.04 to 0.09


@pytest.mark.parametrize("dimensions", [1, 2, 3, 5, 7, 9, 13])
def test_normal_draws_have_the_moments_and_quantiles_of_their_law(dimensions: int) -> None:
    draws = draw_normal(400, dimensions)
    assert draws.shape == (400, dimensions)
    assert np.abs(draws.mean(axis=0)).max() < 1e-12
    assert draws.T @ draws / 400 == pytest.approx(np.eye(dimensions), abs=1e-12)
    random = np.random.default_rng(8)
    errors = {"quasi-random": [], "random": []}
    for _ in range(200):
        direction = random.standard_normal(dimensions)
        direction /= np.linalg.norm(direction)
        for name, values in (
            ("quasi-random", draws @ direction),
            ("random", random.standard_normal(400)),
        ):
            low, high = np.quantile(values, (0.025, 0.975))
            errors[name] += [low + 1.959964, high - 1.959964]
    rms = {name: np.sqrt(np.mean(np.square(values))) for name, values in errors.items()}
    assert rms["quasi-random"] < 0.8 * rms["random"]
