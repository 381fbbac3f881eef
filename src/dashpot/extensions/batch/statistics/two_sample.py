"""Two-sample comparison: difference, confidence, and smallest detectable difference."""

from __future__ import annotations

import math

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError

POWER = 0.8
SIGNIFICANCE = 0.05


@dataclass(frozen=True)
class Difference:
    """Difference of the means of two groups of seals, the second less the first.

    Attributes
    ----------
    counts : (int, int)
        Seals of each.
    means, deviations : (float, float)
        Means and standard deviations of the seals.
    value : float
    interval : (float, float)
        95 %, of all questions together: it holds 0 where the test finds no difference.
    p_value : float
        p value of Welch's test that there is no difference, times the number of questions.
    freedom : float
        Degrees of freedom, by Welch and Satterthwaite.
    detectable : float
        The difference that such a test detects with a power of 80 %.
    equivalence_margin : float
        The smallest margin within which two one-sided tests, 5 % each, show the means equal.
    """

    counts: tuple[int, int]
    means: tuple[float, float]
    deviations: tuple[float, float]
    value: float
    interval: tuple[float, float]
    p_value: float
    freedom: float
    detectable: float
    equivalence_margin: float

    @property
    def different(self) -> bool:
        """Whether chance gives such a difference in fewer than 5 % of trials."""
        return self.p_value < SIGNIFICANCE


def difference(first: FloatArray, second: FloatArray, *, questions: int = 1) -> Difference:
    r"""Compare the means of two groups by Welch's t; the values are those of whole seals.

    .. math:: t = \frac{\bar y - \bar x}{\sqrt{s_x^2/n_x + s_y^2/n_y}}

    with the degrees of freedom of Welch and Satterthwaite. A repeat has no information on its lot
    beyond that of its seal: were repeats the values, the interval would be too short. The
    detectable difference follows from the noncentral t distribution with the observed scatter.
    Equivalence is two one-sided tests (Schuirmann, 1987): the ends of the 90 % interval.

    Of several `questions` asked at once each has its part of the 5 % (Bonferroni), in the test as
    in the intervals: with p-values that fall step by step (Holm) an interval could hold 0 beside a
    difference that is found.

    Raises
    ------
    DataError
        If a group has fewer than two values.
    """
    groups = [np.asarray(values, dtype=float) for values in (first, second)]
    if min(map(len, groups)) < 2:
        raise DataError(
            f"lots of {len(groups[0])} and {len(groups[1])} seals cannot be compared: two seals of "
            "each, at least, say how much seals of one lot differ"
        )
    from scipy.stats import t as student

    (m1, m2), (s1, s2) = ([float(f) for f in stat] for stat in zip(
        *((group.mean(), group.std(ddof=1)) for group in groups), strict=True
    ))  # fmt: skip
    n1, n2 = map(len, groups)
    parts = s1**2 / n1, s2**2 / n2
    error = math.sqrt(sum(parts))
    value = m2 - m1
    if error == 0:
        freedom = float(n1 + n2 - 2)
        p_value = 1.0 if value == 0 else 0.0
        return Difference((n1, n2), (m1, m2), (s1, s2), value, (value, value), p_value, freedom,
                          0.0, abs(value))  # fmt: skip
    freedom = error**4 / (parts[0] ** 2 / (n1 - 1) + parts[1] ** 2 / (n2 - 1))
    significance = SIGNIFICANCE / questions
    half_width, inner = (
        float(student.isf(p, freedom)) * error for p in (significance / 2, significance)
    )
    p_value = min(questions * float(2 * student.sf(abs(value) / error, freedom)), 1.0)
    return Difference(
        (n1, n2), (m1, m2), (s1, s2), value, (value - half_width, value + half_width), p_value,
        freedom,
        error * _compute_detectable_shift(freedom, significance), abs(value) + inner,
    )  # fmt: skip


def _compute_detectable_shift(freedom: float, significance: float) -> float:
    """Return the shift, in standard errors, that a two-sided test finds with that power."""
    from scipy.special import nctdtrinc
    from scipy.stats import t as student

    # that the estimate falls beyond the other end is less than 1e-5 here
    return float(nctdtrinc(freedom, 1 - POWER, student.isf(significance / 2, freedom)))
