"""Two lots: Welch's test by a worked example, its power and its equivalence by simulation."""

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.batch.statistics.two_sample import difference

pytestmark = pytest.mark.once


def having(mean, deviation, count):
    shape = np.random.default_rng(count).normal(size=count)
    return mean + deviation * (shape - shape.mean()) / shape.std(ddof=1)


def test_the_example_of_the_handbook():
    # NIST/SEMATECH e-Handbook, 1.3.5.3, AUTO83B.DAT: miles per gallon of 249 and 79 cars, unequal
    # variances: T = -12.94627 with 136.87499 degrees of freedom
    result = difference(having(20.14458, 6.41470, 249), having(30.48101, 6.10771, 79))
    error = np.hypot(6.41470 / 249**0.5, 6.10771 / 79**0.5)
    assert result.value / error == pytest.approx(12.94627, abs=1e-4)
    assert result.freedom == pytest.approx(136.87499, abs=1e-3)
    assert result.p_value == pytest.approx(1.571e-25, rel=1e-3)
    # two-sided 95 % and one-sided 5 % of t with 136.875 degrees of freedom
    assert result.interval == pytest.approx(
        (10.33643 - 1.97751 * error, 10.33643 + 1.97751 * error), abs=1e-4
    )
    assert result.equivalence_margin == pytest.approx(10.33643 + 1.65609 * error, abs=1e-4)
    assert result.different


@pytest.mark.parametrize(("sizes", "sds"), [((5, 5), (1.0, 1.0)), ((25, 8), (1.0, 3.0))])
def test_it_says_how_often_it_finds_what_is_there(sizes, sds):
    """Without a difference 5 % are found, with the detectable one 80 %; the interval holds 95 %."""
    rng, seeds = np.random.default_rng(1), 600
    first, second = (rng.normal(0, sd, (seeds, n)) for sd, n in zip(sds, sizes, strict=True))
    none = [difference(x, y) for x, y in zip(first, second, strict=True)]
    exact = difference(having(0, sds[0], sizes[0]), having(0, sds[1], sizes[1])).detectable
    there = [difference(x, y + exact) for x, y in zip(first, second, strict=True)]
    four = 4 * np.sqrt(1 / seeds)
    assert np.mean([item.different for item in none]) == pytest.approx(0.05, abs=four * 0.22)
    assert np.mean([item.different for item in there]) == pytest.approx(0.8, abs=four * 0.4)
    held = np.mean([item.interval[0] <= exact <= item.interval[1] for item in there])
    assert held == pytest.approx(0.95, abs=four * 0.22)
    # equal within a margin that the truth just passes is said in no more than 5 %
    assert np.mean([item.equivalence_margin < exact for item in there]) < 0.05 + four * 0.22


def test_repeats_for_seals_would_find_what_is_not_there():
    """Why the values are seals: 4 seals of 10 repeats each, no difference of the lots."""
    rng = np.random.default_rng(3)
    seals = rng.normal(0, 1, (300, 2, 4))
    tests = np.repeat(seals, 10, axis=2) + rng.normal(0, 0.1, (300, 2, 40))
    by_seal = np.mean([difference(*seal).different for seal in seals])
    by_test = np.mean([difference(*test).different for test in tests])
    assert by_seal < 0.1
    assert by_test > 0.4


def test_lots_without_scatter_and_lots_too_small():
    assert difference(np.ones(3), np.ones(2)).p_value == 1
    separate = difference(np.ones(3), np.full(3, 2.0))
    assert (separate.p_value, separate.interval, separate.equivalence_margin) == (0, (1, 1), 1)
    with pytest.raises(DataError, match="lots of 5 and 1 seals cannot be compared"):
        difference(np.arange(5.0), np.ones(1))


@pytest.mark.parametrize("questions", [1, 3, 8])
def test_difference_is_significant_where_its_interval_excludes_zero(questions):
    """With step-down p-values they disagreed in one of ten comparisons of eight quantities."""
    rng = np.random.default_rng(5)
    results = 0
    for shift in np.linspace(0.0, 3.0, 200):
        result = difference(rng.normal(0, 1, 6), rng.normal(shift, 1.5, 9), questions=questions)
        low, high = result.interval
        assert result.different == (not low <= 0 <= high)
        results += result.different
    assert 20 < results < 180


def test_the_intervals_of_several_questions_hold_together():
    """95 %: of eight quantities without a difference none is found in 95 % of comparisons."""
    rng, seeds = np.random.default_rng(6), 400
    any_difference = [
        any(
            difference(rng.normal(0, 1, 5), rng.normal(0, 2, 8), questions=8).different
            for _ in range(8)
        )
        for _ in range(seeds)
    ]
    assert np.mean(any_difference) == pytest.approx(0.05, abs=4 * 0.22 / seeds**0.5)
