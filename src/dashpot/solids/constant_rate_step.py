r"""What arms carry over a short step in which their part moves evenly, exactly.

With :math:`a = h/\tau` and the force :math:`d = k\,\Delta u` that a step gives an arm,

.. math:: q(h) = q(0)\,e^{-a} + d\,\frac{1 - e^{-a}}{a}, \qquad
          \frac1h \int_0^h q\,dt = q(0)\,\frac{1 - e^{-a}}{a}
          + d\,\Bigl(1 - \frac{1 - e^{-a}}{a}\Bigr)\Big/a

however short or long the time of an arm is beside the step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray


class EvenStep(NamedTuple):
    """Factors of what an arm carries and of what a step gives it, each of the shape of h / tau.

    Attributes
    ----------
    kept : array
        Of what it carried, on the average of the step; of what is given, at its end.
    left : array
        Of what it carried, at the end of the step.
    onward : array
        Of what is given, on the average of the step.
    """

    kept: FloatArray
    left: FloatArray
    onward: FloatArray

    @classmethod
    def from_ratio(cls, ratio: FloatArray) -> EvenStep:
        """For steps of h / tau > 0."""
        retained = -np.expm1(-ratio) / ratio
        onward = np.where(ratio < 1e-4, 0.5 - ratio / 6, (1 - retained) / ratio)
        return cls(retained, 1 - ratio * retained, onward)

    def mean(self, carried: FloatArray, provided: FloatArray) -> FloatArray:
        """What arms carry on the average of the step, N."""
        return carried * self.kept + provided * self.onward

    def end(self, carried: FloatArray, provided: FloatArray) -> FloatArray:
        """What they carry at its end, N."""
        return carried * self.left + provided * self.kept
