r"""Effect of load-cell noise on the uncertainty of a creep fit.

The fit answers a load freed of its noise, :math:`\hat F = F + W e` with e the white noise of the
readings. To first order the error moves the parameters by :math:`(J^TJ)^{-1} J^T S W e`, with S the
displacement that a load gives. :math:`W^T S^T J` joins the middle of the sandwich: S transposed
runs the same recursions backwards.
"""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.extensions.curves.creep.preprocess import make_load_error_products
from dashpot.extensions.curves.datamodel.creep import LoadHold
from dashpot.numerics.design_matrices.recorded_motion import recursion
from dashpot.solids.interconversion import CreepSpectrum


def load_rows(columns: FloatArray, record: LoadHold, creep: CreepSpectrum) -> FloatArray:
    """Return J' delta of every independent error of the load, of unit variance, shape (m, r).

    `columns` are J, or any turn of it, of the last samples of the record.
    """
    all_columns = np.zeros((len(record.time), columns.shape[1]))
    all_columns[len(all_columns) - len(columns) :] = columns
    return make_load_error_products(record)(load_sensitivity(all_columns, record.time, creep))


def load_sensitivity(columns: FloatArray, time: FloatArray, creep: CreepSpectrum) -> FloatArray:
    """S transposed, times columns: how each reading of the load moves them, shape (n, r)."""
    step = np.diff(time)[:, None]
    response = (creep.glass + sum(creep.d)) * columns
    if creep.flow > 0:
        later_sums = np.cumsum(columns[::-1], axis=0)[::-1]
        halves = 0.5 * creep.flow * step * later_sums[1:]
        response[:-1] += halves
        response[1:] += halves
    for d, lam in zip(creep.d, creep.lam, strict=True):
        z = step / lam
        decay_less_one = np.expm1(-z)
        decay = np.broadcast_to(1 + decay_less_one, (len(z), columns.shape[1]))
        later_response = recursion(decay[::-1], columns[-2::-1], columns[-1])[::-1]
        mean = -decay_less_one / z
        response[0] -= d * (later_response[0] - mean[0] * later_response[1])
        response[1:] -= d * mean * later_response[1:]
        response[1:-1] += d * mean[1:] * later_response[2:]
    return response
