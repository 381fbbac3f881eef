"""The rules for the number of arms in the metric of a noise that is as slow as the arms."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from dashpot.fitting.uncertainty.solution_covariance import (
    Score,
    noises_of,
    rounding,
    split_by_record,
)
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.variable_projection import Jacobian, Solution, solve_orders
from dashpot.numerics.inference.model_order import bic_of_deviance, is_significant_fall
from dashpot.numerics.inference.whitening import whitened_block


def score_in_noise_metric(
    scores: Sequence[Score],
    every_sample: Sequence[DataBlock],
    largest: Jacobian,
    *,
    peak: float,
    thorough: bool,
    priors: Sequence[DataBlock] = (),
) -> tuple[Score, ...] | None:
    """Return every number of arms judged anew, or None if a record has no noise.

    Parameters
    ----------
    scores : sequence of Score
        By plain least squares, no arm first.
    every_sample : sequence of DataBlock
        One per record, a row per sample.
    largest : Jacobian
        Residual and Jacobian of every sample for the most arms: they tell the noise.
    peak : float
        The largest force, N: it sets what rounding alone leaves.
    thorough : bool
        Add quasi-random starts.
    priors : sequence of DataBlock
        What was known before the data.
    """
    solutions = [score.solution for score in scores]
    residuals, jacobians = split_by_record(largest, [*every_sample, *priors])
    count = len(every_sample)
    noises = noises_of(residuals[:count], jacobians[:count], peak=peak)
    if any(noise.autocovariance[0] <= rounding(peak) ** 2 for noise in noises):
        return None
    blocks = [
        whitened_block(block, noise) for block, noise in zip(every_sample, noises, strict=True)
    ]
    # in the metric of the noise a row is worth one
    blocks += [block.scale_rows(1 / np.sqrt(block.variance)) for block in priors if block.variance]
    refitted = [*solve_orders(blocks, len(solutions) - 1, thorough=thorough)]
    # where a further arm with k > 0 does not help, its number leaves what the last one left
    refitted += [refitted[-1]] * (len(solutions) - len(refitted))
    effective = sum(noise.effective for noise in noises)
    size = [_parameters(solution) for solution in solutions]
    falls = [before.sse - after.sse for before, after in pairwise(refitted)]
    significant = [
        True,
        *(is_significant_fall(f, b - a) for f, (a, b) in zip(falls, pairwise(size), strict=True)),
    ]
    return tuple(
        Score(solution, bic_of_deviance(best.sse, effective=effective, parameters=count), clear)
        for solution, best, count, clear in zip(solutions, refitted, size, significant, strict=True)
    )


def _parameters(solution: Solution) -> int:
    return len(solution.fixed) + solution.order * (1 + len(solution.groups))
