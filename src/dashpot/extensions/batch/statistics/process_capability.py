"""Process capability Cp and Cpk with confidence limits."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError

Ends: TypeAlias = tuple[float, float]
_Index: TypeAlias = tuple[float | None, Ends | None]
_NORMALITY_P_VALUE = 0.05
"""Below it normal values are rare."""
_MAX_EXACT_INDEX = 30.0
"""An index beyond which the mean's scatter is nothing beside the deviation's, and scipy 1.17's
inverse of the noncentral t loses its digits, then does not end."""


@dataclass(frozen=True)
class Capability:
    """Process capability of scattering values between limits.

    Attributes
    ----------
    count : int
        Number of values.
    mean, deviation : float
        Mean of the values, and their standard deviation.
    lower, upper : float or None
        The limits requested.
    cp, cpk : float or None
        None without scatter of the values; ``cp`` also where there is one limit.
    cp_interval, cpk_interval : (float, float) or None
        95 %, of normal values.
    outside : int
        Values beyond a limit.
    outside_interval : (float, float)
        95 %: which share of such seals lies outside, whatever their distribution.
    normal : float or None
        P-value of the test of Shapiro and Wilk; None of fewer than three values, or equal ones.
    """

    count: int
    mean: float
    deviation: float
    lower: float | None
    upper: float | None
    cp: float | None
    cp_interval: Ends | None
    cpk: float | None
    cpk_interval: Ends | None
    outside: int
    outside_interval: Ends
    normal: float | None

    @property
    def cells(self) -> tuple[str, str, str]:
        """Cpk and both ends of its interval; empty if unknown."""
        if self.cpk is None or self.cpk_interval is None:
            return "", "", ""
        return f"{self.cpk:.2f}", f"{self.cpk_interval[0]:.2f}", f"{self.cpk_interval[1]:.2f}"

    @property
    def summary(self) -> str:
        """Cpk with its interval."""
        cpk, low, high = self.cells
        return f"Cpk {cpk} ({low} to {high})"

    @property
    def suspect(self) -> bool:
        """Whether the values are hardly normal, so that Cp and Cpk say little."""
        return self.normal is not None and self.normal < _NORMALITY_P_VALUE


def capability(
    values: FloatArray, lower: float | None, upper: float | None, *, level: float = 0.95
) -> Capability:
    r"""Return Cp and Cpk of values, each with its interval, and the counts outside.

    .. math:: C_p = \frac{U - L}{6s}, \qquad
        C_{pk} = \min\left(\frac{U - \bar x}{3s}, \frac{\bar x - L}{3s}\right)

    with s of all values: what AIAG calls Ppk, and ISO 22514-2 a capability where the values are in
    control. The interval of Cp is that of :math:`\chi^2`. Those of each half of Cpk are exact, of
    the noncentral t distribution (Chou, Owen and Borrego, Journal of Quality Technology 22, 1990).
    Cpk has the lower one of their lower ends, and the lower one of their upper ends, each there
    with half the tail, as either half may be the smaller one: from two values on it holds the truth
    at least as often as it says. The share outside has the interval of Clopper and Pearson.

    Raises
    ------
    DataError
        If there are fewer than two values, or no limit, or the limits are exchanged.
    """
    x = np.asarray(values, dtype=float)
    if len(x) < 2:
        raise DataError(f"capability of {len(x)} value: expected two or more")
    low, high = -math.inf if lower is None else lower, math.inf if upper is None else upper
    if math.isinf(low) and math.isinf(high):
        raise DataError("capability without a limit; give a lower one, an upper one, or both")
    if low >= high:
        raise DataError(f"the lower limit {low:g} is not below the upper one, {high:g}")
    from scipy.stats import shapiro  # few need it, and it costs time to import

    mean, deviation = float(x.mean()), float(x.std(ddof=1))
    is_outside = int(np.count_nonzero((x < low) | (x > high)))
    scatters = deviation > 1e-12 * abs(mean)
    unknown: _Index = (None, None)
    cp, cpk = unknown, unknown
    if scatters:
        cp, cpk = _compute_indices(mean, deviation, low, high, n=len(x), level=level)
    return Capability(
        len(x), mean, deviation, lower, upper, *cp, *cpk,
        is_outside, share_interval(is_outside, len(x), level),
        float(shapiro(x).pvalue) if scatters and len(x) > 2 else None,
    )  # fmt: skip


def _compute_indices(
    mean: float, deviation: float, lower: float, upper: float, *, n: int, level: float
) -> tuple[_Index, _Index]:
    from scipy.stats import chi2

    tail_probability = (1 - level) / 2
    halves = [side / (3 * deviation) for side in (mean - lower, upper - mean)]
    values = [half_width for half_width in halves if math.isfinite(half_width)]
    low = min(_find_true_index(value, n, 1 - tail_probability) for value in values)
    high = min(_find_true_index(value, n, tail_probability / len(values)) for value in values)
    cpk_with_interval = min(values), (low, high)
    if len(values) < len(halves):
        return (None, None), cpk_with_interval
    cp = (upper - lower) / (6 * deviation)
    lower_bound, upper_bound = (
        cp * math.sqrt(float(chi2.ppf(p, n - 1)) / (n - 1))
        for p in (tail_probability, 1 - tail_probability)
    )
    return (cp, (lower_bound, upper_bound)), cpk_with_interval


def _find_true_index(index: float, n: int, tail_probability: float) -> float:
    """Return the true index under which n values give this one, or a smaller one, so rarely."""
    from scipy.special import nctdtrinc
    from scipy.stats import chi2

    if abs(index) > _MAX_EXACT_INDEX:
        share = chi2.isf if index > 0 else chi2.ppf
        return index * math.sqrt(float(share(tail_probability, n - 1)) / (n - 1))
    scale = 3 * math.sqrt(n)
    return float(nctdtrinc(n - 1, tail_probability, scale * index)) / scale


def share_interval(count: int, total: int, level: float = 0.95) -> Ends:
    """Return the exact interval of a share by `count` occurrences."""
    from scipy.stats import beta

    tail_probability = (1 - level) / 2
    low = 0.0 if count == 0 else float(beta.ppf(tail_probability, count, total - count + 1))
    high = (
        1.0 if count == total else float(beta.ppf(1 - tail_probability, count + 1, total - count))
    )
    return low, high
