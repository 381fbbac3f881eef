r"""Consistency of a rod's modulus with a passive Maxwell model of any number of arms.

Lines inverted one by one fit anything: another mode, or a wrong gain. A model does not. Its

.. math:: E^*(\omega) = E_\infty + j\omega b
    + \sum_j E_j\, \frac{j\omega\tau_j}{1 + j\omega\tau_j}, \qquad E_\infty, b, E_j \ge 0

with relaxation times on a grid from far below to far above the lines, is fitted to them beside each
error that all lines share, whose size is known
(:class:`~dashpot.extensions.materials.rod.datamodel.RodErrors`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray
from dashpot.extensions.materials.rod.datamodel import RodModulus
from dashpot.numerics.nonnegative_least_squares import solve_linear

_PER_DECADE, _BEYOND = 12, 30.0
"""Relaxation times of a decade, and factor of their range beyond the lines."""
_MIN_LINES = 8


def compute_single_model_misfit(lines: RodModulus, scatter: FloatArray) -> float | None:
    """Return chi square over the degrees of freedom of the best passive model; None of few lines.

    Parameters
    ----------
    lines : RodModulus
        Used samples of the modulus.
    scatter : array, shape (n,)
        Relative standard deviation of either part of each.
    """
    f, E = lines.frequency, lines.modulus
    if len(f) < _MIN_LINES or not (scatter > 0).all():
        return None
    omega = 2 * np.pi * f
    slowest, fastest = 1 / omega[0] * _BEYOND, 1 / omega[-1] / _BEYOND
    count = int(np.ceil(np.log10(slowest / fastest) * _PER_DECADE)) + 1
    x = 1j * np.outer(omega, np.geomspace(fastest, slowest, count))
    columns = np.column_stack((np.ones(len(f)), 1j * omega, x / (1 + x)))
    errors = [E * relative for relative in lines.error_contributions]
    size = len(errors)
    weight = 1 / (np.abs(E) * scatter)
    A = np.vstack((
        _split_real_imaginary(np.column_stack((columns, *errors)) * weight[:, None]),
        np.eye(size, columns.shape[1] + size, columns.shape[1]),
    ))  # fmt: skip
    y = np.concatenate((_split_real_imaginary(np.asarray(E * weight)), np.zeros(size)))
    is_nonnegative = np.arange(A.shape[1]) < columns.shape[1]
    beta, _ = solve_linear(A, y, is_nonnegative)
    residual = y - A @ beta
    degrees_of_freedom = len(y) - size - int(np.count_nonzero(beta[is_nonnegative]))
    return float(residual @ residual) / max(degrees_of_freedom, 1)


def _split_real_imaginary(rows: npt.NDArray[Any]) -> FloatArray:
    return np.concatenate((rows.real, rows.imag))
