"""dashpot: from the relaxation test of a seal to a validated vibration model."""

from dashpot._version import __version__

__all__ = ["__version__"]
