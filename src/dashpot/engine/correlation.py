r"""A recorded displacement on a uniform grid: correlated once, fitted at no cost per sample.

With d_i = x_i - x_{i-1}, z = h/tau, a = e^{-z}, G = (1 - e^{-z})/z and u_i = a u_{i-1} + d_i, an
arm is q = G u, and every inner product that a fit asks for over the window W is a sum of
:math:`a^l c(l)` over the lags of a correlation:

.. math::

    \langle v, q \rangle &= G \sum_l a^l C_v(l), \qquad C_v(l) = \sum_{i \in W} v_i d_{i-l} \\
    \langle q_j, q_k \rangle &= G_j G_k
        \frac{S_j + S_k - C_d(0) + a_j a_k (u_j u_k|_{before} - u_j u_k|_{last})}
             {1 - a_j a_k}, \qquad S_j = \sum_l a_j^l C_d(l)

The C_v(l) are compressed like a decaying signal, so a sum over all lags is a sum over some 200
nodes. Derivatives by ln tau multiply a node by l z; the mixed derivative of
:math:`\langle q_j, q_k \rangle` is :math:`\langle p_j, p_k \rangle`. The Cholesky factor of the
Gram matrix of [fixed, q, y, p] then holds the columns in orthogonal coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import DesignBlock, Evaluation
from dashpot.engine.compression import Compression, compression


@dataclass(frozen=True, eq=False)
class CorrelationBlock:
    """A block whose inner products are closed forms in tau.

    The Gram matrix resolves an SSE to 1e-15 of the data's own sum of squares; `exact` is the
    same block with every sample as a row, for the final residual.
    """

    exact: DesignBlock
    lags: Compression
    #: pseudo-samples of the sequences, rows: fixed..., y, d, u before the window, u at its end
    sequences: FloatArray
    #: Gram matrix of [fixed, y] over the window
    gram: FloatArray
    energy: float
    step: float

    @property
    def floor(self) -> float:
        """Nothing is set aside."""
        return 0.0

    @property
    def turning(self) -> bool:
        """Each Cholesky factor has its own coordinates."""
        return True

    @property
    def grain(self) -> float:
        """Sum of squares below which the Gram matrix holds rounding only."""
        return 1e-14 * float(self.gram[-1, -1])

    @property
    def samples(self) -> int:
        """Samples in the window."""
        return self.exact.samples

    @property
    def fixed_names(self) -> tuple[str, ...]:
        """Names of the fixed columns."""
        return self.exact.fixed_names

    @property
    def arm_group(self) -> str:
        """The group of the arms' coefficients."""
        return self.exact.arm_group

    @property
    def window(self) -> tuple[float, float]:
        """Shortest and longest relaxation time that the data could tell, s."""
        return self.exact.window

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """Return target and design matrix in the coordinates of the Cholesky factor."""
        gram, q = self.gram_matrix(np.exp(log_tau), derivative=derivative)
        factor = _cholesky(gram)
        arms = len(log_tau)
        target = q + arms
        slope = slice(target + 1, None) if derivative else slice(q, target)
        return Evaluation(factor[:, target], factor[:, :q], factor[:, q:target], factor[:, slope])

    def gram_matrix(self, tau: FloatArray, *, derivative: bool) -> tuple[FloatArray, int]:
        """Gram matrix of [fixed, arms, y] or [fixed, arms, y, slopes], and the fixed columns."""
        arm = self._arm_sums(tau)
        q, arms = len(self.gram) - 1, len(tau)
        order = np.concatenate((np.arange(q), [q + arms]))
        size = q + 1 + (2 * arms if derivative else arms)
        gram = np.empty((size, size))
        gram[order[:, None], order] = self.gram
        here = slice(q, q + arms)
        products = _products(arm, self.energy)
        gram[here, here] = products.qq
        gram[order, here] = arm.g * arm.sums[: q + 1]
        gram[here, order] = gram[order, here].T
        if derivative:
            there = slice(q + arms + 1, None)
            gram[order, there] = arm.dg * arm.sums[: q + 1] + arm.g * arm.slopes[: q + 1]
            gram[there, order] = gram[order, there].T
            gram[here, there] = products.qp
            gram[there, here] = products.qp.T
            gram[there, there] = products.pp
        return gram, q

    def _arm_sums(self, tau: FloatArray) -> _ArmSums:
        z = self.step / tau
        lost = np.expm1(-z)
        a, g = 1 + lost, -lost / z
        x = self.lags.nodes[:, None] * z
        decay = self.lags.root_weight[:, None] * np.exp(-x)
        both = self.sequences @ np.concatenate((decay, x * decay), axis=1)
        return _ArmSums(z, a, g, g - a, both[:, : len(tau)], both[:, len(tau) :])


class _ArmSums(NamedTuple):
    z: FloatArray
    a: FloatArray
    g: FloatArray
    dg: FloatArray  # dG / d ln tau = G - a
    sums: FloatArray  # sum a^l c(l), a row per sequence, a column per arm
    slopes: FloatArray  # their derivatives by ln tau


class _Products(NamedTuple):
    qq: FloatArray
    qp: FloatArray
    pp: FloatArray


def _products(arm: _ArmSums, energy: float) -> _Products:
    r"""Inner products of arms and of their derivatives, by the quotient rule on num/den."""
    s, ds = arm.sums[-3], arm.slopes[-3]
    da = arm.a * arm.z
    before, last = arm.a * arm.sums[-2], arm.a * arm.sums[-1]
    d_before = da * arm.sums[-2] + arm.a * arm.slopes[-2]
    d_last = da * arm.sums[-1] + arm.a * arm.slopes[-1]
    den = -np.expm1(-(arm.z[:, None] + arm.z))
    num = s[:, None] + s - energy + np.outer(before, before) - np.outer(last, last)
    u = num / den
    num_k = ds + np.outer(before, d_before) - np.outer(last, d_last)
    den_k = -np.outer(arm.a, da)
    u_k = (num_k - u * den_k) / den
    num_jk = np.outer(d_before, d_before) - np.outer(d_last, d_last)
    u_jk = (num_jk - u_k.T * den_k - u_k * den_k.T + u * np.outer(da, da)) / den
    g, dg = arm.g, arm.dg
    cross = dg[:, None] * (g * u_k)
    return _Products(
        qq=np.outer(g, g) * u,
        qp=g[:, None] * (dg * u + g * u_k),
        pp=np.outer(dg, dg) * u + cross + cross.T + np.outer(g, g) * u_jk,
    )


def _cholesky(gram: FloatArray) -> FloatArray:
    """Upper factor R with R'R = gram, scaled to a unit diagonal first."""
    scale = np.sqrt(np.diagonal(gram))
    unit = gram / scale / scale[:, None]
    ridge = 0.0
    while True:
        try:
            return np.asarray(np.linalg.cholesky(unit).T * scale)
        except np.linalg.LinAlgError:
            ridge = max(10 * ridge, 1e-15)
            unit = unit + ridge * np.eye(len(unit))


def correlation_block(
    exact: DesignBlock, time: FloatArray, x: FloatArray, *, start: int, stop: int
) -> CorrelationBlock:
    """Correlate a record on a uniform grid, at rest at zero before its first sample."""
    count = stop
    d = np.diff(x[:count], prepend=0.0)
    size = _fast_length(2 * count)
    lagged = np.fft.rfft(d, size).conj()
    window = np.zeros(count)
    lags = compression(np.arange(count, dtype=float))

    def compressed(sequence: FloatArray) -> FloatArray:
        return lags.project(sequence)[0]

    def correlated(values: FloatArray) -> FloatArray:
        window[start:] = values
        # one sequence at a time stays in the cache
        return compressed(np.fft.irfft(np.fft.rfft(window, size) * lagged, size)[:count])

    before = np.zeros(count)
    before[:start] = d[:start][::-1]
    last = d[::-1]
    rows = [correlated(column) for column in (*exact.fixed.T, exact.target, d[start:])]
    matrix = np.column_stack((exact.fixed, exact.target))
    return CorrelationBlock(
        exact=exact,
        lags=lags,
        sequences=np.stack([*rows, compressed(before), compressed(last)]),
        gram=matrix.T @ matrix,
        energy=float(d[start:] @ d[start:]),
        step=float(time[-1] - time[0]) / (len(time) - 1),
    )


def _fast_length(least: int) -> int:
    """The smallest 2^i 3^j 5^k >= least."""
    best = 1 << (least - 1).bit_length()
    five = 1
    while five < best:
        three = five
        while three < best:
            rest = -(-least // three)
            best = min(best, three << (rest - 1).bit_length())
            three *= 3
        five *= 5
    return best
