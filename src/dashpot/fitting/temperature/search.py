"""Where the descent starts, and how many arms: shifts by pairs, arms by the engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.blocks.block import Block
from dashpot.engine.inference.order import bic_of_deviance
from dashpot.engine.least_squares.nnls import nonnegative
from dashpot.engine.solver.variable_projection import solve_orders
from dashpot.fitting.temperature.joint import Joint, Point, alive
from dashpot.fitting.temperature.reduced import moved

# decades that a colder test may lie away from its warmer neighbour, and a wrong order of them
_FARTHEST, _BACK, _STEP = 4.0, 0.5, 0.1
_PER_DECADE = 8
# shifts and numbers of arms are sought again from each other
_ROUNDS = 2


class Candidate(NamedTuple):
    """One number of arms.

    Attributes
    ----------
    point : Point
    bic : float
    """

    point: Point
    bic: float


def first_shifts(joint: Joint) -> FloatArray:
    """Return ln a_T of every temperature, neighbour by neighbour out from the reference."""
    log_a = np.zeros(len(joint.temperatures))
    reference, count = joint.reference, len(log_a)
    for way in (range(reference - 1, -1, -1), range(reference + 1, count)):
        for i in way:
            near = i + 1 if i < reference else i - 1
            colder = 1.0 if i < reference else -1.0
            log_a[i] = log_a[near] + _against(joint, i, near, colder)
    return log_a


def _against(joint: Joint, i: int, near: int, colder: float) -> float:
    """Return ln a of temperature i over that of its neighbour, by one positive spectrum for both.

    Every shift is tried on a grid, as a grid of arms shared in the neighbour's time.
    """
    log_b = joint.held_log_b
    pairs = [
        (block, int(at))
        for block, at in zip(joint.blocks, joint.at, strict=True)
        if at in {i, near}
    ]
    tried = colder * np.arange(-_BACK, _FARTHEST + _STEP / 2, _STEP) * np.log(10.0)
    left = [
        _left(
            [
                moved(block, shift if at == i else 0.0, log_b[at] - log_b[near])
                for block, at in pairs
            ]
        )
        for shift in tried
    ]
    return float(tried[int(np.argmin(left))])


def _left(blocks: Sequence[Block]) -> float:
    """Sum of squares that the best positive spectrum leaves, nearly."""
    low = min(block.bounds[0] for block in blocks)
    high = max(block.bounds[1] for block in blocks)
    grid = np.linspace(low, high, int((high - low) / np.log(10.0) * _PER_DECADE) + 2)
    found = [block.evaluate(grid, False) for block in blocks]
    columns = np.concatenate([np.concatenate((one.fixed, one.arms), axis=1) for one in found])
    target = np.concatenate([one.target for one in found])
    scale = np.linalg.norm(columns, axis=0)
    unit = columns / np.where(scale > 0, scale, 1.0)
    best = nonnegative(unit.T @ unit, unit.T @ target)
    error = target - unit @ best
    return float(error @ error)


def candidates(
    joint: Joint, start: FloatArray, most: int, *, effective: float, thorough: bool
) -> tuple[Candidate, ...]:
    """Return the best point of every number of arms, from none up to `most`.

    Parameters
    ----------
    joint : Joint
    start : array, shape (T,)
        Ln a_T.
    most : int
    effective : float
        Independent residuals.
    thorough : bool
        Add quasi-random starts.
    """
    best: dict[int, Candidate] = {}
    log_a, log_b = start, joint.held_log_b
    for _ in range(_ROUNDS):
        blocks = [
            moved(block, log_a[i], log_b[i])
            for block, i in zip(joint.blocks, joint.at, strict=True)
        ]
        for solution in solve_orders(blocks, most, thorough=thorough):
            k = np.maximum(solution.arms[0], 0.0) if solution.order else np.zeros(0)
            there = k > 0
            point = joint.descend(
                Point(
                    max(solution.coefficient("k_inf"), 0.0),
                    np.log(k[there]),
                    solution.log_tau[there],
                    np.array(log_a),
                    np.array(log_b),
                )
            )
            _keep(best, joint, point, effective)
        chosen = min(best.values(), key=lambda one: one.bic).point
        log_a, log_b = chosen.log_a, chosen.log_b
    return tuple(best[n] for n in sorted(best))


def again(joint: Joint, found: Sequence[Candidate], effective: float) -> tuple[Candidate, ...]:
    """Return candidates descended anew, from where they were, on data that changed a little."""
    best: dict[int, Candidate] = {}
    for one in found:
        _keep(best, joint, joint.descend(one.point), effective)
    return tuple(best[n] for n in sorted(best))


def _keep(best: dict[int, Candidate], joint: Joint, point: Point, effective: float) -> None:
    there = alive(point)
    if not there.all():
        point = replace(point, log_k=point.log_k[there], log_tau=point.log_tau[there])
        point = joint.descend(point)
    parameters = len(joint.names(point.order))
    score = bic_of_deviance(point.chi_square, effective=effective, parameters=parameters)
    before = best.get(point.order)
    if before is None or score < before.bic:
        best[point.order] = Candidate(point, score)
