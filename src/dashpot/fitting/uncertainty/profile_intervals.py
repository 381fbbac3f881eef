"""Profile likelihoods where a standard error is no good guide to an interval."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.student_t import t_quantile
from dashpot.datamodel.parameter_estimate import Profile
from dashpot.fitting.uncertainty.solution_covariance import SolutionEstimate
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.relaxation_kernels import compact_block
from dashpot.numerics.exponential_fit.log_tau_descent import Stack
from dashpot.numerics.inference.covariance import nearly_white, noise_gain_differs
from dashpot.numerics.inference.profile_likelihood import BEYOND
from dashpot.numerics.inference.profile_likelihood import profiles as walked
from dashpot.numerics.inference.profile_tracing import Coordinate, ProfileTarget

if TYPE_CHECKING:
    from dashpot.numerics.inference.whitening import NoiseGain

# below this SE(ln tau) the likelihood is Gaussian for all that intervals need
WALD_SUFFICES = 0.05
# the widest interval that a stored profile serves; where few residuals count, so that it would
# take evidence beyond all measure, a usual one: a wider one is open
_WIDEST_LEVEL, _USUAL_LEVEL, _MEASURE = 0.999, 0.95, 30.0


def profiles(
    blocks: Sequence[DataBlock],
    estimate: SolutionEstimate,
    *,
    every_sample: Sequence[DataBlock] | None = None,
) -> tuple[Profile, ...]:
    """Return the profiles of tau, k and b of every arm with SE(ln tau) >= 0.05, and of k_inf.

    Parameters
    ----------
    blocks : sequence of DataBlock
        The compressed data.
    estimate : SolutionEstimate
    every_sample : sequence of DataBlock, optional
        The data with a row per sample, in the order of time: noise as slow as the arms is then
        counted as each profile meets it.
    """
    solution = estimate.solution
    if not solution.order or estimate.dof < 1.0:
        return ()
    k = solution.arms[solution.groups.index("k")]
    doubtful = [
        (number, int(j))
        for number, j in enumerate(np.flatnonzero(k > 0), start=1)
        if not estimate.standard_error(f"ln_tau_{j + 1}") < WALD_SUFFICES
    ]
    if not doubtful:
        return ()
    noise_gain = None if every_sample is None else _noise_gain(every_sample, estimate)
    scaling = _Scaling(estimate, noise_gain)
    fixed = len(solution.fixed_names)
    targets = {}
    if solution.coefficient("k_inf") > 0:
        targets["k_inf"] = scaling.linear("k_inf")
    for number, j in doubtful:
        row = f"k_{j + 1}"
        targets[f"k_{number}"] = scaling.linear(row)
        targets[f"ln_tau_{number}"] = scaling.log_tau(j)
        targets[f"ln_b_{number}"] = scaling.log_b(j, row, float(k[j]), fixed=fixed)
    # a prior is a few rows already
    stack = Stack(
        [
            compact_block(block, excess=BEYOND) if block.variance is None else block
            for block in blocks
        ]
    )
    widest, usual = (
        t_quantile(value, estimate.dof) ** 2 for value in (_WIDEST_LEVEL, _USUAL_LEVEL)
    )
    limit = min(widest, max(1.1 * usual, _MEASURE))
    results = walked(stack, solution, list(targets.values()), limit=limit)
    return tuple(Profile(name, *result) for name, result in zip(targets, results, strict=True))


def _noise_gain(every_sample: Sequence[DataBlock], estimate: SolutionEstimate) -> NoiseGain | None:
    """Return the noise gain of each change of the model, None if it is about the same."""
    if nearly_white(estimate.noises) or not noise_gain_differs(estimate.noise_gain):
        return None
    from dashpot.numerics.inference.whitening import NoiseGain

    return NoiseGain(every_sample, estimate.noises, estimate.solution)


class _Scaling:
    """Steps and scales of profiles, so that each begins as its own covariance says."""

    def __init__(self, estimate: SolutionEstimate, noise_gain: NoiseGain | None) -> None:
        self.estimate = estimate
        self.noise_gain = noise_gain

    def linear(self, row: str) -> ProfileTarget:
        index = self.estimate.names.index(row)
        return self._scale_direction(Coordinate.LINEAR, index, self._unit(index))

    def log_tau(self, arm: int) -> ProfileTarget:
        index = self.estimate.names.index(f"ln_tau_{arm + 1}")
        return self._scale_direction(Coordinate.LOG_TAU, arm, self._unit(index))

    def log_b(self, arm: int, row: str, k: float, *, fixed: int) -> ProfileTarget:
        gradient = self._unit(self.estimate.names.index(f"ln_tau_{arm + 1}"))
        index = self.estimate.names.index(row)
        gradient[index] = 1.0 / k
        # the profile counts linear parameters, and b holds the arm's stiffness
        return self._scale_direction(Coordinate.LOG_B, index - fixed, gradient)

    def _unit(self, index: int) -> FloatArray:
        unit = np.zeros(len(self.estimate.names))
        unit[index] = 1.0
        return unit

    def _scale_direction(
        self, coordinate: Coordinate, index: int, gradient: FloatArray
    ) -> ProfileTarget:
        used = gradient != 0.0
        block = self.estimate.covariance[np.ix_(used, used)]
        directions = self.estimate.directions
        inverse = directions @ (directions.T @ gradient)
        wide = float(gradient @ inverse)
        if np.all(np.isfinite(block)):
            variance = float(gradient[used] @ block @ gradient[used])
        else:
            variance = wide * self.estimate.spread**2
        error = float(np.sqrt(variance))
        scale = variance / wide if wide > 0 else self.estimate.spread**2
        step = 0.7 * error
        if coordinate is not Coordinate.LINEAR:
            step = min(step, 0.5)
        return ProfileTarget(
            coordinate,
            index,
            step=max(step, 1e-9),
            scale=max(scale, 1e-300),
            relative_gain=self._relative_gain(inverse),
        )

    def _relative_gain(self, first: FloatArray) -> Callable[[FloatArray, FloatArray], float] | None:
        noise_gain = self.noise_gain
        if noise_gain is None:
            return None
        at_optimum = noise_gain.compute_step_gain(first)
        return lambda beta, log_tau: noise_gain.at(beta, log_tau) / at_optimum
