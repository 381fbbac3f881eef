"""Filters that a user may ask for, and the bias that each brings."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from dashpot.base.errors import DataError
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.fitting.relaxation import check_filter_bias
from dashpot.preprocessing.prepare import prepare
from dashpot.preprocessing.signal_conditioning import Filter, filter_record, parse_filter


@pytest.fixture(scope="module")
def ideal(paper_seal) -> RampHold:
    """The paper's test without noise or lag, at the 100 Hz of the reference's table."""
    time = np.arange(4301) / 100
    x = 8e-3 * np.clip(time - 2.0, 0, 1)
    return prepare(
        RelaxationTest(time=time, displacement=x, force=paper_seal.force(time, x), units="SI")
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("lowpass:10Hz", Filter("lowpass", cutoff=10.0)),
        (" lowpass:0.5 kHz ", Filter("lowpass", cutoff=500.0)),
        ("lowpass:2Hz:causal", Filter("lowpass", cutoff=2.0, causal=True)),
        ("notch:50Hz", Filter("notch", cutoff=50.0)),
        ("median:5", Filter("median", window=5)),
    ],
)
def test_a_filter_is_named_in_words(text: str, expected: Filter):
    assert parse_filter(text) == expected
    assert parse_filter(str(expected)) == expected


@pytest.mark.parametrize(
    "text", ["lowpass", "lowpass:10", "lowpass:0Hz", "lowpass:10s", "median:4", "median:1",
             "median:x", "smooth:3", "lowpass:10Hz:fast", ""],
)  # fmt: skip
def test_parse_filter_lists_valid_filters(text: str):
    with pytest.raises(DataError, match=r"filter .*expected 'lowpass:10Hz'"):
        parse_filter(text)


def test_zero_phase_is_forwards_and_backwards():
    time = np.arange(1000) / 100
    wave = np.sin(2 * np.pi * 3 * time)
    b, a = signal.butter(2, 5.0, fs=100)
    middle = slice(200, 800)
    result = Filter("lowpass", cutoff=5.0)(time, wave)[middle]
    np.testing.assert_allclose(result, signal.filtfilt(b, a, wave)[middle], atol=1e-6)
    gain = np.abs(signal.freqz(b, a, [3.0], fs=100)[1][0]) ** 2
    np.testing.assert_allclose(result, gain * wave[middle], atol=1e-4)


def test_a_causal_filter_delays_and_starts_settled():
    time = np.arange(1000) / 100
    flat = Filter("lowpass", cutoff=5.0, causal=True)(time, np.full(1000, 3.0))
    np.testing.assert_allclose(flat, 3.0, atol=1e-12)
    step = Filter("lowpass", cutoff=5.0, causal=True)(time, (time >= 5) * 1.0)
    assert np.abs(step[time < 5]).max() == 0.0
    assert step[505] < 0.9


def test_a_notch_takes_out_the_hum_and_a_median_the_glitch():
    time = np.arange(5000) / 1000
    hum = np.sin(2 * np.pi * 50 * time)
    assert np.abs(Filter("notch", cutoff=50.0)(time, hum))[1000:4000].max() < 1e-3
    glitch = np.zeros(100)
    glitch[50] = 1.0
    assert Filter("median", window=3)(time[:100], glitch).max() == 0.0


@pytest.mark.parametrize(
    ("text", "k_1", "tau_1"),
    [
        ("lowpass:1Hz", -20.6, 22.2),
        ("lowpass:2Hz", -5.6, 4.9),
        ("lowpass:5Hz", -0.88, 0.67),
        ("lowpass:10Hz", -0.30, 0.21),
    ],
)
def test_the_bias_on_eq_5_is_the_references(ideal: RampHold, text: str, k_1: float, tau_1: float):
    check = check_filter_bias(filter_record(ideal, parse_filter(text)))
    result = dict(
        part.rsplit(" by ", 1)
        for part in check.message.split("hold, ")[1].split(". ")[0].split(", ")
    )
    assert float(result["k_1"].strip(" %")) == pytest.approx(k_1, abs=0.3)
    assert float(result["tau_1"].strip(" %")) == pytest.approx(tau_1, abs=0.35)


def test_filter_bias_check_rejects_slow_and_causal_filters(ideal: RampHold):
    fast = check_filter_bias(filter_record(ideal, parse_filter("lowpass:20Hz")))
    slow = check_filter_bias(filter_record(ideal, parse_filter("lowpass:2Hz")))
    late = check_filter_bias(filter_record(ideal, parse_filter("lowpass:20Hz:causal")))
    assert fast.passed
    assert fast.value is not None
    assert fast.value < 0.003
    assert slow.failed
    assert "The cut-off is below 5/tau_1 = 9.96 Hz" in slow.message
    assert "Fit the raw record." in slow.message_with_remedy
    assert late.failed
    assert "A causal filter delays the force" in late.message


def test_linear_filter_on_both_channels_preserves_the_response(ideal: RampHold, paper_seal):
    behind = filter_record(ideal, parse_filter("lowpass:5Hz"))
    middle = slice(100, -200)
    expected = paper_seal.force(behind.time, behind.displacement)
    np.testing.assert_allclose(behind.force[middle], expected[middle], atol=2e-5)
    assert np.abs(behind.force - ideal.force).max() > 0.02


def test_linear_filter_refuses_uneven_sampling(ideal: RampHold):
    time = np.cumsum(np.random.default_rng(0).uniform(0.001, 0.02, 500))
    with pytest.raises(DataError, match=r"lowpass:5Hz needs even sampling.*or use a median"):
        parse_filter("lowpass:5Hz")(time, time)
    assert len(parse_filter("median:3")(time, time)) == 500


def test_a_cut_off_above_half_the_rate_is_refused(ideal: RampHold):
    with pytest.raises(DataError, match="lies above half the sampling rate, 50 Hz"):
        parse_filter("lowpass:60Hz")(ideal.time, ideal.force)
