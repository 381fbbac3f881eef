"""One Maxwell arm under a recorded displacement, exactly."""

from __future__ import annotations

import numpy as np

from dashpot._arrays import FloatArray


def decaying_sum(decay: FloatArray, increments: FloatArray) -> FloatArray:
    r"""Return :math:`u_i = a_i u_{i-1} + d_i` with :math:`u_{-1} = 0`, shape (n,) or (n, m).

    A scan in log2(n) passes: after the pass of stride s every u_i holds the sum over the last
    2s increments, each with its own product of decays. All products are of numbers <= 1, so
    nothing can overflow; the scan ends early once every product has underflowed.
    """
    product = np.array(decay, dtype=float)
    total = np.array(increments, dtype=float)
    stride = 1
    while stride < len(total) and product[stride:].max(initial=0.0) > 0.0:
        total[stride:] += product[stride:] * total[:-stride]
        product[stride:] *= product[:-stride]
        stride *= 2
    return total


def arm_response(time: FloatArray, displacement: FloatArray, tau: float) -> FloatArray:
    r"""Return the elongation of the spring of an arm, m: force = k times this, shape (n,).

    For displacement straight between samples, with h the sample interval and z = h/tau,

    .. math:: q_i = e^{-z} q_{i-1} + \frac{1 - e^{-z}}{z} (x_i - x_{i-1}), \qquad q_0 = x_0

    Boltzmann superposition integrated exactly, segment by segment; any sampling.
    """
    z = np.diff(time) / tau
    decay = np.concatenate(([0.0], np.exp(-z)))
    mean = np.concatenate(([1.0], -np.expm1(-z) / z))
    moved = np.concatenate((displacement[:1], np.diff(displacement)))
    return decaying_sum(decay, mean * moved)
