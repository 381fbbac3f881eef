"""Simulated tests of known seals: the virtual rig and the virtual hammer."""

from dashpot.base.lazy import build_lazy_exports

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
