"""Viscoelastic solids from vibration, alone or together with relaxation."""

from dashpot.identification.identify import identify

__all__ = ["identify"]
