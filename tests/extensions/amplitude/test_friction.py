"""Friction elements: published numbers, closed forms against their own paths, limits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.extensions.amplitude.friction import Berg, Coulomb, Iwan, Kraus, jenkins_like
from dashpot.extensions.amplitude.nonlinear_springs import Cubic, StagedSpring
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.networks import kelvin_voigt, spring
from dashpot.solids.rate_independent import InParallel, RateIndependent

ELEMENTS = (
    Jenkins(100.0, 0.05),
    Coulomb(2.0),
    Iwan(5e3, 2.0),
    Berg(10.0, 1e-4),
    Cubic(1e9),
    StagedSpring((100.0, 900.0, 400.0), (2e-4, 6e-4)),
    Jenkins(100.0, 0.05) + Iwan(5e3, 2.0) + Berg(3.0, 1e-3),
)


def first_harmonic(element, X, cycles=6, points=4000):
    """The equivalent stiffness from the marched path alone: the last cycle's Fourier sum."""
    phase = 2 * np.pi * np.arange(cycles * points + 1) / points
    x = X * np.sin(phase)
    force = element.path_force(phase, x) if isinstance(element, InParallel) else element.force(x)
    last = slice(-points - 1, None)
    weight = np.trapezoid(force[last] * np.exp(-1j * phase[last]), phase[last]) / np.pi
    return 1j * weight / X


class TestPublishedNumbers:
    def test_iwan_of_uniform_strengths(self):
        element, X = Iwan(5e3, 2.0), 5e-4
        assert element.backbone(X) == pytest.approx(1.71875, rel=1e-12)
        assert element.energy(X) == pytest.approx(0.52083333e-3, rel=1e-8)
        assert element.secant(X) == pytest.approx(3437.5, rel=1e-12)
        assert element.stiffness(X).imag == pytest.approx(663.1456, rel=1e-7)

    def test_kraus(self):
        rubber = spring(1.0) + Kraus(2.0, 0.01, exponent=0.6, loss=0.5)
        g = np.array([0.001, 0.003, 0.01, 0.03, 0.1])
        K = rubber.equivalent(1.0, g)
        assert K.real.round(6).tolist() == [2.881298, 2.618384, 2.0, 1.422191, 1.118702]
        assert K.imag.round(6).tolist() == [
            0.23628,
            0.392938,
            0.5,
            0.408086,
            0.23628,
        ]

    def test_berg(self):
        element, X = Berg(10.0, 1e-4), np.array([0.05e-3, 0.2e-3, 1e-3])
        tip = element.secant(X) * X
        assert tip.round(6).tolist() == [2.807764, 5.615528, 8.442888]
        # Berg's own integral of the steady loop; a coarsely stepped loop loses 0.3 % of it
        c = element.half_way * (1 + tip / element.limit)
        exact = 2 * ((tip + element.limit) * (2 * X - c * np.log1p(2 * X / c)) - 2 * X * tip)
        assert element.energy(X) == pytest.approx(exact, rel=1e-9)
        assert 1e3 * element.energy(X) == pytest.approx([0.10658, 1.8046, 23.175], rel=3e-3)

    def test_gaillard_and_singh(self):
        element, X = Jenkins(5e3, 2.0), 1e-3
        assert element.energy(X) == pytest.approx(4.8e-3, rel=1e-12)
        assert element.stiffness(X) == pytest.approx(1867.650 + 1527.887j, rel=1e-6)
        rubs = Jenkins(60.0, 0.03)
        assert rubs.energy(X) == pytest.approx(60e-6, rel=1e-12)
        assert rubs.stiffness(X) == pytest.approx(30 + 19.0986j, rel=1e-6)
        assert Coulomb(2.0).energy(X) == pytest.approx(8e-3, rel=1e-12)
        voigt = kelvin_voigt(1.0, 5.0)
        lost = np.pi * X**2 * voigt.loss(omega=2 * np.pi * 10)
        assert lost == pytest.approx(0.98696e-3, rel=1e-5)

    def test_cubic_spring(self):
        mount = spring(1e3) + Cubic(1e9)
        K = mount.equivalent(0.0, [1e-4, 5e-4, 1e-3])
        assert K.real == pytest.approx([1007.5, 1187.5, 1750.0], rel=1e-12)


@pytest.mark.parametrize("element", ELEMENTS, ids=lambda e: type(e).__name__)
@pytest.mark.parametrize("X", [1e-4, 5e-4, 2e-3])
def test_the_equivalent_stiffness_is_that_of_the_path(element, X):
    N = complex(element.equivalent(1.0, X))
    assert abs(N - first_harmonic(element, X)) < 2e-3 * abs(N)


@pytest.mark.parametrize("element", [e for e in ELEMENTS if isinstance(e, RateIndependent)])
def test_a_closed_form_is_the_quadrature(element):
    X = np.array([3e-5, 4e-4, 5e-3])
    by_quadrature = RateIndependent.stiffness(element, X)
    assert np.abs(element.stiffness(X) / by_quadrature - 1).max() < 1e-5


@pytest.mark.parametrize("element", [e for e in ELEMENTS if isinstance(e, RateIndependent)])
def test_a_count_and_the_loop_and_its_area(element):
    X = 7e-4
    assert (3 * element).stiffness(X) == pytest.approx(3 * element.stiffness(X), rel=1e-12)
    x, F = element.loop(X, points=20000)
    area = abs(np.trapezoid(F, x))
    assert area == pytest.approx(float(element.energy(X)), rel=2e-3, abs=1e-12)


@settings(max_examples=40)
@given(st.lists(st.floats(-1, 1), min_size=2, max_size=30), st.floats(0.1, 3))
@example([-1.0, 0.0, -2.5741363750046265e-167, 0.0], 1.0)  # the product of two ways is 0
def test_an_iwan_element_is_its_many_jenkins(turns, scale):
    """Any path: nested loops, wiped-out loops, beyond the first loading."""
    iwan, n = Iwan(1.0, 0.5), 800  # yields to 1
    yields = (np.arange(n) + 0.5) / n
    path = scale * np.interp(
        np.linspace(0, len(turns), 12 * len(turns)), range(len(turns) + 1), [0, *turns]
    )
    held = np.zeros(n)
    before, many = 0.0, []
    for x in path:
        held = np.clip(held + x - before, -yields, yields)
        before = x
        many.append(held.mean())
    assert np.abs(iwan.force(path) - np.array(many)).max() < 1e-5


def test_friction_dissipates_on_any_path():
    rng = np.random.default_rng(1)
    walk = np.concatenate(([0], np.cumsum(rng.normal(size=400)), [0.0])) * 1e-4
    for element in ELEMENTS[:4]:
        F = element.force(np.concatenate((walk, walk)))
        work = np.trapezoid(F, np.concatenate((walk, walk)))
        assert work > 0, element


def test_the_energy_of_a_cycle_is_the_area_of_its_loop():
    solid = GeneralizedMaxwell(200.0, (300.0,), (0.02,))
    part = solid + Jenkins(400.0, 0.06)
    w, X, n = 40.0, 1e-3, 4000
    t = np.arange(4 * n + 1) * 2 * np.pi / w / n
    x = X * np.sin(w * t)
    F = part.path_force(t, x)[-n - 1 :]
    assert np.trapezoid(F, x[-n - 1 :]) == pytest.approx(float(part.energy_per_cycle(w, X)), 1e-4)


def test_jenkins_elements_stand_for_kraus_s_storage():
    law = Kraus(235.0, 3e-4, exponent=0.5)
    spectrum = jenkins_like(law, largest_amplitude=3e-3)
    X = np.geomspace(1e-5, 3e-3, 40)
    N = spectrum.equivalent(1.0, X)
    assert np.abs(N.real - law.stiffness(X).real).max() < 0.005 * law.k
    assert all(part.k > 0 for part in spectrum.parts)


class TestRefused:
    @pytest.mark.parametrize(
        "build",
        [
            lambda: Jenkins(0.0, 1.0),
            lambda: Jenkins(1.0, np.inf),
            lambda: Coulomb(-1.0),
            lambda: Kraus(1.0, 1.0, exponent=1.0),
            lambda: Kraus(1.0, 1.0, loss=-0.1),
            lambda: Kraus(1.0, 1.0, loss=np.inf),
            lambda: Cubic(0.0),
            lambda: StagedSpring((1.0, 2.0), (0.0,)),
            lambda: StagedSpring((1.0, -2.0), (1.0,)),
            lambda: InParallel(()),
        ],
    )
    def test_numbers_that_are_no_element(self, build):
        with pytest.raises(DataError, match="expected"):
            build()

    def test_an_amplitude_of_nothing(self):
        with pytest.raises(DataError, match="amplitude = 0"):
            Jenkins(1.0, 1.0).stiffness([1.0, 0.0])

    def test_a_law_of_amplitudes_has_no_path(self):
        with pytest.raises(DataError, match="jenkins_like"):
            Kraus(1.0, 1.0).force([0.0, 1.0])
