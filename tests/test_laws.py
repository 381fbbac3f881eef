"""Laws that every linear passive solid obeys, whatever its numbers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.base.units import GRAVITY
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import predict_frf

stiffness = st.floats(1e-2, 1e6)
time = st.floats(1e-4, 1e4)


@st.composite
def solids(draw, b=True):
    arms = draw(st.lists(st.tuples(stiffness, time), max_size=4))
    return GeneralizedMaxwell(
        draw(stiffness),
        tuple(k for k, _ in arms),
        tuple(tau for _, tau in arms),
        draw(st.sampled_from([0.0, 3.0, 250.0])) if b else 0.0,
    )


histories = st.lists(
    st.tuples(st.floats(1e-3, 2.0), st.floats(-0.01, 0.01)), min_size=3, max_size=30
)


def history(steps):
    t = np.concatenate(([0.0], np.cumsum([dt for dt, _ in steps])))
    return t, np.concatenate(([0.0], [x for _, x in steps]))


OMEGA = np.geomspace(1e-5, 1e5, 60)


@given(solids())
def test_passive_at_every_frequency(solid):
    assert (solid.loss(omega=OMEGA) >= 0).all()
    assert (solid.storage(omega=OMEGA) >= solid.k_inf * (1 - 1e-12)).all()
    assert (np.diff(solid.storage(omega=OMEGA)) >= -1e-9 * solid.k_0).all()


@given(solids(b=False))
def test_limits(solid):
    assert solid.storage(omega=0.0) == pytest.approx(solid.k_inf)
    assert solid.storage(omega=1e12) == pytest.approx(solid.k_0, rel=1e-6)
    assert solid.relaxation(0.0) == pytest.approx(solid.k_0)
    assert solid.relaxation(1e9) == pytest.approx(solid.k_inf)


@given(solids(), solids())
def test_parallel_solids_add(a, b):
    both = a + b
    np.testing.assert_allclose(
        both.complex_stiffness(omega=OMEGA),
        a.complex_stiffness(omega=OMEGA) + b.complex_stiffness(omega=OMEGA),
    )
    np.testing.assert_allclose(
        (a + a).complex_stiffness(omega=OMEGA), (2 * a).complex_stiffness(omega=OMEGA)
    )


@given(solids(), histories, histories, st.floats(-3, 3))
def test_superposition(solid, first, second, factor):
    n = min(len(first), len(second))
    t, x = history(first[:n])
    _, y = history(second[:n])
    together = solid.force(t, x + factor * y)
    separate = solid.force(t, x) + factor * solid.force(t, y)
    scale = np.abs(solid.force(t, x)).max() + np.abs(solid.force(t, y)).max() + 1e-12
    np.testing.assert_allclose(together, separate, atol=1e-9 * scale * (1 + abs(factor)))


@given(solids(), histories, st.floats(0.01, 100))
def test_time_scales(solid, steps, factor):
    t, x = history(steps)
    slow = GeneralizedMaxwell(
        solid.k_inf, solid.k, tuple(factor * tau for tau in solid.tau), factor * solid.b
    )
    expected = solid.force(t, x)
    np.testing.assert_allclose(
        slow.force(factor * t, x), expected, atol=1e-8 * (np.abs(expected).max() + 1e-12)
    )


@given(solids(b=False), histories)
def test_recursion_is_the_hereditary_integral(solid, steps):
    """F(t) = sum over segments of the slope times the integral of k(t - u) du, in closed form."""
    t, x = history(steps)
    slope = np.diff(x) / np.diff(t)
    expected = [0.0]
    for end in t[1:]:
        lag_start, lag_end = end - t[:-1], end - t[1:]
        used = lag_end >= 0
        total = solid.k_inf * np.sum((slope * (lag_start - lag_end))[used])
        for k, tau in zip(solid.k, solid.tau, strict=True):
            # not as a difference, of which a slow arm leaves few digits
            decay = np.exp(-np.where(used, lag_end, 0) / tau) * -np.expm1(-np.diff(t) / tau)
            total += k * tau * np.sum((slope * decay)[used])
        expected.append(total)
    scale = solid.k_0 * np.abs(x).max() + 1e-12
    np.testing.assert_allclose(solid.force(t, x), expected, atol=1e-9 * scale)


@given(solids(b=False))
def test_recursion_against_slow_quadrature(solid):
    """A smooth history: midpoint quadrature of the convolution converges to the recursion."""
    t = np.linspace(0, 3, 61)
    x = np.sin(t) * 1e-3
    fine = np.linspace(0, 3, 60 * 400 + 1)
    middle = (fine[1:] + fine[:-1]) / 2
    velocity = np.diff(np.interp(fine, t, x))
    force = np.sum(solid.relaxation(3 - middle) * velocity)
    if min(solid.tau, default=1.0) > 0.05:  # the midpoint rule must resolve the fastest arm
        assert solid.force(t, x)[-1] == pytest.approx(force, abs=2e-6 * solid.k_0 * 1e-3)


@given(solids(b=False), st.floats(0.05, 5))
def test_ramp_hold_is_the_recursion_on_a_ramp(solid, ramp):
    t = np.unique(np.concatenate((np.linspace(0, ramp, 9), ramp + np.geomspace(1e-3, 40, 30))))
    x = 8e-3 * np.minimum(t / ramp, 1)
    closed = solid.ramp_hold_force(t, depth=8e-3, ramp_time=ramp)
    np.testing.assert_allclose(solid.force(t, x), closed, atol=1e-10 * solid.k_0)


@given(solids(b=False))
def test_fast_ramp_is_a_step(solid):
    t = np.array([1.0, 10.0])
    force = solid.ramp_hold_force(t, depth=1e-3, ramp_time=1e-9)
    tolerance = 1e-3 * solid.k_0 * 1e-5  # a ramp lasts 1e-5 of the fastest relaxation time
    np.testing.assert_allclose(force, 1e-3 * solid.relaxation(t), atol=tolerance, rtol=1e-4)


@st.composite
def draw_carried_mass(draw):
    """A solid and a mass that presses it no farther than any seal is."""
    solid = draw(solids())
    return solid, draw(st.floats(1e-6, min(1e3, 0.199 * solid.k_inf / GRAVITY)))


@given(draw_carried_mass())
def test_a_mass_makes_a_passive_receptance(part):
    solid, mass = part
    frf = predict_frf(solid, mass=mass, frequency=np.geomspace(1e-3, 1e3, 50), kind="receptance")
    assert (frf.value.imag <= 1e-12 * np.abs(frf.value)).all()


@given(draw_carried_mass(), st.floats(0, 5))
def test_kinds_convert_and_return(part, shift):
    solid, mass = part
    frf = predict_frf(solid, mass=mass, frequency=np.geomspace(0.1, 1e2, 20), shift=shift)
    for kind in ("receptance", "mobility", "dynamic_stiffness"):
        direct = predict_frf(solid, mass=mass, frequency=frf.frequency, kind=kind, shift=shift)
        np.testing.assert_allclose(frf.to(kind).value, direct.value, rtol=1e-9)
        np.testing.assert_allclose(frf.to(kind).to("accelerance").value, frf.value, rtol=1e-9)


@given(solids(), st.floats(0.01, 1), st.floats(0.01, 1))
def test_length_scales_stiffness(solid, length, measured):
    cut = solid.with_length(length, measured_length=measured)
    np.testing.assert_allclose(
        cut.complex_stiffness(omega=OMEGA), solid.complex_stiffness(omega=OMEGA) * length / measured
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((-1.0,), "k_inf = -1.0; a passive solid needs k_inf >= 0"),
        ((1.0, (2.0,), (0.1, 0.2)), "every arm needs a k and a tau, found 1 k and 2 tau"),
        ((1.0, (-2.0,), (0.1,)), "k_1 = -2.0; a passive arm needs k > 0"),
        ((1.0, (2.0,), (0.0,)), "tau_1 = 0.0; a passive arm needs tau > 0"),
        ((1.0, (2.0,), (float("nan"),)), "tau_1 = nan"),
    ],
)
def test_what_no_passive_solid_can_be_is_refused(arguments, message):
    with pytest.raises(DataError, match=message.replace("(", r"\(")):
        GeneralizedMaxwell(*arguments)
