"""The solids that dashpot is judged on, held to closed forms: a truth that errs judges nothing."""

from __future__ import annotations

from math import gamma

import numpy as np
import pytest
from kit.foreign.rigs import Protocol
from kit.foreign.truths import FAMILIES, TABLE_1, TRUTHS, Seal, Solid, draw_truth, slider
from scipy.integrate import quad
from scipy.special import erfcx

T = np.geomspace(1e-4, 3e3, 60)
OMEGA = np.geomspace(1e-3, 1e4, 60)
EACH = [draw_truth(family, 3) for family in FAMILIES]


def make_cases(solids):
    return {"argvalues": solids, "ids": [solid.name for solid in solids]}


@pytest.mark.parametrize("alpha", [0.3, 0.5, 0.75])
def test_dense_sums_are_the_closed_stiffnesses(alpha):
    z, beta = (0.3j * OMEGA) ** alpha, alpha / 2
    zener = Solid.fractional("", 100.0, 50.0, 0.3, alpha)
    pot = Solid.springpot("", 100.0, 50.0, beta)
    np.testing.assert_allclose(zener.stiffness(OMEGA), 100 + 50 * z / (1 + z), rtol=2e-7)
    np.testing.assert_allclose(pot.stiffness(OMEGA), 100 + 50 * (1j * OMEGA) ** beta, rtol=2e-7)
    np.testing.assert_allclose(pot.relaxation(T), 100 + 50 * T**-beta / gamma(1 - beta), rtol=2e-7)


def test_the_fractional_zener_relaxes_as_mittag_leffler():
    half = Solid.fractional("", 100.0, 50.0, 0.3, 0.5)
    np.testing.assert_allclose(half.relaxation(T), 100 + 50 * erfcx(np.sqrt(T / 0.3)), rtol=1e-9)
    alpha, n = 0.7, np.arange(60)[:, None]
    early = T[T < 0.3]
    series = np.sum((-((early / 0.3) ** alpha)) ** n / np.vectorize(gamma)(alpha * n + 1), axis=0)
    fractional = Solid.fractional("", 100.0, 50.0, 0.3, alpha)
    np.testing.assert_allclose(fractional.relaxation(early), 100 + 50 * series, rtol=1e-8)


def test_foreign_power_law_and_its_stiffness_agree():
    power_law = Solid.power_law("", 100.0, 50.0, 0.02, 0.2)
    np.testing.assert_allclose(
        power_law.relaxation(T), 100 + 50 * (1 + T / 0.02) ** -0.2, rtol=5e-8
    )
    for s in (0.01, 1.0, 80.0):
        # the same sum at a real rate, against the integral
        result = 100 + sum(
            k * s * t / (1 + s * t) for k, t in zip(power_law.k, power_law.tau, strict=True)
        )
        whole = quad(lambda u, s: np.exp(-u) * (1 + u / s / 0.02) ** -0.2, 0, 60, (s,))[0]
        assert result == pytest.approx(100 + 50 * whole, rel=1e-7)


@pytest.mark.parametrize("solid", **make_cases(TRUTHS))
def test_every_truth_is_passive_and_ends_where_it_says(solid):
    t = np.geomspace(1e-5, 1e4, 200)
    k, K = solid.relaxation(t), solid.stiffness(1 / t)
    assert min(solid.k) >= 0
    assert np.all(np.diff(k) <= 0)
    assert np.all(np.diff(K.real) <= 1e-12 * K.real[1:])
    assert np.all(K.imag >= 0)
    # of an exponential k(t) - K'(1/t) is at most .44 of the arm, both between k_inf and k_0
    assert np.all(k >= solid.k_inf)
    if "arm" in solid.name:
        assert solid.relaxation(1e4) == pytest.approx(solid.k_inf, rel=1e-9)
        assert solid.stiffness(1e-9) == pytest.approx(solid.k_inf, rel=1e-6)
        assert solid.relaxation(0.0) == pytest.approx(solid.k_inf + sum(solid.k))


def test_truths_are_42_others_by_another_seed_and_in_a_seals_range():
    assert len({truth.name for truth in TRUTHS}) == len(TRUTHS) == 42
    assert draw_truth("3 arms", 1) == draw_truth("3 arms", 1) != draw_truth("3 arms", 2)
    for item in TRUTHS:
        assert 50 < item.relaxation(40.0) < 2000


def compute_by_recursion(solid, x, step):
    """The exact recursion, in 80 bits."""
    k, tau = np.array(solid.k, np.longdouble), np.array(solid.tau, np.longdouble)
    decay, mean = np.exp(-step / tau), -np.expm1(-step / tau) * tau / step
    held, force = np.zeros_like(k), []
    for dx in np.diff(np.asarray(x, np.longdouble), prepend=0):
        held = held * decay + k * mean * dx
        force.append(held.sum())
    return np.asarray(force + np.longdouble(solid.k_inf) * x, float)


@pytest.mark.parametrize("solid", **make_cases(EACH))
def test_the_force_is_that_of_the_exact_recursion(solid):
    x = np.cumsum(np.random.default_rng(5).standard_normal(2500)) * 1e-4
    x -= x[0]
    expected = compute_by_recursion(solid, x, 1e-3)
    np.testing.assert_allclose(
        solid.force(x, 1e-3), expected, atol=3e-14 * np.abs(expected).max(), rtol=0
    )


def test_the_force_of_table_1_is_the_papers():
    """Domain numbers of 8 mm in 1 s, by eq. 5."""
    _, x = Protocol(rounding=0.0, baseline=0.0).plate()
    force = TABLE_1.force(x, 5e-4)
    at = np.array([0.25, 0.5, 1, 1.5, 2, 3, 5, 10, 20, 41])
    expected = [
        0.613441, 1.153750, 2.117728, 1.856581, 1.757614, 1.701896, 1.680416, 1.651845, 1.615420,
        1.584081,
    ]  # fmt: skip
    np.testing.assert_allclose(force[np.round(at * 2000).astype(int)], expected, atol=6e-7)


def test_a_ramp_of_a_springpot_and_of_a_power_law_is_exact():
    t = np.arange(4001) / 1000
    pot = Solid.springpot("", 100.0, 50.0, 0.4).force(2e-3 * t, 1e-3)
    expected = 2e-3 * (100 * t + 50 * t**0.6 / gamma(1.6))
    np.testing.assert_allclose(pot[1:], expected[1:], rtol=1e-6)
    law = Solid.power_law("", 100.0, 50.0, 0.02, 0.2).force(2e-3 * t, 1e-3)
    expected = 2e-3 * (100 * t + 50 * 0.02 * ((1 + t / 0.02) ** 0.8 - 1) / 0.8)
    np.testing.assert_allclose(law[1:], expected[1:], rtol=1e-6)


@pytest.mark.parametrize("solid", **make_cases(EACH))
def test_foreign_force_of_smooth_motion_converges(solid):
    """What a motion does between instants: against a clock four times as fine."""
    sent = Protocol(ramp=0.5, hold=1.5, rate=250.0, servo=(8.0, 0.5))
    _, coarse = sent.plate()
    _, fine = Protocol(ramp=0.5, hold=1.5, rate=8000.0, servo=(8.0, 0.5)).plate()
    force = solid.force(fine, 1 / 8000)[::4]
    assert np.max(np.abs(solid.force(coarse, 1 / 2000) - force)) < 1e-5 * force.max()


@pytest.mark.parametrize("solid", **make_cases(EACH))
def test_the_stiffness_is_that_of_a_steady_vibration(solid):
    omega = 2 * np.pi * 5.0
    t = np.arange(60 * 2000) / 2000
    x = 1e-3 * np.sin(omega * t) * np.clip(t, 0, 1)
    last = slice(-2000, None)
    # a slow remainder of the start is a straight line by now
    columns = np.stack((np.sin(omega * t), np.cos(omega * t), np.ones_like(t), t))[:, last]
    result = np.linalg.lstsq(columns.T, solid.force(x, 1 / 2000)[last], rcond=None)[0]
    # a polygon's first harmonic
    seen = np.sinc(5.0 / 2000) ** 2
    assert 1e3 * (result[0] + 1j * result[1]) == pytest.approx(
        complex(solid.stiffness(omega)), rel=2e-4
    )
    assert seen == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("solid", **make_cases(EACH))
def test_forces_superpose_and_wait(solid):
    random = np.random.default_rng(0)
    value, two = 1e-3 * random.standard_normal((2, 900))
    value[0] = two[0] = 0.0
    both = solid.force(value, 0.01) + 2 * solid.force(two, 0.01)
    np.testing.assert_allclose(solid.force(value + 2 * two, 0.01), both, atol=1e-9)
    later = solid.force(np.concatenate((np.zeros(50), value)), 0.01)
    np.testing.assert_allclose(later[50:], solid.force(value, 0.01), atol=1e-9)


def test_the_peak_of_the_papers_block_and_its_limits():
    seal = Seal(TABLE_1)
    assert seal.peak(0.1040426, 2) == pytest.approx((12.71, 1083.79), rel=1e-5)
    assert abs(seal.accelerance(1e4, 0.104, 2)) == pytest.approx(1 / 0.104, rel=1e-4)
    heavy = seal.mass_at(9.0, 2)
    assert seal.peak(heavy, 2)[0] == pytest.approx(9.0, rel=2e-4)


def test_a_bent_law_keeps_its_secant_and_says_its_tangent():
    for a, c in [(0.08, 0.0), (-0.2, 0.0), (0.0, 46.5 / 196.5)]:
        seal = Seal(TABLE_1, 8e-3, a=a, c=c)
        x = np.array([8e-3, 8e-3 + 1e-9])
        e = seal.elastic(x)
        assert e[0] == pytest.approx(8e-3)
        assert np.diff(e)[0] / np.diff(x)[0] == pytest.approx(seal.tangent, rel=1e-6)
    assert seal.tangent == pytest.approx(0.2895 / 0.1965, rel=1e-3)
    assert seal.stiffness(1.0) == pytest.approx(seal.tangent * TABLE_1.stiffness(1.0))


def test_a_slider_is_jenkins():
    t = np.linspace(0, 2, 4001)
    x = 1e-3 * np.sin(2 * np.pi * t)
    force = slider(x, 2.0, 5e3)
    last = slice(2000, None)
    assert np.max(np.abs(force)) == 2.0
    # 4 F (X - F/k); and the first harmonic of it
    assert np.trapezoid(force[last], x[last]) == pytest.approx(4.8e-3, rel=1e-5)
    storage = 2 * np.mean(force[last][:-1] * np.sin(2 * np.pi * t[last][:-1])) / 1e-3
    assert storage == pytest.approx(1867.650, rel=1e-4)


def test_sliders_do_not_relax_and_stick_after_a_turn():
    seal = Seal(Solid.arms("spring", 0.0, [1e-12], [1.0]), friction=0.5)
    way = np.concatenate((np.linspace(0, 5e-3, 50), np.full(20, 5e-3), [4.99e-3]))
    force = seal.force(way, 0.1)
    np.testing.assert_allclose(force[49:70], 0.5, atol=1e-12)
    # all five are stuck again: 10 um times the sum of their springs
    assert force[-1] == pytest.approx(0.5 - 1e-5 * 0.1 / 1e-4 * (2 - 2.0**-4), rel=1e-9)
