"""Figures of slam tests."""

from __future__ import annotations

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.extensions.materials.slam.datamodel import SlamFit
from dashpot.extensions.materials.slam.prediction import Slam
from dashpot.plot.picture import BENEATH, FIT, PREDICTED, UPON, Line, Panel, Picture, Scale
from dashpot.plot.plotted_data import stamp as format_stamp

_MOST = 6
"""Slams that a figure shows."""


def slams(slam_fit: SlamFit, *, stamp: str = "") -> Picture:
    """Return force of every slam over time: measured, and by the motion that was fitted.

    Parameters
    ----------
    slam_fit : SlamFit
    stamp : str
        What the figure says of its origin; by default the files.
    """
    panels = []
    for hit in slam_fit.hits[:_MOST]:
        ms = convert_to_unit(hit.time, "ms")
        top = 1.08 * float(hit.measured.max())
        marks = (
            Line(ms, hit.modelled, BENEATH, "fitted"),
            Line(ms, hit.measured, UPON, "measured"),
        )
        across = Scale("time from the touch, ms", (float(ms[0]), float(ms[-1])))
        title = f"{hit.speed.value:.3g} m/s"
        panels.append(Panel(across, Scale("force, N", (-0.08 * top, top)), marks, title=title))
    caption = "Force of impacts on a specimen over time: measured, and by the fitted motion."
    origin = format_stamp(slam_fit.sources) if slam_fit.sources else ""
    return Picture("slams", caption, tuple((panel,) for panel in panels), 3, stamp or origin)


def slam(slam: Slam, *, stamp: str = "") -> Picture:
    """Return force of a slam over time and over compression, beside the relaxed force.

    Parameters
    ----------
    slam : Slam
    stamp : str
        What the figure says of its origin; by default the files of the fit.
    """
    motion = slam.motion
    ms, mm = convert_to_unit(motion.time, "ms"), convert_to_unit(motion.compression, "mm")
    up = Scale("force, N", (0.0, 1.08 * float(motion.force.max())))
    whole = Panel(
        Scale("time, ms", (0.0, float(ms[-1]))),
        up,
        (Line(ms, np.maximum(motion.force, 0.0), PREDICTED, "predicted"),),
    )
    rising = slice(0, int(motion.compression.argmax()) + 1)
    loop = Panel(
        Scale("compression, mm", (0.0, 1.05 * float(mm.max()))),
        up,
        (
            Line(mm, np.maximum(motion.force, 0.0), PREDICTED, "predicted"),
            Line(mm[rising], motion.relaxed[rising], FIT, "relaxed"),
        ),
    )
    caption = "Force of a mass dropped on the specimen, over time and over compression."
    origin = format_stamp(slam.sources) if slam.sources else ""
    return Picture("slam", caption, ((whole,), (loop,)), 2, stamp or origin)
