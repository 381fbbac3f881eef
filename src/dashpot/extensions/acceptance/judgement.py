"""Judgement of an interval against limits, and the number of tests that would decide it."""

from __future__ import annotations

import math
from typing import Literal

from dashpot.base.reported_values import NORMAL

Outcome = Literal["met", "missed", "open"]

POWER = 1.281552
"""Normal quantile of 0.9: the chance of the larger number of tests."""
MOST_TESTS = 1000
"""A larger number of further tests is no advice."""


def judge_interval(lower: float | None, upper: float | None, low: float, high: float) -> Outcome:
    """Return whether an interval keeps to limits: met, missed, or open where it holds a limit.

    A value without uncertainty is an interval without width.

    Parameters
    ----------
    lower, upper : float or None
        The limits; None where there is none.
    low, high : float
        Ends of the interval, in the unit of the limits; nan where none is known.

    Examples
    --------
    >>> judge_interval(3.0, None, 3.1, 3.4), judge_interval(3.0, None, 2.7, 2.9)
    ('met', 'missed')
    >>> judge_interval(None, 3.0, 2.9, 3.1)
    'open'
    """
    least = -math.inf if lower is None else lower
    most = math.inf if upper is None else upper
    if least <= low and high <= most:
        return "met"
    return "missed" if high < least or low > most else "open"


def count_further_tests(
    lower: float | None,
    upper: float | None,
    value: float,
    low: float,
    high: float,
    *,
    quantile: float = 0.0,
) -> int | None:
    r"""Return how many more tests like this one would decide an open limit.

    The mean of n tests has half of the interval's width times :math:`1/\sqrt n`. With the
    half width h of one test towards a limit at the distance d from the value,

    .. math:: n = \left\lceil \left(\frac hd \,\Bigl(1 + \frac{z}{1.96}\Bigr)\right)^2 \right\rceil

    of which one is done. At z = 0 the mean stays where the value is; with z a quantile of the
    normal distribution the mean of so many tests decides with that probability, if the value is
    true.

    Parameters
    ----------
    lower, upper : float or None
    value, low, high : float
        Value and 95 % interval of one test.
    quantile : float
        z.

    Returns
    -------
    int or None
        None where the value lies on a limit, or more than `MOST_TESTS` were needed.

    Examples
    --------
    >>> count_further_tests(3.0, None, 3.5, 2.5, 4.5)
    3
    """
    needed = 1
    for limit in (lower, upper):
        if limit is None or not low < limit < high:
            continue
        half = high - value if limit > value else value - low
        distance = abs(limit - value)
        if not distance > 0:
            return None
        tests = (half / distance * (1 + quantile / NORMAL)) ** 2
        if not tests <= MOST_TESTS:
            return None
        # a share of a test that rounding made is none
        needed = max(needed, math.ceil(tests * (1 - 1e-12)))
    return needed - 1
