"""Figures of drop tests."""

from __future__ import annotations

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.extensions.materials.drop.datamodel import DropFit
from dashpot.extensions.materials.drop.prediction import DropPrediction
from dashpot.plot.picture import DATA_ON_FIT, FIT, FIT_BAND, PREDICTED, Line, Panel, Picture, Scale
from dashpot.plot.plotted_data import stamp as format_stamp

_MAX_IMPACTS = 6
"""Largest number of impacts in a figure."""


def draw_drop_fit(drop_fit: DropFit, *, stamp: str = "") -> Picture:
    """Return the force of every impact over time, measured and fitted.

    Parameters
    ----------
    drop_fit : DropFit
    stamp : str
        Origin of the figure; by default the files.
    """
    panels = []
    for hit in drop_fit.hits[:_MAX_IMPACTS]:
        ms = convert_to_unit(hit.time, "ms")
        top = 1.08 * float(hit.measured.max())
        marks = (
            Line(ms, hit.modelled, FIT_BAND, "fitted"),
            Line(ms, hit.measured, DATA_ON_FIT, "measured"),
        )
        horizontal = Scale("time from the touch, ms", (float(ms[0]), float(ms[-1])))
        title = f"{hit.speed.value:.3g} m/s"
        panels.append(Panel(horizontal, Scale("force, N", (-0.08 * top, top)), marks, title=title))
    caption = "Force of impacts on a specimen over time: measured, and by the fitted motion."
    origin = format_stamp(drop_fit.sources) if drop_fit.sources else ""
    return Picture("slams", caption, tuple((panel,) for panel in panels), 3, stamp or origin)


def draw_drop_prediction(prediction: DropPrediction, *, stamp: str = "") -> Picture:
    """Return the predicted force over time and over compression, with the relaxed force.

    Parameters
    ----------
    prediction : DropPrediction
    stamp : str
        Origin of the figure; by default the files of the fit.
    """
    motion = prediction.motion
    ms, mm = convert_to_unit(motion.time, "ms"), convert_to_unit(motion.compression, "mm")
    up = Scale("force, N", (0.0, 1.08 * float(motion.force.max())))
    force_panel = Panel(
        Scale("time, ms", (0.0, float(ms[-1]))),
        up,
        (Line(ms, np.maximum(motion.force, 0.0), PREDICTED, "predicted"),),
    )
    loading = slice(0, int(motion.compression.argmax()) + 1)
    loop = Panel(
        Scale("compression, mm", (0.0, 1.05 * float(mm.max()))),
        up,
        (
            Line(mm, np.maximum(motion.force, 0.0), PREDICTED, "predicted"),
            Line(mm[loading], motion.elastic_force[loading], FIT, "relaxed"),
        ),
    )
    caption = "Force of a mass dropped on the specimen, over time and over compression."
    origin = format_stamp(prediction.sources) if prediction.sources else ""
    return Picture("slam", caption, ((force_panel,), (loop,)), 2, stamp or origin)
