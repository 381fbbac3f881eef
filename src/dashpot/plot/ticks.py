"""Ticks of an axis and their labels."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import MINUS, SUPERSCRIPTS
from dashpot.plot.picture import Scale

# Tick values of a decade, by density.
SUBS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8))
# of a logarithmic axis and of an even one, below which numbers may stand closer
FEW_TICKS, PAIR = 5, 3
# how much so, and if they are short
CLOSE_SPACING, SHORT_NUMBERS, LETTERS = 0.7, (1e-2, 1e4), 4
# plain numbers are short between these
PLAIN = (1e-4, 1e5)


def place(scale: Scale, values: FloatArray | Sequence[float] | float) -> FloatArray:
    """Return where values lie between the limits of an axis, 0 to 1."""
    low, high = scale.limits
    v = np.asarray(values, dtype=float)
    if scale.log:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.log(np.maximum(v, 1e-300) / low) / math.log(high / low))
    return (v - low) / (high - low)


def numbers(scale: Scale, length: float, spacing: float) -> tuple[float, ...]:
    """Return values with a number: as many round ones as stand `spacing` px on `length` px.

    Of an axis that has fewer than three so, a logarithmic one fewer than five, closer ones if they
    are short: two numbers say little of it.
    """
    if scale.ticks:
        return scale.ticks
    values, closer = (
        _numbers(scale, length, value) for value in (spacing, CLOSE_SPACING * spacing)
    )
    if len(closer) <= len(values) or len(values) >= (FEW_TICKS if scale.log else PAIR):
        return values
    if scale.log:
        return (
            closer if SHORT_NUMBERS[0] <= closer[0] and closer[-1] <= SHORT_NUMBERS[1] else values
        )
    return closer if max(map(len, format_ticks(scale, closer))) <= LETTERS else values


def _numbers(scale: Scale, length: float, difference: float) -> tuple[float, ...]:
    if scale.log:
        return _round_ones(scale, length, difference)
    ticks = _even(scale.limits, max(int(length / difference), 2))
    return tuple(value for value in ticks if value == round(value)) if scale.whole else ticks


def _round_ones(scale: Scale, length: float, difference: float) -> tuple[float, ...]:
    best: tuple[float, ...] = ()
    for decade in (*_decades(scale.limits), _even(scale.limits, max(int(length / difference), 2))):
        is_close = len(decade) > 1 and np.diff(length * place(scale, decade)).min() < difference
        if is_close and len(best) > 1:
            break
        # two numbers at least, if need be the outer ones
        best = (decade[0], decade[-1]) if is_close else max(best, decade, key=len)
    return best


def _even(limits: tuple[float, float], max_count: int) -> tuple[float, ...]:
    low, high = limits
    raw = (high - low) / max_count
    power = 10.0 ** math.floor(math.log10(raw))
    candidate_steps = [m * power for m in (0.5, 1, 2, 2.5, 5, 10)]
    at = next(i for i, step in enumerate(candidate_steps) if step >= raw * 0.999)
    values: tuple[float, ...] = ()
    # one number alone says no scale
    for step in candidate_steps[at::-1]:
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        values = tuple(i * step for i in range(first, last + 1))
        if len(values) > 1:
            break
    return values


def _decades(limits: tuple[float, float]) -> list[tuple[float, ...]]:
    first, last = (math.floor(math.log10(end)) for end in limits)
    # a very wide axis bears every second decade, every third...
    sets = [((1,), interval) for interval in (12, 6, 4, 3, 2)] + [(subs, 1) for subs in SUBS]
    return [
        tuple(
            v
            for d in range(first, last + 1)
            if d % interval == 0
            for m in subs
            if limits[0] * (1 - 1e-9) <= (v := float(f"{m}e{d}")) <= limits[1] * (1 + 1e-9)
        )
        for subs, interval in sets
    ]


def compute_minor_ticks(scale: Scale) -> tuple[float, ...]:
    """Return values of a logarithmic axis with a small tick: the whole numbers of every decade."""
    low, high = scale.limits
    if not scale.log or not 3 < high / low < 1e6:
        return ()
    decades = range(math.floor(math.log10(low)), math.floor(math.log10(high)) + 1)
    return tuple(v for d in decades for m in range(1, 10) if low <= (v := m * 10.0**d) <= high)


def format_ticks(scale: Scale, values: Sequence[float]) -> list[str]:
    """Tick values as text: as many decimals as the axis needs, the same for all if it is even."""
    if scale.tick_names:
        return list(scale.tick_names)
    if scale.log:
        use_plain = all(PLAIN[0] <= v <= PLAIN[1] for v in values)
        return [f"{v:.6g}" if use_plain else _power(v) for v in values]
    if not values:
        return []
    size, step = max(abs(v) for v in values), min(np.diff(values), default=1.0)
    if size >= 1e6 or 0 < size < 1e-4:
        digits = 3 + max(0, math.ceil(math.log10(size / step)) - 2)
        return [f"{v:.{digits}g}".replace("-", MINUS) for v in values]
    decimals = next(d for d in range(13) if d == 12 or _round(values, d, step))
    return [f"{v + 0.0:.{decimals}f}".replace("-", MINUS) for v in values]


def _round(values: Sequence[float], decimals: int, step: float) -> bool:
    """Tell whether so many decimals say each value, to a hundredth of the step."""
    return all(abs(v - round(v, decimals)) <= 0.01 * step for v in values)


def _power(value: float) -> str:
    power = math.floor(math.log10(value) + 1e-9)
    mantissa = value / 10.0**power
    header = "" if abs(mantissa - 1) < 1e-6 else f"{mantissa:.3g}·"
    return f"{header}10{str(power).translate(SUPERSCRIPTS)}"
