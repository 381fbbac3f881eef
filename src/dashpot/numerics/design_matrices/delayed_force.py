r"""The column of a force that comes late, and its correlation with the motion in closed form.

.. math:: c = -\dot F = \sum_j \frac{k_j}{\tau_j}\,q_j - k_g\,\dot x

On an even clock, with the steps d of the motion, a window from b + 1 to e and the correlation
:math:`C_d` of its steps with all steps, the recursion of an arm is one of its correlation,

.. math::

    C_q(l) &= a\,C_q(l-1) + G\,C_d(l) + (q_{b+1} - G d_{b+1})\,d_{b+1-l} - a\,q_e\,d_{e+1-l} \\
    2h\,C_{\dot x}(l) &= C_d(l) + C_d(l+1) + d_{e+1} d_{e-l} - d_{b+1} d_{b-l}
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.numerics.design_matrices.arm_recursion import compute_exponential_cumsum


class DelayedForce(NamedTuple):
    """A force that comes late, sample by sample.

    Attributes
    ----------
    column : array, shape (n,)
        c over the window.
    arms : array, shape (n, N)
        q over the window.
    k, tau : array, shape (N,)
    k_g : float
        Of k_inf and all arms together.
    """

    column: FloatArray
    arms: FloatArray
    k: FloatArray
    tau: FloatArray
    k_g: float

    @classmethod
    def from_arms(
        cls, arms: FloatArray, k: FloatArray, tau: FloatArray, k_g: float, speed: FloatArray
    ) -> DelayedForce:
        """From the arms' elongations and the speed of the motion over the window."""
        return cls(arms @ (k / tau) - k_g * speed, arms, k, tau, k_g)


class MotionSteps(NamedTuple):
    """The steps of a motion from its first sample to the end of a window, and the one after.

    Attributes
    ----------
    each : array, shape (stop,)
        d; the first is the first displacement, zero.
    after : float
        The step after the window, or its last where the record ends.
    own : array, shape (stop,)
        C_d at every lag.
    """

    each: FloatArray
    after: float
    own: FloatArray


def late_lags(steps: MotionSteps, late: DelayedForce, *, start: int, interval: float) -> FloatArray:
    """Correlation of the column with the steps at every lag, shape (stop,)."""
    d, values = steps.each, steps.own
    first = reverse_before_start(d, start + 1)
    after_last = np.concatenate(([0.0], d[:0:-1]))
    total = np.zeros(len(d))
    for q, k, tau in zip(late.arms.T, late.k, late.tau, strict=True):
        z = interval / tau
        mean = -np.expm1(-z) / z
        difference = (
            mean * values + (q[0] - mean * d[start]) * first - np.exp(-z) * q[-1] * after_last
        )
        difference[0] = q @ d[start:]
        total += k / tau * compute_exponential_cumsum(difference, z)
    change = values + steps.after * d[::-1] - d[start] * reverse_before_start(d, start)
    change[:-1] += values[1:]
    return np.asarray(total - late.k_g / (2.0 * interval) * change)


def reverse_before_start(values: FloatArray, start: int) -> FloatArray:
    """Return the values before `start`, the last first, then zeros."""
    out = np.zeros(len(values))
    out[:start] = values[:start][::-1]
    return out
