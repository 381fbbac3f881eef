"""Demonstration seals: Table 1 of the paper, and two with arms hidden from a hold."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF

PAPER = GeneralizedMaxwell(k_inf=196.5, k=(117.5, 17.8), tau=(59.0 / 117.5, 292.2 / 17.8))
"""Table 1 at 8 mm, N/m and s: 0.1965, 0.1175, 0.0178 N/mm, 0.0590 and 0.2922 N s/mm.

It has no damping to speak of at 12.71 Hz.
"""


BROAD = PAPER + GeneralizedMaxwell(k_inf=0.0, k=(20.0, 20.0, 20.0), tau=(0.08, 0.016, 0.0032))
"""Table 1 with three fast arms: relaxes like the paper's seal, damps like a sponge."""


HIDDEN = PAPER + GeneralizedMaxwell(k_inf=0.0, k=(50.0,), tau=(0.0125,))
"""Table 1 with the one arm that the paper supposes: where the hammer feels it most."""


PAPER_MASS = 0.1040426
"""Block, kg, that puts the accelerance peak of two paper seals at 12.71 Hz."""


BROAD_MASS = 0.114829829
"""Block, kg, that puts the accelerance peak of two broad seals at 12.71 Hz."""


HIDDEN_MASS = 0.11260495596
"""Block, kg, with an accelerance peak at 12.71 Hz on two such seals."""


SEALS: Mapping[str, tuple[GeneralizedMaxwell, float]] = MappingProxyType(
    {"paper": (PAPER, PAPER_MASS), "broad": (BROAD, BROAD_MASS), "hidden": (HIDDEN, HIDDEN_MASS)}
)
"""Each demonstration seal by name: one seal, and the block on two of them."""


SHIFT = WLF.universal(glass=218.15, reference=296.15)
"""How the demonstration seals move with temperature: the universal WLF law of a rubber whose glass
transition lies at -55 degC, referred to 23 degC; C_1 = 6.9437, C_2 = 129.6 K."""
