r"""A body that flies into a viscoelastic surface: its motion from touch to release.

.. math:: m \ddot x = m p - F, \qquad x(0) = 0,\ \dot x(0) = V

with p the pull along the way (gravity, for a fall). Release is where F falls to zero: the surface,
being viscous, does not follow at once. The restitution is :math:`e = -\dot x / V` there; for a
linear contact without pull :math:`e = \exp\bigl[-\tfrac{\zeta}{\sqrt{1-\zeta^2}}
\operatorname{atan2}(2\zeta\sqrt{1-\zeta^2},\, 2\zeta^2 - 1)\bigr]`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, positive
from dashpot.base.errors import DataError
from dashpot.solids.contact import ContactLaw, ViscousContact

_TOLERANCE = 1e-9
"""Relative, of the integration."""
_SAMPLES = 300
"""Of a motion, or of each half of it."""
_REMEMBERED = 64
"""Shapes: a fit asks for one again, at another speed or touch."""
_LONGEST = 300.0
"""Of a contact, in times of a Hertzian one: what lasts longer never lets go."""


@dataclass(frozen=True, eq=False)
class Collision(ByValue):
    """One contact, from touch to release.

    Attributes
    ----------
    time : array, shape (n,)
        s, from 0 at the touch to the release.
    displacement, velocity, force : array, shape (n,)
        m, m/s, N.
    mass : float
        kg.
    pull : float
        m/s^2.
    """

    time: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    force: FloatArray
    mass: float
    pull: float = 0.0

    @property
    def duration(self) -> float:
        """S."""
        return float(self.time[-1])

    @property
    def restitution(self) -> float:
        """Speed of release over speed of approach."""
        return float(-self.velocity[-1] / self.velocity[0])

    @property
    def approach(self) -> float:
        """Speed at the touch, m/s."""
        return float(self.velocity[0])

    @property
    def depth(self) -> float:
        """Largest indentation, m."""
        return _peak(self.time, self.displacement)

    @property
    def largest_force(self) -> float:
        """N."""
        return _peak(self.time, self.force)

    @property
    def acceleration(self) -> FloatArray:
        """Of the body, m/s^2, positive into the surface, shape (n,)."""
        return np.asarray(self.pull - self.force / self.mass)


def collide(law: ContactLaw, *, mass: float, velocity: float, pull: float = 0.0) -> Collision:
    """Return the motion of a body through one contact.

    Parameters
    ----------
    law : ContactLaw
    mass : float
        kg.
    velocity : float
        Of approach, m/s, > 0.
    pull : float
        Acceleration that acts besides the contact, m/s^2: 9.81 for a fall, 0 across.

    Raises
    ------
    DataError
        If a number is not above zero, or the body is never let go.
    """
    positive(mass=mass, velocity=velocity, expected="a finite number above 0")
    n = law.exponent
    unit = ((n + 1) / 2 * mass * velocity ** (1 - n) / law.k) ** (1 / (n + 1))
    fall = pull * unit / velocity
    if isinstance(law, ViscousContact):
        shape = viscous(n, law.viscous_time / unit, fall)
    else:
        shape = relaxing(law.g, law.tau / unit, fall)
    return scaled(shape, unit=unit, mass=mass, velocity=velocity, pull=pull)


def stiffness_of(exponent: float, *, unit: float, mass: float, velocity: float) -> float:
    """Return k of the contact whose lossless motion has that unit of time, s: depth over speed."""
    return float((exponent + 1) / 2 * mass * velocity ** (1 - exponent) / unit ** (exponent + 1))


class Shape(NamedTuple):
    """A motion in units of the speed of approach and of the depth of a lossless contact.

    There all numbers are near 1, and the laws have one parameter less.
    """

    time: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    force: FloatArray


def scaled(
    shape: Shape, *, unit: float, mass: float, velocity: float, pull: float = 0.0
) -> Collision:
    """Return the collision of a shape, with its unit of time, s."""
    depth, push = velocity * unit, mass * velocity / unit
    t, x, v, F = shape
    return Collision(t * unit, x * depth, v * velocity, F * push, mass, pull)


def _peak(t: FloatArray, y: FloatArray) -> float:
    """Of the parabola through the largest sample and its neighbours; an end is what it is."""
    top = int(y.argmax())
    if top in {0, len(y) - 1}:
        return float(y[top])
    near = t[top - 1 : top + 2] - t[top]
    (a, b, c) = np.linalg.solve(np.stack((near**2, near, np.ones(3)), axis=1), y[top - 1 : top + 2])
    return float(c - b**2 / (4 * a)) if a < 0 else float(y[top])


@lru_cache(maxsize=_REMEMBERED)
def viscous(n: float, A: float, pull: float = 0.0, *, tolerance: float = _TOLERANCE) -> Shape:
    """Return the motion where the force follows from displacement and velocity.

    A and pull are in units of the lossless contact.
    """
    scale = (n + 1) / 2

    def force(x: float, v: float) -> float:
        if x <= 0:
            return scale * A * v if n == 1 else 0.0
        return scale * (x + A * v if n == 1 else x**1.5 + 1.5 * A * x**0.5 * v)

    def rate(_: float, y: FloatArray) -> tuple[float, float]:
        x, v = y.tolist()
        return v, pull - force(x, v)

    # x^(n-1) is a factor of the force: what is left of it changes sign at the release
    t, y = _to_event(rate, (0.0, 1.0), lambda _, y: float(y[0] + n * A * y[1]), tolerance)
    x, v = y
    F = np.array([force(*pair) for pair in zip(x.tolist(), v.tolist(), strict=True)])
    F[-1] = 0.0
    return Shape(t, x, v, F)


@lru_cache(maxsize=_REMEMBERED)
def relaxing(g: float, tau: float, pull: float = 0.0, *, tolerance: float = _TOLERANCE) -> Shape:
    r"""Return Ting's contact: loading with a state of the arm, unloading at the size it once had.

    With :math:`q = \int e^{-(t-s)/\tau} dx^{3/2}` and :math:`p = \int e^{-(t-s)/\tau} dx`, the
    earlier indentation h of equal contact falls as

    .. math:: \dot h = \frac{(1 + g)\,\dot x - (h - x)/\tau}{1 + g\,e^{-(t-t_1)/\tau}}

    which is regular at the turn, where t_1 itself is not. tau and pull are in units of the lossless
    contact of the relaxed solid.
    """
    scale = 1.25

    def loading(_: float, y: FloatArray) -> tuple[float, float, float]:
        x, v, q = max(float(y[0]), 0.0), float(y[1]), float(y[2])
        return v, pull - scale * (x**1.5 + g * q), 1.5 * x**0.5 * v - q / tau

    t, y = _to_event(loading, (0.0, 1.0, 0.0), lambda _, y: float(y[1]), tolerance)
    top, at = float(y[0, -1]), t[-1]
    # near the turn the indentation is a parabola: its root is even in time
    root = np.sqrt(np.maximum(top - y[0], 0.0))
    from scipy.interpolate import CubicSpline

    order = np.argsort(root)
    earlier = CubicSpline(root[order], np.stack((t, y[2]), axis=1)[order])

    def state(now: float, h: float) -> tuple[float, float]:
        t1, q = earlier(np.sqrt(max(top - h, 0.0)))
        faded = g * np.exp(-(now - t1) / tau)
        return float(faded), scale * (max(h, 0.0) ** 1.5 + float(faded * q))

    def unloading(now: float, y: FloatArray) -> tuple[float, float, float]:
        x, v, h = y.tolist()
        faded, force = state(at + now, h)
        return v, pull - force, ((1 + g) * v - (h - x) / tau) / (1 + faded)

    later, z = _to_event(unloading, (top, 0.0, top), lambda _, y: float(y[2]), tolerance)
    F = np.concatenate(
        (
            scale * (np.maximum(y[0], 0.0) ** 1.5 + g * y[2]),
            [
                state(at + now, h)[1]
                for now, h in zip(later[1:].tolist(), z[2, 1:].tolist(), strict=True)
            ],
        )
    )
    F[-1] = 0.0
    return Shape(
        np.concatenate((t, at + later[1:])),
        np.concatenate((y[0], z[0, 1:])),
        np.concatenate((y[1], z[1, 1:])),
        F,
    )


def _to_event(
    rate: Callable[[float, FloatArray], tuple[float, ...]],
    start: tuple[float, ...],
    ends: Callable[[float, FloatArray], float],
    tolerance: float,
) -> tuple[FloatArray, FloatArray]:
    """Integrate until a function falls through zero; evenly sampled times and states there."""
    from scipy.integrate import solve_ivp

    def release(t: float, y: FloatArray) -> float:
        return ends(t, y)

    release.terminal = True  # type: ignore[attr-defined]
    release.direction = -1  # type: ignore[attr-defined]
    found = solve_ivp(
        rate, (0.0, _LONGEST), start, method="DOP853", events=release, dense_output=True,
        rtol=tolerance, atol=tolerance, max_step=0.3,
    )  # fmt: skip
    if found.status != 1 or found.t_events is None or found.sol is None:
        raise DataError(
            f"the body is still in contact after {_LONGEST:g} times the time of a lossless one: "
            "it is not let go; expected less damping or less pull"
        )
    t = np.linspace(0.0, float(found.t_events[0][0]), _SAMPLES)
    return t, np.asarray(found.sol(t))
