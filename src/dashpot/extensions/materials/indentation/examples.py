"""Simulated example files: a ball dropped on rubber."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.units import GRAVITY
from dashpot.base.version import byline
from dashpot.extensions.materials.indentation.collision import collide
from dashpot.extensions.materials.indentation.contact_law import ViscousContact, sphere_stiffness
from dashpot.registry import Example


def _simulate_hit() -> str:
    """A steel ball of 5 g on rubber, its acceleration at 100 kHz, 0.5 % noisy, with an offset."""
    law = ViscousContact(sphere_stiffness(4e6, 5e-3), 1e-4)
    collision = collide(law, mass=5e-3, velocity=1.0, acceleration=GRAVITY)
    time = np.arange(600) * 1e-5
    interpolated = np.interp(
        time - 2e-3, collision.time, collision.force / collision.mass, left=0.0, right=0.0
    )
    interpolated += 3.0 + 0.005 * interpolated.max() * np.random.default_rng(1).standard_normal(
        len(time)
    )
    rows = (f"{t:.5f},{a:.5g}" for t, a in zip(time, -interpolated, strict=True))
    header = [
        f"# {byline('simulated indentation')}",
        "# simulated",
        "# indenter of 5 g, radius 5 mm",
    ]
    return "\n".join([*header, "time [s],acceleration [m/s^2]", *rows, ""])


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "hit.csv": Example(
            "indentation",
            "a ball of 5 g, radius 5 mm, dropped 51 mm on rubber, for dashpot fit",
            _simulate_hit,
        ),
    }
)
"""Example files by their names."""
