"""Which hits to keep: FRFs of one mode in closed form, one of them of another mode."""

import numpy as np
import pytest

from dashpot.datamodel.frf import FRF, Hit, Kind
from dashpot.extensions.app.hit_selection import estimate_each_hit, propose_hits
from dashpot.simulation.impact import simulate_impact
from dashpot.solids.demo_seals import BROAD
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured_frf import average

LINES = np.arange(1.0, 80.0, 0.25)


def accelerance(hertz, ratio, top=80.0):
    """Of one mode of 0.1 kg: -omega^2 / (k - m omega^2 + j c omega)."""
    lines = LINES[top >= LINES]
    omega, natural = 2 * np.pi * lines, 2 * np.pi * hertz
    return lines, -(omega**2) / (0.1 * (natural**2 - omega**2 + 2j * ratio * natural * omega))


def frf(hertz=12.0, *, top=80.0, scatter=0.0, hits=(), seed=0):
    lines, value = accelerance(hertz, 0.03, top)
    draw = np.random.default_rng(seed).normal(size=(2, len(lines)))
    noisy = value * (1 + scatter * (draw[0] + 1j * draw[1]))
    return FRF(lines, noisy, Kind.ACCELERANCE, hits=tuple(hits), units="SI")


def make_hits(*accepted, rejected=()):
    def make(name, good):
        return Hit(name=name, peak=1.0, duration=0.01, accepted=good, reasons=(), time=0.0)

    return [*(make(name, True) for name in accepted), *(make(name, False) for name in rejected)]


def test_hit_of_another_mode_is_rejected():
    single = {name: frf(scatter=0.01, seed=int(name)) for name in "12345"}
    single["3"] = frf(hertz=12.6, scatter=0.01)
    result = propose_hits(frf(hits=make_hits(*"12345")), single)
    assert result.drop == ("3",)
    assert result.keep == ("1", "2", "4", "5")
    assert result.message.startswith("Keep 1, 2, 4, 5")
    # of both FRFs in closed form
    at = (LINES > 12 / 2.3) & (LINES < 12 * 2.3)
    true, other = accelerance(12.0, 0.03)[1][at], accelerance(12.6, 0.03)[1][at]
    off = np.linalg.norm(other - true) / np.linalg.norm(true)
    assert result.deviations["3"] == pytest.approx(off, rel=0.05)


def test_hits_with_equal_scatter_are_all_accepted():
    for seed in range(20):
        single = {name: frf(scatter=0.05, seed=10 * seed + int(name)) for name in "123456"}
        assert propose_hits(frf(hits=make_hits(*"123456")), single).drop == ()


def test_at_least_three_hits_remain():
    for third in (12.0, 14.0, 20.0):
        single = {name: frf(hertz=12.0) for name in "12"}
        single |= {"3": frf(hertz=third), "4": frf(hertz=25.0)}
        assert len(propose_hits(frf(hits=make_hits(*"1234")), single).keep) >= 3


def test_what_was_rejected_for_its_pulse_is_not_proposed():
    single = {name: frf(scatter=0.01, seed=int(name)) for name in "12345"}
    result = propose_hits(frf(hits=make_hits(*"1235", rejected="4")), single)
    assert result.keep == ("1", "2", "3", "5")


def test_two_hits_are_not_compared():
    result = propose_hits(frf(hits=make_hits(*"12")), {name: frf() for name in "12"})
    assert not result.deviations
    assert "at least three" in result.message


def test_a_softer_blow_that_reaches_less_far_is_compared_where_it_does():
    single = {name: frf(scatter=0.01, seed=int(name)) for name in "1234"}
    single["2"] = frf(scatter=0.01, top=20.0, seed=2)
    assert propose_hits(frf(hits=make_hits(*"1234")), single).drop == ()


def test_simulated_hits_are_accepted_and_each_has_an_frf():
    test, choices = simulate_impact(BROAD, mass=0.1148, seed=3).test, HammerChoices()
    whole = average(test, choices=choices)
    single = estimate_each_hit(test, whole, choices)
    assert single.keys() == {hit.name for hit in whole.hits}
    assert propose_hits(whole, single).drop == ()
