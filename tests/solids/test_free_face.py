"""The face of a seal under a plate that only pushes: laws, and a recursion that is not ours."""

from __future__ import annotations

import numpy as np
import pytest
from kit.foreign.conditioning import Arms, press_solid

from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.moving_plate import simulate_face_under_plate

SEAL = Arms("three arms", 200.0, (40.0, 30.0, 50.0), (0.3, 6.0, 40.0))
SOLID = GeneralizedMaxwell(SEAL.k_inf, SEAL.k, SEAL.tau)


def cycles(step: float, *, low: float = 0.0, rest: float = 5.0) -> tuple[np.ndarray, np.ndarray]:
    """Two triangles to 8 mm, a rest at `low`, m, and a ramp to a hold."""
    corners = np.cumsum([0.0, 1.0, 1.5, 1.5, 1.5, 1.5, rest, 1.0, 20.0])
    levels = 8e-3 * np.array([0, 0, 1, 0, 1, 0, 0, 1, 1]) + low * np.array(
        [0, 0, 0, 1, 0, 1, 1, 0, 0]
    )
    time = np.arange(0.0, corners[-1], step)
    return time, np.interp(time, corners, levels)


@pytest.mark.parametrize("low", [0.0, -1e-3, 0.4e-3])
def test_a_face_is_that_of_a_fine_recursion(low: float) -> None:
    time, plate = cycles(0.01, low=low)
    face, force = simulate_face_under_plate(SOLID, time, plate)
    fine, finer = press_solid(SEAL, 0.01, plate, bonded=False, fine=20)
    np.testing.assert_allclose(face, fine, atol=3e-4 * 8e-3)
    np.testing.assert_allclose(force, finer, atol=1e-3 * finer.max())


def test_the_plate_never_enters_the_seal_nor_pulls_at_it() -> None:
    time, plate = cycles(0.02)
    face, force = simulate_face_under_plate(SOLID, time, plate)
    assert np.all(face >= plate)
    assert np.all(force >= 0)
    # where they are apart there is no force
    assert np.all(force[face > plate + 1e-9] == 0)
    separate = np.flatnonzero(face > plate + 1e-9)
    assert len(separate) > 100
    # and where they are not, it is that of the motion of the face
    np.testing.assert_allclose(SOLID.force(time, face), force, atol=2e-3 * force.max())


def test_the_recovery_of_a_free_face_is_a_sum_of_retardations() -> None:
    """One arm: x goes back as exp(-t/lambda), lambda = tau (k_inf + k) / k_inf, and to zero."""
    solid = GeneralizedMaxwell(200.0, (100.0,), (2.0,))
    time = np.linspace(0.0, 30.0, 3001)
    plate = np.where(time < 10.0, 8e-3, -1e-3)
    plate[0] = 0.0
    face, _ = simulate_face_under_plate(solid, time, plate)
    first = int(np.searchsorted(time, 10.0)) + 1
    since = time[first:] - time[first]
    np.testing.assert_allclose(face[first:], face[first] * np.exp(-since / 3.0), rtol=2e-3)
    assert face[first] > 1e-3


def test_a_plate_that_only_presses_is_the_face() -> None:
    time = np.linspace(0.0, 10.0, 501)
    plate = 8e-3 * np.minimum(time / 2, 1.0)
    face, force = simulate_face_under_plate(SOLID, time, plate)
    np.testing.assert_array_equal(face, plate)
    np.testing.assert_allclose(force, SOLID.force(time, plate), rtol=1e-9, atol=1e-12)


def test_a_spring_and_an_uneven_clock_are_taken_as_well() -> None:
    time, plate = cycles(0.01)
    face, force = simulate_face_under_plate(GeneralizedMaxwell(200.0), time, plate - 1e-3)
    np.testing.assert_allclose(face, np.maximum(plate - 1e-3, 0.0), atol=1e-12)
    np.testing.assert_allclose(force, 200.0 * face, atol=1e-9)
    retained = np.sort(np.random.default_rng(2).permutation(len(time))[: 2 * len(time) // 3])
    retained = np.unique(np.append(retained, 0))
    even, _ = simulate_face_under_plate(SOLID, time, plate)
    some, _ = simulate_face_under_plate(SOLID, time[retained], plate[retained])
    np.testing.assert_allclose(some, even[retained], atol=0.01 * 8e-3)
