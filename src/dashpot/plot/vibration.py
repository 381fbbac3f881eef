"""Figures of the hammer half: the FRF, and the predicted against the measured one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.plot.panels import frequency as panel
from dashpot.plot.style import (
    BLUE,
    CHOSEN,
    COLUMN,
    GREY,
    JOINT,
    MEASURED,
    NORMAL,
    OTHERS,
    PAGE,
    PURPLE,
    SMALL,
    Pen,
    dress,
    figure,
    legend,
    legend_above,
    log_axis,
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
    same = [measured, *(other.to(measured.kind) for other in others)]
    names = _names(labels, len(same))
    pens = [PENS[i % len(PENS)] for i in range(len(same))]
    return _bode(
        list(zip(same, names, pens, strict=True)),
        band if measured.kind is Kind.ACCELERANCE else None,
    )


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
    made = _bode(curves_of(comparison, joint), band)
    mark_peaks(made.axes[0], comparison, joint)
    return made


def curves_of(comparison: Comparison, joint: Comparison | None) -> list[tuple[FRF, str, Pen]]:
    """The curves of a comparison, measured first."""
    curves = [
        (comparison.measured, "measured", MEASURED),
        (comparison.predicted, "predicted from relaxation", CHOSEN),
    ]
    if joint is not None:
        curves.append((joint.predicted, "joint fit", JOINT))
    return curves


def peaks_of(comparison: Comparison, joint: Comparison | None) -> list[tuple[float, float]]:
    """Frequency and height of the peak of each of these curves."""
    c = comparison
    peaks = [(c.measured_hz, c.measured_peak), (c.predicted_hz, c.predicted_peak)]
    if joint is not None:
        peaks.append((joint.predicted_hz, joint.predicted_peak))
    return peaks


def nyquist(measured: FRF, *others: FRF, labels: Sequence[str] = ()) -> Figure:
    """Imaginary against real part on equal axes, half-power points of each ringed."""
    unit, scale, _ = SHOWN[measured.kind]
    made = figure(COLUMN, 84)
    ax = made.subplots()
    same = [measured, *(other.to(measured.kind) for other in others)]
    names = _names(labels, len(same))
    for one, name, pen in zip(same, names, PENS, strict=False):
        f, value = smooth(one)
        value = scale * value
        marks = panel.half_power(value)
        ends = " and ".join(f"{f[i]:.2f}" for i in marks)
        label = f"{name} (○ {ends} Hz)" if name and ends else name
        panel.nyquist(ax, value, pen, label=label, markers=one.averages > 0)
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


def draw_magnitude(
    ax: Axes, curves: Sequence[tuple[FRF, str, Pen]], *, around: float | None = None
) -> None:
    """Magnitudes of FRFs of one kind, log-log, with decibels on the right.

    All lines are shown, or an octave and a bit to either side of the frequency `around`.
    """
    if around is not None:
        near = (around / 2.4, around * 2.4)
        curves = [(one.band(*near), label, pen) for one, label, pen in curves]
    unit, scale, reference = SHOWN[curves[0][0].kind]
    for one, label, pen in curves:
        if one.sd is not None:
            panel.band(ax, one.frequency, scale * one.value, scale * one.sd, pen)
        f, value = smooth(one)
        panel.magnitude(ax, f, scale * value, pen, label=label)
    first = curves[0][0].frequency
    ax.set_xlim(max(first[0], 1e-3 * first[-1]), first[-1])
    ax.set_ylim(*_decent(np.concatenate([scale * np.abs(smooth(one)[1]) for one, _, _ in curves])))
    log_axis(ax, "x")
    log_axis(ax, "y")
    dress(ax, y=f"{curves[0][0].kind.value.replace('_', ' ')}, {unit}")
    panel.decibels(ax, reference)


def draw_band(ax: Axes, band: FRFBounds, *, parameters: bool = True) -> None:
    """What the relaxation test leaves open: by its standard errors, by arms it cannot see."""
    low, high = ax.get_ylim()
    # a resonance without damping has no highest magnitude
    shown = (0.1 * low, 10 * high)
    panel.limits(ax, band.frequency, np.clip(band.unseen, *shown), PURPLE,
                 label="room for unseen arms", alpha=0.22)  # fmt: skip
    if parameters:
        panel.limits(ax, band.frequency, np.clip(band.parameter, *shown), BLUE,
                     label="standard errors (95 %)", alpha=0.3)  # fmt: skip
    ax.set_ylim(low, high)


def draw_phase(ax: Axes, curves: Sequence[tuple[FRF, str, Pen]], *, spread: bool = True) -> None:
    """Phases of FRFs, on the part of the circle that they use."""
    lowest = panel.phase_axis(ax, np.concatenate([one.value for one, _, _ in curves]))
    for one, _, pen in curves:
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


def mark_peaks(ax: Axes, comparison: Comparison, joint: Comparison | None) -> None:
    """A dot at the peak of every curve, its frequency and height in the corner."""
    peaks = zip(peaks_of(comparison, joint), (MEASURED, CHOSEN, JOINT), strict=False)
    for i, ((hz, height), pen) in enumerate(peaks):
        text = f"{hz:.2f} Hz, {three_digits(height)} (m/s²)/N"
        ax.plot([hz], [height], "o", markersize=3.5, color=pen.color, zorder=7)
        ax.annotate(
            text, (0.985, 0.97), xycoords="axes fraction",
            xytext=(0, -1.45 * SMALL * i), textcoords="offset points", ha="right", va="top",
            fontsize=SMALL, color=pen.color,
        )  # fmt: skip


def three_digits(value: float) -> str:
    """At least three digits, never an exponent: 1084, 155, 15.5."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def _names(labels: Sequence[str], count: int) -> list[str]:
    return [plain(label) for label in labels] + [""] * (count - len(labels))


def _bode(curves: Sequence[tuple[FRF, str, Pen]], band: FRFBounds | None) -> Figure:
    measured = curves[0][0]
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
    axes[-1].set_xlabel(FREQUENCY, fontsize=NORMAL)
    made.align_ylabels(list(axes))
    return made


def _decent(size: FloatArray) -> tuple[float, float]:
    """Limits of a log axis that a few vanishing lines cannot stretch."""
    low = max(float(np.percentile(size, 1)), 1e-4 * float(np.max(size)))
    return 0.6 * low, 2.0 * float(np.max(size))
