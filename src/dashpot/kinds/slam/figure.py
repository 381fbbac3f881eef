"""Figures of a mass slammed on a piece."""

from __future__ import annotations

import numpy as np

from dashpot.base.units import in_unit
from dashpot.kinds.slam.predicted import Slam
from dashpot.plot.picture import FIT, PREDICTED, Line, Panel, Picture, Scale
from dashpot.plot.stamps import stamp as stamped


def slam(found: Slam, *, stamp: str = "") -> Picture:
    """Force of a slam over time and over compression, beside the relaxed force.

    Parameters
    ----------
    found : Slam
    stamp : str
        What the figure says of its origin; by default the files of the fit.
    """
    motion = found.motion
    ms, mm = in_unit(motion.time, "ms"), in_unit(motion.compression, "mm")
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
    caption = "Force of a mass slammed on the piece, over time and over compression."
    origin = stamped(found.sources) if found.sources else ""
    return Picture("slam", caption, ((whole,), (loop,)), 2, stamp or origin)
