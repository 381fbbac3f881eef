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
from dashpot.numerics.inference.correlated_noise import noise_of
from dashpot.numerics.least_squares import Optimum
from dashpot.solids.moving_plate import EvenStep

_REACH, _FOOT = 0.03, 0.08
"""Parts of the depth over which friction reverses, and a tilted specimen comes into contact."""
_POWER = 6
"""Power of the compression, of a law steeper than a cubic."""
_EARLY = 1 / 15
"""Relaxation time of an additional arm, in lengths of a contact."""
_SMALL = 1e-3
"""Step of a difference, over each force."""
_FEWEST = 30.0
"""Least number of independent rows before first contact and after release."""
_TAKEN = 1e-6
"""Part of a column below which it lies in the columns of the fit."""


def compute_residual_shapes(problem: DropProblem, best: Optimum) -> dict[str, float]:
    """Return the score of each shape in the residual, in standard deviations, by its words."""
    theta = best.theta
    rows = np.repeat(theta[None, :], len(problem.hits), axis=0)
    x, v, force, relaxed = problem.integrate_motion(rows, problem.speeds(theta), problem.pulls)
    touched = np.cumsum((force <= 0) & (v < 0), axis=0) == 0
    forces = _compute_additional_forces(problem, np.maximum(x, 0.0), relaxed)
    seen = {
        words: np.where(touched, slope, 0.0)
        for words, slope in zip(
            forces, _compute_force_responses(problem, rows, forces, touched), strict=True
        )
    }
    bend = np.gradient(np.gradient(force, problem.step, axis=0), problem.step, axis=0)
    seen["a sensor that filters"] = np.where(touched, bend, 0.0)
    J = best.jacobian[:, best.free]
    # the relaxation time of an arm with g = 0 has no effect
    size = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
    basis, weight, _ = np.linalg.svd(J / size, full_matrices=False)
    basis = basis[:, weight > _TAKEN * weight[0]]
    flights = _Flights.from_residual(problem, theta, best.residual)
    deviation = np.sqrt(flights.noise_correlation_factor)
    entries = {}
    for words, values in seen.items():
        column = np.concatenate(
            [
                problem.sample_force(values[:, i], hit.time - touch) / hit.noise
                for i, (hit, touch) in enumerate(
                    zip(problem.hits, problem.touches(theta), strict=True)
                )
            ]
            + [np.zeros(best.problem.priors)]
        )
        differences = column - basis @ (basis.T @ column)
        size = float(np.linalg.norm(differences))
        if size > _TAKEN * np.linalg.norm(column):
            entries[words] = float(differences @ best.all_residuals / size / deviation)
    if (louder := flights.louder) is not None:
        entries["a sensor or a mass that rings on"] = max(louder, 0.0)
    return entries


def _compute_additional_forces(
    problem: DropProblem, x: FloatArray, relaxed: FloatArray
) -> dict[str, FloatArray]:
    """Return additional forces of a specimen along its motions, shape (steps + 1, impacts), N."""
    depth, largest = x.max(), relaxed.max()
    share = x / depth
    rubs, arm = np.zeros_like(x), np.zeros_like(x)
    contact = median(np.array([hit.contact for hit in problem.hits]))
    even = EvenStep.from_ratio(np.array(problem.step / (_EARLY * contact)))
    for i, (way, pressed, item) in enumerate(
        zip(np.diff(x, axis=0), relaxed[1:], np.diff(relaxed, axis=0), strict=True), start=1
    ):
        # a slider that the specimen presses on
        rubs[i] = np.clip(rubs[i - 1] + largest / _REACH * way / depth, -pressed, pressed)
        arm[i] = even.end(arm[i - 1], item)
    return {
        "friction": rubs,
        "an elastic law steeper than a cubic": largest * share**_POWER,
        "a specimen that is met at an angle": largest * share * np.exp(-share / _FOOT),
        "one arm more": arm,
    }


def _compute_force_responses(
    problem: DropProblem, rows: FloatArray, forces: dict[str, FloatArray], touched: FloatArray
) -> FloatArray:
    """Return the measured effect of each force, first order, (forces, steps + 1, impacts), N."""
    stack = np.stack([np.where(touched, force, 0.0) for force in forces.values()])
    n = len(problem.hits)
    both = np.concatenate(
        [sign * _SMALL * value for sign in (1.0, -1.0) for value in stack], axis=1
    )
    many = both.shape[1]
    theta = np.tile(rows, (many // n, 1))
    g, tau = problem.arms(theta)
    masses = Masses(
        np.full(many, problem.mass), np.tile(problem.speeds(rows[0]), many // n),
        np.tile(problem.pulls, many // n) - both / problem.mass,
        partial(problem.law.force, c=theta[:, : len(POWERS)]), np.ones(many), g, tau,
    )  # fmt: skip
    force = integrate_impact(masses, problem.step, stack.shape[1] - 1).force
    up, down = (part.reshape(len(force), -1, n) for part in np.split(force, 2, axis=1))
    steps = min(len(force), stack.shape[1])
    answer = np.zeros_like(stack)
    answer[:, :steps] = np.moveaxis(up - down, 1, 0)[:, :steps] / (2 * _SMALL)
    return np.asarray(answer + stack)


class _Flights(NamedTuple):
    """Residuals before first contact and after release."""

    before: FloatArray
    after: FloatArray

    @classmethod
    def from_residual(
        cls, problem: DropProblem, theta: FloatArray, residual: FloatArray
    ) -> _Flights:
        since = np.concatenate(
            [
                hit.time - touch
                for hit, touch in zip(problem.hits, problem.touches(theta), strict=True)
            ]
        )
        away = np.concatenate(problem.forces(theta)) == 0
        return cls(residual[away & (since <= 0)], residual[away & (since > 0)])

    @property
    def noise_correlation_factor(self) -> float:
        """Factor of the variance for correlated noise, before first contact."""
        return noise_of(self.before).kappa if len(self.before) else 1.0

    @property
    def louder(self) -> float | None:
        """Increase of the log variance after release, in standard errors; None if rows are few."""
        n = np.array([len(self.before), len(self.after)]) / self.noise_correlation_factor
        if n.min() < _FEWEST:
            return None
        return float(
            np.log(np.mean(self.after**2) / np.mean(self.before**2)) / np.sqrt((2 / n).sum())
        )
