"""The rig that a relaxation test was made on, as far as its user knows it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dashpot.base.errors import DataError
from dashpot.base.options import option


@dataclass(frozen=True)
class Rig:
    r"""What the record cannot show of the rig, or shows badly.

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
        None, "Doubt of the clocks of force and displacement, e.g. 0.5ms.", unit="time"
    )
    drift: float | None = option(None, "Drift of the load cell, e.g. 0.2mN/s.", unit="force rate")
    compliance: float = option(0.0, "Of the machine, e.g. 50um/N.", unit="compliance")
    force_filter: float | None = option(
        None, "First-order low-pass in the force channel, e.g. 10Hz.", unit="frequency"
    )

    def __post_init__(self) -> None:
        for name in ("sync", "drift", "compliance"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value >= 0):
                raise DataError(f"rig {name} = {value!r}; expected a number >= 0 in SI units")
        cut = self.force_filter
        if cut is not None and not (math.isfinite(cut) and cut > 0):
            raise DataError(f"rig force_filter = {cut!r} Hz; expected a number > 0")
