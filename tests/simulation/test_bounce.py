"""A mass on a viscoelastic solid under half-sine pulses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from dashpot.base.errors import DataError
from dashpot.simulation.impact import HalfSine, Oscillator
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, PAPER, PAPER_MASS
from dashpot.solids.maxwell import GeneralizedMaxwell


def test_the_poles_are_the_references():
    poles = sorted(
        Oscillator.from_solid(2 * PAPER, PAPER_MASS).poles, key=lambda p: (p.real, p.imag)
    )
    np.testing.assert_allclose(
        [poles[0].real, poles[1].real, poles[2].real, poles[3].real],
        [-1.288324, -0.354171, -0.354171, -0.055776],
        atol=1e-6,
    )
    assert poles[2].imag == pytest.approx(79.85693, abs=1e-5)


def test_the_broad_seal_bounces_and_rocks_where_the_reference_says():
    bounce = Oscillator.from_solid(2 * BROAD, BROAD_MASS)
    pole = bounce.poles[np.argmax(bounce.poles.imag)]
    assert abs(pole) / 2 / np.pi == pytest.approx(12.69983, abs=1e-5)
    assert -pole.real / abs(pole) == pytest.approx(0.0285575, abs=1e-7)
    rock = Oscillator.from_solid((2 * 0.045**2) * BROAD, BROAD_MASS * 0.12**2 / 12)
    assert np.abs(rock.poles).max() < 700
    fastest = rock.poles[np.argmax(rock.poles.imag)]
    assert abs(fastest) / 2 / np.pi == pytest.approx(16.57, abs=0.005)


def test_the_response_agrees_with_an_ordinary_integrator():
    solid = GeneralizedMaxwell(300.0, k=(150.0, 80.0), tau=(0.4, 0.01), b=0.5)
    mass = 0.1
    pulse = HalfSine(start=0.0123, duration=0.015, peak=3.0)

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        force = pulse.force(np.array([t]))[0]
        pull = 300.0 * y[0] + 150.0 * y[2] + 80.0 * y[3] + 0.5 * y[1]
        return np.array([y[1], (force - pull) / mass, y[1] - y[2] / 0.4, y[1] - y[3] / 0.01])

    time = np.arange(2000) / 4000
    done = solve_ivp(
        slope, (0, time[-1]), np.zeros(4), t_eval=time, rtol=1e-9, atol=1e-12, max_step=5e-4
    )
    expected = np.array([slope(t, y)[1] for t, y in zip(time, done.y.T, strict=True)])
    result, _ = Oscillator.from_solid(solid, mass).acceleration(time, (pulse,))
    np.testing.assert_allclose(result, expected, atol=2e-6)


@settings(max_examples=25)
@given(
    start=st.floats(0.0, 0.3),
    duration=st.floats(0.005, 0.1),
    peak=st.floats(-5, 5),
    later=st.floats(0.0, 0.2),
)
def test_two_pulses_are_the_sum_of_each(start: float, duration: float, peak: float, later: float):
    oscillator = Oscillator.from_solid(2 * BROAD, BROAD_MASS)
    time = np.arange(400) / 1000
    half_sine, two = HalfSine(start, duration, peak), HalfSine(start + later, 0.02, 1.0)
    both, _ = oscillator.acceleration(time, (half_sine, two))
    first, _ = oscillator.acceleration(time, (half_sine,))
    second, _ = oscillator.acceleration(time, (two,))
    np.testing.assert_allclose(both, first + second, atol=1e-9)


def test_a_record_can_be_cut_and_carried_on():
    oscillator = Oscillator.from_solid(2 * BROAD, BROAD_MASS)
    time = np.arange(1001) / 1000
    whole, _ = oscillator.acceleration(time, (HalfSine(0.05, 0.015, 3.0), HalfSine(0.6, 0.02, 2.0)))
    early, state = oscillator.acceleration(time[:501], (HalfSine(0.05, 0.015, 3.0),))
    late, _ = oscillator.acceleration(time[500:], (HalfSine(0.6, 0.02, 2.0),), state)
    np.testing.assert_allclose(np.concatenate((early, late[1:])), whole, atol=1e-9)


def test_a_flowing_solid_is_refused():
    with pytest.raises(DataError, match="k_inf = 0: the test mass has no static equilibrium"):
        Oscillator.from_solid(GeneralizedMaxwell(0.0, k=(10.0,), tau=(1.0,)), 0.1)


def test_a_double_pole_is_refused():
    # critical damping by the parallel dashpot: b = 2 sqrt(k m)
    with pytest.raises(DataError, match="change the mass a little"):
        Oscillator.from_solid(GeneralizedMaxwell(100.0, b=20.0), 1.0)
