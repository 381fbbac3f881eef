"""A relaxation modulus over time: the answer to a unit step, as a curve."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, increasing, measured, same_length
from dashpot.base.errors import DataError
from dashpot.base.offered import Described
from dashpot.base.provenance import Source, of_file
from dashpot.base.units import Quantity, si
from dashpot.records.specimen import Specimen, tested_at
from dashpot.records.temperature import ONE_TEMPERATURE, near


@dataclass(frozen=True, eq=False, repr=False)
class RelaxationModulus(ByValue, Described):
    r"""A curve :math:`E(t)`, measured or shifted together, after a step at t = 0.

    Attributes
    ----------
    time : array, shape (n,)
        s since the step, >= 0, strictly increasing; at several temperatures in any order.
    modulus : array, shape (n,)
        Pa for a material, N/m for a part (`unit`).
    temperature : array, shape (n,), or None
        K, where the curve was measured at several; to be shifted together.
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
    temperature: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", measured("time", self.time))
        object.__setattr__(self, "modulus", measured("modulus", self.modulus))
        if self.temperature is not None:
            object.__setattr__(self, "temperature", measured("temperature", self.temperature))
            tested_at("temperature", self.temperature.min(), self.temperature.max())
        else:
            increasing("time", self.time)
        same_length(time=self.time, modulus=self.modulus, temperature=self.temperature)
        if self.time.min() < 0:
            raise DataError(
                f"time begins at {self.time.min():g} s; expected the time since the step, >= 0"
            )
        if self.unit not in {"Pa", "N/m"}:
            raise DataError(f"unit '{self.unit}' of the modulus; expected 'Pa' or 'N/m'")

    def at(self, temperature: Quantity) -> RelaxationModulus:
        """The samples within a kelvin of a temperature, K, in order of time.

        Raises
        ------
        DataError
            If there are none, or two at the same time.
        """
        kelvin = si(temperature, "temperature")
        chosen = np.flatnonzero(near(self.temperature, kelvin))
        chosen = chosen[np.argsort(self.time[chosen], kind="stable")]
        return replace(
            self,
            time=self.time[chosen],
            modulus=self.modulus[chosen],
            temperature=None,
            specimen=replace(self.specimen, temperature=kelvin),
        )

    @property
    def several_temperatures(self) -> bool:
        """Whether the samples are too far apart in temperature to be of one solid."""
        return self.temperature is not None and bool(np.ptp(self.temperature) > ONE_TEMPERATURE)

    @property
    def described(self) -> tuple[str, ...]:
        """Which curve it is, and what it covers."""
        warm = ""
        if self.temperature is not None:
            warm = f", {self.temperature.min():.5g} to {self.temperature.max():.5g} K"
        return (
            of_file(self.source, len(self.time)),
            (
                f"{self.modulus[0]:.5g} to {self.modulus[-1]:.5g} {self.unit} over "
                f"{self.time.min():.4g} to {self.time.max():.5g} s{warm}"
            ),
        )
