r"""Collision of a body with a viscoelastic surface: motion from touch to release.

.. math:: m \ddot x = m p - F, \qquad x(0) = 0,\ \dot x(0) = V

with p the acceleration of gravity in a fall, else 0. Release is where F falls to zero: the surface,
being viscous, does not follow at once. The restitution is :math:`e = -\dot x / V` there; for a
linear contact without gravity :math:`e = \exp\bigl[-\tfrac{\zeta}{\sqrt{1-\zeta^2}}
\operatorname{atan2}(2\zeta\sqrt{1-\zeta^2},\, 2\zeta^2 - 1)\bigr]`.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Callable
from functools import lru_cache
from math import atan2, exp, sqrt
from typing import NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_positive
from dashpot.extensions.materials.indentation.contact_law import ContactLaw, ViscousContact

_STEP, _RELAXING_STEP = 0.03, 0.05
"""Step of integration; a lossless contact is some five long. The motion is right to 1e-8, that of
a model that relaxes to 3e-6, its force to 1e-5 of the largest."""
_SAMPLES_PER_STEP = 6
"""Samples of a step."""
_MAX_ROUNDS = 30
"""Iterations in the search for the end of a contact."""
_CACHE_SIZE = 1024
"""Number of cached shapes, which fits use again at other speeds and times of contact."""
_MAX_CONTACT_TIME = 300.0
"""Longest contact, in lengths of a Hertzian one."""

State: TypeAlias = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Collision(EqualByValue):
    """Contact from touch to release.

    Attributes
    ----------
    time : array, shape (n,)
        s, from 0 at the touch to the release.
    displacement, velocity, force : array, shape (n,)
        m, m/s, N.
    mass : float
        kg.
    gravity : float
        m/s^2.
    """

    time: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    force: FloatArray
    mass: float
    gravity: float = 0.0

    @property
    def duration(self) -> float:
        """S."""
        return float(self.time[-1])

    @property
    def restitution(self) -> float:
        """Release speed over impact speed."""
        return float(-self.velocity[-1] / self.velocity[0])

    @property
    def approach(self) -> float:
        """Impact speed, m/s."""
        return float(self.velocity[0])

    @property
    def depth(self) -> float:
        """Largest indentation, m."""
        return _find_peak(self.time, self.displacement)

    @property
    def largest_force(self) -> float:
        """N."""
        return _find_peak(self.time, self.force)

    @property
    def acceleration(self) -> FloatArray:
        """Acceleration of the body, m/s^2, positive into the surface, shape (n,)."""
        return np.asarray(self.gravity - self.force / self.mass)


def collide(
    law: ContactLaw, *, mass: float, velocity: float, acceleration: float = 0.0
) -> Collision:
    """Return the motion of a body through one contact.

    Parameters
    ----------
    law : ContactLaw
    mass : float
        kg.
    velocity : float
        Velocity of approach, m/s, > 0.
    acceleration : float
        Additional acceleration, m/s^2: 9.81 for a fall, 0 across.

    Raises
    ------
    DataError
        If a number is not above zero, or the body never rebounds.
    """
    require_positive(mass=mass, velocity=velocity, expected="a finite number above 0")
    n = law.exponent
    unit = ((n + 1) / 2 * mass * velocity ** (1 - n) / law.k) ** (1 / (n + 1))
    scaled_acceleration = acceleration * unit / velocity
    if isinstance(law, ViscousContact):
        shape = integrate_viscous_contact(n, law.viscous_time / unit, scaled_acceleration)
    else:
        shape = integrate_relaxing_contact(law.g, law.tau / unit, scaled_acceleration)
    return scale_collision(
        shape, unit=unit, mass=mass, velocity=velocity, acceleration=acceleration
    )


def get_stiffness(exponent: float, *, unit: float, mass: float, velocity: float) -> float:
    """Return k of the contact whose lossless motion has that unit of time, s: depth over speed."""
    return float((exponent + 1) / 2 * mass * velocity ** (1 - exponent) / unit ** (exponent + 1))


class Shape(NamedTuple):
    """Motion in units of the approach speed and of the depth of a lossless contact.

    There all numbers are near 1, and the laws have one parameter less.
    """

    time: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    force: FloatArray


def scale_collision(
    shape: Shape, *, unit: float, mass: float, velocity: float, acceleration: float = 0.0
) -> Collision:
    """Return the collision of a shape, with its unit of time, s."""
    depth, push = velocity * unit, mass * velocity / unit
    t, x, v, F = shape
    return Collision(t * unit, x * depth, v * velocity, F * push, mass, acceleration)


def _find_peak(t: FloatArray, y: FloatArray) -> float:
    """Return the maximum of the parabola through the largest sample and its neighbours."""
    peak_index = int(y.argmax())
    if peak_index in {0, len(y) - 1}:
        return float(y[peak_index])
    time_from_peak = t[peak_index - 1 : peak_index + 2] - t[peak_index]
    (a, b, c) = np.linalg.solve(
        np.stack((time_from_peak**2, time_from_peak, np.ones(3)), axis=1),
        y[peak_index - 1 : peak_index + 2],
    )
    return float(c - b**2 / (4 * a)) if a < 0 else float(y[peak_index])


@lru_cache(maxsize=_CACHE_SIZE)
def integrate_viscous_contact(n: float, A: float, acceleration: float = 0.0) -> Shape:
    r"""Return the motion where the force follows from displacement and velocity.

    A and gravity are in units of the lossless contact. On a sphere :math:`y = \sqrt x` and
    :math:`d\sigma = dt / y` make polynomials of the motion, regular at touch and release:

    .. math:: t' = y, \qquad 2 y' = v, \qquad v' = y\,[p - \tfrac54 (y^3 + \tfrac32 A y v)]
    """
    step = _STEP / (1 + A)
    if n == 1:
        # the force changes sign at the release
        t, x, v = _integrate_contact(
            lambda _, x, v: (1.0, v, acceleration - x - A * v), (0.0, 0.0, 1.0),
            lambda _, x, v: x + A * v, step,
        )  # fmt: skip
        F = x + A * v
    else:
        # x^(1/2) is a factor of the force, x + 3/2 A v the rest of it
        t, y, v = _integrate_contact(
            lambda _, y, v: (y, v / 2, y * (acceleration - 1.25 * y * (y * y + 1.5 * A * v))),
            (0.0, 0.0, 1.0), lambda _, y, v: y - sqrt(1.5 * abs(A) * max(-v, 0.0)), step,
        )  # fmt: skip
        x = y**2
        F = 1.25 * y * (x + 1.5 * A * v)
    F[-1] = 0.0
    return Shape(t, x, v, F)


@lru_cache(maxsize=_CACHE_SIZE)
def integrate_relaxing_contact(g: float, tau: float, acceleration: float = 0.0) -> Shape:
    r"""Return Ting's contact: loading with a state of the arm, unloading at the size it once had.

    With :math:`q = \int e^{-(t-s)/\tau} dx^{3/2}` and :math:`p = \int e^{-(t-s)/\tau} dx`, the
    earlier indentation h of equal contact falls as

    .. math:: \dot h = \frac{(1 + g)\,\dot x - (h - x)/\tau}{1 + g\,e^{-(t-t_1)/\tau}}

    which is regular at the turn, where t_1 itself is not. tau and p are in units of the lossless
    contact of the relaxed state. It is marched in :math:`d\sigma = dt / \sqrt h`, regular at touch
    and release.
    """
    step = _RELAXING_STEP / ((1 + g) ** 0.4 * (1 + 0.05 / tau))

    def loading(_: float, y: float, v: float, q: float) -> State:
        force = 1.25 * (y**3 + g * q)
        return y, v / 2, y * (acceleration - force), y * (1.5 * y * v - q / tau)

    t, y, v, q = _integrate_contact(loading, (0.0, 0.0, 1.0, 0.0), lambda *state: state[2], step)
    top, end_time = float(y[-1]), float(t[-1])
    from scipy.interpolate import CubicSpline

    # at this angle of the size the way there is smooth, at the touch as at the turn
    nodes = slice(None, None, _SAMPLES_PER_STEP)
    angle = _compute_angle(y[nodes], top)
    loading_history = CubicSpline(angle, np.stack((t, q), axis=1)[nodes])
    edges, cubics = angle.tolist(), loading_history.c.transpose(1, 2, 0).tolist()

    def unloading(time: float, w: float, v: float, x: float) -> State:
        angle_in_loading = atan2(w, sqrt(max(top * top - w * w, 0.0)))
        i = min(max(bisect(edges, angle_in_loading) - 1, 0), len(cubics) - 1)
        by = angle_in_loading - edges[i]
        (a, b, c, t1), (d, e, f, q1) = cubics[i]
        # what the arm has lost since the contact was as large
        faded = g * exp((((a * by + b) * by + c) * by + t1 - time) / tau)
        force = 1.25 * (w**3 + faded * (((d * by + e) * by + f) * by + q1))
        speed = ((1 + g) * v - (w * w - x) / tau) / (1 + faded)
        return w, speed / 2, w * (acceleration - force), w * v

    unloading_time, w, u, x = _integrate_contact(
        unloading, (end_time, top, 0.0, top**2), lambda *state: state[1], step
    )
    t1, q1 = loading_history(_compute_angle(w, top)).T
    F = 1.25 * (w**3 + g * np.exp((t1 - unloading_time) / tau) * q1)
    F[-1] = 0.0
    return Shape(
        np.concatenate((t, unloading_time[1:])),
        np.concatenate((y**2, x[1:])),
        np.concatenate((v, u[1:])),
        np.concatenate((1.25 * (y**3 + g * q), F[1:])),
    )


def _compute_angle(y: FloatArray, peak_force: float) -> FloatArray:
    return np.arctan2(y, np.sqrt(np.maximum(peak_force**2 - y**2, 0.0)))


def _integrate_contact(
    rate: Callable[..., State],
    start: State,
    end_condition: Callable[..., float],
    step: float,
) -> FloatArray:
    """March a state, time its first, by Runge and Kutta's steps until a function falls through 0.

    Even steps make errors that do not jump with a law's numbers. Returns the states in rows, at the
    steps and by the cubics between them.
    """

    def compute_next_state(y: State, k1: State, h: float) -> State:
        k2 = rate(*[a + h / 2 * b for a, b in zip(y, k1, strict=True)])
        k3 = rate(*[a + h / 2 * b for a, b in zip(y, k2, strict=True)])
        k4 = rate(*[a + h * b for a, b in zip(y, k3, strict=True)])
        pairs = zip(y, k1, k2, k3, k4, strict=True)
        return tuple([a + h / 6 * (b + 2 * (c + d) + e) for a, b, c, d, e in pairs])

    states, rates, previous_condition, condition = [start], [rate(*start)], 0.0, 1.0
    while condition > 0:
        if max(states[-1][0], len(states) * step) > _MAX_CONTACT_TIME:
            raise DataError(
                f"the body is still in contact after {_MAX_CONTACT_TIME:g} times the time of a "
                "lossless one: it is not let go; expected less damping or less gravity"
            )
        states.append(compute_next_state(states[-1], rates[-1], step))
        rates.append(rate(*states[-1]))
        previous_condition, condition = condition, end_condition(*states[-1])
    # the last step ends where the function is zero: false position, its stale end halved
    low, high, part = 0.0, step, 0.0
    for _ in range(_MAX_ROUNDS):
        part = high - condition * (high - low) / (condition - previous_condition)
        states[-1] = compute_next_state(states[-2], rates[-2], part)
        value = end_condition(*states[-1])
        if value * condition < 0:
            low, previous_condition = high, condition
        else:
            previous_condition /= 2
        high, condition = part, value
        if abs(high - low) < 1e-14 or value == 0:
            break
    rates[-1] = rate(*states[-1])
    y, k = np.array(states).T, np.array(rates).T
    h = np.append(np.full(len(states) - 2, step), part)
    s = np.arange(_SAMPLES_PER_STEP)[:, None, None] / _SAMPLES_PER_STEP
    change = np.diff(y)
    interpolated = y[:, :-1] + s * (
        h * k[:, :-1] * (1 - s) ** 2 + s * ((3 - 2 * s) * change + (s - 1) * h * k[:, 1:])
    )
    return np.column_stack((interpolated.transpose(1, 2, 0).reshape(len(start), -1), y[:, -1]))
