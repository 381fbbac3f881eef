"""Relaxation of a fit, for materials whose elastic law is not linear."""

from __future__ import annotations

from dashpot.base.errors import FitError
from dashpot.solids.maxwell import GeneralizedMaxwell


def normalise_relaxation(model: GeneralizedMaxwell) -> GeneralizedMaxwell:
    """Return a model divided by its stiffness at rest, so that k_inf is 1.

    Raises
    ------
    FitError
        If it has no stiffness at rest.
    """
    if not model.k_inf > 0:
        raise FitError(
            "the relaxation test found no stiffness at rest, so its relaxation function has no "
            "scale; hold it longer"
        )
    return model * (1 / model.k_inf)
