"""Starting shifts and number of arms of a fit over several temperatures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.extensions.curves.superposition.pairwise_shifts import chain_shifts
from dashpot.extensions.curves.temperatures.joint_problem import JointTests, ShiftedSolid
from dashpot.extensions.curves.temperatures.marginalised_data import shift_block
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit import solve_orders
from dashpot.numerics.inference.model_order import bic_of_deviance
from dashpot.numerics.least_squares import Parameter, Problem, Rows

# Decades of shift between a colder test and its warmer neighbour, and of a shift with the wrong
# sign, that are tried.
_MAX_SHIFT, _MAX_BACKWARD_SHIFT, _SHIFT_STEP = 4.0, 0.5, 0.1
_PER_DECADE = 8
# shifts and numbers of arms are sought again from each other
_MAX_ITERATIONS = 2


class OrderCandidate(NamedTuple):
    """Candidate number of arms.

    Attributes
    ----------
    point : ShiftedSolid
    bic : float
    """

    point: ShiftedSolid
    bic: float


def first_shifts(joint: JointTests) -> FloatArray:
    """Return ln a_T of every temperature, each on its neighbour, 0 at the reference."""
    log_shifts = np.arange(
        -_MAX_BACKWARD_SHIFT, _MAX_SHIFT + _SHIFT_STEP / 2, _SHIFT_STEP
    ) * np.log(10.0)
    pairs = range(len(joint.temperatures) - 1)
    return chain_shifts(((_pair(joint, i, log_shifts), log_shifts) for i in pairs), joint.reference)


def _pair(joint: JointTests, i: int, log_shifts: FloatArray) -> Problem:
    """One positive spectrum for temperature i and the next warmer one, over how far ln a falls."""
    log_b = joint.fixed_log_b

    def shift_temperature_blocks(shifted_index: int, log_shift: float) -> list[DataBlock]:
        blocks_with_temperature = zip(joint.blocks, joint.at, strict=True)
        return [
            shift_block(block, log_shift, log_b[shifted_index] - log_b[i + 1])
            for block, temperature_index in blocks_with_temperature
            if temperature_index == shifted_index
        ]

    end_blocks = [
        *shift_temperature_blocks(i, log_shifts[0]),
        *shift_temperature_blocks(i, log_shifts[-1]),
        *shift_temperature_blocks(i + 1, 0.0),
    ]
    low, high = min(end.bounds[0] for end in end_blocks), max(end.bounds[1] for end in end_blocks)
    grid = np.linspace(low, high, int((high - low) / np.log(10.0) * _PER_DECADE) + 2)
    hotter_evaluations = [
        block.evaluate(grid, False) for block in shift_temperature_blocks(i + 1, 0.0)
    ]

    def rows(theta: FloatArray) -> Rows:
        evaluations = [
            *(block.evaluate(grid, False) for block in shift_temperature_blocks(i, theta[0])),
            *hotter_evaluations,
        ]
        columns = [
            np.concatenate((evaluation.fixed, evaluation.arms), axis=1)
            for evaluation in evaluations
        ]
        return Rows(
            np.concatenate([evaluation.target for evaluation in evaluations]),
            np.concatenate(columns),
        )

    return Problem(rows, [Parameter()], positive=True)


def candidates(
    joint: JointTests, start: FloatArray, max_arms: int, *, effective: float, thorough: bool
) -> tuple[OrderCandidate, ...]:
    """Return the best point of every number of arms, from none up to `max_arms`.

    Parameters
    ----------
    joint : JointTests
    start : array, shape (T,)
        Ln a_T.
    max_arms : int
    effective : float
        Independent residuals.
    thorough : bool
        Add quasi-random starts.
    """
    best: dict[int, OrderCandidate] = {}
    log_a, log_b = start, joint.fixed_log_b
    for _ in range(_MAX_ITERATIONS):
        blocks = [
            shift_block(block, log_a[i], log_b[i])
            for block, i in zip(joint.blocks, joint.at, strict=True)
        ]
        for solution in solve_orders(blocks, max_arms, thorough=thorough):
            k = np.maximum(solution.arms[0], 0.0) if solution.order else np.zeros(0)
            is_positive = k > 0
            point = joint.descend(
                ShiftedSolid(
                    max(solution.coefficient("k_inf"), 0.0),
                    k[is_positive],
                    solution.log_tau[is_positive],
                    np.array(log_a),
                    np.array(log_b),
                )
            )
            _keep(best, joint, point, effective)
        best_point = min(best.values(), key=lambda candidate: candidate.bic).point
        log_a, log_b = best_point.log_a, best_point.log_b
    return tuple(best[n] for n in sorted(best))


def refine_candidates(
    joint: JointTests, order_candidates: Sequence[OrderCandidate], effective: float
) -> tuple[OrderCandidate, ...]:
    """Return candidates descended anew, from where they were, on data that changed a little."""
    best: dict[int, OrderCandidate] = {}
    for candidate in order_candidates:
        _keep(best, joint, joint.descend(candidate.point), effective)
    return tuple(best[n] for n in sorted(best))


def _keep(
    best: dict[int, OrderCandidate], joint: JointTests, point: ShiftedSolid, effective: float
) -> None:
    is_alive = point.alive
    if not is_alive.all():
        point = replace(point, k=point.k[is_alive], log_tau=point.log_tau[is_alive])
        point = joint.descend(point)
    parameters = len(joint.names(point.order))
    score = bic_of_deviance(point.chi_square, effective=effective, parameters=parameters)
    best_so_far = best.get(point.order)
    if best_so_far is None or score < best_so_far.bic:
        best[point.order] = OrderCandidate(point, score)
