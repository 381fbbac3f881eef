r"""From one start to the nearest optimum, by the steps of Levenberg and Marquardt.

Whatever is minimised is a function of parameters of order one, such as logarithms, inside bounds.
Everything linear is solved at every trial (:mod:`dashpot.numerics.least_squares.problem`), so that
a trial is known by its sum of squares, its gradient J'r and its curvature J'J.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Generic, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray

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
#: what then may be left of theta
REST = 1e-9
#: what carries less, as a part, has faded: its steps are damped as if it carried that
FADED = 1e-12
#: after a step that was refused none goes farther than this part of it
NEARER = 0.5
#: after one, damping falls to this part a step, and not at all where a step gained less than this
#: part of what it promised
EASED, GAINED = 0.5, 0.75
#: what was learned of the Hessian is dropped where the fall that it foretells is so far off
MISTAKEN = 0.25
#: a step so little damped promises what there is to gain
DAMPED = 1e-3
#: and by how much, in parts of it, the SSE may fall
UNCHANGED = 1e-12
#: so many steps with a coefficient of the wrong sign lead to none of the right one
PATIENCE = 12

T = TypeVar("T", bound="Trial")


class Trial(Protocol):
    """Parameters with everything linear solved.

    `theta` (p,) and `beta` (q,); the sum of squares `sse`, infinite where the model says nothing;
    `gradient` J'r (p,) and `curvature` J'J (p, p) of the reduced residual.
    """

    @property
    def theta(self) -> FloatArray: ...  # noqa: D102
    @property
    def beta(self) -> FloatArray: ...  # noqa: D102
    @property
    def sse(self) -> Any: ...  # noqa: D102
    @property
    def gradient(self) -> FloatArray: ...  # noqa: D102
    @property
    def curvature(self) -> FloatArray: ...  # noqa: D102
    def ahead(self, step: FloatArray) -> Self: ...  # noqa: D102


class Objective(NamedTuple, Generic[T]):
    """What is minimised.

    Attributes
    ----------
    at : callable
        ``at(theta, last) -> trial``, `last` the trial that the descent stands at, None at first.
    low, high : array, shape (p,)
    floor : float
        Sum of squares that no theta lowers.
    rounding : float
        Sum of squares below which a residual is rounding.
    """

    at: Callable[[FloatArray, T | None], T]
    low: FloatArray
    high: FloatArray
    floor: float = 0.0
    rounding: float = 0.0


class LocalOptimum(NamedTuple, Generic[T]):
    """Where a descent ended."""

    point: T
    evaluations: int
    converged: bool


def is_step_acceptable(new: Any, old: Any, change: Any, rounding: Any) -> Any:
    """Far away a step must lower the SSE; near the end, where it is flat, not raise it."""
    return (new < old) | ((change < TAIL) & (new <= old * (1 + 1e-8) + rounding))


def has_converged(change: Any, last: Any, fall: Any, sse: Any) -> Any:
    """At the rate of the last undamped steps next to nothing is left, of theta and of the SSE."""
    return (change <= LINEAR) & (change * change <= REST * last) & (fall <= UNCHANGED * sse)


def descend(  # noqa: C901 -- one loop, whose rules share all that it knows
    objective: Objective[T],
    start: FloatArray,
    *,
    wanted: BoolArray | None = None,
    met: Callable[[FloatArray], bool] | None = None,
    finished: float = FINISHED,
    flat: float = 0.0,
    damping: float = 1e-3,
    limit: int = 60,
) -> LocalOptimum[T] | None:
    r"""Levenberg-Marquardt with steps of at most 1.5 in every parameter, inside the bounds.

    Far away a step must lower the SSE; within 1e-5 the SSE is flat to its last digits, so the
    undamped step itself decides: the descent ends when it falls below `finished`, or when, at
    the rate of the last steps, next to nothing is left of it, or when a step that promised no more
    than rounding is refused. Where the residual is large J'J is
    a poor Hessian and such steps only creep; what the gradients say it lacks is then learned
    from step to step (as in J. E. Dennis, D. M. Gay, R. E. Welsch, *ACM Trans. Math. Softw.* 7,
    1981, with the symmetric rank-one update).

    A step that raises the SSE may only have left the floor of a valley that bends: it is taken if
    one more from where it ends leads below the start (the watchdog of R. M. Chamberlain and others,
    *Math. Programming Study* 16, 1982).

    With `flat` it ends where a step promises to lower the SSE by less than that part of it. A
    descent on which coefficients that are `wanted` positive have long been negative, such as two
    arms that merge with ever larger coefficients of opposite sign, ends there.

    Returns None when it has `met` what is known already, or where the start cannot be evaluated.
    """
    at, low, high, floor, rounding = objective
    bounds = low.tolist(), high.tolist()
    here = at(np.minimum(np.maximum(start, low), high), None)
    if here.sse == np.inf:
        return None
    lacking: FloatArray | None = None
    last, wrong, refused, wary = np.inf, 0, np.inf, False
    for count in range(2, limit + 2):
        trial = _trial(here, lacking, damping, bounds)
        step = trial - here.theta
        change = max(map(abs, step.tolist()), default=0.0)
        # much the step that was refused
        while TAIL < NEARER * refused < change:
            damping *= 10
            trial = _trial(here, lacking, damping, bounds)
            step = trial - here.theta
            change = max(map(abs, step.tolist()), default=0.0)
        refused = np.inf
        fall, sse = abs(float(here.gradient @ step)), floor + here.sse
        if change <= finished or (fall < flat * sse and damping <= DAMPED):
            return LocalOptimum(here, count, True)
        if damping < LINEAR and has_converged(change, last, fall, sse):
            return LocalOptimum(here.ahead(step), count, True)
        new = at(trial, here)
        if here.sse < new.sse < np.inf and change >= TAIL:
            # along a valley that bends the step ends on its side: from there to its floor
            floored = at(_trial(new, None, damping, bounds), new)
            if floored.sse < here.sse:
                new, step = floored, floored.theta - here.theta
                change = max(map(abs, step.tolist()))
        if is_step_acceptable(new.sse, here.sse, change, rounding):
            promised = -float(step @ (2 * here.gradient + here.curvature @ step))
            short = wary and here.sse - new.sse < GAINED * promised
            sure = change < TAIL or _foretold(lacking, here, new, step)
            lacking = _update_hessian_correction(lacking, here, new, change, last) if sure else None
            last, here = change, new
            wrong = wrong + 1 if wanted is not None and (here.beta[wanted] < 0).any() else 0
            damping *= (1.0 if short else EASED if wary else 0.1) * (change >= TAIL)
        elif (change < TAIL and damping == 0.0) or fall <= UNCHANGED * sse:
            return LocalOptimum(here, count, True)
        else:
            damping, refused, wary = 10 * max(damping, 1e-6), change, True
        if here.sse <= rounding or damping > 1e9 or wrong > PATIENCE:
            return LocalOptimum(here, count, here.sse <= rounding)
        if met is not None and met(here.theta):
            return None
    return LocalOptimum(here, limit, False)


def _foretold(lacking: FloatArray | None, old: Trial, new: Trial, step: FloatArray) -> bool:
    """Whether what was learned of the Hessian foretells by how much a step lowers the SSE."""
    if lacking is None:
        return True
    fall = -float(step @ (2 * old.gradient + (old.curvature + lacking) @ step))
    return bool(abs(old.sse - new.sse - fall) <= MISTAKEN * fall)


def _update_hessian_correction(
    lacking: FloatArray | None, old: Trial, new: Trial, length: float, last: float
) -> FloatArray | None:
    """What the Hessian holds beyond J'J, corrected so that it explains a step that creeps."""
    if not (ROUNDING < length < NEAR and length > SLOW * last):
        return lacking
    change = new.theta - old.theta
    missed = new.gradient - old.gradient - new.curvature @ change
    if lacking is not None:
        missed = missed - lacking @ change
    along = float(missed @ change)
    if along * along <= 1e-16 * float((missed @ missed) * (change @ change)):
        return lacking
    update = np.outer(missed, missed) / along
    return update if lacking is None else lacking + update


def _trial(
    point: Trial,
    lacking: FloatArray | None,
    damping: float,
    bounds: tuple[list[float], list[float]],
) -> FloatArray:
    """Where the damped step ends; held is what presses against a bound or carries nothing."""
    gradient, curvature, at = point.gradient, point.curvature, point.theta
    scale = curvature.diagonal()
    # an estimate that would turn the step uphill is no Hessian
    if lacking is not None:
        hessian = curvature + lacking
        if np.linalg.eigvalsh(hessian)[0] > 1e-3 * scale.min():
            curvature = hessian
    ridge = max(damping, 1e-15) * np.maximum(scale, FADED * scale.max(initial=0.0))
    if _is_within_bounds(at, bounds, least=False) and all(scale.tolist()):
        step = _solve_damped_step(curvature, gradient, ridge)
    else:
        low, high = map(np.array, bounds)
        held = ((at <= low) & (gradient > 0)) | ((at >= high) & (gradient < 0))
        index = np.flatnonzero((scale > 0) & ~held)
        step = np.zeros(len(gradient))
        part = curvature[index[:, None], index]
        step[index] = _solve_damped_step(part, gradient[index], ridge[index])
    longest = max(map(abs, step.tolist()), default=0.0)
    step = step if longest <= LONGEST_STEP else np.clip(step, -LONGEST_STEP, LONGEST_STEP)
    trial = at + step
    return trial if _is_within_bounds(trial, bounds, least=True) else np.clip(trial, *bounds)


def _is_within_bounds(
    at: FloatArray, bounds: tuple[list[float], list[float]], *, least: bool
) -> bool:
    """True if no parameter sits at an end of its range or, at `least`, beyond one."""
    pairs = zip(bounds[0], at.tolist(), bounds[1], strict=True)
    if least:
        return all(low <= value <= high for low, value, high in pairs)
    return all(low < value < high for low, value, high in pairs)


def _solve_damped_step(
    curvature: FloatArray, gradient: FloatArray, ridge: FloatArray
) -> FloatArray:
    try:
        return np.asarray(-np.linalg.solve(curvature + ridge * _unit(len(ridge)), gradient))
    except np.linalg.LinAlgError:
        return np.asarray(-gradient / (curvature.diagonal() + ridge))


_unit = lru_cache(maxsize=64)(np.eye)


def triangle(columns: FloatArray) -> FloatArray:
    """The upper triangular factor of a matrix given by its columns, shape (c, n)."""
    raw: FloatArray = np.linalg.qr(columns.T, mode="raw")[0]
    c = len(columns)
    return np.asarray(raw.T[:c] * _upper(c)[: raw.shape[1]])


@lru_cache(maxsize=64)
def _upper(size: int) -> FloatArray:
    return np.triu(np.ones((size, size)))
