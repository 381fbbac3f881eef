from dashpot.export import UNIT_SYSTEMS as UNIT_SYSTEMS
from dashpot.export import deck_for as deck_for
from dashpot.extensions.amplitude.fit_files import Levels as Levels
from dashpot.extensions.amplitude.fit_files import level_files as level_files
from dashpot.extensions.door.analyse_file import DoorResult as DoorResult
from dashpot.extensions.door.analyse_file import door_file as door_file
from dashpot.extensions.door.analyse_file import shear_of as shear_of
from dashpot.extensions.door.closing_from_file import ClosingResult as ClosingResult
from dashpot.extensions.door.read import read_door as read_door
from dashpot.extensions.materials.cld.datamodel import CLD as CLD
from dashpot.extensions.materials.cld.datamodel import RateLaw as RateLaw
from dashpot.extensions.materials.cld.datamodel import RelaxedLaw as RelaxedLaw
from dashpot.extensions.materials.cld.fit_files import Pieces as Pieces
from dashpot.extensions.materials.cld.fit_files import cld_files as cld_files
from dashpot.extensions.materials.hyperelastic.fit_files import (
    hyperelastic_files as hyperelastic_files,
)
from dashpot.extensions.materials.indentation.fit_files import indent_file as indent_file
from dashpot.extensions.materials.rod.fit_files import Rod as Rod
from dashpot.extensions.materials.rod.fit_files import rod_files as rod_files
from dashpot.extensions.materials.slam.fit_files import slam_files as slam_files
from dashpot.extensions.modes.mass_series_files import ModesByMass as ModesByMass
from dashpot.extensions.modes.mass_series_files import modes_by_mass as modes_by_mass
from dashpot.extensions.modes.measured_modes import MeasuredModes as MeasuredModes
from dashpot.extensions.modes.measured_modes import modes_files as modes_files
from dashpot.extensions.projects.project import create as create
from dashpot.extensions.projects.project import open_project as open_project
from dashpot.extensions.projects.project import record as record
from dashpot.extensions.projects.verification import (
    check_half_written_files as check_half_written_files,
)
from dashpot.extensions.projects.verification import verify as verify
from dashpot.fitting.uncertainty.prediction_bounds import unseen_arm_band as unseen_arm_band
from dashpot.planning.assumed_seal import SupposedSeal as SupposedSeal
from dashpot.planning.plan import plan as plan
from dashpot.planning.planned_ramp_hold import Bench as Bench
from dashpot.reading.readers.inspect import inspect_file as inspect_file
from dashpot.report import html as html
from dashpot.report.result_pages.solid_page import over_frequency as over_frequency

from .example_files import CAPTIONS as CAPTIONS
from .example_files import EXAMPLES as EXAMPLES
from .example_files import FIRST as FIRST
from .example_files import MASS as MASS
from .fit_bench_tests import fit_files as fit_files
from .fit_bench_tests import fit_fixed_order as fit_fixed_order
from .inspections import InspectedFile as InspectedFile
from .inspections import Inspections as Inspections
from .inspections import inspect_files as inspect_files
from .job import HammerChoices as HammerChoices
from .job import Job as Job
from .job import RodChoices as RodChoices
from .json_archive import to_document as to_document
from .json_files import format_unexpected_kind as format_unexpected_kind
from .json_files import read_exported as read_exported
from .json_files import read_fit as read_fit
from .json_files import read_json_document as read_json_document
from .response.frf_prediction import Prediction as Prediction
from .response.frf_prediction import predict_files as predict_files
from .response.static_equilibrium import StaticEquilibrium as StaticEquilibrium
from .response.static_equilibrium import find_static_equilibrium as find_static_equilibrium
from .study import run as run
from .vibration.impact_tests import Agreement as Agreement
from .vibration.impact_tests import ImpactResult as ImpactResult
from .vibration.impact_tests import compare_files as compare_files
from .vibration.impact_tests import identify_files as identify_files
from .vibration.impact_tests import impact_files as impact_files
