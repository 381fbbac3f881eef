r"""Weighted least squares of a quasi-linear solid: stiffnesses solved, ln tau and shape descended.

.. math:: \min_{\tau,\,s,\,k \ge 0,\,z}\; \sum_i \frac{c_i}{\sigma_i^2}
    \Bigl(F_i - \Phi_i(\tau, s)\,k - Z_i z\Bigr)^2 + \sum_q \frac{(z_q - \mu_q)^2}{\sigma_q^2}

Nuisance terms z (offset, drift, delay) carry priors. The shape has the mean 1, which is known as
well as the ramps tell their own size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.nonlinear_ramp.downsampling import DownsampledRows
from dashpot.fitting.nonlinear_ramp.quasi_linear import QuasiLinear
from dashpot.fitting.nuisance_priors import Prior
from dashpot.numerics.least_squares.problem import (
    Optimum,
    Parameter,
    Problem,
    Rows,
    require_optimum,
)

_STEPS = 40
# a fall of the cost, in units of noise variance, that is not worth a further step
_FINISHED = 1e-5


class Nuisances(NamedTuple):
    """Columns of the load cells and clocks, shape (M, Q), and what is known of each."""

    names: tuple[str, ...]
    columns: FloatArray
    priors: tuple[Prior, ...]


class Bounds(NamedTuple):
    """The window of ln tau: a sample of the ramp to the longest hold."""

    low: float
    high: float


def tau_bounds(rows: DownsampledRows) -> Bounds:
    """Return the relaxation times that ramp and hold could show, ln s."""
    shortest = min(float(rows.step[rows.record == i].min()) for i in range(len(rows.depths)))
    holds = [rows.time[rows.record == i][-1] - end for i, end in enumerate(rows.ends)]
    return Bounds(float(np.log(shortest)), float(np.log(max(holds))))


class Weighted:
    """A quasi-linear solid, the standard deviation of one sample of each row, and nuisances.

    Theta is every ln tau, then the shape of a law that is not straight; beta every stiffness of
    each set, then the nuisances. With `apart` each record has stiffnesses of its own; relaxation
    times and shape stay shared.
    """

    def __init__(
        self, solid: QuasiLinear, sd: FloatArray, nuisances: Nuisances, *, separate: bool = False
    ) -> None:
        self.solid, self.nuisances = solid, nuisances
        self._set = solid.rows.record if separate else np.zeros(len(sd), dtype=np.intp)
        self.sets = int(self._set[-1]) + 1
        self._member = (self._set[:, None] == np.arange(self.sets)) * 1.0
        self.root = np.sqrt(solid.rows.count) / sd
        mean, spread = np.array(nuisances.priors).T.reshape(2, -1)
        data = self.root * solid.rows.force
        # how far the mean of the shape is from 1 is the last row
        self._size = float(np.linalg.norm(data[solid.rows.ramp]))
        self.target = np.concatenate((data, mean / spread, [0.0]))
        self._known = self._white(nuisances.columns)
        self._known[len(sd) : -1] = np.diag(1.0 / spread)

    def _white(self, columns: FloatArray) -> FloatArray:
        """Columns of the rows in units of their noise, rows of zeros for what is known before."""
        values = np.zeros((len(self.target), columns.shape[1]))
        values[: len(columns)] = self.root[:, None] * columns
        return values

    def _expand_by_row(self, k: FloatArray) -> FloatArray:
        """Stiffnesses of each row's own set, shape (M, 1 + N)."""
        return np.asarray(k.reshape(self.sets, -1)[self._set])

    def stiffnesses(self, best: Optimum) -> FloatArray:
        """k_inf and every k of each set, N/m, shape (S, 1 + N)."""
        return best.beta[: len(best.beta) - len(self.nuisances.names)].reshape(self.sets, -1)

    def force(self, best: Optimum) -> FloatArray:
        """Force of the solid alone, N, shape (M,)."""
        log_tau, shape = self.solid.split_parameters(best.theta)
        columns = self.solid.columns(log_tau) @ shape
        return np.asarray(np.sum(columns * self._expand_by_row(self.stiffnesses(best)), axis=1))

    def problem(self, arms: int) -> Problem:
        """The problem of so many arms, their ln tau inside the window of the rows."""
        solid, stiff = self.solid, self.sets * (1 + arms)
        bends = solid.weights[solid.bends]

        def model(theta: FloatArray) -> Rows:
            log_tau, shape = solid.split_parameters(theta)
            mean = float(solid.weights @ shape)
            hats, shape = solid.columns(log_tau), shape / mean
            columns = hats @ shape
            value = (self._member[:, :, None] * columns[:, None, :]).reshape(len(columns), -1)
            A = np.concatenate((self._white(value), self._known), axis=1)

            def slope(beta: FloatArray) -> FloatArray:
                k = self._expand_by_row(beta[:stiff])
                by_tau = solid.slopes(log_tau, shape, columns[:, 1:]) * k[:, 1:]
                force = np.sum(columns * k, axis=1)
                by_shape = (np.einsum("mnp,mn->mp", hats[:, :, solid.bends], k)
                            - np.outer(force, bends)) / mean  # fmt: skip
                values = self._white(np.concatenate((by_tau, by_shape), axis=1))
                values[-1, arms:] = self._size * bends
                return values

            y = self.target.copy()
            y[-1] = self._size * (1.0 - mean)
            return Rows(y, A, slope)

        return Problem(
            model,
            [Parameter(*tau_bounds(solid.rows))] * arms + [Parameter(0.0)] * len(bends),
            positive=np.arange(stiff + len(self.nuisances.names)) < stiff,
            priors=len(self.nuisances.names) + 1,
            gauge=self._normalise_shape if len(bends) else None,
        )

    def _normalise_shape(self, theta: FloatArray) -> FloatArray:
        """The length of the shape is no parameter."""
        log_tau, shape = self.solid.split_parameters(theta)
        return np.concatenate((log_tau, shape / float(self.solid.weights @ shape)))

    def descend(self, theta: FloatArray) -> Optimum:
        """Return the nearest optimum, ln tau in the window of the rows, shape >= 0 of mean 1."""
        problem = self.problem(len(self.solid.split_parameters(theta)[0]))
        return require_optimum(problem, [theta], most=_STEPS, flat=_FINISHED / len(self.root))
