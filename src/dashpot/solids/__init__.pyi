from . import networks as networks
