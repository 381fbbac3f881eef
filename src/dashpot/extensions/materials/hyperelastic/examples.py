"""Simulated example files: a rubber stretched in two modes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.extensions.materials.hyperelastic.strain_energy import Hyperelastic
from dashpot.extensions.materials.options import Mode
from dashpot.registry import Example

_RUBBER = Hyperelastic("mooney-rivlin", (0.15e6, 0.05e6))


def _make_curve_writer(mode: Mode, max_stretch: float, seed: int) -> Callable[[], str]:
    """Stress over strain of a rubber that follows Mooney and Rivlin, 0.5 % noisy."""

    def render_file() -> str:
        x = np.linspace(1.0, max_stretch, 80)
        stress = convert_to_unit(_RUBBER.nominal(mode, x), "MPa")
        stress += 0.005 * stress.max() * np.random.default_rng(seed).standard_normal(len(x))
        rows = (f"{100 * (a - 1):.5g},{b:.5g}" for a, b in zip(x, stress, strict=True))
        header = [f"# {byline(f'simulated {mode} test')}", "# simulated"]
        return "\n".join([*header, "strain [%],nominal stress [MPa]", *rows, ""])

    return render_file


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "tension.csv": Example(
            "stress-strain",
            "a rubber pulled to twice its length, for dashpot fit",
            _make_curve_writer("uniaxial", 2.0, 1),
        ),
        "biaxial.csv": Example(
            "stress-strain",
            "the same pulled both ways: dashpot fit takes the two",
            _make_curve_writer("equibiaxial", 1.6, 2),
        ),
    }
)
"""Example files by their names."""
