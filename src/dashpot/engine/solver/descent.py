r"""From one start to the nearest optimum in ln tau, linear parameters solved exactly on the way."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.engine.blocks.block import Block, stiffnesses
from dashpot.engine.solver.nnls import nonnegative_columns

LONGEST_STEP = 1.5
TAIL = 1e-5
NEAR = 0.1
#: steps shorter than this change the gradient by rounding only
ROUNDING = 1e-7
#: Gauss-Newton that converges creeps when a step is more than this part of the last
SLOW = 1e-3
FINISHED = 1e-11
#: so short a step changes the linear parameters in proportion, to rounding
LINEAR = 1e-6
#: what then may be left of ln tau
REST = 1e-9
#: a step so little damped promises what there is to gain
DAMPED = 1e-3
#: and by how much, in parts of it, the SSE may fall
UNCHANGED = 1e-12


class Rows(NamedTuple):
    """A whole stack at one ln tau: y (n,), Phi (n, p), and dPhi/d ln tau of the arms' columns."""

    target: FloatArray
    phi: FloatArray
    slope: FloatArray


class Stack:
    """Blocks on top of each other, their columns matched by name and group.

    The linear parameters stand as all fixed names, then the arms of the first group, of the
    second, and so on: p = q + G N.
    """

    def __init__(self, blocks: Sequence[Block]) -> None:
        self.blocks = tuple(blocks)
        self.names = tuple(dict.fromkeys(n for block in blocks for n in block.fixed_names))
        self.groups = tuple(dict.fromkeys(block.arm_group for block in blocks))
        self.floor = float(sum(block.floor for block in blocks))
        self.samples = sum(block.samples for block in blocks)
        shortest = min(block.window[0] for block in blocks)
        longest = max(block.window[1] for block in blocks)
        self.bounds = (float(np.log(shortest)), float(np.log(longest)))
        #: how often :func:`point_at` was asked
        self.trials = 0
        #: stacks of equal sampling have equal columns
        self.sampling = blocks[0].sampling if len(blocks) == 1 else None
        #: the blocks' coordinates depend on tau, so only columns evaluated together compare
        self.rotated_basis = any(block.rotated_basis for block in blocks)
        #: sum of squares below which a residual is rounding
        self.rounding_floor = float(sum(block.rounding_floor for block in blocks))

    @cached_property
    def energy(self) -> float:
        """Sum of squares of the target."""
        return float(sum(block.energy for block in self.blocks))

    @property
    def nothing(self) -> float:
        """Sum of squares that a finished descent leaves of exact data."""
        return max(self.rounding_floor, FINISHED**2 * self.energy)

    def restricted(self, arms: int, *, signed: bool) -> BoolArray:
        """Which linear parameters must not be negative, shape (p,)."""
        every = np.ones(len(self.names) + arms * len(self.groups), dtype=bool)
        every[: len(self.names)] = stiffnesses(self.names)
        return every & (not signed)

    def evaluate(self, log_tau: FloatArray, *, derivative: bool = True) -> Rows:
        """Return the stacked target, design matrix and slopes."""
        if len(self.blocks) == 1:
            one = self.blocks[0].evaluate(log_tau, derivative)
            # columns stand as contiguous rows, turned: that is how they are made and factored
            return Rows(one.target, np.concatenate((one.fixed.T, one.arms.T)).T, one.d_arms)
        parts = [block.evaluate(log_tau, derivative) for block in self.blocks]
        rows = sum(len(part.target) for part in parts)
        arms, q = len(log_tau), len(self.names)
        phi = np.zeros((rows, q + arms * len(self.groups)))
        slope = np.zeros((rows, arms * len(self.groups)))
        first = 0
        for block, part in zip(self.blocks, parts, strict=True):
            here = slice(first, first + len(part.target))
            group = arms * self.groups.index(block.arm_group)
            phi[here, [self.names.index(name) for name in block.fixed_names]] = part.fixed
            phi[here, q + group : q + group + arms] = part.arms
            slope[here, group : group + arms] = part.d_arms
            first = here.stop
        return Rows(np.concatenate([part.target for part in parts]), phi, slope)


class Point(NamedTuple):
    r"""One trial of ln tau with everything linear solved.

    `gradient` is J'r and `curvature` J'J of the reduced residual, both per ln tau, `turn`
    (p, N) the derivative of beta by ln tau; `sse` is without the stack's floor.
    """

    log_tau: FloatArray
    beta: FloatArray
    sse: float
    gradient: FloatArray
    curvature: FloatArray
    turn: FloatArray

    def ahead(self, step: FloatArray) -> Point:
        """The point a short step away, where beta is linear and the SSE is flat."""
        return self._replace(log_tau=self.log_tau + step, beta=self.beta + self.turn @ step)


class Local(NamedTuple):
    """Where a descent ended."""

    point: Point
    evaluations: int
    converged: bool


def point_at(
    stack: Stack, log_tau: FloatArray, *, restricted: BoolArray | None = None
) -> Point | None:
    r"""Solve the linear parameters at ln tau and differentiate the residual left over.

    With Phi = QR, r = (I - QQ')y and beta = R^{-1}Q'y, the derivative of r by ln tau_j is

    .. math:: J_j = -(I - QQ') D_j \beta_j - Q R^{-T} e_j (D_j' r)

    (G. H. Golub and V. Pereyra, *SIAM J. Numer. Anal.* 10, 1973); arms shared by several
    groups add up. The two terms are orthogonal, and only the first meets r. Everything that
    they need stands in the triangular factor of one QR,

    .. math:: [\Phi, D, y] \to
        \begin{bmatrix} R & Q'D & Q'y \\ 0 & D_\perp & r \end{bmatrix}

    where D_perp and r are in coordinates orthogonal to Q. In the same letters

    .. math:: \frac{\partial\beta}{\partial\ln\tau_j}
        = -R^{-1} Q' D_j \beta_j + R^{-1} R^{-T} e_j (D_j' r)

    With `restricted`, those coefficients are kept >= 0; an arm at zero has no derivative.
    Returns None if the columns are dependent to 13 digits.
    """
    stack.trials += 1
    target, phi, slope = stack.evaluate(log_tau)
    fixed = phi.shape[1] - slope.shape[1]
    active = None if restricted is None else nonnegative_columns(phi, target, restricted)
    used = phi if active is None else phi[:, active]
    p, arms = used.shape[1], len(log_tau)
    factor = triangle(np.concatenate((used.T, slope.T, target[None])))
    r = factor[:p, :p]
    pivot = r.diagonal()
    if len(factor) < p or (pivot * pivot <= 1e-26 * (r * r).sum(axis=0)).any():
        return None
    inverse: FloatArray = np.linalg.inv(r).astype(float, copy=False)
    beta = inverse @ factor[:p, -1]
    along = inverse @ factor[:p, p:-1]
    towards = inverse
    if active is not None:
        beta, along, towards = (_spread(active, each) for each in (beta, along, inverse))
    k, residual, outside = beta[fixed:], factor[p:, -1], factor[p:, p:-1]
    dual_gradient = residual @ outside
    inside = towards[fixed:] * dual_gradient[:, None]
    outside, along = outside * k, along * k
    dual_gradient = k * dual_gradient
    if len(k) > arms:
        dual_gradient = dual_gradient.reshape(-1, arms).sum(axis=0)
        inside = inside.reshape(-1, arms, p).sum(axis=0)
        outside = outside.reshape(len(outside), -1, arms).sum(axis=1)
        along = along.reshape(len(along), -1, arms).sum(axis=1)
    return Point(
        log_tau,
        beta,
        float(residual @ residual),
        -dual_gradient,
        outside.T @ outside + inside @ inside.T,
        towards @ inside.T - along,
    )


def triangle(columns: FloatArray) -> FloatArray:
    """The upper triangular factor of a matrix given by its columns, shape (c, n)."""
    raw: FloatArray = np.linalg.qr(columns.T, mode="raw")[0]
    c = len(columns)
    return np.asarray(raw.T[:c] * _upper(c)[: raw.shape[1]])


@lru_cache(maxsize=64)
def _upper(size: int) -> FloatArray:
    return np.triu(np.ones((size, size)))


def _spread(active: BoolArray, values: FloatArray) -> FloatArray:
    """Values of the active columns in their places among all, zero elsewhere."""
    out = np.zeros((len(active), *values.shape[1:]))
    out[active] = values
    return out


def descend(
    stack: Stack,
    start: FloatArray,
    *,
    restricted: BoolArray | None = None,
    rivals: Sequence[FloatArray] = (),
    finished: float = FINISHED,
    flat: float = 0.0,
    damping: float = 1e-3,
    limit: int = 60,
) -> Local | None:
    r"""Levenberg-Marquardt in ln tau with steps of at most 1.5, inside the stack's window.

    Far away a step must lower the SSE; within 1e-5 the SSE is flat to its last digits, so the
    undamped step itself decides: the descent ends when it falls below `finished`, or when, at
    the rate of the last steps, next to nothing is left of it. Where the residual is large J'J is
    a poor Hessian and such steps only creep; what the gradients say it lacks is then learned
    from step to step (as in J. E. Dennis, D. M. Gay, R. E. Welsch, *ACM Trans. Math. Softw.* 7,
    1981, with the symmetric rank-one update).

    With `flat` it ends where a step promises to lower the SSE by less than that part of it.

    Returns None when it runs into one of the `rivals` (optima already known) or when the
    start cannot be evaluated.
    """
    low, high = stack.bounds
    here = point_at(stack, np.clip(np.sort(start), low, high), restricted=restricted)
    if here is None:
        return None
    rounding_floor = stack.rounding_floor
    lacking: FloatArray | None = None
    last = np.inf
    for count in range(2, limit + 2):
        trial = here.log_tau + _step(here, lacking, damping, low, high)
        if not all(low <= value <= high for value in trial.tolist()):
            trial = np.clip(trial, low, high)
        step = trial - here.log_tau
        moved = max(map(abs, step.tolist()), default=0.0)
        fall, sse = abs(float(here.gradient @ step)), stack.floor + here.sse
        if moved <= finished or (fall < flat * sse and damping <= DAMPED):
            return Local(here, count, True)
        if (
            damping < LINEAR
            and moved <= LINEAR
            and moved * moved <= REST * last
            and fall <= UNCHANGED * sse
        ):
            return Local(here.ahead(step), count, True)
        new = point_at(stack, trial, restricted=restricted)
        tail = moved < TAIL
        if new is not None and (
            new.sse < here.sse or (tail and new.sse <= here.sse * (1 + 1e-8) + rounding_floor)
        ):
            if ROUNDING < moved < NEAR and moved > SLOW * last:
                lacking = _learned(lacking, here, new)
            last = moved
            here = new
            damping = 0.0 if tail else 0.1 * damping
            if new.sse <= rounding_floor:
                return Local(here, count, True)
        else:
            if tail and damping == 0.0:
                return Local(here, count, True)
            damping = 10 * max(damping, 1e-6)
            if damping > 1e9:
                return Local(here, count, False)
        if rivals and any(np.abs(np.sort(here.log_tau) - rival).max() < 1e-2 for rival in rivals):
            return None
    return Local(here, limit, False)


def _learned(lacking: FloatArray | None, old: Point, new: Point) -> FloatArray | None:
    """What the Hessian holds beyond J'J, corrected so that it explains the last step."""
    moved = new.log_tau - old.log_tau
    missed = new.gradient - old.gradient - new.curvature @ moved
    if lacking is not None:
        missed = missed - lacking @ moved
    along = float(missed @ moved)
    if along * along <= 1e-16 * float((missed @ missed) * (moved @ moved)):
        return lacking
    update = np.outer(missed, missed) / along
    return update if lacking is None else lacking + update


def _step(
    point: Point, lacking: FloatArray | None, damping: float, low: float, high: float
) -> FloatArray:
    """The damped step, with arms held that press against the window or carry nothing."""
    gradient, curvature = point.gradient, point.curvature
    scale = curvature.diagonal()
    # an estimate that would turn the step uphill is no Hessian
    if lacking is not None:
        hessian = curvature + lacking
        if np.linalg.eigvalsh(hessian)[0] > 1e-3 * scale.min():
            curvature = hessian
    ridge = max(damping, 1e-15) * scale
    at = point.log_tau
    if all(low < value < high for value in at.tolist()) and all(scale.tolist()):
        step = _solved(curvature, gradient, ridge)
    else:
        free = scale > 0
        free &= ~((at <= low) & (gradient > 0))
        free &= ~((at >= high) & (gradient < 0))
        index = np.flatnonzero(free)
        step = np.zeros(len(gradient))
        if not len(index):
            return step
        part = curvature[index[:, None], index]
        step[index] = _solved(part, gradient[index], ridge[index])
    longest = max(map(abs, step.tolist()))
    return step if longest <= LONGEST_STEP else np.clip(step, -LONGEST_STEP, LONGEST_STEP)


def _solved(curvature: FloatArray, gradient: FloatArray, ridge: FloatArray) -> FloatArray:
    try:
        return np.asarray(-np.linalg.solve(curvature + np.diag(ridge), gradient))
    except np.linalg.LinAlgError:
        return np.asarray(-gradient / (curvature.diagonal() + ridge))


def relative_offset(point: Point, sse: float) -> float:
    r"""The length of the residual that a Gauss-Newton step would still remove, over |r|.

    The criterion of D. M. Bates and D. G. Watts, *Technometrics* 23 (1981).
    """
    if not len(point.gradient) or sse <= 0:
        return 0.0
    try:
        step = np.linalg.solve(point.curvature, point.gradient)
    except np.linalg.LinAlgError:
        step = np.linalg.lstsq(point.curvature, point.gradient, rcond=1e-14)[0]
    return float(np.sqrt(abs(point.gradient @ step) / sse))
