"""Response to random base motion, as standard deviations and their limits."""

from __future__ import annotations

from dashpot.base import dataclass


@dataclass(frozen=True)
class RandomResponse:
    """Response of a point to random base motion, as standard deviations.

    Attributes
    ----------
    acceleration : float
        Acceleration of the mass, or of the place, absolute, m/s^2.
    stretch : float
        Stretch of the solid, or of the place against the base, m.
    crossings : float
        Upward crossings of zero of the stretch a second, 1/s (Rice).
    """

    acceleration: float
    stretch: float
    crossings: float


@dataclass(frozen=True)
class RandomLimits:
    """Limits of the response to random base motion; infinite if there is none.

    Attributes
    ----------
    acceleration : (float, float)
        Acceleration of the mass, m/s^2.
    stretch : (float, float)
        Stretch of the solid, m.
    band_hz : (float, float)
        Upper end of the band of the noise that the upper limits count: all of a table, of white
        noise a part.
    """

    acceleration: tuple[float, float]
    stretch: tuple[float, float]
    band_hz: tuple[float, float]
