from dashpot.extensions.curves.creep.simulation import simulate_creep as simulate_creep
from dashpot.extensions.gauges.transducer import Daq as Daq
from dashpot.extensions.gauges.transducer import Instrument as Instrument

from .ground_truth import stamp as stamp
from .ground_truth import truth_json as truth_json
from .impact import Hammer as Hammer
from .impact import simulate_impact as simulate_impact
from .relaxation import simulate_motion as simulate_motion
from .relaxation import simulate_relaxation as simulate_relaxation
from .rig_errors import Climate as Climate
from .rig_errors import Rig as Rig
