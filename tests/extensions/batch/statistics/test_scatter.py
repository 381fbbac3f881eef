"""Components of variance against a worked example of a textbook, and by their laws."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.batch.statistics.variance_components import (
    components,
    find_outlier_distances,
    robust_distance,
)

pytestmark = pytest.mark.once

# Box, Hunter and Hunter, Statistics for Experimenters (1978), section 17.3: moisture of pigment
# paste, 15 batches, two samples of each, two tests of each sample
PASTE = """
40 39 30 30  26 28 25 26  29 28 14 15  30 31 24 24  19 20 17 17  33 32 26 24  23 24 32 33
34 34 29 29  27 27 31 31  13 16 27 24  25 23 25 27  29 29 31 32  19 20 29 30  23 24 25 25
39 37 26 28
"""
VALUES = np.array(PASTE.split(), dtype=float)
BATCH = [str(i // 4) for i in range(60)]
SAMPLE = [str(i // 2 % 2) for i in range(60)]


def test_the_paste_of_box_hunter_and_hunter():
    """Their table: mean squares 86.5, 58.0, 0.9 with 14, 15, 30; components 7.1, 28.5, 0.9."""
    batch, sample, test = components(VALUES, [("batch", BATCH), ("sample", SAMPLE)])
    assert (batch.freedom, sample.freedom, test.freedom) == (14, 15, 30)
    assert batch.variance == pytest.approx(7.1, abs=0.05)
    assert sample.variance == pytest.approx(28.5, abs=0.05)
    assert test.variance == pytest.approx(0.92, abs=0.005)
    assert 4 * batch.variance + 2 * sample.variance + test.variance == pytest.approx(86.5, abs=0.05)
    assert 2 * sample.variance + test.variance == pytest.approx(58.0, abs=0.05)
    assert batch.share + sample.share + test.share == pytest.approx(1)
    # exact: 30 mean squares over the quantiles 46.98 and 16.79 of chi-square with 30 (any table)
    assert test.interval == pytest.approx((27.5 / 46.979, 27.5 / 16.791), rel=1e-4)
    assert batch.interval[0] == 0 < batch.variance < batch.interval[1]
    assert 0 < sample.interval[0] < sample.variance < sample.interval[1]


@pytest.mark.parametrize(
    ("sizes", "repeats", "sds", "least"),
    [
        ([6] * 8, [4], (2.0, 3.0, 1.0), 0.95),
        ([6] * 8, [4], (0.5, 1.0, 3.0), 0.95),
        # lots of 2 and of 40 seals, tested once or eight times: a level of its own weight each
        ([2, 40, 3, 40], [1, 8], (2.0, 1.0, 0.5), 0.95),
        # no lot differs: more than half of the estimates would be below 0
        ([5, 20, 5, 3], [3, 1], (0.0, 1.0, 1.0), 0.95),
        # an approximation, which small lots of little scatter strain
        ([2, 5, 9, 14, 3, 17], [1, 4, 2, 6], (0.2, 1.0, 1.0), 0.92),
    ],
)
def test_intervals_hold_the_truth_as_often_as_they_say(sizes, repeats, sds, least):
    lots = np.repeat(np.arange(len(sizes)), sizes)
    times = np.resize(repeats, len(lots))
    lot, seal = np.repeat(lots, times), np.repeat(np.arange(len(lots)), times)
    held, seeds = np.zeros(3), 400
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        values = (
            rng.normal(0, sds[0], len(sizes))[lot]
            + rng.normal(0, sds[1], len(lots))[seal]
            + rng.normal(0, sds[2], len(lot))
        )
        result = components(values, [("lot", lot.astype(str)), ("seal", seal.astype(str))])
        assert all(item.variance >= 0 for item in result)
        held += [c.interval[0] <= sd**2 <= c.interval[1] for c, sd in zip(result, sds, strict=True)]
    # within four standard deviations of such a count
    assert (held / seeds > least - 4 * np.sqrt(0.05 * 0.95 / seeds)).all(), held / seeds


DRAWS = {
    "normal": (lambda rng, n: rng.normal(size=n), 1.0),
    "lognormal": (
        lambda rng, n: np.exp(0.5 * rng.normal(size=n)), np.expm1(0.25) * np.exp(0.25)
    ),
    "t of 5": (lambda rng, n: rng.standard_t(5, n), 5 / 3),
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "least"), [("lognormal", 0.86), ("normal", 0.93), ("t of 5", 0.88)]
)
def test_seals_that_are_not_normal_have_a_wider_interval(name, least):
    """Of 15 seals in one lot that of chi-square holds .81 and .86, this one .89 and .92."""
    draw, truth = DRAWS[name]
    rng, held, normal, seeds = np.random.default_rng(7), 0, 0, 300
    for _ in range(seeds):
        values = np.concatenate((draw(rng, 8), draw(rng, 8)))
        _, seal = components(values, [("lot", ["a"] * 8 + ["b"] * 8)], innermost_name="seal")
        held += seal.interval[0] <= truth <= seal.interval[1]
        normal += not seal.is_corrected_for_kurtosis
    assert held / seeds > least - 2 * np.sqrt(least * (1 - least) / seeds), held / seeds
    # what is normal is mostly taken for it, what is skewed is not
    assert normal / seeds > 0.6 or name != "normal"
    assert normal / seeds < 0.5 or name != "lognormal"


def test_an_interval_of_bonett():
    """Worked by hand of its formula: ten values, one of them far."""
    values = np.array([1.0, 1.1, 0.9, 1.05, 0.95, 1.02, 0.98, 1.0, 1.01, 3.0])
    _, seal = components(
        np.concatenate((values, values)), [("lot", ["a"] * 10 + ["b"] * 10)], innermost_name="seal"
    )
    d, N, n, z = values - values.mean(), 20, 18, 1.959964
    d = np.sort(np.concatenate((d, d)))
    m = d[2:-2].mean()  # 20/(2 sqrt 16) = 2.5 values of either end
    g = N * np.sum((d - m) ** 4) / np.sum(d**2) ** 2
    c = N / (N - z)
    wide = z * c * np.sqrt((g - 17 / 20) / n)
    square = np.sum(d**2) / n
    assert seal.is_corrected_for_kurtosis
    assert seal.interval == pytest.approx(
        (c * square * np.exp(-wide), c * square * np.exp(wide)), rel=1e-5
    )


def test_an_unbalanced_design_is_unbiased():
    lot = np.repeat(np.arange(6), [2, 5, 9, 14, 3, 17])
    seal = np.arange(50) // 2
    rng = np.random.default_rng(1)
    total = np.zeros(3)
    for _ in range(600):
        values = rng.normal(0, 2, 6)[lot] + rng.normal(0, 1, 25)[seal] + rng.normal(0, 0.5, 50)
        # no estimate is cut at 0 here but the lots', which are large
        result = components(values, [("lot", lot.astype(str)), ("seal", seal.astype(str))])
        total += [item.variance for item in result]
    assert total / 600 == pytest.approx([4, 1, 0.25], rel=0.1)


def test_the_errors_of_the_fits_come_off_the_repeats():
    levels = [("batch", BATCH), ("sample", SAMPLE)]
    whole = components(VALUES, levels)
    *outer, repeat, fit = components(VALUES, levels, errors=np.full(60, 0.5))
    assert [item.variance for item in outer] == [item.variance for item in whole[:2]]
    assert fit.variance == pytest.approx(0.25)
    assert repeat.variance == pytest.approx(whole[2].variance - 0.25)
    *_, none, fit = components(VALUES, levels, errors=np.full(60, 5.0))
    assert (none.variance, none.interval[0]) == (0, 0)


def test_variance_components_refuse_levels_without_repeats():
    with pytest.raises(DataError, match="scatter of each repeat"):
        components(np.arange(4.0), [("seal", list("abcd"))])
    with pytest.raises(DataError, match="scatter of each lot"):
        components(np.arange(4.0), [("lot", list("aaaa")), ("seal", list("aabb"))])


def test_the_labels_of_seals_begin_again_in_each_lot():
    values = np.arange(8.0)
    again = components(values, [("lot", list("aaaabbbb")), ("seal", list("11221122"))])
    separate = components(values, [("lot", list("aaaabbbb")), ("seal", list("11223344"))])
    assert again == separate


def test_what_stands_out_is_counted_in_robust_deviations():
    rng = np.random.default_rng(2)
    values = rng.normal(10, 1, 100_001)
    assert robust_distance(values).std() == pytest.approx(1, rel=0.02)
    assert robust_distance(np.array([1.0, 1.0, 1.0, 2.0])).tolist() == [0, 0, 0, np.inf]


@pytest.mark.parametrize(("size", "below", "above"), [(10, 9.0, 9.2), (1001, 3.51, 3.54)])
def test_the_limit_is_3_5_in_a_large_lot_and_wider_in_a_small_one(size, below, above):
    """Quantiles of t at 2.33e-4 a side with 4.5 and 500 degrees of freedom."""
    for far, out in ((below, False), (above, True)):
        # all but one lie evenly from -1 to 1 about the median, so that the scale is theirs
        values = np.linspace(-1, 1, size)
        scale = 1.482602218505602 * np.median(np.abs(values - np.median(values)))
        values[-1] = np.median(values) + far * scale
        assert bool(find_outlier_distances(values)[-1]) is out


@pytest.mark.parametrize("size", [5, 8, 20, 100])
def test_outlier_rule_has_a_false_alarm_rate_of_one_in_a_thousand(size):
    rng = np.random.default_rng(size)
    lots = rng.normal(size=(40_000 // size, size))
    assert (
        sum(np.count_nonzero(find_outlier_distances(lot)) for lot in lots) <= 55
    )  # 40 and 2.4 sd of it
