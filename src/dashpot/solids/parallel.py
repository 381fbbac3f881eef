"""Solids side by side that no single one of their kind stands for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import add

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.serialisation import Serialisable
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid


@dataclass(frozen=True)
class Parallel(Solid, Serialisable):
    """Solids that share one displacement: their forces add.

    Attributes
    ----------
    parts : tuple of Solid
        At least one; parts that are themselves in parallel are laid out side by side.
    """

    schema = "dashpot/parallel@1"

    parts: tuple[Solid, ...]

    def __post_init__(self) -> None:
        flat = [
            part
            for solid in self.parts
            for part in (solid.parts if isinstance(solid, Parallel) else [solid])
        ]
        if not flat or not all(isinstance(part, Solid) for part in flat):
            raise DataError(
                f"parts = {self.parts!r}; expected at least one solid, and nothing else"
            )
        object.__setattr__(self, "parts", tuple(flat))

    @property
    def k_inf(self) -> float:  # type: ignore[override]  # others keep it as a field
        """Equilibrium stiffness, N/m."""
        return sum(part.k_inf for part in self.parts)

    @property
    def k_0(self) -> float:  # type: ignore[override]
        """Instantaneous stiffness, N/m."""
        return sum(part.k_0 for part in self.parts)

    @property
    def maxwell(self) -> GeneralizedMaxwell:
        """The arms of all parts."""
        return reduce(add, (part.maxwell for part in self.parts))

    def stiffness_at(self, s: npt.ArrayLike) -> ComplexArray:
        """Stiffness on the Laplace plane, N/m, `s` in 1/s: the sum of the parts."""
        return np.asarray(sum(part.stiffness_at(s) for part in self.parts))

    def relaxation(self, t: npt.ArrayLike) -> FloatArray:
        """Relaxation stiffness, N/m, for t > 0 in s: the sum of the parts."""
        return np.asarray(sum(part.relaxation(t) for part in self.parts))

    def force(self, t: npt.ArrayLike, displacement: npt.ArrayLike) -> FloatArray:
        """Force, N, under a displacement history, m, that is straight between its samples."""
        return np.asarray(sum(part.force(t, displacement) for part in self.parts))

    def __add__(self, other: object) -> Parallel:
        """One more solid beside them."""
        return Parallel((self, other)) if isinstance(other, Solid) else NotImplemented

    __radd__ = __add__

    def __mul__(self, count: float) -> Parallel:
        """`count` equal solids in parallel; a fraction is a shorter piece of seal."""
        return Parallel(tuple(part * count for part in self.parts))

    __rmul__ = __mul__
