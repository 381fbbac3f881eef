"""Panels of ramp, hold and residual with the record and its fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.relaxation import RampHold
from dashpot.plot.picture import (
    DATA_ON_FIT,
    FIT_BAND,
    REF,
    Line,
    Mark,
    Panel,
    Pen,
    Scale,
    Span,
    Tag,
)
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    downsample_to_extremes,
    downsample_to_means,
    unit_of,
)
from dashpot.plot.relaxation import SINCE_RAMP, PlottedFit, compute_time_step, residual_panel


def upon_panels(
    first: PlottedFit,
    prepared: RampHold,
    *,
    second: PlottedFit | None = None,
    whole: RampHold | None = None,
) -> tuple[Panel, Panel, Panel]:
    """Ramp, hold and residual with the record upon its fit, and all of the record in sight.

    The ramp is on the clock of the record; hold and residual are on log time since the end of the
    ramp, to the last sample: what a cut leaves out is hatched.

    Parameters
    ----------
    first : PlottedFit
        A band in its own colour.
    prepared : RampHold
    second : PlottedFit, optional
        Drawn thin beside it.
    whole : RampHold, optional
        The same test to its last sample, where the hold of `prepared` is cut.
    """
    _, scale = unit_of(prepared.force, "N")
    (ramp, hold), c = record_panels(prepared, whole=whole), prepared.ramp_time
    on_ramp, on_hold = fit_lines(first, prepared, whole or prepared)
    change, *upon = ramp.marks
    *remaining, held = hold.marks
    rest = residual_panel(first, prepared, time_origin=c, axis=hold.x)
    below: list[Mark] = [*remaining]
    if second is not None:
        below.append(
            _hold_line(second.time - c, scale * second.force, hold.x, second.pen, "eq. (5)")
        )
    return (
        replace(ramp, marks=(change, on_ramp, *upon)),
        replace(hold, marks=(*below, on_hold, held)),
        replace(rest, marks=(*remaining, *rest.marks)),
    )


def record_panels(prepared: RampHold, *, whole: RampHold | None = None) -> tuple[Panel, Panel]:
    """Ramp and hold of :func:`upon_panels` before there is any fit."""
    unit, scale = unit_of(prepared.force, "N")
    t, force, c = prepared.time, scale * prepared.force, prepared.ramp_time
    whole = whole or prepared
    seen, axis = _upon_axes(prepared, whole)
    within = (t >= seen[0]) & (t <= seen[1])
    displacement = prepared.displacement * (float(np.max(force[within])) / prepared.depth)
    ramp: tuple[Mark, ...] = (
        _ramp_line(t, displacement, seen, REF, "displacement"),
        _ramp_line(t, force, seen, DATA_ON_FIT, "measured"),
        Tag(float(prepared.onset + 0.55 * c), float(0.5 * np.max(displacement[within])),
            "displacement", "soft"),
    )  # fmt: skip
    since, held, (start, last) = whole.time - prepared.ramp_end, scale * whole.force, axis.limits
    hold: list[Mark] = []
    if prepared.hold_end - prepared.ramp_end < last:
        hold = [Span(prepared.hold_end - prepared.ramp_end, last, "away", "", True, 1.0)]
    hold.append(_hold_line(since, held, axis, DATA_ON_FIT, "measured"))
    text = f"force, {unit}"
    return (
        Panel(Scale("time on the record's clock, s", seen),
              Scale(text, _headroom(force[within])), ramp),
        Panel(axis, Scale(text, _headroom(held[since >= start])), tuple(hold)),
    )  # fmt: skip


def fit_lines(
    plotted_fit: PlottedFit, prepared: RampHold, whole: RampHold | None = None
) -> tuple[Line, Line]:
    """Return the fit on the ramp and on the hold of :func:`upon_panels`."""
    _, scale = unit_of(prepared.force, "N")
    (seen, axis), c = _upon_axes(prepared, whole or prepared), prepared.ramp_time
    under = replace(FIT_BAND, colour=plotted_fit.pen.colour)
    return (
        _ramp_line(
            plotted_fit.time + prepared.onset, scale * plotted_fit.force, seen, under, "fit"
        ),
        _hold_line(plotted_fit.time - c, scale * plotted_fit.force, axis, under, "fit"),
    )


def mean_residual(plotted_fit: PlottedFit, prepared: RampHold) -> tuple[FloatArray, FloatArray]:
    """Return the mean residual of :func:`upon_panels`, N, over time since the end of the ramp."""
    c, axis = prepared.ramp_time, _upon_axes(prepared, prepared)[1]
    when, residual = plotted_fit.residual(prepared, c + axis.limits[0])
    return downsample_to_means(when - c, residual, log=True)


def _upon_axes(prepared: RampHold, whole: RampHold) -> tuple[tuple[float, float], Scale]:
    """What is in sight of the ramp, s on the clock of the record, and the axis of the hold."""
    c, first, end = prepared.ramp_time, float(prepared.time[0]), float(whole.time[-1])
    last = end - prepared.ramp_end
    start = min(_first_step(prepared), last / 10)
    seen = max(first, prepared.onset - 0.5 * c), min(end, prepared.ramp_end + 0.8 * c)
    return seen, Scale(SINCE_RAMP, (start, last), log=True)


def _ramp_line(
    at: FloatArray, y: FloatArray, seen: tuple[float, float], pen: Pen, label: str
) -> Line:
    inside = (at >= seen[0]) & (at <= seen[1])
    return Line(*downsample_to_extremes(at[inside], y[inside], bins=250), pen, label)


def _hold_line(at: FloatArray, y: FloatArray, axis: Scale, pen: Pen, label: str) -> Line:
    start, last = axis.limits
    inside = (at >= start) & (at <= last)
    return Line(*downsample_to_extremes(at[inside], y[inside], bins=350, log=True), pen, label)


def _headroom(values: FloatArray) -> tuple[float, float]:
    """Return limits with space above the curves for the names of handles."""
    low, high = compute_padded_limits(values)
    return low, high + 0.12 * (high - low)


def _first_step(prepared: RampHold) -> float:
    """Where log time since the end of the ramp begins: two samples on, and no sliver of it."""
    return max(2 * compute_time_step(prepared), 1e-3 * prepared.hold_time / 4)
