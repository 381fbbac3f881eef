"""A relaxation modulus over time: the answer to a unit step, as a curve."""

from __future__ import annotations

from dataclasses import dataclass, field

from dashpot.base.arrays import ByValue, FloatArray, increasing, measured, same_length
from dashpot.base.errors import DataError
from dashpot.base.offered import Described
from dashpot.base.provenance import Source, of_file
from dashpot.records.specimen import Specimen


@dataclass(frozen=True, eq=False, repr=False)
class RelaxationModulus(ByValue, Described):
    r"""A curve :math:`E(t)`, measured or shifted together, after a step at t = 0.

    Attributes
    ----------
    time : array, shape (n,)
        s since the step, >= 0, strictly increasing.
    modulus : array, shape (n,)
        Pa for a material, N/m for a part (`unit`).
    unit : str
        ``"Pa"`` or ``"N/m"``.
    specimen : Specimen
    source : Source or None

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or time falls or starts below 0.
    """

    time: FloatArray
    modulus: FloatArray
    unit: str = "Pa"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", increasing("time", measured("time", self.time)))
        object.__setattr__(self, "modulus", measured("modulus", self.modulus))
        same_length(time=self.time, modulus=self.modulus)
        if self.time[0] < 0:
            raise DataError(f"time[0] = {self.time[0]:g} s; expected the time since the step, >= 0")
        if self.unit not in {"Pa", "N/m"}:
            raise DataError(f"unit '{self.unit}' of the modulus; expected 'Pa' or 'N/m'")

    @property
    def described(self) -> tuple[str, ...]:
        """Which curve it is, and what it covers."""
        return (
            of_file(self.source, len(self.time)),
            (
                f"{self.modulus[0]:.5g} to {self.modulus[-1]:.5g} {self.unit} over "
                f"{self.time[0]:.4g} to {self.time[-1]:.5g} s"
            ),
        )
