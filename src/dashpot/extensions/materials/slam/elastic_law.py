r"""Elastic law under slams: a known one or none, and an added cubic spring.

.. math:: F_e(x) = F_0(x) + c_1 x + c_2 x^2 + c_3 x^3, \qquad P\,c \sim N(0, 1)

with :math:`F_0` the law of a load deflection test and P how well that is known; of a law that is
free both are nothing.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.datamodel.fit import Fit
from dashpot.solids.elastic import ElasticLaw

POWERS = np.arange(1.0, 4.0)
LEAST_SD = 0.01
"""No load deflection test knows the law of a piece better than this part."""
_KNOTS = 17


@dataclass(frozen=True, eq=False)
class SlamLaw(EqualByValue):
    """Elastic law as known before the slams.

    Attributes
    ----------
    known : ElasticLaw or None
        None where the law is free.
    precision : array, shape (m, 3)
        Rows whose products with c, N/m, N/m^2 and N/m^3, are normal of standard deviation 1.
    """

    known: ElasticLaw | None
    precision: FloatArray

    @classmethod
    def free(cls) -> SlamLaw:
        """Nothing is known."""
        return cls(None, np.zeros((0, len(POWERS))))

    @classmethod
    def from_fit(cls, fit: Fit, longer: float = 1.0) -> SlamLaw:
        """That of a load deflection test, in a fit; free where the fit holds one depth alone.

        Its tangent at each knot is known to its standard error, or to 1 %; three numbers are each
        known as well as one knot, for errors of neighbours are alike.
        """
        law = fit.elastic_law
        if law is None or law.kind == "linear":
            return cls.free()
        law = longer * law
        knots, tangent = np.asarray(law.knots), np.asarray(law.tangents)
        error = law.stiffness * np.asarray(law.ratio_se or np.zeros(len(knots)))
        floor = LEAST_SD * np.maximum(tangent, LEAST_SD * tangent.max())
        sd = np.maximum(error, floor) * np.sqrt(max(len(knots) / len(POWERS), 1.0))
        return cls(law, POWERS * knots[:, None] ** (POWERS - 1) / sd[:, None])

    def force(self, x: FloatArray, c: FloatArray) -> FloatArray:
        """Relaxed force, N, at compressions, m, shape (n,), each by its c, shape (n, 3)."""
        x = np.maximum(x, 0.0)  # a mass that was let go flies on
        values = x * (c[..., 0] + x * (c[..., 1] + x * c[..., 2]))
        return values if self.known is None else np.asarray(values + self.known.force(x))

    def piecewise(self, c: FloatArray, depth: float) -> ElasticLaw:
        """Return the law to a depth, m, on knots."""
        knots, ratio, stiffness = self.compute_knot_tangents(c, depth)
        return ElasticLaw(tuple(knots.tolist()), tuple(ratio.tolist()), stiffness)

    def compute_knot_tangents(
        self, c: FloatArray, depth: float
    ) -> tuple[FloatArray, FloatArray, float]:
        """Knots, m, the tangent there over the secant, and that secant at the depth, N/m."""
        knots = np.linspace(0.0, depth, _KNOTS)
        slope = (POWERS * knots[:, None] ** (POWERS - 1)) @ c
        if self.known is not None:
            slope = slope + self.known.tangent(knots)
        slope = np.maximum(slope, 0.0)
        secant = float(np.trapezoid(slope, knots)) / depth
        return knots, slope / max(secant, 1e-300), secant
