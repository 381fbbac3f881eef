"""Quantities against frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.plot.style import GREY, SKY, Pen, right_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def magnitude(
    ax: Axes, frequency: FloatArray, value: ComplexArray, pen: Pen, *, label: str = ""
) -> None:
    """Magnitude; axes are made logarithmic elsewhere."""
    _line(ax, frequency, np.abs(value), pen, label)


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
    _line(ax, x, y, pen, "")


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
    _line(ax, frequency, value, pen, "")
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
    outside = np.where(_shrunk(inside), np.nan, value)
    ax.plot(frequency, outside, color=pen.color, linestyle=(0, (3.5, 1.8)), linewidth=pen.width)


def _shrunk(inside: BoolArray) -> BoolArray:
    """`inside` less its first and last line, so that the dashes reach the solid part."""
    return inside & np.roll(inside, 1) & np.roll(inside, -1)


def limits(
    ax: Axes, frequency: FloatArray, band: FloatArray, color: str, *, label: str, alpha: float
) -> None:
    """The area between two limits, edges drawn so that a narrow band is still seen."""
    ax.fill_between(
        frequency, band[0], band[1], color=color, alpha=alpha, linewidth=0, label=label or None
    )
    for edge in band:
        ax.plot(frequency, edge, color=color, linewidth=0.5, alpha=min(1.0, 2 * alpha))


def identified(ax: Axes, band: tuple[float, float], *, label: str = "") -> None:
    """Shade the frequencies that the test can inform."""
    ax.axvspan(*band, color=SKY, alpha=0.2, linewidth=0, zorder=0, label=label or None)


def nyquist(ax: Axes, value: ComplexArray, pen: Pen, *, label: str, markers: bool = False) -> None:
    """Imaginary part against real part."""
    ax.plot(
        value.real,
        value.imag,
        color=pen.color,
        linestyle="none" if markers else pen.dashes,
        linewidth=pen.width,
        marker="." if markers else "",
        markersize=2.5,
        label=label or None,
    )


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


def _line(ax: Axes, x: FloatArray, y: FloatArray, pen: Pen, label: str) -> None:
    ax.plot(x, y, color=pen.color, linestyle=pen.dashes, linewidth=pen.width, label=label or None)
