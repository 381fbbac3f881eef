"""Figure of a relaxation modulus: data, fit and residual."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.datamodel.fit import Fit
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.plot.picture import FIT, REF, Dots, Line, Panel, Picture, Rule, Scale
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    compute_padded_log_limits,
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
        What the figure says of its origin; by default the fit's files, specimen and date.
    """
    panels = answer_panels(
        data.time, data.modulus, answer=fit.solid.relaxation, unit=data.unit,
        name="relaxation modulus", axis=TIME,
    )  # fmt: skip
    caption = "Relaxation modulus: measured, the fit to it, and what that leaves."
    return Picture("modulus", caption, (panels,), 1, stamp or format_fit_stamp(fit))


def answer_panels(
    time: FloatArray,
    values: FloatArray,
    *,
    answer: Callable[[FloatArray], FloatArray],
    unit: str,
    name: str,
    axis: str,
) -> tuple[Panel, Panel]:
    """The answer to a step over log time with that of a solid, and the residual in per cent."""
    word, scale = read_as(unit)
    certain = time > 0
    t, measured = time[certain], scale * values[certain]
    dense = np.geomspace(t[0], t[-1], 300)
    curve = scale * answer(dense)
    residual = 100 * (measured / (scale * answer(t)) - 1)
    across = Scale(axis, (float(t[0]), float(t[-1])), log=True)
    upper = Panel(
        across, Scale(f"{name}, {word}", compute_padded_log_limits(measured, curve), log=True),
        (Line(dense, curve, FIT, "fit"), Dots(t, measured, "measured", "measured")),
        height=240,
    )  # fmt: skip
    lower = Panel(
        across, Scale("residual, %", compute_padded_limits(residual, np.zeros(1), margin=0.1)),
        (Rule(0.0, REF, across=True), Dots(t, residual, "fit")),
        height=90, note=f"rms {round_to_error(float(np.sqrt(np.mean(residual**2))))} %",
    )  # fmt: skip
    return upper, lower
