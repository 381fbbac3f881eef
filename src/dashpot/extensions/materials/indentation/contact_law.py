r"""Contact laws of a body on a viscoelastic half-space: force against indentation.

With x the indentation and n = 1 (a flat punch, or any contact taken as linear) or 3/2 (a sphere):

.. math:: F = k\,\Bigl(x^n + A \frac{d x^n}{dt}\Bigr)

n = 1 is Kelvin and Voigt's, c = k A; n = 3/2 with A = 0 is Hertz's,
:math:`k = \tfrac43 E^*\sqrt R`, with A > 0 that of Kuwabara and Kono. A material that relaxes,
:math:`E(t) = E_\infty (1 + g\,e^{-t/\tau})`, answers by the history:

.. math:: F = k \int_0^{t_1} \bigl(1 + g\,e^{-(t-s)/\tau}\bigr)\, \frac{d x^{3/2}}{ds}\,ds

with :math:`t_1 = t` while the contact grows (Lee and Radok) and afterwards the earlier time at
which it was as large as it is now, :math:`\int_{t_1}^t E(t-s)\,x'(s)\,ds = 0` (Ting).
Sources: G. Kuwabara, K. Kono, Jpn. J. Appl. Phys. 26 (1987) 1230; E. H. Lee, J. R. M. Radok,
J. Appl. Mech. 27 (1960) 438; T. C. T. Ting, J. Appl. Mech. 33 (1966) 845.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_positive

SPHERE_EXPONENT = 1.5
"""Exponent of a sphere on a half-space."""


@dataclass(frozen=True)
class ViscousContact:
    """Spring with a parallel dashpot, over a contact area that may grow.

    Attributes
    ----------
    k : float
        N/m^n, > 0.
    viscous_time : float
        A, s, >= 0.
    exponent : float
        n: 1 or 3/2.
    """

    k: float
    viscous_time: float = 0.0
    exponent: float = SPHERE_EXPONENT

    def __post_init__(self) -> None:
        require_positive(k=self.k, expected="a finite number above 0")
        if not 0 <= self.viscous_time < np.inf:
            raise DataError(f"viscous_time = {self.viscous_time!r} s; expected 0 or more")
        if self.exponent not in {1.0, SPHERE_EXPONENT}:
            raise DataError(f"exponent = {self.exponent!r}; expected 1 or 1.5")

    @property
    def c(self) -> float:
        """Damping of a linear contact, N s/m."""
        return self.k * self.viscous_time

    def force(self, x: npt.ArrayLike, v: npt.ArrayLike) -> FloatArray:
        """Force, N, at an indentation, m, and its rate, m/s; none out of contact."""
        indentation = np.maximum(np.asarray(x, dtype=float), 0.0)
        n = self.exponent
        slope = n * indentation ** (n - 1)
        return np.asarray(self.k * (indentation**n + self.viscous_time * slope * np.asarray(v)))


@dataclass(frozen=True)
class RelaxingContact:
    """Sphere on a material with one Maxwell arm.

    Attributes
    ----------
    k : float
        Stiffness of the relaxed material, N/m^1.5, > 0.
    g : float
        The arm's stiffness over k, >= 0.
    tau : float
        s, > 0.
    """

    k: float
    g: float
    tau: float

    exponent = SPHERE_EXPONENT

    def __post_init__(self) -> None:
        require_positive(k=self.k, tau=self.tau, expected="a finite number above 0")
        if not 0 <= self.g < np.inf:
            raise DataError(f"g = {self.g!r}; expected 0 or more")


ContactLaw: TypeAlias = ViscousContact | RelaxingContact


def sphere_stiffness(modulus: float, radius: float) -> float:
    r"""Return k, N/m^1.5, of a rigid sphere: :math:`\tfrac43 E^* \sqrt R`, Pa and m."""
    return 4 / 3 * modulus * float(np.sqrt(radius))


def reduced_modulus(k: float, radius: float) -> float:
    r"""Return :math:`E^* = E / (1 - \nu^2)`, Pa, of k in N/m^1.5 under a rigid sphere, m."""
    return 0.75 * k / float(np.sqrt(radius))
