"""Figure of stiffness and loss factor over frequency, with the requested frequencies."""

from __future__ import annotations

from dashpot.base import replace
from dashpot.extensions.dynamic_stiffness.prediction import StiffnessPrediction
from dashpot.plot.picture import REF, Panel, Picture, Rule


def draw_stiffness_prediction(prediction: StiffnessPrediction, *, stamp: str = "") -> Picture:
    """Return stiffness and loss factor over frequency, with the requested frequencies.

    Parameters
    ----------
    prediction : StiffnessPrediction
    stamp : str
        Origin of the figure; by default the files of the fit.
    """
    picture: Picture = prediction.fit.plot()
    strips = tuple(
        tuple(_mark_frequencies(panel, prediction.frequencies) for panel in strip)
        for strip in picture.strips
    )
    return replace(picture, strips=strips, stamp=stamp or picture.stamp)


def _mark_frequencies(panel: Panel, frequencies: tuple[float, ...]) -> Panel:
    low, high = panel.x.limits
    frequency_rules = tuple(Rule(f, REF, "requested") for f in frequencies if low <= f <= high)
    return replace(panel, marks=(*panel.marks, *frequency_rules))
