"""Relaxation tests, raw and prepared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, increasing, same_length, samples
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError
from dashpot.base.provenance import Source, Step
from dashpot.records.resolution import quantum
from dashpot.records.specimen import Specimen


@dataclass(frozen=True, eq=False)
class RelaxationTest(ByValue):
    """A relaxation test as the machine wrote it, in SI units.

    Attributes
    ----------
    time : array, shape (n,)
        s, strictly increasing; any sampling.
    displacement : array, shape (n,)
        m, sign and zero as recorded.
    force : array, shape (n,)
        N, sign and zero as recorded.
    specimen : Specimen
    source : Source or None
        The file it came from; None for arrays made in memory.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 8 samples, are not finite, or time stalls.
    """

    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None

    def __post_init__(self) -> None:
        for name in ("time", "displacement", "force"):
            object.__setattr__(self, name, samples(name, getattr(self, name), minimum=8))
        same_length(time=self.time, displacement=self.displacement, force=self.force)
        increasing("time", self.time)


@dataclass(frozen=True, eq=False)
class RampHold(ByValue):
    """A prepared relaxation test: the ramp and the hold known, compression positive, tared.

    Made by :func:`dashpot.preparation.prepare.prepare`; `fit` takes nothing else.

    Attributes
    ----------
    time : array, shape (n,)
        s, on the clock of the raw record.
    displacement : array, shape (n,)
        Compression of the seal from first contact, m: what the fit takes as its input.
        Zero before contact; positive is compression.
    force : array, shape (n,)
        Compressive force less the tare, N; positive is compression. Not filtered by default.
    onset, ramp_end, hold_end : float
        First contact, end of the ramp and end of the hold, s on the same clock. With several
        ramps, the first ramp and the last hold.
    depth : float
        Compression held, m: the mean displacement over the hold.
    preload : float
        Force, N, carried at the first sample if the record starts in contact; else 0.
    force_noise, displacement_noise : float
        Standard deviation of the sample-to-sample scatter of each channel, N and m.
    contact_error : float
        Standard error of the zero of the displacement, m, where first contact had to be found
        behind an air gap; else 0.
    specimen, source
        As in the raw test.
    steps : tuple of Step
        What preparation did, in order.
    checks : tuple of Check
        What preparation noticed.
    unfiltered : RampHold or None
        The same record before the filter that was asked for; None if none was.
    """

    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    onset: float
    ramp_end: float
    hold_end: float
    depth: float
    preload: float = 0.0
    force_noise: float = 0.0
    displacement_noise: float = 0.0
    contact_error: float = 0.0
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    steps: tuple[Step, ...] = ()
    checks: tuple[Check, ...] = ()
    unfiltered: RampHold | None = None

    def __post_init__(self) -> None:
        for name in ("time", "displacement", "force"):
            object.__setattr__(self, name, samples(name, getattr(self, name), minimum=8))
        same_length(time=self.time, displacement=self.displacement, force=self.force)
        increasing("time", self.time)
        if not self.onset < self.ramp_end < self.hold_end:
            raise DataError(
                f"the ramp must start, end and be held in that order, found onset "
                f"{self.onset:g} s, ramp end {self.ramp_end:g} s, hold end {self.hold_end:g} s"
            )
        if not (np.isfinite(self.depth) and self.depth > 0):
            raise DataError(f"depth = {self.depth!r} m; expected a compression > 0")

    @property
    def ramp_time(self) -> float:
        """Duration of the ramp, the paper's c, s."""
        return self.ramp_end - self.onset

    @property
    def hold_time(self) -> float:
        """Duration of the hold, s."""
        return self.hold_end - self.ramp_end

    @cached_property
    def displacement_quantum(self) -> float:
        """The step of the displacement's readings, m; 0 if none shows."""
        return quantum(self.displacement)

    @property
    def hold(self) -> slice:
        """The samples of the hold, ramp end included."""
        start, stop = np.searchsorted(self.time, [self.ramp_end, self.hold_end])
        return slice(int(start), min(int(stop) + 1, len(self.time)))


def listed(tests: RampHold | Sequence[RampHold]) -> tuple[RampHold, ...]:
    """Return one or several prepared tests as a tuple.

    Raises
    ------
    FitError
        If one of them is not prepared.
    """
    records = (tests,) if isinstance(tests, RampHold) else tuple(tests)
    for record in records:
        if not isinstance(record, RampHold):
            raise FitError(
                f"a fit takes prepared tests, found a {type(record).__name__}; call prepare(test)"
            )
    return records
