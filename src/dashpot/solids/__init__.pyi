from dashpot.extensions.amplitude import friction as friction
from dashpot.extensions.amplitude import nonlinear_springs as nonlinear_springs
from dashpot.extensions.amplitude.polynomial_law import PolynomialLaw as PolynomialLaw
from dashpot.extensions.curves.datamodel.superposition import Superposition as Superposition
from dashpot.extensions.curves.relaxation_spectrum import (
    dynamic_master_curve as dynamic_master_curve,
)
from dashpot.extensions.curves.relaxation_spectrum import master_curve as master_curve
from dashpot.extensions.curves.superposition.superpose import superpose as superpose
from dashpot.extensions.depths.curve_agreement import compare_with_curve as compare_with_curve
from dashpot.extensions.materials.hyperelastic.strain_energy import Hyperelastic as Hyperelastic
from dashpot.extensions.paper.exponential_sum import (
    exponential_sum as exponential_sum,
)

from . import networks as networks
from .elastic import ElasticLaw as ElasticLaw
from .fractional import FractionalZener as FractionalZener
from .maxwell import GeneralizedMaxwell as GeneralizedMaxwell
from .maxwell import Parallel as Parallel
from .shift_laws import WLF as WLF
from .shift_laws import Arrhenius as Arrhenius
from .shift_laws import FreeShifts as FreeShifts
