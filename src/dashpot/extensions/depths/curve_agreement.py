"""The relaxed force of an elastic law beside a measured compression curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import require_increasing, require_same_length, validate_samples
from dashpot.base.errors import DataError
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.solids.elastic import ElasticLaw


@dataclass(frozen=True)
class CurveAgreement:
    """Relaxed force beside the force of a compression (load-deflection) curve.

    Attributes
    ----------
    depth : float
        m.
    relaxed, curve : float
        Equilibrium force of the relaxation test, and force on the curve at this depth, N.
    message : str
    """

    depth: float
    relaxed: float
    curve: float
    message: str

    @property
    def difference(self) -> float:
        """Curve over relaxed force, less one."""
        return self.curve / self.relaxed - 1.0


def compare_with_curve(
    law: ElasticLaw,
    depths: Sequence[float],
    *,
    displacement: npt.ArrayLike,
    force: npt.ArrayLike,
) -> tuple[CurveAgreement, ...]:
    """Compare the relaxed force with a slow compression curve at the tested depths.

    Parameters
    ----------
    law : ElasticLaw
    depths : sequence of float
        m.
    displacement, force : array_like, shape (n,)
        The loading branch of the curve, m (rising) and N.

    Raises
    ------
    DataError
        If the curve does not reach a depth or its displacement does not rise.
    """
    x = require_increasing(
        "displacement", validate_samples("displacement", displacement, minimum=2)
    )
    y = validate_samples("force", force, minimum=2)
    require_same_length(displacement=x, force=y)
    agreements = []
    for depth in depths:
        if not x[0] <= depth <= x[-1]:
            raise DataError(
                f"the compression curve runs from {convert_to_unit(x[0], 'mm'):.4g} to "
                f"{format_quantity(x[-1], 'mm')} and does not reach the depth of "
                f"{format_quantity(depth, 'mm')}; "
                "measure it deeper"
            )
        law_force, curve = float(law.force(depth)), float(np.interp(depth, x, y))
        deviation = 100 * (curve / law_force - 1.0)
        agreements.append(
            CurveAgreement(
                depth,
                law_force,
                curve,
                f"at {format_quantity(depth, 'mm')} the compression curve reads {curve:.4g} N, "
                f"{deviation:+.2g} % of the relaxed {law_force:.4g} N; a curve driven at a finite "
                "speed lies above by what has not relaxed yet",
            )
        )
    return tuple(agreements)
