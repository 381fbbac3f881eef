"""The virtual axis: a discrete PID on a motor, against the loop it is meant to be."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from dashpot.base.errors import DataError
from dashpot.simulation.robot import Axis, setpoints


def ramp(axis: Axis, *, depth: float = 8e-3, duration: float = 1.0, hold: float = 4.0):
    time = np.arange(round((duration + hold) * axis.rate)) / axis.rate
    return time, depth * np.clip(time / duration, 0, 1)


def test_set_points_are_101_and_the_last_is_exact():
    points = setpoints(0.0, -8e-3, duration=1.0, interval=10e-3)
    assert len(points) == 101
    assert points[0] == 0.0
    assert points[-1] == -8e-3
    np.testing.assert_allclose(np.diff(points), -8e-5, rtol=1e-12)


def test_the_loop_is_the_second_order_system_it_says():
    axis = Axis(integral=0.0, filter_time=1e-4)
    time, reference = ramp(axis)
    omega = 2 * np.pi * axis.frequency
    loop = signal.TransferFunction([omega**2], [1, 2 * axis.damping * omega, omega**2])
    expected = signal.lsim(loop, reference, time)[1]
    np.testing.assert_allclose(axis.follow(reference), expected, atol=0.02 * 8e-3)


def test_a_ramp_of_8_mm_in_1_s_overshoots_by_half_a_percent_and_settles_within_a_count():
    axis = Axis()
    time, reference = ramp(axis)
    x = axis.follow(reference)
    assert 1.003 < x.max() / 8e-3 < 1.01
    assert np.abs(x[time > 2.5] - 8e-3).max() < 0.02e-3 / 2
    # the lag of 2 zeta / omega is 32 ms at 8 mm/s
    lag = (reference - x)[(time > 0.5) & (time < 0.9)] / 8e-3
    np.testing.assert_allclose(lag, 2 * 0.6 / (2 * np.pi * 6), rtol=0.05)


def test_friction_sticks_and_the_integrator_brings_the_axis_home():
    reference = ramp(Axis(), hold=15.0)[1]
    stuck = Axis(friction=0.1, integral=0.0).follow(reference)
    home = Axis(friction=0.1).follow(reference)
    assert stuck[-1] == stuck[-500]
    assert abs(stuck[-1] - 8e-3) > 0.02e-3
    assert abs(home[-1] - 8e-3) < 0.02e-3


@pytest.mark.parametrize("friction", [0.2, 0.5, 2.0])
def test_an_axis_that_friction_stops_far_away_ends_within_a_count(friction: float):
    # R1: steady error < 1 count; without its integrator the axis stops f/k_p short, here beyond
    # the integrator's zone of 0.1 mm
    reference = ramp(Axis(), hold=15.0)[1]
    stuck = Axis(friction=friction, integral=0.0).follow(reference)
    home = Axis(friction=friction).follow(reference)
    assert 8e-3 - stuck[-1] > 0.1e-3
    assert abs(home[-1] - 8e-3) < 0.02e-3
    assert home.max() < 1.01 * 8e-3
    # by the rate alone: an integrator that knows only its zone never begins
    single = Axis(friction=friction, standstill=0.0).follow(reference)
    assert 8e-3 - single[-1] > 0.1e-3


def test_a_limited_axis_does_not_wind_up():
    weak = Axis(limit=0.2, integral=20000.0, integral_zone=1.0)
    strong = Axis(integral=20000.0, integral_zone=1.0)
    step = np.full(4000, 8e-3)
    step[0] = 0.0
    x = weak.follow(step)
    assert x.max() < 1.6 * 8e-3
    assert abs(x[-1] - 8e-3) < 0.02e-3
    assert strong.follow(step).max() > 8e-3


def test_the_motion_is_exact_under_a_held_drive():
    # far from the goal the drive is at its limit u: v = (u/d) (1 - e^(-d t)) exactly
    axis = Axis(limit=0.01, integral=0.0)
    t = np.arange(200) / axis.rate
    reference = np.full(200, 1.0)
    reference[0] = 0.0
    x = axis.follow(reference)[1:]
    t = t[:-1]
    expected = 0.01 / axis.drag * (t - -np.expm1(-axis.drag * t) / axis.drag)
    np.testing.assert_allclose(x, expected, atol=1e-15)


@pytest.mark.parametrize("name", ["friction", "integral", "integral_zone", "standstill"])
def test_what_an_axis_cannot_have_less_than_none_of_is_refused(name: str):
    assert getattr(Axis(**{name: 0.0}), name) == 0.0
    with pytest.raises(DataError, match=f"axis {name} = -0.1; expected a number >= 0"):
        Axis(**{name: -0.1})


@pytest.mark.parametrize(("name", "value"), [("frequency", 0.0), ("rate", -1.0), ("limit", 0.0)])
def test_an_impossible_axis_is_refused(name: str, value: float):
    with pytest.raises(DataError, match=f"axis {name} = .*expected a number > 0"):
        Axis(**{name: value})


def test_a_slow_controller_is_refused():
    with pytest.raises(DataError, match="needs a control rate of at least 1200 Hz"):
        Axis(frequency=60.0)
