"""Results to figures, in two layers: results to figures here, arrays to axes in `panels`.

Every function returns a :class:`matplotlib.figure.Figure` that no global state knows of;
:func:`save` writes it. matplotlib is loaded when the first figure is drawn.
"""

from dashpot.plot.files import rendered, save, to_svg
from dashpot.plot.impact import hits
from dashpot.plot.overview import hero
from dashpot.plot.relaxation import fit, segments
from dashpot.plot.solid import dynamic_stiffness, elastic_law, spectrum, stiffness
from dashpot.plot.vibration import comparison, frf, nyquist

__all__ = [
    "comparison",
    "dynamic_stiffness",
    "elastic_law",
    "fit",
    "frf",
    "hero",
    "hits",
    "nyquist",
    "rendered",
    "save",
    "segments",
    "spectrum",
    "stiffness",
    "to_svg",
]
