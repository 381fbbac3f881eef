"""How far a seal is believed to be pressed."""

from __future__ import annotations

import math

from dashpot.base.errors import DataError
from dashpot.base.units import format_quantity
from dashpot.solids.elastic import ElasticLaw

FARTHEST = 3.0
"""Times the depth tested, at most."""


def require_plausible_compression(
    compression: float,
    law: ElasticLaw | None,
    height: float | None,
    *,
    carried: float | None = None,
) -> None:
    """Refuse a compression, m, that no such seal has: more than its height, or far from any test.

    Parameters
    ----------
    compression : float
        m; where it is infinite nothing carries the weight, which is no matter here.
    law : ElasticLaw, optional
        Of the seal, with the depth that was tested.
    height : float, optional
        Of the seal, m.
    carried : float, optional
        The mass, kg, that presses each seal; None where the compression was given.

    Raises
    ------
    DataError
    """
    if not math.isfinite(compression):
        return
    if height is not None and compression >= height:
        name = f"it is {format_quantity(height, 'mm')} high"
    elif law is not None and compression > FARTHEST * law.depth:
        name = f"it was tested to {format_quantity(law.depth, 'mm', '.3g')}"
    else:
        return
    pressed, requested = "the compression given presses", "check its unit"
    if carried is not None:
        pressed = f"a mass of {carried:.4g} kg on each presses"
        requested = "check the mass and its unit (is it g?), and the number of seals"
    raise DataError(
        f"{pressed} the seal by {format_quantity(compression, 'mm')}, but {name}: {requested}"
    )
