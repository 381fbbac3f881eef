"""Least-squares problem of the impacts of a specimen: law, arms, speeds, times of contact."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.parameter_estimate import parameter_names
from dashpot.extensions.materials.drop.elastic_law import POWERS, ElasticLawPrior
from dashpot.extensions.materials.drop.motion import Masses, integrate_impact
from dashpot.extensions.materials.drop.preprocess import RecordedImpact
from dashpot.extensions.materials.relaxation_model import normalise_relaxation
from dashpot.fitting.prediction_bounds import get_solid_parameters
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows

STEPS = 240
"""Of a contact: right to 3e-5 of the largest force."""
_STEP = 1e-3
"""Of a difference, in scales of a parameter."""
_HELD = 1e-4
"""Least relative standard deviation of an arm of the relaxation test."""
_TRIES, _FLAT, _FINISHED = 40, 1e-6, 1e-4
_REBOUND = 0.95
_PLACES = ((0.1, 0.25), (0.5, 0.25), (0.5, 0.06))
"""Arms from which the search begins: g, and time in lengths of a contact."""
_STARTS, _NEAR, _ROUGHLY = 2, 8, 1e-3
"""Of them those that are followed, and the steps before, and what these may leave."""
_SHORTEST, _LONGEST = 0.01, 3.0
"""Between which the time of the arm lies, in lengths of a contact."""


@dataclass(frozen=True, eq=False)
class RelaxationPrior:
    """Arms of a relaxation test, with their uncertainty.

    Attributes
    ----------
    g, tau : array, shape (arms,)
        Over the relaxed force, and s.
    precision : array, shape (m, 2 arms)
        Rows whose products with the errors of g and ln tau are normal of standard deviation 1;
        none where the arms are fixed.
    fit : Fit or None
        Behind them.
    """

    g: FloatArray = field(default_factory=lambda: np.zeros(0))
    tau: FloatArray = field(default_factory=lambda: np.zeros(0))
    precision: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    fit: Fit | None = None

    @classmethod
    def from_fit(cls, fit: Fit | None) -> RelaxationPrior:
        """Return the arms of a fit, with the precision of its covariance."""
        if fit is None:
            return cls()
        model = normalise_relaxation(fit.model)
        g, tau, arms = np.array(model.k), np.array(model.tau), model.arms
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
        """Whether the arms are parameters of the fit."""
        return len(self.precision) > 0


@dataclass(frozen=True, eq=False)
class DropProblem:
    """Least-squares problem of all impacts, each in units of its noise, with prior rows.

    Theta holds c of the elastic law, g and ln tau of the relaxation test's arms where these are
    fitted, g and ln tau of the fast arm, and speed and time of first contact of every impact.

    Attributes
    ----------
    hits : tuple of RecordedImpact
    mass : float
        kg.
    pulls : array, shape (impacts,)
        m/s^2.
    stated_speeds : array, shape (impacts,)
        Speeds that were given, m/s; nan where none was.
    speed_sd : float
        Standard deviation of each, as a part of it.
    law : ElasticLawPrior
    relaxation : RelaxationPrior
    """

    hits: tuple[RecordedImpact, ...]
    mass: float
    pulls: FloatArray
    stated_speeds: FloatArray
    speed_sd: float
    law: ElasticLawPrior
    relaxation: RelaxationPrior

    @property
    def step(self) -> float:
        """Time step of the integration, s."""
        return max(hit.contact for hit in self.hits) * 1.3 / STEPS

    @property
    def relaxation_parameter_count(self) -> int:
        """Number of parameters of the relaxation test's arms."""
        return 2 * len(self.relaxation.g) if self.relaxation.free else 0

    @property
    def shared_parameter_count(self) -> int:
        """Number of parameters that all impacts share."""
        return len(POWERS) + self.relaxation_parameter_count + 2

    def arms(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return g and tau of every arm, the fast one last, shape (..., arms)."""
        first, n = len(POWERS), len(self.relaxation.g)
        shape = (*theta.shape[:-1], n)
        g, tau = (
            np.broadcast_to(self.relaxation.g, shape),
            np.broadcast_to(self.relaxation.tau, shape),
        )
        if self.relaxation.free:
            g, tau = theta[..., first : first + n], np.exp(theta[..., first + n : first + 2 * n])
        own_g, own_tau = (
            theta[..., self.shared_parameter_count - 2, None],
            np.exp(theta[..., self.shared_parameter_count - 1, None]),
        )
        return np.concatenate((g, own_g), axis=-1), np.concatenate((tau, own_tau), axis=-1)

    def speeds(self, theta: FloatArray) -> FloatArray:
        """Return the speed of every impact, m/s."""
        return theta[self.shared_parameter_count :: 2]

    def touches(self, theta: FloatArray) -> FloatArray:
        """Return the time of first contact of every impact, s."""
        return theta[self.shared_parameter_count + 1 :: 2]

    def integrate_motion(
        self, theta: FloatArray, speed: FloatArray, pull: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return x, v, force, relaxed force by steps, (steps + 1, n), at rows of theta, (n, p)."""
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
        """Return the modelled force of every impact."""
        rows = np.repeat(theta[None, :], len(self.hits), axis=0)
        force = self.integrate_motion(rows, self.speeds(theta), self.pulls)[2]
        return [
            self.sample_force(force[:, i], hit.time - touch)
            for i, (hit, touch) in enumerate(
                zip(self.hits, self.touches(theta).tolist(), strict=True)
            )
        ]

    def sample_force(self, force: FloatArray, since: FloatArray) -> FloatArray:
        """Return a force by steps at times since first contact, s."""
        nodes = self.step * np.arange(len(force))
        return np.interp(since, nodes, force, left=0.0, right=0.0)

    def slopes(self, theta: FloatArray) -> FloatArray:
        """Return the derivatives of all forces by theta, by central differences."""
        shared, many = self.shared_parameter_count, len(self.hits)
        scale = np.array([parameter.scale for parameter in self.parameters])
        # up and down of the shared parameters, and of the impact's speed
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
        """Prior rows P and the means of P theta, in standard deviations."""
        first, places = len(POWERS), self.shared_parameter_count + 2 * len(self.hits)
        law = np.zeros((len(self.law.precision), places))
        law[:, :first] = self.law.precision
        relaxation = np.zeros((len(self.relaxation.precision), places))
        relaxation[:, first : first + self.relaxation_parameter_count] = self.relaxation.precision
        about = self.relaxation.precision @ np.concatenate(
            (self.relaxation.g, np.log(self.relaxation.tau))
        )
        indices = np.flatnonzero(np.isfinite(self.stated_speeds))
        speeds = np.zeros((len(indices), places))
        sd = self.speed_sd * self.stated_speeds[indices]
        speeds[np.arange(len(indices)), self.shared_parameter_count + 2 * indices] = 1 / sd
        rows = np.concatenate((law, relaxation, speeds))
        return rows, np.concatenate((np.zeros(len(law)), about, self.stated_speeds[indices] / sd))

    def rows(self, theta: FloatArray) -> Rows:
        """Return the residuals, the columns of the sensors' zeros, and the prior rows."""
        P, about = self.priors
        if self.speeds(theta).min() <= 0:
            raise DataError("an impact has a speed above 0")
        modelled = self.forces(theta)
        residuals = [
            (hit.force - force) / hit.noise for hit, force in zip(self.hits, modelled, strict=True)
        ]
        if not all(np.isfinite(residual).all() for residual in residuals):
            raise DataError("the elastic law gives tension")
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
        """Starting speeds and times of first contact, interleaved."""
        impulse = np.array(
            [float(np.trapezoid(np.maximum(hit.force, 0.0), hit.time)) for hit in self.hits]
        )
        contact = np.array([hit.contact for hit in self.hits])
        thrown = (impulse / self.mass - self.pulls * contact) / (1 + _REBOUND)
        speed = np.where(
            np.isfinite(self.stated_speeds), self.stated_speeds, np.maximum(thrown, 1e-3)
        )
        return np.stack((speed, [hit.touch for hit in self.hits]), axis=1).ravel()

    @property
    def parameters(self) -> list[Parameter]:
        """Bounds and scales of theta."""
        peak = max(float(hit.force.max()) for hit in self.hits)
        depth = self.depth
        contact = min(hit.contact for hit in self.hits)
        cubic = [Parameter(scale=0.1 * peak / depth**i) for i in POWERS.tolist()]
        relaxation = []
        if self.relaxation.free:
            relaxation = [
                Parameter(0.0, np.inf, 0.1 * value) for value in self.relaxation.g.tolist()
            ]
            relaxation += [Parameter(scale=0.1) for _ in self.relaxation.tau]
        arm = [
            Parameter(0.0, 50.0, 0.1),
            Parameter(math.log(_SHORTEST * contact), math.log(_LONGEST * contact), 0.3),
        ]
        parameters: list[Parameter] = []
        for i, impact in enumerate(self.hits):
            speed = float(self.initial_speeds_and_touches[2 * i])
            parameters.append(Parameter(0.2 * speed, 5 * speed, 0.05 * speed))
            far = 0.3 * impact.contact
            parameters.append(
                Parameter(impact.touch - far, impact.touch + far, 0.02 * impact.contact)
            )
        return [*cubic, *relaxation, *arm, *parameters]

    @property
    def depth(self) -> float:
        """Largest compression, roughly, m: a fast mass is brought to rest over half a contact."""
        return max(
            2 / np.pi * 0.5 * hit.contact * float(speed)
            for hit, speed in zip(self.hits, self.initial_speeds_and_touches[::2], strict=True)
        )

    def find_optimum(self) -> Optimum | None:
        """Return the best fit from several starting arms, fixed at first so that none goes to 0."""
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
        """Starting points, one for each arm that is tried."""
        contact = float(np.median([hit.contact for hit in self.hits]))
        relaxation = (
            np.concatenate((self.relaxation.g, np.log(self.relaxation.tau)))
            if self.relaxation.free
            else np.zeros(0)
        )
        cubic = np.zeros(len(POWERS)) if self.law.known else self._cubic()
        return [
            np.concatenate(
                (cubic, relaxation, [g, np.log(part * contact)], self.initial_speeds_and_touches)
            )
            for g, part in _PLACES
        ]

    def _cubic(self) -> FloatArray:
        """Return a cubic law by the force over the integrated path, less the force of the arms."""
        slow = 1 + float(self.relaxation.g.sum()) + 0.1
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
