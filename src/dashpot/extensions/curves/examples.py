"""Simulated frequency sweeps of a seal, and of a rubber at several temperatures."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.registry import Example
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF


def _simulate_sweep() -> str:
    """Storage and loss of one seal as a dynamic testing machine writes them, with 0.5 % noise."""
    frequency = np.geomspace(0.01, 100.0, 41)
    stiffness = BROAD.complex_stiffness(omega=2 * np.pi * frequency)
    storage, loss = (convert_to_unit(part, "N/mm") for part in (stiffness.real, stiffness.imag))
    noise = 1 + 0.005 * np.random.default_rng(1).standard_normal((2, len(frequency)))
    rows = zip(frequency, storage * noise[0], loss * noise[1], strict=True)
    header = "frequency [Hz],storage stiffness [N/mm],loss stiffness [N/mm]"
    lines = [f"# {byline('simulated dynamic test')}", "# simulated", header]
    return "\n".join([*lines, *(",".join(f"{value:.6g}" for value in row) for row in rows), ""])


def _simulate_modulus() -> str:
    """A relaxation modulus of rubber over time, MPa, with 0.2 % noise."""
    time = np.geomspace(1e-3, 100.0, 61)
    modulus = BROAD.relaxation(time) * 1e-2
    noise = 1 + 0.002 * np.random.default_rng(1).standard_normal(len(time))
    rows = (f"{t:.6g},{e:.6g}" for t, e in zip(time, modulus * noise, strict=True))
    header = [f"# {byline('simulated relaxation modulus')}", "# simulated", "time [s],E(t) [MPa]"]
    return "\n".join([*header, *rows, ""])


def _simulate_sweeps() -> str:
    """Sweeps of a filled rubber at nine temperatures, MPa, with 0.5 % noise."""
    tau = np.logspace(-9, 3, 37)
    ratio = np.exp(-0.5 * ((np.log10(tau) + 4) / 2.2) ** 2)
    rubber = GeneralizedMaxwell(4.0, tuple(1500 * ratio / ratio.sum()), tuple(tau))
    law, draw_normal = WLF(7.0, 120.0, 296.15), np.random.default_rng(3).standard_normal
    frequency = np.geomspace(0.1, 20.0, 12)
    rows = []
    for celsius in range(-25, 56, 10):
        kelvin = celsius + 273.15
        solid = rubber.shift_to_temperature(float(law.a_t(kelvin)), kelvin / law.reference)
        value = solid.complex_stiffness(omega=2 * np.pi * frequency)
        value = value + 0.005 * np.abs(value) * (draw_normal(12) + 1j * draw_normal(12))
        rows += [
            f"{f:.6g},{v.real:.6g},{v.imag:.6g},{celsius + 0.05 * draw_normal():.2f}"
            for f, v in zip(frequency, value, strict=True)
        ]
    header = "frequency [Hz],storage modulus [MPa],loss modulus [MPa],temperature [degC]"
    return "\n".join([f"# {byline('simulated dynamic test')}", "# simulated", header, *rows, ""])


SWEEPS: Mapping[str, Example] = MappingProxyType(
    {
        "sweep.csv": Example(
            "dma",
            "storage and loss over frequency, as a dynamic testing machine writes them",
            _simulate_sweep,
        ),
        "sweeps.csv": Example(
            "dma",
            "such sweeps of a rubber at nine temperatures, for a master curve",
            _simulate_sweeps,
        ),
    }
)
"""Dynamic tests."""

CURVES: Mapping[str, Example] = MappingProxyType(
    {
        "curve.csv": Example("modulus", "a relaxation modulus over time", _simulate_modulus),
    }
)
"""Curves over time."""
