r"""Systematic shapes in the residual of a drop-test fit, and their significance.

An additional force f of the specimen brakes the mass, and is measured itself. To first order

.. math:: \delta F = \frac{\partial F}{\partial p}\left[-\frac{f(t)}{m}\right] + f(t)

along the fitted motion, with p the acceleration of the free mass. :math:`d_\perp` is the column d
without its projection on the columns J of the fit. With residuals r of unit variance

.. math:: z = \frac{d_\perp^T r}{|d_\perp| \sqrt\kappa} \sim N(0, 1)

where there is no such force (score test; C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50).
:math:`\kappa`, the factor of correlated noise, is that of the flights before the contacts, as an
additional force makes neighbouring residuals alike, too. An oscillation after the contacts shows as
a larger variance of those flights.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.extensions.materials.drop.elastic_law import POWERS
from dashpot.extensions.materials.drop.least_squares_problem import DropProblem
from dashpot.extensions.materials.drop.motion import Masses, integrate_impact
from dashpot.numerics.inference.correlated_noise import estimate_noise
from dashpot.numerics.least_squares import Optimum
from dashpot.solids.moving_plate import EvenStep

_REVERSAL_DEPTH, _TILT_DEPTH = 0.03, 0.08
"""Parts of the depth over which friction reverses, and a tilted specimen comes into contact."""
_POWER = 6
"""Power of the compression, of a law steeper than a cubic."""
_ADDITIONAL_TAU = 1 / 15
"""Relaxation time of an additional arm, in lengths of a contact."""
_DIFFERENCE_STEP = 1e-3
"""Step of a difference, over each force."""
_MIN_ROWS = 30.0
"""Least number of independent rows before first contact and after release."""
_MIN_ORTHOGONAL_PART = 1e-6
"""Part of a column below which it lies in the columns of the fit."""


def compute_residual_shapes(problem: DropProblem, optimum: Optimum) -> dict[str, float]:
    """Return the score of each shape in the residual, in standard deviations, by its words."""
    theta = optimum.theta
    rows = np.repeat(theta[None, :], len(problem.impacts), axis=0)
    x, v, force, relaxed_force = problem.integrate_motion(
        rows, problem.select_speeds(theta), problem.gravity_accelerations
    )
    in_contact = np.cumsum((force <= 0) & (v < 0), axis=0) == 0
    forces = _compute_additional_forces(problem, np.maximum(x, 0.0), relaxed_force)
    responses = {
        name: np.where(in_contact, slope, 0.0)
        for name, slope in zip(
            forces, _compute_force_responses(problem, rows, forces, in_contact), strict=True
        )
    }
    curvature = np.gradient(np.gradient(force, problem.step, axis=0), problem.step, axis=0)
    responses["a filter of the sensor"] = np.where(in_contact, curvature, 0.0)
    J = optimum.jacobian[:, optimum.free]
    # the relaxation time of an arm with g = 0 has no effect
    size = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
    basis, weight, _ = np.linalg.svd(J / size, full_matrices=False)
    basis = basis[:, weight > _MIN_ORTHOGONAL_PART * weight[0]]
    flights = _Flights.from_residual(problem, theta, optimum.residual)
    deviation = np.sqrt(flights.noise_correlation_factor)
    scores = {}
    for name, values in responses.items():
        column = np.concatenate(
            [
                problem.sample_force(values[:, i], hit.time - contact_time) / hit.noise
                for i, (hit, contact_time) in enumerate(
                    zip(problem.impacts, problem.select_contact_times(theta), strict=True)
                )
            ]
            + [np.zeros(optimum.problem.priors)]
        )
        orthogonal_column = column - basis @ (basis.T @ column)
        size = float(np.linalg.norm(orthogonal_column))
        if size > _MIN_ORTHOGONAL_PART * np.linalg.norm(column):
            scores[name] = float(orthogonal_column @ optimum.all_residuals / size / deviation)
    if (variance_increase := flights.variance_increase) is not None:
        scores["a sensor or mass that keeps vibrating"] = max(variance_increase, 0.0)
    return scores


def _compute_additional_forces(
    problem: DropProblem, x: FloatArray, relaxed_force: FloatArray
) -> dict[str, FloatArray]:
    """Return additional forces of a specimen along its motions, shape (steps + 1, impacts), N."""
    depth, largest = x.max(), relaxed_force.max()
    ratio = x / depth
    friction, arm = np.zeros_like(x), np.zeros_like(x)
    contact = median(np.array([hit.contact_duration for hit in problem.impacts]))
    steps = EvenStep.from_ratio(np.array(problem.step / (_ADDITIONAL_TAU * contact)))
    for i, (step, friction_limit, force_step) in enumerate(
        zip(np.diff(x, axis=0), relaxed_force[1:], np.diff(relaxed_force, axis=0), strict=True),
        start=1,
    ):
        # a slider that the specimen presses on
        friction[i] = np.clip(
            friction[i - 1] + largest / _REVERSAL_DEPTH * step / depth,
            -friction_limit,
            friction_limit,
        )
        arm[i] = steps.end(arm[i - 1], force_step)
    return {
        "friction": friction,
        "an elastic law steeper than a cubic": largest * ratio**_POWER,
        "a contact at an angle": largest * ratio * np.exp(-ratio / _TILT_DEPTH),
        "one more arm": arm,
    }


def _compute_force_responses(
    problem: DropProblem, rows: FloatArray, forces: dict[str, FloatArray], in_contact: FloatArray
) -> FloatArray:
    """Return the measured effect of each force, first order, (forces, steps + 1, impacts), N."""
    stack = np.stack([np.where(in_contact, force, 0.0) for force in forces.values()])
    n = len(problem.impacts)
    changes = np.concatenate(
        [sign * _DIFFERENCE_STEP * value for sign in (1.0, -1.0) for value in stack], axis=1
    )
    motion_count = changes.shape[1]
    theta = np.tile(rows, (motion_count // n, 1))
    g, tau = problem.compute_arms(theta)
    masses = Masses(
        np.full(motion_count, problem.mass),
        np.tile(problem.select_speeds(rows[0]), motion_count // n),
        np.tile(problem.gravity_accelerations, motion_count // n) - changes / problem.mass,
        partial(problem.law.force, c=theta[:, : len(POWERS)]), np.ones(motion_count), g, tau,
    )  # fmt: skip
    force = integrate_impact(masses, problem.step, stack.shape[1] - 1).force
    increased, decreased = (part.reshape(len(force), -1, n) for part in np.split(force, 2, axis=1))
    steps = min(len(force), stack.shape[1])
    response = np.zeros_like(stack)
    response[:, :steps] = np.moveaxis(increased - decreased, 1, 0)[:, :steps] / (
        2 * _DIFFERENCE_STEP
    )
    return np.asarray(response + stack)


class _Flights(NamedTuple):
    """Residuals before first contact and after release."""

    before_contact: FloatArray
    after_release: FloatArray

    @classmethod
    def from_residual(
        cls, problem: DropProblem, theta: FloatArray, residual: FloatArray
    ) -> _Flights:
        time = np.concatenate(
            [
                hit.time - contact_time
                for hit, contact_time in zip(
                    problem.impacts, problem.select_contact_times(theta), strict=True
                )
            ]
        )
        in_flight = np.concatenate(problem.compute_forces(theta)) == 0
        return cls(residual[in_flight & (time <= 0)], residual[in_flight & (time > 0)])

    @property
    def noise_correlation_factor(self) -> float:
        """Factor of the variance for correlated noise, before first contact."""
        return estimate_noise(self.before_contact).kappa if len(self.before_contact) else 1.0

    @property
    def variance_increase(self) -> float | None:
        """Increase of the log variance after release, in standard errors; None if rows are few."""
        n = (
            np.array([len(self.before_contact), len(self.after_release)])
            / self.noise_correlation_factor
        )
        if n.min() < _MIN_ROWS:
            return None
        return float(
            np.log(np.mean(self.after_release**2) / np.mean(self.before_contact**2))
            / np.sqrt((2 / n).sum())
        )
