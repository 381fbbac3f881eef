r"""Weighted least squares of a quasi-linear solid: stiffnesses solved, ln tau and shape descended.

.. math:: \min_{\tau,\,s,\,k \ge 0,\,z}\; \sum_i \frac{c_i}{\sigma_i^2}
    \Bigl(F_i - \Phi_i(\tau, s)\,k - Z_i z\Bigr)^2 + \sum_q \frac{(z_q - \mu_q)^2}{\sigma_q^2}

Nuisance terms z (offset, drift, delay) carry priors. Variable projection with the Jacobian of
L. Kaufman, BIT 15 (1975) 49, and Levenberg's damping; bounds by projection.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.least_squares.nnls import nonnegative_columns
from dashpot.fitting.nonlinear_ramp.quasi_linear import QuasiLinear
from dashpot.fitting.nuisance import Prior

LONGEST_STEP = 1.5
_TRIALS = 40
# a fall of the cost, in units of noise variance, that is not worth a further step
_FINISHED = 1e-3
_LEAST_DAMPING, _MOST_DAMPING = 1e-9, 1e9


class Nuisances(NamedTuple):
    """Columns of the load cells and clocks, shape (M, Q), and what is known of each."""

    names: tuple[str, ...]
    columns: FloatArray
    priors: tuple[Prior, ...]


class Point(NamedTuple):
    """One trial: everything linear solved.

    Attributes
    ----------
    log_tau, shape : arrays, shapes (N,) and (P,)
    k : array, shape (S (1 + N),)
        k_inf and every k, N/m, of each set of stiffnesses.
    nuisance : array, shape (Q,)
    residual : array, shape (M,)
        Data less model, N.
    cost : float
        What is minimised.
    """

    log_tau: FloatArray
    shape: FloatArray
    k: FloatArray
    nuisance: FloatArray
    residual: FloatArray
    cost: float


class Weighted:
    """A quasi-linear solid, the standard deviation of one sample of each row, and nuisances.

    With `apart` each record has stiffnesses of its own; relaxation times and shape stay shared.
    """

    def __init__(
        self, solid: QuasiLinear, sd: FloatArray, nuisances: Nuisances, *, apart: bool = False
    ) -> None:
        self.solid, self.nuisances = solid, nuisances
        self._set = solid.rows.record if apart else np.zeros(len(sd), dtype=np.intp)
        self._member = (self._set[:, None] == np.arange(self._set[-1] + 1)) * 1.0
        self.root = np.sqrt(solid.rows.count) / sd
        mean, spread = np.array(nuisances.priors).T.reshape(2, -1)
        self.columns = np.concatenate(
            (self.root[:, None] * nuisances.columns, np.diag(1.0 / spread))
        )
        self.target = np.concatenate((self.root * solid.rows.force, mean / spread))
        self._basis = np.linalg.qr(self.columns)[0]

    def whitened(self, columns: FloatArray) -> FloatArray:
        """Columns of the rows in units of their noise, a row of zeros for each prior."""
        white = self.root.reshape(-1, *[1] * (columns.ndim - 1)) * columns
        return np.concatenate((white, np.zeros((len(self.nuisances.names), *columns.shape[1:]))))

    def linear(self, columns: FloatArray) -> FloatArray:
        """Columns (M, 1 + N) of a solid as those of every set of stiffnesses, (M, S (1 + N))."""
        return np.asarray(
            (self._member[:, :, None] * columns[:, None, :]).reshape(len(columns), -1)
        )

    def _by_row(self, k: FloatArray) -> FloatArray:
        """Stiffnesses of each row's own set, shape (M, 1 + N)."""
        return np.asarray(k.reshape(self._member.shape[1], -1)[self._set])

    def _freed(self, columns: FloatArray) -> FloatArray:
        return np.asarray(columns - self._basis @ (self._basis.T @ columns))

    def point(self, log_tau: FloatArray, shape: FloatArray) -> Point:
        """Return the best stiffnesses >= 0 and nuisances at these relaxation times and shape."""
        columns = self.linear(self.solid.responses(log_tau, shape, full=False).columns)
        white = self.whitened(columns)
        k = _nonnegative(self._freed(white), self._freed(self.target))
        left = self.target - white @ k
        nuisance = np.asarray(np.linalg.lstsq(self.columns, left, rcond=None)[0])
        residual = self.solid.rows.force - columns @ k - self.nuisances.columns @ nuisance
        return Point(log_tau, shape, k, nuisance, residual,
                     float(np.sum((left - self.columns @ nuisance) ** 2)))  # fmt: skip

    def force(self, at: Point) -> FloatArray:
        """Force of the solid alone, N, shape (M,)."""
        columns = self.solid.responses(at.log_tau, at.shape, full=False).columns
        return np.asarray(np.sum(columns * self._by_row(at.k), axis=1))

    def jacobian(self, at: Point) -> FloatArray:
        """Derivative of the whitened model by every stiffness, ln tau, shape and nuisance.

        Shape (M + Q, S (1 + N) + N + P + Q); the columns of the shape keep its mean, and
        the linear law has none.
        """
        found = self.solid.responses(at.log_tau, at.shape, full=True)
        k = self._by_row(at.k)
        by_tau = found.slopes * k[:, 1:]
        by_shape = np.einsum("mnp,mn->mp", found.by_shape, k[:, : found.by_shape.shape[1]])
        if by_shape.shape[1]:
            force = np.sum(found.columns * k, axis=1)
            by_shape = by_shape - np.outer(force, self.solid.weights)
        solid = np.concatenate((self.linear(found.columns), by_tau, by_shape), axis=1)
        return np.concatenate((self.whitened(solid), self.columns), axis=1)

    def descend(self, log_tau: FloatArray, shape: FloatArray, bounds: tuple[float, float]) -> Point:
        """Return the nearest optimum with ln tau inside `bounds`, shape >= 0 of mean 1."""
        here = self.point(np.clip(log_tau, *bounds), shape)
        damping = 1e-3
        gradient, curvature = self._local(here)
        for _ in range(_TRIALS):
            step = self._step(here, gradient, curvature, damping, bounds)
            if not step.any():
                break
            trial = self._moved(here, step, bounds)
            fall = here.cost - trial.cost
            if fall >= 0:
                here, damping = trial, max(0.1 * damping, _LEAST_DAMPING)
                if fall <= _FINISHED:
                    break
                gradient, curvature = self._local(here)
            else:
                damping *= 10.0
                if damping > _MOST_DAMPING:
                    break
        return here

    def _local(self, at: Point) -> tuple[FloatArray, FloatArray]:
        """Gradient and curvature of the cost by ln tau and shape, linear parameters projected."""
        whole = self.jacobian(at)
        tangent = whole[:, len(at.k) : whole.shape[1] - len(self.nuisances.names)]
        used = np.flatnonzero(at.k > 0)
        linear = np.concatenate((whole[:, used], self.columns), axis=1)
        basis = np.linalg.qr(linear / np.linalg.norm(linear, axis=0))[0]
        tangent = tangent - basis @ (basis.T @ tangent)
        residual = np.concatenate((self.root * at.residual, np.zeros(len(self.nuisances.names))))
        residual[len(self.root) :] = (
            self.target[len(self.root) :] - self.columns[len(self.root) :] @ at.nuisance
        )
        return tangent.T @ residual, tangent.T @ tangent

    def _step(
        self,
        at: Point,
        gradient: FloatArray,
        curvature: FloatArray,
        damping: float,
        bounds: tuple[float, float],
    ) -> FloatArray:
        n = len(at.log_tau)
        value = np.concatenate((at.log_tau, at.shape if len(gradient) > n else []))
        low = np.full(len(value), 0.0)
        low[:n] = bounds[0]
        high = np.full(len(value), np.inf)
        high[:n] = bounds[1]
        held = ((value <= low) & (gradient <= 0)) | ((value >= high) & (gradient >= 0))
        size = np.diag(curvature)
        free = np.flatnonzero(~held & (size > 1e-14 * size.max(initial=0.0)))
        step = np.zeros(len(value))
        if not len(free):
            return step
        # the length of the shape is no parameter: its mean is 1
        gauge = np.zeros(len(value))
        gauge[n:] = self.solid.weights if len(value) > n else []
        matrix = curvature + size.max() * np.outer(gauge, gauge) + damping * np.diag(size)
        root = np.sqrt(np.diag(matrix)[free])
        scaled = matrix[np.ix_(free, free)] / np.outer(root, root)
        step[free] = np.linalg.lstsq(scaled, gradient[free] / root, rcond=1e-13)[0] / root
        longest = float(np.abs(step[:n]).max(initial=0.0))
        return step * min(1.0, LONGEST_STEP / longest) if longest > 0 else step

    def _moved(self, at: Point, step: FloatArray, bounds: tuple[float, float]) -> Point:
        n = len(at.log_tau)
        shape = at.shape
        if len(step) > n:
            shape = np.maximum(shape + step[n:], 0.0)
            shape = shape / float(self.solid.weights @ shape)
        return self.point(np.clip(at.log_tau + step[:n], *bounds), shape)


def _nonnegative(phi: FloatArray, target: FloatArray) -> FloatArray:
    """Return the least-squares coefficients >= 0, from the triangular factor."""
    factor = np.asarray(np.linalg.qr(np.concatenate((phi, target[:, None]), axis=1), mode="r"))
    columns, y = factor[:, :-1], factor[:, -1]
    active = nonnegative_columns(columns, y, np.ones(columns.shape[1], dtype=bool))
    found = np.zeros(columns.shape[1])
    found[active] = np.linalg.lstsq(columns[:, active], y, rcond=None)[0]
    return np.maximum(found, 0.0)
