r"""Motion of a mass that hits a viscoelastic seal and rebounds.

.. math:: m\,\ddot x = m\,p - F, \qquad F = k_\infty\,u(x) + b\,\dot u + \sum_j q_j, \qquad
          \dot q_j = k_j\,\dot u - q_j / \tau_j

with p the acceleration of the free mass (gravity, for a fall) and u the path of the elastic law:
the quasi-linear seal (Fung). It ends where F falls to zero. Verlet steps of second order, with the
arms exact within each (:mod:`dashpot.solids.moving_plate`); several masses are integrated at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_positive
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.moving_plate import EvenStep

_FINE_STEPS, _COARSE_STEPS = 4000, 60
"""Number of steps of a contact: for an accuracy of 1e-7, or of a few per cent of its duration."""
_RELEASE_TEST_STEPS = 8
"""Number of steps between tests of the release."""
_LONGEST_CONTACT = 40.0
"""Longest contact, in durations of an elastic one; after it the mass does not rebound."""


class Masses(NamedTuple):
    """Masses on specimens, integrated simultaneously.

    Attributes
    ----------
    mass, speed : array, shape (n,)
        kg and m/s.
    gravity_acceleration : array, shape (n,) or (steps + 1, n)
        m/s^2.
    compute_path : callable
        Elastic path u, m, at compressions x, m, both of shape (n,).
    k_inf, b : array, shape (n,)
        N/m and N s/m.
    compute_path_derivative : callable
        :math:`du/dx` at compressions, where there is any b.
    k, tau : array, shape (n, arms)
        N/m and s.
    """

    mass: FloatArray
    speed: FloatArray
    gravity_acceleration: FloatArray
    compute_path: Callable[[FloatArray], FloatArray]
    k_inf: FloatArray
    k: FloatArray
    tau: FloatArray
    b: FloatArray | None = None
    compute_path_derivative: Callable[[FloatArray], FloatArray] | None = None


class MotionHistory(NamedTuple):
    """Motion from first contact, shape (steps + 1, n): m, m/s, N, and the elastic path, m."""

    x: FloatArray
    v: FloatArray
    force: FloatArray
    path: FloatArray


def integrate_impact(masses: Masses, step: float, max_steps: int) -> MotionHistory:
    """Return the motion until every mass has left its specimen, or a number of steps.

    Parameters
    ----------
    masses : Masses
    step : float
        s.
    max_steps : int
        Largest number of steps.
    """
    m, v, free_acceleration, path, k_inf, k, tau, b, factor = masses
    x, u, arms = np.zeros(len(m)), np.zeros(len(m)), np.zeros(k.shape)
    steps = EvenStep.from_ratio(step / tau)
    viscous = b is not None and factor is not None
    force = b * factor(x) * v if viscous else np.zeros(len(m))  # type: ignore[operator,misc]
    motion = MotionHistory(*np.empty((4, max_steps + 1, len(m))))
    half_step = 0.5 * step
    accelerations = np.broadcast_to(free_acceleration, (max_steps + 1, len(m)))
    acceleration, i = accelerations[0] - force / m, 0
    for i in range(max_steps + 1):
        if i:
            v = v + half_step * acceleration
            x = x + step * v
            next_u = path(x)
            arms = steps.end(arms, k * (next_u - u)[:, None])
            u, force = next_u, k_inf * next_u + arms.sum(axis=1)
            v = v + half_step * (accelerations[i] - force / m)
            if viscous:
                # the dashpot force depends on the speed at the end of the step
                damping = b * factor(x)  # type: ignore[operator,misc]
                v = v / (1 + half_step * damping / m)
                force = force + damping * v
            acceleration = accelerations[i] - force / m
        motion.x[i], motion.v[i], motion.force[i], motion.path[i] = x, v, force, u
        if not i % _RELEASE_TEST_STEPS and ((force <= 0) & (v < 0)).all():
            break
    return MotionHistory(*(values[: i + 1] for values in motion))


@dataclass(frozen=True, eq=False)
class ImpactMotion(EqualByValue):
    """Motion of one mass on one specimen, from first contact to release.

    Attributes
    ----------
    time, compression, velocity, force, elastic_force : array, shape (n,)
        s, m, m/s, N; the elastic force is that of the elastic law at equilibrium, N.
    mass : float
        kg.
    free_acceleration : float
        Acceleration of the free mass, m/s^2.
    """

    time: FloatArray
    compression: FloatArray
    velocity: FloatArray
    force: FloatArray
    elastic_force: FloatArray
    mass: float
    free_acceleration: float

    @property
    def peak(self) -> Instant:
        """Instant of the largest force."""
        return self._interpolate_instant(_find_vertex(self.force))

    @property
    def max_compression(self) -> Instant:
        """Instant of the largest compression."""
        return self._interpolate_instant(_find_vertex(self.compression))

    @property
    def release(self) -> Instant:
        """Instant of release."""
        return self._interpolate_instant(_find_zero(self.force))

    def _interpolate_instant(self, index_and_offset: tuple[int, float]) -> Instant:
        histories = (self.time, self.compression, self.velocity, self.force, self.elastic_force)
        return Instant(*(_interpolate_parabola(values, *index_and_offset) for values in histories))

    @property
    def energy(self) -> float:
        """Kinetic energy at first contact, J."""
        return 0.5 * self.mass * float(self.velocity[0]) ** 2

    @property
    def loading_work(self) -> float:
        """Work on the specimen to the largest compression, J."""
        return self.energy + self.mass * self.free_acceleration * self.max_compression.compression

    @property
    def absorbed_energy(self) -> float:
        """Work on the specimen to the release, J: the absorbed energy."""
        release = self.release
        remainder = 0.5 * self.mass * release.velocity**2
        return self.energy - remainder + self.mass * self.free_acceleration * release.compression

    @property
    def elastic_energy(self) -> float:
        """Energy of the elastic law at the largest compression, J."""
        i, offset = _find_vertex(self.compression)
        max_compression = self.max_compression
        loop_energy = float(np.trapezoid(self.elastic_force[: i + 1], self.compression[: i + 1]))
        equilibrium = 0.5 * (max_compression.elastic_force + float(self.elastic_force[i]))
        return (
            loop_energy + equilibrium * (max_compression.compression - float(self.compression[i]))
            if offset
            else loop_energy
        )

    @property
    def frequency(self) -> float:
        """Frequency of a cycle of twice the contact time, Hz."""
        return 0.5 / self.release.time

    @property
    def rebound(self) -> float:
        """Release speed over impact speed."""
        return float(-self.release.velocity / self.velocity[0])


class Instant(NamedTuple):
    """Instant of a motion: s, m, m/s, N, N."""

    time: float
    compression: float
    velocity: float
    force: float
    elastic_force: float


def simulate_impacts(
    models: Sequence[GeneralizedMaxwell],
    law: ElasticLaw,
    *,
    mass: float,
    speed: float,
    acceleration: float = 0.0,
) -> list[ImpactMotion]:
    """Return the motion of a mass that hits a specimen at rest, for each of several models.

    Parameters
    ----------
    models : sequence of GeneralizedMaxwell
        Secant models at the depth of the law, close to the first.
    law : ElasticLaw
        Its elastic path is used.
    mass : float
        kg.
    speed : float
        m/s, > 0.
    acceleration : float
        Acceleration of the free mass, m/s^2: gravity for a fall, 0 for a horizontal impact.

    Raises
    ------
    DataError
        If a number is not above zero, or the mass does not rebound.

    Notes
    -----
    Relative accuracy 1e-6, verified by the integrator DOP853.
    """
    require_positive(mass=mass, speed=speed, expected="a finite number above 0")
    count, arms = len(models), max(model.arms for model in models)
    k, tau = np.zeros((count, arms)), np.ones((count, arms))
    for i, model in enumerate(models):
        k[i, : model.arms], tau[i, : model.arms] = model.k, model.tau
    b = np.array([model.b for model in models])
    masses = Masses(
        np.full(count, mass), np.full(count, speed), np.full(count, acceleration), law.path,
        np.array([model.k_inf for model in models]), k, tau, b if b.any() else None, law.factor,
    )  # fmt: skip
    contact_time = _estimate_contact_time(masses, models[0], law)
    coarse_motion = integrate_impact(
        masses, contact_time / _COARSE_STEPS, int(_LONGEST_CONTACT * _COARSE_STEPS)
    )
    is_released = (coarse_motion.force <= 0) & (coarse_motion.v <= 0)
    if not is_released[-1].all():
        raise DataError(
            f"the mass is still on the specimen after {_LONGEST_CONTACT:g} times the time of an "
            "elastic contact: it does not rebound. Expected a lighter mass, or a faster one"
        )
    step = contact_time * int(is_released[:, 0].argmax()) / _COARSE_STEPS / _FINE_STEPS
    fine_motion = integrate_impact(masses, step, 3 * _FINE_STEPS)
    motions = []
    for i, model in enumerate(models):
        end = int(((fine_motion.force[:, i] <= 0) & (fine_motion.v[:, i] <= 0)).argmax()) + 1
        x, v, force, path = (values[:end, i] for values in fine_motion)
        time = step * np.arange(float(end))
        motions.append(ImpactMotion(time, x, v, force, model.k_inf * path, mass, acceleration))
    return motions


def _estimate_contact_time(masses: Masses, model: GeneralizedMaxwell, law: ElasticLaw) -> float:
    """Return the approximate duration of an elastic contact, s, by the energy of the law."""
    energy = 0.5 * float(masses.mass[0] * masses.speed[0] ** 2)
    x = np.linspace(0.0, law.depth, 201)
    path = law.path(x)
    work = np.concatenate(([0.0], np.cumsum(np.diff(x) * 0.5 * (path[1:] + path[:-1]))))
    stiffness = max(model.k_inf, 1e-3 * model.k_0)
    if stiffness * work[-1] > energy:
        depth = float(np.interp(energy / stiffness, work, x))
    else:
        depth = law.depth * float(np.sqrt(energy / (stiffness * work[-1])))
    return math.pi * depth / float(masses.speed[0])


def _find_vertex(y: FloatArray) -> tuple[int, float]:
    """Return the index of the largest sample, or the one before, and the offset of the vertex."""
    i = min(max(int(y.argmax()), 1), len(y) - 2)
    left, middle, right = y[i - 1 : i + 2].tolist()
    curvature = left - 2 * middle + right
    offset = 0.5 * (left - right) / curvature if curvature else 0.0
    return (i, offset) if offset >= 0 else (i - 1, 1 + offset)


def _find_zero(y: FloatArray) -> tuple[int, float]:
    """Return the index of the last sample above zero, and the offset of the parabola's zero."""
    i = len(y) - 2
    left, middle, right = y[i - 1 : i + 2].tolist()
    curvature, slope = 0.5 * (left - 2 * middle + right), 0.5 * (right - left)
    root = float(np.sqrt(max(slope**2 - 4 * curvature * middle, 0.0)))
    return i, min(max(-2 * middle / (slope - root), 0.0), 1.0)


def _interpolate_parabola(y: FloatArray, i: int, offset: float) -> float:
    """Return the value at an offset from a sample, by the parabola through its neighbours."""
    i, offset = (i, offset) if i else (1, offset - 1)
    left, middle, right = map(float, y[i - 1 : i + 2])
    return middle + offset * (0.5 * (right - left) + 0.5 * offset * (left - 2 * middle + right))
