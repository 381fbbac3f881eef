"""Quantities against frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dashpot._arrays import BoolArray, ComplexArray, FloatArray
from dashpot.plot.look import GREY, SKY, SMALL, Pen

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def magnitude(
    ax: Axes,
    frequency: FloatArray,
    value: ComplexArray,
    pen: Pen,
    *,
    sd: FloatArray | None = None,
    label: str = "",
) -> None:
    """Magnitude with a band of two standard deviations; axes are made logarithmic elsewhere."""
    size = np.abs(value)
    if sd is not None:
        # a magnitude has no negative side: the band is cut well below the curve
        low, high = np.maximum(size - 2 * sd, 0.02 * size), size + 2 * sd
        ax.fill_between(frequency, low, high, color=pen.color, alpha=0.18, linewidth=0)
    _line(ax, frequency, size, pen, label)


def phase(
    ax: Axes,
    frequency: FloatArray,
    value: ComplexArray,
    pen: Pen,
    *,
    sd: FloatArray | None = None,
) -> None:
    """Phase in degrees from -180 to 180, the line broken where it wraps."""
    degrees = np.degrees(np.angle(value))
    if sd is not None:
        half = np.degrees(np.arcsin(np.minimum(2 * sd / np.abs(value), 1.0)))
        ax.fill_between(
            frequency, degrees - half, degrees + half, color=pen.color, alpha=0.18, linewidth=0
        )
    wraps = np.flatnonzero(np.abs(np.diff(degrees)) > 180) + 1
    _line(ax, np.insert(frequency, wraps, np.nan), np.insert(degrees, wraps, np.nan), pen, "")
    ax.set_ylim(-190, 190)
    ax.set_yticks([-180, -90, 0, 90, 180])


def decibels(ax: Axes, reference: str) -> None:
    """The same magnitudes in dB on the right-hand side."""

    def to_db(y: FloatArray) -> FloatArray:
        return 20 * np.log10(np.maximum(y, 1e-300))

    def from_db(y: FloatArray) -> FloatArray:
        return np.power(10.0, np.asarray(y) / 20)

    right = ax.secondary_yaxis("right", functions=(to_db, from_db))
    right.set_ylabel(f"dB re {reference}", fontsize=SMALL)
    right.tick_params(labelsize=SMALL, color=GREY, length=3.0, width=0.6)
    right.spines["right"].set_linewidth(0.6)
    right.spines["right"].set_color(GREY)
    _decibel_ticks(right, ax)


def _decibel_ticks(right: Axes, ax: Axes) -> None:
    from matplotlib.ticker import MultipleLocator, NullLocator, ScalarFormatter

    low, high = ax.get_ylim()
    span = 20 * np.log10(high / low)
    right.yaxis.set_major_locator(MultipleLocator(20 if span > 50 else 10 if span > 22 else 5))
    right.yaxis.set_minor_locator(NullLocator())
    right.yaxis.set_major_formatter(ScalarFormatter())


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


def identified(ax: Axes, band: tuple[float, float]) -> None:
    """Shade the frequencies that the test can inform."""
    ax.axvspan(*band, color=SKY, alpha=0.16, linewidth=0, zorder=0)


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


def half_power(frequency: FloatArray, value: ComplexArray) -> list[int]:
    """The lines nearest to the half-power points on either side of the largest magnitude."""
    size = np.abs(value)
    peak = int(np.argmax(size))
    target = size[peak] / np.sqrt(2)
    found = []
    for side in (np.arange(peak, -1, -1), np.arange(peak, len(size))):
        below = np.flatnonzero(size[side] < target)
        if below.size:
            pair = side[max(below[0] - 1, 0) : below[0] + 1]
            found.append(int(pair[np.argmin(np.abs(size[pair] - target))]))
    return sorted({i for i in found if i != peak})


def _line(ax: Axes, x: FloatArray, y: FloatArray, pen: Pen, label: str) -> None:
    ax.plot(x, y, color=pen.color, linestyle=pen.dashes, linewidth=pen.width, label=label or None)
