"""Effect of a systematic error of a record on the parameters of its fit."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.numerics.inference.covariance_estimate import Estimate


def estimate_parameter_shift(estimate: Estimate, change: FloatArray) -> FloatArray:
    """Return by how much theta and beta follow a change of the model's rows, to first order."""
    is_free, shift = estimate.optimum.free, np.zeros(len(estimate.covariance))
    J = estimate.optimum.jacobian[:, is_free]
    size = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
    shift[is_free] = -np.linalg.lstsq(J / size, change, rcond=1e-12)[0] / size
    return shift
