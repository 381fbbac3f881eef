"""Ramp and hold of a solid whose spectrum is smooth and decades wide, on a sound rig."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
DEPTH, RAMP, REST = 8e-3, 1.0, 2.0
"""m, s, s before the ramp."""


def record_wide_spectrum(
    *,
    slope: float,
    shortest: float,
    longest: float,
    noise: float,
    hold: float,
    rate: float,
    seed: int = 1,
) -> tuple[Array, Array, Array]:
    r"""Return time, s, displacement, m, and force, N.

    200 arms at even distances of log tau, k_j proportional to :math:`\tau_j^{-slope}`, 400 N/m in
    all, beside a spring of 150 N/m. During the ramp at the speed v an arm carries
    :math:`k v \tau (1 - e^{-t/\tau})`, after it this decays.
    """  # fmt: skip
    tau = np.geomspace(shortest, longest, 200)
    stiffness = tau**-slope
    stiffness *= 400.0 / stiffness.sum()
    time = np.arange(0.0, REST + RAMP + hold, 1 / rate)
    since, speed = time - REST, DEPTH / RAMP
    displacement = DEPTH * np.clip(since / RAMP, 0.0, 1.0)
    force = 150.0 * displacement
    in_ramp, after = np.clip(since, 0.0, RAMP), np.clip(since - RAMP, 0.0, None)
    for k, t in zip(stiffness, tau, strict=True):
        force += k * speed * t * (1 - np.exp(-in_ramp / t)) * np.exp(-after / t)
    random = np.random.default_rng(seed)
    return (
        time,
        displacement + random.normal(0, 1e-7, len(time)),
        force + random.normal(0, noise, len(time)),
    )
