"""Variance components of a lot, and its outliers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from statistics import NormalDist
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.student_t import t_quantile

Groups: TypeAlias = npt.NDArray[np.int64]

STANDS_OUT = 3.5
"""Robust standard deviations from the median, of many values (Iglewicz and Hoaglin, 1993)."""
_EFFICIENCY = 0.5
"""Degrees of freedom of a median absolute deviation, for each value but one; a little careful."""
NOT_NORMAL = 0.25
"""P-value of the Shapiro-Wilk test below which values count as not normal."""
_MIN_COUNT = 6
"""Smallest number of values for a kurtosis."""
_OF_THREE = 2 / 3
"""Degrees of freedom per value for means of three."""
SHORT_HOLD = 0.95
"""Shortest hold, as a share of the median hold."""
_PER_MAD = 1.482602218505602
"""Standard deviation of a normal distribution over its median absolute deviation."""


@dataclass(frozen=True)
class Component:
    """Variance component.

    Attributes
    ----------
    source : str
        ``"lot"``, ``"seal"``, ``"repeat"`` or ``"fit"``.
    variance : float
        In the square of the quantity's unit; an estimate below 0 is given as 0.
    interval : (float, float) or None
        95 %; None for the fits' own errors, which each fit states.
    freedom : int or None
        Degrees of freedom of its mean square.
    share : float
        Share of the sum of all variances.
    normal : float or None
        p-value of a normal distribution (Shapiro and Wilk 1965); None of fewer than six, of pairs,
        or of the fits' errors. Below ``NOT_NORMAL`` the interval is Bonett's.
    """

    source: str
    variance: float
    interval: tuple[float, float] | None
    freedom: int | None
    share: float = 0.0
    normal: float | None = None

    @property
    def is_corrected_for_kurtosis(self) -> bool:
        """Whether its interval is that for non-normal values."""
        return self.normal is not None and self.normal < NOT_NORMAL


@dataclass(frozen=True)
class _Stratum:
    """Mean square at one level, and in its expectation what this level and those inside count."""

    source: str
    mean_square: float
    dof: int
    variance_coefficients: tuple[float, ...]
    deviations: FloatArray  # of each value from its own mean

    def normal(self) -> float | None:
        """P-value of a test for normality; None if there are too few values."""
        from scipy.stats import shapiro  # few need it, and it costs time to import

        # what is left of pairs is symmetric, whatever they are
        single = self.dof < _OF_THREE * len(self.deviations)
        if single or len(self.deviations) < _MIN_COUNT or not np.ptp(self.deviations) > 0:
            return None
        return float(shapiro(self.deviations).pvalue)

    def limits(self, level: float) -> tuple[float, float]:
        r"""Return both ends of the interval of the mean square, as parts of it.

        Of normal values :math:`n / \chi^2`. Of others, with the kurtosis
        :math:`g = N \sum d^4 / (\sum d^2)^2` about a trimmed mean and :math:`c = N/(N - z)`,

        .. math:: \exp\Bigl(\ln c \pm z c \sqrt{\frac{g - (N - 3)/N}{n}}\Bigr)

        (D. G. Bonett, Comput. Stat. Data Anal. 50 (2006) 775).
        """
        normal = self.normal()
        if normal is None or normal >= NOT_NORMAL:
            from scipy.stats import chi2

            tail_probability = (1 - level) / 2
            upper, lower = (chi2.ppf(p, self.dof) for p in (1 - tail_probability, tail_probability))
            return float(self.dof / upper), float(self.dof / lower)
        d, count = self.deviations, len(self.deviations)
        z = NormalDist().inv_cdf((1 + level) / 2)
        trimmed_count = int(count / (2 * np.sqrt(count - 4)))
        mean_value = float(np.sort(d)[trimmed_count : count - trimmed_count].mean())
        kurtosis = count * float(np.sum((d - mean_value) ** 4)) / float(np.sum(d**2)) ** 2
        c = count / (count - z)
        half_width = z * c * np.sqrt(max(kurtosis - (count - 3) / count, 0.0) / self.dof)
        return float(c * np.exp(-half_width)), float(c * np.exp(half_width))


def components(
    values: FloatArray,
    levels: Sequence[tuple[str, Sequence[str]]],
    *,
    innermost_name: str = "repeat",
    errors: FloatArray | None = None,
    level: float = 0.95,
) -> tuple[Component, ...]:
    r"""Return the components of variance of a nested design, the outermost first.

    The analysis of variance of the nested classification; unbalanced data use the mean squares of
    unweighted means: each lot counts as one, each seal as one of its lot (Burdick and Graybill,
    Confidence Intervals on Variance Components, 1992, chapter 5). The last component, named
    `innermost_name`, is what is left inside the innermost level, less the mean square of the fits'
    own errors, ``"fit"``, if those are given. The innermost interval is that of its mean square, of
    :math:`\chi^2`, or of Bonett where the values are not normal; the others are those of Ting et
    al. (1990) for a difference of mean squares with such limits.

    Parameters
    ----------
    values : array, shape (n,)
    levels : sequence of (str, sequence of str)
        Name of each level and the label of every value in it, outermost first; the same label in
        another group is another specimen.
    innermost_name : str
    errors : array, shape (n,), optional
        Standard errors of the values.
    level : float

    Raises
    ------
    DataError
        If there are no repeats, or only one of a level.
    """
    labels = [np.asarray(words) for _, words in levels]
    groups: list[Groups] = []
    for depth in range(1, len(labels) + 1):
        keys = list(zip(*labels[:depth], strict=True))
        groups.append(np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1))
    names = [name for name, _ in levels]
    strata = _compute_strata(np.asarray(values, dtype=float), groups, [*names, innermost_name])
    components = _solve_variances(strata, level)
    if errors is not None:
        components = [*components[:-1], *_split(components[-1], float(np.mean(np.square(errors))))]
    total = sum(component.variance for component in components)
    return tuple(
        replace(component, share=component.variance / total if total > 0 else 0.0)
        for component in components
    )


def _compute_strata(values: FloatArray, groups: list[Groups], names: list[str]) -> list[_Stratum]:
    """Mean squares of unweighted means: worked out from the innermost, outermost given first."""
    nested = [np.zeros(len(values), dtype=np.int64), *groups, np.arange(len(values))]
    counts = [int(row.max()) + 1 for row in nested]
    means, weights = values, np.ones((1, len(values)))  # each row: what a variance adds to a mean
    stratums: list[_Stratum] = []
    for depth in range(len(nested) - 1, 0, -1):
        freedom = counts[depth] - counts[depth - 1]
        if freedom < 1:
            group_name = names[depth - 1]
            raise DataError(
                f"the scatter of each {group_name} cannot be found: there is no more than one "
                f"{group_name} of each kind; leave that grouping out, or test more"
            )
        parent = np.zeros(counts[depth], dtype=np.int64)
        parent[nested[depth]] = nested[depth - 1]
        size = np.bincount(parent)
        parent_means = np.bincount(parent, means) / size
        deviations = means - parent_means[parent]
        square = float(np.sum(deviations**2)) / freedom
        expects = weights @ (1 - 1 / size)[parent] / freedom
        stratums.insert(0, _Stratum(names[depth - 1], square, freedom, tuple(expects), deviations))
        means = parent_means
        weights = np.array([np.bincount(parent, row) / size**2 for row in weights])
        weights = np.vstack([np.ones(len(parent_means)), weights])
    return stratums


def _solve_variances(strata: list[_Stratum], level: float) -> list[Component]:
    """Solve the expectations from the innermost out."""
    components: list[Component] = []
    estimates: list[float] = []  # of the levels inside, as they came out
    for index in range(len(strata) - 1, -1, -1):
        stratum = strata[index]
        value, *inner_coefficients = stratum.variance_coefficients
        inner_sum = sum(c * v for c, v in zip(inner_coefficients, estimates, strict=True))
        variance = (stratum.mean_square - inner_sum) / value
        if index == len(strata) - 1:
            low, high = stratum.limits(level)
            interval = low * stratum.mean_square, high * stratum.mean_square
        else:
            interval = _compute_difference_limits(
                stratum, strata[index + 1], inner_sum, value, level
            )
        pair = max(variance, 0.0), interval, stratum.dof, 0.0, stratum.normal()
        components.insert(0, Component(stratum.source, *pair))
        estimates.insert(0, variance)
    return components


def _compute_difference_limits(
    outer: _Stratum, inner: _Stratum, inner_sum: float, value: float, level: float
) -> tuple[float, float]:
    """Modified large-sample limits of (outer mean square - below) / own."""
    from scipy.stats import f

    tail_probability, n1, n2 = (1 - level) / 2, outer.dof, inner.dof
    m2 = max(inner_sum, 0.0) / value
    # an estimate below 0 is known no better than one of 0
    m1 = max(outer.mean_square / value, m2)
    (low1, high1), (low2, high2) = outer.limits(level), inner.limits(level)
    g1, h1, g2, h2 = 1 - low1, high1 - 1, 1 - low2, high2 - 1
    high, low = f.ppf(1 - tail_probability, n1, n2), f.ppf(tail_probability, n1, n2)
    g12 = ((high - 1) ** 2 - (g1 * high) ** 2 - h2**2) / high
    h12 = ((1 - low) ** 2 - (h1 * low) ** 2 - g2**2) / low
    lower_square = (g1 * m1) ** 2 + (h2 * m2) ** 2 + g12 * m1 * m2
    upper_square = (h1 * m1) ** 2 + (g2 * m2) ** 2 + h12 * m1 * m2
    middle = m1 - m2
    lower, upper = (
        middle - np.sqrt(max(lower_square, 0.0)),
        middle + np.sqrt(max(upper_square, 0.0)),
    )
    return max(float(lower), 0.0), max(float(upper), 0.0)


def _split(component: Component, fit: float) -> tuple[Component, Component]:
    """Return the variance between repeats less that of their fits, and the latter."""
    assert component.interval is not None  # noqa: S101
    low, high = (max(end - fit, 0.0) for end in component.interval)
    remainder = max(component.variance - fit, 0.0)
    return (
        Component(
            component.source, remainder, (low, high), component.freedom, 0.0, component.normal
        ),
        Component("fit", fit, None, None),
    )


def robust_distance(values: FloatArray) -> FloatArray:
    """Distance of each value from the median in robust standard deviations, 1.4826 MAD.

    Infinite where more than half of the values are one and this is another.
    """
    deviations = np.asarray(values, dtype=float) - np.median(values)
    scale = _PER_MAD * np.median(np.abs(deviations))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(deviations == 0, 0.0, deviations / scale)


def find_outlier_distances(values: FloatArray) -> FloatArray:
    """Return the significant robust distances, and 0 for the others.

    The limit is 3.5 for many values, and for few the quantile of Student's t that is as rare: the
    deviation is then known badly, and 3.5 would accuse one of 20 of five good values.
    """
    distances = robust_distance(values)
    return np.where(np.abs(distances) > _limit(len(distances)), distances, 0.0)


@cache
def _limit(count: int) -> float:
    rare = 1 - 2 * NormalDist().cdf(-STANDS_OUT)
    return t_quantile(rare, _EFFICIENCY * (count - 1))
