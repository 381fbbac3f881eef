from . import friction as friction
from . import networks as networks
from . import stiffening as stiffening
