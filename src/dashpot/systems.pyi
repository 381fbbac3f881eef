from dashpot.datamodel.seal_line import LineFriction as LineFriction
from dashpot.datamodel.seal_line import SealSection as SealSection
from dashpot.datamodel.seal_line import Shear as Shear
from dashpot.datamodel.structure import (
    FreeModes as FreeModes,
)
from dashpot.extensions.amplitude.preloaded_mass import PreloadedMass as PreloadedMass
from dashpot.extensions.amplitude.response_solver import response_at_level as response_at_level
from dashpot.extensions.door.closing import ClosingDoor as ClosingDoor
from dashpot.extensions.door.closing_analysis import Closing as Closing
from dashpot.extensions.door.closing_analysis import close_door as close_door
from dashpot.extensions.door.closing_setup import ClosingSetup as ClosingSetup
from dashpot.extensions.door.energy_shares import energy_shares as energy_shares
from dashpot.extensions.door.seal_line import (
    Joint as Joint,
)
from dashpot.extensions.door.seal_line import (
    SealLine as SealLine,
)
from dashpot.extensions.modes.stabilisation import stabilisation as stabilisation
from dashpot.extensions.random_vibration.base_response import random_base as random_base
from dashpot.extensions.random_vibration.base_response import random_response as random_response
from dashpot.solids.part_geometry import Block as Block
from dashpot.solids.part_geometry import Bulb as Bulb
from dashpot.solids.part_geometry import Bush as Bush
from dashpot.solids.part_geometry import Disc as Disc
from dashpot.vibration.comparison.compare import infer_mass as infer_mass
from dashpot.vibration.modal.pole_fit import (
    mac as mac,
)
from dashpot.vibration.systems.frf_prediction import isolation_frequency as isolation_frequency
from dashpot.vibration.systems.frf_prediction import predict_frf as predict_frf
from dashpot.vibration.systems.multibody import (
    Body as Body,
)
from dashpot.vibration.systems.multibody import (
    Mount as Mount,
)
from dashpot.vibration.systems.multibody import (
    System as System,
)
from dashpot.vibration.systems.multibody import (
    planar_body as planar_body,
)
from dashpot.vibration.systems.multibody import (
    point_mass as point_mass,
)
