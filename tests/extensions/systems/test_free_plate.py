"""The virtual door: frequencies of free square plates in the literature."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.extensions.systems.door.free_plate import free_plate

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 0)]


def test_a_free_square_plate_is_that_of_leissa():
    r"""Leissa (1973), :math:`\omega a^2 \sqrt{\rho h / D}` at a Poisson ratio of 0.3, by Ritz."""
    modes = free_plate(CORNERS, width=1.0, height=1.0, mass=1.0, rigidity=1.0)
    result = 2 * np.pi * modes.frequency
    assert result[:3].tolist() == [0, 0, 0]
    assert result[3:8] == pytest.approx([13.489, 19.789, 24.432, 35.024, 35.024], rel=0.012)
    assert modes.rigid.tolist() == [True] * 3 + [False] * 8


def test_its_rigid_modes_weigh_what_it_does():
    """Across the plane: the mass, and the moments of an even plate about its edges."""
    w, h, m = 1.1, 1.2, 25.0
    modes = free_plate(CORNERS, width=w, height=h, mass=m, rigidity=3e4, elastic=1)
    T = modes.rigid_motion[:, [2, 3, 4]].T
    whole = np.linalg.inv(T @ T.T)
    plate = np.array([(m, m * h / 2, -m * w / 2), (0, m * h**2 / 3, -m * w * h / 4),
                      (0, 0, m * w**2 / 3)])  # fmt: skip
    assert whole == pytest.approx(plate + np.triu(plate, 1).T, rel=1e-9)
