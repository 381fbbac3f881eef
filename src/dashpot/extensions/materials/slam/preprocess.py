"""Slams in a record: runs of samples in which the mass is pushed back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, find_true_runs, median
from dashpot.base.errors import DataError
from dashpot.extensions.materials.slam.datamodel import SlamTest

_OTHER, _FOOT = 0.05, 0.15
"""Part of the largest force that makes another slam, and of its own where its flanks are met."""
_CLEAR = 6.0
"""Of the scatter, below which no force is a slam."""
_FEWEST = 12
"""Samples of a slam."""
_AROUND = 0.6
"""How much of the flights is taken to either side, in lengths of the contact."""
_RIGHT = 1e-4
"""Part of the largest force to which a motion is right."""
_SCATTER = 20**0.5
"""Rms of third differences of white noise of 1."""


class RecordedSlam(NamedTuple):
    """Slam of a record.

    Attributes
    ----------
    name : str
    time, force : array, shape (n,)
        Of the samples about it, s from the record's start; N, positive where the mass is pushed
        back, its zero roughly taken off.
    touch, contact : float
        When it roughly begins, and how long it lasts, s.
    noise : float
        Scatter of the force about it from sample to sample, N; no less than a motion is right to.
    rest : float or None
        Since the slam before was over, s.
    ratio : float or None
        Impulse by the force over that by the acceleration, over the mass, where both were
        recorded.
    """

    name: str
    time: FloatArray
    force: FloatArray
    touch: float
    contact: float
    noise: float
    rest: float | None
    ratio: float | None


def slams_of(test: SlamTest, mass: float, name: str) -> list[RecordedSlam]:
    """Return the slams of a record in their order.

    Raises
    ------
    DataError
        If none stands out of the scatter.
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
    slams: list[RecordedSlam] = []
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
        slams.append(
            RecordedSlam(
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
    return slams


def _scatter(push: FloatArray) -> float:
    return float(np.std(np.diff(push, 3))) / _SCATTER


def _push(signal: FloatArray) -> FloatArray:
    """Positive where the mass is pushed back, its rest at zero."""
    tenth = max(len(signal) // 20, 1)
    # a record may be cut so close that most of it is contact
    rest = min((median(signal), median(signal[:tenth]), median(signal[-tenth:])), key=abs)
    sign = 1.0 if signal.max() - rest >= rest - signal.min() else -1.0
    return np.asarray(sign * (signal - rest))


def _contacts(push: FloatArray, level: float, least: float) -> list[tuple[int, int]]:
    """First and last sample of each slam, down to where the force begins."""
    results: list[tuple[int, int]] = []
    for first, last in find_true_runs(push > level).tolist():
        # noise about the level breaks a run in two
        if results and first - results[-1][1] < max(0.2 * (last - results[-1][0]), 3):
            results[-1] = (results[-1][0], last)
        else:
            results.append((first, last))
    long = [result for result in results if result[1] - result[0] + 1 >= _FEWEST]
    return [_to_zero(push, first, last, least) for first, last in long]


def _to_zero(push: FloatArray, first: int, last: int, least: float) -> tuple[int, int]:
    """Return where a push begins and ends, by the slope of its flanks above its foot."""
    level = max(_FOOT * float(push[first : last + 1].max()), least)
    top = first + int(push[first : last + 1].argmax())
    below = np.flatnonzero(push <= level)
    first = int(below[below < top].max(initial=-1)) + 1
    last = int(below[below > top].min(initial=len(push))) - 1
    near = max((last - first) // 12, 2)
    up = max((push[first + near] - push[first]) / near, 1e-300)
    down = max((push[last - near] - push[last]) / near, 1e-300)
    most = (last - first) // 3
    begin = first - min(int(level / up), most)
    end = last + min(int(level / down), most)
    return max(begin, 0), min(end, len(push) - 1)
