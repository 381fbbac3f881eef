"""The two demonstration seals: the paper's, and one with the fast arms that a hold cannot see."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.table1 import TABLE_1

PAPER = TABLE_1
"""Table 1 of the paper at 8 mm, N/m and s: no damping to speak of at 12.71 Hz."""

BROAD = PAPER + GeneralizedMaxwell(k_inf=0.0, k=(20.0, 20.0, 20.0), tau=(0.08, 0.016, 0.0032))
"""Table 1 with three fast arms: relaxes like the paper's seal, damps like a sponge."""

PAPER_MASS = 0.1040426
"""Block, kg, that puts the accelerance peak of two paper seals at 12.71 Hz."""

BROAD_MASS = 0.114829829
"""Block, kg, that puts the accelerance peak of two broad seals at 12.71 Hz."""

SEALS: Mapping[str, tuple[GeneralizedMaxwell, float]] = MappingProxyType(
    {"paper": (PAPER, PAPER_MASS), "broad": (BROAD, BROAD_MASS)}
)
"""Each demonstration seal by name: one seal, and the block that rests on two of them."""
