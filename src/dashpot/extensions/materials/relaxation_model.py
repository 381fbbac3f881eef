"""Relaxation of a fit, for materials whose elastic law is not linear."""

from __future__ import annotations

from dashpot.base.errors import FitError
from dashpot.solids.maxwell import GeneralizedMaxwell


def normalise_relaxation(solid: GeneralizedMaxwell) -> GeneralizedMaxwell:
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
