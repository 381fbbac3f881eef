"""The acquisition card: counts, rate, skew, filter, aliases."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.gauges.transducer import Daq


def test_a_count_is_305_uv():
    # R5: 16 bits over +-10 V
    card = Daq()
    assert card.lsb == pytest.approx(305.176e-6, rel=1e-6)
    read = card.quantise(np.array([0.4 * card.lsb, 0.6 * card.lsb, 11.0, -11.0]))
    assert read.tolist() == [0.0, card.lsb, 10.0 - card.lsb, -10.0]


def test_daq_refuses_a_rate_over_its_capacity():
    # R5: 7 channels at 30 kHz are 210 kS/s, of 200
    with pytest.raises(
        DataError, match=r"7 channels at 30 kHz are 210 kS/s; the card converts 200"
    ):
        Daq(rate=30e3, channels=7)
    assert Daq(rate=200e3 / 7, channels=7).channels == 7
    assert Daq(rate=30e3, channels=6).rate == 30e3


@pytest.mark.parametrize("name", ["bits", "span", "rate", "channels", "fastest"])
def test_an_impossible_card_is_refused(name: str):
    with pytest.raises(DataError, match=f"daq {name} = 0; expected a number > 0"):
        Daq(**{name: 0})
    with pytest.raises(DataError, match="expected a corner in Hz, or 0"):
        Daq(filter=-1.0)


def test_channel_7_is_30_us_late():
    # R5: skew 6 * 5 us
    card = Daq()
    assert card.skew(7) == pytest.approx(30e-6)
    clock = np.arange(16001) / 8000.0
    slope = np.tile(0.5 * clock, (7, 1))  # 0.5 V/s
    read = card.read(clock, slope, np.arange(1000) / 1000.0)
    np.testing.assert_allclose(read[6] - read[0], 0.5 * 30e-6, rtol=1e-9)
    np.testing.assert_allclose(read[0], 0.5 * np.arange(1000) / 1000.0, atol=1e-12)


def test_the_filter_delays_what_is_slow_by_root_2_over_omega():
    card = Daq(filter=100.0)
    clock = np.arange(32001) / 8000.0
    at = np.arange(3000) / 1000.0
    read = card.read(clock, np.array([2.0 + 0.5 * clock]), at)[0]
    # a ramp comes out later by the group delay, once the start is over
    late = (2.0 + 0.5 * at - read)[500:] / 0.5
    np.testing.assert_allclose(late, np.sqrt(2) / (2 * np.pi * 100), rtol=1e-3)
    assert read[0] == pytest.approx(2.0, abs=1e-9)


@pytest.mark.parametrize("corner", [0.0, 30.0])
def test_daq_aliases_a_line_unless_filtered(corner: float):
    # 60 Hz at 100 samples a second: 40 Hz (section 6 of the domain's reference)
    card = Daq(rate=100.0, filter=corner)
    clock = np.arange(40 * 8000) / 8000.0
    read = card.read(clock, np.array([np.sin(2 * np.pi * 60 * clock)]), np.arange(3000) / 100.0)[0]
    line = np.abs(np.fft.rfft(read[1000:])) / 1000
    assert np.argmax(line) / 20 == pytest.approx(card.alias(60.0))
    assert line.max() == pytest.approx(card.filter_gain(60.0), rel=0.02)
    assert card.alias(60.0) == pytest.approx(40.0)
    assert card.alias(50.0) is None
    assert card.alias(50.1) == pytest.approx(49.9)
