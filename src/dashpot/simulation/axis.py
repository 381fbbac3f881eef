"""One position-controlled axis: set-points in, motion out."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError


def setpoints(start: float, stop: float, *, duration: float, interval: float) -> FloatArray:
    """Positions that a robot is sent through, evenly spaced in time, both ends exact.

    >>> len(setpoints(0.0, -8e-3, duration=1.0, interval=10e-3))
    101
    """
    count = max(1, round(duration / interval))
    points = start + (stop - start) * np.arange(count + 1) / count
    points[-1] = stop
    return np.asarray(points)


@dataclass(frozen=True)
class Axis:
    r"""A motor axis under a discrete PID controller.

    .. math:: \ddot x = u - d\,\dot x - f\,\mathrm{sign}\,\dot x, \qquad
        U = k_p E + \frac{k_i}{s} E - \frac{k_d s}{1 + s T_f} X

    with :math:`k_p = \omega_n^2` and :math:`k_d = 2\zeta\omega_n - d`: without friction and
    without the integrator the closed loop is of second order with these :math:`\omega_n, \zeta`.
    The derivative acts on the position and is filtered; the integrator rests while the output
    is limited or the error lies outside its zone (anti-windup). Between control instants u is
    held and the motion is integrated exactly.

    Attributes
    ----------
    frequency, damping : float
        Natural frequency, Hz, and damping ratio of the closed loop.
    rate : float
        Control rate, Hz.
    drag : float
        Viscous drag d of the motor, 1/s.
    friction : float
        Dry friction f, m/s^2 (force over moving mass): above 0 the axis sticks and slips.
    integral : float
        k_i, 1/s^3.
    integral_zone : float
        The integrator works while the error is smaller than this, m.
    filter_time : float
        T_f, s.
    limit : float
        Largest u, m/s^2.
    """

    frequency: float = 6.0
    damping: float = 0.6
    rate: float = 1000.0
    drag: float = 30.0
    friction: float = 0.0
    integral: float = 600.0
    integral_zone: float = 0.1e-3
    filter_time: float = 2e-3
    limit: float = 20.0

    def __post_init__(self) -> None:
        for name in ("frequency", "damping", "rate", "drag", "filter_time", "limit"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise DataError(f"axis {name} = {value!r}; expected a number > 0")
        if self.frequency > self.rate / 20:
            raise DataError(
                f"a loop of {self.frequency:g} Hz needs a control rate of at least "
                f"{20 * self.frequency:g} Hz, found {self.rate:g} Hz"
            )

    def follow(self, reference: npt.ArrayLike) -> FloatArray:
        """Return the position, m, at each control instant, started at rest on the first one.

        Parameters
        ----------
        reference : array_like, shape (n,)
            Set-point in force at each control instant, m.
        """
        target = np.asarray(reference, dtype=float).tolist()
        step = 1 / self.rate
        omega = 2 * pi * self.frequency
        kp, kd = omega**2, 2 * self.damping * omega - self.drag
        # exact motion over one step of constant drive: v -> a v + g u, x -> x + g v + w u
        a = exp(-self.drag * step)
        g = (1 - a) / self.drag
        w = (step - g) / self.drag
        smooth = 1 - exp(-step / self.filter_time)
        x = target[0]
        v = integral = rate = 0.0
        last = x
        path = []
        for wanted in target:
            path.append(x)
            error = wanted - x
            rate += smooth * ((x - last) / step - rate)
            last = x
            drive = kp * error + integral - kd * rate
            limited = min(max(drive, -self.limit), self.limit)
            if limited == drive and abs(error) < self.integral_zone:
                integral += self.integral * error * step
            if v == 0.0 and abs(limited) <= self.friction:
                continue
            direction = v if v != 0.0 else limited
            push = limited - (self.friction if direction > 0 else -self.friction)
            faster = a * v + g * push
            x += g * v + w * push
            # dry friction stops a motion; it never turns it round
            v = 0.0 if self.friction > 0 and v * faster < 0 else faster
        return np.array(path)
