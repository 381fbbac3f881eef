"""The descent of many records at once: arithmetic on stacks of small triangular factors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.engine.blocks.families import Family, Seen
from dashpot.engine.solver.descent import FINISHED, LINEAR, LONGEST_STEP, REST, TAIL, UNCHANGED


class Points(NamedTuple):
    """One trial of each record, as :class:`.Point`, in arrays that change."""

    beta: FloatArray  # (R, q + N)
    sse: FloatArray  # (R,)
    gradient: FloatArray  # (R, N)
    curvature: FloatArray  # (R, N, N)
    turn: FloatArray  # (R, q + N, N)

    def put(self, index: IndexArray, new: Points) -> None:
        """Write some records anew."""
        for old, fresh in zip(self, new, strict=True):
            old[index] = fresh

    def ahead(self, index: IndexArray, step: FloatArray) -> None:
        """Move beta by short steps (R, N), along which it is linear."""
        self.beta[index] += (self.turn[index] @ step[..., None])[..., 0]

    def take(self, index: IndexArray | BoolArray) -> Points:
        """Return copies of some records."""
        return Points(*(part[index] for part in self))


def points_at(family: Family, log_tau: FloatArray, seen: Seen, *, exact: bool = False) -> Points:
    """As :func:`dashpot.engine.solver.descent.point_at`, from stacked triangular factors."""
    q, arms = family.fixed_count, log_tau.shape[1]
    p = q + arms
    factor = family.factor(log_tau, seen, exact=exact)
    r = factor[:, :p, :p]
    pivot, length = np.diagonal(r, axis1=1, axis2=2) ** 2, (r * r).sum(axis=1)
    dependent = (pivot <= 1e-13 * length).any(axis=1)
    r = np.where(dependent[:, None, None], np.eye(p), r)
    inverse = np.linalg.inv(r)
    beta = (inverse @ factor[:, :p, -1:])[..., 0]
    residual, outside, k = factor[:, p:, -1], factor[:, p:, p:-1], beta[:, q:]
    dual_gradient = (residual[:, None, :] @ outside)[:, 0]
    inside = inverse[:, q:] * dual_gradient[..., None]
    outside = outside * k[:, None, :]
    turned = np.swapaxes(inside, 1, 2)
    curvature = np.swapaxes(outside, 1, 2) @ outside + inside @ turned
    turn = inverse @ (turned - factor[:, :p, p:-1] * k[:, None, :])
    sse = np.where(dependent, np.inf, np.vecdot(residual, residual))
    return Points(beta, sse, -k * dual_gradient, curvature, turn)


class Descended(NamedTuple):
    """Where the descent of each record ended, and whether at an optimum."""

    log_tau: FloatArray
    point: Points
    done: BoolArray

    def put(self, index: IndexArray, new: Descended) -> None:
        """Write some records anew."""
        self.log_tau[index], self.done[index] = new.log_tau, new.done
        self.point.put(index, new.point)

    def take(self, index: IndexArray | BoolArray) -> Descended:
        """Return copies of some records."""
        return Descended(self.log_tau[index], self.point.take(index), self.done[index])


def descend_together(
    family: Family, start: FloatArray, started: BoolArray, seen: Seen, limit: int = 40
) -> Descended:
    """The descent of :func:`dashpot.engine.solver.descent.descend`, for all records at once."""
    low, high = family.template.bounds
    log_tau = start.copy()
    here = points_at(family, log_tau, seen)
    rounding = family.rounding_floor * seen.energy
    done = np.zeros(len(log_tau), dtype=bool)
    damping = np.full(len(log_tau), 1e-6)
    last = np.full(len(log_tau), np.inf)
    active = np.flatnonzero(started & np.isfinite(here.sse))
    for _ in range(limit):
        if not len(active):
            break
        now = here.take(active)
        trial = np.clip(log_tau[active] + _steps(now, damping[active]), low, high)
        step = trial - log_tau[active]
        moved = np.abs(step).max(axis=1)
        over = (moved <= LINEAR) & (damping[active] < LINEAR) & (moved**2 <= REST * last[active])
        over &= np.abs(np.vecdot(now.gradient, step)) <= UNCHANGED * (seen.floor[active] + now.sse)
        over |= moved <= FINISHED
        ended = active[over]
        log_tau[ended] = trial[over]
        here.ahead(ended, step[over])
        done[ended] = True
        active, trial, moved, before = active[~over], trial[~over], moved[~over], now.sse[~over]
        if not len(active):
            break
        new = points_at(family, trial, seen.take(active))
        tail = moved < TAIL
        flat = before * (1 + 1e-8) + rounding[active]
        better = (new.sse < before) | (tail & (new.sse <= flat))
        taken = active[better]
        log_tau[taken] = trial[better]
        last[taken] = moved[better]
        here.put(taken, new.take(better))
        damping[taken] = np.where(tail[better], 0.0, 0.1 * damping[taken])
        stuck = ~better & tail & (damping[active] == 0.0)
        done[active[stuck]] = True
        refused = active[~better]
        damping[refused] = 10 * np.maximum(damping[refused], 1e-6)
        active = active[~stuck & (damping[active] < 1e9)]
    return Descended(log_tau, here, done)


def _steps(point: Points, damping: FloatArray) -> FloatArray:
    scale = np.maximum(np.diagonal(point.curvature, axis1=1, axis2=2), 1e-300)
    unit = point.curvature / np.sqrt(scale[:, :, None] * scale[:, None, :])
    unit = unit + (np.maximum(damping, 1e-14)[:, None, None]) * np.eye(scale.shape[1])
    root = np.sqrt(scale)
    step = -np.linalg.solve(unit, (point.gradient / root)[..., None])[..., 0] / root
    return np.clip(step, -LONGEST_STEP, LONGEST_STEP)
