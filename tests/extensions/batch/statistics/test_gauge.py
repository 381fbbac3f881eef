"""Gauge studies: the example of AIAG to its last digit, and intervals against chance."""

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.batch.statistics.gauge_rr import gauge
from dashpot.extensions.batch.statistics.variance_components import components

pytestmark = pytest.mark.once

# AIAG, Measurement Systems Analysis, 4th ed., chapter III, gauge repeatability and reproducibility
# data sheet: ten parts (columns), three appraisers, three trials each
TABLE = """ 0.29 -0.56 1.34  0.47 -0.80  0.02  0.59 -0.31 2.26 -1.36
        0.41 -0.68 1.17  0.50 -0.92 -0.11  0.75 -0.20 1.99 -1.25
        0.64 -0.58 1.27  0.64 -0.84 -0.21  0.66 -0.17 2.01 -1.31
        0.08 -0.47 1.19  0.01 -0.56 -0.20  0.47 -0.63 1.80 -1.68
        0.25 -1.22 0.94  1.03 -1.20  0.22  0.55  0.08 2.12 -1.62
        0.07 -0.68 1.34  0.20 -1.28  0.06  0.83 -0.34 2.19 -1.50
        0.04 -1.38 0.88  0.14 -1.46 -0.29  0.02 -0.46 1.77 -1.49
       -0.11 -1.13 1.09  0.20 -1.07 -0.67  0.01 -0.56 1.45 -1.77
       -0.15 -0.96 0.67  0.11 -1.45 -0.49  0.21 -0.49 1.87 -2.16"""
STUDY = np.array(TABLE.split(), dtype=float)
WHO = np.repeat(["A", "B", "C"], 30)
PART = np.tile(np.arange(10).astype(str), 9)


def test_the_study_of_the_manual():
    result = gauge(STUDY, PART, WHO)
    assert (result.parts, result.operators, result.tests, result.omitted_tests) == (10, 3, 90, 0)
    assert result.interaction_p == pytest.approx(0.974, abs=5e-4)  # F = 0.434, so it is pooled
    for name, deviation, share in (
        ("repeatability", 0.199933, 18.4), ("operator", 0.226838, 20.9), ("gauge", 0.302373, 27.9),
        ("part", 1.042327, 96.0),
    ):  # fmt: skip
        item = result[name]
        assert item.deviation == pytest.approx(deviation, abs=2e-6), name
        assert 100 * item.share == pytest.approx(share, abs=0.06), name
        assert item.interval[0] < item.deviation < item.interval[1]
    assert result["total"].deviation == pytest.approx(1.085, abs=5e-4)
    assert int(result.categories) == 4
    assert result.categories == pytest.approx(1.41 * 1.042327 / 0.302373, rel=1e-5)
    # one operator knows his fewest degrees of freedom: two
    assert result["operator"].interval[1] > 5 * result["operator"].deviation


def test_gauge_retains_a_real_interaction():
    rng = np.random.default_rng(2)
    crossed = rng.normal(0, 1.0, 30)[np.repeat(np.arange(30), 3)]
    part, who = np.repeat(np.arange(10), 9).astype(str), np.tile(np.repeat(list("abc"), 3), 10)
    values = crossed + rng.normal(0, 0.1, 90)
    result = gauge(values, part, who)
    assert result.interaction_p < 1e-6
    assert result["interaction"].interval[0] < 1.0 < result["interaction"].interval[1]
    total = result["repeatability"], result["operator"], result["interaction"]
    assert result["gauge"].deviation ** 2 == pytest.approx(sum(item.deviation**2 for item in total))


def test_without_operators_it_is_the_nested_analysis_of_seal_and_repeat():
    values, part = STUDY[:30], PART[:30]
    single = gauge(values, part)
    seal, repeat = components(values, [("seal", list(part))])
    assert single["part"].deviation ** 2 == pytest.approx(seal.variance)
    assert single["repeatability"].deviation ** 2 == pytest.approx(repeat.variance)
    # the mean square of repeats has an exact interval; ours is of 20 000 draws
    ends = [end**0.5 for end in repeat.interval]
    assert single["gauge"].interval == pytest.approx(ends, rel=0.02)
    assert single.operators == 1
    assert single.interaction_p is None
    assert gauge(values, part, ["A"] * 30) == single


@pytest.mark.parametrize(
    ("operators", "sds"), [(1, (0.0, 1.0, 3.0)), (1, (0.0, 1.0, 0.3)), (3, (1.0, 1.0, 3.0))]
)
def test_intervals_hold_the_truth_as_often_as_they_say(operators, sds):
    """Of 25 parts; a fifth of the repeats of a study by one operator is missing."""
    of_operator, of_error, of_part = sds
    truth = np.hypot(of_operator, of_error)
    share, seeds, held = truth / np.hypot(truth, of_part), 150, np.zeros(2)
    part, who = (
        np.repeat(np.arange(25), 6),
        np.tile(np.repeat(np.arange(operators), 6 // operators), 25),
    )
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        values = (
            rng.normal(0, of_part, 25)[part]
            + rng.normal(0, of_operator, operators)[who] * (operators > 1)
            + rng.normal(0, of_error, len(part))
        )
        retained = rng.random(len(part)) > 0.2 if operators == 1 else np.full(len(part), True)
        result = gauge(values[retained], part[retained].astype(str), who[retained].astype(str))
        for i, (low, value, high) in enumerate((
            (result["part"].interval[0], of_part, result["part"].interval[1]),
            (result["gauge"].share_interval[0], share, result["gauge"].share_interval[1]),
        )):  # fmt: skip
            held[i] += low <= value <= high
    assert (held / seeds > 0.95 - 4 * np.sqrt(0.05 * 0.95 / seeds)).all(), held / seeds


def test_a_design_with_holes_is_cut_to_what_is_whole():
    retained = np.full(90, True)
    retained[[0, 10, 20, 31]] = False  # part 0 of A is gone, part 1 of B has two trials
    result = gauge(STUDY[retained], PART[retained], WHO[retained])
    assert (result.parts, result.tests, result.omitted_tests) == (9, 9 * 3 * 2, 86 - 54)


def test_gauge_refuses_designs_without_repeats():
    for values, part, who, words in (
        ([1.0, 2.0], "aa", None, "1 parts with at most 2"),
        ([1.0, 2.0], "ab", None, "2 parts with"),
        ([1.0, 2.0, 3.0, 4.0], "aabb", "xxyy", "0 parts were tested by all 2"),
        ([1.0, 2.0, 3.0, 4.0], "aabb", "xyxy", "tested a part once"),
    ):  # fmt: skip
        with pytest.raises(DataError, match=words):
            gauge(np.array(values), list(part), None if who is None else list(who))


def test_equal_values_are_no_fault():
    result = gauge(np.full(8, 2.0), list("aabbccdd"))
    assert all(variation.deviation == variation.share == 0 for variation in result.variations)
    assert result.categories == 0
