"""Collisions: laws, published numbers, and a march in time written apart."""

from __future__ import annotations

import numpy as np
import pytest
from kit import contacts

from dashpot.base.errors import DataError
from dashpot.extensions.materials.indentation.collision import collide
from dashpot.extensions.materials.indentation.contact_law import (
    RelaxingContact,
    ViscousContact,
    reduced_modulus,
    sphere_stiffness,
)

pytestmark = pytest.mark.once

# a ball of 5 g, radius 2.5 mm, on rubber of E = 3 MPa, nu = 0.5, at 1 m/s
MASS, RADIUS = 5e-3, 2.5e-3
K = sphere_stiffness(3e6 / 0.75, RADIUS)


def numbers(law, *, mass=MASS, **how):
    collision = collide(law, mass=mass, velocity=how.pop("velocity", 1.0), **how)
    return collision.restitution, collision.duration, collision.depth, collision.largest_force


class TestNumbers:
    """Of the reference pages [7]: independent scripts, HKV's largest values there as sampled."""

    def test_kelvin_voigt(self):
        m, k, c = 0.01, 1e4, 2.0
        e, duration, depth, _ = numbers(ViscousContact(k, c / k, 1.0), mass=m)
        zeta = c / (2 * np.sqrt(k * m))
        root = np.sqrt(1 - zeta**2)
        angle = np.arctan2(2 * zeta * root, 2 * zeta**2 - 1)
        assert e == pytest.approx(np.exp(-zeta / root * angle), rel=1e-8)
        assert e == pytest.approx(0.7440794, abs=5e-8)
        assert duration == pytest.approx(2.956075e-3, rel=1e-6)
        assert depth == pytest.approx(0.8626004e-3, rel=1e-6)

    def test_hertz(self):
        e, duration, depth, force = numbers(ViscousContact(K))
        assert e == pytest.approx(1.0, abs=1e-8)
        assert duration == pytest.approx(2.610926e-3, rel=3e-6)
        assert depth == pytest.approx(0.8870835e-3, rel=1e-7)
        assert force == pytest.approx(7.0455598, rel=1e-6)

    @pytest.mark.parametrize(
        ("A", "message"),
        [
            (2e-5, (0.9584814, 2.592299e-3, 0.8722554e-3, 6.872882)),
            (1e-4, (0.8139689, 2.522252e-3, 0.8185083e-3, 6.316236)),
        ],
    )
    def test_kuwabara_and_kono(self, A, message):
        result = numbers(ViscousContact(K, A))
        assert result[0] == pytest.approx(message[0], abs=2e-7)
        assert result == pytest.approx(message, rel=2e-5)

    def test_ting(self):
        e, _, depth, force = numbers(RelaxingContact(K, 0.6885, 1e-3))
        assert e == pytest.approx(0.79050, abs=1e-5)
        assert depth == pytest.approx(0.747721e-3, rel=1e-6)
        assert force == pytest.approx(7.63691, rel=1e-6)


class TestLaws:
    def test_an_arm_of_nothing_is_hertz(self):
        assert numbers(RelaxingContact(K, 0.0, 1e-3)) == pytest.approx(
            numbers(ViscousContact(K)), rel=1e-7
        )

    def test_relaxing_contact_has_spring_and_dashpot_limits(self):
        glassy = numbers(ViscousContact(1.5 * K))
        assert numbers(RelaxingContact(K, 0.5, 1e3)) == pytest.approx(glassy, rel=1e-4)
        # E_inf g tau is the viscosity of the arm
        fast = numbers(RelaxingContact(K, 0.5, 1e-5))
        assert fast[2] == pytest.approx(numbers(ViscousContact(K, 5e-6))[2], rel=1e-3)

    def test_a_lossless_contact_shortens_with_speed_to_the_fifth(self):
        slow, fast = (numbers(ViscousContact(K), velocity=V)[1] for V in (0.1, 3.2))
        assert slow / fast == pytest.approx(32**0.2, rel=1e-6)

    def test_the_energy_lost_is_the_work_of_the_loop(self):
        for law in (
            ViscousContact(K, 1e-4),
            RelaxingContact(K, 0.7, 1e-3),
            ViscousContact(8e3, 2.5e-4, 1.0),
        ):
            collision = collide(law, mass=MASS, velocity=1.0, acceleration=9.81)
            work = np.trapezoid(collision.force, collision.displacement)
            lost = (
                MASS / 2 * (1 - collision.restitution**2) + MASS * 9.81 * collision.displacement[-1]
            )
            assert work == pytest.approx(lost, rel=5e-4)

    def test_impulse_is_the_change_of_momentum(self):
        collision = collide(
            RelaxingContact(K, 0.7, 1e-3), mass=MASS, velocity=1.0, acceleration=9.81
        )
        change = MASS * (1 + collision.restitution + 9.81 * collision.duration)
        assert np.trapezoid(collision.force, collision.time) == pytest.approx(change, rel=2e-4)

    def test_modulus_and_stiffness_are_inverse(self):
        assert reduced_modulus(sphere_stiffness(4e6, RADIUS), RADIUS) == pytest.approx(4e6)


class TestMarch:
    @pytest.mark.parametrize(
        ("law", "force"),
        [
            (ViscousContact(1e4, 2e-4, 1.0), contacts.kelvin_voigt(1e4, 2.0)),
            (ViscousContact(K, 1e-4), contacts.kuwabara(K, 1e-4)),
        ],
    )
    @pytest.mark.parametrize("pull", [0.0, 9.81])
    def test_viscous_contacts(self, law, force, pull):
        T, X, V, F = contacts.march(force, MASS, 1.0, pull=pull)
        collision = collide(law, mass=MASS, velocity=1.0, acceleration=pull)
        assert collision.duration == pytest.approx(T[-1], abs=2e-6)
        assert np.interp(T[:-2], collision.time, collision.displacement) == pytest.approx(
            X[:-2], abs=2e-8
        )
        assert collision.restitution == pytest.approx(-V[-1], rel=2e-4)
        assert collision.largest_force == pytest.approx(F.max(), rel=1e-4)

    def test_a_relaxing_contact(self):
        T, X, F, e = contacts.ting(K, 1.5, 4e-4, MASS, 1.0)
        collision = collide(RelaxingContact(K, 1.5, 4e-4), mass=MASS, velocity=1.0)
        assert np.interp(T, collision.time, collision.displacement) == pytest.approx(X, abs=1e-6)
        assert np.interp(T, collision.time, collision.force) == pytest.approx(F, abs=5e-3 * F.max())
        assert collision.restitution == pytest.approx(e, abs=2e-3)


def test_what_is_no_collision():
    for bad in ({"mass": 0.0, "velocity": 1.0}, {"mass": 1.0, "velocity": -1.0}):
        with pytest.raises(DataError, match="above 0"):
            collide(ViscousContact(K), **bad)
    with pytest.raises(DataError, match="not let go"):
        collide(ViscousContact(1e4, 0.1, 1.0), mass=0.01, velocity=1e-3, acceleration=9.81)
    for made in (lambda: ViscousContact(-1.0), lambda: RelaxingContact(K, -0.1, 1.0)):
        with pytest.raises(DataError):
            made()
    with pytest.raises(DataError, match=r"1 or 1\.5"):
        ViscousContact(K, 0.0, 2.0)
    with pytest.raises(DataError, match="0 or more"):
        ViscousContact(K, -1e-4)
