"""Reading an acquisition device while it measures; never moving anything."""

from dashpot.base.lazy import names_of

__getattr__, __dir__, __all__ = names_of(__name__, __file__)
