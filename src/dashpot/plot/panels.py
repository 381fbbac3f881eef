"""Arrays to Axes: one panel each, knowing no result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray, IndexArray
from dashpot.plot.style import GREY, PALE, SKY, YELLOW, Pen, right_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def line(ax: Axes, x: FloatArray, y: FloatArray, pen: Pen, label: str = "", **more: object) -> None:
    """A curve in that pen, with `more` that matplotlib knows of a line."""
    style: dict[str, Any] = {"color": pen.color, "linestyle": pen.dashes, "linewidth": pen.width}
    ax.plot(x, y, label=label or None, **style | more)


def shade(
    ax: Axes, low: float, high: float, *, color: str = SKY, alpha: float = 0.2, label: str = ""
) -> None:
    """A background for a range of the horizontal axis, such as what a test can inform."""
    ax.axvspan(low, high, color=color, alpha=alpha, linewidth=0, zorder=0, label=label or None)


# -- against time ---------------------------------------------------------------------------------


def trace(
    ax: Axes,
    time: FloatArray,
    values: FloatArray,
    pen: Pen,
    *,
    log: bool = False,
    bins: int = 500,
    label: str = "",
    **more: object,
) -> None:
    """One record against time, every excursion kept; with `log`, times must count from an event."""
    x, y = extremes(time, values, bins=bins, log=log)
    line(ax, x, y, pen, label, **more)


def segments(ax: Axes, bounds: tuple[float, float, float], *, before: float | None = None) -> None:
    """Shade the ramp and the hold between the three instants, and the baseline from `before`."""
    onset, ramp_end, hold_end = bounds
    if before is not None:
        shade(ax, before, onset, color=PALE, alpha=0.45)
    shade(ax, onset, ramp_end, color=YELLOW, alpha=0.22)
    shade(ax, ramp_end, hold_end, alpha=0.13)


def outer_limits(*arrays: FloatArray, margin: float = 0.06) -> tuple[float, float]:
    """Limits that hold every array with a margin."""
    low = min(float(np.min(a)) for a in arrays)
    high = max(float(np.max(a)) for a in arrays)
    pad = margin * ((high - low) or abs(high) or 1.0)
    return low - pad, high + pad


# -- against frequency ----------------------------------------------------------------------------


def band(ax: Axes, frequency: FloatArray, value: ComplexArray, sd: FloatArray, pen: Pen) -> None:
    """Two standard deviations on either side of the magnitude."""
    size = np.abs(value)
    # a magnitude has no negative side: the band is cut well below the curve
    low, high = np.maximum(size - 2 * sd, 0.02 * size), size + 2 * sd
    ax.fill_between(frequency, low, high, color=pen.color, alpha=0.18, linewidth=0)


def phase(
    ax: Axes,
    frequency: FloatArray,
    value: ComplexArray,
    pen: Pen,
    *,
    lowest: float = -180.0,
    sd: FloatArray | None = None,
) -> None:
    """Phase in degrees from `lowest` up to a full turn more, the line broken where it wraps."""
    degrees = turned(value, lowest)
    breaks = np.flatnonzero(np.abs(np.diff(degrees)) > 180) + 1
    x = np.insert(frequency, breaks, np.nan)
    y = np.insert(degrees, breaks, np.nan)
    if sd is not None:
        half = np.degrees(np.arcsin(np.minimum(2 * sd / np.abs(value), 1.0)))
        half = np.insert(half, breaks, np.nan)
        ax.fill_between(x, y - half, y + half, color=pen.color, alpha=0.18, linewidth=0)
    line(ax, x, y, pen)


def turned(value: ComplexArray, lowest: float) -> FloatArray:
    """Phase in degrees within one turn from `lowest`."""
    return np.asarray((np.degrees(np.angle(value)) - lowest) % 360 + lowest)


def phase_axis(ax: Axes, values: ComplexArray) -> float:
    """Choose where the turn begins for all `values`, set the axis, and return it, degrees.

    From -180 as usual; from -90 where that would cut through the data, as the noise of an
    accelerance below its resonance does.
    """
    usual = turned(values, -180.0)
    lowest = -90.0 if bool(np.mean(np.abs(usual) > 165) > 0.02) else -180.0
    degrees = turned(values, lowest)
    first = 90 * np.floor((np.percentile(degrees, 1) + 20) / 90)
    last = 90 * np.ceil((np.percentile(degrees, 99) - 20) / 90)
    ax.set_yticks(np.arange(first, max(last, first + 90) + 1, 90))
    ax.set_ylim(first - 15, max(last, first + 90) + 15)
    return lowest


def decibels(ax: Axes, reference: str) -> None:
    """The same magnitudes in dB on the right-hand side: ticks on the same log axis."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    low, high = 20 * np.log10(ax.get_ylim())
    step = 20 if high - low > 50 else 10 if high - low > 22 else 5
    levels = np.arange(step * np.ceil(low / step), high, step)
    right = right_axis(ax, f"dB re {reference}", lambda y: y, lambda y: y)
    right.yaxis.set_major_locator(FixedLocator(list(10 ** (levels / 20))))
    right.yaxis.set_minor_locator(NullLocator())
    right.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{20 * np.log10(y):.0f}"))


def coherence(ax: Axes, frequency: FloatArray, value: FloatArray, pen: Pen) -> None:
    """Coherence from 0 to 1, with the 0.9 that ISO 7626-5 asks for."""
    ax.axhline(0.9, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)))
    line(ax, frequency, value, pen)
    ax.set_ylim(0, 1.08)
    ax.set_yticks([0, 0.5, 1])


def known_and_extrapolated(
    ax: Axes,
    frequency: FloatArray,
    value: FloatArray,
    pen: Pen,
    *,
    known: tuple[float, float],
    label: str = "",
) -> None:
    """A curve, solid inside the `known` band of frequencies and dashed outside it."""
    inside = (frequency >= known[0]) & (frequency <= known[1])
    solid = np.where(inside, value, np.nan)
    ax.plot(frequency, solid, color=pen.color, linestyle="-", linewidth=pen.width + 0.4,
            label=label or None, solid_capstyle="butt")  # fmt: skip
    # the dashes reach the solid part: less its first and last line
    deep = inside & np.roll(inside, 1) & np.roll(inside, -1)
    outside = np.where(deep, np.nan, value)
    ax.plot(frequency, outside, color=pen.color, linestyle=(0, (3.5, 1.8)), linewidth=pen.width)


def limits(
    ax: Axes, frequency: FloatArray, band: FloatArray, color: str, *, label: str, alpha: float
) -> None:
    """The area between two limits, edges drawn so that a narrow band is still seen."""
    ax.fill_between(
        frequency, band[0], band[1], color=color, alpha=alpha, linewidth=0, label=label or None
    )
    for edge in band:
        ax.plot(frequency, edge, color=color, linewidth=0.5, alpha=min(1.0, 2 * alpha))


def half_power(value: ComplexArray) -> list[int]:
    """The lines nearest to the half-power points on either side of the largest magnitude."""
    size = np.abs(value)
    peak = int(np.argmax(size))
    target = size[peak] / np.sqrt(2)
    found = []
    for side in (np.arange(peak, -1, -1), np.arange(peak, len(size))):
        below = np.flatnonzero(size[side] < target)
        if below.size:
            pair = side[max(below[0] - 1, 1) : below[0] + 1]  # never the peak itself
            found.append(int(pair[np.argmin(np.abs(size[pair] - target))]))
    return sorted(found)


# -- fewer points for the eye, with none of the noise hidden --------------------------------------


def extremes(
    x: FloatArray, y: FloatArray, *, bins: int = 500, log: bool = False
) -> tuple[FloatArray, FloatArray]:
    """The lowest and the highest sample of every bin of x, in the order they were recorded.

    A line through them covers the same paper as a line through every sample, once a bin is
    narrower than the line is wide. Bins are even in x, or in ln x (then only x > 0 is kept).
    Returns the samples untouched where there are few.
    """
    x, y = _positive(x, y) if log else (x, y)
    if len(x) <= 2 * bins:
        return x, y
    label, starts = _binned(x, bins, log)
    low = _first_equal(y, np.minimum.reduceat(y, starts), label)
    high = _first_equal(y, np.maximum.reduceat(y, starts), label)
    kept = np.union1d(low, high)
    return x[kept], y[kept]


def means(
    x: FloatArray, y: FloatArray, *, bins: int = 120, log: bool = False
) -> tuple[FloatArray, FloatArray]:
    """The mean of x and of y over every bin that holds a sample."""
    x, y = _positive(x, y) if log else (x, y)
    if len(x) == 0:
        return x, y
    _, starts = _binned(x, bins, log)
    count = np.diff(np.append(starts, len(x)))
    return np.add.reduceat(x, starts) / count, np.add.reduceat(y, starts) / count


def _positive(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    first = int(np.searchsorted(x, 0.0, side="right"))
    return x[first:], y[first:]


def _binned(x: FloatArray, bins: int, log: bool) -> tuple[IndexArray, IndexArray]:
    """Number the bin of every sample 0, 1, 2..., empty bins left out; where each bin starts."""
    scale = np.log(x) if log else x
    span = scale[-1] - scale[0] or 1.0
    raw = np.minimum((scale - scale[0]) / span * bins, bins - 1).astype(np.intp)
    fresh = np.concatenate(([True], np.diff(raw) > 0))
    return np.cumsum(fresh) - 1, np.flatnonzero(fresh)


def _first_equal(y: FloatArray, extreme: FloatArray, label: IndexArray) -> IndexArray:
    hits = np.flatnonzero(y == extreme[label])
    _, first = np.unique(label[hits], return_index=True)
    return hits[first]
