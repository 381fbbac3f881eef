"""Simulated example file: a seal at three compressions and three amplitudes."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.version import byline
from dashpot.registry import Example
from dashpot.solids.demo_seals import PAPER

_COMPRESSIONS, _AMPLITUDES = (4.0, 6.0, 8.0), (0.05, 0.1, 0.2, 0.4)
"""mm."""
_LINEAR, _DEPTH = 0.15, 8.0
"""Slope of the cubic law at no compression, N/mm, and the depth of the paper, mm."""
_LOST, _HALF, _EXPONENT = 0.2, 0.15, 0.5
_SCATTER = 2e-3


def _write_preload_map() -> str:
    """Return the paper's seal with a cubic law of stiffness and Kraus's softening, as a table."""
    random = np.random.default_rng(49)
    frequency = np.geomspace(1.0, 50.0, 16)
    solid = PAPER.complex_stiffness(omega=2 * np.pi * frequency)
    cubic = (PAPER.k_inf / 1e3 - _LINEAR) / _DEPTH**2
    lines = [f"# {byline('simulated dynamic tests of one seal')}", "# simulated"]
    lines.append(
        "compression [mm],amplitude [mm],frequency [Hz],storage stiffness [N/mm],loss factor"
    )
    for c in _COMPRESSIONS:
        tangent = (_LINEAR + 3 * cubic * c**2) / PAPER.k_inf
        for X in _AMPLITUDES:
            u = (X / _HALF) ** _EXPONENT
            part = 1 - _LOST * u**2 / (1 + u**2)
            softening_factor = part + 2j * _LOST * _EXPONENT / np.pi * u / (1 + u**2)
            error = random.standard_normal(16) + 1j * random.standard_normal(16)
            value = tangent * solid * softening_factor * np.exp(_SCATTER * error)
            rows = zip(frequency, value.real, value.imag / value.real, strict=True)
            lines += [f"{c:g},{X:g},{f:.4f},{k:.6f},{eta:.6f}" for f, k, eta in rows]
    return "\n".join([*lines, ""])


EXAMPLES: Mapping[str, Example] = MappingProxyType({
    "preload_map.csv": Example(
        "preload-map", "storage and loss of a seal at three compressions, four amplitudes",
        _write_preload_map,
    ),
})  # fmt: skip
