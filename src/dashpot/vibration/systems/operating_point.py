r"""Where a mass rests on seals, and what small vibration feels there.

At rest n seals carry the weight, :math:`n F_e(x) = m g`; vibration about that compression feels the
tangent of the elastic law, :math:`F_e'(x)/k` times every stiffness of the solid that a test found,
k its secant stiffness at the depth tested (Fung: all arms answer :math:`F_e(x(t))`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.units import GRAVITY
from dashpot.base.validators import require_positive
from dashpot.datamodel.compression_limits import require_plausible_compression
from dashpot.datamodel.fit import Fit
from dashpot.solids.maxwell import Solid


@dataclass(frozen=True)
class MassOnSeals:
    """A mass on so many equal seals.

    Attributes
    ----------
    mass : float
        With what moves of the seals, kg.
    seals : float
        How many carry it.
    compression : float or None
        Of the seals, m; by default where :math:`n F_e(x) = m g`.
    coupled : float
        Of seals that weigh something, the mass that couples both ends, kg
        (:mod:`dashpot.vibration.systems.mount_mass`).
    """

    mass: float
    seals: float = 1.0
    compression: float | None = None
    coupled: float = 0.0

    @property
    def keywords(self) -> dict[str, Any]:
        """The mass, seals and compression as arguments of what predicts or identifies them."""
        return {"mass": self.mass, "seals": self.seals, "compression": self.compression}

    def scaled_down(self, scale: float) -> MassOnSeals:
        """Return masses so many times as small on the same seals."""
        return replace(self, mass=self.mass / scale, coupled=self.coupled / scale)


@dataclass(frozen=True)
class OperatingPoint:
    """A compression, and what the seal is there.

    Attributes
    ----------
    compression : float
        m; infinite where nothing carries the weight at rest.
    depth : float or None
        The deepest compression tested, m; None if the fit has no elastic law.
    factor, factor_se : float
        Tangent stiffness over the fit's, and its standard error.
    linear : bool
        The fit's elastic law is a straight line, or it has none: the factor is 1.
    given : bool
        The compression was given; else it is that of the weight.
    """

    compression: float
    depth: float | None
    factor: float = 1.0
    factor_se: float = 0.0
    linear: bool = True
    given: bool = False

    @property
    def beyond(self) -> bool:
        """Deeper than tested: there the last tangent goes on."""
        return self.depth is not None and self.compression > self.depth

    def solid(self, fit: Fit) -> Solid:
        """One seal as small vibration feels it."""
        return fit.solid if self.linear else self.factor * fit.solid


def operating_point(
    fit: Fit, *, mass: float, seals: float = 1.0, compression: float | None = None
) -> OperatingPoint:
    r"""The compression of a mass's weight, or one given, and the tangent there.

    Parameters
    ----------
    fit : Fit
        Of one seal.
    mass : float
        kg.
    seals : float
        How many carry it.
    compression : float, optional
        m; by default where :math:`n F_e(x) = m g`.

    Raises
    ------
    DataError
        If a number cannot be, the fit is of a material, no compression carries the weight, or
        the seal would be pressed beyond its height or ten times as deep as it was tested.
    """
    require_positive(mass=mass, seals=seals)
    require_positive(compression=compression, optional=True)
    if fit.unit != "N/m":
        raise DataError(
            f"the fit is of a material's modulus, in {fit.unit}; a mass rests on a part. Give its "
            'shape: --shape disc:20mm,20mm (Python: fit.part("disc:20mm,20mm"))'
        )
    law, provided = fit.elastic_law, compression is not None
    bent = law is not None and law.kind != "linear"
    if compression is None:
        k_inf = fit.model.k_inf
        compression = mass * GRAVITY / (seals * k_inf) if k_inf > 0 else np.inf
        if law is not None and bent:
            compression = law.compression(mass * GRAVITY / seals)
    require_plausible_compression(
        compression, law, fit.specimen.height, carried=None if provided else mass / seals
    )
    if law is None or not bent:
        depth = None if law is None else law.depth
        return OperatingPoint(float(compression), depth, given=provided)
    factor, error = float(law.factor(compression)), float(law.factor_se(compression))
    return OperatingPoint(
        float(compression), law.depth, factor, error, linear=False, given=provided
    )
