"""The parameters of a fit as a vector, and the solid of another vector."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.parameter_estimate import ELEMENT, parameter_names
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

_LEAST = 0.02
"""Part of a stiffness that is left of it, however far it is moved."""


class SolidParameters(NamedTuple):
    """The parameters of a fit's solid by their names, and their covariance.

    The covariance is zero for what the fit holds.
    """

    names: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray


def own(fit: Fit) -> SolidParameters:
    """Return the parameters of the solid, in the order of a covariance that is of them alone."""
    solid = fit.solid
    names: tuple[str, ...] = ELEMENT
    if isinstance(solid, FractionalZener):
        results = [solid.k_inf, solid.k_0, np.log(solid.tau), solid.alpha]
    else:
        model, dashpot = fit.model, "b" in fit.parameters
        names = parameter_names(model.arms, dashpot=dashpot)
        results = [model.k_inf, *model.k, *np.log(model.tau), *([model.b] if dashpot else [])]
    here = [i for i, name in enumerate(names) if name in fit.parameters]
    rows = [fit.parameters.index(names[i]) for i in here]
    covariance = np.zeros((len(names), len(names)))
    covariance[np.ix_(here, here)] = fit.covariance[np.ix_(rows, rows)]
    return SolidParameters(names, np.array(results), covariance)


def values(fit: Fit) -> FloatArray | None:
    """Return the parameters in the order of the covariance; None where it is not of them."""
    names, result, _ = own(fit)
    return result if names == fit.parameters else None


def axes(covariance: FloatArray) -> FloatArray:
    """Return one standard error along each axis of a covariance, a row each, shape (p, p).

    The sign of an axis is that of its first part that is not small: no library chooses it.
    """
    size, turn = np.linalg.eigh(covariance)
    rows = (turn * np.sqrt(np.maximum(size, 0.0))).T
    parts = np.abs(turn.T)
    first = np.argmax(parts > 0.5 * parts.max(axis=1, keepdims=True), axis=1)
    return np.asarray(rows * np.sign(turn.T[np.arange(len(first)), first])[:, None])


def root(covariance: FloatArray) -> FloatArray:
    """Return the symmetric square root of a covariance, shape (p, p), which is the only one."""
    size, turn = np.linalg.eigh(covariance)
    return np.asarray((turn * np.sqrt(np.maximum(size, 0.0))) @ turn.T)


def off_by_error(fit: Fit) -> tuple[Solid, ...]:
    """Return the solid one standard error off, along each axis of the covariance.

    None where no covariance is known; a stiffness is moved no nearer to 0 than 2 % of it.
    """
    here = values(fit)
    if here is None or not np.isfinite(fit.covariance).all():
        return ()
    return tuple(_solid(fit, here, here + by) for by in axes(fit.covariance))


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


def memory_of(solid: GeneralizedMaxwell) -> GeneralizedMaxwell:
    """Return the arms of a solid over its stiffness at rest: a solid whose k_inf is 1.

    Raises
    ------
    FitError
        If it has no stiffness at rest.
    """
    if not solid.k_inf > 0:
        raise FitError(
            "the relaxation test found no stiffness at rest, so that its memory has no scale; "
            "hold it longer"
        )
    return solid * (1 / solid.k_inf)
