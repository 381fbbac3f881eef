from dashpot.engine.sums import exponential_sum as exponential_sum
from dashpot.fitting.spectrum import dynamic_master_curve as dynamic_master_curve
from dashpot.fitting.spectrum import master_curve as master_curve
from dashpot.fitting.superposition.superpose import superpose as superpose
from dashpot.records.superposition import Superposition as Superposition

from . import friction as friction
from . import networks as networks
from . import stiffening as stiffening
from .elastic import ElasticLaw as ElasticLaw
from .elastic import compare_with_curve as compare_with_curve
from .fractional import FractionalZener as FractionalZener
from .hyperelastic import Hyperelastic as Hyperelastic
from .maxwell import GeneralizedMaxwell as GeneralizedMaxwell
from .parallel import Parallel as Parallel
from .temperature import WLF as WLF
from .temperature import Arrhenius as Arrhenius
from .temperature import FreeShifts as FreeShifts
