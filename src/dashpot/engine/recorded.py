"""Blocks of a recorded displacement, any history on any grid."""

from __future__ import annotations

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import DesignBlock
from dashpot.engine.holds import window_of
from dashpot.solids.history import decaying_sum


def recorded_block(
    time: FloatArray,
    displacement: FloatArray,
    force: FloatArray,
    *,
    window: slice = slice(None),
    k_inf: str = "k_inf",
    offset: str | None = None,
    drift: str | None = None,
    weights: FloatArray | None = None,
    arm_group: str = "k",
) -> DesignBlock:
    r"""Force under a recorded displacement that is straight between its samples.

    .. math:: F_i = k_\infty x_i + \sum_j k_j q_j(t_i) + F_0 + \dot F (t_i - t_0), \qquad
        q_i = e^{-z} q_{i-1} + \frac{1 - e^{-z}}{z} (x_i - x_{i-1}), \; z = h_i/\tau

    Parameters
    ----------
    time, displacement, force : array, shape (M,)
        Strictly increasing times, any spacing; at rest at displacement zero before the first.
    window : slice
        The samples whose force is fitted; the displacement before it still acts.
    k_inf, offset, drift : str
        Names of the fixed columns; offset and drift are left out unless named.
    weights : array, shape (M,), optional
        1/sd of each sample.
    """
    time = np.asarray(time, dtype=float)
    x = np.asarray(displacement, dtype=float)
    root = (np.ones(len(time)) if weights is None else weights)[window]
    fixed = {k_inf: x[window]}
    if offset is not None:
        fixed[offset] = np.ones(len(root))
    if drift is not None:
        fixed[drift] = time[window] - time[window][0]

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        q, p = arm_columns(time, x, tau)
        return root[:, None] * q[window], root[:, None] * p[window]

    return DesignBlock(
        target=root * force[window],
        fixed=root[:, None] * np.column_stack(list(fixed.values())),
        fixed_names=tuple(fixed),
        columns=columns,
        window=window_of(time),
        arm_group=arm_group,
    )


def arm_columns(time: FloatArray, x: FloatArray, tau: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Elongations q of unit arms and dq / d ln tau, both (M, N), by the exact recursion."""
    z = np.diff(time)[:, None] / tau
    zero = np.zeros((1, len(tau)))
    decay = np.concatenate((zero, np.exp(-z)))
    mean = np.concatenate((zero + 1, -np.expm1(-z) / z))
    moved = np.concatenate((x[:1], np.diff(x)))[:, None]
    q = decaying_sum(decay, mean * moved)
    z = np.concatenate((zero, z))
    before = np.concatenate((zero, q[:-1]))
    p = decaying_sum(decay, decay * z * before + (mean - decay) * moved * (z > 0))
    return q, p
