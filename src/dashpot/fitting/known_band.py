"""The part of a band in which the loss factor is known, and how well."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

from dashpot.base.arrays import find_true_runs
from dashpot.datamodel.band_error import WELL_KNOWN, BandError

#: lines that are sought between one that is known and one that is not, at most
BETWEEN = 5
#: a band ends where the error is so much of the largest that is known, or within this of ln f
AT_END, PLACED = 0.85, 0.05
Errors: TypeAlias = Callable[[float], tuple[float, float]]


def find_loss_factor_band(
    errors: Errors,
    band: tuple[float, float],
    lines: Mapping[float, tuple[float, float]],
    *,
    around: float | None = None,
) -> tuple[tuple[float, float], BandError]:
    """Return the widest part of a band in which the loss factor is known, and how well.

    With `around` it is the part that holds this line. Where it is known at no line, or not at that
    one, the band stays as it is: the errors show that.

    Parameters
    ----------
    errors : callable
    band : (float, float)
        Hz.
    lines : mapping of float to (float, float)
        Errors at some lines of the band, Hz, increasing; its two ends among them.
    around : float, optional
        One of these lines, Hz.
    """
    at, every = np.array(list(lines)), dict(lines)
    certain = np.array([error[1] for error in lines.values()]) <= WELL_KNOWN
    if certain.all() or not certain.any():
        return band, _band_error(every)
    parts = find_true_runs(certain).tolist()
    if around is not None:
        parts = [part for part in parts if at[part[0]] <= around <= at[part[1]]]
        if not parts:
            return band, _band_error(every)
    first, last = max(parts, key=lambda run: at[run[1]] / at[run[0]])
    ends = []
    for inside, outside in ((first, first - 1), (last, last + 1)):
        end = float(at[inside])
        if 0 <= outside < len(at):
            end = _end(errors, every, end, float(at[outside]))
        ends.append(end)
    low, high = ends
    return (low, high), _band_error({f: e for f, e in every.items() if low <= f <= high})


def _end(
    errors: Errors, every: dict[float, tuple[float, float]], inside: float, outside: float
) -> float:
    """Return the last frequency found from one that is known towards one that is not."""
    for turn in range(BETWEEN):
        near, far = every[inside][1], every[outside][1]
        share = 0.5
        if 0 < near < WELL_KNOWN < far < np.inf:
            share = float(np.log(WELL_KNOWN / near) / np.log(far / near))
        # an error rises ever faster towards the end of a band: a straight line crosses too early
        share = min(max(share, 0.5 if turn else 0.1), 0.98)
        middle = inside * (outside / inside) ** share
        every[middle] = errors(middle)
        if every[middle][1] <= WELL_KNOWN:
            inside = middle
        else:
            outside = middle
        if every[inside][1] > AT_END * WELL_KNOWN or abs(np.log(outside / inside)) < PLACED:
            break
    return inside


def _band_error(errors: Mapping[float, tuple[float, float]]) -> BandError:
    lines = sorted(errors)
    stiffness, loss_factor = zip(*(errors[line] for line in lines), strict=True)
    return BandError(tuple(lines), tuple(stiffness), tuple(loss_factor))
