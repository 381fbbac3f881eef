r"""Systematic shapes in the residual of a slam fit, and their significance.

A force f that the piece has besides brakes the mass, and is measured itself. To first order in it

.. math:: \delta F = \frac{\partial F}{\partial p}\left[-\frac{f(t)}{m}\right] + f(t)

along the motion that was fitted, with p the pull on the mass. Of its column d what the fit's own
columns J take up is taken off, :math:`d_\perp`, and the residuals r, each of deviation 1, say

.. math:: z = \frac{d_\perp^T r}{|d_\perp| \sqrt\kappa} \sim N(0, 1)

where there is no such force (C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50: the score of what is
not fitted). :math:`\kappa` is that of the flights before the contacts, for a force besides makes
neighbours alike, too. What rings on after them makes those flights louder.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.extensions.materials.slam.elastic_law import POWERS
from dashpot.extensions.materials.slam.least_squares_problem import Slams
from dashpot.extensions.materials.slam.motion import Masses, integrate_impact
from dashpot.numerics.inference.correlated_noise import noise_of
from dashpot.numerics.least_squares import Optimum
from dashpot.solids.moving_plate import EvenStep

_REACH, _FOOT = 0.03, 0.08
"""Parts of the depth over which friction turns round, and a piece that tilts is met."""
_POWER = 6
"""Of the compression, of a law that is steeper than a cubic."""
_EARLY = 1 / 15
"""Time of one arm more, in lengths of a contact."""
_SMALL = 1e-3
"""Of each force, for a difference."""
_FEWEST = 30.0
"""Independent rows before a touch and after a release that tell whether it rings on."""
_TAKEN = 1e-6
"""Part of a column below which the fit has taken all of it up."""


def compute_residual_shapes(slams: Slams, best: Optimum) -> dict[str, float]:
    """Return by how many standard deviations each shape shows in what is left, by its words."""
    theta = best.theta
    rows = np.repeat(theta[None, :], len(slams.hits), axis=0)
    x, v, force, relaxed = slams.integrate_motion(rows, slams.speeds(theta), slams.pulls)
    touched = np.cumsum((force <= 0) & (v < 0), axis=0) == 0
    forces = _besides(slams, np.maximum(x, 0.0), relaxed)
    seen = {
        words: np.where(touched, slope, 0.0)
        for words, slope in zip(
            forces, _compute_force_responses(slams, rows, forces, touched), strict=True
        )
    }
    bend = np.gradient(np.gradient(force, slams.step, axis=0), slams.step, axis=0)
    seen["a sensor that filters"] = np.where(touched, bend, 0.0)
    J = best.jacobian[:, best.free]
    # the time of an arm that has gone moves nothing
    size = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
    basis, weight, _ = np.linalg.svd(J / size, full_matrices=False)
    basis = basis[:, weight > _TAKEN * weight[0]]
    flights = _Flights.from_residual(slams, theta, best.residual)
    deviation = np.sqrt(flights.noise_correlation_factor)
    entries = {}
    for words, values in seen.items():
        column = np.concatenate(
            [
                slams.sample_force(values[:, i], hit.time - touch) / hit.noise
                for i, (hit, touch) in enumerate(zip(slams.hits, slams.touches(theta), strict=True))
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


def _besides(slams: Slams, x: FloatArray, relaxed: FloatArray) -> dict[str, FloatArray]:
    """Forces that a piece may have besides, along its motions, shape (steps + 1, slams), N."""
    depth, largest = x.max(), relaxed.max()
    share = x / depth
    rubs, arm = np.zeros_like(x), np.zeros_like(x)
    contact = median(np.array([hit.contact for hit in slams.hits]))
    even = EvenStep.from_ratio(np.array(slams.step / (_EARLY * contact)))
    for i, (way, pressed, item) in enumerate(
        zip(np.diff(x, axis=0), relaxed[1:], np.diff(relaxed, axis=0), strict=True), start=1
    ):
        # a slider that the piece presses on
        rubs[i] = np.clip(rubs[i - 1] + largest / _REACH * way / depth, -pressed, pressed)
        arm[i] = even.end(arm[i - 1], item)
    return {
        "friction": rubs,
        "a law that is steeper than a cubic": largest * share**_POWER,
        "a specimen that is met at an angle": largest * share * np.exp(-share / _FOOT),
        "one arm more": arm,
    }


def _compute_force_responses(
    slams: Slams, rows: FloatArray, forces: dict[str, FloatArray], touched: FloatArray
) -> FloatArray:
    """What is measured of each force, to first order, shape (forces, steps + 1, slams), N."""
    stack = np.stack([np.where(touched, force, 0.0) for force in forces.values()])
    n = len(slams.hits)
    both = np.concatenate(
        [sign * _SMALL * value for sign in (1.0, -1.0) for value in stack], axis=1
    )
    many = both.shape[1]
    theta = np.tile(rows, (many // n, 1))
    g, tau = slams.arms(theta)
    masses = Masses(
        np.full(many, slams.mass), np.tile(slams.speeds(rows[0]), many // n),
        np.tile(slams.pulls, many // n) - both / slams.mass,
        partial(slams.law.force, c=theta[:, : len(POWERS)]), np.ones(many), g, tau,
    )  # fmt: skip
    force = integrate_impact(masses, slams.step, stack.shape[1] - 1).force
    up, down = (part.reshape(len(force), -1, n) for part in np.split(force, 2, axis=1))
    steps = min(len(force), stack.shape[1])
    answer = np.zeros_like(stack)
    answer[:, :steps] = np.moveaxis(up - down, 1, 0)[:, :steps] / (2 * _SMALL)
    return np.asarray(answer + stack)


class _Flights(NamedTuple):
    """What is left before the touches and after the releases, and how many rows are worth one."""

    before: FloatArray
    after: FloatArray

    @classmethod
    def from_residual(cls, slams: Slams, theta: FloatArray, residual: FloatArray) -> _Flights:
        since = np.concatenate(
            [hit.time - touch for hit, touch in zip(slams.hits, slams.touches(theta), strict=True)]
        )
        away = np.concatenate(slams.forces(theta)) == 0
        return cls(residual[away & (since <= 0)], residual[away & (since > 0)])

    @property
    def noise_correlation_factor(self) -> float:
        """How many rows before a touch are worth one."""
        return noise_of(self.before).kappa if len(self.before) else 1.0

    @property
    def louder(self) -> float | None:
        """By how many standard deviations of chance it is louder after; None if rows are few."""
        n = np.array([len(self.before), len(self.after)]) / self.noise_correlation_factor
        if n.min() < _FEWEST:
            return None
        return float(
            np.log(np.mean(self.after**2) / np.mean(self.before**2)) / np.sqrt((2 / n).sum())
        )
