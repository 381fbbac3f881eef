"""Simulated example files of compression load deflection."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.registry import Example
from dashpot.solids.demo_seals import BROAD


def _simulate_force(path: FloatArray, is_in_contact: BoolArray, step: float) -> FloatArray:
    """Return the force of a relaxing seal along a path, N; out of contact it recovers."""
    k, tau = np.asarray(BROAD.k), np.asarray(BROAD.tau)
    decay = np.exp(-step / tau)
    mean = k * (1 - decay) * tau / step
    arms, position, force = np.zeros(len(k)), 0.0, np.zeros(len(path))
    for i, next_position in enumerate(path.tolist()):
        previous_position, position, passed = position, next_position, decay * arms
        force[i] = BROAD.k_inf * position + (passed + mean * (position - previous_position)).sum()
        if force[i] <= 0 or not is_in_contact[i]:
            force[i] = 0.0
            position = (mean.sum() * previous_position - passed.sum()) / (BROAD.k_inf + mean.sum())
        arms = passed + mean * (position - previous_position)
    return force


def _make_cld_writer(
    stiffness: float, seed: int, *, speed: float = 50e-3 / 60
) -> Callable[[], str]:
    """Return a record of a stiffening seal, pressed by 8 mm four times and softer each time."""

    def render_file() -> str:
        depth, gap, cycles = 8e-3, 1e-3, 4
        stroke = (depth + gap) / speed
        turns = np.arange(2 * cycles + 1) * stroke + 2.0
        knots = np.concatenate(([0.0], turns, [turns[-1] + 2.0]))
        positions = np.array([-gap, *([-gap, depth] * cycles), -gap, -gap])
        time = np.linspace(0.0, knots[-1], 1601)
        plate = np.interp(time, knots, positions)
        x = np.maximum(plate, 0.0)
        number = np.searchsorted(turns[2::2], time)
        softer = 1 + 0.1 * np.exp(-2.0 * number)  # the seal of the relaxation test is conditioned
        path = softer * (0.7 * x + 0.3 * x**3 / depth**2)
        force = stiffness * _simulate_force(path, plate > 0, float(time[1]))
        noise = 4e-3 * np.random.default_rng(seed).standard_normal(len(time))
        lines = zip(time, convert_to_unit(plate, "mm"), force + 0.03 + noise, strict=True)
        header = [f"# {byline('simulated compression load deflection test')}", "# simulated"]
        rows = (",".join(f"{value:.6g}" for value in row) for row in lines)
        return "\n".join([*header, "time [s],displacement [mm],force [N]", *rows, ""])

    return render_file


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "cld_1.csv": Example(
            "cld",
            "100 mm of a seal pressed 8 mm and released four times at 50 mm/min",
            _make_cld_writer(1.0, 1),
        ),
        "cld_2.csv": Example("cld", "a second specimen of it", _make_cld_writer(1.04, 2)),
        "cld_3.csv": Example(
            "cld", "a third: dashpot fit takes the three", _make_cld_writer(0.97, 3)
        ),
        "cld_slow.csv": Example(
            "cld", "the first specimen at 5 mm/min", _make_cld_writer(1.0, 4, speed=5e-3 / 60)
        ),
        "cld_fast.csv": Example(
            "cld",
            "and at 500 mm/min: dashpot fit takes the three speeds",
            _make_cld_writer(1.0, 5, speed=500e-3 / 60),
        ),
    }
)
"""Example files by their names."""
