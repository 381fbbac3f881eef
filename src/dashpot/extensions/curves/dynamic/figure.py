"""Figure of a fit to a frequency sweep."""

from __future__ import annotations

from dashpot.datamodel.fit import Fit
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.plot.picture import Picture
from dashpot.plot.solid import stiffness


def draw_sweep(fit: Fit, data: DynamicTest) -> Picture:
    """Return the figure of a fit to a sweep of frequency."""
    return stiffness(fit, data=data)
