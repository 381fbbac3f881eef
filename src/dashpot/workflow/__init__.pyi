from dashpot.export import UNIT_SYSTEMS as UNIT_SYSTEMS
from dashpot.export import deck_for as deck_for
from dashpot.fitting.prediction_bounds import (
    unresolved_arm_band as unresolved_arm_band,
)
from dashpot.planning.assumed_seal import AssumedSeal as AssumedSeal
from dashpot.planning.plan import plan as plan
from dashpot.planning.planned_ramp_hold import Bench as Bench
from dashpot.reading.readers.inspect import inspect_file as inspect_file
from dashpot.report import html as html
from dashpot.report.solid_and_frf_pages import (
    over_frequency as over_frequency,
)

from .bench_tests import fit_files as fit_files
from .bench_tests import fit_fixed_order as fit_fixed_order
from .example_files import CAPTIONS as CAPTIONS
from .example_files import EXAMPLES as EXAMPLES
from .example_files import FIRST as FIRST
from .example_files import MASS as MASS
from .frf_comparison import FRFComparison as FRFComparison
from .frf_comparison import compare_files as compare_files
from .frf_prediction import Prediction as Prediction
from .frf_prediction import predict_files as predict_files
from .identification import identify_files as identify_files
from .inspections import InspectedFile as InspectedFile
from .inspections import Inspections as Inspections
from .inspections import inspect_files as inspect_files
from .job import HammerChoices as HammerChoices
from .job import Job as Job
from .json_archive import format_unexpected_kind as format_unexpected_kind
from .json_archive import read_exported as read_exported
from .json_archive import read_fit as read_fit
from .json_archive import read_json_document as read_json_document
from .json_archive import to_document as to_document
from .measured_frf import ImpactResult as ImpactResult
from .measured_frf import impact_files as impact_files
from .stiffness_under_mass import StaticEquilibrium as StaticEquilibrium
from .stiffness_under_mass import find_static_equilibrium as find_static_equilibrium
from .study import run as run
