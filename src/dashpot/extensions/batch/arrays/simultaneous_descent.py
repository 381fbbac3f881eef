"""Simultaneous descent of many records from their starts to the nearest optima."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.extensions.batch.arrays.shared_sampling import ReducedRecords, SharedSampling
from dashpot.numerics.least_squares import (
    FINAL_TOLERANCE,
    LINEAR_STEP,
    LONGEST_STEP,
    TAIL_CHANGE,
    has_converged,
    is_step_acceptable,
)
from dashpot.numerics.log_tau_descent import StackTrial


def evaluate_trials(
    family: SharedSampling, log_tau: FloatArray, reduced: ReducedRecords, *, exact: bool = False
) -> StackTrial:
    """Return one trial of each record, ln tau (R, N).

    As :func:`~dashpot.numerics.log_tau_descent.solve_at`.
    """
    q = family.fixed_count
    p = q + log_tau.shape[1]
    factor = family.compute_triangular_factors(log_tau, reduced, exact=exact)
    r = factor[:, :p, :p]
    pivot, length = np.diagonal(r, axis1=1, axis2=2) ** 2, (r * r).sum(axis=1)
    dependent = (pivot <= 1e-13 * length).any(axis=1)
    r[dependent] = np.eye(p)
    point = StackTrial.from_factor(log_tau, factor, q)
    point.sse[dependent] = np.inf
    return point


def descend_together(
    family: SharedSampling,
    start: FloatArray,
    started: BoolArray,
    reduced: ReducedRecords,
    limit: int = 40,
) -> tuple[StackTrial, BoolArray]:
    """Descend from the start of every record; where each ended, and whether at an optimum.

    As :func:`~dashpot.numerics.log_tau_descent.descend`.
    """
    low, high = family.template.bounds
    points = evaluate_trials(family, start.copy(), reduced)
    rounding = family.rounding_floor * reduced.energy
    converged = np.zeros(len(start), dtype=bool)
    damping = np.full(len(start), 1e-6)
    last_sse = np.full(len(start), np.inf)
    active = np.flatnonzero(started & np.isfinite(points.sse))
    for _ in range(limit):
        if not len(active):
            break
        current = points.take(active)
        trial = np.clip(current.log_tau + _compute_steps(current, damping[active]), low, high)
        step = trial - current.log_tau
        change, expected_fall = np.abs(step).max(axis=1), np.abs(np.vecdot(current.gradient, step))
        sse = reduced.floor[active] + current.sse
        is_finished = (damping[active] < LINEAR_STEP) & has_converged(
            change, last_sse[active], expected_fall, sse
        )
        is_finished |= change <= FINAL_TOLERANCE
        previous_sse = current.sse
        if is_finished.any():
            points.put(active[is_finished], current.take(is_finished).step_ahead(step[is_finished]))
            converged[active[is_finished]] = True
            active, trial, change, previous_sse = (
                x[~is_finished] for x in (active, trial, change, previous_sse)
            )
        if not len(active):
            break
        new_trials = evaluate_trials(family, trial, reduced.select(active))
        is_tail, is_better = (
            change < TAIL_CHANGE,
            is_step_acceptable(new_trials.sse, previous_sse, change, rounding[active]),
        )
        improved_indices = active[is_better]
        last_sse[improved_indices] = change[is_better]
        points.put(improved_indices, new_trials.take(is_better))
        damping[improved_indices] = np.where(
            is_tail[is_better], 0.0, 0.1 * damping[improved_indices]
        )
        is_stuck = ~is_better & is_tail & (damping[active] == 0.0)
        converged[active[is_stuck]] = True
        refused_rows = active[~is_better]
        damping[refused_rows] = 10 * np.maximum(damping[refused_rows], 1e-6)
        active = active[~is_stuck & (damping[active] < 1e9)]
    return points, converged


def _compute_steps(point: StackTrial, damping: FloatArray) -> FloatArray:
    scale = np.maximum(np.diagonal(point.curvature, axis1=1, axis2=2), 1e-300)
    unit = point.curvature / np.sqrt(scale[:, :, None] * scale[:, None, :])
    unit = unit + (np.maximum(damping, 1e-14)[:, None, None]) * np.eye(scale.shape[1])
    root = np.sqrt(scale)
    step = -np.linalg.solve(unit, (point.gradient / root)[..., None])[..., 0] / root
    return np.clip(step, -LONGEST_STEP, LONGEST_STEP)
