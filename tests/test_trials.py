"""The independent trials against closed forms: a generator that errs would judge nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.trials import (
    DISTURBANCES,
    FAULTLESS,
    KINDS,
    LAWS,
    Seal,
    record,
    relaxation_test,
    strike,
    trial,
)
from scipy.integrate import quad
from scipy.special import erfcx

from dashpot.solids.maxwell import GeneralizedMaxwell

PAPER = Seal.of_arms(196.5, (117.5, 17.8), (0.5021, 16.416))
T = np.geomspace(1e-4, 1e3, 60)


def test_the_fractional_seal_is_mittag_lefflers():
    seal = Seal.fractional(100.0, 50.0, 0.3, 0.5)
    np.testing.assert_allclose(seal.relaxation(T), 100 + 50 * erfcx(np.sqrt(T / 0.3)), rtol=1e-7)
    omega = np.geomspace(1e-3, 1e3, 40)
    power = (1j * omega * 0.3) ** 0.5
    np.testing.assert_allclose(seal.stiffness(omega), 100 + 50 * power / (1 + power), rtol=1e-5)


def test_trial_power_law_agrees_with_its_transform():
    seal = Seal.power_law(100.0, 50.0, 0.02, 0.2)
    np.testing.assert_allclose(seal.relaxation(T), 100 + 50 * (1 + T / 0.02) ** -0.2, rtol=5e-7)
    for s in (0.01, 1.0, 80.0):
        laplace = quad(lambda v, s=s: np.exp(-v) * (1 + v / (s * 0.02)) ** -0.2, 0, np.inf)[0]
        assert seal.at(s) == pytest.approx(100 + 50 * laplace, rel=1e-6)


def test_the_force_is_the_closed_form_of_a_ramp_and_a_hold():
    step, c = 1e-3, 0.5
    t = step * np.arange(5001)
    expected = PAPER.k_inf * np.minimum(t, c)
    for k, tau in zip(PAPER.k, PAPER.tau, strict=True):
        expected += k * tau * (np.exp(-np.maximum(t - c, 0) / tau) - np.exp(-t / tau))
    np.testing.assert_allclose(PAPER.force(np.minimum(t, c), step), expected, rtol=1e-10)


@pytest.mark.parametrize("name", LAWS)
def test_trial_law_reaches_unity_with_its_slope(name):
    law, u = LAWS[name], np.linspace(0, 1, 201)
    assert law.shape(np.zeros(1))[0] == pytest.approx(0, abs=1e-15)
    assert law.shape(np.ones(1))[0] == pytest.approx(1)
    middle = np.diff(law.shape(u)) / np.diff(u)
    np.testing.assert_allclose(law.slope(0.5 * (u[1:] + u[:-1])), middle, rtol=1e-3)


def test_the_cubic_seal_has_the_tangents_of_the_acceptance():
    item = record(PAPER, replace(FAULTLESS, hold=1.0), law="cubic")
    assert 196.5 * item.tangent(8e-3) == pytest.approx(289.5, abs=0.1)
    assert 196.5 * item.tangent(2.6e-3) == pytest.approx(164.7, abs=0.1)


@pytest.mark.parametrize("motion", sorted({kind.motion for kind in KINDS}))
def test_dashpot_computes_the_same_force_for_the_same_motion(motion):
    kind = next(k for k in KINDS if k.motion == motion and k.solid == "4 arms")
    item = trial(kind, seed=3, bench=FAULTLESS.perfect())
    solid = GeneralizedMaxwell(item.seal.k_inf, item.seal.k, item.seal.tau)
    theirs = solid.force(item.time, item.displacement)
    # the motion between samples is a chord to dashpot, and a quarter as coarse here
    assert np.abs(theirs - item.pure).max() < 1e-3
    assert item.displacement[-1] == pytest.approx(item.bench.depth, rel=1e-3)


def test_a_compliant_machine_gives_way_by_its_force():
    item = record(PAPER, replace(FAULTLESS.perfect(), hold=3.0, compliance=50e-6))
    np.testing.assert_allclose(item.compression + 50e-6 * item.pure, item.displacement, atol=1e-12)


def test_filter_and_delay_are_what_they_say():
    still = replace(FAULTLESS.perfect(), hold=3.0)
    pure = record(PAPER, still)
    late = record(PAPER, replace(still, late=5e-3))
    np.testing.assert_allclose(late.force[5:], pure.force[:-5], atol=1e-12)
    low = record(PAPER, replace(still, force_filter=10.0))
    slope = np.gradient(low.force, low.time)
    np.testing.assert_allclose(low.force + slope / (20 * np.pi), pure.force, atol=2e-3)


def test_the_hammer_rings_at_the_accelerance():
    hits = strike(Seal.fractional(150, 120, 0.2, 0.5), mass=0.104, hits=2, noise=(0, 0), seed=4)
    ratio = np.fft.rfft(hits.acceleration) / np.fft.rfft(hits.hammer)
    frequency = np.fft.rfftfreq(len(hits.time), 1 / 2048)
    band = (frequency > 3) & (frequency < 60)
    np.testing.assert_allclose(ratio[band], hits.accelerance(frequency[band]), rtol=3e-3)
    pole = hits.pole()
    assert pole.imag > 0 > pole.real
    assert abs(hits.mass * pole**2 + 2 * hits.seal.at(pole)) < 1e-6


def test_the_42_kinds_are_drawn_by_their_seed():
    assert len({kind.name for kind in KINDS}) == 42
    item, again, other = (trial(KINDS[5], seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(item.force, again.force)
    assert item.seal != other.seal
    assert item.k_end(3) < item.k_end() < item.seal.relaxation(1.0)


@pytest.mark.parametrize("name", DISTURBANCES)
def test_a_disturbance_shows_in_the_record(name):
    bench = replace(DISTURBANCES[name], hold=5.0)
    intact = replace(bench, **{
        field: getattr(FAULTLESS, field)
        for field in ("late", "force_filter", "hum", "drift", "compliance", "creep", "friction",
                      "slip", "clip", "noise_time", "interval", "axis", "damping")
    })  # fmt: skip
    bad, good = record(PAPER, bench, seed=2), record(PAPER, intact, seed=2)
    assert np.abs(bad.force - good.force).max() > 1e-3
    assert relaxation_test(bad).time[-1] == pytest.approx(7.5)
