"""Where an axis has its numbers, and how they are written."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.numbers import MINUS, SUPERSCRIPTS
from dashpot.plot.picture import Axis

# numbers of a decade, ever more of them
SUBS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8))
# plain numbers are short between these
PLAIN = (1e-4, 1e5)


def place(axis: Axis, values: FloatArray | Sequence[float] | float) -> FloatArray:
    """Where values lie between the limits of an axis, 0 to 1."""
    low, high = axis.limits
    v = np.asarray(values, dtype=float)
    if axis.log:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.log(np.maximum(v, 1e-300) / low) / math.log(high / low))
    return (v - low) / (high - low)


def numbers(axis: Axis, length: float, apart: float) -> tuple[float, ...]:
    """Values that bear a number: as many round ones as stand `apart` px on `length` px."""
    if axis.ticks:
        return axis.ticks
    if not axis.log:
        return _even(axis.limits, max(int(length / apart), 2))
    best: tuple[float, ...] = ()
    for found in (*_decades(axis.limits), _even(axis.limits, max(int(length / apart), 2))):
        if len(found) < 2:
            best = best or found
            continue
        gaps = np.diff(length * place(axis, found))
        if gaps.min() < apart and len(best) >= 2:
            break
        best = found if gaps.min() >= apart else best or found
    return best


def _even(limits: tuple[float, float], most: int) -> tuple[float, ...]:
    low, high = limits
    raw = (high - low) / most
    power = 10.0 ** math.floor(math.log10(raw))
    wider = [m * power for m in (0.5, 1, 2, 2.5, 5, 10)]
    at = next(i for i, step in enumerate(wider) if step >= raw * 0.999)
    found: tuple[float, ...] = ()
    # one number alone says no scale
    for step in wider[at::-1]:
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        found = tuple(i * step for i in range(first, last + 1))
        if len(found) > 1:
            break
    return found


def _decades(limits: tuple[float, float]) -> list[tuple[float, ...]]:
    first, last = (math.floor(math.log10(end)) for end in limits)
    # a very wide axis bears every second decade, every third...
    sets = [((1,), every) for every in (12, 6, 4, 3, 2)] + [(subs, 1) for subs in SUBS]
    return [
        tuple(
            v
            for d in range(first, last + 1)
            if d % every == 0
            for m in subs
            if limits[0] * (1 - 1e-9) <= (v := float(f"{m}e{d}")) <= limits[1] * (1 + 1e-9)
        )
        for subs, every in sets
    ]


def between(axis: Axis) -> tuple[float, ...]:
    """Values of a logarithmic axis with a small tick: the whole numbers of every decade."""
    low, high = axis.limits
    if not axis.log or not 3 < high / low < 1e6:
        return ()
    decades = range(math.floor(math.log10(low)), math.floor(math.log10(high)) + 1)
    return tuple(v for d in decades for m in range(1, 10) if low <= (v := m * 10.0**d) <= high)


def written(axis: Axis, values: Sequence[float]) -> list[str]:
    """Tick values as text: as many decimals as the axis needs, the same for all if it is even."""
    if axis.log:
        plain = all(PLAIN[0] <= v <= PLAIN[1] for v in values)
        return [f"{v:.6g}" if plain else _power(v) for v in values]
    if not values:
        return []
    size = max(abs(v) for v in values)
    if size >= 1e6 or 0 < size < 1e-4:
        return [f"{v:.3g}".replace("-", MINUS) for v in values]
    decimals = next((d for d in range(7) if all(_round(v, d, size) for v in values)), 6)
    return [f"{v + 0.0:.{decimals}f}".replace("-", MINUS) for v in values]


def _round(value: float, decimals: int, size: float) -> bool:
    return abs(value - round(value, decimals)) <= 1e-6 * size


def _power(value: float) -> str:
    power = math.floor(math.log10(value) + 1e-9)
    mantissa = value / 10.0**power
    head = "" if abs(mantissa - 1) < 1e-6 else f"{mantissa:.3g}·"
    return f"{head}10{str(power).translate(SUPERSCRIPTS)}"
