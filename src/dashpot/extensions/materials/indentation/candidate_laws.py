"""Candidate contact laws: their parameters, starts, and simulated sensor signals.

A fit's parameters are visible in a record: the logarithms of contact time and of speed change, and
the time of first contact, s; between them numbers of the law's own, a loss and a time. Nothing
pulls in these: what does, makes the contact of the same law somewhat longer. The motion is marched
again for the law's own numbers alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.extensions.materials.indentation.collision import (
    Collision,
    Shape,
    get_stiffness,
    integrate_relaxing_contact,
    integrate_viscous_contact,
    scale_collision,
)
from dashpot.extensions.materials.indentation.contact_law import (
    SPHERE_EXPONENT,
    ContactLaw,
    RelaxingContact,
    ViscousContact,
)
from dashpot.extensions.materials.indentation.datamodel import Motion
from dashpot.numerics.least_squares import Parameter

_ARSINH_UNITS = np.array([0.02, 1.0])
"""Unit of a loss and a time, whose arsinh in this unit is the parameter: by what is less a record
changes in proportion, and where both are more their logarithms do."""
_RANGE = np.array([[1e-6, 10.0], [1 / 32, 32.0]])
_LOG_RANGE = 8.0
"""Range of the logarithm of a number about its start."""
_HALF_WAVE = 1.07
"""Pi over the length of a lossless contact."""
STEP = 3e-5
"""Relative step of a numerical derivative that integrates the motion again."""


@dataclass(frozen=True)
class Law:
    """Candidate contact law of a fit.

    Attributes
    ----------
    exponent : float
    shape : callable
        Parameters: those of the law's own numbers and gravity, without units.
    build_law : callable
        The contact of k, the unit of time and the law's own numbers.
    starting_values : tuple of tuple
        Starting values of its loss and of its time, tried in all combinations.
    build_coefficients : callable
        Returns the coefficients of the law from its loss and its time.
    """

    exponent: float
    shape: Callable[..., Shape]
    build_law: Callable[..., ContactLaw]
    starting_values: tuple[tuple[float, ...], ...] = ()
    build_coefficients: Callable[..., Sequence[float]] = lambda *values: values

    def fix_loss(self, values: Sequence[float]) -> Law:
        """Return the law with its loss and its time held."""
        numbers = self.build_coefficients(*values)
        return replace(self, starting_values=(), build_coefficients=lambda: numbers)

    def parameters(self, duration: float, change: float) -> list[Parameter]:
        """Return the range of each, but for the touch."""
        value = np.arcsinh(_RANGE / _ARSINH_UNITS[:, None])[: len(self.starting_values)]
        log_duration, log_change = np.log((duration, change))
        ranges = [
            [log_duration - _LOG_RANGE, log_duration + _LOG_RANGE],
            *value,
            [log_change - _LOG_RANGE, log_change + _LOG_RANGE],
        ]
        return [Parameter(float(low), float(high)) for low, high in ranges]

    def make_starting_parameters(
        self, duration: float, values: Sequence[float], change: float
    ) -> FloatArray:
        """Return the parameters, but for the touch."""
        log_duration, log_change = np.log((duration, change))
        return np.array(
            [log_duration, *np.arcsinh(values / _ARSINH_UNITS[: len(values)]), log_change]
        )

    def _read(self, theta: FloatArray) -> tuple[float, Sequence[float], float]:
        """Return time unit, coefficients of the law and speed from the parameters."""
        duration, change = np.exp(theta[[0, -2]]).tolist()
        value = np.sinh(theta[1:-2]) * _ARSINH_UNITS[: len(theta) - 3]
        values = self.build_coefficients(*value.tolist())
        free = self.shape(*values, 0.0)
        return duration / float(free.time[-1]), values, change / (1 - float(free.velocity[-1]))

    def contact(self, theta: FloatArray, mass: float) -> ContactLaw:
        """Return the contact of a fit's parameters."""
        unit, values, speed = self._read(theta)
        k = get_stiffness(self.exponent, unit=unit, mass=mass, velocity=speed)
        return self.build_law(k, unit, *values)

    def collision(self, theta: FloatArray, mass: float, acceleration: float) -> Collision:
        """Return the motion of a fit's parameters."""
        unit, values, speed = self._read(theta)
        shape = self.shape(*values, acceleration * unit / speed)
        return scale_collision(
            shape, unit=unit, mass=mass, velocity=speed, acceleration=acceleration
        )


def _compute_arm(loss: float, time: float) -> tuple[float, float]:
    """Return the arm's g, and its tau in the unit of time, of k''(w) / k and w tau.

    Nearly: w is pi over the length of a lossless contact as stiff as k'(w). In these a record's
    valley is straight.
    """
    return loss * (1 + time**2) / time, time / (_HALF_WAVE * (1 + loss * time) ** 0.4)


LAWS = MappingProxyType(
    {
        "kelvin-voigt": Law(
            1.0, partial(integrate_viscous_contact, 1.0), lambda k, unit, A: ViscousContact(k,
            A * unit, 1.0),
            ((0.1, 0.5),),
        ),
        "hertz": Law(
            SPHERE_EXPONENT, partial(integrate_viscous_contact, SPHERE_EXPONENT, 0.0),
            lambda k, _: ViscousContact(k)
        ),
        "hertz-kelvin-voigt": Law(
            SPHERE_EXPONENT, partial(integrate_viscous_contact, SPHERE_EXPONENT),
            lambda k, unit, A: ViscousContact(k, A * unit),
            ((0.05, 0.3),),
        ),
        "hertz-maxwell": Law(
            SPHERE_EXPONENT, integrate_relaxing_contact,
            lambda k, unit, g, tau: RelaxingContact(k, g, tau * unit),
            (tuple(0.02 * 2.0**np.arange(7)), tuple(2.0**np.arange(-3, 4))), _compute_arm,
        ),
    }
)  # fmt: skip


class SensorSignal(NamedTuple):
    """Simulated sensor signal and its derivatives, each of shape (n,).

    Attributes
    ----------
    signal : array
    rate : array
        By time.
    time_unit_derivative : array
        Derivative by the logarithm of the time unit, at constant speed and acceleration in that
        unit.
    """

    signal: FloatArray
    rate: FloatArray
    time_unit_derivative: FloatArray


def simulate_sensor_signal(
    hit: Collision, motion: Motion, time_since_touch: FloatArray, step: float
) -> SensorSignal:
    """Return the signal of a sensor, positive for a push, at times since first contact, s.

    An acceleration is the specific force F/m, zero in free fall. A force that jumps at the touch is
    averaged over a sample, as every recorder does.
    """
    from scipy.interpolate import CubicHermiteSpline

    t, end, F = hit.time, hit.duration, hit.force
    in_contact = (time_since_touch > 0) & (time_since_touch < end)

    def interpolate_cubic(
        values: FloatArray, rate: FloatArray, time: FloatArray = time_since_touch
    ) -> tuple[FloatArray, ...]:
        """Return values and rates from cubics through value and rate."""
        cubic = CubicHermiteSpline(t, values, rate)
        time = np.clip(time, 0.0, end)
        return cubic(time), cubic(time, 1)

    push, rate = (
        values * in_contact for values in interpolate_cubic(F, np.gradient(F, t, edge_order=2))
    )
    if motion in {"acceleration", "force"}:
        scale = 1.0 if motion == "force" else 1 / hit.mass
        value, stretched = push, -push - time_since_touch * rate
        if F[0] > 0:
            speed_change = (
                hit.velocity[0] + hit.gravity * t - hit.velocity
            )  # the force's integral over mass
            edge = np.stack((time_since_touch - step / 2, time_since_touch + step / 2))
            value, force = interpolate_cubic(speed_change * hit.mass, F, edge)
            force *= (edge > 0) & (edge < end)
            value, rate, stretched = (
                np.diff(values, axis=0)[0] / step for values in (value, force, -edge * force)
            )
        return SensorSignal(value * scale, rate * scale, stretched * scale)
    time_before, time_after = (
        np.minimum(time_since_touch, 0.0),
        np.maximum(time_since_touch - end, 0.0),
    )
    # in flight with the speed of approach, or of release
    acceleration = push / hit.mass - hit.gravity
    if motion == "velocity":
        speed = interpolate_cubic(hit.velocity, hit.acceleration)[0] + hit.gravity * (
            time_before + time_after
        )
        return SensorSignal(-speed, acceleration, -time_since_touch * acceleration)
    displacement, speed = interpolate_cubic(hit.displacement, hit.velocity)
    speed += hit.gravity * (time_before + time_after)
    displacement += hit.velocity[0] * time_before + hit.velocity[-1] * time_after
    displacement += hit.gravity * (time_before**2 + time_after**2) / 2
    return SensorSignal(-displacement, -speed, time_since_touch * speed - displacement)
