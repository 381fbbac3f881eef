"""Figure of a contact: record, fitted motion and residual."""

from __future__ import annotations

import numpy as np

from dashpot.base.number_format import round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.extensions.materials.indentation.datamodel import UNITS, IndentationFit
from dashpot.plot.picture import FIT, REF, Dots, Line, Panel, Picture, Rule, Scale, Span
from dashpot.plot.plotted_data import compute_padded_limits
from dashpot.plot.plotted_data import stamp as format_stamp


def indentation(fit: IndentationFit, *, stamp: str = "") -> Picture:
    """Return a contact over time with the fit to it, and the residual below.

    Parameters
    ----------
    fit : IndentationFit
    stamp : str
        Origin of the data, printed below the figure; by default the file.
    """
    t, unit = (
        convert_to_unit(fit.time, "ms"),
        "mm" if fit.quantity == "displacement" else UNITS[fit.quantity],
    )
    measured, modelled = convert_to_unit(fit.measured, unit), convert_to_unit(fit.modelled, unit)
    values, word = measured - modelled, unit.replace("^2", "²")
    horizontal = Scale("time since the touch, ms", (float(t[0]), float(t[-1])))
    contact = Span(0.0, convert_to_unit(fit.duration, "ms"), "fit", "in contact")
    upper = Panel(
        horizontal, Scale(f"{fit.quantity} (push > 0), {word}", compute_padded_limits(measured,
        modelled)),
        (
            contact, Dots(t, measured, "measured", "measured", size=2.5),
            Line(t, modelled, FIT, "fit"),
        ),
        height=240, note=fit.law,
    )  # fmt: skip
    lower = Panel(
        horizontal, Scale(f"residual, {word}", compute_padded_limits(values, np.zeros(1),
        margin=0.1)),
        (contact, Rule(0.0, REF, is_horizontal=True), Dots(t, values, "fit", size=2.5)),
        height=90, note=f"{round_to_error(100 * fit.residual)} % of the push in contact",
    )  # fmt: skip
    caption = "Motion of the indenter: recorded, by the contact law, and the residual."
    origin = format_stamp((fit.source,), mass=fit.indenter.mass) if fit.source else ""
    return Picture("indentation", caption, ((upper, lower),), 1, stamp or origin)
