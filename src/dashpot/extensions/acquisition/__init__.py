"""Recording from an acquisition device, which is only read and never controlled."""

from dashpot.base.lazy import build_lazy_exports

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
