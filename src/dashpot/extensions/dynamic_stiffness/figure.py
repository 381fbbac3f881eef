"""Figure of stiffness and loss factor over frequency, with the frequencies that were asked."""

from __future__ import annotations

from dashpot.base import replace
from dashpot.extensions.dynamic_stiffness.prediction import StiffnessPrediction
from dashpot.plot.picture import Picture


def draw_stiffness_prediction(prediction: StiffnessPrediction, *, stamp: str = "") -> Picture:
    """Return stiffness and loss factor of the fit over frequency.

    Parameters
    ----------
    prediction : StiffnessPrediction
    stamp : str
        Origin of the figure; by default the files of the fit.
    """
    picture: Picture = prediction.fit.plot()
    return replace(picture, stamp=stamp) if stamp else picture
