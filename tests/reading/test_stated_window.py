"""What a header states of an exponential window, in the words of several makers."""

from __future__ import annotations

import math

import pytest

from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.header_metadata import stated_window, window_rate


@pytest.mark.parametrize(
    ("lines", "rate"),
    [
        (["# Exponential window: 0.8 s"], 1.25),
        (["Window: Exponential", "Decay time [ms]: 800"], 1.25),
        (["Exponential window, decay rate [1/s]: 1.25"], 1.25),
        (["Fenster: exponentiell, Zeitkonstante 0,8 s"], 1.25),
        (["Response window: Force/Exponential", "Window time constant: 800 ms"], 1.25),
        (["exp_window_tau [s]: 0.8"], 1.25),
        (["Exponential window, end value: 1 %"], math.log(100) / 4),
        (["Window decay: 2 s", "Averaging: exponential, 10 averages"], 0.5),
    ],
)
def test_a_window_is_read_with_its_unit(lines, rate):
    result = stated_window(lines, record=4.0)
    assert result is not None
    assert result.rate == pytest.approx(rate)


@pytest.mark.parametrize(
    "lines",
    [
        ["Window: Exponential"],
        ["Exponential window: 0.8"],
        ["Exponential window: 0.8 s", "Window time constant: 2 s"],
    ],
)
def test_a_window_without_a_clear_decay_is_stated_all_the_same(lines):
    result = stated_window(lines)
    assert result is not None
    assert result.rate is None
    rate, stated, notes = window_rate(lines, ReadOptions())
    assert (rate, stated) == (None, True)
    assert "exponential window" in notes[0]


@pytest.mark.parametrize(
    "lines",
    [
        [],
        ["Window: Uniform"],
        ["Window: Hanning"],
        ["Averaging: exponential"],
        ["Exponential window: off"],
        ["Exponential window: none"],
        ["Exponential window: 0 s"],
        ["Force window: 20 ms"],
        ["Operator: Exposito, Windowsill rig 3"],
        ["damping: 0.02"],
        ["Temperature: 23 degC"],
    ],
)
def test_other_lines_state_none(lines):
    assert stated_window(lines, record=4.0) is None


def test_what_the_user_says_wins():
    lines = ["Exponential window: 0.8 s"]
    assert window_rate(lines, ReadOptions(window_decay=2.0))[:2] == (0.5, True)
    assert window_rate(lines, ReadOptions(window_decay=0.0))[:2] == (0.0, False)
