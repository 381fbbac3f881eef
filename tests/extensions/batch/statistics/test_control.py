"""Control charts against worked examples of textbooks, and each rule where it begins to speak."""

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.batch.statistics.control_chart import (
    FOUR_OF_FIVE,
    OUTSIDE_LIMITS,
    SIDE,
    TREND,
    TWO_OF_THREE,
    chart_individuals,
    chart_means_and_deviations,
    run_signals,
)

pytestmark = pytest.mark.once

# Montgomery, Introduction to Statistical Quality Control, 6th ed., table 6.3: inside diameters of
# piston rings, 25 samples of five, thousandths of a millimetre above 73.9
TABLE = """130 102 119  92 108   95  92 101 111 104   88 124 121 105 102  102  96  93 115 109
        92 107 115  89 114  109  94  97  85  93   95 106  94 100 105   85 103  93 115  88
       108  95 109 105 104   98 100  90 107  95   94  98  94  95  90  104 100 107 100  96
        83 102  98  97 112  106  67  94 100  84  112 114  98  99 107  100  84 105  98  96
        94 112  86 105 107  106 110 118 103 100   84 102 103 105  97  100 110 113 120 103
        82 101 115 105  96  104  99  90 106 109  110  89  90 109 114  115 108  93 100 110
        82  84  95 117 113"""
RINGS = np.array(TABLE.split(), dtype=float).reshape(25, 5)  # fmt: skip


def test_individuals_are_those_of_the_worked_example():
    # NIST/SEMATECH e-Handbook of Statistical Methods, 6.3.2.2: a flow rate, ten samples
    flow = np.array([49.6, 47.6, 49.9, 51.3, 47.8, 51.2, 52.6, 52.4, 53.6, 52.1])
    text, moving = chart_individuals(flow)
    assert text.centre == pytest.approx(50.81)
    assert (text.lower[0], text.upper[-1]) == pytest.approx((45.8159, 55.8041), abs=6e-5)
    assert moving.centre == pytest.approx(1.8778, abs=5e-5)
    assert moving.upper[0] == pytest.approx(3.267 * 1.8778, abs=5e-4)
    assert np.isnan(moving.values[0])
    assert not text.signals
    assert not moving.signals
    with pytest.raises(DataError, match="of 1 value"):
        chart_individuals(flow[:1])


def test_means_and_deviations_are_those_of_the_worked_example():
    """Its example 6.3: 74.001 and 0.0094; limits 73.988 to 74.014, and 0 to 0.0196."""
    mean, deviation = chart_means_and_deviations(list(73.9 + 1e-3 * RINGS))
    assert mean.centre == pytest.approx(74.001, abs=5e-4)
    assert (mean.lower[0], mean.upper[0]) == pytest.approx((73.988, 74.014), abs=6e-4)
    assert deviation.centre == pytest.approx(0.0094, abs=5e-5)
    assert (deviation.lower[0], deviation.upper[0]) == pytest.approx((0, 0.0196), abs=1e-4)
    assert not mean.signals
    assert not deviation.signals


def test_factors_are_those_of_the_tables():
    """A_3, B_3, B_4 of Montgomery's appendix VI."""
    for n, a3, b3, b4 in ((2, 2.659, 0, 3.267), (4, 1.628, 0, 2.266), (10, 0.975, 0.284, 1.716)):
        rows = np.random.default_rng(n).normal(size=(3, n))
        mean, deviation = chart_means_and_deviations(list(rows))
        s = rows.std(axis=1, ddof=1).mean()
        assert mean.upper[0] - mean.centre == pytest.approx(a3 * s, rel=6e-4)
        assert deviation.lower[0] == pytest.approx(b3 * s, abs=6e-4 * s)
        assert deviation.upper[0] == pytest.approx(b4 * s, rel=6e-4)


def test_control_limits_of_unequal_groups_share_one_scatter():
    rng = np.random.default_rng(3)
    sizes = rng.integers(1, 8, 4000)
    mean, deviation = chart_means_and_deviations([rng.normal(5, 2, n) for n in sizes])
    assert (mean.upper - mean.centre) * np.sqrt(sizes) == pytest.approx(6, rel=0.02)
    assert np.isnan(deviation.values[sizes == 1]).all()
    single = {signal.point for signal in deviation.signals} & set(np.flatnonzero(sizes == 1))
    assert not single
    for groups in ([[1.0, 2.0]], [[1.0], [2.0]]):
        with pytest.raises(DataError, match="wants two groups"):
            chart_means_and_deviations([np.array(group) for group in groups])


@pytest.mark.parametrize(
    ("rule", "breaks", "keeps"),
    [
        (OUTSIDE_LIMITS, [3.01], [2.99]),
        (OUTSIDE_LIMITS, [-3.01], [-3.0]),
        (SIDE, [0.1] * 9, [0.1] * 8),
        (SIDE, [-0.1] * 9, [-0.1] * 8 + [0.1]),
        (TREND, [-1.5, -0.5, -0.2, 0.3, 0.5, 0.9], [-0.5, -0.2, 0.3, 0.5, 0.9]),
        (TREND, [0.9, 0.5, 0.3, -0.2, -0.5, -0.9], [0.9, 0.5, 0.3, -0.2, -0.5, -0.5]),
        (TWO_OF_THREE, [2.1, 0.0, 2.1], [2.1, 0.0, -2.1]),
        (TWO_OF_THREE, [0.0, -2.1, -2.1], [2.1, 0.0, 0.0, 2.1]),
        (FOUR_OF_FIVE, [1.1, 1.2, 0.0, 1.1, 1.3], [1.1, 1.2, 0.0, 0.9, 1.3]),
        (FOUR_OF_FIVE, [0.0, -1.1, -1.2, -1.3, -1.1], [1.1, 1.2, 1.3, 0.0, 0.0, 1.1]),
    ],
)
def test_each_rule_speaks_at_the_last_point_of_its_run(rule, breaks, keeps):
    assert (len(breaks) - 1, rule) in run_signals(np.array(breaks))
    assert rule not in [signal.rule for signal in run_signals(np.array(keeps))]


def test_control_chart_of_equal_values_signals_nothing():
    for chart in (
        *chart_individuals(np.full(12, 0.1)),
        *chart_means_and_deviations([np.full(3, 0.1)] * 9),
    ):
        assert not chart.signals


def test_a_lot_in_control_is_seldom_accused():
    """Three standard deviations are passed by 0.27 %; from 25 estimated limits a little more."""
    rng = np.random.default_rng(4)
    rules = [
        signal.rule
        for _ in range(400)
        for signal in chart_individuals(rng.normal(size=25))[0].signals
    ]
    assert 0.002 < rules.count(OUTSIDE_LIMITS) / 1e4 < 0.008
    assert len(rules) / 400 < 0.5  # false alarms of all five rules, for each lot of 25 seals
