"""The load cell before contact: its zero, its noise, its drift."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step

# samples: fewer have no scatter to speak of
MIN_BASELINE = 5.0


class Baseline(NamedTuple):
    """What the load cell showed before the plate met the seal.

    Attributes
    ----------
    samples : int
    duration : float
        s.
    level, noise : float
        Mean, and standard deviation about a straight line, N.
    slope, slope_error : float
        Of that line, N/s; the error is infinite where the baseline is too short.
    middle : float
        Its mean time, s.
    """

    samples: int
    duration: float
    level: float
    noise: float
    slope: float
    slope_error: float
    middle: float

    @property
    def long_enough(self) -> bool:
        """Five samples make a mean worth subtracting."""
        return self.samples >= MIN_BASELINE


def baseline_of(time: FloatArray, force: FloatArray) -> Baseline:
    """Describe the samples before contact; there is at least one."""
    middle, level = float(time.mean()), float(force.mean())
    t = time - middle
    power = float(t @ t)
    sloped = len(force) >= MIN_BASELINE and power > 0
    slope = float(t @ force) / power if sloped else 0.0
    free = len(force) - 2 * sloped
    noise = float(np.sqrt(np.sum((force - level - slope * t) ** 2) / free))
    error = noise / power**0.5 if sloped else np.inf
    return Baseline(len(force), float(np.ptp(time)), level, noise, slope, error, middle)


def zeroed(
    time: FloatArray, force: FloatArray, found: Baseline, *, drift: float | str | None, where: str
) -> tuple[FloatArray, Step]:
    """Take off the tare, and the drift if it was asked for.

    Raises
    ------
    DataError
        If the drift of a baseline is asked for that is too short to show one.
    """
    if drift == "baseline" and not found.long_enough:
        raise DataError(
            f"{where}: drift='baseline' was asked for, but {found.samples} samples lie before "
            f"contact; expected at least {MIN_BASELINE:.0f}: record a baseline, or give the drift "
            "in N/s"
        )
    rate = found.slope if drift == "baseline" else float(drift or 0.0)
    tare = found.level if found.long_enough else 0.0
    says = (
        f"tare of {1e3 * tare:.4g} mN from {found.samples} samples before contact"
        if found.long_enough
        else "no tare: the record starts on the ramp"
    )
    if np.isfinite(found.slope_error):
        says += (
            f"; the baseline drifts by {1e3 * found.slope:.2g} +- {1e3 * found.slope_error:.1g} "
            "mN/s"
        )
    says += f"; {1e3 * rate:.3g} mN/s taken off" if rate else "; no drift taken off"
    parameters = (("tare_n", repr(tare)), ("drift_n_per_s", repr(rate)))
    return force - tare - rate * (time - found.middle), Step("tare", parameters, says)
