"""Impacts in a record: runs of samples in which the mass is pushed back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, find_true_runs, median
from dashpot.base.errors import DataError
from dashpot.extensions.materials.drop.datamodel import DropTest

_OTHER, _FOOT = 0.05, 0.15
"""Parts of the largest force: of another impact, and of the foot of its own flanks."""
_CLEAR = 6.0
"""Times the noise, below which no force is an impact."""
_FEWEST = 12
"""Least number of samples of an impact."""
_AROUND = 0.6
"""Part of the flight used on either side, in lengths of the contact."""
_RIGHT = 1e-4
"""Accuracy of a computed motion, over the largest force."""
_SCATTER = 20**0.5
"""Rms of third differences of unit white noise."""


class RecordedImpact(NamedTuple):
    """One impact of a record.

    Attributes
    ----------
    name : str
    time, force : array, shape (n,)
        Of the samples around it, s from the start of the record; N, positive where the mass is
        pushed back, without the estimated zero.
    touch, contact : float
        Estimated first contact and length of contact, s.
    noise : float
        Noise of the force, N, at least the accuracy of a computed motion.
    rest : float or None
        Time since the end of the impact before, s.
    ratio : float or None
        Impulse of the force over mass times that of the acceleration, where both were recorded.
    """

    name: str
    time: FloatArray
    force: FloatArray
    touch: float
    contact: float
    noise: float
    rest: float | None
    ratio: float | None


def find_impacts(test: DropTest, mass: float, name: str) -> list[RecordedImpact]:
    """Return the impacts of a record in their order.

    Raises
    ------
    DataError
        If none stands out of the noise.
    """
    time, signal = test.time, test.force
    if signal is None:
        assert test.acceleration is not None  # noqa: S101
        signal = mass * test.acceleration
    push = _push(signal)
    noise = _scatter(push)
    top = float(push.max())
    if not top > 2 * _CLEAR * noise:
        raise DataError(
            f"{name}: no impact stands out of the scatter: the largest force is {top:.3g} N, the "
            f"scatter {noise:.3g} N. Cut the record about the impacts, or use a stiffer sensor"
        )
    impacts: list[RecordedImpact] = []
    over = _contacts(push, max(_OTHER * top, _CLEAR * noise), _CLEAR * noise)
    if not over:
        raise DataError(f"{name}: the longest push has fewer than {_FEWEST} samples. Sample faster")
    other = None if test.force is None or test.acceleration is None else _push(test.acceleration)
    for number, (first, last) in enumerate(over):
        wide = last - first + 1
        reach = int(_AROUND * wide)
        low = max(first - reach, (over[number - 1][1] + first) // 2 if number else 0)
        high = len(push) - 1
        if number + 1 < len(over):
            high = min(high, (last + over[number + 1][0]) // 2)
        rows = slice(low, min(last + reach, high) + 1)
        inside = slice(first, last + 1)
        impacts.append(
            RecordedImpact(
                f"{name}, impact {number + 1}" if len(over) > 1 else name,
                time[rows],
                push[rows],
                float(time[first]),
                wide * test.step,
                max(_scatter(push[rows]), _RIGHT * top),
                float(time[first] - time[over[number - 1][1]]) if number else None,
                None if other is None else float(push[inside].sum() / (mass * other[inside].sum())),
            )
        )
    return impacts


def _scatter(push: FloatArray) -> float:
    return float(np.std(np.diff(push, 3))) / _SCATTER


def _push(signal: FloatArray) -> FloatArray:
    """Return the signal without its zero, positive where the mass is pushed back."""
    tenth = max(len(signal) // 20, 1)
    # a record may be cut so close that most of it is contact
    rest = min((median(signal), median(signal[:tenth]), median(signal[-tenth:])), key=abs)
    sign = 1.0 if signal.max() - rest >= rest - signal.min() else -1.0
    return np.asarray(sign * (signal - rest))


def _contacts(push: FloatArray, threshold: float, least: float) -> list[tuple[int, int]]:
    """Return the first and last sample of each impact, from zero force to zero force."""
    results: list[tuple[int, int]] = []
    for first, last in find_true_runs(push > threshold).tolist():
        # noise about the threshold breaks a run in two
        if results and first - results[-1][1] < max(0.2 * (last - results[-1][0]), 3):
            results[-1] = (results[-1][0], last)
        else:
            results.append((first, last))
    long = [result for result in results if result[1] - result[0] + 1 >= _FEWEST]
    return [_to_zero(push, first, last, least) for first, last in long]


def _to_zero(push: FloatArray, first: int, last: int, least: float) -> tuple[int, int]:
    """Return first and last sample of a push, by the slope of its flanks above the foot."""
    foot = max(_FOOT * float(push[first : last + 1].max()), least)
    top = first + int(push[first : last + 1].argmax())
    below = np.flatnonzero(push <= foot)
    first = int(below[below < top].max(initial=-1)) + 1
    last = int(below[below > top].min(initial=len(push))) - 1
    near = max((last - first) // 12, 2)
    up = max((push[first + near] - push[first]) / near, 1e-300)
    down = max((push[last - near] - push[last]) / near, 1e-300)
    most = (last - first) // 3
    begin = first - min(int(foot / up), most)
    end = last + min(int(foot / down), most)
    return max(begin, 0), min(end, len(push) - 1)
