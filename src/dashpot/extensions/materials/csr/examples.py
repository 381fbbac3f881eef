"""Simulated example files: specimens of a door seal in three ovens."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.units import parse_quantity
from dashpot.base.version import byline
from dashpot.extensions.materials.csr.law import AgingLaw
from dashpot.registry import Example

_LAW = AgingLaw(0.03, float(np.log(9e6)), 90e3, 1.0, 398.15, np.zeros((4, 4)), 0.0)
_HOURS = (0.5, 1, 2, 5, 10, 24, 48, 72, 168, 336, 500, 750, 1000)


def _write_ovens() -> str:
    """Return three specimens at 100, 125 and 150 degC: 3 % a decade, 90 kJ/mol; noise of 1 %."""
    random = np.random.default_rng(1)
    lines = [f"# {byline('simulated compression stress relaxation')}", "# simulated, method A"]
    lines.append("time [h],force [N],temperature [degC],piece")
    for number in range(9):
        oven, first = (100, 125, 150)[number // 3], 40 * (1 + 0.03 * random.standard_normal())
        for hours in _HOURS:
            remainder = _LAW.compute_retention(
                parse_quantity(f"{oven}degC", "temperature"), parse_quantity(f"{hours}h", "time")
            )
            force = first * remainder + 0.4 * random.standard_normal()
            lines.append(f"{hours:g},{force:.2f},{oven},{number + 1}")
    return "\n".join([*lines, ""])


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "ovens.csv": Example(
            "csr",
            "specimens of a seal squeezed in three ovens for 1000 h, for dashpot fit",
            _write_ovens,
        ),
    }
)
"""By their names."""
