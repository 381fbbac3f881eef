"""Reading an acquisition device while it measures; never moving anything."""

from dashpot.base.lazy import build_lazy_exports

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
