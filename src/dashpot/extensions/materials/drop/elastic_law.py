r"""Elastic law of a drop test: a known one or none, and an added cubic spring.

.. math:: F_e(x) = F_0(x) + c_1 x + c_2 x^2 + c_3 x^3, \qquad P\,c \sim N(0, 1)

with :math:`F_0` the law of a load deflection test and P the weights of its errors; without such a
test both are zero.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.datamodel.fit import Fit
from dashpot.solids.elastic import ElasticLaw

POWERS = np.arange(1.0, 4.0)
MIN_SD = 0.01
"""Least relative standard deviation of a tangent by a load deflection test."""
_KNOT_COUNT = 17


@dataclass(frozen=True, eq=False)
class ElasticLawPrior(EqualByValue):
    """Elastic law as known before the fit, with its uncertainty.

    Attributes
    ----------
    law : ElasticLaw or None
        Law that is known before the fit; None if there is none and the drop tests alone give it.
    precision : array, shape (m, 3)
        Rows whose products with c, N/m, N/m^2 and N/m^3, are normal of standard deviation 1.
    """

    law: ElasticLaw | None
    precision: FloatArray

    @classmethod
    def without_law(cls) -> ElasticLawPrior:
        """Return the prior without a known law."""
        return cls(None, np.zeros((0, len(POWERS))))

    @classmethod
    def from_fit(cls, fit: Fit, length_ratio: float = 1.0) -> ElasticLawPrior:
        """Return the law of a load deflection fit; of a fit at one depth :meth:`without_law`.

        The tangent at each knot is known to its standard error, or to 1 %. Errors of neighbouring
        knots are taken as equal, so that three numbers are each known as well as one knot.
        """
        law = fit.elastic_law
        if law is None or law.kind == "linear":
            return cls.without_law()
        law = length_ratio * law
        knots, tangent = np.asarray(law.knots), np.asarray(law.tangents)
        error = law.stiffness * np.asarray(law.ratio_se or np.zeros(len(knots)))
        min_sd = MIN_SD * np.maximum(tangent, MIN_SD * tangent.max())
        sd = np.maximum(error, min_sd) * np.sqrt(max(len(knots) / len(POWERS), 1.0))
        return cls(law, POWERS * knots[:, None] ** (POWERS - 1) / sd[:, None])

    def force(self, x: FloatArray, c: FloatArray) -> FloatArray:
        """Return the relaxed force, N, at compressions, m, shape (n,), by rows of c, (n, 3)."""
        x = np.maximum(x, 0.0)  # after release the mass flies on
        values = x * (c[..., 0] + x * (c[..., 1] + x * c[..., 2]))
        return values if self.law is None else np.asarray(values + self.law.force(x))

    def piecewise(self, c: FloatArray, depth: float) -> ElasticLaw:
        """Return the elastic law on knots to a depth, m."""
        knots, ratio, stiffness = self.compute_knot_tangents(c, depth)
        return ElasticLaw(tuple(knots.tolist()), tuple(ratio.tolist()), stiffness)

    def compute_knot_tangents(
        self, c: FloatArray, depth: float
    ) -> tuple[FloatArray, FloatArray, float]:
        """Return knots, m, the tangents there over the secant, and the secant at the depth, N/m."""
        knots = np.linspace(0.0, depth, _KNOT_COUNT)
        slope = (POWERS * knots[:, None] ** (POWERS - 1)) @ c
        if self.law is not None:
            slope = slope + self.law.tangent(knots)
        slope = np.maximum(slope, 0.0)
        secant = float(np.trapezoid(slope, knots)) / depth
        return knots, slope / max(secant, 1e-300), secant
