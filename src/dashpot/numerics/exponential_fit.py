"""Globally optimal exponential sum of a stack of blocks, with its certificate."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import compress

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, EqualByValue, FloatArray, FrozenArrays
from dashpot.base.errors import FitError
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.least_squares import FINAL_TOLERANCE, LocalOptimum
from dashpot.numerics.log_tau_descent import (
    Grid,
    Stack,
    StackTrial,
    descend,
    draw_quasirandom_starts,
    find_best_pair,
    find_best_point,
    find_best_triple,
    find_peaks,
    is_inside_window,
    make_insertion_starts,
    make_partition_starts,
    relative_offset,
    solve_at,
)

# Optima for 0, 1, 2, ... arms, each started from the previous one.


#: tolerances of step and SSE for descents that are then compared
COARSE_TOLERANCE = 1e-4
FLAT_DEVIANCE = 1e-10
EXTRA_STARTS = 16
MAX_LN_TAU_SD = 0.1
#: numbers of arms for which every set of points of a grid is tried, and the points of that grid
GRID_SEARCH: dict[int, tuple[Callable[[Grid], FloatArray | None], int]] = {
    1: (find_best_point, 48),
    2: (find_best_pair, 48),
    3: (find_best_triple, 94),
}
#: in units of the noise variance
FAR_DEVIANCE = 20.0


class ArmInsertion:
    """Insertion of arms into a stack: grid, spectrum, and the optima of all orders so far.

    `best[n]` is the optimum with n arms, except after a `leap`, when the only one is its own.
    """

    def __init__(
        self, stack: Stack, *, thorough: bool = False, signed: bool = False, seed: int = 0
    ) -> None:
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
        return find_peaks(self.grid)

    def leap(self, arms: int) -> bool:
        """Go straight to `arms` if that leaves no doubt, as two that start as neighbours would."""
        optimum = (
            self._find_certain_optimum(arms) if arms and self._has_separated_start(arms) else None
        )
        if optimum is not None:
            self.best.append(optimum)
        return optimum is not None

    def accept_optimum_near(self, log_tau: FloatArray, *, negligible: float) -> bool:
        """Go to the optimum next to `log_tau` if no spectrum gains `negligible` noise variances."""
        local = descend(self.stack, log_tau)
        nonnegative_mask = self._get_nonnegative_mask(len(log_tau))
        if local is None or (local.point.beta[nonnegative_mask] <= 0).any():
            return False
        self.best.append(local)
        if not self._gains_little(negligible):
            self.best.pop()
        return bool(self.best)

    def _find_certain_optimum(self, arms: int) -> LocalOptimum[StackTrial] | None:
        """Return the optimum next to the best of the whole grid, if nothing about it is in doubt.

        Doubt is a relaxation time that is not known to 10 %, or that sits at the edge of the
        window, or a coefficient that is not positive; with more arms than three, whose start is
        not the best of all sets, also an SSE well above that of the best positive spectrum.
        A well-determined optimum that started from the best of the whole grid has no rival.
        """
        local = self._find_grid_optimum(arms)
        if local is None:
            return None
        point = local.point
        dof = self.stack.samples - len(point.beta) - arms
        if (
            not local.converged
            or point.sse <= 100 * self.stack.rounding_sse
            or dof < 10
            or (point.beta[self.stack.get_nonnegative_mask(arms, signed=False)] <= 0).any()
            or not is_inside_window(point.log_tau, self.stack.bounds)
        ):
            return None
        noise = (self.stack.floor + point.sse) / dof
        try:
            variances = np.diagonal(np.linalg.inv(point.curvature)) * noise
        except np.linalg.LinAlgError:  # an arm of which nothing is known
            return None
        if not (variances < MAX_LN_TAU_SD**2).all():
            return None
        if arms not in GRID_SEARCH and point.sse - self.grid.residual_sse > FAR_DEVIANCE * noise:
            return None
        return local

    def _find_grid_optimum(self, arms: int) -> LocalOptimum[StackTrial] | None:
        """The optimum next to the best set of grid points, or next to the spectrum's peaks."""
        if arms not in self._attempts:
            start = self._find_first_start(arms)
            self._attempts[arms] = (
                None
                if start is None
                else descend(
                    self.stack,
                    start,
                    damping=1e-6,
                    expected_positive=self._get_nonnegative_mask(arms),
                )
            )
        return self._attempts[arms]

    def _has_separated_start(self, arms: int) -> bool:
        """Return whether the best set of grid points has no two that are neighbours."""
        start, (low, high) = self._find_first_start(arms), self.stack.bounds
        if start is None or arms not in GRID_SEARCH:
            return start is not None
        step = (high - low) / (GRID_SEARCH[arms][1] - 1)
        return bool((np.diff(start) > 1.5 * step).all())

    def _find_first_start(self, arms: int) -> FloatArray | None:
        if self.thorough or self.signed or len(self.stack.groups) > 1:
            return None
        if arms not in self._starts_found:
            if arms in GRID_SEARCH:
                best_set, size = GRID_SEARCH[arms]
                start = best_set(Grid(self.stack, size))
            else:
                start = next(
                    iter(make_partition_starts(self.grid, *self.peaks, arms, count=1)), None
                )
            self._starts_found[arms] = start
        return self._starts_found[arms]

    def extend(self, arms: int, *, negligible: float = 0.0, every_order: bool = True) -> None:
        """Add orders up to `arms`, or until none is better.

        Where no positive spectrum whatever would lower the SSE by `negligible` noise variances
        any more, one start is enough for a further order; unless `every_order` one is wanted, the
        first such order is the last.
        """
        if not self.best:
            self.best.append(
                LocalOptimum(_solve_without_arms(self.stack, signed=self.signed), 1, True)
            )
        while self.largest_order < arms:
            last_point, count = self.best[-1].point, self.largest_order + 1
            if last_point.sse <= self.stack.rounding_sse:
                return
            gains_little = self._gains_little(negligible)
            if gains_little:
                optimum = self._find_best_optimum(count, starts=self._insert_arm(count=1))
            else:
                optimum = self._find_certain_optimum(count) or self._find_best_optimum(count)
            attainable_gain = (
                last_point.sse
                - 1e-10 * (self.stack.floor + last_point.sse)
                - self.stack.rounding_sse
            )
            if optimum is None or optimum.point.sse >= attainable_gain:
                return
            self.best.append(optimum)
            if gains_little and not every_order:
                return

    def _gains_little(self, negligible: float) -> bool:
        """Return whether no positive spectrum gains so many noise variances on the last order."""
        if self.signed or self.thorough or negligible <= 0:
            return False
        last_point = self.best[-1].point
        dof = max(self.stack.samples - len(last_point.beta) - len(last_point.log_tau), 1)
        variance_limit = negligible * (self.stack.floor + last_point.sse) / dof
        return bool(
            last_point.sse - self.grid.residual_sse < variance_limit
            and last_point.sse - self._compute_best_sse() < variance_limit
        )

    def _compute_best_sse(self) -> float:
        """Return the SSE of the best positive spectrum on the grid and beside the last arms."""
        point = self.best[-1].point
        log_tau = np.concatenate((point.log_tau, self.grid.log_tau))
        is_current_arm = np.arange(len(log_tau)) < len(point.log_tau)
        fixed = point.beta[: len(self.stack.names)]
        is_free = ~(self.stack.get_nonnegative_mask(0, signed=False) & (fixed == 0))
        return Grid(
            self.stack, log_tau=log_tau, is_free=is_free, likely_positive=is_current_arm
        ).residual_sse

    def _find_best_optimum(
        self, arms: int, *, starts: list[FloatArray] | None = None
    ) -> LocalOptimum[StackTrial] | None:
        """The best of the optima next to all starts, finished; None if no arms carry as many."""
        restricted = self._get_nonnegative_mask(arms)
        if starts is None:
            allowed = self._find_optima(
                self._list_starts(arms), self._find_grid_optimum(arms), restricted
            )
        else:
            allowed = self._descend_restricted(starts, restricted)
        full_optima = [local for local in allowed if _has_active_arms(local.point, self.stack)]
        if not full_optima:
            return None
        winner = min(full_optima, key=lambda local: local.point.sse)
        bound = (winner.point.beta[restricted] == 0).any()
        polished = self._descend(
            winner.point.log_tau,
            (),
            restricted=restricted if bound else None,
            step_tolerance=FINAL_TOLERANCE,
        )
        if polished is None or not _has_active_arms(polished.point, self.stack):
            return winner
        # at the bound a restricted polish may leave the rounding of a zero, which is no sign
        if not bound and (polished.point.beta[restricted] < 0).any():
            return winner
        return polished

    def _get_nonnegative_mask(self, arms: int) -> BoolArray:
        """Return the coefficients that must not be negative."""
        return self.stack.get_nonnegative_mask(arms, signed=self.signed)

    def _list_starts(self, arms: int) -> list[FloatArray]:
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

    def _find_optima(
        self,
        starts: Sequence[FloatArray],
        first: LocalOptimum[StackTrial] | None,
        restricted: BoolArray,
    ) -> list[LocalOptimum[StackTrial]]:
        """Return the optima without a coefficient below zero that the starts lead to."""
        optima = [] if first is None else [first]
        for start in starts:
            rivals = [np.sort(optimum.point.log_tau) for optimum in optima]
            local = self._descend(start, rivals, expected_positive=restricted)
            if local is not None:
                optima.append(local)
        sse = np.array([local.point.sse for local in optima])
        signs = [(local.point.beta[restricted] >= 0).all() for local in optima]
        feasible = np.array(signs, dtype=bool)
        allowed = list(compress(optima, feasible))
        # what is better but not allowed is pushed back to where it is
        is_better = ~feasible & (sse < sse[feasible].min(initial=np.inf))
        pushed = [local.point.log_tau for local in compress(optima, is_better)]
        return allowed + self._descend_restricted(
            [*pushed, *([] if allowed else starts[-2:])], restricted
        )

    def _descend_restricted(
        self, starts: Sequence[FloatArray], restricted: BoolArray
    ) -> list[LocalOptimum[StackTrial]]:
        """Return the optima next to the starts with no restricted coefficient below zero."""
        optima = [self._descend(start, (), restricted=restricted) for start in starts]
        return [
            optimum
            for optimum in optima
            if optimum and optimum.point.beta[-len(optimum.point.log_tau) :].any()
        ]

    def _descend(
        self,
        start: FloatArray,
        known_optima: Sequence[FloatArray],
        *,
        restricted: BoolArray | None = None,
        expected_positive: BoolArray | None = None,
        step_tolerance: float = COARSE_TOLERANCE,
    ) -> LocalOptimum[StackTrial] | None:
        return descend(
            self.stack,
            start,
            restricted=restricted,
            expected_positive=expected_positive,
            known_optima=known_optima,
            step_tolerance=step_tolerance,
            cost_tolerance=0.0 if step_tolerance == FINAL_TOLERANCE else FLAT_DEVIANCE,
        )


def _has_active_arms(point: StackTrial, stack: Stack) -> bool:
    """Return whether every arm carries something in some group."""
    arms = len(point.log_tau)
    k = point.beta[len(stack.names) :].reshape(len(stack.groups), arms)
    return bool((k != 0).any(axis=0).all())


def _solve_without_arms(stack: Stack, *, signed: bool) -> StackTrial:
    nothing = np.zeros(0)
    if not stack.names:
        target = stack.evaluate(nothing, derivative=False).target
        no_arms = np.zeros((0, 0))
        return StackTrial(nothing, nothing, float(target @ target), nothing, no_arms, no_arms)
    restricted = None if signed else stack.get_nonnegative_mask(0, signed=False)
    point = solve_at(stack, nothing, restricted=restricted)
    if point.sse == np.inf:
        raise FitError(
            "the columns that do not relax are not independent in this data; "
            "fit fewer of " + ", ".join(stack.names)
        )
    return point


# Exponential sum of a stack of blocks, without starting values.


MIN_RESOLVED_SHARE = 1e-9


@dataclass(frozen=True, eq=False)
class Solution(FrozenArrays):
    """Optimum of a stack for one number of arms.

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
    requested_arms : int
        Arms requested; more than N if the data reject the others.
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
    requested_arms: int
    evaluations: int
    converged: bool
    relative_offset: float
    at_bound: BoolArray
    bounds: tuple[float, float]
    signed: bool = False

    @property
    def order(self) -> int:
        """Number of arms found."""
        return len(self.log_tau)

    @property
    def beta(self) -> FloatArray:
        """The linear parameters as a stack has them: the fixed ones, then the arms by group."""
        return np.concatenate((self.fixed, self.arms.ravel()))

    @property
    def tau(self) -> FloatArray:
        """Relaxation times, s, ascending."""
        return np.asarray(np.exp(self.log_tau))

    def coefficient(self, name: str) -> float:
        """Return the coefficient of a fixed column by its name."""
        return float(self.fixed[self.fixed_names.index(name)])


@dataclass(frozen=True, eq=False)
class Jacobian(EqualByValue):
    """Residual of a solution and its derivative by every parameter, in the blocks' rows.

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
    blocks: Sequence[DataBlock],
    arms: int,
    *,
    log_tau_start: FloatArray | None = None,
    near_log_tau: FloatArray | None = None,
    negligible: float = 0.0,
    thorough: bool = False,
    signed: bool = False,
    seed: int = 0,
) -> Solution:
    """Return the least-squares sum with `arms` exponentials.

    Parameters
    ----------
    blocks : sequence of DataBlock
        The data sets, stacked.
    arms : int
        How many relaxation times, >= 0.
    log_tau_start : array, shape (arms,), optional
        One start of your own; by default the engine finds the starts.
    near_log_tau : array, shape (arms,), optional
        Where an optimum may be: next to it no other start is tried, if no positive spectrum with
        any number of arms would gain `negligible` noise variances on what is there.
    negligible : float
        Negligible gain: arms beyond those that could gain so many noise variances one start is
        enough.
    thorough : bool
        Add quasi-random starts for every number of arms.
    signed : bool
        Allow coefficients of either sign.
    seed : int
        Shifts the quasi-random starts.

    Returns
    -------
    Solution
        With fewer arms than requested if a further arm with k > 0 would not lower the SSE.

    Raises
    ------
    FitError
        If the data have fewer samples than parameters, or `arms` is negative.
    """
    stack = _validate_blocks(blocks, arms)
    if log_tau_start is not None:
        return _from_start(stack, np.asarray(log_tau_start, dtype=float), arms, signed=signed)
    chain = ArmInsertion(stack, thorough=thorough, signed=signed, seed=seed)
    if (
        near_log_tau is not None
        and arms
        and chain.accept_optimum_near(near_log_tau, negligible=negligible)
    ):
        return _make_solution(chain, -1, requested=arms)
    if chain.leap(arms):
        return _make_solution(chain, -1, requested=arms)
    chain.extend(arms, negligible=negligible)
    return _make_solution(chain, chain.largest_order, requested=arms)


def solve_orders(
    blocks: Sequence[DataBlock],
    max_arms: int,
    *,
    negligible: float = 0.0,
    every_order: bool = False,
    thorough: bool = False,
) -> tuple[Solution, ...]:
    """Return the optimum for none, 1, 2, ... `max_arms` exponentials, from one chain.

    The tuple ends where a further arm with k > 0 no longer lowers the SSE. With `negligible` it
    also ends one order after the first that is within so many noise variances of the best
    positive spectrum with any number of arms, so that no order omitted could gain more; unless
    `every_order` one is wanted, which is then found from a single start.
    """
    chain = ArmInsertion(_validate_blocks(blocks, max_arms), thorough=thorough)
    chain.extend(max_arms, negligible=negligible, every_order=every_order)
    return tuple(_make_solution(chain, n, requested=n) for n in range(chain.largest_order + 1))


def iterate_orders(blocks: Sequence[DataBlock], max_arms: int) -> Iterator[Solution]:
    """Yield the solutions of :func:`solve_orders` one by one, each found when requested."""
    chain = ArmInsertion(_validate_blocks(blocks, max_arms))
    for arms in range(max_arms + 1):
        chain.extend(arms)
        if chain.largest_order < arms:
            return
        yield _make_solution(chain, arms, requested=arms)


def compute_full_jacobian(blocks: Sequence[DataBlock], solution: Solution) -> Jacobian:
    r"""Residual and derivative of the model by all parameters, linear ones and ln tau.

    The inverse of J'J times the noise variance is the covariance for white noise.
    """
    stack, arms, q = Stack(blocks), solution.order, len(solution.fixed_names)
    rows_of_blocks = [block.evaluate(solution.log_tau) for block in blocks]
    target = np.concatenate([block_rows.target for block_rows in rows_of_blocks])
    first, by_tau = 0, q + solution.arms.size
    # columns stand as contiguous rows, turned
    matrix = np.zeros((by_tau + arms, len(target)))
    for block, block_rows in zip(blocks, rows_of_blocks, strict=True):
        rows = slice(first, first + len(block_rows.target))
        index = solution.groups.index(block.arm_group)
        for name, column in zip(block.fixed_names, block_rows.fixed.T, strict=True):
            matrix[stack.names.index(name), rows] = column
        matrix[q + index * arms : q + (index + 1) * arms, rows] = block_rows.arms.T
        np.multiply(solution.arms[index][:, None], block_rows.d_arms.T, out=matrix[by_tau:, rows])
        first = rows.stop
    names = list(solution.fixed_names)
    for group in solution.groups:
        kind, separator, test_index = group.partition("@")
        names += [f"{kind}_{j}{separator}{test_index}" for j in range(1, solution.order + 1)]
    names += [f"ln_tau_{j}" for j in range(1, solution.order + 1)]
    return Jacobian(tuple(names), matrix.T, target - solution.beta @ matrix[:by_tau])


def _validate_blocks(blocks: Sequence[DataBlock], arms: int) -> Stack:
    if arms < 0:
        raise FitError(f"arms = {arms}; expected a number >= 0")
    if not blocks:
        raise FitError("nothing to fit: expected at least one block of data")
    stack = Stack(blocks)
    unknown = len(stack.names) + arms * (1 + len(stack.groups))
    if stack.samples + stack.known < unknown:
        raise FitError(
            f"{stack.samples} samples cannot determine {unknown} parameters; "
            "use fewer arms or a longer record"
        )
    return stack


def _make_solution(chain: ArmInsertion, order: int, *, requested: int) -> Solution:
    return _solution(
        chain.stack,
        chain.best[order],
        requested=requested,
        evaluations=chain.stack.trials,
        signed=chain.signed,
    )


def _from_start(stack: Stack, start: FloatArray, arms: int, *, signed: bool) -> Solution:
    if len(start) != arms:
        raise FitError(f"{arms} arms need {arms} starting values of ln tau, found {len(start)}")
    local = descend(stack, start)
    if local is not None and not signed:
        restricted = stack.get_nonnegative_mask(arms, signed=False)
        if (local.point.beta[restricted] < 0).any():
            local = descend(stack, start, restricted=restricted)
    if local is None:
        raise FitError(
            "the columns at the start are not independent; start from different relaxation times"
        )
    return _solution(stack, local, requested=arms, evaluations=stack.trials, signed=signed)


def _resolve_exactly(
    stack: Stack, local: LocalOptimum[StackTrial]
) -> tuple[Stack, LocalOptimum[StackTrial]]:
    """Finish on every sample if the residual is too small for the compressed form to hold it."""
    if stack.floor + local.point.sse > MIN_RESOLVED_SHARE * (stack.floor + stack.energy):
        return stack, local
    exact_stack = Stack([block.exact for block in stack.blocks])
    is_zero = local.point.beta == 0
    if not len(local.point.log_tau) or is_zero.any():
        return stack, local
    exact_optimum = descend(exact_stack, local.point.log_tau)
    return (stack, local) if exact_optimum is None else (exact_stack, exact_optimum)


def _solution(
    stack: Stack, local: LocalOptimum[StackTrial], *, requested: int, evaluations: int, signed: bool
) -> Solution:
    stack, local = _resolve_exactly(stack, local)
    point = local.point
    order = np.argsort(point.log_tau, kind="stable")
    log_tau = point.log_tau[order]
    q = len(stack.names)
    low, high = stack.bounds
    at_bound = (log_tau <= low + 1e-9) | (log_tau >= high - 1e-9)
    sse = stack.floor + float(point.sse)
    return Solution(
        log_tau=log_tau,
        groups=stack.groups,
        arms=point.beta[q:].reshape(len(stack.groups), len(log_tau))[:, order],
        fixed_names=stack.names,
        fixed=point.beta[:q],
        sse=sse,
        samples=stack.samples,
        requested_arms=requested,
        evaluations=evaluations,
        converged=local.converged and not bool(at_bound.any()),
        relative_offset=relative_offset(point, sse),
        at_bound=at_bound,
        bounds=stack.bounds,
        signed=signed,
    )


# Optimality certificate: distance to the best positive spectrum.


CERTIFICATE_GRID = 96
CERTIFICATE_ROUNDS = 3
MERGE_DISTANCE = 0.1
CERTAIN_GAP = 1e-6


@dataclass(frozen=True)
class OptimalityCertificate:
    r"""Bounds of the gain by one more arm, or by any number of arms.

    Attributes
    ----------
    optimal : bool
        No positive spectrum whatever, in the window, has an SSE lower by 1e-6 of it.
    gap : float
        (SSE - SSE of the best positive spectrum with any number of arms) / SSE, >= 0.
    dual_gradient : float
        :math:`\max_\tau D(\tau)/|r|`, the cosine between the residual and the best further
        column, what is already fitted swept out; <= 0 proves that the gap is zero.
    tau : float or None
        Time of that maximum, s; None if no further arm would gain anything.
    """

    optimal: bool
    gap: float
    dual_gradient: float
    tau: float | None


def certificate(blocks: Sequence[DataBlock], solution: Solution) -> OptimalityCertificate:
    r"""Compare a solution with the best spectrum of non-negative arms of any number.

    If :math:`D(\tau) = \hat\varphi(\tau)' r \le 0` for all tau, the residual r satisfies the
    optimality conditions of the convex problem over all positive measures, so no positive
    model with any number of arms has a smaller SSE (section 4.3 of N. Boyd, G. Schiebinger,
    B. Recht, *SIAM J. Optim.* 27, 2017). Otherwise the convex problem is solved on a grid of
    ln tau that holds the solution's own arms, refined around its support, and polished off it.
    """
    stack = Stack(blocks)
    groups = len(stack.groups)
    # k_inf resting at zero is no free direction: its column then is not swept out
    is_free = ~(stack.get_nonnegative_mask(0, signed=False) & (solution.fixed == 0))
    grid, support = np.linspace(*stack.bounds, CERTIFICATE_GRID), solution.log_tau
    best_sse, remainder, dual_gradient, best_log_tau = np.inf, 0.0, -np.inf, 0.0
    for round_ in range(CERTIFICATE_ROUNDS):
        log_tau = np.concatenate((solution.log_tau, grid))
        is_support = np.append(np.ones(solution.order, bool), np.isin(grid, support))
        support_grid = Grid(stack, log_tau=log_tau, is_free=is_free, likely_positive=is_support)
        if round_ == 0:
            length = support_grid.length.reshape(groups, -1)[:, : solution.order]
            values = np.zeros((groups, len(log_tau)))
            values[:, : solution.order] = solution.arms * np.where(np.isfinite(length), length, 0.0)
            residual = support_grid.aim - support_grid.columns @ values.ravel()
            remainder = float(residual @ residual)
            group_gradient = (support_grid.columns.T @ residual).reshape(groups, -1).max(axis=0)
            dual_gradient, best_log_tau = (
                float(group_gradient.max()),
                float(log_tau[np.argmax(group_gradient)]),
            )
        best_sse = min(best_sse, support_grid.residual_sse)
        weight = support_grid.spectrum.sum(axis=0)
        support = log_tau[weight > 0]
        grid = _make_refined_grid(support, round_, stack.bounds)
    sse = stack.floor + remainder
    # of a gap that is seen a few digits will do
    cost_tolerance = 1e-3 * max(CERTAIN_GAP, (remainder - best_sse) / sse if sse > 0 else 0.0)
    best_sse = min(best_sse, _compute_merged_sse(stack, log_tau, weight, cost_tolerance))
    optimality_gap = (
        0.0 if remainder <= stack.rounding_sse else max(0.0, remainder - best_sse) / sse
    )
    optimal = optimality_gap <= CERTAIN_GAP
    return OptimalityCertificate(
        optimal=optimal,
        gap=float(optimality_gap),
        dual_gradient=float(dual_gradient / np.sqrt(sse)) if sse > 0 else 0.0,
        tau=None if optimal else float(np.exp(best_log_tau)),
    )


def _make_refined_grid(support: FloatArray, round_: int, bounds: tuple[float, float]) -> FloatArray:
    """Return the support of a spectrum, and a finer grid around each of its points."""
    step = (bounds[1] - bounds[0]) / CERTIFICATE_GRID / 8.0**round_
    fine_log_tau = support[:, None] + step * np.arange(-8, 9) / 8
    return np.array(sorted({*np.clip(fine_log_tau, *bounds).flat, *bounds}))


def _compute_merged_sse(
    stack: Stack, grid: FloatArray, weight: FloatArray, cost_tolerance: float
) -> float:
    """SSE after the spectrum's arms, neighbours merged, have moved off the grid together.

    To `cost_tolerance`, a part of it.
    """
    order = np.flatnonzero(weight > 0)
    order = order[np.argsort(grid[order], kind="stable")]
    if not len(order):
        return np.inf
    runs = np.split(order, np.flatnonzero(np.diff(grid[order]) > MERGE_DISTANCE) + 1)
    start = np.array([weight[run] @ grid[run] / weight[run].sum() for run in runs])
    restricted = stack.get_nonnegative_mask(len(start), signed=False)
    local = descend(stack, start, restricted=restricted, cost_tolerance=cost_tolerance)
    return np.inf if local is None else local.point.sse
