from collections.abc import Callable

from dashpot.report.study_figure import hero as hero

from .figure_files import render_figure as render_figure
from .figure_files import save as save
from .figure_files import to_figure as to_figure
from .frf_figure import comparison as comparison
from .frf_figure import frf as frf
from .frf_figure import nyquist as nyquist
from .frf_figure import resonance as resonance
from .picture import Picture as Picture
from .plotted_data import stamp as stamp
from .records import columns as columns
from .records import hits as hits
from .relaxation import bench as bench
from .relaxation import fit as fit
from .relaxation import segments as segments
from .solid import dynamic_stiffness as dynamic_stiffness
from .solid import elastic_law as elastic_law
from .solid import spectrum as spectrum
from .solid import stiffness as stiffness
from .svg import to_svg as to_svg

def __getattr__(name: str) -> Callable[..., Picture]: ...
