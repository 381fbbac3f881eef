from dashpot.datamodel.seal_line import LineFriction as LineFriction
from dashpot.datamodel.seal_line import SealSection as SealSection
from dashpot.datamodel.seal_line import Shear as Shear
from dashpot.extensions.amplitude.preloaded_mass import PreloadedMass as PreloadedMass
from dashpot.extensions.modes.stabilisation import stabilisation as stabilisation
from dashpot.extensions.preload_map.fit import fit_preload_map as fit_preload_map
from dashpot.extensions.preload_map.preload_map import PreloadMap as PreloadMap
from dashpot.extensions.preload_map.preload_sweep import PreloadSweep as PreloadSweep
from dashpot.extensions.systems.base_response import random_base as random_base
from dashpot.extensions.systems.base_response import random_response as random_response
from dashpot.extensions.systems.door.closing import ClosingDoor as ClosingDoor
from dashpot.extensions.systems.door.closing_analysis import ClosingAnalysis as ClosingAnalysis
from dashpot.extensions.systems.door.closing_analysis import close_door as close_door
from dashpot.extensions.systems.door.closing_setup import ClosingSetup as ClosingSetup
from dashpot.extensions.systems.door.energy_shares import energy_shares as energy_shares
from dashpot.extensions.systems.door.leak_result import LeakResult as LeakResult
from dashpot.extensions.systems.door.leak_setup import LeakSetup as LeakSetup
from dashpot.extensions.systems.door.leak_setup import LeakState as LeakState
from dashpot.extensions.systems.door.seal_line import (
    Joint as Joint,
)
from dashpot.extensions.systems.door.seal_line import (
    SealLine as SealLine,
)
from dashpot.extensions.systems.free_modes import (
    FreeModes as FreeModes,
)
from dashpot.extensions.systems.level_response import (
    response_at_level as response_at_level,
)
from dashpot.extensions.systems.multibody import (
    Body as Body,
)
from dashpot.extensions.systems.multibody import (
    Mount as Mount,
)
from dashpot.extensions.systems.multibody import (
    System as System,
)
from dashpot.extensions.systems.multibody import (
    planar_body as planar_body,
)
from dashpot.extensions.systems.multibody import (
    point_mass as point_mass,
)
from dashpot.extensions.transfer_stiffness.stiffness_sheet import (
    TransferStiffness as TransferStiffness,
)
from dashpot.extensions.transfer_stiffness.transfer_methods import (
    compute_transfer_stiffness as compute_transfer_stiffness,
)
from dashpot.solids.part_geometry import Block as Block
from dashpot.solids.part_geometry import Bulb as Bulb
from dashpot.solids.part_geometry import Bush as Bush
from dashpot.solids.part_geometry import Disc as Disc
from dashpot.vibration.comparison.compare import infer_mass as infer_mass
from dashpot.vibration.mass_on_seals import (
    isolation_frequency as isolation_frequency,
)
from dashpot.vibration.mass_on_seals import (
    predict_frf as predict_frf,
)
from dashpot.vibration.modal.pole_fit import (
    mac as mac,
)
