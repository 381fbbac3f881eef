"""The machine that a relaxation test was made on, as far as its user knows it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dashpot.base.demands import not_negative, picked, positive
from dashpot.base.options import option
from dashpot.base.units import si_fields

# a load cell of which nothing is known drifts by this part of the final force over the record
UNKNOWN_DRIFT = 3.5e-3
# a baseline tells the drift if it leaves less than this part of the final force over the record
TOLD_DRIFT = 1e-3


@dataclass(frozen=True)
class Machine:
    r"""What the record cannot show of the machine, or shows badly.

    Attributes
    ----------
    sync : float or None
        Standard deviation of the delay between the clocks of force and displacement, s; by
        default one sample.
    drift : float or None
        Standard deviation of the drift of the load cell, N/s, as its data sheet gives it.
    compliance : float
        Of machine and load cell, m/N: the seal is compressed by :math:`x - C F`.
    force_filter : float or None
        Cut-off of a first-order low-pass in the force channel, Hz.
    """

    sync: float | None = option(
        None, "Uncertainty of the delay between force and displacement.", unit="time",
        under="machine",
    )  # fmt: skip
    drift: float | None = option(
        None, "Drift of the load cell, e.g. 0.2mN/s.", unit="force rate", under="machine"
    )
    compliance: float = option(
        0.0, "Compliance of the machine, e.g. 50um/N.", unit="compliance", under="machine"
    )
    force_filter: float | None = option(
        None,
        "First-order low-pass in the force channel, e.g. 10Hz.",
        unit="frequency",
        under="machine",
    )

    def delay_sd(self, sample: float) -> float:
        """Standard deviation of the delay of the force, s, for samples so far apart, s."""
        filtered = 1 / (2 * math.pi * self.force_filter) if self.force_filter else 0.0
        return max(sample, self.sync or 0.0, filtered)

    @staticmethod
    def drift_told(sd: float, final: float, duration: float) -> bool:
        """True if a baseline whose slope has this error, N/s, tells the drift over a record.

        `final` is the force at its end, N, and `duration` its length, s.
        """
        return sd < TOLD_DRIFT * final / duration

    def drift_sd(self, final: float, duration: float) -> float:
        """Standard deviation of the drift, N/s; of a cell not described, from the final force, N.

        It may drift by 0.35 % of that over a record of `duration`, s.
        """
        return UNKNOWN_DRIFT * final / duration if self.drift is None else self.drift

    def __post_init__(self) -> None:
        si_fields(self)
        known = picked(self, "sync", "drift", "compliance")
        not_negative("machine ", **known, expected="a number >= 0 in SI units", optional=True)
        positive("machine ", force_filter=self.force_filter, unit=" Hz", optional=True)
