"""Figures of the hammer half: the FRF, and the predicted against the measured one."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.numbers import rounded
from dashpot.plot import panels as panel
from dashpot.plot.style import (
    BLUE,
    CHOSEN,
    COLUMN,
    GREY,
    JOINT,
    MEASURED,
    OTHERS,
    PAGE,
    PURPLE,
    SMALL,
    Pen,
    dress,
    figure,
    label_axes,
    legend,
    legend_above,
    plain,
)
from dashpot.records.bounds import FRFBounds
from dashpot.records.frf import FRF, Kind
from dashpot.vibration.comparison.comparison import Comparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FREQUENCY = "frequency, Hz"
PENS = (MEASURED, CHOSEN, JOINT, *OTHERS)


class Curve(NamedTuple):
    """An FRF as it is drawn, and the frequency and height of its peak where that is named."""

    frf: FRF
    label: str
    pen: Pen
    peak: tuple[float, float] | None = None


# what people read: the unit, its size in SI, and the reference of its decibels
SHOWN = {
    Kind.RECEPTANCE: ("mm/N", 1e3, "1 mm/N"),
    Kind.MOBILITY: ("(mm/s)/N", 1e3, "1 (mm/s)/N"),
    Kind.ACCELERANCE: ("(m/s²)/N", 1.0, "1 (m/s²)/N"),
    Kind.DYNAMIC_STIFFNESS: ("N/mm", 1e-3, "1 N/mm"),
}


def frf(
    measured: FRF, *others: FRF, labels: Sequence[str] = (), band: FRFBounds | None = None
) -> Figure:
    """One or several FRFs of one kind: magnitude, phase, and the coherence of the first.

    Parameters
    ----------
    measured : FRF
        Sets the kind and the range of frequencies.
    *others : FRF
        Drawn over it, converted to its kind.
    labels : sequence of str
        One per FRF.
    band : FRFBand, optional
        Between which limits a relaxation test predicts; drawn over an accelerance.
    """
    curves = _same_kind(measured, others, labels)
    return _bode(curves, band if measured.kind is Kind.ACCELERANCE else None)


def comparison(
    comparison: Comparison, *, joint: Comparison | None = None, band: FRFBounds | None = None
) -> Figure:
    """Predicted against measured accelerance, peaks named, coherence beneath (paper Fig. 6).

    Parameters
    ----------
    comparison : Comparison
        Prediction from the relaxation test against the measured FRF.
    joint : Comparison, optional
        The joint fit against the same FRF: what changes once the hammer is believed.
    band : FRFBand, optional
        Between which limits the relaxation test predicts.
    """
    curves = curves_of(comparison, joint)
    made = _bode(curves, band)
    mark_peaks(made.axes[0], curves)
    return made


def curves_of(comparison: Comparison, joint: Comparison | None) -> list[Curve]:
    """The curves of a comparison with their peaks, measured first."""
    c = comparison
    curves = [
        Curve(c.measured, "measured", MEASURED, (c.measured_hz, c.measured_peak)),
        Curve(c.predicted, "predicted from relaxation", CHOSEN, (c.predicted_hz, c.predicted_peak)),
    ]
    if joint is not None:
        peak = (joint.predicted_hz, joint.predicted_peak)
        curves.append(Curve(joint.predicted, "joint fit", JOINT, peak))
    return curves


def nyquist(measured: FRF, *others: FRF, labels: Sequence[str] = ()) -> Figure:
    """Imaginary against real part on equal axes, half-power points of each ringed."""
    unit, scale, _ = SHOWN[measured.kind]
    made = figure(COLUMN, 84)
    ax = made.subplots()
    for one, name, pen, _ in _same_kind(measured, others, labels):
        f, value = smooth(one)
        value = scale * value
        marks = panel.half_power(value)
        ends = " and ".join(f"{f[i]:.2f}" for i in marks)
        label = f"{name} (○ {ends} Hz)" if name and ends else name
        dots = {"linestyle": "none", "marker": "."} if one.averages > 0 else {}
        panel.line(ax, value.real, value.imag, pen, label, markersize=2.5, **dots)
        ax.plot(value[marks].real, value[marks].imag, "o", markerfacecolor="none", markersize=6,
                markeredgecolor=pen.color, markeredgewidth=0.9)  # fmt: skip
    ax.axhline(0, color=GREY, linewidth=0.5)
    ax.axvline(0, color=GREY, linewidth=0.5)
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.08)
    what = measured.kind.value.replace("_", " ")
    dress(ax, x=f"real part of {what}, {unit}", y=f"imaginary part of {what}, {unit}")
    legend_above(made, ax, columns=1)
    return made


def draw_magnitude(ax: Axes, curves: Sequence[Curve], *, around: float | None = None) -> None:
    """Magnitudes of FRFs of one kind, log-log, with decibels on the right.

    All lines are shown, or an octave and a bit to either side of the frequency `around`.
    """
    if around is not None:
        near = (around / 2.4, around * 2.4)
        curves = [one._replace(frf=one.frf.band(*near)) for one in curves]
    first = curves[0].frf
    unit, scale, reference = SHOWN[first.kind]
    sizes = []
    for one, label, pen, _ in curves:
        if one.sd is not None:
            panel.band(ax, one.frequency, scale * one.value, scale * one.sd, pen)
        f, value = smooth(one)
        sizes.append(scale * np.abs(value))
        panel.line(ax, f, sizes[-1], pen, label)
    ax.set_xlim(max(first.frequency[0], 1e-3 * first.frequency[-1]), first.frequency[-1])
    size = np.concatenate(sizes)
    # a few vanishing lines cannot stretch the axis
    low = max(float(np.percentile(size, 1)), 1e-4 * float(np.max(size)))
    ax.set_ylim(0.6 * low, 2.0 * float(np.max(size)))
    dress(ax, y=f"{first.kind.value.replace('_', ' ')}, {unit}", log="xy")
    panel.decibels(ax, reference)


def draw_band(ax: Axes, band: FRFBounds, *, parameters: bool = True) -> None:
    """What the relaxation test leaves open: by its standard errors, by unresolved arms."""
    low, high = ax.get_ylim()
    # a resonance without damping has no highest magnitude
    shown = (0.1 * low, 10 * high)
    panel.limits(ax, band.frequency, np.clip(band.unseen, *shown), PURPLE,
                 label="bound over unresolved arms", alpha=0.22)  # fmt: skip
    if parameters:
        panel.limits(ax, band.frequency, np.clip(band.parameter, *shown), BLUE,
                     label="standard errors (95 %)", alpha=0.3)  # fmt: skip
    ax.set_ylim(low, high)


def draw_phase(ax: Axes, curves: Sequence[Curve], *, spread: bool = True) -> None:
    """Phases of FRFs, on the part of the circle that they use."""
    lowest = panel.phase_axis(ax, np.concatenate([one.frf.value for one in curves]))
    for one, _, pen, _ in curves:
        if one.sd is not None and spread:
            panel.phase(ax, one.frequency, one.value, pen, lowest=lowest, sd=one.sd)
        else:
            f, value = smooth(one)
            panel.phase(ax, f, value, pen, lowest=lowest)
    dress(ax, y="phase, °")


def smooth(one: FRF) -> tuple[FloatArray, ComplexArray]:
    """A predicted FRF on denser lines, densest near its peak; a measured one as it is.

    A sharp resonance between two lines is drawn round: not the FRF but its inverse is joined by
    straight lines, which is smooth where the FRF peaks (it is the dynamic mass m + K/s^2).
    """
    dense_already = len(one.frequency) > 2000 or len(one.frequency) < 2
    if one.averages > 0 or dense_already or bool((one.value == 0).any()):
        return one.frequency, one.value
    size = np.abs(one.value)
    parts = np.where(np.maximum(size[:-1], size[1:]) > 0.2 * size.max(), 48, 3)
    start = np.repeat(np.arange(len(parts)), parts)
    within = np.arange(len(start)) - np.repeat(np.cumsum(parts) - parts, parts)
    place = np.append(start + within / np.repeat(parts, parts), len(parts))
    lines = np.arange(len(size))
    inverse = 1 / one.value
    real, imag = (np.interp(place, lines, part) for part in (inverse.real, inverse.imag))
    return np.interp(place, lines, one.frequency), np.asarray(1 / (real + 1j * imag))


def mark_peaks(ax: Axes, curves: Sequence[Curve]) -> None:
    """A dot at the peak of every curve, its frequency and height in the corner."""
    peaks = [(*one.peak, one.pen) for one in curves if one.peak is not None]
    for i, (hz, height, pen) in enumerate(peaks):
        text = f"{hz:.2f} Hz, {rounded(height)} (m/s²)/N"
        ax.plot([hz], [height], "o", markersize=3.5, color=pen.color, zorder=7)
        ax.annotate(
            text, (0.985, 0.97), xycoords="axes fraction",
            xytext=(0, -1.45 * SMALL * i), textcoords="offset points", ha="right", va="top",
            fontsize=SMALL, color=pen.color,
        )  # fmt: skip


def _same_kind(measured: FRF, others: Sequence[FRF], labels: Sequence[str]) -> list[Curve]:
    """Curves of FRFs of the first one's kind, labelled as far as labels go."""
    same = [measured, *(other.to(measured.kind) for other in others)]
    return [
        Curve(one, plain(label), pen)
        for one, label, pen in zip(
            same, itertools.chain(labels, itertools.repeat("")), itertools.cycle(PENS)
        )
    ]


def _bode(curves: Sequence[Curve], band: FRFBounds | None) -> Figure:
    measured = curves[0].frf
    strip = measured.coherence is not None
    rows = 3 if strip else 2
    made = figure(PAGE, 118 if strip else 100)
    axes = made.subplots(rows, 1, sharex=True, height_ratios=(2.6, 1.0, 0.6)[:rows])
    draw_magnitude(axes[0], curves)
    if band is not None:
        draw_band(axes[0], band)
    legend(axes[0], loc="lower right")
    draw_phase(axes[1], curves)
    if measured.coherence is not None:
        panel.coherence(axes[2], measured.frequency, measured.coherence, MEASURED)
        dress(axes[2], y="coherence, –")
    label_axes(axes[-1], x=FREQUENCY)
    made.align_ylabels(list(axes))
    return made
