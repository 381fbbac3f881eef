"""The best sum of exponentials in a stack of blocks, without a guess."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import BoolArray, EqualByValue, FloatArray, FrozenArrays
from dashpot.base.errors import FitError
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.arm_insertion import ArmInsertion
from dashpot.numerics.exponential_fit.log_tau_descent import (
    Stack,
    StackTrial,
    descend,
    relative_offset,
)
from dashpot.numerics.least_squares.levenberg_marquardt import LocalOptimum

RESOLVED = 1e-9


@dataclass(frozen=True, eq=False)
class Solution(FrozenArrays):
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
        """The coefficient of a fixed column by its name."""
        return float(self.fixed[self.fixed_names.index(name)])


@dataclass(frozen=True, eq=False)
class Jacobian(EqualByValue):
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
    blocks: Sequence[DataBlock],
    arms: int,
    *,
    log_tau_start: FloatArray | None = None,
    near: FloatArray | None = None,
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
        One start of your own; without it the engine finds the starts.
    near : array, shape (arms,), optional
        Where an optimum may be: next to it no other start is tried, if no positive spectrum with
        any number of arms would gain `negligible` noise variances on what is there.
    negligible : float
        Of arms beyond those that could gain so many noise variances one start is enough.
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
    stack = _validate_blocks(blocks, arms)
    if log_tau_start is not None:
        return _from_start(stack, np.asarray(log_tau_start, dtype=float), arms, signed=signed)
    chain = ArmInsertion(stack, thorough=thorough, signed=signed, seed=seed)
    if near is not None and arms and chain.as_good_near(near, negligible=negligible):
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
    every: bool = False,
    thorough: bool = False,
) -> tuple[Solution, ...]:
    """Return the optimum for none, 1, 2, ... `max_arms` exponentials, from one chain.

    The tuple ends where a further arm with k > 0 no longer lowers the SSE. With `negligible` it
    also ends one order after the first that is within so many noise variances of the best
    positive spectrum with any number of arms, so that no order left out could gain more; unless
    `every` one is wanted, which is then found from a single start.
    """
    stack = _validate_blocks(blocks, max_arms)
    chain = ArmInsertion(stack, thorough=thorough, signed=False, seed=0)
    chain.extend(max_arms, negligible=negligible, every=every)
    return tuple(_make_solution(chain, n, requested=n) for n in range(chain.largest_order + 1))


def full_jacobian(blocks: Sequence[DataBlock], solution: Solution) -> Jacobian:
    r"""Residual and derivative of the model by all parameters, linear ones and ln tau.

    The inverse of J'J times the noise variance is the covariance for white noise.
    """
    stack, arms, q = Stack(blocks), solution.order, len(solution.fixed_names)
    parts = [block.evaluate(solution.log_tau) for block in blocks]
    target = np.concatenate([part.target for part in parts])
    first, by_tau = 0, q + solution.arms.size
    # columns stand as contiguous rows, turned
    matrix = np.zeros((by_tau + arms, len(target)))
    for block, part in zip(blocks, parts, strict=True):
        here = slice(first, first + len(part.target))
        index = solution.groups.index(block.arm_group)
        for name, column in zip(block.fixed_names, part.fixed.T, strict=True):
            matrix[stack.names.index(name), here] = column
        matrix[q + index * arms : q + (index + 1) * arms, here] = part.arms.T
        np.multiply(solution.arms[index][:, None], part.d_arms.T, out=matrix[by_tau:, here])
        first = here.stop
    names = list(solution.fixed_names)
    for group in solution.groups:
        kind, at, where = group.partition("@")
        names += [f"{kind}_{j}{at}{where}" for j in range(1, solution.order + 1)]
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
    if stack.floor + local.point.sse > RESOLVED * (stack.floor + stack.energy):
        return stack, local
    exact = Stack([block.exact for block in stack.blocks])
    resting = local.point.beta == 0
    if not len(local.point.log_tau) or resting.any():
        return stack, local
    finer = descend(exact, local.point.log_tau)
    return (stack, local) if finer is None else (exact, finer)


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
        requested=requested,
        evaluations=evaluations,
        converged=local.converged and not bool(at_bound.any()),
        relative_offset=relative_offset(point, sse),
        at_bound=at_bound,
        bounds=stack.bounds,
        signed=signed,
    )
