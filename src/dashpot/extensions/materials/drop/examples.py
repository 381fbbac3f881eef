"""Simulated example files: a mass dropped on a door seal."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.version import byline
from dashpot.extensions.materials.drop.motion import simulate_impacts
from dashpot.registry import Example
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.elastic import ElasticLaw

_DEPTH = 8e-3
_SEALS = 2
"""Number of specimens of 50 mm under the mass."""


def _simulate_record() -> str:
    """Return the force of 200 g at 0.3, 0.45 and 0.6 m/s on two seals, at 10 kHz with 1 % noise."""
    law, random = ElasticLaw.linear(BROAD.k_inf, _DEPTH), np.random.default_rng(1)
    force = []
    for speed in (0.3, 0.45, 0.6):
        (motion,) = simulate_impacts([_SEALS * BROAD], law, mass=0.2, speed=speed)
        time = np.arange(0.0, 0.6, 1e-4)
        interpolated = np.interp(
            time - 0.05, motion.time, np.maximum(motion.force, 0.0), left=0.0, right=0.0
        )
        force.append(
            interpolated + 0.01 * interpolated.max() * random.standard_normal(len(interpolated))
        )
    all_forces = np.concatenate(force)
    rows = (f"{1e-4 * i:.4f},{item:.5g}" for i, item in enumerate(all_forces.tolist()))
    header = [
        f"# {byline('simulated slams')}",
        "# simulated: slams of 200 g on 100 mm of seal, at 0.3, 0.45 and 0.6 m/s",
    ]
    return "\n".join([*header, "time [s],force [N]", *rows, ""])


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "slam.csv": Example(
            "drop",
            "200 g dropped on two such seals at 0.3, 0.45 and 0.6 m/s, for dashpot fit",
            _simulate_record,
        ),
    }
)
"""Example files by their names."""
