r"""Arms of a recorded displacement on an even clock, a stretch of samples at a time.

With d_i = x_i - x_{i-1}, z = h/tau, a = e^{-z}, G = (1 - e^{-z})/z, sample i of a stretch is

.. math:: u_i = \sum_{j \le i} a^{i-j} d_j + a^{i+1} u_{-1}, \qquad q_i = G u_i, \qquad
    p_i = \frac{\partial q_i}{\partial \ln\tau} = (G - a)\,u_i + G z\,v_i, \qquad
    v_i = \sum_{j \le i} (i - j)\, a^{i-j} d_j + a^{i+1} (v_{-1} + (i + 1)\, u_{-1})

with what the stretch before it ends with at index -1. All stretches are one product with one
triangular matrix, and their ends are such a sum again, of fewer samples: the recursion in the
order of a matrix product, for the same result in an eighth of the time.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray

#: samples of a stretch: a longer one is more work, a shorter one has more ends
STRETCH = 32


def compute_arm_elongations(
    x: FloatArray, z: FloatArray, *, derivative: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Elongations q of unit arms and p = dq / d ln tau, both (M, N), from q_0 = x_0.

    Parameters
    ----------
    x : array, shape (M,)
        Displacement.
    z : array, shape (N,)
        Sample interval over each relaxation time.
    derivative : bool
        Without it the second is the first.
    """
    size = len(x)
    count = -(-size // STRETCH)
    steps = np.zeros(count * STRETCH)
    np.subtract(x[1:], x[:-1], out=steps[1:size])
    # beside the steps of each stretch, what the one before it ends with
    values = np.zeros((count, STRETCH + 2))
    values[:, :STRETCH] = steps.reshape(count, STRETCH)
    both = np.empty((2 if derivative else 1, len(z), count, STRETCH))
    index = np.arange(STRETCH + 1.0)
    for j, value in enumerate(z):
        power = np.exp(-value * index)
        mean = -np.expm1(-value) / value
        ends = compute_exponential_cumsum(
            values[:, :STRETCH] @ power[STRETCH - 1 :: -1], value * STRETCH
        )
        values[1:, STRETCH] = ends[:-1]
        np.matmul(values[:, :-1], _answers(mean * power), out=both[0, j])
        if derivative:
            late = index * power
            late_ends = values[:, :STRETCH] @ late[STRETCH - 1 :: -1]
            late_ends[1:] += late[STRETCH] * ends[:-1]
            values[1:, STRETCH + 1] = compute_exponential_cumsum(late_ends, value * STRETCH)[:-1]
            made = _answers((mean - power[1]) * power + mean * value * late)
            np.matmul(
                values, np.concatenate((made, mean * value * power[None, 1:])), out=both[1, j]
            )
    q, p = (item.reshape(len(z), count * STRETCH) for item in (both[0], both[-1]))
    if x[0] != 0.0:
        passed = z[:, None] * np.arange(q.shape[1])
        remainder = x[0] * np.exp(-passed)
        q += remainder
        if derivative:
            p += passed * remainder
    return q.T[:size], p.T[:size]


def _answers(kernel: FloatArray) -> FloatArray:
    """A row of answers to each step of a stretch, and one to the end before it."""
    return np.concatenate((_triangle(kernel[:STRETCH]), kernel[None, 1:]))


def compute_exponential_cumsum(values: FloatArray, z: float) -> FloatArray:
    r"""Return the sums :math:`\sum_{j \le i} e^{-z (i - j)} v_j`, shape (n,)."""
    size = len(values)
    if size <= STRETCH:
        return values @ _triangle(np.exp(-z * np.arange(float(size))))
    power = np.exp(-z * np.arange(STRETCH + 1.0))
    matrix = np.zeros((-(-size // STRETCH), STRETCH))
    matrix.ravel()[:size] = values
    result = matrix @ _triangle(power[:STRETCH])
    result[1:] += compute_exponential_cumsum(result[:, -1], z * STRETCH)[:-1, None] * power[1:]
    return np.asarray(result.ravel()[:size])


def _triangle(kernel: FloatArray) -> FloatArray:
    """The matrix whose row j holds kernel[i - j] at every i >= j."""
    lag, later = _lags(len(kernel))
    return np.where(later, kernel[lag], 0.0)


@lru_cache(maxsize=64)
def _lags(size: int) -> tuple[IndexArray, BoolArray]:
    lag = np.arange(size) - np.arange(size)[:, None]
    return np.maximum(lag, 0), lag >= 0
