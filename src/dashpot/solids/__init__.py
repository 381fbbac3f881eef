"""Viscoelastic solids and elements."""

from dashpot.base.lazy import build_lazy_exports

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
