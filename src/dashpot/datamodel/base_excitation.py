"""A base that is shaken and the mass on it, as recorded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import EqualByValue, FloatArray, hold_measured, number_of_run, slices
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.result_mixins import HasSummary, Series, collect_arrays
from dashpot.base.validators import require_positive


@dataclass(frozen=True, eq=False, repr=False)
class ShakenTest(EqualByValue, HasSummary):
    """The motions of a base and of the mass on its mounts, sampled together.

    Attributes
    ----------
    rate : float
        Samples a second, Hz.
    base, mass : array, shape (n,)
        The base's acceleration, m/s^2, and the mass's motion in the same direction.
    order : int
        How often the displacement was differentiated in `mass`: 2 if it is an acceleration, m/s^2,
        1 a velocity, 0 a displacement.
    relative : bool
        Whether the mass was measured relative to the base.
    starts : tuple of int
        First sample of each continuous record.
    source : tuple of Source
    """

    rate: float
    base: FloatArray
    mass: FloatArray
    starts: tuple[int, ...] = (0,)
    source: tuple[Source, ...] = ()
    order: int = 2
    relative: bool = False

    def __post_init__(self) -> None:
        require_positive(rate=self.rate, unit=" Hz", expected="a sampling rate > 0")
        hold_measured(self, "base", "mass", minimum=8)
        if self.order not in (0, 1, 2):
            raise DataError(f"order = {self.order!r}; expected 0, 1 or 2")

    @property
    def series(self) -> Series:
        """The motions of base and mass over time, and the number of the record."""
        time = np.arange(len(self.base)) / self.rate
        return {
            "time": (time, "s"), "record": (number_of_run(self.starts, len(time)), ""),
            **collect_arrays(self, base="m/s^2", mass=("m", "m/s", "m/s^2")[self.order]),
        }  # fmt: skip

    @property
    def described(self) -> tuple[str, ...]:
        """Which record it is, and how hard the base was shaken."""
        source = self.source[0] if len(self.source) == 1 else None
        return (
            describe_record_source(source, len(self.base)),
            f"base and mass at {self.rate:.6g} Hz, the base at {self.base.std():.4g} m/s^2 rms",
        )

    def records(self) -> tuple[slice, ...]:
        """The continuous records, as slices of the samples."""
        return slices(self.starts, len(self.base))
