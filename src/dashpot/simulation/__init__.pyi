from .creep import simulate_creep as simulate_creep
from .impact import Hammer as Hammer
from .impact import simulate_impact as simulate_impact
from .relaxation import Climate as Climate
from .relaxation import Rig as Rig
from .relaxation import simulate_relaxation as simulate_relaxation
from .truth import stamp as stamp
from .truth import truth_json as truth_json
