"""Simulated example files: a rubber cylinder that vibrates under a mass."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.version import byline
from dashpot.extensions.materials.rod.wave_equation import rod_transmissibility
from dashpot.registry import Example
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.part_geometry import Disc


def _simulate_rod() -> str:
    """T of a rubber cylinder, 20 mm by 20 mm and 6.283 g, under 31.4 g; 0.5 % noisy."""
    part, density = Disc(20e-3, 20e-3), 1000.0
    frequency = np.arange(20.0, 600.0, 1.0)
    rubber = GeneralizedMaxwell(0.8e6, (0.15e6, 0.15e6, 0.4e6), (1e-2, 1e-3, 1e-4))
    bonded = part.factor() * part.height / part.area
    T = rod_transmissibility(
        frequency,
        bonded * rubber.complex_stiffness(frequency=frequency),
        length=part.height,
        density=density,
        mass_ratio=31.4e-3 / (density * part.area * part.height),
    )
    draw = np.random.default_rng(1).standard_normal
    T = T * (1 + 0.005 * (draw(len(T)) + 1j * draw(len(T))))
    rows = zip(frequency, np.abs(T), np.degrees(np.angle(T)), np.full(len(T), 0.9999), strict=True)
    header = "frequency [Hz],transmissibility magnitude [g/g],phase [deg],coherence"
    lines = [f"# {byline('simulated transmissibility')}", "# simulated", header]
    return "\n".join([*lines, *(",".join(f"{value:.6g}" for value in row) for row in rows), ""])


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "rod.csv": Example(
            "transmissibility",
            "the transmissibility of a rubber cylinder to a mass on it, for dashpot fit",
            _simulate_rod,
        ),
    }
)
"""Example files by their names."""
