"""Figure of a creep test or compliance: data, fit and residual."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.datamodel.fit import Fit
from dashpot.extensions.curves.creep.compliance import fitted_displacement
from dashpot.extensions.curves.datamodel.creep import CreepCompliance, LoadHold
from dashpot.extensions.curves.time_curve_figure import response_panels
from dashpot.plot.picture import DATA_ON_FIT, FIT, FIT_BAND, REF, Line, Panel, Picture, Rule, Scale
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    downsample_to_extremes,
    format_fit_stamp,
    select_plot_unit,
)

TIME_LABEL = "time since the load began, s"


def creep(fit: Fit, data: LoadHold | CreepCompliance, *, stamp: str = "") -> Picture:
    """Creep over log time with the fit to it, and the residual.

    Parameters
    ----------
    fit : Fit
    data : LoadHold or CreepCompliance
        Fitted record.
    stamp : str
        Origin of the data, printed below the figure; by default the fit's files, specimen and date.
    """
    panels = (
        _make_curve(fit, data)
        if isinstance(data, CreepCompliance)
        else _make_test_panels(fit, data)
    )
    caption = "Creep: measured, the fit to it, and what that leaves."
    return Picture("creep", caption, (panels,), 1, stamp or format_fit_stamp(fit))


def _make_test_panels(fit: Fit, data: LoadHold) -> tuple[Panel, Panel]:
    time_since_onset = data.time - data.onset
    first = max(float(np.diff(data.time).min()), 1e-3 * data.hold_time)
    is_shown = time_since_onset >= first
    t, measured, fitted_values = (
        time_since_onset[is_shown],
        data.displacement[is_shown],
        fitted_displacement(fit, data)[is_shown],
    )
    if data.unit == "N/m":
        unit, scale = select_plot_unit(measured, "m")
        label = f"displacement, {unit}"
    else:
        scale, label = 100.0, "strain, %"
    horizontal = Scale(TIME_LABEL, (first, float(t[-1])), log=True)

    def line(values: FloatArray) -> tuple[FloatArray, FloatArray]:
        return downsample_to_extremes(t, scale * values, bins=350, log=True)

    upper = Panel(
        horizontal, Scale(label, compute_padded_limits(scale * measured)),
        (Line(*line(fitted_values), FIT_BAND, "fit"), Line(*line(measured), DATA_ON_FIT,
        "measured")),
        height=240,
    )  # fmt: skip
    residual = measured - fitted_values
    unit, residual_scale = select_plot_unit(residual, "m") if data.unit == "N/m" else ("%", 100.0)
    x, y = downsample_to_extremes(t, residual_scale * residual, bins=350, log=True)
    rms = round_to_error(residual_scale * fit.estimate.residual.rms)
    lower = Panel(
        horizontal, Scale(f"residual, {unit}", compute_padded_limits(y, np.zeros(1), margin=0.1)),
        (Rule(0.0, REF, is_horizontal=True), Line(x, y, FIT)),
        height=90, note=f"rms {rms} {unit}",
    )  # fmt: skip
    return upper, lower


def _make_curve(fit: Fit, data: CreepCompliance) -> tuple[Panel, Panel]:
    return response_panels(
        data.time, data.compliance, compute_response=fit.solid.creep, unit=data.unit,
        name="creep compliance", axis="time since the step, s",
    )  # fmt: skip
