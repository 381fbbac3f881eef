"""Capability against worked examples, and its intervals against chance."""

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.batch.statistics.process_capability import capability, share_interval

pytestmark = pytest.mark.once


def having(mean, deviation, count):
    """So many values with exactly this mean and standard deviation."""
    shape = np.random.default_rng(count).normal(size=count)
    return mean + deviation * (shape - shape.mean()) / shape.std(ddof=1)


def test_the_indices_are_those_of_the_handbook():
    # NIST/SEMATECH e-Handbook, 6.1.6: limits 8 and 20, mean 16, standard deviation 2
    result = capability(having(16, 2, 50), 8, 20)
    assert result.cp == pytest.approx(1.0)
    assert result.cpk == pytest.approx(0.6667, abs=5e-5)
    assert capability(having(16, 2, 50), 8, None).cpk == pytest.approx(1.3333, abs=5e-5)
    assert capability(having(16, 2, 50), None, 20).cp is None


def test_the_intervals_are_those_of_the_textbooks():
    # Montgomery, Introduction to Statistical Quality Control, 6th ed., example 8.4
    result = capability(having(50, 1.75, 20), 38, 62)
    assert result.cp == pytest.approx(2.29, abs=5e-3)
    assert result.cp_interval == pytest.approx((1.57, 3.01), abs=0.01)
    # its example 8.5, by an approximation: n = 20, C_pk = 1.33, 0.88 to 1.78 (two sides of 2.5 %)
    item = capability(having(0, 1, 20), None, 3 * 1.33)
    assert item.cpk_interval == pytest.approx((0.88, 1.78), abs=0.02)
    # NIST/SEMATECH e-Handbook, 7.2.6.3: of 43 values, by the noncentral t, k_1 = 12.28834/sqrt(43)
    # standard deviations from the mean leave 90 % (1.28155) inside with a confidence of 99 %
    k = 12.28834 / np.sqrt(43)
    low, _ = capability(having(0, 1, 43), None, k, level=0.98).cpk_interval
    assert 3 * low == pytest.approx(1.28155, abs=1e-4)


@pytest.mark.parametrize("size", [2, 5, 25])
@pytest.mark.parametrize("mean", [0.0, 0.3, 3.0, 5.0])
def test_the_interval_of_cpk_holds_the_truth_as_often_as_it_says(size, mean):
    rng = np.random.default_rng(size)
    truth, seeds = (4 - mean) / 3, 400
    rows = rng.normal(mean, 1, (seeds, size))
    ends = np.array([capability(row, -4, 4).cpk_interval for row in rows])
    held = np.mean((ends[:, 0] <= truth) & (truth <= ends[:, 1]))
    assert held > 0.95 - 4 * np.sqrt(0.05 * 0.95 / seeds)
    assert np.mean(truth < ends[:, 0]) < 0.025 + 4 * np.sqrt(0.025 * 0.975 / seeds)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("count", [2, 5, 30])
def test_capability_interval_scales_with_distance_of_limit(count, side):
    near, extra = (
        np.array(capability(having(0.0, 1.0, count), None, side * d).cpk_interval)
        for d in (89.9, 9e5)
    )
    np.testing.assert_allclose(extra, near * 9e5 / 89.9, rtol=6e-4)


def test_what_lies_outside_is_counted_whatever_its_distribution():
    result = capability(np.array([1.0, 2.0, 3.0, 9.0]), 1.0, 8.0)
    assert result.outside == 1  # a limit itself is inside
    # Clopper and Pearson (1934) for 1 of 4
    assert result.outside_interval == pytest.approx((0.0063, 0.8059), abs=5e-5)
    assert share_interval(0, 25) == pytest.approx((0, 1 - 0.025 ** (1 / 25)))
    assert share_interval(25, 25) == pytest.approx((0.025 ** (1 / 25), 1))


def test_values_that_are_not_normal_are_suspect():
    rng = np.random.default_rng(1)
    assert capability(rng.lognormal(0, 1, 50), 0, None).suspect
    assert not capability(rng.normal(size=50), -9, None).suspect
    assert not capability(np.array([1.0, 2.0]), 0, None).suspect


def test_equal_values_have_no_index_and_bad_limits_are_refused():
    result = capability(np.full(5, 0.1), 0.0, 1.0)
    assert (result.cp, result.cpk, result.cpk_interval, result.normal) == (None,) * 4
    assert result.outside == 0
    for values, low, high, words in (
        ([1.0], 0, 2, "of 1 value"), ([1.0, 2.0], None, None, "without a limit"),
        ([1.0, 2.0], 2, 2, "not below"),
    ):  # fmt: skip
        with pytest.raises(DataError, match=words):
            capability(np.array(values), low, high)
