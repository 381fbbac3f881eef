r"""The force of a quasi-linear solid, linear in its stiffnesses and in the shape of its law.

All arms answer the same elastic path p(x) (Y. C. Fung, *Biomechanics*, 1993, ch. 7):

.. math:: F = k_\infty\,p(x) + \sum_j k_j \int_0^t e^{-(t-u)/\tau_j}\,\frac{d\,p(x(u))}{du}\,du,
    \qquad p(x) = \sum_m s_m B_m(x), \quad B_m(x) = \int_0^x h_m(v)\,dv

with hats :math:`h_m` on the knots, so that the tangent :math:`p'` is linear between them and
:math:`p' \ge 0` if and only if every :math:`s_m \ge 0`. The shape has the mean 1: p of the depth
is the depth and the stiffnesses are secants there.
"""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.nonlinear_ramp.downsampling import DownsampledRows
from dashpot.numerics.design_matrices.recorded_motion import recursion


class QuasiLinear:
    r"""Rows of records under an elastic law on some knots.

    Attributes
    ----------
    rows : ThinnedRows
    knots : array, shape (P,)
        m, from 0 to the deepest compression.
    weights : array, shape (P,)
        Of each hat in the mean of the tangent: :math:`w \cdot s = 1`.
    """

    def __init__(self, rows: DownsampledRows, knots: FloatArray) -> None:
        self.rows, self.knots = rows, knots
        self.hats = hat_integrals(rows.displacement, knots)
        width = np.diff(knots)
        self.weights = 0.5 * (np.append(width, 0.0) + np.append(0.0, width)) / knots[-1]
        steps = np.diff(self.hats, axis=0, prepend=0.0)
        steps[rows.first] = self.hats[rows.first]
        self._moved = steps

    @property
    def bends(self) -> slice:
        """The hats whose shape is free: none of a straight law."""
        return slice(0, len(self.knots) if len(self.knots) > 2 else 0)

    def theta(self, log_tau: FloatArray, shape: FloatArray) -> FloatArray:
        """Every ln tau, and the shape of a law that is not straight, (N + P,)."""
        return np.concatenate((log_tau, shape[self.bends]))

    def split_parameters(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Every ln tau, and the shape at every knot."""
        arms = len(theta) - self.bends.stop
        return theta[:arms], theta[arms:] if self.bends.stop else np.ones(2)

    def columns(self, log_tau: FloatArray) -> FloatArray:
        """Of k_inf and every k under each hat: its path, and each arm's elongation, (M, 1+N, P)."""
        _, mean, passed = self._steps(log_tau)
        arms = _run(passed[:, :, None], mean[:, :, None] * self._moved[:, None, :])
        return np.concatenate((self.hats[:, None, :], arms), axis=1)

    def slopes(self, log_tau: FloatArray, shape: FloatArray, arms: FloatArray) -> FloatArray:
        """Derivative of each arm's elongation under a shape by its ln tau, (M, N)."""
        z, mean, passed = self._steps(log_tau)
        before = np.concatenate((np.zeros((1, len(log_tau))), arms[:-1]))
        change = (self._moved @ shape)[:, None]
        return _run(passed, passed * z * before + (mean - np.exp(-z)) * change)

    def _steps(self, log_tau: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Step of each row over tau, the mean decay within it, and what passes from row to row."""
        z = self.rows.step[:, None] / np.exp(log_tau)
        lost = np.expm1(-z)
        passed = 1 + lost
        passed[self.rows.first] = 0.0
        return z, -lost / z, passed


def hat_integrals(x: FloatArray, knots: FloatArray) -> FloatArray:
    """Integral of each hat from 0 to x, shape (M, P); beyond the ends the last tangent stays."""
    width = np.diff(knots)
    i = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, len(width) - 1)
    part = np.clip(x, 0.0, knots[-1]) - knots[i]
    half = 0.5 * width
    below = np.zeros((len(knots), len(knots)))
    for m in range(1, len(knots)):
        below[m] = below[m - 1]
        below[m, m - 1 : m + 1] += half[m - 1]
    values = below[i]
    right = 0.5 * part**2 / width[i]
    every = np.arange(len(x))
    values[every, i] += part - right
    values[every, i + 1] += right
    values[:, 0] += np.minimum(x, 0.0)
    values[:, -1] += np.maximum(x - knots[-1], 0.0)
    return values


def _run(decay: FloatArray, increments: FloatArray) -> FloatArray:
    return recursion(decay[1:], increments[1:], increments[0])
