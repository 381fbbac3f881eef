from dashpot.datamodel.relaxation import (
    Trajectory as Trajectory,
)
from dashpot.extensions import acquisition as _acquisition
from dashpot.extensions.acceptance.accept import read_limits as read_limits
from dashpot.extensions.curves.superposition.read_shift_factors import read_shifts as read_shifts
from dashpot.extensions.formats.write_uff import (
    frf_uff as frf_uff,
)
from dashpot.extensions.systems.door.read_modes import read_modes as read_modes
from dashpot.reading.read_options import ReadOptions as ReadOptions
from dashpot.reading.read_options import dump_profile as dump_profile
from dashpot.reading.read_options import load_profile as load_profile
from dashpot.reading.readers.relaxation import (
    read_trajectory as read_trajectory,
)
from dashpot.reading.write import write_frf as write_frf
from dashpot.reading.write import write_impact as write_impact
from dashpot.reading.write import write_relaxation as write_relaxation
from dashpot.reading.write import write_trajectory as write_trajectory
from dashpot.simulation.robot import (
    planned_trajectory as planned_trajectory,
)
from dashpot.workflow.json_archive import from_json as from_json
from dashpot.workflow.json_archive import to_json as to_json

acquisition = _acquisition
