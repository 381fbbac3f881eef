"""Figure of a relaxation modulus: data, fit and residual."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.datamodel.fit import Fit
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.datamodel.stress_relaxation import StressRelaxationTest
from dashpot.plot.picture import (
    DATA_ON_FIT,
    FIT,
    FIT_BAND,
    REF,
    Dots,
    Line,
    Panel,
    Picture,
    Rule,
    Scale,
)
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    compute_padded_log_limits,
    downsample_to_extremes,
    format_fit_stamp,
    read_as,
)

TIME = "time, s"


def modulus(fit: Fit, data: RelaxationModulus, *, stamp: str = "") -> Picture:
    """Return a relaxation modulus over log time with the fit to it, and the residual in per cent.

    Parameters
    ----------
    fit : Fit
    data : RelaxationModulus
        What it was fitted to.
    stamp : str
        Origin of the data, printed below the figure; by default the fit's files, specimen and date.
    """
    panels = response_panels(
        data.time, data.modulus, compute_response=fit.solid.relaxation, unit=data.unit,
        name="relaxation modulus", axis=TIME,
    )  # fmt: skip
    caption = "Relaxation modulus: measured, the fit to it, and what that leaves."
    return Picture("modulus", caption, (panels,), 1, stamp or format_fit_stamp(fit))


def response_panels(
    time: FloatArray,
    values: FloatArray,
    *,
    compute_response: Callable[[FloatArray], FloatArray],
    unit: str,
    name: str,
    axis: str,
) -> tuple[Panel, Panel]:
    """The answer to a step over log time with that of a solid, and the residual in per cent."""
    shown, scale = read_as(unit)
    is_positive_time = time > 0
    t, measured = time[is_positive_time], scale * values[is_positive_time]
    dense = np.geomspace(t[0], t[-1], 300)
    curve = scale * compute_response(dense)
    residual = 100 * (measured / (scale * compute_response(t)) - 1)
    horizontal = Scale(axis, (float(t[0]), float(t[-1])), log=True)
    upper = Panel(
        horizontal, Scale(f"{name}, {shown}", compute_padded_log_limits(measured, curve), log=True),
        (Line(dense, curve, FIT, "fit"), Dots(t, measured, "measured", "measured")),
        height=240,
    )  # fmt: skip
    lower = Panel(
        horizontal, Scale("residual, %", compute_padded_limits(residual, np.zeros(1), margin=0.1)),
        (Rule(0.0, REF, is_horizontal=True), Dots(t, residual, "fit")),
        height=90, note=f"rms {round_to_error(float(np.sqrt(np.mean(residual**2))))} %",
    )  # fmt: skip
    return upper, lower


def draw_stress_relaxation(fit: Fit, data: StressRelaxationTest, *, stamp: str = "") -> Picture:
    """Return the stress of a test over time with that of the fit, and the residual.

    Parameters
    ----------
    fit : Fit
    data : StressRelaxationTest
        What it was fitted to.
    stamp : str
        Origin of the data, printed below the figure; by default the fit's files, specimen and date.
    """
    unit, scale = read_as("Pa")
    sign = float(np.sign(np.median(data.strain) - data.strain[0])) or 1.0
    strain = sign * (data.strain - data.strain[0])
    time = data.time - data.time[0]
    stress = scale * fit.solid.force(time, strain)
    is_before_step = np.arange(len(time)) < max(int(np.argmax(strain > 0.02 * strain.max())), 1)
    measured = scale * sign * data.stress
    measured = measured - np.median(measured[is_before_step])
    residual = measured - stress
    horizontal = Scale(TIME, (float(time[0]), float(time[-1])))
    upper = Panel(
        horizontal, Scale(f"stress, {unit}", compute_padded_limits(measured, stress)),
        (
            Line(*downsample_to_extremes(time, stress, bins=350), FIT_BAND, "fit"),
            Line(*downsample_to_extremes(time, measured, bins=350), DATA_ON_FIT, "measured"),
        ),
        height=240,
    )  # fmt: skip
    x, y = downsample_to_extremes(time, residual, bins=350)
    lower = Panel(
        horizontal, Scale(f"residual, {unit}", compute_padded_limits(y, np.zeros(1), margin=0.1)),
        (Rule(0.0, REF, is_horizontal=True), Line(x, y, FIT)), height=90,
    )  # fmt: skip
    caption = "Relaxation in stress: measured, the fit to it, and what that leaves."
    return Picture(
        "stress-relaxation", caption, ((upper, lower),), 1, stamp or format_fit_stamp(fit)
    )
