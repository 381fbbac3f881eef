"""The best sum of exponentials in a stack of blocks, without a guess."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dashpot._arrays import BoolArray, ByValue, FloatArray, frozen
from dashpot.engine.blocks import Block
from dashpot.engine.descent import FINISHED, Local, Point, Stack, descend, point_at, relative_offset
from dashpot.engine.starts import (
    Grid,
    inserted,
    paired,
    partitioned,
    peaks_of,
    scattered,
    single,
)
from dashpot.errors import FitError

LOOSE = 1e-4
EXTRA_STARTS = 16
DOUBT = 0.1
LOOK = 48
#: in units of the noise variance
FAR = 20.0
RESOLVED = 1e-9


@dataclass(frozen=True, eq=False)
class Solution(ByValue):
    """The optimum of a stack for one number of arms.

    Attributes
    ----------
    log_tau : array, shape (N,)
        ln of the relaxation times, ascending.
    groups : tuple of str
        The arm groups of the stack, in the order of the rows of `arms`.
    arms : array, shape (G, N)
        Coefficients of the arms, one row per group.
    fixed_names : tuple of str
    fixed : array, shape (q,)
        Coefficients of the fixed columns.
    sse : float
        Sum of squared residuals of the full data.
    samples : int
        Full-data sample count.
    requested : int
        Arms asked for; more than N if the data reject the others.
    evaluations : int
        Trials of ln tau, over all starts.
    converged : bool
        The gradient vanished at an optimum inside the window.
    relative_offset : float
        Length of the residual that a further step would remove, over the residual's.
    at_bound : bool array, shape (N,)
        Which relaxation times sit at the edge of the window.
    bounds : (float, float)
        The window, ln s.
    signed : bool
        Coefficients of either sign were allowed.
    """

    log_tau: FloatArray
    groups: tuple[str, ...]
    arms: FloatArray
    fixed_names: tuple[str, ...]
    fixed: FloatArray
    sse: float
    samples: int
    requested: int
    evaluations: int
    converged: bool
    relative_offset: float
    at_bound: BoolArray
    bounds: tuple[float, float]
    signed: bool = False

    def __post_init__(self) -> None:
        for name in ("log_tau", "arms", "fixed", "at_bound"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def order(self) -> int:
        """Number of arms found."""
        return len(self.log_tau)

    @property
    def tau(self) -> FloatArray:
        """Relaxation times, s, ascending."""
        return np.asarray(np.exp(self.log_tau))

    def coefficient(self, name: str) -> float:
        """The coefficient of a fixed column by its name."""
        return float(self.fixed[self.fixed_names.index(name)])


@dataclass(frozen=True, eq=False)
class Jacobian(ByValue):
    """The residual of a solution and its derivative by every parameter, in the blocks' rows.

    Attributes
    ----------
    names : tuple of str
        Fixed names, then arms group by group (``"k_1"``; group ``"k@0"`` gives ``"k_1@0"``),
        then ``"ln_tau_1"``...
    matrix : array, shape (n, p)
        d model / d parameter: ``[Phi, D beta]``.
    residual : array, shape (n,)
        Target less model.
    """

    names: tuple[str, ...]
    matrix: FloatArray
    residual: FloatArray


def solve(
    blocks: Sequence[Block],
    arms: int,
    *,
    log_tau_start: FloatArray | None = None,
    thorough: bool = False,
    signed: bool = False,
    seed: int = 0,
) -> Solution:
    """Return the least-squares sum with `arms` exponentials.

    Parameters
    ----------
    blocks : sequence of Block
        The data sets, stacked.
    arms : int
        How many relaxation times, >= 0.
    log_tau_start : array, shape (arms,), optional
        One start of your own; without it the engine finds the starts.
    thorough : bool
        Add quasi-random starts for every number of arms.
    signed : bool
        Allow coefficients of either sign.
    seed : int
        Shifts the quasi-random starts.

    Returns
    -------
    Solution
        With fewer arms than asked for if a further arm with k > 0 would not lower the SSE.

    Raises
    ------
    FitError
        If the data have fewer samples than parameters, or `arms` is negative.
    """
    stack = _checked(blocks, arms)
    if log_tau_start is not None:
        return _from_start(stack, np.asarray(log_tau_start, dtype=float), arms, signed=signed)
    chain = _Chain(stack, thorough=thorough, signed=signed, seed=seed)
    if chain.leap(arms):
        return chain.solution(-1, requested=arms)
    chain.extend(arms)
    return chain.solution(chain.reached, requested=arms)


def solve_orders(
    blocks: Sequence[Block],
    max_arms: int,
    *,
    thorough: bool = False,
    signed: bool = False,
    seed: int = 0,
) -> tuple[Solution, ...]:
    """Return the optimum for 1, 2, ... `max_arms` exponentials, from one chain.

    The tuple ends where a further arm with k > 0 no longer lowers the SSE; if not even one
    does, it holds the solution without arms.
    """
    stack = _checked(blocks, max_arms)
    chain = _Chain(stack, thorough=thorough, signed=signed, seed=seed)
    chain.extend(max_arms)
    orders = range(min(1, chain.reached), chain.reached + 1)
    return tuple(chain.solution(n, requested=n) for n in orders)


def full_jacobian(blocks: Sequence[Block], solution: Solution) -> Jacobian:
    r"""Residual and derivative of the model by all parameters, linear ones and ln tau.

    The inverse of J'J times the noise variance is the covariance for white noise.
    """
    stack = Stack(blocks)
    target, phi, slope = stack.evaluate(solution.log_tau)
    k = solution.arms.ravel()
    beta = np.concatenate((solution.fixed, k))
    by_tau = (slope * k).reshape(len(target), len(solution.groups), solution.order).sum(axis=1)
    names = list(solution.fixed_names)
    for group in solution.groups:
        kind, at, where = group.partition("@")
        names += [f"{kind}_{j}{at}{where}" for j in range(1, solution.order + 1)]
    names += [f"ln_tau_{j}" for j in range(1, solution.order + 1)]
    return Jacobian(tuple(names), np.concatenate((phi, by_tau), axis=1), target - phi @ beta)


def _checked(blocks: Sequence[Block], arms: int) -> Stack:
    if arms < 0:
        raise FitError(f"arms = {arms}; expected a number >= 0")
    if not blocks:
        raise FitError("nothing to fit: expected at least one block of data")
    stack = Stack(blocks)
    unknown = len(stack.names) + arms * (1 + len(stack.groups))
    if stack.samples < unknown:
        raise FitError(
            f"{stack.samples} samples cannot determine {unknown} parameters; "
            "use fewer arms or a longer record"
        )
    return stack


class _Chain:
    """The best optimum for 0, 1, 2, ... arms, each started from the one before."""

    def __init__(self, stack: Stack, *, thorough: bool, signed: bool, seed: int) -> None:
        self.stack, self.signed, self.thorough, self.seed = stack, signed, thorough, seed
        self.evaluations = 0
        self.best: list[Local] = []

    @property
    def reached(self) -> int:
        return len(self.best) - 1

    @cached_property
    def grid(self) -> Grid:
        return Grid(self.stack)

    @cached_property
    def spectrum(self) -> FloatArray:
        return self.grid.spectrum()

    @cached_property
    def peaks(self) -> tuple[FloatArray, FloatArray]:
        return peaks_of(self.grid, self.spectrum)

    def leap(self, arms: int) -> bool:
        """Go straight to `arms` if that leaves no doubt."""
        found = self._undoubted(arms) if arms else None
        if found is not None:
            self.best.append(found)
        return found is not None

    def _undoubted(self, arms: int) -> Local | None:
        """The optimum next to the best of the whole grid, if nothing about it is in doubt.

        Doubt is a relaxation time that is not known to 10 %, or that sits at the edge of the
        window, or a coefficient that is not positive; with more than two arms, whose start is
        not the best of all sets, also an SSE well above that of the best positive spectrum.
        A well-determined optimum that started from the best of the whole grid has no rival.
        """
        if self.thorough or self.signed or len(self.stack.groups) > 1:
            return None
        local = None
        for start in self._sure_starts(arms):
            local = descend(self.stack, start, damping=1e-6)
        if local is None:
            return None
        self.evaluations += local.evaluations
        point = local.point
        low, high = self.stack.bounds
        spare = self.stack.samples - len(point.beta) - arms
        if (
            not local.converged
            or point.sse <= 100 * self.stack.nothing
            or spare < 10
            or (point.beta[self.stack.restricted(arms, signed=False)] <= 0).any()
            or not (low < point.log_tau.min() and point.log_tau.max() < high)
        ):
            return None
        noise = (self.stack.floor + point.sse) / spare
        known = np.diagonal(np.linalg.inv(point.curvature)) * noise < DOUBT**2
        if not known.all():
            return None
        if arms > 2 and point.sse - self.grid.left_by(self.spectrum) > FAR * noise:
            return None
        return local

    def _sure_starts(self, arms: int) -> list[FloatArray]:
        if arms > 2:
            return partitioned(self.grid, *self.peaks, arms, count=1)
        look = Grid(self.stack, LOOK)
        start = paired(look) if arms == 2 else single(look)
        return [] if start is None else [start]

    def extend(self, arms: int) -> None:
        """Add orders up to `arms`, or until none is better."""
        if not self.best:
            self.best.append(Local(_without_arms(self.stack, signed=self.signed), 1, True))
        while self.reached < arms:
            last = self.best[-1].point
            if last.sse <= self.stack.nothing:
                return
            found = self._undoubted(self.reached + 1) or self._best_with(self.reached + 1)
            worth = last.sse - 1e-10 * (self.stack.floor + last.sse) - self.stack.nothing
            if found is None or found.point.sse >= worth:
                return
            self.best.append(found)

    def solution(self, order: int, *, requested: int) -> Solution:
        return _solution(
            self.stack,
            self.best[order],
            requested=requested,
            evaluations=self.evaluations,
            signed=self.signed,
        )

    def _best_with(self, arms: int) -> Local | None:
        starts = inserted(self.grid, self.best[-1].point, signed=self.signed)
        if not self.signed:
            starts = partitioned(self.grid, *self.peaks, arms) + starts
        if self.thorough:
            starts += scattered(self.stack, arms, EXTRA_STARTS, self.seed)
        restricted = self.stack.restricted(arms, signed=self.signed)
        allowed: list[Local] = []
        refused: list[Local] = []
        for start in starts:
            rivals = [np.sort(local.point.log_tau) for local in allowed + refused]
            local = self._descend(start, rivals)
            if local is not None:
                feasible = (local.point.beta[restricted] >= 0).all()
                (allowed if feasible else refused).append(local)
        reach = min((local.point.sse for local in allowed), default=np.inf)
        pushed = [local.point.log_tau for local in refused if local.point.sse < reach]
        for start in pushed + ([] if allowed else starts[-2:]):
            local = self._descend(start, (), restricted=restricted)
            if local is not None and not (local.point.beta[-arms:] == 0).all():
                allowed.append(local)
        full = [local for local in allowed if _carries(local.point, self.stack)]
        if not full:
            return None
        winner = min(full, key=lambda local: local.point.sse)
        bound = (winner.point.beta[restricted] == 0).any()
        polished = self._descend(
            winner.point.log_tau, (), restricted=restricted if bound else None, finished=FINISHED
        )
        if polished is None or not _carries(polished.point, self.stack):
            return winner
        if (polished.point.beta[restricted] < 0).any():
            return winner
        return polished

    def _descend(
        self,
        start: FloatArray,
        rivals: Sequence[FloatArray],
        *,
        restricted: BoolArray | None = None,
        finished: float = LOOSE,
    ) -> Local | None:
        local = descend(self.stack, start, restricted=restricted, rivals=rivals, finished=finished)
        self.evaluations += local.evaluations if local is not None else 4
        return local


def _carries(point: Point, stack: Stack) -> bool:
    """True if every arm carries something in some group."""
    arms = len(point.log_tau)
    k = point.beta[len(stack.names) :].reshape(len(stack.groups), arms)
    return bool((k != 0).any(axis=0).all())


def _without_arms(stack: Stack, *, signed: bool) -> Point:
    nothing = np.zeros(0)
    if not stack.names:
        target = stack.evaluate(nothing, derivative=False).target
        return Point(nothing, nothing, float(target @ target), nothing, np.zeros((0, 0)))
    restricted = None if signed else stack.restricted(0, signed=False)
    point = point_at(stack, nothing, restricted=restricted)
    if point is None:
        raise FitError(
            "the columns that do not relax are not independent in this data; "
            "fit fewer of " + ", ".join(stack.names)
        )
    return point


def _from_start(stack: Stack, start: FloatArray, arms: int, *, signed: bool) -> Solution:
    if len(start) != arms:
        raise FitError(f"{arms} arms need {arms} starting values of ln tau, found {len(start)}")
    local = descend(stack, start)
    if local is not None and not signed:
        restricted = stack.restricted(arms, signed=False)
        if (local.point.beta[restricted] < 0).any():
            local = descend(stack, start, restricted=restricted)
    if local is None:
        raise FitError(
            "the columns at the start are not independent; start from different relaxation times"
        )
    return _solution(stack, local, requested=arms, evaluations=local.evaluations, signed=signed)


def _resolved(stack: Stack, local: Local) -> tuple[Stack, Local]:
    """Finish on every sample if the residual is too small for the compressed form to hold it."""
    if stack.floor + local.point.sse > RESOLVED * (stack.floor + stack.energy):
        return stack, local
    exact = Stack([block.exact for block in stack.blocks])
    resting = local.point.beta == 0
    if not len(local.point.log_tau) or resting.any():
        return stack, local
    finer = descend(exact, local.point.log_tau)
    return (stack, local) if finer is None else (exact, finer)


def _solution(
    stack: Stack, local: Local, *, requested: int, evaluations: int, signed: bool
) -> Solution:
    stack, local = _resolved(stack, local)
    point = local.point
    order = np.argsort(point.log_tau, kind="stable")
    log_tau = point.log_tau[order]
    q = len(stack.names)
    low, high = stack.bounds
    at_bound = (log_tau <= low + 1e-9) | (log_tau >= high - 1e-9)
    sse = stack.floor + point.sse
    return Solution(
        log_tau=log_tau,
        groups=stack.groups,
        arms=point.beta[q:].reshape(len(stack.groups), len(log_tau))[:, order],
        fixed_names=stack.names,
        fixed=point.beta[:q],
        sse=sse,
        samples=stack.samples,
        requested=requested,
        evaluations=evaluations,
        converged=local.converged and not bool(at_bound.any()),
        relative_offset=relative_offset(point, sse),
        at_bound=at_bound,
        bounds=stack.bounds,
        signed=signed,
    )
