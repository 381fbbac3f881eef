"""The parameters of a fit as a vector, and the solid of another vector."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.records.estimate import ELEMENT
from dashpot.records.fit import Fit
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

_LEAST = 0.02
"""Part of a stiffness that is left of it, however far it is moved."""


def values(fit: Fit) -> FloatArray | None:
    """Return the parameters in the order of the covariance; None where it is not of them."""
    solid = fit.solid
    if isinstance(solid, FractionalZener):
        found = np.array([solid.k_inf, solid.k_0, np.log(solid.tau), solid.alpha])
    else:
        own = fit.model
        found = np.array([own.k_inf, *own.k, *np.log(own.tau), *([own.b] if own.b else [])])
    return found if len(found) == len(fit.parameters) else None


def off_by_error(fit: Fit) -> tuple[Solid, ...]:
    """Return the solid one standard error off, along each axis of the covariance.

    None where no covariance is known; a stiffness is moved no nearer to 0 than 2 % of it.
    """
    here = values(fit)
    if here is None or not np.isfinite(fit.covariance).all():
        return ()
    size, turn = np.linalg.eigh(fit.covariance)
    axes = (turn * np.sqrt(np.maximum(size, 0.0))).T
    return tuple(_solid(fit, here, here + by) for by in axes)


def _solid(fit: Fit, here: FloatArray, there: FloatArray) -> Solid:
    if fit.parameters == ELEMENT:
        k_inf, k_0 = np.maximum(there[:2], _LEAST * here[:2])
        alpha = float(np.clip(there[3], 0.05, 1.0))
        return FractionalZener(float(k_0), float(k_inf), float(np.exp(there[2])), alpha)
    arms = fit.model.arms
    k = np.maximum(there[: 1 + arms], _LEAST * here[: 1 + arms]).tolist()
    tau = np.exp(there[1 + arms : 1 + 2 * arms])
    order = np.argsort(tau)
    return GeneralizedMaxwell(
        k[0], tuple(k[1 + i] for i in order), tuple(tau[order].tolist()), fit.model.b
    )
