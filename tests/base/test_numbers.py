"""Printed numbers carry no more digits than their error allows."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.number_format import (
    ascii_only,
    decibels,
    duration,
    format_interval,
    format_typographic,
    interval,
    percent,
    round_to_error,
    shorten_number,
    split_identifier,
    symbol,
    with_error,
)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.1965, 0.00012, "0.19650"),
        (0.1965, 0.012, "0.197"),
        (196.5, 12.0, "196"),
        (19654.0, 1234.0, "19700"),
        (0.0, 0.01, "0.000"),
        (-0.25, 0.012, "−0.250"),
        (12.70975, None, "12.7"),
        (0.00886863, None, "0.00887"),
        (1083.79, None, "1084"),
        (2.5e-7, None, "2.50·10⁻⁷"),
        (0.0, None, "0"),
        (math.inf, None, "∞"),
        (-math.inf, None, "−∞"),
        (math.nan, None, "unknown"),
        (1.5, math.inf, "1.50"),
        (1.5, 0.0, "1.50"),
    ],
)
def test_rounding(value, error, text):
    assert round_to_error(value, error) == text


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1.0))
def test_rounding_never_moves_a_value_by_more_than_a_tenth_of_its_error(value, relative):
    error = relative * value
    raised = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
    shown = float(round_to_error(value, error).replace("·10", "e").translate(raised))
    assert abs(shown - value) <= 0.051 * error + 1e-9 * value


def test_uncertainty_in_words():
    assert with_error(0.1965, 0.00012) == "0.19650 ± 0.00012"
    assert with_error(0.1965, math.inf) == "0.197, not identified"
    assert with_error(0.1965, math.nan) == "0.1965"
    assert with_error(0.1965, 0.0) == "0.197, held"
    assert interval(0.19621, 0.19679) == "0.19621 to 0.19679"
    assert interval(0.0, math.inf) == "above 0"
    assert interval(-math.inf, 2.0) == "below 2.00"
    assert interval(-math.inf, math.inf) == "not bounded"


def test_differences_carry_their_sign():
    assert percent(0.0123) == "+1.2 %"
    assert percent(-0.62) == "−62 %"
    assert percent(0.00001) == "0.00 %"
    assert percent(math.inf) == "unknown"
    assert decibels(14.46) == "+14.5 dB"
    assert decibels(-0.04) == "0.0 dB"
    assert decibels(-3.0) == "−3.0 dB"


def test_times_below_a_second_are_milliseconds():
    assert duration(0.0125) == "12.5 ms"
    assert duration(0.9999) == "1.00 s"
    assert duration(16.4) == "16.4 s"


def test_parameters_are_written_as_printed():
    assert symbol("ln_tau_12") == "ln τ₁₂"
    assert symbol("k_inf") == "k∞"
    assert symbol("b_1") == "b₁"
    assert format_typographic("tau_1 and k_inf, not tau_x nor sk_1; tau = 2 s") == (
        "τ₁ and k∞, not tau_x nor sk_1; τ = 2\N{NO-BREAK SPACE}s"
    )
    assert split_identifier("tau_inside_window") == "τ inside window"
    assert split_identifier("k_inf_positive") == "k∞ positive"


def test_long_numbers_in_steps_are_shortened_and_words_are_not():
    assert shorten_number("1.5264523502809903") == "1.52645"
    assert shorten_number("0.25") == "0.25"
    assert shorten_number("lowpass:10.0000Hz") == "lowpass:10.0000Hz"


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [(-0.25, 0.012, "-0.250"), (2.5e-7, None, "2.50e-7"), (-math.inf, None, "-inf")],
)
def test_terminals_get_the_same_digits_in_their_alphabet(value, error, text):
    printed = ascii_only(round_to_error(value, error))
    assert printed == text
    assert printed.isascii()


@pytest.mark.parametrize(
    ("value", "low", "high", "error", "text"),
    [
        (0.1965, 0.1953, 0.1977, 0.0006, "0.19530 to 0.19770"),
        (1.0, 0.1, 10.0, 0.9, "0.10 to 10.00"),  # a factor of ten either way is known
        (1.0, 0.099, 10.0, 0.9, "below 10.00"),
        (1.0, 0.1, 10.01, 0.9, "above 0.10"),
        (1.0, 0.099, 10.01, 0.9, "not identified"),
        (0.001, 0.0, 7e20, 0.027, "not identified"),
        (16.87, 16.15, math.inf, 0.99, "above 16.15"),
        (0.0, 0.0, 2.0, 1.0, "below 2.0"),
    ],
)
def test_an_interval_that_does_not_hold_the_power_of_ten_is_open(value, low, high, error, text):
    assert format_interval(value, low, high, error) == text


@pytest.mark.parametrize("value", [396.0, 0.1, 3e-4, -12.0, 7.7e5])
@pytest.mark.parametrize("ratio", [0.01, 1.0, 30.0, 1e4])
def test_a_number_that_is_not_zero_is_not_printed_as_zero(value, ratio):
    """However large its error is: an arm of 396 s is none of 0 s."""
    text = round_to_error(value, ratio * abs(value))
    assert float(ascii_only(text)) == pytest.approx(value, rel=0.5)
    assert round_to_error(1e-15, 0.01) == "0.000"
