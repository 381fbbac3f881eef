"""Options of a plan: its ramp and hold, and its hammer test."""

from __future__ import annotations

import math

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Method, option, require_choice
from dashpot.base.units import si_fields
from dashpot.base.value_ranges import SIZES, require_positive

IN_SI = "a number > 0 in SI units"


@dataclass(frozen=True)
class PlannedRamp:
    """Planned ramp and hold: the fields of :class:`~dashpot.planning.planned_ramp_hold.Bench`, in
    SI.
    """

    depth: float = option("8mm", "Compression.", unit="length", size=SIZES["travel"])
    ramp_time: float = option("1s", "Ramp time.", unit="time", flag="ramp")
    hold_time: float = option("40s", "Hold time.", unit="time", flag="hold")
    rate: float = option("1kHz", "Sampling rate.", unit="frequency")
    noise: float = option("5mN", "Standard deviation per sample.", unit="force")
    method: Method = option("full", "Whole record, or equation (5).", choices=Method)
    baseline: float = option("1s", "Recorded before the ramp.", unit="time")

    def __post_init__(self) -> None:
        si_fields(self)
        require_positive(
            depth=self.depth,
            ramp_time=self.ramp_time,
            hold_time=self.hold_time,
            rate=self.rate,
            noise=self.noise,
            baseline=self.baseline,
            expected=IN_SI,
            optional=True,
        )
        require_choice("method", self.method, Method)


@dataclass(frozen=True)
class HammerPlan:
    """Planned hammer test of a block on seals.

    Attributes
    ----------
    mass : float, optional
        kg, of the block on `seals` seals; by default the one with the peak at the frequency of
        interest.
    seals : float
    record : float, optional
        Length of the planned record of a hit, s.
    pulse : float, optional
        Duration of the hammer pulse, s: soft rubber tips give 10 to 20 ms.
    hits : int
        How many hits are averaged.
    coherence : float
        Their coherence about the peak, below 1.

    Raises
    ------
    DataError
        If a number is not positive, or the coherence not below 1.
    """

    mass: float | None = option(
        None, "Test mass (that which resonates there).", unit="mass", size=SIZES["mass"]
    )
    seals: float = option(1.0, "Seals in parallel.")
    record: float | None = option(None, "Record after a hit.", unit="time", flag="hit-length")
    pulse: float | None = option(None, "Hammer pulse; soft tips give 10 to 20 ms.", unit="time")
    hits: int = option(5, "Number of hammer hits.", minimum=1)
    coherence: float = option(0.99, "Coherence of those hits.")

    def __post_init__(self) -> None:
        si_fields(self)
        require_positive(
            mass=self.mass,
            seals=self.seals,
            record=self.record,
            pulse=self.pulse,
            hits=self.hits,
            expected=IN_SI,
            optional=True,
        )
        if not 0 < self.coherence < 1:
            raise DataError(f"coherence = {self.coherence!r}; expected a number between 0 and 1")

    @property
    def relative_sd(self) -> float:
        r"""Relative error of real and imaginary part: :math:`\sqrt{(1-\gamma^2)/(2n\gamma^2)}`."""
        return math.sqrt((1 - self.coherence) / (2 * self.hits * self.coherence))
