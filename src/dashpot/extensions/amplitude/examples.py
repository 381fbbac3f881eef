"""Simulated example files: a seal with friction, moved and shaken at several amplitudes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.extensions.amplitude.friction import Iwan
from dashpot.registry import Example, require_handler
from dashpot.solids.demo_seals import BROAD, BROAD_MASS

_RUBBING = Iwan(120.0, 0.06)
"""Friction beside a seal, N/m and N: it softens with amplitude."""


def _simulate_loops() -> str:
    """Six cycles at each of nine amplitudes, 5 Hz, about a compression of 4 mm."""
    rate, cycles, hz = 250, 6, 5.0
    sizes = np.geomspace(5e-5, 3e-3, 9)
    time = np.arange(int(len(sizes) * cycles / hz * rate)) / rate
    size = sizes[np.minimum((time * hz / cycles).astype(int), len(sizes) - 1)]
    x = size * np.sin(2 * np.pi * hz * time)
    noise = 3e-4 * np.random.default_rng(1).standard_normal(len(time))
    force = (BROAD + _RUBBING).path_force(time, x) + 1.2 + noise
    rows = (
        f"{t:.6g},{d:.6g},{f:.6g}"
        for t, d, f in zip(time, convert_to_unit(x + 4e-3, "mm"), force, strict=True)
    )
    header = [
        f"# {byline('simulated loops')}",
        "# simulated",
        "time [s],displacement [mm],force [N]",
    ]
    return "\n".join([*header, *rows, ""])


def _make_frf_writer(level: float, seed: int) -> Callable[[], str]:
    """The FRF of the block on two seals that rub, under a force of that amplitude, 0.5 % noisy."""

    def render_file() -> str:
        sweep = require_handler("sweep at level", "mass")
        frf = sweep(
            2 * BROAD, 2 * _RUBBING,
            mass=round(BROAD_MASS, 4), level=level, frequency=np.linspace(8, 20, 97),
        ).frf()  # fmt: skip
        draw = np.random.default_rng(seed).standard_normal
        value = frf.value * (1 + 0.005 * (draw(97) + 1j * draw(97)))
        rows = zip(frf.frequency, value.real, value.imag, strict=True)
        header = "frequency [Hz],real [(m/s^2)/N],imaginary [(m/s^2)/N]"
        lines = [f"# {byline('simulated shaker test')}", "# simulated", header]
        return "\n".join([*lines, *(",".join(f"{item:.6g}" for item in row) for row in rows), ""])

    return render_file


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "loops.csv": Example(
            "cyclic",
            "a seal that rubs, moved to and fro at nine amplitudes, for dashpot fit",
            _simulate_loops,
        ),
        "shaker_20mN.csv": Example(
            "frf", "the mass on two such seals, on a shaker of 0.02 N", _make_frf_writer(0.02, 1)
        ),
        "shaker_500mN.csv": Example(
            "frf", "the same at 0.5 N: dashpot fit takes the two", _make_frf_writer(0.5, 2)
        ),
    }
)
"""Example files by their names."""
