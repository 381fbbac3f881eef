"""Verdicts on hammer hits."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.vibration.impact.hit_faults import find_second_pulse, is_flat_topped, judge_hit
from dashpot.vibration.impact.hits import HitBlock

BEFORE = 200


def hit(force, rate=2048.0, *, response=None, noise=0.0, seconds=4.0):
    """A hit with a given pulse and a response that decays within the record."""
    random = np.random.default_rng(0)
    n = round(seconds * rate)
    f = np.zeros(n)
    f[BEFORE : BEFORE + len(force)] = force
    t = (np.arange(n) - BEFORE) / rate
    a = np.where(t > 0, np.exp(-2 * t) * np.sin(80 * t), 0) if response is None else response
    f = f + noise * random.standard_normal(n)
    return HitBlock(
        name="1", time=0.0, rate=rate, onset=BEFORE, force=f, acceleration=a[None, :],
        noise=np.array([noise, 0.0]), ringing=np.zeros(1), offset=np.zeros(2),
    )  # fmt: skip


def half_sine(milliseconds, rate=2048.0, phase=0.3):
    n = int(milliseconds * rate / 1000)
    return np.clip(np.sin(np.pi * (np.arange(n) + phase) * 1000 / rate / milliseconds), 0, None)


def haversine(milliseconds, rate=2048.0):
    return half_sine(milliseconds, rate) ** 2


@pytest.mark.parametrize("shape", [half_sine, haversine])
@pytest.mark.parametrize(
    ("milliseconds", "rate"),
    [
        (milliseconds, rate)
        for milliseconds in (3, 8, 12, 20, 40)
        for rate in (1000.0, 2048.0, 5000.0, 25600.0)
        if milliseconds * rate >= 6000  # six samples
    ],
)
@pytest.mark.parametrize("noise", [0.0, 1e-3, 0.01])
def test_a_clean_pulse_of_a_soft_tip_is_no_double_hit(shape, milliseconds, rate, noise):
    verdict = judge_hit(hit(3 * shape(milliseconds, rate), rate, noise=noise, seconds=3.5))
    assert verdict.faults == ()


@pytest.mark.parametrize("share", [0.08, 0.2, 0.4, 0.9])
@pytest.mark.parametrize("gap", [20, 60, 200])
def test_a_second_pulse_is_a_double_hit(share, gap):
    first = 3 * half_sine(12)
    force = np.concatenate((first, np.zeros(2 * gap), share * first))
    (fault,) = judge_hit(hit(force, noise=0.005)).faults
    assert fault.startswith(f"double hit: a second pulse of {100 * share:.0f} %")
    assert fault.endswith("ms after it")


def test_judge_hit_counts_a_smaller_pulse_before_the_main_pulse():
    first = 3 * half_sine(12)
    force = np.concatenate((0.3 * first, np.zeros(100), first))
    (fault,) = judge_hit(hit(force)).faults
    assert fault.endswith("before it")


def test_two_humps_that_touch_are_a_double_hit():
    t = np.arange(80) / 80
    humps = np.exp(-(((t - 0.3) / 0.1) ** 2)) + 0.8 * np.exp(-(((t - 0.7) / 0.1) ** 2))
    height, after = find_second_pulse(hit(humps))
    assert height > 0.5
    assert after == pytest.approx(0.4 * 80 / 2048, rel=0.1)


def test_ringing_of_a_filter_about_a_short_pulse_is_no_double_hit():
    ringing = np.sinc((np.arange(60) - 20.4) * 0.9)
    assert judge_hit(hit(ringing)).faults == ()


@pytest.mark.parametrize("level", [0.5, 0.8, 0.93])
@pytest.mark.parametrize("noise", [0.0, 0.002, 0.01])
def test_an_overloaded_hammer_is_noticed_under_noise(level, noise):
    clipped = 3 * np.minimum(half_sine(15), level)
    (fault,) = judge_hit(hit(clipped, noise=noise)).faults
    assert "hammer overload: the pulse is flat" in fault


def test_a_short_pulse_is_flat_only_where_neighbours_are_equal():
    assert is_flat_topped(np.array([0.5, 2.0, 2.0, 2.0, 0.6]), 0.0)
    assert not is_flat_topped(np.array([0.5, 1.9, 2.0, 1.9, 0.6]), 0.0)


def test_an_overloaded_accelerometer_is_noticed():
    t = np.arange(8192) / 2048
    response = np.clip(20 * np.exp(-2 * t) * np.sin(80 * t), -12, 12)
    (fault,) = judge_hit(hit(half_sine(12), response=response)).faults
    assert "acceleration 1 overloads: it is flat at 12" in fault


def test_a_record_that_begins_inside_the_pulse_is_useless():
    late = hit(half_sine(12))
    cut = HitBlock(
        name="1", time=0.0, rate=late.rate, onset=0, force=late.force[BEFORE + 8 :],
        acceleration=late.acceleration[:, BEFORE + 8 :], noise=np.zeros(2), ringing=np.zeros(1),
        offset=np.zeros(2),
    )  # fmt: skip
    verdict = judge_hit(cut)
    assert any("begins inside the pulse" in fault for fault in verdict.faults)
    assert any("only 0 samples lie before the pulse" in doubt for doubt in verdict.doubts)


@pytest.mark.parametrize("samples", [1, 2, 4])
def test_an_undersampled_pulse_is_doubtful_not_wrong(samples):
    verdict = judge_hit(hit(np.full(samples, 2.0) - 0.01 * np.arange(samples)))
    assert verdict.faults == ()
    assert any(f"{samples} sample" in doubt for doubt in verdict.doubts)


def test_judge_hit_reports_a_truncated_response_for_each_window():
    t = (np.arange(4096) - BEFORE) / 2048
    response = np.where(t > 0, np.exp(-0.5 * t) * np.sin(80 * t), 0)
    ringing = hit(half_sine(12), response=response, seconds=2.0)
    (plain,) = judge_hit(ringing).doubts
    assert "expected 1 % without a window" in plain
    (windowed,) = judge_hit(ringing, windowed=True).doubts
    assert "expected 25 % with a window" in windowed
    assert judge_hit(hit(half_sine(12))).doubts == ()


@pytest.mark.parametrize("noise", [0.0, 2e-3])
@pytest.mark.parametrize("start", [300, 700, 1100])
def test_a_response_that_stands_still_while_it_rings_is_a_fault(start, noise):
    t = (np.arange(8192) - BEFORE) / 2048
    ring = np.where(t > 0, np.exp(-2 * t) * np.sin(80 * t), 0)
    ring = ring + noise * np.random.default_rng(1).standard_normal(len(t))
    assert judge_hit(hit(3 * half_sine(12), response=ring, noise=1e-3)).faults == ()
    ring[start:] = ring[start]
    faults = judge_hit(hit(3 * half_sine(12), response=ring, noise=1e-3)).faults
    # at its lowest value it may as well be cut off there
    words = ("acceleration 1 has one and the same value", "acceleration 1 overloads")
    assert any(fault.startswith(words) for fault in faults)


@pytest.mark.parametrize("count", [1e-4, 1e-3, 1e-2, 5e-2])
@pytest.mark.parametrize("noise", [0.0, 1e-4, 2e-3])
def test_judge_hit_accepts_a_response_that_decays_in_counts(count, noise):
    t = (np.arange(16384) - BEFORE) / 2048
    ring = np.where(t > 0, np.exp(-2 * t) * np.sin(80 * t), 0)
    ring = ring + noise * np.random.default_rng(1).standard_normal(len(t))
    ring = np.round(ring / count) * count
    made = judge_hit(hit(3 * half_sine(12), response=ring, noise=1e-3, seconds=8.0))
    assert not any("one and the same value" in reason for reason in made.reasons)


def test_doubt_about_a_coarse_pulse_counts_samples_above_a_tenth():
    """11 ms at 250 Hz were "2 samples long" beside a width of 11 ms."""
    block = hit(3 * half_sine(11, 250.0), 250.0)
    (doubt,) = (text for text in judge_hit(block).doubts if "guesswork" in text)
    samples = block.pulse(0.1).stop - block.pulse(0.1).start
    assert f"only {samples} samples of the pulse exceed a tenth of its peak" in doubt
    assert "long" not in doubt
    # from the first to the last of them it is shorter than its width by lines beyond both
    assert (samples - 1) / block.rate < block.width(0.1)
