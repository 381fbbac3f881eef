"""Simulated example files: blank tests of one machine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.units import convert_to_unit, parse_quantity
from dashpot.base.version import byline
from dashpot.registry import Example
from dashpot.solids.demo_seals import PAPER

Part: TypeAlias = Callable[[FloatArray, FloatArray], FloatArray]

_COMPLIANCE, _CREEP = parse_quantity("45um/N", "compliance"), parse_quantity("5um", "length")
_SPRING, _DELAY = parse_quantity("1N/mm", "stiffness"), parse_quantity("4ms", "time")
_GAIN = 1.008
_REST, _RAMP, _HOLD, _STEP = 10.0, 1.0, 40.0, 0.01


def _render_record(gap: float, depth: float, seed: int, part: Part) -> str:
    """Return a press by `depth` beyond a gap, m, and back; `part` gives the force of its time, s,
    and of the way that part and machine are pressed by, m.
    """
    speed = depth / _RAMP
    stop = _REST + (gap + depth) / speed
    return_time = stop + _HOLD + (gap + depth) / speed
    corners = (0.0, _REST, stop, stop + _HOLD, return_time, return_time + 2)
    time = np.arange(0.0, corners[-1], _STEP)

    def move(time: FloatArray) -> FloatArray:
        return np.interp(time, corners, (0.0, 0.0, gap + depth, gap + depth, 0.0, 0.0))

    delayed = time - _DELAY
    path = move(delayed) - gap + _CREEP * np.log1p(np.maximum(delayed - stop, 0.0) / _RAMP)
    random = np.random.default_rng(seed)
    force = _GAIN * part(time, np.maximum(path, 0.0)) + 2e-4 * time
    force += 4e-3 * np.sin(2 * np.pi * 20.3 * time) + 4e-3 * random.standard_normal(len(time))
    x = convert_to_unit(move(time) + 3e-7 * random.standard_normal(len(time)), "mm")
    lines = [f"# {byline('simulated test on one machine')}", "# simulated"]
    lines.append("time [s],displacement [mm],force [N]")
    rows = zip(time, x, force, strict=True)
    return "\n".join([*lines, *(f"{t:.2f},{a:.5f},{f:.5f}" for t, a, f in rows), ""])


def _press_seal(time: FloatArray, motion: FloatArray) -> FloatArray:
    """Return the force of the paper's seal, with the deflection of the machine."""
    force = np.zeros(len(time))
    for _ in range(4):  # the give is a hundredth of the way
        force = PAPER.force(time, motion - _COMPLIANCE * force)
    return force


def _render_stop() -> str:
    return _render_record(5e-4, 25 * _COMPLIANCE, 1, lambda _, motion: motion / _COMPLIANCE)


def _render_spring() -> str:
    return _render_record(1e-3, 8e-3, 2, lambda _, motion: motion / (1 / _SPRING + _COMPLIANCE))


def _render_empty() -> str:
    return _render_record(1e-3, 8e-3, 3, lambda _, motion: 0 * motion)


def _render_seal() -> str:
    return _render_record(1e-3, 8e-3, 4, _press_seal)


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "rig_stop.csv": Example("", "a testing machine pressed on a rigid stop", _render_stop),
        "rig_spring.csv": Example(
            "", "the same machine on a steel spring of 1 N/mm", _render_spring
        ),
        "rig_empty.csv": Example("", "the same machine without a specimen", _render_empty),
        "rig_seal.csv": Example(
            "relaxation", "a seal of the paper on the same machine", _render_seal
        ),
    }
)
"""Example files by their names."""
