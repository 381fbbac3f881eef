"""Judgement of an interval against limits, and the number of tests that would decide it."""

from __future__ import annotations

import math
from typing import Literal

from dashpot.base.reported_values import NORMAL

Outcome = Literal["met", "missed", "open"]

POWER_QUANTILE = 1.281552
"""Normal quantile of 0.9: the chance of the larger number of tests."""


def judge_interval(lower: float | None, upper: float | None, low: float, high: float) -> Outcome:
    """Return whether an interval keeps to limits: met, missed, or open if it contains a limit.

    A value without uncertainty is an interval without width.

    Parameters
    ----------
    lower, upper : float or None
        The limits; None if there is none.
    low, high : float
        Ends of the interval, in the unit of the limits; nan where none is known.

    Examples
    --------
    >>> judge_interval(3.0, None, 3.1, 3.4), judge_interval(3.0, None, 2.7, 2.9)
    ('met', 'missed')
    >>> judge_interval(None, 3.0, 2.9, 3.1)
    'open'
    """
    lower_limit = -math.inf if lower is None else lower
    upper_limit = math.inf if upper is None else upper
    if lower_limit <= low and high <= upper_limit:
        return "met"
    return "missed" if high < lower_limit or low > upper_limit else "open"


def count_additional_tests(
    lower: float | None,
    upper: float | None,
    value: float,
    low: float,
    high: float,
    *,
    noise_share: float = 1.0,
    quantile: float = 0.0,
) -> int | None:
    r"""Return how many more tests like this one would decide an open limit; None if no number does.

    Of the half width h towards a limit at the distance d from the value, a share q is of noise and
    shrinks by :math:`1/\sqrt n` in the mean of n tests. The part due to the rig, common to all
    tests, does not. The limit is decided from

    .. math:: h^2 (1 - q^2) + \frac{h^2 q^2}{n} \le \left(\frac{d}{1 + z / 1.96}\right)^2

    on, of which n one is done. At z = 0 the mean stays where the value is; with z a quantile of the
    normal distribution the mean of so many tests decides with that probability, if the value is
    true.

    Parameters
    ----------
    lower, upper : float or None
    value, low, high : float
        Value and 95 % interval of one test.
    noise_share : float
        q, the standard error of noise over that of noise and rig, from 0 to 1.
    quantile : float
        z.

    Examples
    --------
    >>> count_additional_tests(3.0, None, 3.5, 2.5, 4.5)
    3
    >>> count_additional_tests(3.0, None, 3.5, 2.5, 4.5, noise_share=0.8)
    """
    tests_needed = 1.0
    for limit in (lower, upper):
        if limit is None or not low < limit < high:
            continue
        half_width = high - value if limit > value else value - low
        allowed_half_width = abs(limit - value) / (1 + quantile / NORMAL)
        noise, rig = half_width * noise_share, half_width * math.sqrt(1 - noise_share**2)
        if not allowed_half_width > rig:
            return None
        tests_needed = max(tests_needed, noise**2 / (allowed_half_width**2 - rig**2))
    # a share of a test that rounding made is none
    return math.ceil(tests_needed * (1 - 1e-12)) - 1 if math.isfinite(tests_needed) else None
