"""A model in series with friction, against its settled path in time."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.extensions.amplitude.friction import Coulomb, Jenkins
from dashpot.extensions.amplitude.series_elements import InSeries
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.networks import kelvin_voigt, spring
from dashpot.solids.rate_independent import InParallel


class TestSeries:
    def test_a_spring_and_a_slider_are_a_jenkins_element(self):
        pair, jenkins = InSeries(spring(100.0), Coulomb(0.05)), Jenkins(100.0, 0.05)
        x = 1e-3 * np.sin(np.linspace(0, 12, 400))
        t = np.linspace(0, 1, 400)
        assert pair.path_force(t, x) == pytest.approx(jenkins.force(x), abs=1e-9)

    def test_series_element_without_slip_is_the_solid(self):
        pair = InSeries(GeneralizedMaxwell(10.0, (5.0,), (0.1,)), Coulomb(1.0))
        assert pair.equivalent(3.0, 1e-4) == pytest.approx(pair.solid.complex_stiffness(omega=3.0))

    def test_series_element_with_a_linear_part_adds_compliances(self):
        solid = GeneralizedMaxwell(10.0, (5.0,), (0.1,))
        soft = InParallel((spring(3.0),))
        K = InSeries(solid, soft).equivalent(7.0, 1e-3)
        assert abs(K * (1 / solid.complex_stiffness(omega=7.0) + 1 / 3.0) - 1) < 1e-12

    def test_its_balance_is_near_its_path(self):
        solid = GeneralizedMaxwell(200.0, (300.0,), (0.02,))
        pair = InSeries(solid, InParallel((spring(60.0), Jenkins(400.0, 0.06))))
        w, X, n = 40.0, 1e-3, 300
        t = np.arange(5 * n + 1) * 2 * np.pi / w / n
        F = pair.path_force(t, X * np.sin(w * t))[-n - 1 :]
        last = t[-n - 1 :]
        K = 1j * np.trapezoid(F * np.exp(-1j * w * last), last) * w / np.pi / X
        assert abs(K - complex(pair.equivalent(w, X))) < 0.02 * abs(K)

    def test_a_bare_slider_behind_a_spring_is_a_jenkins_element(self):
        X = np.geomspace(2e-4, 0.05, 60)
        pair = InSeries(spring(100.0), Coulomb(0.05))
        exact = Jenkins(100.0, 0.05).equivalent(1.0, X)
        assert pair.equivalent(1.0, X) == pytest.approx(exact, rel=1e-12)

    @pytest.mark.parametrize(
        "solid",
        [
            GeneralizedMaxwell(200.0, (300.0,), (0.02,)),
            GeneralizedMaxwell(0.0, (100.0,), (0.05,)),
            GeneralizedMaxwell(196.0, (117.0, 17.0), (0.05, 0.3)),
            kelvin_voigt(100.0, 3.0),
        ],
    )
    def test_a_bare_slider_behind_arms_is_what_its_path_settles_to(self, solid):
        w, n, cycles = 40.0, *((3000, 3) if solid.b else (300, 12))
        t = np.arange(cycles * n + 1) * 2 * np.pi / w / n
        last = t[-n - 1 :]
        yields = 0.05 / abs(complex(solid.complex_stiffness(omega=w)))
        pair = InSeries(solid, Coulomb(0.05))
        for ratio in (0.99, 1.0005, 1.2, 5.0):
            X = ratio * yields
            F = integrate_force(solid, 0.05, t, X * np.sin(w * t))[-n - 1 :]
            K = 1j * np.trapezoid(F * np.exp(-1j * w * last), last) * w / np.pi / X
            assert abs(K - complex(pair.equivalent(w, X))) < 2e-3 * abs(K)

    def test_a_jenkins_element_behind_arms_is_what_its_path_settles_to(self):
        solid = GeneralizedMaxwell(200.0, (300.0,), (0.02,))
        pair = InSeries(solid, Jenkins(400.0, 0.06))
        w, n = 40.0, 400
        t = np.arange(8 * n + 1) * 2 * np.pi / w / n
        last = t[-n - 1 :]
        for X in (1e-4, 5e-4, 3e-3):
            F = pair.path_force(t, X * np.sin(w * t))[-n - 1 :]
            K = 1j * np.trapezoid(F * np.exp(-1j * w * last), last) * w / np.pi / X
            assert abs(K - complex(pair.equivalent(w, X))) < 2e-3 * abs(K)

    def test_series_element_at_large_amplitude_is_the_slider(self):
        pair = InSeries(GeneralizedMaxwell(200.0, (300.0,), (0.02,)), Coulomb(0.05))
        X = np.array([500.0, 5000.0])
        slides = Coulomb(0.05).equivalent(40.0, X)
        assert np.abs(pair.equivalent(40.0, X) / slides - 1).max() < 1e-3

    @pytest.mark.once
    @pytest.mark.parametrize("slider", [Coulomb(0.1), Jenkins(300.0, 0.1)])
    def test_a_picometre_is_as_exact_as_a_millimetre(self, slider):
        """With displacements and slip forces a billion times smaller, so is every force."""
        solid, small = GeneralizedMaxwell(393.0, (235.0,), (0.5,)), 1e-9
        t = np.linspace(0, 2, 81)
        x = 1e-3 * np.sin(2 * np.pi * t)
        less = type(slider)(**{**vars(slider), "slip": small * slider.slip})
        large = InSeries(solid, slider).path_force(t, x)
        result = InSeries(solid, less).path_force(t, small * x) / small
        assert np.abs(result - large).max() < 1e-9 * np.abs(large).max()


def integrate_force(solid, slip, t, x):
    """Force of arms and a dashpot before a slider, along a path."""
    k, tau, dt = np.array(solid.k), np.array(solid.tau), t[1]
    keeps, gains = np.exp(-dt / tau), tau / dt * -np.expm1(-dt / tau)
    rise = solid.k_inf + k @ gains + solid.b / dt
    u, q, force = 0.0, np.zeros(len(k)), [0.0]
    for dx in np.diff(x):
        base = solid.k_inf * u + k @ (keeps * q)
        f = float(np.clip(base + rise * dx, -slip, slip))
        du = (f - base) / rise
        u, q = u + du, keeps * q + gains * du
        force.append(f)
    return np.array(force)
