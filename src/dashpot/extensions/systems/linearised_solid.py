"""Solid whose amplitude-dependent part is linearised at one amplitude."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, to_complex
from dashpot.base.errors import DataError
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.solids.rate_independent import AmplitudeDependent


@dataclass(frozen=True)
class Linearised(Solid):
    """Solid in parallel with an element linearised at one amplitude.

    Attributes
    ----------
    solid : Solid
    rate_independent : AmplitudeDependent
    amplitude : float
        m.
    """

    solid: Solid
    rate_independent: AmplitudeDependent
    amplitude: float

    @property
    def k_inf(self) -> float:  # type: ignore[override]  # others keep it as a field
        """Stiffness, N/m, of slow motion of that amplitude."""
        return self.solid.k_inf + float(self.rate_independent.equivalent(0.0, self.amplitude).real)

    @property
    def k_0(self) -> float:  # type: ignore[override]
        """Stiffness, N/m, of fast motion of that amplitude."""
        return self.solid.k_0 + float(self.rate_independent.equivalent(1e12, self.amplitude).real)

    @property
    def maxwell(self) -> GeneralizedMaxwell:
        """Refused: friction loses the same at every frequency, which no arm does.

        Raises
        ------
        DataError
        """
        raise DataError(
            "friction has no arms, and so no linear equations in time; its answers are "
            "response_at_level, newton_modes and the FRF at an amplitude, or path_force in time"
        )

    def stiffness_at(self, s: npt.ArrayLike) -> ComplexArray:
        """Return stiffness on the Laplace plane, N/m, `s` in 1/s; the part's is that of Im s."""
        s = to_complex(s)
        extra = self.rate_independent.equivalent(np.abs(s.imag), self.amplitude)
        loss = np.where(s.imag < 0, extra.conj(), extra)
        return np.asarray(self.solid.stiffness_at(s) + loss)

    def __mul__(self, count: float) -> Linearised:
        """`count` in parallel."""
        return replace(
            self, solid=self.solid * count, rate_independent=self.rate_independent * count
        )

    __rmul__ = __mul__
