"""The best optimum for 0, 1, 2, ... arms, each started from the one before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import compress

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import FitError
from dashpot.numerics.exponential_fit.log_tau_descent import (
    Stack,
    StackTrial,
    descend,
    is_inside_window,
    point_at,
)
from dashpot.numerics.exponential_fit.starting_points import (
    Grid,
    draw_quasirandom_starts,
    find_best_pair,
    find_best_triple,
    make_insertion_starts,
    make_partition_starts,
    peaks_of,
    single,
)
from dashpot.numerics.least_squares.levenberg_marquardt import FINISHED, LocalOptimum

#: where descents that are yet to be compared end: steps, and falls of the SSE
LOOSE = 1e-4
FLAT = 1e-10
EXTRA_STARTS = 16
DOUBT = 0.1
#: numbers of arms for which every set of points of a grid is tried, and the points of that grid
LOOK: dict[int, tuple[Callable[[Grid], FloatArray | None], int]] = {
    1: (single, 48),
    2: (find_best_pair, 48),
    3: (find_best_triple, 94),
}
#: in units of the noise variance
FAR = 20.0


class ArmInsertion:
    """What a stack's orders have in common: grid, spectrum, and the optima found so far.

    `best[n]` is the optimum with n arms, except after a `leap`, when the only one is its own.
    """

    def __init__(self, stack: Stack, *, thorough: bool, signed: bool, seed: int) -> None:
        self.stack, self.signed, self.thorough, self.seed = stack, signed, thorough, seed
        self.best: list[LocalOptimum[StackTrial]] = []
        self._attempts: dict[int, LocalOptimum[StackTrial] | None] = {}
        self._starts_found: dict[int, FloatArray | None] = {}

    @property
    def largest_order(self) -> int:
        """The largest number of arms so far."""
        return len(self.best) - 1

    @cached_property
    def grid(self) -> Grid:
        """The stack's columns on a grid of ln tau."""
        return Grid(self.stack)

    @cached_property
    def peaks(self) -> tuple[FloatArray, FloatArray]:
        """Positions and weights of the spectrum's peaks."""
        return peaks_of(self.grid)

    def leap(self, arms: int) -> bool:
        """Go straight to `arms` if that leaves no doubt, as two that start as neighbours would."""
        optimum = (
            self._find_certain_optimum(arms) if arms and self._has_separated_start(arms) else None
        )
        if optimum is not None:
            self.best.append(optimum)
        return optimum is not None

    def as_good_near(self, log_tau: FloatArray, *, negligible: float) -> bool:
        """Go to the optimum next to `log_tau` if no spectrum gains `negligible` noise variances."""
        local = descend(self.stack, log_tau)
        wanted = self._get_nonnegative_mask(len(log_tau))
        if local is None or (local.point.beta[wanted] <= 0).any():
            return False
        self.best.append(local)
        if not self._leaves_less_than(negligible):
            self.best.pop()
        return bool(self.best)

    def _find_certain_optimum(self, arms: int) -> LocalOptimum[StackTrial] | None:
        """The optimum next to the best of the whole grid, if nothing about it is in doubt.

        Doubt is a relaxation time that is not known to 10 %, or that sits at the edge of the
        window, or a coefficient that is not positive; with more arms than three, whose start is
        not the best of all sets, also an SSE well above that of the best positive spectrum.
        A well-determined optimum that started from the best of the whole grid has no rival.
        """
        local = self._attempt(arms)
        if local is None:
            return None
        point = local.point
        spare = self.stack.samples - len(point.beta) - arms
        if (
            not local.converged
            or point.sse <= 100 * self.stack.nothing
            or spare < 10
            or (point.beta[self.stack.get_nonnegative_mask(arms, signed=False)] <= 0).any()
            or not is_inside_window(point.log_tau, self.stack.bounds)
        ):
            return None
        noise = (self.stack.floor + point.sse) / spare
        try:
            spread = np.diagonal(np.linalg.inv(point.curvature)) * noise
        except np.linalg.LinAlgError:  # an arm of which nothing is known
            return None
        if not (spread < DOUBT**2).all():
            return None
        if arms not in LOOK and point.sse - self.grid.residual_sse > FAR * noise:
            return None
        return local

    def _attempt(self, arms: int) -> LocalOptimum[StackTrial] | None:
        """The optimum next to the best set of grid points, or next to the spectrum's peaks."""
        if arms not in self._attempts:
            start = self._first_start(arms)
            self._attempts[arms] = (
                None
                if start is None
                else descend(
                    self.stack, start, damping=1e-6, wanted=self._get_nonnegative_mask(arms)
                )
            )
        return self._attempts[arms]

    def _has_separated_start(self, arms: int) -> bool:
        """True if the best set of grid points has no two that are neighbours."""
        start, (low, high) = self._first_start(arms), self.stack.bounds
        if start is None or arms not in LOOK:
            return start is not None
        step = (high - low) / (LOOK[arms][1] - 1)
        return bool((np.diff(start) > 1.5 * step).all())

    def _first_start(self, arms: int) -> FloatArray | None:
        if self.thorough or self.signed or len(self.stack.groups) > 1:
            return None
        if arms not in self._starts_found:
            if arms in LOOK:
                best_set, size = LOOK[arms]
                start = best_set(Grid(self.stack, size))
            else:
                start = next(
                    iter(make_partition_starts(self.grid, *self.peaks, arms, count=1)), None
                )
            self._starts_found[arms] = start
        return self._starts_found[arms]

    def extend(self, arms: int, *, negligible: float = 0.0, every: bool = True) -> None:
        """Add orders up to `arms`, or until none is better.

        Where no positive spectrum whatever would lower the SSE by `negligible` noise variances
        any more, one start is enough for a further order; unless `every` one is wanted, the first
        such order is the last.
        """
        if not self.best:
            self.best.append(LocalOptimum(_without_arms(self.stack, signed=self.signed), 1, True))
        while self.largest_order < arms:
            last, count = self.best[-1].point, self.largest_order + 1
            if last.sse <= self.stack.nothing:
                return
            enough = self._leaves_less_than(negligible)
            if enough:
                optimum = self._best_with(count, starts=self._insert_arm(count=1))
            else:
                optimum = self._find_certain_optimum(count) or self._best_with(count)
            worth = last.sse - 1e-10 * (self.stack.floor + last.sse) - self.stack.nothing
            if optimum is None or optimum.point.sse >= worth:
                return
            self.best.append(optimum)
            if enough and not every:
                return

    def _leaves_less_than(self, negligible: float) -> bool:
        """True if no positive spectrum gains so many noise variances on the last order."""
        if self.signed or self.thorough or negligible <= 0:
            return False
        last = self.best[-1].point
        spare = max(self.stack.samples - len(last.beta) - len(last.log_tau), 1)
        least = negligible * (self.stack.floor + last.sse) / spare
        return bool(last.sse - self.grid.residual_sse < least and last.sse - self._any() < least)

    def _any(self) -> float:
        """The SSE of the best positive spectrum on the grid and beside the last arms."""
        point = self.best[-1].point
        together = np.concatenate((point.log_tau, self.grid.log_tau))
        near = np.arange(len(together)) < len(point.log_tau)
        fixed = point.beta[: len(self.stack.names)]
        loose = ~(self.stack.get_nonnegative_mask(0, signed=False) & (fixed == 0))
        return Grid(self.stack, log_tau=together, loose=loose, near=near).residual_sse

    def _best_with(
        self, arms: int, *, starts: list[FloatArray] | None = None
    ) -> LocalOptimum[StackTrial] | None:
        """The best of the optima next to all starts, finished; None if no arms carry as many."""
        restricted = self._get_nonnegative_mask(arms)
        if starts is None:
            allowed = self._optima(self._starts(arms), self._attempt(arms), restricted)
        else:
            allowed = self._descend_restricted(starts, restricted)
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
        # at the bound a restricted polish may leave the rounding of a zero, which is no sign
        if not bound and (polished.point.beta[restricted] < 0).any():
            return winner
        return polished

    def _get_nonnegative_mask(self, arms: int) -> BoolArray:
        """The coefficients that must not be negative."""
        return self.stack.get_nonnegative_mask(arms, signed=self.signed)

    def _starts(self, arms: int) -> list[FloatArray]:
        starts = self._insert_arm(count=2)
        if not self.signed:
            starts = make_partition_starts(self.grid, *self.peaks, arms) + starts
        if self.thorough:
            starts += draw_quasirandom_starts(self.stack, arms, EXTRA_STARTS, self.seed)
        return starts

    def _insert_arm(self, *, count: int) -> list[FloatArray]:
        return make_insertion_starts(
            self.grid, self.best[-1].point, signed=self.signed, count=count
        )

    def _optima(
        self,
        starts: Sequence[FloatArray],
        first: LocalOptimum[StackTrial] | None,
        restricted: BoolArray,
    ) -> list[LocalOptimum[StackTrial]]:
        """The optima without a coefficient below zero that the starts lead to."""
        optima = [] if first is None else [first]
        for start in starts:
            rivals = [np.sort(rival.point.log_tau) for rival in optima]
            local = self._descend(start, rivals, wanted=restricted)
            if local is not None:
                optima.append(local)
        sse = np.array([local.point.sse for local in optima])
        signs = [(local.point.beta[restricted] >= 0).all() for local in optima]
        feasible = np.array(signs, dtype=bool)
        allowed = list(compress(optima, feasible))
        # what is better but not allowed is pushed back to where it is
        better = ~feasible & (sse < sse[feasible].min(initial=np.inf))
        pushed = [local.point.log_tau for local in compress(optima, better)]
        return allowed + self._descend_restricted(
            [*pushed, *([] if allowed else starts[-2:])], restricted
        )

    def _descend_restricted(
        self, starts: Sequence[FloatArray], restricted: BoolArray
    ) -> list[LocalOptimum[StackTrial]]:
        """The optima next to the starts with no restricted coefficient below zero."""
        optima = [self._descend(start, (), restricted=restricted) for start in starts]
        return [
            optimum
            for optimum in optima
            if optimum and optimum.point.beta[-len(optimum.point.log_tau) :].any()
        ]

    def _descend(
        self,
        start: FloatArray,
        rivals: Sequence[FloatArray],
        *,
        restricted: BoolArray | None = None,
        wanted: BoolArray | None = None,
        finished: float = LOOSE,
    ) -> LocalOptimum[StackTrial] | None:
        return descend(
            self.stack,
            start,
            restricted=restricted,
            wanted=wanted,
            rivals=rivals,
            finished=finished,
            flat=0.0 if finished == FINISHED else FLAT,
        )


def _carries(point: StackTrial, stack: Stack) -> bool:
    """True if every arm carries something in some group."""
    arms = len(point.log_tau)
    k = point.beta[len(stack.names) :].reshape(len(stack.groups), arms)
    return bool((k != 0).any(axis=0).all())


def _without_arms(stack: Stack, *, signed: bool) -> StackTrial:
    nothing = np.zeros(0)
    if not stack.names:
        target = stack.evaluate(nothing, derivative=False).target
        none = np.zeros((0, 0))
        return StackTrial(nothing, nothing, float(target @ target), nothing, none, none)
    restricted = None if signed else stack.get_nonnegative_mask(0, signed=False)
    point = point_at(stack, nothing, restricted=restricted)
    if point.sse == np.inf:
        raise FitError(
            "the columns that do not relax are not independent in this data; "
            "fit fewer of " + ", ".join(stack.names)
        )
    return point
