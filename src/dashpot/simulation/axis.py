"""One motor axis of the virtual rig: a discrete PID, drag, dry friction."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.validators import require_nonnegative, require_positive, select_fields


@dataclass(frozen=True)
class Axis:
    r"""A motor axis under a discrete PID controller.

    .. math:: \ddot x = u - d\,\dot x - f\,\mathrm{sign}\,\dot x, \qquad
        U = k_p E + \frac{k_i}{s} E - \frac{k_d s}{1 + s T_f} X

    with :math:`k_p = \omega_n^2` and :math:`k_d = 2\zeta\omega_n - d`: without friction and
    without the integrator the closed loop is of second order with these :math:`\omega_n, \zeta`.
    The derivative acts on the position and is filtered. The integrator works where the error lies
    inside its zone or the axis, by the controller's own rate, stands still: it then brings an axis
    home that dry friction stopped far away, :math:`f / k_p` short, within some :math:`k_p / k_i`.
    It rests while the axis travels or the output is limited (anti-windup). Between control
    instants u is held and the motion is integrated exactly.

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
        The integrator works while the error is smaller than this, m,
    standstill : float
        or while the filtered rate is, m/s.
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
    standstill: float = 0.2e-3
    filter_time: float = 2e-3
    limit: float = 20.0

    def __post_init__(self) -> None:
        above = ("frequency", "damping", "rate", "drag", "filter_time", "limit")
        require_positive("axis ", **select_fields(self, *above))
        others = ("friction", "integral", "integral_zone", "standstill")
        require_nonnegative("axis ", **select_fields(self, *others))
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
            near = abs(error) < self.integral_zone or abs(rate) < self.standstill
            if limited == drive and near:
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
