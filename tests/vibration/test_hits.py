"""Hits are found in continuous records and cut; hits that the others contradict are left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.impact.hits import cut_hits

RATE = 2048
NOISE = (5e-3, 0.02)


def record_of(*starts, seconds=30.0, peaks=None, noise=2e-3, double=None):
    """A continuous record of 10 ms pulses at given times, and a response that decays in 1 s."""
    random = np.random.default_rng(0)
    t = np.arange(round(seconds * RATE)) / RATE
    force = noise * random.standard_normal(len(t))
    response = noise * random.standard_normal(len(t))
    for i, start in enumerate(starts):
        peak = 3.0 if peaks is None else peaks[i]
        since = t - start
        force += np.where((since >= 0) & (since <= 0.01), peak * np.sin(np.pi * since / 0.01), 0)
        response += np.where(since > 0, 10 * peak * np.exp(-5 * since) * np.sin(80 * since), 0)
    return ImpactTest(time=t, force=force, acceleration=response[None], units="SI")


def test_cut_hits_detects_every_hit_with_its_time():
    starts = (1.0, 7.3, 13.0, 19.9)
    hits = cut_hits([record_of(*starts)])
    assert [hit.time for hit in hits] == pytest.approx(starts, abs=2e-3)
    assert [hit.name for hit in hits] == ["1", "2", "3", "4"]
    # as long as the shortest way to the next hit, less the quiet before it
    assert hits[0].length == pytest.approx(5.7, abs=0.02)
    assert {hit.onset for hit in hits} == {round(0.1 * RATE)}
    assert [hit.missing for hit in hits] == [0, 0, 0, 0]


def test_a_blow_knows_its_pulse():
    hit = cut_hits([record_of(1.0, noise=0.0)])[0]
    assert hit.peak == pytest.approx(3.0, rel=1e-3)
    assert hit.width(0.5) == pytest.approx(0.01 * 2 / 3, rel=0.01)
    middle, rms = hit.moments()
    assert middle + hit.time - hit.onset / RATE == pytest.approx(1.005, abs=1e-4)
    assert rms == pytest.approx(0.01 * np.sqrt(0.25 - 2 / np.pi**2), rel=0.02)


def test_taps_far_weaker_than_the_blows_are_no_blows():
    hits = cut_hits([record_of(1.0, 8.0, 15.0, peaks=(3.0, 0.1, 2.5))])
    assert [hit.time for hit in hits] == pytest.approx([1.0, 15.0], abs=2e-3)


def test_a_hasty_blow_does_not_shorten_the_others():
    frf = estimate_frf(record_of(1.0, 8.0, 9.5, 16.0, 23.0))
    assert [hit.accepted for hit in frf.hits] == [True, False, True, True, True]
    assert "double hit" in frf.hits[1].reasons[0]
    assert frf.record > 6


@pytest.mark.parametrize("value", [0.0, 9.81])
def test_a_channel_that_never_moves_is_no_accelerometer(value):
    test = record_of(1.0)
    dead = np.vstack((test.acceleration, np.full(len(test.time), value)))
    with pytest.raises(DataError, match=f"acceleration 2 is {value:g} m/s.2 throughout"):
        cut_hits([ImpactTest(test.time, test.force, dead, units="SI")])


def test_estimate_frf_reports_a_record_that_ends_too_soon():
    frf = estimate_frf(record_of(1.0, 8.0, 15.0, 22.0, 28.5))
    assert [hit.accepted for hit in frf.hits] == [True, True, True, True, False]
    assert "the recording ends" in frf.hits[4].reasons[0]


def test_estimate_frf_reports_a_record_that_starts_in_the_pulse(strike):
    test = strike(record=4.0, hits=3, noise=NOISE)
    n, late = 4 * RATE, round(0.106 * RATE)
    keep = np.r_[late:n, n : 3 * n]
    cut = ImpactTest(
        test.time[keep], test.force[keep], test.acceleration[:, keep],
        starts=(0, n - late, 2 * n - late), units="SI",
    )  # fmt: skip
    frf = estimate_frf(cut)
    assert [hit.accepted for hit in frf.hits] == [False, True, True]
    assert "begins inside the pulse" in frf.hits[0].reasons[0] or "ends" in frf.hits[0].reasons[0]
    # alone, it is as long as its recording: nothing is missing at the end
    with pytest.raises(DataError, match="no hit is left to average") as refusal:
        estimate_frf(
            ImpactTest(
                cut.time[: n - late],
                cut.force[: n - late],
                cut.acceleration[:, : n - late],
                units="SI",
            )
        )
    message = str(refusal.value)
    assert "hit 1: the recording begins inside the pulse" in message
    assert "recording ends" not in message
    assert message.endswith("accept it by name")


def test_estimate_frf_rejects_an_incoherent_hit(strike):
    test = strike(record=4.0, hits=5, noise=NOISE)
    n = 4 * RATE
    acceleration = test.acceleration.copy()
    acceleration[:, 2 * n : 3 * n] *= 1.5  # a loose accelerometer
    frf = estimate_frf(replace(test, acceleration=acceleration))
    assert [hit.accepted for hit in frf.hits] == [True, True, False, True, True]
    assert frf.hits[2].reasons[0].startswith("incoherent: its response differs by")
    forced = estimate_frf(replace(test, acceleration=acceleration), accept=["3"])
    assert forced.averages == 5
    assert [c.passed for c in forced.checks if c.name == "hits_agree"] == [False]


def test_of_three_hits_nobody_knows_which_is_wrong(strike):
    test = strike(record=4.0, hits=3, noise=NOISE)
    acceleration = test.acceleration.copy()
    acceleration[:, : 4 * RATE] *= 1.5
    frf = estimate_frf(replace(test, acceleration=acceleration))
    assert frf.averages == 3
    assert next(c for c in frf.checks if c.name == "hits_agree").failed


def test_the_mean_of_the_quiet_before_is_taken_off(strike):
    hit = cut_hits([strike(offset=(0.2, -1.5))])[0]
    assert hit.offset == pytest.approx([0.2, -1.5], abs=1e-9)
    assert np.abs(hit.force[: hit.onset - 2]).max() < 1e-9


def test_cut_hits_estimates_noise_without_ringing():
    hit = cut_hits([record_of(1.0, noise=0.01)])[0]
    assert hit.noise == pytest.approx([0.01, 0.01], rel=0.2)
