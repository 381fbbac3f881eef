"""Figures of the bench half: the test with its segments, and the fits to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.plot import panels as panel
from dashpot.plot.style import (
    GREY,
    MEASURED,
    NORMAL,
    PAGE,
    PALE,
    Pen,
    dress,
    figure,
    label_axes,
    legend,
    note,
    pen_of_arms,
    right_axis,
    unit_of,
)
from dashpot.preparation.denoising import true_motion
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DATA = Pen("#9a9a9a", "-", 1.7)
"""The measured force, wide and pale, so that the fits upon it leave it visible."""

FROM_CONTACT = "time from first contact, s"
FROM_LOG = f"{FROM_CONTACT} (log)"


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
    for above, below, title in zip(*grid, ("ramp, linear time", "hold, log time"), strict=True):
        label_axes(above, title=title)
        above.tick_params(labelbottom=False)
        label_axes(below, x=FROM_CONTACT)
    _name_segments(grid[0, 0], grid[0, 1], prepared)
    _label_force(grid[1, 1], prepared)
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
    shown = fitted(fit, alternatives, prepared)
    made = figure(PAGE, 64 + 24 * len(shown))
    grid = made.add_gridspec(
        1 + len(shown), 2, height_ratios=(2.6, *[1.0] * len(shown)), width_ratios=(1.0, 1.5)
    )
    hold, whole = made.add_subplot(grid[0, 0]), made.add_subplot(grid[0, 1])
    draw_fits(hold, shown, prepared, hold_only=True)
    label_axes(hold, x=FROM_CONTACT, title="hold, linear time")
    draw_fits(whole, shown, prepared)
    label_axes(whole, x=FROM_CONTACT, title="ramp and hold, log time")
    legend(whole)
    panels = [made.add_subplot(grid[row, :]) for row in range(1, 1 + len(shown))]
    for ax, one in zip(panels, shown, strict=True):
        draw_residual(ax, one, prepared)
        ax.tick_params(labelbottom=ax is panels[-1])
    label_axes(panels[-1], x=FROM_LOG)
    made.align_ylabels([hold, *panels])
    return made


class Fitted(NamedTuple):
    """A fit as it is drawn: its pen, time from first contact, s, and the force it says there, N."""

    fit: Fit
    pen: Pen
    time: FloatArray
    force: FloatArray

    def residual(self, prepared: RampHold) -> tuple[FloatArray, FloatArray]:
        """Time from first contact and residual, N, over what a log axis shows."""
        start, end = _log_start(prepared), prepared.hold_end - prepared.onset
        inside = (self.time >= start) & (self.time <= end)
        measured = np.interp(self.time[inside], prepared.time - prepared.onset, prepared.force)
        return self.time[inside], measured - self.force[inside]


def fitted(chosen: Fit, alternatives: Sequence[Fit], prepared: RampHold) -> list[Fitted]:
    """The curves of all fits that are shown."""
    return [
        Fitted(one, pen_of_arms(one.model.arms, chosen.model.arms), *fitted_force(one, prepared))
        for one in fits_to_show(chosen, alternatives)
    ]


def fits_to_show(fit: Fit, alternatives: Sequence[Fit]) -> list[Fit]:
    """The alternatives and the chosen fit, one per number of arms, fewest arms first."""
    by_arms = {one.model.arms: one for one in (*alternatives, fit)}
    return [by_arms[arms] for arms in sorted(by_arms)]


def draw_fits(
    ax: Axes, shown: Sequence[Fitted], prepared: RampHold, *, hold_only: bool = False
) -> None:
    """Force with the fitted curves over it: on log time, or the hold alone on linear time."""
    end = prepared.hold_end - prepared.onset
    start = prepared.ramp_time if hold_only else _log_start(prepared)
    unit, scale = unit_of(prepared.force, "N")

    def trace(t: FloatArray, force: FloatArray, pen: Pen, label: str) -> FloatArray:
        drawn = (t >= start) & (t <= end)
        values = scale * force[drawn]
        panel.trace(ax, t[drawn], values, pen, log=not hold_only, label=label)
        return values

    data = trace(prepared.time - prepared.onset, prepared.force, DATA, "measured")
    for one in shown:
        arms = one.fit.model.arms
        trace(one.time, one.force, one.pen, f"{counted(arms, 'Maxwell arm')} (N = {arms})")
    panel.segments(ax, _bounds(prepared))
    ax.set_xlim(start, end)
    ax.set_ylim(*panel.outer_limits(data))
    dress(ax, y=f"force, {unit}", log="" if hold_only else "x")


def draw_residual(
    ax: Axes, one: Fitted, prepared: RampHold, *, others: Sequence[Fitted] = ()
) -> None:
    """Measured less fitted force against log time; of `others` only the mean of each bin.

    On the right the same in standard deviations of the noise, if that is known.
    """
    when, left = one.residual(prepared)
    unit, scale = unit_of(left, "N")
    drawn = [scale * left]
    # every excursion pale, the mean of each bin in ink
    panel.trace(ax, when, drawn[0], Pen(PALE, "-", 0.5), log=True, zorder=1)
    x, y = panel.means(when, drawn[0], log=True)
    panel.line(ax, x, y, Pen(one.pen.color, "-", one.pen.width), zorder=3)
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=2)
    for other in others:
        x, y = panel.means(*other.residual(prepared), log=True)
        panel.trace(ax, x, scale * y, other.pen, log=True)
        drawn.append(scale * y)
    panel.segments(ax, _bounds(prepared))
    ax.set_ylim(*panel.outer_limits(*drawn, margin=0.08))
    ax.set_xlim(_log_start(prepared), prepared.hold_end - prepared.onset)
    dress(ax, y=f"N = {one.fit.model.arms}\nresidual, {unit}", log="x")
    noise = scale * prepared.force_noise
    if noise > 0:
        right_axis(ax, "in noise SD", lambda y: y / noise, lambda y: y * noise)
    word, factor = unit_of(np.array([one.fit.residual.rms]), "N")
    note(ax, f"RMS {factor * one.fit.residual.rms:.3g} {word}", (0.995, 0.95), ha="right")


def fitted_force(one: Fit, prepared: RampHold) -> tuple[FloatArray, FloatArray]:
    """Time from first contact and the force that the fit says at it, N.

    A fit of the hold answers to the ideal ramp of the paper's eq. (5), on the hold only. Every
    other answers to the motion behind the recorded displacement, bent by the elastic law, with the
    offset, drift and delay that the fit found.
    """
    solid = _at_depth(one, prepared.depth)
    if one.method == "hold":
        since = prepared.time[prepared.hold] - prepared.onset
        return since, solid.maxwell.ramp_hold_force(
            since, depth=prepared.depth, ramp_time=prepared.ramp_time
        )
    used = slice(0, prepared.hold.stop)
    time, (x, _) = prepared.time[used], true_motion(prepared)
    law = one.elastic_law
    path = x - x[0] if law is None or law.kind == "linear" else law.path(x - x[0])
    force = solid.force(time, path)
    terms = {
        "offset": np.ones(len(time)),
        "drift": time - time[0],
        "delay": -np.gradient(force, time),
    }
    told = {term.name: term.value for term in one.nuisance if term.name in terms}
    allowed = {term.name.partition(" ")[0] for term in one.nuisance} & set(terms)
    if told:
        force = force + sum(value * terms[name] for name, value in told.items())
    elif allowed:
        # of several tests it is not known which this is
        design = np.column_stack([terms[name] for name in sorted(allowed)])
        size, *_ = np.linalg.lstsq(design, prepared.force[used] - force, rcond=None)
        force = force + design @ size
    return time - prepared.onset, force


def _at_depth(one: Fit, depth: float) -> Solid:
    """The solid at this depth, where every test of the fit has stiffnesses of its own."""
    if not one.by_depth:
        return one.solid
    near = min(one.by_depth, key=lambda at: abs(at.depth - depth))
    there = [(k, tau) for k, tau in zip(near.k, one.model.tau, strict=False) if k > 0]
    k, tau = zip(*there, strict=True) if there else ((), ())
    return GeneralizedMaxwell(max(near.k_inf, 0.0), k, tau)


def counted(number: int, what: str) -> str:
    """So many of a thing, as a sentence says it.

    >>> counted(1, "arm"), counted(4, "Maxwell arm"), counted(9, "arm")
    ('one arm', 'four Maxwell arms', '9 arms')
    """
    words = ("no", "one", "two", "three", "four", "five", "six")
    return f"{words[number] if number < len(words) else number} {what}{'' if number == 1 else 's'}"


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
    inside = (t >= low) & (t <= high)
    panel.segments(ax, _bounds(prepared), before=low)
    panel.trace(ax, t[inside], values[inside], MEASURED)
    ax.set_xlim(low, high)
    ax.locator_params(axis="x", nbins=6)


def _hold(ax: Axes, t: FloatArray, values: FloatArray, prepared: RampHold) -> None:
    panel.segments(ax, _bounds(prepared))
    start = 0.5 * prepared.ramp_time
    inside = t >= start
    panel.trace(ax, t[inside], values[inside], MEASURED, log=True)
    ax.set_xlim(start, max(t[-1], prepared.hold_end - prepared.onset))
    dress(ax, log="x")


def _name_segments(ramp: Axes, hold: Axes, prepared: RampHold) -> None:
    word, factor = unit_of(prepared.displacement, "m")
    top = factor * prepared.depth
    low, _ = ramp.get_xlim()
    c = prepared.ramp_time
    middle = float(np.sqrt(c * (prepared.hold_end - prepared.onset)))
    places = [
        (ramp, 0.72 * c, 0.22 * top, f"ramp\n{c:.3g} s"),
        (ramp, 1.5 * c, 0.5 * top, "hold"),
        (hold, middle, 0.5 * top, f"hold\n{prepared.hold_time:.3g} s at {top:.3g} {word}"),
    ]
    if low < -0.2 * c:
        places.append((ramp, low / 2, 0.5 * top, "baseline"))
    for ax, x, y, text in places:
        ax.text(x, y, text, fontsize=NORMAL, va="center", ha="center", color="#333333")


def _label_force(ax: Axes, prepared: RampHold) -> None:
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
