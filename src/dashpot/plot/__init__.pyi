from collections.abc import Callable

from .bench_tests_figure import bench as bench
from .columns_figure import columns as columns
from .dynamic_stiffness_figure import dynamic_stiffness as dynamic_stiffness
from .figure_files import render_figure as render_figure
from .figure_files import save as save
from .frf_figure import comparison as comparison
from .frf_figure import frf as frf
from .frf_figure import nyquist as nyquist
from .frf_figure import resonance as resonance
from .impact import hits as hits
from .matplotlib_writer import to_figure as to_figure
from .overview import hero as hero
from .picture import Picture as Picture
from .provenance_stamp import stamp as stamp
from .relaxation import fit as fit
from .relaxation import segments as segments
from .solid import elastic_law as elastic_law
from .solid import spectrum as spectrum
from .solid import stiffness as stiffness
from .svg import to_svg as to_svg

def __getattr__(name: str) -> Callable[..., Picture]: ...
