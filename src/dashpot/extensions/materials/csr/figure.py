"""Figure of an aging law: F/F0 over time in every oven."""

from __future__ import annotations

import numpy as np

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.law import FIRST
from dashpot.extensions.materials.csr.lifetime_prediction import Aged
from dashpot.plot.picture import FIT, PREDICTED, Area, Dots, Line, Panel, Picture, Scale
from dashpot.plot.plotted_data import stamp as format_stamp


def csr(aging: Aging, *, stamp: str = "") -> Picture:
    """Return the retained force of every specimen over time and the aging law, a panel an oven.

    Parameters
    ----------
    aging : Aging
    stamp : str
        What the figure says of its origin; by default the files.
    """
    time = np.geomspace(FIRST, aging.longest, 200)
    hours = convert_to_unit(time, "h")
    across = Scale("time, h", (float(hours[0]) / 1.3, float(hours[-1]) * 1.3), log=True)
    least = min(float(oven.retained.min()) for oven in aging.ovens)
    up = Scale("F/F0, %", (max(100 * least - 5, 0.0), 105.0))
    panels = []
    for item in aging.ovens:
        values = np.array([aging.law.compute_retention(item.temperature, entry) for entry in time])
        dots = Dots(convert_to_unit(item.time, "h"), 100 * item.retained, "measured", "measured")
        marks = (Line(hours, 100 * values, FIT, "law"), dots)
        panels.append(Panel(across, up, marks, title=format_quantity(item.temperature, "°C")))
    caption = "Retained force of the specimens in each oven: measured, and by the aging law."
    origin = format_stamp(aging.sources) if aging.sources else ""
    return Picture("csr", caption, tuple((panel,) for panel in panels), 3, stamp or origin)


def draw_aged_force(prediction: Aged, *, stamp: str = "") -> Picture:
    """Return the predicted force at a temperature over time, with its 95 % interval.

    Parameters
    ----------
    prediction : Aged
    stamp : str
        What the figure says of its origin; by default the files.
    """
    law, kelvin = prediction.aging.law, prediction.temperature
    law = law.lower_limit() if law.bound_alone else law
    time = np.geomspace(FIRST, prediction.furthest, 200)
    values = np.array([law.compute_retention(kelvin, item) for item in time])
    errors = [law.error_of(lambda it: it.compute_retention(kelvin, at)) for at in time]  # noqa: B023
    reference = np.array(errors)
    half = 100 * law.quantile * np.where(np.isfinite(reference), reference, 0.0)
    hours = convert_to_unit(time, "h")
    measured = time <= prediction.aging.longest
    marks = (
        Area(hours, 100 * values - half, 100 * values + half, "fit", "95 % interval"),
        Line(hours, 100 * values, PREDICTED, "beyond the last reading"),
        Line(hours[measured], 100 * values[measured], FIT, "law"),
    )
    across = Scale("time, h", (float(hours[0]), float(hours[-1])), log=True)
    up = Scale("F/F0, %", (max(100 * float(values.min()) - 10, 0.0), 105.0))
    title = format_quantity(kelvin, "°C") + (", at least" if law.bound_alone else "")
    caption = "Force that is left over time at one temperature, with its 95 % interval."
    origin = format_stamp(prediction.aging.sources) if prediction.aging.sources else ""
    panel = Panel(across, up, marks, title=title, height=240)
    return Picture("aged", caption, ((panel,),), 1, stamp or origin)
