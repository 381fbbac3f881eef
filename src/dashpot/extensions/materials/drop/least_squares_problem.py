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
"""Time steps in a contact, for an error of 3e-5 of the largest force."""
_DIFFERENCE_STEP = 1e-3
"""Step of a central difference, in scales of the parameter."""
_MIN_ARM_SD = 1e-4
"""Least relative standard deviation of an arm of the relaxation test."""
_MAX_STEPS, _MIN_DECREASE, _MIN_STEP = 40, 1e-6, 1e-4
_USUAL_RESTITUTION = 0.95
_STARTING_ARMS = ((0.1, 0.25), (0.5, 0.25), (0.5, 0.06))
"""Fast arms from which the search begins: g, and tau in contact times."""
_STARTS_FOLLOWED, _FIRST_STEPS, _FIRST_DECREASE = 2, 8, 1e-3
"""Starts that are followed to the end; steps by which they are chosen, and their tolerance."""
_SHORTEST_TAU, _LONGEST_TAU = 0.01, 3.0
"""Bounds of the relaxation time of the fast arm, in contact times."""


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
        eigenvalues, eigenvectors = np.linalg.eigh((G @ covariance @ G.T) / np.outer(scale, scale))
        sd = np.sqrt(np.maximum(eigenvalues, _MIN_ARM_SD**2))
        return cls(g, tau, eigenvectors.T / sd[:, None] / scale, fit)

    @property
    def free(self) -> bool:
        """Whether the arms are parameters of the fit."""
        return len(self.precision) > 0


@dataclass(frozen=True, eq=False)
class DropProblem:
    """Least-squares problem of all impacts, each in units of its noise, with prior rows.

    The vector `theta` of its parameters holds c of the elastic law, g and ln tau of the relaxation
    test's arms where these are fitted, g and ln tau of the fast arm, and the speed and the time of
    first contact of every impact.

    Attributes
    ----------
    impacts : tuple of RecordedImpact
    mass : float
        kg.
    gravity_accelerations : array, shape (impacts,)
        m/s^2.
    stated_speeds : array, shape (impacts,)
        Stated speeds, m/s; nan where none was.
    speed_sd : float
        Standard deviation of each, as a part of it.
    law : ElasticLawPrior
    relaxation : RelaxationPrior
    """

    impacts: tuple[RecordedImpact, ...]
    mass: float
    gravity_accelerations: FloatArray
    stated_speeds: FloatArray
    speed_sd: float
    law: ElasticLawPrior
    relaxation: RelaxationPrior

    @property
    def step(self) -> float:
        """Time step of the integration, s."""
        return max(hit.contact_duration for hit in self.impacts) * 1.3 / STEPS

    @property
    def relaxation_parameter_count(self) -> int:
        """Number of parameters of the relaxation test's arms."""
        return 2 * len(self.relaxation.g) if self.relaxation.free else 0

    @property
    def shared_parameter_count(self) -> int:
        """Number of parameters that all impacts share."""
        return len(POWERS) + self.relaxation_parameter_count + 2

    def compute_arms(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return g and tau of every arm, the fast one last, shape (..., arms)."""
        start, n = len(POWERS), len(self.relaxation.g)
        shape = (*theta.shape[:-1], n)
        g, tau = (
            np.broadcast_to(self.relaxation.g, shape),
            np.broadcast_to(self.relaxation.tau, shape),
        )
        if self.relaxation.free:
            g, tau = theta[..., start : start + n], np.exp(theta[..., start + n : start + 2 * n])
        fast_g, fast_tau = (
            theta[..., self.shared_parameter_count - 2, None],
            np.exp(theta[..., self.shared_parameter_count - 1, None]),
        )
        return np.concatenate((g, fast_g), axis=-1), np.concatenate((tau, fast_tau), axis=-1)

    def select_speeds(self, theta: FloatArray) -> FloatArray:
        """Return the speed of every impact, m/s."""
        return theta[self.shared_parameter_count :: 2]

    def select_contact_times(self, theta: FloatArray) -> FloatArray:
        """Return the time of first contact of every impact, s."""
        return theta[self.shared_parameter_count + 1 :: 2]

    def integrate_motion(
        self, theta: FloatArray, speed: FloatArray, acceleration: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return x, v, force, relaxed force by steps, (steps + 1, n), at rows of theta, (n, p)."""
        g, tau = self.compute_arms(theta)
        c = theta[:, : len(POWERS)]
        n = len(theta)
        masses = Masses(
            np.full(n, self.mass),
            speed,
            acceleration,
            partial(self.law.force, c=c),
            np.ones(n),
            g,
            tau,
        )
        # a trial law that pulls runs away, and is refused for it
        with np.errstate(over="ignore", invalid="ignore"):
            x, v, force, relaxed_force = integrate_impact(masses, self.step, STEPS)
        is_released = np.maximum.accumulate((force <= 0) & (v < 0), axis=0)
        return x, v, np.where(is_released, 0.0, force), relaxed_force

    def compute_forces(self, theta: FloatArray) -> list[FloatArray]:
        """Return the modelled force of every impact."""
        rows = np.repeat(theta[None, :], len(self.impacts), axis=0)
        force = self.integrate_motion(rows, self.select_speeds(theta), self.gravity_accelerations)[
            2
        ]
        return [
            self.sample_force(force[:, i], hit.time - contact_time)
            for i, (hit, contact_time) in enumerate(
                zip(self.impacts, self.select_contact_times(theta).tolist(), strict=True)
            )
        ]

    def sample_force(self, force: FloatArray, time: FloatArray) -> FloatArray:
        """Return a force by steps at times since first contact, s."""
        nodes = self.step * np.arange(len(force))
        return np.interp(time, nodes, force, left=0.0, right=0.0)

    def compute_jacobian(self, theta: FloatArray) -> FloatArray:
        """Return the derivatives of all forces by theta, by central differences."""
        shared_count, impact_count = self.shared_parameter_count, len(self.impacts)
        scale = np.array([parameter.scale for parameter in self.parameters])
        # up and down of the shared parameters, and of the impact's speed
        steps = np.zeros((2 * (shared_count + 1), shared_count + 1))
        steps[: shared_count + 1] = np.eye(shared_count + 1)
        steps[shared_count + 1 :] = -np.eye(shared_count + 1)
        steps *= _DIFFERENCE_STEP
        motions_per_impact = 2 * (shared_count + 1) + 1
        rows = np.repeat(theta[None, :shared_count], motions_per_impact * impact_count, axis=0)
        speed = np.repeat(self.select_speeds(theta), motions_per_impact)
        acceleration = np.repeat(self.gravity_accelerations, motions_per_impact)
        for i in range(impact_count):
            block = slice(i * motions_per_impact + 1, (i + 1) * motions_per_impact)
            rows[block] += steps[:, :shared_count] * scale[:shared_count]
            speed[block] += steps[:, shared_count] * scale[shared_count + 2 * i]
        force = self.integrate_motion(rows, speed, acceleration)[2]
        J = []
        for i, hit in enumerate(self.impacts):
            time = hit.time - self.select_contact_times(theta)[i]
            values = np.zeros((len(time), len(theta)))
            unchanged_force = force[:, i * motions_per_impact]
            for j in range(shared_count + 1):
                increased, decreased = (
                    force[:, i * motions_per_impact + 1 + j + k * (shared_count + 1)]
                    for k in (0, 1)
                )
                column = j if j < shared_count else shared_count + 2 * i
                values[:, column] = self.sample_force(increased - decreased, time) / (
                    2 * _DIFFERENCE_STEP * scale[column]
                )
            values[:, shared_count + 2 * i + 1] = -self.sample_force(
                np.gradient(unchanged_force, self.step), time
            )
            J.append(values / hit.noise)
        return np.concatenate(J)

    @property
    def priors(self) -> tuple[FloatArray, FloatArray]:
        """Prior rows P and the means of P theta, in standard deviations."""
        law_count, parameter_count = (
            len(POWERS),
            self.shared_parameter_count + 2 * len(self.impacts),
        )
        law = np.zeros((len(self.law.precision), parameter_count))
        law[:, :law_count] = self.law.precision
        relaxation = np.zeros((len(self.relaxation.precision), parameter_count))
        relaxation[:, law_count : law_count + self.relaxation_parameter_count] = (
            self.relaxation.precision
        )
        relaxation_means = self.relaxation.precision @ np.concatenate(
            (self.relaxation.g, np.log(self.relaxation.tau))
        )
        indices = np.flatnonzero(np.isfinite(self.stated_speeds))
        speeds = np.zeros((len(indices), parameter_count))
        sd = self.speed_sd * self.stated_speeds[indices]
        speeds[np.arange(len(indices)), self.shared_parameter_count + 2 * indices] = 1 / sd
        rows = np.concatenate((law, relaxation, speeds))
        return rows, np.concatenate(
            (np.zeros(len(law)), relaxation_means, self.stated_speeds[indices] / sd)
        )

    def compute_rows(self, theta: FloatArray) -> Rows:
        """Return the residuals, the columns of the sensors' zeros, and the prior rows."""
        P, prior_means = self.priors
        if self.select_speeds(theta).min() <= 0:
            raise DataError("an impact has a speed above 0")
        modelled = self.compute_forces(theta)
        residuals = [
            (hit.force - force) / hit.noise
            for hit, force in zip(self.impacts, modelled, strict=True)
        ]
        if not all(np.isfinite(residual).all() for residual in residuals):
            raise DataError("the elastic law gives tension")
        sizes = [len(residual) for residual in residuals]
        zero_columns = np.repeat(np.diag([1 / hit.noise for hit in self.impacts]), sizes, axis=0)

        def compute_slope(_: FloatArray) -> FloatArray:
            return np.concatenate((self.compute_jacobian(theta), P))

        return Rows(
            np.concatenate((*residuals, prior_means - P @ theta)),
            np.concatenate((zero_columns, np.zeros((len(P), len(sizes))))),
            compute_slope,
        )

    @property
    def initial_speeds_and_contact_times(self) -> FloatArray:
        """Starting speeds and times of first contact, interleaved."""
        impulse = np.array(
            [float(np.trapezoid(np.maximum(hit.force, 0.0), hit.time)) for hit in self.impacts]
        )
        contact = np.array([hit.contact_duration for hit in self.impacts])
        rebound_speed = (impulse / self.mass - self.gravity_accelerations * contact) / (
            1 + _USUAL_RESTITUTION
        )
        speed = np.where(
            np.isfinite(self.stated_speeds), self.stated_speeds, np.maximum(rebound_speed, 1e-3)
        )
        return np.stack((speed, [hit.contact_start for hit in self.impacts]), axis=1).ravel()

    @property
    def parameters(self) -> list[Parameter]:
        """Bounds and scales of theta."""
        peak = max(float(hit.force.max()) for hit in self.impacts)
        depth = self.depth
        contact = min(hit.contact_duration for hit in self.impacts)
        cubic = [Parameter(scale=0.1 * peak / depth**i) for i in POWERS.tolist()]
        relaxation = []
        if self.relaxation.free:
            relaxation = [
                Parameter(0.0, np.inf, 0.1 * value) for value in self.relaxation.g.tolist()
            ]
            relaxation += [Parameter(scale=0.1) for _ in self.relaxation.tau]
        arm = [
            Parameter(0.0, 50.0, 0.1),
            Parameter(math.log(_SHORTEST_TAU * contact), math.log(_LONGEST_TAU * contact), 0.3),
        ]
        parameters: list[Parameter] = []
        for i, impact in enumerate(self.impacts):
            speed = float(self.initial_speeds_and_contact_times[2 * i])
            parameters.append(Parameter(0.2 * speed, 5 * speed, 0.05 * speed))
            shift = 0.3 * impact.contact_duration
            parameters.append(
                Parameter(
                    impact.contact_start - shift,
                    impact.contact_start + shift,
                    0.02 * impact.contact_duration,
                )
            )
        return [*cubic, *relaxation, *arm, *parameters]

    @property
    def depth(self) -> float:
        """Largest compression, roughly, m: a fast mass is brought to rest over half a contact."""
        return max(
            2 / np.pi * 0.5 * hit.contact_duration * float(speed)
            for hit, speed in zip(
                self.impacts, self.initial_speeds_and_contact_times[::2], strict=True
            )
        )

    def find_optimum(self) -> Optimum | None:
        """Return the best fit from several starting arms, fixed at first to keep them from 0."""
        problem = Problem(self.compute_rows, self.parameters, priors=len(self.priors[0]))
        arm = slice(self.shared_parameter_count - 2, self.shared_parameter_count)
        candidates = []
        for start in self.starting_points:
            restricted_problem = problem.fix_parameter(
                self.shared_parameter_count - 1, start[arm][1]
            ).fix_parameter(self.shared_parameter_count - 2, start[arm][0])
            restricted_start = np.delete(start, arm)
            if (
                restricted_optimum := restricted_problem.solve(
                    [restricted_start], max_steps=_FIRST_STEPS, cost_tolerance=_FIRST_DECREASE
                )
            ) is not None:
                candidates.append(
                    (
                        restricted_optimum.cost,
                        np.insert(
                            restricted_optimum.theta,
                            [self.shared_parameter_count - 2] * 2,
                            start[arm],
                        ),
                    )
                )
        candidates.sort(key=lambda pair: pair[0])
        starts = [values for _, values in candidates[:_STARTS_FOLLOWED]]
        return problem.solve(
            starts,
            max_steps=_MAX_STEPS,
            step_tolerance=_MIN_STEP,
            cost_tolerance=_MIN_DECREASE,
        )

    @property
    def starting_points(self) -> list[FloatArray]:
        """Starting points, one for each arm that is tried."""
        contact = float(np.median([hit.contact_duration for hit in self.impacts]))
        relaxation = (
            np.concatenate((self.relaxation.g, np.log(self.relaxation.tau)))
            if self.relaxation.free
            else np.zeros(0)
        )
        law_parameters = np.zeros(len(POWERS)) if self.law.law else self._estimate_cubic_law()
        return [
            np.concatenate(
                (
                    law_parameters,
                    relaxation,
                    [g, np.log(part * contact)],
                    self.initial_speeds_and_contact_times,
                )
            )
            for g, part in _STARTING_ARMS
        ]

    def _estimate_cubic_law(self) -> FloatArray:
        """Return a cubic law by the force over the integrated path, less the force of the arms."""
        force_ratio = 1 + float(self.relaxation.g.sum()) + 0.1
        columns, forces = [], []
        for hit, speed, acceleration in zip(
            self.impacts,
            self.initial_speeds_and_contact_times[::2],
            self.gravity_accelerations,
            strict=True,
        ):
            in_contact = hit.time >= hit.contact_start
            time, force = hit.time[in_contact], hit.force[in_contact]
            step = np.diff(time, prepend=time[0])
            velocity = speed + np.cumsum(step * (acceleration - force / self.mass))
            x = np.cumsum(step * velocity)
            loading = slice(0, max(int(x.argmax()), 4))
            columns.append(x[loading, None] ** POWERS)
            forces.append(force[loading] / force_ratio)
        A, y = np.concatenate(columns), np.concatenate(forces)
        scale = np.linalg.norm(A, axis=0)
        return np.asarray(np.linalg.lstsq(A / scale, y, rcond=1e-8)[0] / scale)
