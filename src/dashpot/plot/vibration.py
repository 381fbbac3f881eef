"""Figures of the hammer half: the FRF, and the predicted against the measured one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.comparison import Comparison
from dashpot.plot.look import (
    CHOSEN,
    COLUMN,
    GREY,
    JOINT,
    MEASURED,
    NORMAL,
    OTHERS,
    PAGE,
    SMALL,
    Pen,
    dress,
    figure,
    legend,
    log_axis,
)
from dashpot.plot.panels import frequency as panel
from dashpot.vibration.frf import FRF, Kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FREQUENCY = "frequency, Hz"

# what people read: the unit, its size in SI, and the reference of its decibels
SHOWN = {
    Kind.RECEPTANCE: ("mm/N", 1e3, "1 mm/N"),
    Kind.MOBILITY: ("(mm/s)/N", 1e3, "1 (mm/s)/N"),
    Kind.ACCELERANCE: ("(m/s²)/N", 1.0, "1 (m/s²)/N"),
    Kind.DYNAMIC_STIFFNESS: ("N/mm", 1e-3, "1 N/mm"),
}


def frf(measured: FRF, *others: FRF, labels: Sequence[str] = ()) -> Figure:
    """One or several FRFs of one kind: magnitude, phase, and the coherence of the first.

    Parameters
    ----------
    measured : FRF
        Sets the kind and the range of frequencies.
    *others : FRF
        Drawn over it, converted to its kind.
    labels : sequence of str
        One per FRF.
    """
    same = [measured, *(other.to(measured.kind) for other in others)]
    names = [*labels, *[""] * (len(same) - len(labels))]
    pens = [MEASURED, CHOSEN, JOINT, *OTHERS][: len(same)]
    return _bode(list(zip(same, names, pens, strict=True)))


def comparison(comparison: Comparison, *, joint: Comparison | None = None) -> Figure:
    """Predicted against measured accelerance, peaks named, coherence beneath (paper Fig. 6).

    Parameters
    ----------
    comparison : Comparison
        Prediction from the relaxation test against the measured FRF.
    joint : Comparison, optional
        The joint fit against the same FRF: what changes once the hammer is believed.
    """
    curves = [
        (comparison.measured, "measured (±2 SD)", MEASURED),
        (comparison.predicted, "predicted from relaxation", CHOSEN),
    ]
    if joint is not None:
        curves.append((joint.predicted, "joint fit, relaxation + FRF", JOINT))
    made = _bode(curves)
    name_peaks(made.axes[0], comparison, joint)
    return made


def nyquist(measured: FRF, *others: FRF, labels: Sequence[str] = ()) -> Figure:
    """Imaginary against real part on equal axes, half-power points of each ringed."""
    unit, scale, _ = SHOWN[measured.kind]
    made = figure(COLUMN, 84)
    ax = made.subplots()
    names = [*labels, *[""] * (1 + len(others) - len(labels))]
    for i, (one, name) in enumerate(
        zip([measured, *(other.to(measured.kind) for other in others)], names, strict=True)
    ):
        pen = [MEASURED, CHOSEN, JOINT, *OTHERS][i]
        value = scale * one.value
        panel.nyquist(ax, value, pen, label=name, markers=i == 0 and one.averages > 0)
        marks = panel.half_power(one.frequency, value)
        ax.plot(value[marks].real, value[marks].imag, "o", markerfacecolor="none", markersize=6,
                markeredgecolor=pen.color, markeredgewidth=0.9)  # fmt: skip
        for line in marks:
            ax.annotate(
                f"{one.frequency[line]:.4g} Hz", (value[line].real, value[line].imag),
                xytext=(5, 3), textcoords="offset points", fontsize=SMALL, color=pen.color,
            )  # fmt: skip
    ax.axhline(0, color=GREY, linewidth=0.5)
    ax.axvline(0, color=GREY, linewidth=0.5)
    ax.set_aspect("equal", adjustable="datalim")
    what = measured.kind.value.replace("_", " ")
    dress(ax, x=f"real part of {what}, {unit}", y=f"imaginary part of {what}, {unit}")
    legend(ax, loc="best")
    return made


def draw_magnitude(ax: Axes, curves: Sequence[tuple[FRF, str, Pen]]) -> None:
    """Magnitudes of FRFs of one kind, log-log, with decibels on the right."""
    unit, scale, reference = SHOWN[curves[0][0].kind]
    for one, label, pen in curves:
        sd = None if one.sd is None else scale * one.sd
        panel.magnitude(ax, one.frequency, scale * one.value, pen, sd=sd, label=label)
    first = curves[0][0].frequency
    ax.set_xlim(max(first[0], 1e-3 * first[-1]), first[-1])
    ax.set_ylim(*_decent(np.concatenate([scale * np.abs(one.value) for one, _, _ in curves])))
    log_axis(ax, "x")
    log_axis(ax, "y")
    dress(ax, y=f"{curves[0][0].kind.value.replace('_', ' ')}, {unit}")
    panel.decibels(ax, reference)


def name_peaks(ax: Axes, comparison: Comparison, joint: Comparison | None) -> None:
    """Write frequency and height beside the peak of every curve."""
    peaks = [
        (comparison.measured_hz, comparison.measured_peak, MEASURED.color, "measured"),
        (comparison.predicted_hz, comparison.predicted_peak, CHOSEN.color, "predicted"),
    ]
    if joint is not None:
        peaks.append((joint.predicted_hz, joint.predicted_peak, JOINT.color, "joint"))
    for hz, height, color, _ in peaks:
        ax.plot([hz], [height], "o", markersize=3.5, color=color, zorder=7)
    text = [f"{name}: {hz:.2f} Hz, {height:.3g} (m/s²)/N" for hz, height, _, name in peaks]
    for i, (line, (_, _, color, _)) in enumerate(zip(text, peaks, strict=True)):
        ax.text(0.015, 0.96 - 0.085 * i, line, transform=ax.transAxes, fontsize=SMALL,
                color=color, va="top")  # fmt: skip


def _bode(curves: Sequence[tuple[FRF, str, Pen]]) -> Figure:
    measured = curves[0][0]
    scale = SHOWN[measured.kind][1]
    strip = measured.coherence is not None
    made = figure(PAGE, 118 if strip else 100)
    axes = made.subplots(
        3 if strip else 2, 1, sharex=True, height_ratios=(2.6, 1.1, 0.55)[: 3 if strip else 2]
    )
    draw_magnitude(axes[0], curves)
    legend(axes[0], loc="upper right")
    for one, _, pen in curves:
        sd = None if one.sd is None else scale * one.sd
        panel.phase(axes[1], one.frequency, scale * one.value, pen, sd=sd)
    dress(axes[1], y="phase, °")
    if measured.coherence is not None:
        panel.coherence(axes[2], measured.frequency, measured.coherence, MEASURED)
        dress(axes[2], y="coherence, 1")
    axes[-1].set_xlabel(FREQUENCY, fontsize=NORMAL)
    made.align_ylabels(list(axes))
    return made


def _decent(size: FloatArray) -> tuple[float, float]:
    """Limits of a log axis that a few vanishing lines cannot stretch."""
    low = max(float(np.percentile(size, 1)), 1e-4 * float(np.max(size)))
    return 0.6 * low, 2.0 * float(np.max(size))
