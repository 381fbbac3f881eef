"""Figures of the bench half: the test with its segments, and the fits to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.plot.panels import time as panel
from dashpot.plot.style import (
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
    unit_of,
)
from dashpot.plot.thinning import means
from dashpot.preparation.denoising import true_motion
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DATA = Pen("#9a9a9a", "-", 1.7)
"""The measured force, wide and pale, so that the fits upon it leave it visible."""

FROM_CONTACT = "time from first contact, s"


def segments(prepared: RampHold) -> Figure:
    """The prepared test with its baseline, ramp and hold (paper Fig. 2).

    Left the ramp on linear time, right the hold on log time from first contact, so that neither
    is a sliver of the other; displacement above, force below.
    """
    made = figure(PAGE, 92)
    grid = made.subplots(2, 2, sharey="row", width_ratios=(1.0, 1.35))
    t = prepared.time - prepared.onset
    length, to_length = unit_of(prepared.displacement, "m")
    force, to_force = unit_of(prepared.force, "N")
    rows = (
        (to_length * prepared.displacement, f"compression, {length}"),
        (to_force * prepared.force, f"force, {force}"),
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
    made = figure(PAGE, 64 + 24 * len(shown))
    grid = made.add_gridspec(
        1 + len(shown), 2, height_ratios=(2.6, *[1.0] * len(shown)), width_ratios=(1.0, 1.5)
    )
    hold, whole = made.add_subplot(grid[0, 0]), made.add_subplot(grid[0, 1])
    draw_fits(hold, shown, prepared, chosen=fit, hold_only=True)
    hold.set_title("hold, linear time", fontsize=NORMAL, loc="left", fontweight="bold")
    draw_fits(whole, shown, prepared, chosen=fit)
    whole.set_title("ramp and hold, log time", fontsize=NORMAL, loc="left", fontweight="bold")
    for ax in (hold, whole):
        ax.set_xlabel(FROM_CONTACT, fontsize=NORMAL)
    legend(whole)
    panels = [made.add_subplot(row) for row in (grid[i, :] for i in range(1, 1 + len(shown)))]
    for ax, one in zip(panels, shown, strict=True):
        draw_residual(ax, one, prepared, chosen=fit)
        ax.tick_params(labelbottom=ax is panels[-1])
    panels[-1].set_xlabel(f"{FROM_CONTACT} (log)", fontsize=NORMAL)
    made.align_ylabels([hold, *panels])
    return made


def fits_to_show(fit: Fit, alternatives: Sequence[Fit]) -> list[Fit]:
    """The alternatives and the chosen fit, one per number of arms, fewest arms first."""
    by_arms = {one.model.arms: one for one in (*alternatives, fit)}
    return [by_arms[arms] for arms in sorted(by_arms)]


def draw_fits(
    ax: Axes, shown: Sequence[Fit], prepared: RampHold, *, chosen: Fit, hold_only: bool = False
) -> None:
    """Force with the fitted curves over it: on log time, or the hold alone on linear time."""
    t = prepared.time - prepared.onset
    end = prepared.hold_end - prepared.onset
    start = prepared.ramp_time if hold_only else _log_start(prepared)
    seen = (t >= start) & (t <= end)
    unit, scale = unit_of(prepared.force, "N")
    data = scale * prepared.force[seen]
    panel.trace(ax, t[seen], data, DATA, log=not hold_only, label="measured")
    for one in shown:
        when, force = fitted_force(one, prepared)
        drawn = (when >= start) & (when <= end)
        pen = pen_of_arms(one.model.arms, chosen.model.arms)
        curve = scale * force[drawn]
        panel.trace(ax, when[drawn], curve, pen, log=not hold_only, label=name_of(one))
    panel.segments(ax, _bounds(prepared))
    ax.set_xlim(start, end)
    ax.set_ylim(*panel.outer_limits(data))
    dress(ax, y=f"force, {unit}")
    if not hold_only:
        log_axis(ax, "x")


def draw_residual(
    ax: Axes, one: Fit, prepared: RampHold, *, chosen: Fit, others: Sequence[Fit] = ()
) -> None:
    """Measured less fitted force against log time; of `others` only the mean of each bin."""
    start, end = _log_start(prepared), prepared.hold_end - prepared.onset
    when, left = _left(one, prepared)
    unit, scale = unit_of(left, "N")
    pen = pen_of_arms(one.model.arms, chosen.model.arms)
    panel.residual(
        ax, when, scale * left, pen, noise=scale * prepared.force_noise, unit=unit,
        what=short_name_of(one),
    )  # fmt: skip
    seen = [scale * left]
    for other in others:
        x, y = means(*_left(other, prepared), log=True)
        pen = pen_of_arms(other.model.arms, chosen.model.arms)
        panel.trace(ax, x, scale * y, pen, log=True)
        seen.append(scale * y)
    panel.segments(ax, _bounds(prepared))
    ax.set_ylim(*panel.outer_limits(*seen, margin=0.08))
    ax.set_xlim(start, end)
    log_axis(ax, "x")
    note(ax, f"RMS {_rms(one.residual.rms)}", (0.995, 0.95), ha="right")


def _left(one: Fit, prepared: RampHold) -> tuple[FloatArray, FloatArray]:
    """Time from first contact and residual, N, over what a log axis shows."""
    when, force = fitted_force(one, prepared)
    start, end = _log_start(prepared), prepared.hold_end - prepared.onset
    seen = (when >= start) & (when <= end)
    measured = np.interp(when[seen], prepared.time - prepared.onset, prepared.force)
    return when[seen], measured - force[seen]


def fitted_force(one: Fit, prepared: RampHold) -> tuple[FloatArray, FloatArray]:
    """Time from first contact and the force that the fit says at it, N.

    A fit of the hold answers to the ideal ramp of the paper's eq. (5), on the hold only. Every
    other answers to the motion behind the recorded displacement, with the offset and drift of the
    load cell that the fit allowed: given the solid, they are what least squares makes of the rest.
    """
    model = _at_depth(one, prepared.depth)
    if one.method == "hold":
        since = prepared.time[prepared.hold] - prepared.onset
        return since, model.ramp_hold_force(
            since, depth=prepared.depth, ramp_time=prepared.ramp_time
        )
    used = slice(0, prepared.hold.stop)
    time, (x, _) = prepared.time[used], true_motion(prepared)
    force = model.force(time, x - x[0])
    terms = {"offset": np.ones(len(time)), "drift": time - time[0]}
    allowed = {term.name.partition(" ")[0] for term in one.nuisance}
    columns = [column for name, column in terms.items() if name in allowed]
    if columns:
        design = np.column_stack(columns)
        force = (
            force + design @ np.linalg.lstsq(design, prepared.force[used] - force, rcond=None)[0]
        )
    return time - prepared.onset, force


def _at_depth(one: Fit, depth: float) -> GeneralizedMaxwell:
    """The solid at this depth, where every test of the fit has stiffnesses of its own."""
    if not one.by_depth:
        return one.model
    near = min(one.by_depth, key=lambda at: abs(at.depth - depth))
    there = [(k, tau) for k, tau in zip(near.k, one.model.tau, strict=False) if k > 0]
    return GeneralizedMaxwell(
        max(near.k_inf, 0.0), tuple(k for k, _ in there), tuple(tau for _, tau in there)
    )


def name_of(one: Fit) -> str:
    """What the legend calls a fit."""
    arms = one.model.arms
    word = {0: "no", 1: "one", 2: "two", 3: "three", 4: "four"}.get(arms, str(arms))
    return f"{word} Maxwell arm{'' if arms == 1 else 's'} (N = {arms})"


def short_name_of(one: Fit) -> str:
    """What a narrow panel calls a fit."""
    return f"N = {one.model.arms}"


def _bounds(prepared: RampHold) -> tuple[float, float, float]:
    return 0.0, prepared.ramp_time, prepared.hold_end - prepared.onset


def _log_start(prepared: RampHold) -> float:
    """Where log time begins: a tenth of the ramp, but not between two samples."""
    near = (prepared.time >= prepared.onset) & (prepared.time <= prepared.ramp_end)
    # sampling may slow down during the hold: the ramp's own steps count
    steps = np.diff(prepared.time[near] if near.sum() > 1 else prepared.time)
    step = float(np.median(steps))
    start = max(0.1 * prepared.ramp_time, 2 * step)
    digit = 10.0 ** np.floor(np.log10(start))
    return float(digit * np.floor(start / digit + 1e-9))


def _zoom(ax: Axes, t: FloatArray, values: FloatArray, prepared: RampHold) -> None:
    c = prepared.ramp_time
    low, high = max(t[0], -0.6 * c), min(t[-1], 2.0 * c)
    seen = (t >= low) & (t <= high)
    panel.segments(ax, _bounds(prepared), before=low)
    panel.trace(ax, t[seen], values[seen], MEASURED)
    ax.set_xlim(low, high)
    ax.locator_params(axis="x", nbins=6)


def _hold(ax: Axes, t: FloatArray, values: FloatArray, prepared: RampHold) -> None:
    panel.segments(ax, _bounds(prepared))
    start = 0.5 * prepared.ramp_time
    seen = t >= start
    panel.trace(ax, t[seen], values[seen], MEASURED, log=True)
    ax.set_xlim(start, max(t[-1], prepared.hold_end - prepared.onset))
    log_axis(ax, "x")


def _name_segments(ramp: Axes, hold: Axes, prepared: RampHold) -> None:
    word, factor = unit_of(prepared.displacement, "m")
    top = factor * prepared.depth
    low, _ = ramp.get_xlim()
    c = prepared.ramp_time
    middle = float(np.sqrt(c * (prepared.hold_end - prepared.onset)))
    words = [
        (ramp, 0.72 * c, 0.22 * top, f"ramp\n{c:.3g} s"),
        (ramp, 1.5 * c, 0.5 * top, "hold"),
        (hold, middle, 0.5 * top, f"hold\n{prepared.hold_time:.3g} s at {top:.3g} {word}"),
    ]
    if low < -0.2 * c:
        words.append((ramp, low / 2, 0.5 * top, "baseline"))
    for ax, x, y, text in words:
        ax.text(x, y, text, fontsize=NORMAL, va="center", ha="center", color="#333333")


def _say_force(ax: Axes, prepared: RampHold) -> None:
    held = prepared.force[prepared.hold]
    word, factor = unit_of(held, "N")
    peak, last = float(np.max(held)), float(np.mean(held[-max(1, len(held) // 100) :]))
    note(
        ax,
        f"highest {factor * peak:.3g} {word}, last {factor * last:.3g} {word}: "
        f"{100 * (1 - last / peak):.0f} % relaxed",
        (0.97, 0.06),
        ha="right",
        va="bottom",
    )


def _rms(newton: float) -> str:
    word, factor = unit_of(np.array([newton]), "N")
    return f"{factor * newton:.3g} {word}"
