"""Quantities against time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.plot.style import GREY, PALE, SKY, YELLOW, Pen, dress, right_axis
from dashpot.plot.thinning import extremes, means

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def trace(
    ax: Axes,
    time: FloatArray,
    values: FloatArray,
    pen: Pen,
    *,
    log: bool = False,
    bins: int = 500,
    label: str = "",
) -> None:
    """One record against time, every excursion kept; with `log`, times must count from an event."""
    x, y = extremes(time, values, bins=bins, log=log)
    ax.plot(x, y, color=pen.color, linestyle=pen.dashes, linewidth=pen.width, label=label or None)


def residual(
    ax: Axes,
    time: FloatArray,
    values: FloatArray,
    pen: Pen,
    *,
    noise: float,
    unit: str,
    what: str,
) -> None:
    """Residuals against log time: every excursion pale, the mean of each bin in ink.

    On the right the same in standard deviations of the noise, `noise` in `unit`, if it is known.
    """
    x, y = extremes(time, values, log=True)
    ax.plot(x, y, color=PALE, linewidth=0.5, zorder=1)
    x, y = means(time, values, log=True)
    ax.plot(x, y, color=pen.color, linestyle="-", linewidth=pen.width, zorder=3)
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=2)
    dress(ax, y=f"{what}\nresidual, {unit}")
    if noise > 0:
        right_axis(ax, "in noise SD", lambda y: y / noise, lambda y: y * noise)


def segments(ax: Axes, bounds: tuple[float, float, float], *, before: float | None = None) -> None:
    """Shade the ramp and the hold between the three instants, and the baseline from `before`."""
    onset, ramp_end, hold_end = bounds
    if before is not None:
        ax.axvspan(before, onset, color=PALE, alpha=0.45, linewidth=0, zorder=0)
    ax.axvspan(onset, ramp_end, color=YELLOW, alpha=0.22, linewidth=0, zorder=0)
    ax.axvspan(ramp_end, hold_end, color=SKY, alpha=0.13, linewidth=0, zorder=0)


def pulse(ax: Axes, time: FloatArray, values: FloatArray, pen: Pen, *, label: str = "") -> None:
    """One short record with its samples visible where they are few."""
    few = len(time) <= 80
    ax.plot(
        time,
        values,
        color=pen.color,
        linestyle=pen.dashes,
        linewidth=pen.width,
        marker="." if few else "",
        markersize=2.5,
        label=label or None,
        alpha=0.85,
    )


def outer_limits(*arrays: FloatArray, margin: float = 0.06) -> tuple[float, float]:
    """Limits that hold every array with a margin."""
    low = min(float(np.min(a)) for a in arrays)
    high = max(float(np.max(a)) for a in arrays)
    pad = margin * ((high - low) or abs(high) or 1.0)
    return low - pad, high + pad
