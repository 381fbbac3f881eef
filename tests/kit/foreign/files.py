"""A press and hold of known truth, to be written in any format; nothing of dashpot in it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
K_INF = 1.0
ARMS = ((0.3, 0.2), (0.25, 8.0))
"""Stiffness, N/mm, and time, s, of each arm."""
AT_40_S = 1.0017
"""Stiffness 40 s after the ramp, N/mm."""


def press_and_hold(
    rate: float = 50.0, *, hold: float = 40.0, noise: float = 3e-3, seed: int = 0
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return time, s, displacement, mm, and force, N: a second of rest, a ramp of 1 s, a hold."""
    time = np.arange(round((2 + hold) * rate)) / rate
    displacement = 8 * np.clip(time - 1, 0, 1)
    steps = np.diff(displacement)
    force = K_INF * displacement
    for stiffness, tau in ARMS:
        decay = np.exp(-1 / rate / tau)
        gained = stiffness * tau * rate * (1 - decay)
        carried = 0.0
        for i, step in enumerate(steps, start=1):
            carried = carried * decay + gained * step
            force[i] += carried
    return (
        time,
        displacement,
        force + noise * np.random.default_rng(seed).standard_normal(len(time)),
    )


def format_table(head: str, columns: Sequence[FloatArray]) -> str:
    """Return a text table with semicolons between its cells."""
    rows = (";".join(f"{value:.7g}" for value in row) for row in zip(*columns, strict=True))
    return "\n".join([head, *rows]) + "\n"
