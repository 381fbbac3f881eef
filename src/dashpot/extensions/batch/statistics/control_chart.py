"""Control charts: limits from the scatter of the points, and rules for runs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.serialisation import Serialisable

D2 = 1.128
"""Mean range of two normal values, in standard deviations."""
_D4 = 3.267
"""Upper control limit of ranges of two, in mean ranges."""
SIGNIFICANCE_LEVEL = 0.015
"""Part of the points of a chart of what is in control that break a rule all the same: measured, on
charts of 5 to 200 values whose limits are their own."""
MIN_POINTS = 25
"""Points that limits should be of (AIAG, Statistical Process Control, 2nd ed., chapter II)."""
_ROUNDING = 1e-12

Kind = Literal["individuals", "moving range", "mean", "standard deviation"]


class Signal(NamedTuple):
    """Signal of a control chart: index from 0, and the broken rule as text."""

    point: int
    rule: str


@dataclass(frozen=True, eq=False)
class Chart(Serialisable):
    """Control chart: ordered points with their limits.

    Attributes
    ----------
    kind : str
        ``"individuals"``, ``"moving range"``, ``"mean"`` or ``"standard deviation"``.
    values : array, shape (n,)
        nan where a point has none.
    centre : float
    lower, upper : array, shape (n,)
        Control limits, three standard deviations away.
    signals : tuple of Signal
    """

    _keys = ("values", "lower", "upper", "centre", "signals")

    kind: Kind
    values: FloatArray
    centre: float
    lower: FloatArray
    upper: FloatArray
    signals: tuple[Signal, ...]

    @property
    def signalling_points(self) -> tuple[int, ...]:
        """The points that break a rule, each once."""
        return tuple(sorted({signal.point for signal in self.signals}))

    @property
    def causes(self) -> tuple[tuple[int, int], ...]:
        """First and last point of each run of points that break a rule: a cause each."""
        results: list[tuple[int, int]] = []
        for index in self.signalling_points:
            if results and index - results[-1][1] == 1:
                results[-1] = (results[-1][0], index)
            else:
                results.append((index, index))
        return tuple(results)


def compute_chance_limit(points: int) -> float:
    """Return the largest number of points that break a rule by chance.

    Points of one run come together, so their number scatters by the root of twice its mean; three
    of those above it are met by one chart in sixty or fewer.
    """
    return SIGNIFICANCE_LEVEL * points + 3 * math.sqrt(2 * SIGNIFICANCE_LEVEL * points)


def chart_individuals(values: FloatArray) -> tuple[Chart, Chart]:
    r"""Return the chart of individual values in their order, and that of their moving ranges.

    .. math:: \bar x \pm 3\,\overline{MR}/d_2, \qquad 0 \ldots D_4 \overline{MR}

    with the mean moving range of two neighbours. Source: AIAG, Statistical Process Control,
    2nd ed., chapter II.

    Raises
    ------
    DataError
        Of fewer than two values.
    """
    x = np.asarray(values, dtype=float)
    if len(x) < 2:
        raise DataError(f"a control chart of {len(x)} value: expected two or more")
    moving_ranges = np.abs(np.diff(x, prepend=np.nan))
    mean_range = float(np.nanmean(moving_ranges))
    sigma = np.full(len(x), mean_range / D2)
    zero = np.zeros(len(x))
    return (
        _make_chart("individuals", x, float(x.mean()), sigma),
        _make_scatter_chart(
            "moving range", moving_ranges, mean_range, zero, zero + _D4 * mean_range
        ),
    )


def chart_means_and_deviations(groups: Sequence[FloatArray]) -> tuple[Chart, Chart]:
    r"""Return the X-bar chart and the s chart of groups, whose sizes may differ.

    .. math:: \bar{\bar x} \pm 3\hat\sigma/\sqrt{n_i}, \qquad
        \hat\sigma\left(c_4 \pm 3\sqrt{1 - c_4^2}\right)

    With groups of one size :math:`\hat\sigma = \bar s/c_4`, which makes these the limits by A_3,
    B_3 and B_4; else it is the mean of :math:`s_i/c_4` weighted by what each knows (Burr, Journal
    of Quality Technology 1, 1969). A group of one has a mean and no deviation.

    Raises
    ------
    DataError
        If there are fewer than two groups, or none has two values.
    """
    sizes = np.array([len(group) for group in groups])
    if len(groups) < 2 or sizes.max(initial=0) < 2:
        raise DataError("a chart of means wants two groups, of which one has two values or more")
    means = np.array([np.mean(group) for group in groups])
    has_several_values = sizes > 1
    c4 = np.array([_c4(int(n)) if n > 1 else np.nan for n in sizes])
    deviations = np.array([np.std(group, ddof=1) if len(group) > 1 else np.nan for group in groups])
    deviation_factor = np.sqrt(1 - c4**2)
    weights = (c4 / deviation_factor)[has_several_values] ** 2
    sigma = float(np.sum(weights * (deviations / c4)[has_several_values]) / weights.sum())
    centre = float(np.sum(sizes * means) / sizes.sum())
    low = sigma * np.maximum(c4 - 3 * deviation_factor, 0)
    return (
        _make_chart("mean", means, centre, sigma / np.sqrt(sizes)),
        _make_scatter_chart(
            "standard deviation", deviations, float(np.mean((sigma * c4)[has_several_values])),
            low, sigma * (c4 + 3 * deviation_factor),
        ),
    )  # fmt: skip


def _c4(n: int) -> float:
    """Return mean standard deviation of n normal values, in theirs."""
    return math.sqrt(2 / (n - 1)) * math.exp(math.lgamma(n / 2) - math.lgamma((n - 1) / 2))


def _make_chart(kind: Kind, values: FloatArray, centre: float, sigma: FloatArray) -> Chart:
    scatters = sigma > _ROUNDING * abs(centre)
    signals = tuple(run_signals((values - centre) / np.where(scatters, sigma, np.inf)))
    return Chart(kind, values, centre, centre - 3 * sigma, centre + 3 * sigma, signals)


def _make_scatter_chart(
    kind: Kind, values: FloatArray, centre: float, lower: FloatArray, upper: FloatArray
) -> Chart:
    """Return a chart of scatter, which knows no runs: its points are not normal."""
    rounding = _ROUNDING * abs(centre)
    with np.errstate(invalid="ignore"):
        is_outside = (values < lower - rounding) | (values > upper + rounding)
    signals = tuple(Signal(int(i), OUTSIDE_LIMITS) for i in np.flatnonzero(is_outside))
    return Chart(kind, values, centre, lower, upper, signals)


OUTSIDE_LIMITS = "beyond the control limits"
SIDE, TREND, TWO_OF_THREE, FOUR_OF_FIVE = (
    "nine in a row on one side of the mean",
    "six in a row that rise or fall",
    "two of three beyond two standard deviations on one side",
    "four of five beyond one standard deviation on one side",
)


def run_signals(z: FloatArray) -> Iterator[Signal]:
    """Yield where points, in standard deviations from their centre, break a rule.

    Rules 1, 2, 3, 5 and 6 of Nelson, Journal of Quality Technology 16 (1984); a rule speaks at the
    last point of its run. Where the order means nothing, the rules of runs do not either.
    """
    for i, value in enumerate(z):
        if abs(value) > 3:
            yield Signal(i, OUTSIDE_LIMITS)
        # a run that begins before the first point is too short
        if abs(np.sign(z[max(i - 8, 0) : i + 1]).sum()) == 9:
            yield Signal(i, SIDE)
        if abs(np.sign(np.diff(z[max(i - 5, 0) : i + 1])).sum()) == 5:
            yield Signal(i, TREND)
        for rule, window, count, min_distance in (
            (TWO_OF_THREE, 3, 2, 2.0),
            (FOUR_OF_FIVE, 5, 4, 1.0),
        ):
            recent_values = z[i - window + 1 : i + 1] * np.sign(value)
            if (
                i >= window - 1
                and abs(value) > min_distance
                and np.count_nonzero(recent_values > min_distance) >= count
            ):
                yield Signal(i, rule)
