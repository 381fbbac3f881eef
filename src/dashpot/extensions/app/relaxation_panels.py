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
    select_plot_unit,
)
from dashpot.plot.relaxation import (
    TIME_AFTER_RAMP_LABEL,
    PlottedFit,
    compute_time_step,
    residual_panel,
)


def make_fit_panels(
    plotted_fit: PlottedFit,
    prepared: RampHold,
    *,
    comparison_fit: PlottedFit | None = None,
    full_test: RampHold | None = None,
) -> tuple[Panel, Panel, Panel]:
    """Ramp, hold and residual with the record upon its fit, and all of the record in sight.

    The ramp is on the clock of the record; hold and residual are on log time since the end of the
    ramp, to the last sample: the part cut off is hatched.

    Parameters
    ----------
    plotted_fit : PlottedFit
        A band in its own colour.
    prepared : RampHold
    comparison_fit : PlottedFit, optional
        Drawn thin beside it.
    full_test : RampHold, optional
        The same test to its last sample, where the hold of `prepared` is cut.
    """
    _, scale = select_plot_unit(prepared.force, "N")
    (ramp, hold), ramp_time = make_record_panels(prepared, full_test=full_test), prepared.ramp_time
    ramp_fit, hold_fit = make_fit_lines(plotted_fit, prepared, full_test or prepared)
    displacement_line, *ramp_marks = ramp.marks
    *hold_marks, measured_hold = hold.marks
    residual = residual_panel(plotted_fit, prepared, time_origin=ramp_time, axis=hold.x)
    lower_marks: list[Mark] = [*hold_marks]
    if comparison_fit is not None:
        lower_marks.append(
            _make_hold_line(
                comparison_fit.time - ramp_time,
                scale * comparison_fit.force,
                hold.x,
                comparison_fit.pen,
                "eq. (5)",
            )
        )
    return (
        replace(ramp, marks=(displacement_line, ramp_fit, *ramp_marks)),
        replace(hold, marks=(*lower_marks, hold_fit, measured_hold)),
        replace(residual, marks=(*hold_marks, *residual.marks)),
    )


def make_record_panels(
    prepared: RampHold, *, full_test: RampHold | None = None
) -> tuple[Panel, Panel]:
    """Ramp and hold of :func:`make_fit_panels` before a fit."""
    unit, scale = select_plot_unit(prepared.force, "N")
    t, force, ramp_time = prepared.time, scale * prepared.force, prepared.ramp_time
    full_test = full_test or prepared
    ramp_window, axis = _make_axes(prepared, full_test)
    is_in_window = (t >= ramp_window[0]) & (t <= ramp_window[1])
    displacement = prepared.displacement * (float(np.max(force[is_in_window])) / prepared.depth)
    ramp: tuple[Mark, ...] = (
        _make_ramp_line(t, displacement, ramp_window, REF, "displacement"),
        _make_ramp_line(t, force, ramp_window, DATA_ON_FIT, "measured"),
        Tag(float(prepared.onset + 0.55 * ramp_time),
        float(0.5 * np.max(displacement[is_in_window])),
            "displacement", "soft"),
    )  # fmt: skip
    hold_elapsed, hold_force, (start, last_time) = (
        full_test.time - prepared.ramp_end,
        scale * full_test.force,
        axis.limits,
    )
    hold: list[Mark] = []
    if prepared.hold_end - prepared.ramp_end < last_time:
        hold = [Span(prepared.hold_end - prepared.ramp_end, last_time, "away", "", True, 1.0)]
    hold.append(_make_hold_line(hold_elapsed, hold_force, axis, DATA_ON_FIT, "measured"))
    text = f"force, {unit}"
    return (
        Panel(Scale("time on the record's clock, s", ramp_window),
              Scale(text, _add_headroom(force[is_in_window])), ramp),
        Panel(axis, Scale(text, _add_headroom(hold_force[hold_elapsed >= start])), tuple(hold)),
    )  # fmt: skip


def make_fit_lines(
    plotted_fit: PlottedFit, prepared: RampHold, full_test: RampHold | None = None
) -> tuple[Line, Line]:
    """Return the fit on the ramp and on the hold of :func:`make_fit_panels`."""
    _, scale = select_plot_unit(prepared.force, "N")
    (ramp_window, axis), ramp_time = _make_axes(prepared, full_test or prepared), prepared.ramp_time
    fit_pen = replace(FIT_BAND, colour=plotted_fit.pen.colour)
    return (
        _make_ramp_line(
            plotted_fit.time + prepared.onset,
            scale * plotted_fit.force,
            ramp_window,
            fit_pen,
            "fit",
        ),
        _make_hold_line(
            plotted_fit.time - ramp_time, scale * plotted_fit.force, axis, fit_pen, "fit"
        ),
    )


def compute_mean_residual(
    plotted_fit: PlottedFit, prepared: RampHold
) -> tuple[FloatArray, FloatArray]:
    """Return the mean residual of :func:`make_fit_panels`, N, over time since the ramp's end."""
    ramp_time, axis = prepared.ramp_time, _make_axes(prepared, prepared)[1]
    sample_time, residual = plotted_fit.residual(prepared, ramp_time + axis.limits[0])
    return downsample_to_means(sample_time - ramp_time, residual, log=True)


def _make_axes(prepared: RampHold, full_test: RampHold) -> tuple[tuple[float, float], Scale]:
    """Return the visible range of the ramp, s on the clock of the record, and the hold's axis."""
    ramp_time, first, end = prepared.ramp_time, float(prepared.time[0]), float(full_test.time[-1])
    hold_length = end - prepared.ramp_end
    start = min(_get_axis_start(prepared), hold_length / 10)
    ramp_window = (
        max(first, prepared.onset - 0.5 * ramp_time),
        min(end, prepared.ramp_end + 0.8 * ramp_time),
    )
    return ramp_window, Scale(TIME_AFTER_RAMP_LABEL, (start, hold_length), log=True)


def _make_ramp_line(
    time: FloatArray, y: FloatArray, window: tuple[float, float], pen: Pen, label: str
) -> Line:
    inside = (time >= window[0]) & (time <= window[1])
    return Line(*downsample_to_extremes(time[inside], y[inside], bins=250), pen, label)


def _make_hold_line(time: FloatArray, y: FloatArray, axis: Scale, pen: Pen, label: str) -> Line:
    start, end = axis.limits
    inside = (time >= start) & (time <= end)
    return Line(*downsample_to_extremes(time[inside], y[inside], bins=350, log=True), pen, label)


def _add_headroom(values: FloatArray) -> tuple[float, float]:
    """Return limits with space above the curves for the names of handles."""
    low, high = compute_padded_limits(values)
    return low, high + 0.12 * (high - low)


def _get_axis_start(prepared: RampHold) -> float:
    """Where log time since the end of the ramp begins: two samples on, and no sliver of it."""
    return max(2 * compute_time_step(prepared), 1e-3 * prepared.hold_time / 4)
