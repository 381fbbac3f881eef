r"""Thousands of records on one sampling, fitted side by side.

What one record computes, a stack of them computes at once: compression is a matrix product, a
start is the best of all sets of grid points, and every step of the descent is arithmetic on
small Gram matrices, one per record. Whatever leaves a doubt (an arm at the edge of the window, a
coefficient that is not positive, a relaxation time not known to 10 %) is solved again one by
one, so that the result is that of :func:`dashpot.engine.separable.solve`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import NamedTuple, Protocol

import numpy as np

from dashpot._arrays import BoolArray, ByValue, FloatArray, IndexArray
from dashpot.engine.blocks import Block
from dashpot.engine.chain import DOUBT
from dashpot.engine.compression import PLAIN
from dashpot.engine.descent import FINISHED, LINEAR, LONGEST_STEP, REST, TAIL, UNCHANGED
from dashpot.engine.separable import Solution, solve
from dashpot.errors import FitError

CHUNK = 256
#: grid points for the first look, by number of arms: every set of them is tried; more arms have
#: too many sets, and go one by one
LOOK = {1: 72, 2: 40, 3: 24}
#: further peaks of the first look that are tried where a relaxation time is not well known
RIVALS = 3


@dataclass(frozen=True, eq=False)
class ManySolutions(ByValue):
    """The optima of many records; rows without a solution hold NaN.

    Attributes
    ----------
    log_tau, arms : array, shape (R, N)
        Ascending in tau; NaN beyond `order`.
    fixed : array, shape (R, q)
    sse : array, shape (R,)
    order : int array, shape (R,)
        Arms found; -1 where nothing was fitted.
    finite, converged, at_bound : bool array, shape (R,)
        Samples and the sum of their squares are finite; the gradient vanished inside the
        window; an arm sits at its edge.
    """

    log_tau: FloatArray
    arms: FloatArray
    fixed: FloatArray
    sse: FloatArray
    order: IndexArray
    finite: BoolArray
    converged: BoolArray
    at_bound: BoolArray


class Seen(NamedTuple):
    """A stack of records through a family: all that a fit needs of them."""

    data: tuple[FloatArray, ...]  # arrays whose first axis is the record
    floor: FloatArray  # (R,)
    energy: FloatArray  # (R,) sum of squares of what the rows hold

    def take(self, index: IndexArray | BoolArray) -> Seen:
        """Some of the records."""
        return Seen(tuple(part[index] for part in self.data), self.floor[index], self.energy[index])


class Family(Protocol):
    """Records that share a sampling and a history, so that only the data differ.

    Attributes
    ----------
    fixed_count, samples : int
    nonnegative : bool array, shape (q,)
        Which fixed coefficients are stiffnesses.
    bounds : (float, float)
        The window of ln tau.
    grain : float
        Relative sum of squares that is rounding.
    """

    @property
    def fixed_count(self) -> int: ...  # noqa: D102
    @property
    def samples(self) -> int: ...  # noqa: D102
    @property
    def nonnegative(self) -> BoolArray: ...  # noqa: D102
    @property
    def bounds(self) -> tuple[float, float]: ...  # noqa: D102
    @property
    def grain(self) -> float: ...  # noqa: D102

    def see(self, values: FloatArray) -> Seen:
        """Reduce records, shape (R, M)."""
        ...

    def factor(self, tau: FloatArray, seen: Seen, *, exact: bool) -> FloatArray:
        """Triangular factors of [fixed, arms, slopes, y] at tau (R, N), one per record.

        `exact` asks for the factor that does not go through a Gram matrix, if there is one.
        """
        ...

    def moments(self, tau: FloatArray, seen: Seen) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gram of [fixed, arms] at shared tau (G,), products with y: (R, q) and (R, G)."""
        ...

    def block(self, values: FloatArray) -> Block:
        """One record as a block, shape (M,)."""
        ...


def solve_many(family: Family, records: FloatArray, arms: int) -> ManySolutions:
    """Fit every row of `records`, shape (R, M), with up to `arms` exponentials.

    Nothing is raised by a bad row: it comes back without a solution.
    """
    if arms < 1:
        raise FitError(f"arms = {arms}; expected at least one")
    if family.samples < family.fixed_count + 2 * arms:
        raise FitError(
            f"{family.samples} samples cannot determine {family.fixed_count + 2 * arms} "
            "parameters; use fewer arms or longer records"
        )
    count = len(records)
    out = _empty(count, arms, family.fixed_count)
    look = _Look(family, arms) if arms in LOOK else None
    for first in range(0, count, CHUNK):
        chunk = records[first : first + CHUNK]
        index = first + np.arange(len(chunk))
        if look is None:
            out.finite[index] = _usable(chunk)
            index = index[out.finite[index]]
        else:
            with np.errstate(over="ignore", invalid="ignore"):
                seen = family.see(chunk)
                finite = np.isfinite(seen.floor + seen.energy)
            out.finite[index] = finite
            index = index[finite]
            if len(index):
                sure = _together(family, look, seen.take(finite), index, out)
                index = index[~sure]
        for i in index:
            _alone(family.block, records[i], arms, int(i), out)
    return out


def solve_each(
    make: Callable[[FloatArray], Block], records: FloatArray, arms: int, *, fixed_count: int
) -> ManySolutions:
    """Fit every row by itself, where nothing can be shared: `make` turns a row into a block."""
    out = _empty(len(records), arms, fixed_count)
    out.finite[:] = _usable(records)
    for i in np.flatnonzero(out.finite):
        _alone(make, records[i], arms, int(i), out)
    return out


def _usable(records: FloatArray) -> BoolArray:
    """Which records hold finite samples whose squares can be summed."""
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(np.isfinite(np.einsum("ij,ij->i", records, records)))


def _empty(count: int, arms: int, fixed: int) -> ManySolutions:
    return ManySolutions(
        log_tau=np.full((count, arms), np.nan),
        arms=np.full((count, arms), np.nan),
        fixed=np.full((count, fixed), np.nan),
        sse=np.full(count, np.nan),
        order=np.full(count, -1),
        finite=np.zeros(count, dtype=bool),
        converged=np.zeros(count, dtype=bool),
        at_bound=np.zeros(count, dtype=bool),
    )


def _alone(
    make: Callable[[FloatArray], Block],
    values: FloatArray,
    arms: int,
    row: int,
    out: ManySolutions,
) -> None:
    """One record by the single solver; a record that it refuses stays without a solution."""
    try:
        found: Solution = solve([make(values)], arms)
    except (FitError, np.linalg.LinAlgError):
        return
    n = found.order
    out.log_tau[row, :n] = found.log_tau
    out.arms[row, :n] = found.arms[0]
    out.fixed[row] = found.fixed
    out.sse[row] = found.sse
    out.order[row] = n
    out.converged[row] = found.converged
    out.at_bound[row] = found.at_bound.any()


class _Look:
    """The best set of grid points for each record: all sets at once, on swept Gram matrices."""

    def __init__(self, family: Family, arms: int) -> None:
        self.family = family
        self.log_tau = np.linspace(*family.bounds, LOOK[arms])
        self.sets = np.array(list(combinations(range(LOOK[arms]), arms)))
        self.inverse: FloatArray | None = None

    def gains(self, seen: Seen) -> FloatArray:
        """What each set explains of each record, (sets, R); zero without positive coefficients."""
        gram, with_fixed, with_grid = self.family.moments(np.exp(self.log_tau), seen)
        q = self.family.fixed_count
        across = np.linalg.solve(gram[:q, :q], gram[:q, q:])
        swept = gram[q:, q:] - gram[q:, :q] @ across
        length = np.sqrt(np.maximum(np.diagonal(swept), 1e-14 * np.diagonal(gram)[q:]))
        moment = (with_grid - with_fixed @ across) / length
        if self.inverse is None:
            cosine = swept / length / length[:, None]
            parts = cosine[self.sets[:, :, None], self.sets[:, None, :]]
            told_apart = np.linalg.eigvalsh(parts)[:, 0] > 1e-7
            self.sets = self.sets[told_apart]
            self.inverse = np.linalg.inv(parts[told_apart])
        # one row per set: whole rows of records are picked, added and compared
        picked = [moment.T[column] for column in self.sets.T]
        gain, positive = np.zeros(picked[0].shape), np.ones(picked[0].shape, dtype=bool)
        for i, row in enumerate(picked):
            beta = sum(self.inverse[:, i, j, None] * other for j, other in enumerate(picked))
            positive &= beta > 0
            gain += beta * row
        return gain * positive

    def best(self, gain: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Return ln tau (R, N) of the best set of each record, and whether it explains anything."""
        best = np.argmax(gain, axis=0)
        return self.log_tau[self.sets[best]], gain[best, np.arange(gain.shape[1])] > 0

    def peaks(self, gain: FloatArray, count: int) -> Iterator[tuple[FloatArray, BoolArray]]:
        """Yield what `best` says of the second, third, ... highest local maximum of each record."""
        left = gain * (gain >= np.maximum.reduce([gain[beside] for beside in self.beside.T]))
        records = np.arange(gain.shape[1])
        for _ in range(count):
            left[np.argmax(left, axis=0), records] = 0.0
            yield self.best(left)

    @cached_property
    def beside(self) -> IndexArray:
        """The sets next to each set, shape (sets, 3^N); itself where there is none."""
        size = len(self.log_tau) + 2
        shape = (size,) * self.sets.shape[1]
        row = np.full(size ** len(shape), -1)
        row[np.ravel_multi_index((self.sets + 1).T, shape)] = np.arange(len(self.sets))
        around = np.indices((3,) * len(shape)).reshape(len(shape), -1)
        found = row[np.ravel_multi_index(self.sets.T[:, :, None] + around[:, None], shape)]
        return np.where(found < 0, np.arange(len(self.sets))[:, None], found)


class _Points(NamedTuple):
    beta: FloatArray  # (R, q + N)
    sse: FloatArray  # (R,)
    gradient: FloatArray  # (R, N)
    curvature: FloatArray  # (R, N, N)
    turn: FloatArray  # (R, q + N, N)

    def put(self, index: IndexArray, new: _Points) -> None:
        for old, fresh in zip(self, new, strict=True):
            old[index] = fresh

    def ahead(self, index: IndexArray, step: FloatArray) -> None:
        """Move beta by short steps (R, N), along which it is linear."""
        self.beta[index] += (self.turn[index] @ step[..., None])[..., 0]

    def take(self, index: IndexArray | BoolArray) -> _Points:
        return _Points(*(part[index] for part in self))


def _points(family: Family, log_tau: FloatArray, seen: Seen, *, exact: bool = False) -> _Points:
    """As :func:`dashpot.engine.descent.point_at`, from stacked triangular factors."""
    q, arms = family.fixed_count, log_tau.shape[1]
    p = q + arms
    factor = family.factor(np.exp(log_tau), seen, exact=exact)
    r = factor[:, :p, :p]
    pivot, length = np.diagonal(r, axis1=1, axis2=2) ** 2, (r * r).sum(axis=1)
    dependent = (pivot <= 1e-13 * length).any(axis=1)
    r = np.where(dependent[:, None, None], np.eye(p), r)
    inverse = np.linalg.inv(r)
    beta = (inverse @ factor[:, :p, -1:])[..., 0]
    residual, outside, k = factor[:, p:, -1], factor[:, p:, p:-1], beta[:, q:]
    lean = (residual[:, None, :] @ outside)[:, 0]
    inside = inverse[:, q:] * lean[..., None]
    outside = outside * k[:, None, :]
    turned = np.swapaxes(inside, 1, 2)
    curvature = np.swapaxes(outside, 1, 2) @ outside + inside @ turned
    turn = inverse @ (turned - factor[:, :p, p:-1] * k[:, None, :])
    sse = np.where(dependent, np.inf, np.vecdot(residual, residual))
    return _Points(beta, sse, -k * lean, curvature, turn)


def _together(
    family: Family, look: _Look, seen: Seen, index: IndexArray, out: ManySolutions
) -> BoolArray:
    """Descend all records of a chunk; write the ones that leave no doubt, and say which."""
    gain = look.gains(seen)
    found = _descend(family, *look.best(gain), seen)
    sure = _proper(family, found, seen)
    weak = np.flatnonzero(sure)
    weak = weak[~_known(family, found.take(weak), seen.take(weak))]
    if len(weak):
        best, sure[weak] = _compared(family, look, gain[:, weak], found.take(weak), seen.take(weak))
        found.put(weak, best)
    log_tau, point, _ = found
    q, arms = family.fixed_count, log_tau.shape[1]
    small = np.flatnonzero(sure & (point.sse < PLAIN * seen.energy))
    if len(small):
        point.put(small, _points(family, log_tau[small], seen.take(small), exact=True))
    sse = seen.floor + point.sse
    rows = index[sure]
    order = np.argsort(log_tau[sure], axis=1)
    out.log_tau[rows] = np.take_along_axis(log_tau[sure], order, axis=1)
    out.arms[rows] = np.take_along_axis(point.beta[sure, q:], order, axis=1)
    out.fixed[rows] = point.beta[sure, :q]
    out.sse[rows] = sse[sure]
    out.order[rows] = arms
    out.converged[rows] = True
    return sure


def _proper(family: Family, found: _Descended, seen: Seen) -> BoolArray:
    """Which records have an optimum inside the window, all coefficients positive."""
    low, high = family.bounds
    q, beta = family.fixed_count, found.point.beta
    proper = found.done & (found.point.sse > 100 * family.grain * seen.energy)
    proper &= (beta[:, q:] > 0).all(axis=1) & (beta[:, :q] > 0)[:, family.nonnegative].all(axis=1)
    proper &= ((found.log_tau > low) & (found.log_tau < high)).all(axis=1)
    return proper


def _known(family: Family, found: _Descended, seen: Seen) -> BoolArray:
    """Which records know every relaxation time so well that no other optimum can be better."""
    count, arms = found.log_tau.shape
    spare = family.samples - family.fixed_count - 2 * arms
    if spare < 10:
        return np.zeros(count, dtype=bool)
    curvature = found.point.curvature
    scale = np.maximum(np.diagonal(curvature, axis1=1, axis2=2), 1e-300)
    unit = curvature / np.sqrt(scale[:, :, None] * scale[:, None, :]) + 1e-14 * np.eye(arms)
    variance = np.diagonal(np.linalg.inv(unit), axis1=1, axis2=2) / scale
    noise = (seen.floor + found.point.sse) / spare
    known = (variance > 0) & (variance * noise[:, None] < DOUBT**2)
    return np.asarray(known.all(axis=1))


def _compared(
    family: Family, look: _Look, gain: FloatArray, found: _Descended, seen: Seen
) -> tuple[_Descended, BoolArray]:
    """The best of what was found and of descents from other peaks, and where it is proper."""
    proper = np.ones(len(found.done), dtype=bool)
    for start, started in look.peaks(gain, RIVALS):
        other = _descend(family, start, started, seen)
        better = np.flatnonzero(other.point.sse < found.point.sse * (1 - 1e-10))
        proper[better] = _proper(family, other, seen)[better]
        found.put(better, other.take(better))
    return found, proper


class _Descended(NamedTuple):
    log_tau: FloatArray
    point: _Points
    done: BoolArray

    def put(self, index: IndexArray, new: _Descended) -> None:
        self.log_tau[index], self.done[index] = new.log_tau, new.done
        self.point.put(index, new.point)

    def take(self, index: IndexArray | BoolArray) -> _Descended:
        return _Descended(self.log_tau[index], self.point.take(index), self.done[index])


def _descend(
    family: Family, start: FloatArray, started: BoolArray, seen: Seen, limit: int = 40
) -> _Descended:
    """The descent of :func:`dashpot.engine.descent.descend`, for all records at once."""
    low, high = family.bounds
    log_tau = start.copy()
    here = _points(family, log_tau, seen)
    rounding = family.grain * seen.energy
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
        new = _points(family, trial, seen.take(active))
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
    return _Descended(log_tau, here, done)


def _steps(point: _Points, damping: FloatArray) -> FloatArray:
    scale = np.maximum(np.diagonal(point.curvature, axis1=1, axis2=2), 1e-300)
    unit = point.curvature / np.sqrt(scale[:, :, None] * scale[:, None, :])
    unit = unit + (np.maximum(damping, 1e-14)[:, None, None]) * np.eye(scale.shape[1])
    root = np.sqrt(scale)
    step = -np.linalg.solve(unit, (point.gradient / root)[..., None])[..., 0] / root
    return np.clip(step, -LONGEST_STEP, LONGEST_STEP)
