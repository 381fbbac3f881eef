"""The laws that a contact is tried with: their parameters, starts, and what a sensor would record.

A fit's parameters are logarithms of the unit of time of the lossless contact, depth over speed, of
the law's own numbers in that unit, and of the speed of approach; the time of the touch comes last,
in s. So a motion is integrated again for the law's own numbers alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.records.indentation import Motion
from dashpot.solids.contact import SPHERE, ContactLaw, RelaxingContact, ViscousContact
from dashpot.vibration.systems.contact import (
    Collision,
    Shape,
    relaxing,
    scaled,
    stiffness_of,
    viscous,
)

_TOLERANCE = 1e-7
_PULL_DIGITS = 5
"""Of the pull in units of the contact: what is less bends no record."""


@dataclass(frozen=True)
class Law:
    """A law as a fit takes it.

    Attributes
    ----------
    exponent : float
    lasts : float
        A lossless contact, in units of time.
    shape : callable
        Of the law's own numbers and the pull, without units.
    made : callable
        The contact of k, the unit of time and the law's own numbers.
    starts : tuple
        Of those numbers.
    """

    exponent: float
    lasts: float
    shape: Callable[..., Shape]
    made: Callable[..., ContactLaw]
    starts: tuple[tuple[float, ...], ...]

    def contact(self, theta: FloatArray, mass: float) -> ContactLaw:
        """The contact of a fit's parameters."""
        unit, *own, speed = np.exp(theta[:-1]).tolist()
        k = stiffness_of(self.exponent, unit=unit, mass=mass, velocity=speed)
        return self.made(k, unit, *own)

    def collision(self, theta: FloatArray, mass: float, pull: float) -> Collision:
        """The motion of a fit's parameters."""
        unit, *own, speed = np.exp(theta[:-1]).tolist()
        fall = round(pull * unit / speed, _PULL_DIGITS)
        shape = self.shape(*own, fall, tolerance=_TOLERANCE)
        return scaled(shape, unit=unit, mass=mass, velocity=speed, pull=pull)


def _linear(A: float, pull: float, *, tolerance: float) -> Shape:
    return viscous(1.0, A, pull, tolerance=tolerance)


def _hertz(pull: float, *, tolerance: float) -> Shape:
    return viscous(SPHERE, 0.0, pull, tolerance=tolerance)


def _kuwabara(A: float, pull: float, *, tolerance: float) -> Shape:
    return viscous(SPHERE, A, pull, tolerance=tolerance)


LAWS = MappingProxyType(
    {
        "kelvin-voigt": Law(
            1.0, np.pi, _linear, lambda k, unit, A: ViscousContact(k, A * unit, 1.0),
            ((0.1,), (0.5,)),
        ),
        "hertz": Law(SPHERE, 2.94327, _hertz, lambda k, _: ViscousContact(k), ((),)),
        "hertz-kelvin-voigt": Law(
            SPHERE, 2.94327, _kuwabara, lambda k, unit, A: ViscousContact(k, A * unit),
            ((0.05,), (0.3,)),
        ),
        "hertz-maxwell": Law(
            SPHERE, 2.94327, relaxing, lambda k, unit, g, tau: RelaxingContact(k, g, tau * unit),
            ((0.7, 1.2), (1.5, 0.4)),
        ),
    }
)  # fmt: skip


def recorded(hit: Collision, of: Motion, since: FloatArray, step: float) -> FloatArray:
    """Return what a sensor would record, positive for a push, at times since the touch, s.

    An acceleration is the specific force F/m, for what falls freely weighs nothing. A force that
    jumps at the touch is averaged over a sample, as every recorder does.
    """
    t, end = hit.time, hit.duration
    if of in {"acceleration", "force"}:
        scale = 1.0 if of == "force" else 1 / hit.mass
        if hit.force[0] > 0:
            lost = hit.velocity[0] + hit.pull * t - hit.velocity  # the force's integral over mass
            edge = np.interp(np.stack((since - step / 2, since + step / 2)), t, lost)
            return np.asarray((edge[1] - edge[0]) / step * hit.mass * scale)
        return scale * np.interp(since, t, hit.force, left=0.0, right=0.0)
    before, after = np.minimum(since, 0.0), np.maximum(since - end, 0.0)
    if of == "velocity":
        flight = hit.pull * (before + after)
        return np.asarray(-np.interp(since, t, hit.velocity) - flight)
    # in flight with the speed of approach, or of release
    flights = (
        hit.velocity[0] * before + hit.velocity[-1] * after + hit.pull * (before**2 + after**2) / 2
    )
    return np.asarray(-np.interp(since, t, hit.displacement) - flights)
