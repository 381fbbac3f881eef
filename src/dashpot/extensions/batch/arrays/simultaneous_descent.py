"""Simultaneous descent of many records from their starts to the nearest optima."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.extensions.batch.arrays.shared_sampling import ReducedRecords, SharedSampling
from dashpot.numerics.least_squares import (
    FINISHED,
    LINEAR,
    LONGEST_STEP,
    TAIL,
    has_converged,
    is_step_acceptable,
)
from dashpot.numerics.log_tau_descent import StackTrial


def points_at(
    family: SharedSampling, log_tau: FloatArray, reduced: ReducedRecords, *, exact: bool = False
) -> StackTrial:
    """Return one trial of each record, ln tau (R, N).

    As :func:`~dashpot.numerics.log_tau_descent.point_at`.
    """
    q = family.fixed_count
    p = q + log_tau.shape[1]
    factor = family.factor(log_tau, reduced, exact=exact)
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
    points = points_at(family, start.copy(), reduced)
    rounding = family.rounding_floor * reduced.energy
    converged = np.zeros(len(start), dtype=bool)
    damping = np.full(len(start), 1e-6)
    last = np.full(len(start), np.inf)
    active = np.flatnonzero(started & np.isfinite(points.sse))
    for _ in range(limit):
        if not len(active):
            break
        now = points.take(active)
        trial = np.clip(now.log_tau + _steps(now, damping[active]), low, high)
        step = trial - now.log_tau
        change, fall = np.abs(step).max(axis=1), np.abs(np.vecdot(now.gradient, step))
        sse = reduced.floor[active] + now.sse
        over = (damping[active] < LINEAR) & has_converged(change, last[active], fall, sse)
        over |= change <= FINISHED
        before = now.sse
        if over.any():
            points.put(active[over], now.take(over).ahead(step[over]))
            converged[active[over]] = True
            active, trial, change, before = (x[~over] for x in (active, trial, change, before))
        if not len(active):
            break
        new = points_at(family, trial, reduced.take(active))
        tail, better = change < TAIL, is_step_acceptable(new.sse, before, change, rounding[active])
        improved = active[better]
        last[improved] = change[better]
        points.put(improved, new.take(better))
        damping[improved] = np.where(tail[better], 0.0, 0.1 * damping[improved])
        stuck = ~better & tail & (damping[active] == 0.0)
        converged[active[stuck]] = True
        refused = active[~better]
        damping[refused] = 10 * np.maximum(damping[refused], 1e-6)
        active = active[~stuck & (damping[active] < 1e9)]
    return points, converged


def _steps(point: StackTrial, damping: FloatArray) -> FloatArray:
    scale = np.maximum(np.diagonal(point.curvature, axis1=1, axis2=2), 1e-300)
    unit = point.curvature / np.sqrt(scale[:, :, None] * scale[:, None, :])
    unit = unit + (np.maximum(damping, 1e-14)[:, None, None]) * np.eye(scale.shape[1])
    root = np.sqrt(scale)
    step = -np.linalg.solve(unit, (point.gradient / root)[..., None])[..., 0] / root
    return np.clip(step, -LONGEST_STEP, LONGEST_STEP)
