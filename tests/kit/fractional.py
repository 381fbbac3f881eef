"""A solid that is no sum of arms: what takes any solid is tested with it."""

from __future__ import annotations

from dashpot.solids.fractional import FractionalZener

SEAL = FractionalZener(336.5, 196.5, 0.6, 0.6)
"""About as stiff as the paper's seal."""
