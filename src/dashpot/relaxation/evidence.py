"""The rules for the number of arms in the metric of a noise that is as slow as the arms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from dashpot.engine.blocks import Block
from dashpot.engine.order import Choice, bic_of_deviance, needed
from dashpot.engine.separable import Jacobian, Solution, solve, solve_orders
from dashpot.engine.uncertainty import uneven
from dashpot.engine.whitening import whitened_block
from dashpot.relaxation.estimate import Score, by_record, noises_of, rounding


def in_noise_metric(
    scores: Sequence[Score],
    choice: Choice,
    every_sample: Sequence[Block],
    whole: Callable[[int], Jacobian],
    *,
    peak: float,
    thorough: bool,
) -> tuple[Score, ...] | None:
    """Return every number of arms judged anew, or None if plain least squares is fit to judge.

    Parameters
    ----------
    scores : sequence of Score
        By plain least squares, no arm first.
    choice : Choice
        What they say. The noise is uneven if it is so to the arms that either rule supports.
    every_sample : sequence of Block
        One per record, a row per sample. Their noise is that of the largest model's residuals.
    whole : callable
        Residual and Jacobian of every sample for one number of arms.
    peak : float
        The largest force, N: it sets what rounding alone leaves.
    thorough : bool
        Add quasi-random starts.
    """
    solutions = [score.solution for score in scores]
    largest = by_record(whole(len(solutions) - 1), every_sample)
    noises = noises_of(*largest, peak=peak)
    if any(noise.autocovariance[0] <= rounding(peak) ** 2 for noise in noises):
        return None
    supported = min(max(choice.by_bic, choice.by_significance, 1), len(solutions) - 1)
    _, jacobians = by_record(whole(supported), every_sample)
    if not uneven(jacobians, noises):
        return None
    blocks = [
        whitened_block(block, noise) for block, noise in zip(every_sample, noises, strict=True)
    ]
    refitted = [solve(blocks, 0)]
    refitted += [s for s in solve_orders(blocks, len(solutions) - 1, thorough=thorough) if s.order]
    # where a further arm with k > 0 does not help, its number leaves what the last one left
    refitted += [refitted[-1]] * (len(solutions) - len(refitted))
    effective = sum(noise.effective for noise in noises)
    size = [_parameters(solution) for solution in solutions]
    falls = [before.sse - after.sse for before, after in pairwise(refitted)]
    significant = [
        True,
        *(needed(f, b - a) for f, (a, b) in zip(falls, pairwise(size), strict=True)),
    ]
    return tuple(
        Score(solution, bic_of_deviance(best.sse, effective=effective, parameters=count), clear)
        for solution, best, count, clear in zip(solutions, refitted, size, significant, strict=True)
    )


def _parameters(solution: Solution) -> int:
    return len(solution.fixed) + solution.order * (1 + len(solution.groups))
