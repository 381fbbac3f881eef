r"""From one start to the nearest optimum in ln tau, linear parameters solved exactly on the way."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.engine.blocks.block import Block, stiffnesses
from dashpot.engine.solver.nnls import nonnegative_columns

if TYPE_CHECKING:
    from dashpot.engine.blocks.families import Family, Reduced

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
#: after a step that was refused none goes farther than this part of it
NEARER = 0.5
#: a step so little damped promises what there is to gain
DAMPED = 1e-3
#: and by how much, in parts of it, the SSE may fall
UNCHANGED = 1e-12
#: so many steps with a coefficient of the wrong sign lead to none of the right one
PATIENCE = 12


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
        self.floor = sum(block.floor for block in blocks)
        #: of the data: what was known before is not a sample
        self.samples = sum(block.samples for block in blocks if block.variance is None)
        #: what was known before, in rows
        self.known = sum(block.samples for block in blocks) - self.samples
        shortest, longest = zip(*(block.window for block in blocks), strict=True)
        self.bounds = (float(np.log(min(shortest))), float(np.log(max(longest))))
        #: how often :func:`point_at` was asked
        self.trials = 0
        #: stacks of equal sampling have equal columns
        self.sampling = blocks[0].sampling if len(blocks) == 1 else None

    @cached_property
    def rotated_basis(self) -> bool:
        """The blocks' coordinates depend on tau, so only columns evaluated together compare."""
        return any(block.rotated_basis for block in self.blocks)

    @cached_property
    def rounding_floor(self) -> float:
        """Sum of squares below which a residual is rounding."""
        return float(sum(block.rounding_floor for block in self.blocks))

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
        # columns stand as contiguous rows, turned: that is how they are made and factored
        if len(self.blocks) == 1:
            one = self.blocks[0].evaluate(log_tau, derivative)
            return Rows(one.target, np.concatenate((one.fixed.T, one.arms.T)).T, one.d_arms)
        parts = [block.evaluate(log_tau, derivative) for block in self.blocks]
        rows = sum(len(part.target) for part in parts)
        arms, q = len(log_tau), len(self.names)
        phi = np.zeros((q + arms * len(self.groups), rows))
        slope = np.zeros((arms * len(self.groups), rows))
        first = 0
        for block, part in zip(self.blocks, parts, strict=True):
            here = slice(first, first + len(part.target))
            group = arms * self.groups.index(block.arm_group)
            for name, column in zip(block.fixed_names, part.fixed.T, strict=True):
                phi[self.names.index(name), here] = column
            phi[q + group : q + group + arms, here] = part.arms.T
            if derivative:
                slope[group : group + arms, here] = part.d_arms.T
            first = here.stop
        return Rows(np.concatenate([part.target for part in parts]), phi.T, slope.T)


class Point(NamedTuple):
    r"""One trial of ln tau with everything linear solved; of each record, if axes lead.

    `gradient` is J'r and `curvature` J'J of the reduced residual, both per ln tau, `turn`
    (p, N) the derivative of beta by ln tau; `sse` is without the floor, infinite where the columns
    are dependent and the rest says nothing.
    """

    log_tau: FloatArray
    beta: FloatArray
    sse: Any  # a number, or one of each record
    gradient: FloatArray
    curvature: FloatArray
    turn: FloatArray

    @classmethod
    def of(
        cls, log_tau: FloatArray, factor: FloatArray, fixed: int, active: BoolArray | None = None
    ) -> Point:
        r"""From the triangular factor of the `active` columns, the slopes and the target.

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
        """
        arms, slopes = log_tau.shape[-1], factor.shape[-1] - 1
        p = fixed + (slopes - fixed) // 2 if active is None else int(active.sum())
        inverse = np.asarray(np.linalg.inv(factor[..., :p, :p]), dtype=float)
        beta = (inverse @ factor[..., :p, -1:])[..., 0]
        along = inverse @ factor[..., :p, p:-1]
        towards = inverse
        if active is not None:
            beta, along, towards = (_spread(active, each) for each in (beta, along, inverse))
        residual, outside = factor[..., p:, -1], factor[..., p:, p:-1]
        k = beta[..., fixed:]
        outward = (residual[..., None, :] @ outside)[..., 0, :]
        inside = towards[..., fixed:, :] * outward[..., None]
        scale = k[..., None, :]
        outside, along = outside * scale, along * scale
        gradient = -k * outward
        if k.shape[-1] > arms:
            gradient = gradient.reshape(-1, arms).sum(axis=0)
            inside = inside.reshape(-1, arms, p).sum(axis=0)
            outside = outside.reshape(len(outside), -1, arms).sum(axis=1)
            along = along.reshape(len(along), -1, arms).sum(axis=1)
        turned = inside.swapaxes(-1, -2)
        curvature = outside.swapaxes(-1, -2) @ outside + inside @ turned
        # a Python number is compared faster
        sse = np.vecdot(residual, residual) if residual.ndim > 1 else float(residual @ residual)
        return cls(log_tau, beta, sse, gradient, curvature, towards @ turned - along)

    def ahead(self, step: FloatArray) -> Point:
        """The point a short step away, where beta is linear and the SSE is flat."""
        turned = (self.turn @ step[..., None])[..., 0]
        return self._replace(log_tau=self.log_tau + step, beta=self.beta + turned)

    def take(self, index: IndexArray | BoolArray) -> Point:
        """Copies of some records."""
        return Point(*(part[index] for part in self))

    def put(self, index: IndexArray, new: Point) -> None:
        """Write some records anew."""
        for old, fresh in zip(self, new, strict=True):
            old[index] = fresh


class Local(NamedTuple):
    """Where a descent ended."""

    point: Point
    evaluations: int
    converged: bool


def point_at(stack: Stack, log_tau: FloatArray, *, restricted: BoolArray | None = None) -> Point:
    r"""Solve the linear parameters at ln tau and differentiate the residual left over.

    With `restricted`, those coefficients are kept >= 0; an arm at zero has no derivative.
    Columns that are dependent to 13 digits have an infinite SSE.
    """
    stack.trials += 1
    rows = stack.evaluate(log_tau)
    free = _point(log_tau, rows)
    # what is allowed without being told so is the best of all that is
    if restricted is None or (free.sse < np.inf and (free.beta[restricted] > 0).all()):
        return free
    return _point(log_tau, rows, nonnegative_columns(rows.phi, rows.target, restricted))


def _point(log_tau: FloatArray, rows: Rows, active: BoolArray | None = None) -> Point:
    """The point of some columns, all by default; an infinite SSE if they are dependent."""
    target, phi, slope = rows
    fixed = phi.shape[1] - slope.shape[1]
    used = phi if active is None else phi[:, active]
    p = used.shape[1]
    factor = triangle(np.concatenate((used.T, slope.T, target[None])))
    r = factor[:p, :p]
    pivot = r.diagonal()
    if len(factor) < p or (pivot * pivot <= 1e-26 * np.vecdot(r.T, r.T)).any():
        return _nowhere(log_tau, phi.shape[1])
    return Point.of(log_tau, factor, fixed, active)


def _nowhere(log_tau: FloatArray, p: int) -> Point:
    n = len(log_tau)
    return Point(log_tau, np.zeros(p), np.inf, np.zeros(n), np.zeros((n, n)), np.zeros((p, n)))


def triangle(columns: FloatArray) -> FloatArray:
    """The upper triangular factor of a matrix given by its columns, shape (c, n)."""
    raw: FloatArray = np.linalg.qr(columns.T, mode="raw")[0]
    c = len(columns)
    return np.asarray(raw.T[:c] * _upper(c)[: raw.shape[1]])


@lru_cache(maxsize=64)
def _upper(size: int) -> FloatArray:
    return np.triu(np.ones((size, size)))


_unit = lru_cache(maxsize=64)(np.eye)


def _spread(active: BoolArray, values: FloatArray) -> FloatArray:
    """Values of the active columns in their places among all, zero elsewhere."""
    out = np.zeros((len(active), *values.shape[1:]))
    out[active] = values
    return out


def accepted(new: Any, old: Any, moved: Any, rounding: Any) -> Any:
    """Far away a step must lower the SSE; near the end, where it is flat, not raise it."""
    return (new < old) | ((moved < TAIL) & (new <= old * (1 + 1e-8) + rounding))


def settled(moved: Any, last: Any, fall: Any, sse: Any) -> Any:
    """At the rate of the last undamped steps next to nothing is left, of ln tau and of the SSE."""
    return (moved <= LINEAR) & (moved * moved <= REST * last) & (fall <= UNCHANGED * sse)


def descend(
    stack: Stack,
    start: FloatArray,
    *,
    restricted: BoolArray | None = None,
    wanted: BoolArray | None = None,
    rivals: Sequence[FloatArray] = (),
    finished: float = FINISHED,
    flat: float = 0.0,
    damping: float = 1e-3,
    limit: int = 60,
) -> Local | None:
    r"""Levenberg-Marquardt in ln tau with steps of at most 1.5, inside the stack's window.

    Far away a step must lower the SSE; within 1e-5 the SSE is flat to its last digits, so the
    undamped step itself decides: the descent ends when it falls below `finished`, or when, at
    the rate of the last steps, next to nothing is left of it, or when a step that promised no more
    than rounding is refused. Where the residual is large J'J is
    a poor Hessian and such steps only creep; what the gradients say it lacks is then learned
    from step to step (as in J. E. Dennis, D. M. Gay, R. E. Welsch, *ACM Trans. Math. Softw.* 7,
    1981, with the symmetric rank-one update).

    With `flat` it ends where a step promises to lower the SSE by less than that part of it. A
    descent on which coefficients that are `wanted` positive have long been negative, such as two
    arms that merge with ever larger coefficients of opposite sign, ends there.

    Returns None when it runs into one of the `rivals` (optima already known) or when the
    start cannot be evaluated.
    """
    low, high = stack.bounds
    here = point_at(stack, np.clip(np.sort(start), low, high), restricted=restricted)
    if here.sse == np.inf:
        return None
    rounding = stack.rounding_floor
    lacking: FloatArray | None = None
    last, wrong, refused = np.inf, 0, np.inf
    for count in range(2, limit + 2):
        trial = _trial(here, lacking, damping, (low, high))
        step = trial - here.log_tau
        moved = max(map(abs, step.tolist()), default=0.0)
        # much the step that was refused
        while TAIL < NEARER * refused < moved:
            damping *= 10
            trial = _trial(here, lacking, damping, (low, high))
            step = trial - here.log_tau
            moved = max(map(abs, step.tolist()), default=0.0)
        refused = np.inf
        fall, sse = abs(float(here.gradient @ step)), stack.floor + here.sse
        if moved <= finished or (fall < flat * sse and damping <= DAMPED):
            return Local(here, count, True)
        if damping < LINEAR and settled(moved, last, fall, sse):
            return Local(here.ahead(step), count, True)
        new = point_at(stack, trial, restricted=restricted)
        if accepted(new.sse, here.sse, moved, rounding):
            lacking = _learned(lacking, here, new, moved, last)
            last, here = moved, new
            wrong = wrong + 1 if wanted is not None and (here.beta[wanted] < 0).any() else 0
            damping = 0.1 * damping * (moved >= TAIL)
        elif (moved < TAIL and damping == 0.0) or fall <= UNCHANGED * sse:
            return Local(here, count, True)
        else:
            damping, refused = 10 * max(damping, 1e-6), moved
        if here.sse <= rounding or damping > 1e9 or wrong > PATIENCE:
            return Local(here, count, here.sse <= rounding)
        if _met(here.log_tau, rivals):
            return None
    return Local(here, limit, False)


def between(log_tau: FloatArray, bounds: tuple[float, float]) -> bool:
    """True if no relaxation time sits at an end of the window."""
    low, high = bounds
    return all(low < value < high for value in log_tau.tolist())


def _met(log_tau: FloatArray, rivals: Sequence[FloatArray]) -> bool:
    return bool(rivals) and bool(np.abs(np.sort(log_tau) - rivals).max(axis=1).min() < 1e-2)


def _learned(
    lacking: FloatArray | None, old: Point, new: Point, length: float, last: float
) -> FloatArray | None:
    """What the Hessian holds beyond J'J, corrected so that it explains a step that creeps."""
    if not (ROUNDING < length < NEAR and length > SLOW * last):
        return lacking
    moved = new.log_tau - old.log_tau
    missed = new.gradient - old.gradient - new.curvature @ moved
    if lacking is not None:
        missed = missed - lacking @ moved
    along = float(missed @ moved)
    if along * along <= 1e-16 * float((missed @ missed) * (moved @ moved)):
        return lacking
    update = np.outer(missed, missed) / along
    return update if lacking is None else lacking + update


def _trial(
    point: Point, lacking: FloatArray | None, damping: float, bounds: tuple[float, float]
) -> FloatArray:
    """Where the damped step ends, with arms held that press against the window or carry nothing."""
    (low, high), gradient, curvature = bounds, point.gradient, point.curvature
    scale = curvature.diagonal()
    # an estimate that would turn the step uphill is no Hessian
    if lacking is not None:
        hessian = curvature + lacking
        if np.linalg.eigvalsh(hessian)[0] > 1e-3 * scale.min():
            curvature = hessian
    ridge = max(damping, 1e-15) * scale
    at = point.log_tau
    if between(at, bounds) and all(scale.tolist()):
        step = _solved(curvature, gradient, ridge)
    else:
        held = ((at <= low) & (gradient > 0)) | ((at >= high) & (gradient < 0))
        index = np.flatnonzero((scale > 0) & ~held)
        step = np.zeros(len(gradient))
        part = curvature[index[:, None], index]
        step[index] = _solved(part, gradient[index], ridge[index])
    longest = max(map(abs, step.tolist()), default=0.0)
    step = step if longest <= LONGEST_STEP else np.clip(step, -LONGEST_STEP, LONGEST_STEP)
    trial = at + step
    inside = all(low <= value <= high for value in trial.tolist())
    return trial if inside else np.clip(trial, low, high)


def _solved(curvature: FloatArray, gradient: FloatArray, ridge: FloatArray) -> FloatArray:
    try:
        return np.asarray(-np.linalg.solve(curvature + ridge * _unit(len(ridge)), gradient))
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


# -- many records side by side --------------------------------------------------------------------


def points_at(
    family: Family, log_tau: FloatArray, reduced: Reduced, *, exact: bool = False
) -> Point:
    """As :func:`point_at`, one trial of each record, ln tau (R, N)."""
    q = family.fixed_count
    p = q + log_tau.shape[1]
    factor = family.factor(log_tau, reduced, exact=exact)
    r = factor[:, :p, :p]
    pivot, length = np.diagonal(r, axis1=1, axis2=2) ** 2, (r * r).sum(axis=1)
    dependent = (pivot <= 1e-13 * length).any(axis=1)
    r[dependent] = np.eye(p)
    point = Point.of(log_tau, factor, q)
    point.sse[dependent] = np.inf
    return point


def descend_together(
    family: Family, start: FloatArray, started: BoolArray, reduced: Reduced, limit: int = 40
) -> tuple[Point, BoolArray]:
    """As :func:`descend`, all records at once; where each ended, and whether at an optimum."""
    low, high = family.template.bounds
    here = points_at(family, start.copy(), reduced)
    rounding = family.rounding_floor * reduced.energy
    done = np.zeros(len(start), dtype=bool)
    damping = np.full(len(start), 1e-6)
    last = np.full(len(start), np.inf)
    active = np.flatnonzero(started & np.isfinite(here.sse))
    for _ in range(limit):
        if not len(active):
            break
        now = here.take(active)
        trial = np.clip(now.log_tau + _steps(now, damping[active]), low, high)
        step = trial - now.log_tau
        moved, fall = np.abs(step).max(axis=1), np.abs(np.vecdot(now.gradient, step))
        sse = reduced.floor[active] + now.sse
        over = (damping[active] < LINEAR) & settled(moved, last[active], fall, sse)
        over |= moved <= FINISHED
        before = now.sse
        if over.any():
            here.put(active[over], now.take(over).ahead(step[over]))
            done[active[over]] = True
            active, trial, moved, before = (x[~over] for x in (active, trial, moved, before))
        if not len(active):
            break
        new = points_at(family, trial, reduced.take(active))
        tail, better = moved < TAIL, accepted(new.sse, before, moved, rounding[active])
        taken = active[better]
        last[taken] = moved[better]
        here.put(taken, new.take(better))
        damping[taken] = np.where(tail[better], 0.0, 0.1 * damping[taken])
        stuck = ~better & tail & (damping[active] == 0.0)
        done[active[stuck]] = True
        refused = active[~better]
        damping[refused] = 10 * np.maximum(damping[refused], 1e-6)
        active = active[~stuck & (damping[active] < 1e9)]
    return here, done


def _steps(point: Point, damping: FloatArray) -> FloatArray:
    scale = np.maximum(np.diagonal(point.curvature, axis1=1, axis2=2), 1e-300)
    unit = point.curvature / np.sqrt(scale[:, :, None] * scale[:, None, :])
    unit = unit + (np.maximum(damping, 1e-14)[:, None, None]) * np.eye(scale.shape[1])
    root = np.sqrt(scale)
    step = -np.linalg.solve(unit, (point.gradient / root)[..., None])[..., 0] / root
    return np.clip(step, -LONGEST_STEP, LONGEST_STEP)
