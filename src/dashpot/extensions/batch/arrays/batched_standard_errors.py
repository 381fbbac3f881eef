"""Standard errors of many records on one clock, from means over a few samples."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray, block_means
from dashpot.extensions.batch.arrays.batched_solver import ManySolutions
from dashpot.numerics.design_matrices.recorded_motion import compute_arm_columns
from dashpot.numerics.inference.correlated_noise import autocovariance, geyer_cuts

# approximate number of means per record
MEANS = 1000
# records done together: they stay in the cache
_BATCH_SIZE = 16
# relative eigenvalue below which a direction counts as undetermined
_SINGULAR = 1e-13


def compute_standard_errors(
    time: FloatArray, x: FloatArray, records: FloatArray, first: int, solutions: ManySolutions
) -> FloatArray:
    r"""Return standard errors of k_inf, every k and every ln tau, shape (R, 1 + 2 N).

    :math:`S\,(J'J)^{-1}`: the power S of the residuals, their variance times :math:`\kappa = 1 +
    2\sum_l \gamma_l/\gamma_0`, is that of means over a few samples, times their number; a mean of
    forces is the response to the mean of motions. NaN for missing arms, infinite for undetermined
    parameters.

    Parameters
    ----------
    time, x : array, shape (M,)
        Clock, s, and motion, m, of all records.
    records : array, shape (R, M)
        N.
    first : int
        The first sample that was fitted.
    solutions : ManySolutions
    """
    count, arms = solutions.arms.shape
    block_length = max(1, len(time) // MEANS)
    used_samples = slice(-(-first // block_length), None)
    clock, motion, forces = (block_means(values, block_length) for values in (time, x, records))
    errors = np.full((count, 1 + 2 * arms), np.nan)
    for order in range(arms + 1):
        rows = np.flatnonzero(solutions.order == order)
        columns = np.concatenate(([0], 1 + np.arange(order), 1 + arms + np.arange(order)))
        for start in range(0, len(rows), _BATCH_SIZE):
            part = rows[start : start + _BATCH_SIZE]
            jacobian, model = _compute_jacobians(clock, motion, solutions, part, order)
            residual = (forces[part] - model)[:, used_samples]
            errors[np.ix_(part, columns)] = _standard_errors(jacobian[:, :, used_samples], residual)
    return errors


def _compute_jacobians(
    time: FloatArray, x: FloatArray, solutions: ManySolutions, rows: IndexArray, order: int
) -> tuple[FloatArray, FloatArray]:
    """Jacobians (R, 1 + 2 N, n) by k_inf, k and ln tau, and the forces of the solids (R, n)."""
    k, k_inf = solutions.arms[rows, :order], solutions.fixed_coefficients[rows, :1]
    jacobian = np.empty((len(rows), 1 + 2 * order, len(x)))
    jacobian[:, 0] = x
    if not order:
        return jacobian, k_inf * x
    columns_and_slopes = compute_arm_columns(
        time, x, np.exp(solutions.log_tau[rows, :order].ravel())
    )
    q, slope = (part.T.reshape(len(rows), order, -1) for part in columns_and_slopes)
    jacobian[:, 1 : 1 + order] = q
    np.multiply(k[:, :, None], slope, out=jacobian[:, 1 + order :])
    return jacobian, k_inf * x + (k[:, None] @ q)[:, 0]


def _standard_errors(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """Return standard errors (R, p) by the power of the residuals (R, n)."""
    _, parameters, n = jacobian.shape
    gamma = autocovariance(residual)
    mask = np.arange(n) < geyer_cuts(gamma)[:, None]
    power = np.maximum(gamma[:, 0], 2 * (gamma * mask).sum(axis=1) - gamma[:, 0])
    information = jacobian @ jacobian.swapaxes(1, 2)
    length = np.sqrt(np.maximum(np.diagonal(information, axis1=1, axis2=2), 1e-300))
    values, vectors = np.linalg.eigh(information / (length[:, :, None] * length[:, None, :]))
    is_determined = values > _SINGULAR * values[:, -1:]
    with np.errstate(divide="ignore"):
        inverse = np.where(is_determined, 1 / np.maximum(values, 1e-300), np.inf)
    # a direction without information leaves unknown what it touches, and no more
    shares = np.where(vectors**2 > _SINGULAR, vectors**2, 0.0)
    with np.errstate(invalid="ignore"):
        variances = np.where(shares > 0, shares * inverse[:, None, :], 0.0).sum(axis=2)
    return np.asarray(np.sqrt(variances * (power * n / max(n - parameters, 1))[:, None]) / length)
