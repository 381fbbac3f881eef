"""Figure of one solid at several temperatures: tests, fits and shift factors."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import celsius
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.relaxation import RampHold
from dashpot.extensions.curves.superposition.figure import shift_panel
from dashpot.plot.picture import Line, Mark, Panel, Pen, Picture, Scale
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    downsample_to_extremes,
    format_fit_stamp,
)
from dashpot.plot.relaxation import TIME_LABEL, fitted_force
from dashpot.plot.style import sequential


def temperatures(fit: Fit, tests: Sequence[RampHold], *, stamp: str = "") -> Picture:
    """Return panels of the force of every test, cold to warm, with one model, and its shifts.

    Log time from first contact: raw curves are no master curve, for the ramp does not shift.

    Parameters
    ----------
    fit : Fit
        Fit of tests at several temperatures.
    tests : sequence of RampHold
        What it was fitted to.
    stamp : str
        Origin of the data, printed below the figure; by default the fit's files, specimen and date.

    Raises
    ------
    DataError
        If the fit is of one temperature.
    """
    if fit.temperatures is None:
        raise DataError("the fit is of one temperature; expected one of several")
    marks: list[Mark] = []
    cold_first = sorted(tests, key=lambda test: test.specimen.temperature or 0.0)
    shortest = min(0.1 * test.ramp_time for test in tests)
    longest = max(test.hold_end - test.onset for test in tests)
    shown_forces: list[FloatArray] = []
    for test, colour in zip(cold_first, sequential(len(cold_first)), strict=True):
        time_since_onset = test.time - test.onset
        in_range = (time_since_onset >= shortest) & (time_since_onset <= test.hold_end - test.onset)
        x, y = downsample_to_extremes(
            time_since_onset[in_range], test.force[in_range], bins=400, log=True
        )
        text = celsius(test.specimen.temperature or 0.0).replace("deg", "°")
        marks.append(Line(x, y, Pen(colour, 3.2), text))
        fitted_time, force = fitted_force(fit, test)
        is_shown = fitted_time >= shortest
        x, y = downsample_to_extremes(fitted_time[is_shown], force[is_shown], bins=400, log=True)
        marks.append(Line(x, y, Pen("fit", 1.2), "" if shown_forces else "one model"))
        shown_forces.append(y)
    axes = (
        Scale(TIME_LABEL, (shortest, longest), log=True),
        Scale("force, N", compute_padded_limits(*shown_forces)),
    )
    force_panel = Panel(*axes, tuple(marks), height=240)
    caption = (
        "One model at several temperatures: the force of each test, that of the model, and "
        "the shift factors of time with two standard errors."
    )
    strips = ((force_panel,), (shift_panel(fit.temperatures),))
    return Picture("temperatures", caption, strips, 2, stamp or format_fit_stamp(fit), width=860.0)
