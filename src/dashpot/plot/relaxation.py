"""Figures of the bench half: the test with its segments, and the fits to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.plot.look import (
    CHOSEN,
    MEASURED,
    NORMAL,
    PAGE,
    Pen,
    dress,
    figure,
    legend,
    log_axis,
    note,
    pen_of_arms,
)
from dashpot.plot.panels import time as panel
from dashpot.relaxation.fit import Fit
from dashpot.relaxation.records import RampHold

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FROM_CONTACT = "time from first contact, s"


def segments(prepared: RampHold) -> Figure:
    """The prepared test with its baseline, ramp and hold (paper Fig. 2).

    Left the ramp on linear time, right the hold on log time from first contact, so that neither
    is a sliver of the other; displacement above, force below.
    """
    made = figure(PAGE, 92)
    grid = made.subplots(2, 2, sharey="row", width_ratios=(1.0, 1.35))
    t = prepared.time - prepared.onset
    rows = (
        (1e3 * prepared.displacement, "compression, mm"),
        (prepared.force, "force, N"),
    )
    for (ramp, hold), (values, label) in zip(grid, rows, strict=True):
        _zoom(ramp, t, values, prepared)
        _hold(hold, t, values, prepared)
        dress(ramp, y=label)
        dress(hold)
    for ax in grid[1]:
        ax.set_xlabel(FROM_CONTACT, fontsize=NORMAL)
    for ax in grid[0]:
        ax.tick_params(labelbottom=False)
    grid[0, 0].set_title("ramp, linear time", fontsize=NORMAL, loc="left", fontweight="bold")
    grid[0, 1].set_title("hold, log time", fontsize=NORMAL, loc="left", fontweight="bold")
    _name_segments(grid[0, 0], grid[0, 1], prepared)
    _say_force(grid[1, 1], prepared)
    return made


def fit(fit: Fit, prepared: RampHold, *, alternatives: Sequence[Fit] = ()) -> Figure:
    """The force and one or more fits to it, with the residuals of each (paper Fig. 4).

    Log time from first contact; residuals in mN and in standard deviations of the noise.

    Parameters
    ----------
    fit : Fit
        The chosen one.
    prepared : RampHold
        What it was fitted to.
    alternatives : sequence of Fit
        Others to hold against it, such as one arm against two.
    """
    shown = fits_to_show(fit, alternatives)
    made = figure(PAGE, 62 + 24 * len(shown))
    axes = made.subplots(1 + len(shown), 1, sharex=True, height_ratios=(2.6, *[1.0] * len(shown)))
    draw_fits(axes[0], shown, prepared, chosen=fit)
    dress(axes[0], y="force, N")
    legend(axes[0], loc="lower right")
    for ax, one in zip(axes[1:], shown, strict=True):
        draw_residual(ax, one, prepared, chosen=fit)
    axes[-1].set_xlabel(f"{FROM_CONTACT} (log)", fontsize=NORMAL)
    made.align_ylabels(list(axes))
    return made


def fits_to_show(fit: Fit, alternatives: Sequence[Fit]) -> list[Fit]:
    """The alternatives and the chosen fit, one per number of arms, fewest arms first."""
    by_arms = {one.model.arms: one for one in (*alternatives, fit)}
    return [by_arms[arms] for arms in sorted(by_arms)]


def draw_fits(ax: Axes, shown: Sequence[Fit], prepared: RampHold, *, chosen: Fit) -> None:
    """Force against log time with the fitted curves over it."""
    t = prepared.time - prepared.onset
    panel.trace(ax, t, prepared.force, Pen("#8c8c8c", "-", 0.8), log=True, label="measured")
    for one in shown:
        pen = pen_of_arms(one.model.arms, chosen.model.arms)
        when, force = fitted_force(one, prepared)
        panel.trace(ax, when, force, pen, log=True, label=name_of(one))
    panel.segments(ax, _bounds(prepared))
    start = _log_start(prepared)
    ax.set_xlim(start, prepared.hold_end - prepared.onset)
    held = prepared.force[t > start]
    ax.set_ylim(*panel.outer_limits(held))
    log_axis(ax, "x")


def draw_residual(ax: Axes, one: Fit, prepared: RampHold, *, chosen: Fit) -> None:
    """Measured less fitted force against log time."""
    when, force = fitted_force(one, prepared)
    measured = np.interp(when, prepared.time - prepared.onset, prepared.force)
    pen = pen_of_arms(one.model.arms, chosen.model.arms)
    panel.residual(
        ax, when, measured - force, pen, noise=prepared.force_noise, what=short_name_of(one)
    )
    panel.segments(ax, _bounds(prepared))
    start = _log_start(prepared)
    seen = 1e3 * (measured - force)[when > start]
    ax.set_ylim(*panel.outer_limits(seen, margin=0.08))
    ax.set_xlim(start, prepared.hold_end - prepared.onset)
    log_axis(ax, "x")
    note(ax, f"RMS {_milli(one.residual.rms)} mN", (0.995, 0.95), ha="right")


def fitted_force(one: Fit, prepared: RampHold) -> tuple[FloatArray, FloatArray]:
    """Time from first contact and the force that the fit says, nuisance terms included.

    A fit of the hold answers to the ideal ramp of the paper's eq. (5), on the hold only; every
    other to the recorded displacement.
    """
    t = prepared.time - prepared.onset
    extra = {term.name: term.value for term in one.nuisance}
    if one.method == "hold":
        t = t[prepared.hold]
        force = one.model.ramp_hold_force(t, depth=prepared.depth, ramp_time=prepared.ramp_time)
    else:
        force = one.model.force(prepared.time, prepared.displacement)
    return t, force + extra.get("offset", 0.0) + extra.get("drift", 0.0) * t


def name_of(one: Fit) -> str:
    """What the legend calls a fit."""
    arms = one.model.arms
    return f"N = {arms}: {arms} Maxwell arm{'' if arms == 1 else 's'}"


def short_name_of(one: Fit) -> str:
    """What a narrow panel calls a fit."""
    return f"N = {one.model.arms}"


def _bounds(prepared: RampHold) -> tuple[float, float, float]:
    return 0.0, prepared.ramp_time, prepared.hold_end - prepared.onset


def _log_start(prepared: RampHold) -> float:
    """Where log time begins: a small part of the ramp, but not between two samples."""
    step = float(np.median(np.diff(prepared.time)))
    return max(0.05 * prepared.ramp_time, 2 * step)


def _zoom(ax: Axes, t: FloatArray, values: FloatArray, prepared: RampHold) -> None:
    c = prepared.ramp_time
    low, high = max(t[0], -0.6 * c), min(t[-1], 2.0 * c)
    seen = (t >= low) & (t <= high)
    panel.segments(ax, _bounds(prepared), before=low)
    panel.trace(ax, t[seen], values[seen], MEASURED)
    ax.set_xlim(low, high)


def _hold(ax: Axes, t: FloatArray, values: FloatArray, prepared: RampHold) -> None:
    panel.segments(ax, _bounds(prepared))
    start = 0.5 * prepared.ramp_time
    seen = t >= start
    panel.trace(ax, t[seen], values[seen], MEASURED, log=True)
    ax.set_xlim(start, max(t[-1], prepared.hold_end - prepared.onset))
    log_axis(ax, "x")


def _name_segments(ramp: Axes, hold: Axes, prepared: RampHold) -> None:
    top = 1e3 * prepared.depth
    style = {"fontsize": NORMAL, "va": "center", "ha": "center", "color": "#333333"}
    low, _ = ramp.get_xlim()
    c = prepared.ramp_time
    if low < -0.2 * c:
        ramp.text(low / 2, 0.5 * top, "baseline", **style)
    ramp.text(0.72 * c, 0.22 * top, f"ramp\n{c:.4g} s", **style)
    ramp.text(1.5 * c, 0.5 * top, "hold", **style)
    middle = float(np.sqrt(c * (prepared.hold_end - prepared.onset)))
    hold.text(middle, 0.5 * top, f"hold\n{prepared.hold_time:.4g} s at {top:.4g} mm", **style)


def _say_force(ax: Axes, prepared: RampHold) -> None:
    held = prepared.force[prepared.hold]
    peak, last = float(held[0]), float(np.mean(held[-max(1, len(held) // 100) :]))
    note(
        ax,
        f"{peak:.3g} N at the end of the ramp, {last:.3g} N at the end of the hold: "
        f"{100 * (1 - last / peak):.0f} % relaxed",
        (0.98, 0.06),
        ha="right",
        va="bottom",
    )


def _milli(newton: float) -> str:
    return f"{1e3 * newton:.3g}"
