"""A solid that is no sum of arms: what takes any solid is tested with it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dashpot.solids.maxwell import GeneralizedMaxwell, Solid


@dataclass(frozen=True)
class FractionalZener(Solid):
    r"""A spring beside a springpot in series with a spring.

    .. math:: K(s) = k_\infty + k \frac{(s\tau)^\alpha}{1 + (s\tau)^\alpha}

    Its relaxation spectrum is that of Cole and Cole, continuous over all relaxation times.
    """

    k_inf: float
    k: float
    tau: float
    alpha: float

    @property
    def k_0(self) -> float:
        return self.k_inf + self.k

    @property
    def maxwell(self) -> GeneralizedMaxwell:
        z = np.linspace(-24.0, 24.0, 49)
        angle = np.pi * self.alpha
        density = np.sin(angle) / (np.cosh(self.alpha * z) + np.cos(angle)) / (2 * np.pi)
        return GeneralizedMaxwell(self.k_inf, self.k * density, self.tau * np.exp(z))

    def stiffness_at(self, s):
        power = (np.asarray(s, dtype=complex) * self.tau) ** self.alpha
        return self.k_inf + self.k * power / (1 + power)

    def __mul__(self, count: float) -> FractionalZener:
        return replace(self, k_inf=count * self.k_inf, k=count * self.k)

    __rmul__ = __mul__


SEAL = FractionalZener(196.5, 140.0, 0.6, 0.6)
"""About as stiff as the paper's seal."""
