"""Results to figures: functions from results to a `Picture`, and writers of pictures.

A :class:`~dashpot.plot.picture.Picture` is a frozen value, what is drawn before anything draws it.
:func:`save` writes it as SVG, PNG or PDF; :func:`to_svg` gives the text of the first,
:func:`to_figure` a :class:`matplotlib.figure.Figure`. matplotlib is loaded for PNG and PDF only.
"""

from dashpot.plot.bench import bench
from dashpot.plot.bitmap import to_figure
from dashpot.plot.cld import cld
from dashpot.plot.closing import closing
from dashpot.plot.columns import columns
from dashpot.plot.creep import creep
from dashpot.plot.direct import dynamic_stiffness
from dashpot.plot.door import door
from dashpot.plot.files import rendered, save
from dashpot.plot.hyperelastic import hyperelastic
from dashpot.plot.impact import hits
from dashpot.plot.indentation import indentation
from dashpot.plot.level import amplitude_sweep, frfs_at_levels, level, loops
from dashpot.plot.modal import several_masses, stabilisation
from dashpot.plot.modulus import modulus
from dashpot.plot.overview import hero
from dashpot.plot.picture import Picture
from dashpot.plot.relaxation import fit, segments
from dashpot.plot.rod import rod
from dashpot.plot.solid import elastic_law, spectrum, stiffness
from dashpot.plot.stamps import stamp
from dashpot.plot.superposition import superposition
from dashpot.plot.svg import whole as to_svg
from dashpot.plot.temperatures import temperatures
from dashpot.plot.vibration import comparison, frf, nyquist, resonance

__all__ = [
    "Picture",
    "amplitude_sweep",
    "bench",
    "cld",
    "closing",
    "columns",
    "comparison",
    "creep",
    "door",
    "dynamic_stiffness",
    "elastic_law",
    "fit",
    "frf",
    "frfs_at_levels",
    "hero",
    "hits",
    "hyperelastic",
    "indentation",
    "level",
    "loops",
    "modulus",
    "nyquist",
    "rendered",
    "resonance",
    "rod",
    "save",
    "segments",
    "several_masses",
    "spectrum",
    "stabilisation",
    "stamp",
    "stiffness",
    "superposition",
    "temperatures",
    "to_figure",
    "to_svg",
]
