"""Limits: judgement of intervals, number of further tests, expressions and files."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from dashpot.base.errors import DataError, ReadError
from dashpot.base.reported_values import ReportedValue
from dashpot.extensions.acceptance.judgement import (
    POWER_QUANTILE,
    count_additional_tests,
    judge_interval,
)
from dashpot.extensions.acceptance.limit_files import (
    parse_expression,
    read_limits,
    split_expression,
)
from dashpot.extensions.acceptance.result_values import ResultValue


@pytest.mark.parametrize(
    ("lower", "upper", "low", "high", "outcome"),
    [
        (3.0, None, 3.0, 3.2, "met"),
        (3.0, None, 2.99, 3.2, "open"),
        (3.0, None, 2.0, 2.99, "missed"),
        (3.0, None, 2.0, 3.0, "open"),
        (None, 3.0, 2.0, 3.0, "met"),
        (None, 3.0, 3.01, 4.0, "missed"),
        (1.0, 3.0, 1.5, 2.5, "met"),
        (1.0, 3.0, 0.5, 3.5, "open"),
        (1.0, 3.0, 3.5, 4.0, "missed"),
        (1.0, None, math.nan, math.nan, "open"),
        (1.0, None, 2.0, math.inf, "met"),
        (None, 3.0, 2.0, math.inf, "open"),
    ],
)
def test_judge_interval_is_met_missed_or_open(
    lower: float | None, upper: float | None, low: float, high: float, outcome: str
) -> None:
    assert judge_interval(lower, upper, low, high) == outcome


@pytest.mark.parametrize("noise_share", [1.0, 0.9, 0.6])
@pytest.mark.parametrize("distance", [0.3, 0.5, 0.7, 0.9])
@pytest.mark.parametrize("above", [True, False])
def test_further_tests_are_the_first_that_decide(
    noise_share: float, distance: float, above: bool
) -> None:
    """Against a search: the interval of the mean of n tests, noise over root n and rig as it is."""
    value, half = 10.0, 1.0
    limit = value + distance if above else value - distance
    count = count_additional_tests(
        limit, None, value, value - half, value + half, noise_share=noise_share
    )
    noise, rig = half * noise_share, half * math.sqrt(1 - noise_share**2)

    def reach(tests: int) -> float:
        return math.sqrt(noise**2 / tests + rig**2)

    if rig >= distance:
        assert count is None
        return
    expected = next(n for n in range(1, 10_000) if reach(n) <= distance)
    assert count == expected - 1
    assert reach(expected) <= distance < reach(expected - 1)


def test_further_tests_between_two_limits_decide_both():
    to_lower = count_additional_tests(1.0, None, 2.0, 0.0, 4.0)
    to_upper = count_additional_tests(None, 2.5, 2.0, 0.0, 4.0)
    assert (
        count_additional_tests(1.0, 2.5, 2.0, 0.0, 4.0) == max(to_lower or 0, to_upper or 0) == 15
    )


def test_no_number_of_tests_decides_a_value_on_its_limit():
    assert count_additional_tests(3.0, None, 3.0, 2.0, 4.0) is None


def test_the_larger_number_of_tests_decides_nine_times_in_ten():
    """By 4000 simulated means of so many tests of a value that is true."""
    error, distance = 1.0, 0.8
    half = 1.96 * error
    count = count_additional_tests(distance, None, 0.0, -half, half, quantile=POWER_QUANTILE)
    assert count is not None
    tests = count + 1
    means = np.random.default_rng(5).normal(0.0, error / math.sqrt(tests), 4000)
    share = np.mean(means + half / math.sqrt(tests) < distance)
    assert share == pytest.approx(0.9, abs=0.02)


@pytest.mark.parametrize(
    ("text", "name", "limits"),
    [
        ("damping >= 3%", "damping", {"lower": "3%"}),
        ("damping≥3%", "damping", {"lower": "3%"}),
        ("12Hz <= frequency", "frequency", {"lower": "12Hz"}),
        ("14Hz >= frequency >= 12Hz", "frequency", {"lower": "12Hz", "upper": "14Hz"}),
        (
            "0.18N/mm <= stiffness at 40s <= 0.22N/mm",
            "stiffness at 40s",
            {"lower": "0.18N/mm", "upper": "0.22N/mm"},
        ),
    ],
)
def test_split_expression_finds_name_and_limits(
    text: str, name: str, limits: dict[str, str]
) -> None:
    assert split_expression(text) == (name, limits)


@pytest.mark.parametrize(
    "text",
    ["damping => 3%", "damping", ">= 3%", "damping >=", "3 <= 4", "1 <= a <= b",
     "12Hz <= frequency >= 14Hz"],
)  # fmt: skip
def test_split_expression_refuses_what_is_no_limit(text: str) -> None:
    with pytest.raises(DataError):
        split_expression(text)


def _find_damping(name: str) -> ResultValue:
    units = {"damping": ("1", "%"), "frequency": ("Hz", ""), "peak": ("1/kg", "")}
    if name not in units:
        raise DataError(f"{name} is unknown")
    unit, read = units[name]
    return ResultValue(name, ReportedValue(name, 1.0, unit=unit, read=read), "random")


@pytest.mark.parametrize(
    ("text", "lower"),
    [("damping >= 3%", 0.03), ("damping >= 0.03", 0.03), ("frequency >= 0.012kHz", 12.0),
     ("peak >= 200 1/kg", 200.0), ("peak >= 2e2", 200.0)],
)  # fmt: skip
def test_parse_expression_reads_units(text: str, lower: float) -> None:
    assert parse_expression(text, _find_damping).lower == pytest.approx(lower, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("damping >= 3mm", "is no limit of damping"),
        ("peak <= 13Hz", "Is the frequency meant: 'frequency <= 13Hz'"),
        ("frequency >= 12", "no unit"),
        ("frequency >= 12mm", "12mm"),
        ("5Hz <= frequency <= 4Hz", "exchange"),
        ("stiff >= 3", "unknown"),
    ],
)
def test_parse_expression_says_what_is_wrong(text: str, message: str) -> None:
    with pytest.raises(DataError, match=message):
        parse_expression(text, _find_damping)


def test_read_limits_refuses_one_quantity_by_two_names(tmp_path: Path) -> None:
    path = tmp_path / "limits.toml"
    path.write_text('[a]\nlower = "1Hz"\n[b]\nupper = "2Hz"\n')
    with pytest.raises(ReadError, match="twice"):
        read_limits(path, lambda _: _find_damping("frequency"))
    path.write_text('[a]\nlowest = "1Hz"\n')
    with pytest.raises(ReadError, match="lowest"):
        read_limits(path, lambda _: _find_damping("frequency"))
