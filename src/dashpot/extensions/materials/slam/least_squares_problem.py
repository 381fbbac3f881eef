"""Least-squares problem of all slams of a piece: law, arms, speeds and touches."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.parameter_estimate import parameter_names
from dashpot.extensions.materials.relaxation_model import normalise_relaxation
from dashpot.extensions.materials.slam.elastic_law import POWERS, SlamLaw
from dashpot.extensions.materials.slam.motion import Masses, integrate_impact
from dashpot.extensions.materials.slam.preprocess import RecordedSlam
from dashpot.fitting.prediction_bounds import get_solid_parameters
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows

STEPS = 240
"""Of a contact: right to 3e-5 of the largest force."""
_STEP = 1e-3
"""Of a difference, in scales of a parameter."""
_HELD = 1e-4
"""Standard deviation, as a part, of what the test of the memory held."""
_TRIES, _FLAT, _FINISHED = 40, 1e-6, 1e-4
_REBOUND = 0.95
_PLACES = ((0.1, 0.25), (0.5, 0.25), (0.5, 0.06))
"""Arms from which the search begins: g, and time in lengths of a contact."""
_STARTS, _NEAR, _ROUGHLY = 2, 8, 1e-3
"""Of them those that are followed, and the steps before, and what these may leave."""
_SHORTEST, _LONGEST = 0.01, 3.0
"""Between which the time of the arm lies, in lengths of a contact."""


@dataclass(frozen=True, eq=False)
class Memory:
    """Arms as known before the slams.

    Attributes
    ----------
    g, tau : array, shape (arms,)
        Over the relaxed force, and s.
    precision : array, shape (m, 2 arms)
        Rows whose products with the errors of g and ln tau are normal of standard deviation 1;
        none where the arms are held.
    fit : Fit or None
        Behind them.
    """

    g: FloatArray = field(default_factory=lambda: np.zeros(0))
    tau: FloatArray = field(default_factory=lambda: np.zeros(0))
    precision: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    fit: Fit | None = None

    @classmethod
    def from_fit(cls, fit: Fit | None) -> Memory:
        """Those of a fit: of a relaxation test, or with the law of a load deflection test."""
        if fit is None:
            return cls()
        solid = normalise_relaxation(fit.model)
        g, tau, arms = np.array(solid.k), np.array(solid.tau), solid.arms
        names, _, covariance = get_solid_parameters(fit)
        if names != parameter_names(arms) or not np.isfinite(covariance).all() or not arms:
            return cls(g, tau, np.zeros((0, 2 * arms)), fit)
        # of g = k / k_inf
        G = np.zeros((2 * arms, 1 + 2 * arms))
        G[:arms, 0] = -g / fit.model.k_inf
        G[:arms, 1 : 1 + arms] = np.eye(arms) / fit.model.k_inf
        G[arms:, 1 + arms :] = np.eye(arms)
        scale = np.concatenate((g, np.ones(arms)))
        size, turn = np.linalg.eigh((G @ covariance @ G.T) / np.outer(scale, scale))
        sd = np.sqrt(np.maximum(size, _HELD**2))
        return cls(g, tau, turn.T / sd[:, None] / scale, fit)

    @property
    def free(self) -> bool:
        """Whether its arms move with the fit."""
        return len(self.precision) > 0


@dataclass(frozen=True, eq=False)
class Slams:
    """All slams, each in units of its own scatter, with the prior knowledge.

    Theta holds c of the law, g and ln tau of the memory where that moves, g and ln tau of the arm,
    and of every slam its speed and touch.

    Attributes
    ----------
    hits : tuple of Struck
    mass : float
        kg.
    pulls : array, shape (slams,)
        m/s^2.
    said : array, shape (slams,)
        Speeds that were given, m/s; nan where none was.
    said_sd : float
        Standard deviation of each, as a part of it.
    law : SlamLaw
    memory : Memory
    """

    hits: tuple[RecordedSlam, ...]
    mass: float
    pulls: FloatArray
    said: FloatArray
    said_sd: float
    law: SlamLaw
    memory: Memory

    @property
    def step(self) -> float:
        """Of the march, s."""
        return max(hit.contact for hit in self.hits) * 1.3 / STEPS

    @property
    def memory_parameter_count(self) -> int:
        """Places of the memory that moves."""
        return 2 * len(self.memory.g) if self.memory.free else 0

    @property
    def shared_parameter_count(self) -> int:
        """Thetas that all slams share."""
        return len(POWERS) + self.memory_parameter_count + 2

    def arms(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """G and tau of every arm, the sought one last, shape (..., arms)."""
        first, n = len(POWERS), len(self.memory.g)
        shape = (*theta.shape[:-1], n)
        g, tau = np.broadcast_to(self.memory.g, shape), np.broadcast_to(self.memory.tau, shape)
        if self.memory.free:
            g, tau = theta[..., first : first + n], np.exp(theta[..., first + n : first + 2 * n])
        own_g, own_tau = (
            theta[..., self.shared_parameter_count - 2, None],
            np.exp(theta[..., self.shared_parameter_count - 1, None]),
        )
        return np.concatenate((g, own_g), axis=-1), np.concatenate((tau, own_tau), axis=-1)

    def speeds(self, theta: FloatArray) -> FloatArray:
        """Of every slam, m/s."""
        return theta[self.shared_parameter_count :: 2]

    def touches(self, theta: FloatArray) -> FloatArray:
        """Of every slam, s."""
        return theta[self.shared_parameter_count + 1 :: 2]

    def integrate_motion(
        self, theta: FloatArray, speed: FloatArray, pull: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """x, v, force, relaxed force by steps, shape (steps + 1, n), of rows of theta, (n, p)."""
        g, tau = self.arms(theta)
        c = theta[:, : len(POWERS)]
        n = len(theta)
        masses = Masses(
            np.full(n, self.mass), speed, pull, partial(self.law.force, c=c), np.ones(n), g, tau
        )
        # a trial law that pulls runs away, and is refused for it
        with np.errstate(over="ignore", invalid="ignore"):
            x, v, force, relaxed = integrate_impact(masses, self.step, STEPS)
        gone = np.maximum.accumulate((force <= 0) & (v < 0), axis=0)
        return x, v, np.where(gone, 0.0, force), relaxed

    def forces(self, theta: FloatArray) -> list[FloatArray]:
        """Return what every slam is modelled as."""
        rows = np.repeat(theta[None, :], len(self.hits), axis=0)
        force = self.integrate_motion(rows, self.speeds(theta), self.pulls)[2]
        return [
            self.sample_force(force[:, i], hit.time - touch)
            for i, (hit, touch) in enumerate(
                zip(self.hits, self.touches(theta).tolist(), strict=True)
            )
        ]

    def sample_force(self, force: FloatArray, since: FloatArray) -> FloatArray:
        """Of a force by steps what is sampled at times since the touch, s."""
        nodes = self.step * np.arange(len(force))
        return np.interp(since, nodes, force, left=0.0, right=0.0)

    def slopes(self, theta: FloatArray) -> FloatArray:
        """Derivative of all forces by theta, all slams and all differences marched as one."""
        shared, many = self.shared_parameter_count, len(self.hits)
        scale = np.array([parameter.scale for parameter in self.parameters])
        # up and down of what all share, and of the own speed
        moves = np.zeros((2 * (shared + 1), shared + 1))
        moves[: shared + 1] = np.eye(shared + 1)
        moves[shared + 1 :] = -np.eye(shared + 1)
        moves *= _STEP
        count = 2 * (shared + 1) + 1
        rows = np.repeat(theta[None, :shared], count * many, axis=0)
        speed = np.repeat(self.speeds(theta), count)
        pull = np.repeat(self.pulls, count)
        for i in range(many):
            at = slice(i * count + 1, (i + 1) * count)
            rows[at] += moves[:, :shared] * scale[:shared]
            speed[at] += moves[:, shared] * scale[shared + 2 * i]
        force = self.integrate_motion(rows, speed, pull)[2]
        J = []
        for i, hit in enumerate(self.hits):
            since = hit.time - self.touches(theta)[i]
            values = np.zeros((len(since), len(theta)))
            here = force[:, i * count]
            for j in range(shared + 1):
                up, down = (force[:, i * count + 1 + j + k * (shared + 1)] for k in (0, 1))
                place = j if j < shared else shared + 2 * i
                values[:, place] = self.sample_force(up - down, since) / (2 * _STEP * scale[place])
            values[:, shared + 2 * i + 1] = -self.sample_force(np.gradient(here, self.step), since)
            J.append(values / hit.noise)
        return np.concatenate(J)

    @property
    def priors(self) -> tuple[FloatArray, FloatArray]:
        """Rows P and what P theta is about, in standard deviations."""
        first, places = len(POWERS), self.shared_parameter_count + 2 * len(self.hits)
        law = np.zeros((len(self.law.precision), places))
        law[:, :first] = self.law.precision
        memory = np.zeros((len(self.memory.precision), places))
        memory[:, first : first + self.memory_parameter_count] = self.memory.precision
        about = self.memory.precision @ np.concatenate((self.memory.g, np.log(self.memory.tau)))
        indices = np.flatnonzero(np.isfinite(self.said))
        speeds = np.zeros((len(indices), places))
        sd = self.said_sd * self.said[indices]
        speeds[np.arange(len(indices)), self.shared_parameter_count + 2 * indices] = 1 / sd
        rows = np.concatenate((law, memory, speeds))
        return rows, np.concatenate((np.zeros(len(law)), about, self.said[indices] / sd))

    def rows(self, theta: FloatArray) -> Rows:
        """Return the slams less their motions, and what the sensors' zeros add, and the priors."""
        P, about = self.priors
        if self.speeds(theta).min() <= 0:
            raise DataError("an impact has a speed above 0")
        modelled = self.forces(theta)
        residuals = [
            (hit.force - force) / hit.noise for hit, force in zip(self.hits, modelled, strict=True)
        ]
        if not all(np.isfinite(residual).all() for residual in residuals):
            raise DataError("the law pulls")
        sizes = [len(residual) for residual in residuals]
        zero = np.repeat(np.diag([1 / hit.noise for hit in self.hits]), sizes, axis=0)

        def slope(_: FloatArray) -> FloatArray:
            return np.concatenate((self.slopes(theta), P))

        return Rows(
            np.concatenate((*residuals, about - P @ theta)),
            np.concatenate((zero, np.zeros((len(P), len(sizes))))),
            slope,
        )

    @property
    def initial_speeds_and_touches(self) -> FloatArray:
        """Speeds and touches to begin with, interleaved."""
        impulse = np.array(
            [float(np.trapezoid(np.maximum(hit.force, 0.0), hit.time)) for hit in self.hits]
        )
        contact = np.array([hit.contact for hit in self.hits])
        thrown = (impulse / self.mass - self.pulls * contact) / (1 + _REBOUND)
        speed = np.where(np.isfinite(self.said), self.said, np.maximum(thrown, 1e-3))
        return np.stack((speed, [hit.touch for hit in self.hits]), axis=1).ravel()

    @property
    def parameters(self) -> list[Parameter]:
        """Ranges and sizes of theta."""
        peak = max(float(hit.force.max()) for hit in self.hits)
        depth = self.depth
        contact = min(hit.contact for hit in self.hits)
        cubic = [Parameter(scale=0.1 * peak / depth**i) for i in POWERS.tolist()]
        memory = []
        if self.memory.free:
            memory = [Parameter(0.0, np.inf, 0.1 * value) for value in self.memory.g.tolist()]
            memory += [Parameter(scale=0.1) for _ in self.memory.tau]
        arm = [
            Parameter(0.0, 50.0, 0.1),
            Parameter(math.log(_SHORTEST * contact), math.log(_LONGEST * contact), 0.3),
        ]
        parameters: list[Parameter] = []
        for i, slam in enumerate(self.hits):
            speed = float(self.initial_speeds_and_touches[2 * i])
            parameters.append(Parameter(0.2 * speed, 5 * speed, 0.05 * speed))
            far = 0.3 * slam.contact
            parameters.append(Parameter(slam.touch - far, slam.touch + far, 0.02 * slam.contact))
        return [*cubic, *memory, *arm, *parameters]

    @property
    def depth(self) -> float:
        """Largest compression, roughly, m: a fast mass is brought to rest over half a contact."""
        return max(
            2 / np.pi * 0.5 * hit.contact * float(speed)
            for hit, speed in zip(self.hits, self.initial_speeds_and_touches[::2], strict=True)
        )

    def find_optimum(self) -> Optimum | None:
        """The best of some arms: each held at first, for beside a poor law it would go to 0."""
        problem = Problem(self.rows, self.parameters, priors=len(self.priors[0]))
        arm = slice(self.shared_parameter_count - 2, self.shared_parameter_count)
        held = []
        for start in self.starts:
            still = problem.fix_parameter(
                self.shared_parameter_count - 1, start[arm][1]
            ).fix_parameter(self.shared_parameter_count - 2, start[arm][0])
            rest = np.delete(start, arm)
            if (near := still.solve([rest], most=_NEAR, flat=_ROUGHLY)) is not None:
                held.append(
                    (
                        near.cost,
                        np.insert(near.theta, [self.shared_parameter_count - 2] * 2, start[arm]),
                    )
                )
        held.sort(key=lambda pair: pair[0])
        starts = [values for _, values in held[:_STARTS]]
        return problem.solve(starts, most=_TRIES, finished=_FINISHED, flat=_FLAT)

    @property
    def starts(self) -> list[FloatArray]:
        """Thetas to begin with, one for each arm that is tried."""
        contact = float(np.median([hit.contact for hit in self.hits]))
        memory = (
            np.concatenate((self.memory.g, np.log(self.memory.tau)))
            if self.memory.free
            else np.zeros(0)
        )
        cubic = np.zeros(len(POWERS)) if self.law.known else self._cubic()
        return [
            np.concatenate(
                (cubic, memory, [g, np.log(part * contact)], self.initial_speeds_and_touches)
            )
            for g, part in _PLACES
        ]

    def _cubic(self) -> FloatArray:
        """A free law, by the force over the path that it gives the mass, less what the arms add."""
        slow = 1 + float(self.memory.g.sum()) + 0.1
        columns, forces = [], []
        for hit, speed, pull in zip(
            self.hits, self.initial_speeds_and_touches[::2], self.pulls, strict=True
        ):
            inside = hit.time >= hit.touch
            time, force = hit.time[inside], hit.force[inside]
            step = np.diff(time, prepend=time[0])
            velocity = speed + np.cumsum(step * (pull - force / self.mass))
            x = np.cumsum(step * velocity)
            loading = slice(0, max(int(x.argmax()), 4))
            columns.append(x[loading, None] ** POWERS)
            forces.append(force[loading] / slow)
        A, y = np.concatenate(columns), np.concatenate(forces)
        size = np.linalg.norm(A, axis=0)
        return np.asarray(np.linalg.lstsq(A / size, y, rcond=1e-8)[0] / size)
