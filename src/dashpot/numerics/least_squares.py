"""Separable least squares: models linear in some parameters, and their descent."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from typing import Any, Generic, NamedTuple, Protocol, Self, TypeAlias, TypeVar

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.errors import DataError, FitError
from dashpot.numerics.nonnegative_least_squares import solve_linear

# Descent of Levenberg and Marquardt.
#
# Whatever is minimised is a function of parameters of order one, such as logarithms, inside bounds.
# Everything linear is solved at every trial (:mod:`dashpot.numerics.least_squares`), so that a
# trial is known by its sum of squares, its gradient J'r and its curvature J'J.


LONGEST_STEP = 1.5
TAIL_CHANGE = 1e-5
NEAR_OPTIMUM = 0.1
#: steps shorter than this change the gradient by rounding only
ROUNDING = 1e-7
#: Gauss-Newton that converges creeps when a step is more than this part of the last
SLOW_RATE = 1e-3
FINAL_TOLERANCE = 1e-11
#: so short a step changes the linear parameters in proportion, to rounding
LINEAR_STEP = 1e-6
#: what then may be left of theta
THETA_TOLERANCE = 1e-9
#: what carries less, as a part, has faded: its steps are damped as if it carried that
MIN_CURVATURE_SHARE = 1e-12
#: after a step that was refused none goes farther than this part of it
STEP_REDUCTION = 0.5
#: after one, damping falls to this part a step, and not at all where a step gained less than this
#: part of what it promised
CAUTIOUS_DAMPING_FACTOR, MIN_GAIN_RATIO = 0.5, 0.75
#: what was learned of the Hessian is dropped where the fall that it foretells is so far off
MAX_PREDICTION_ERROR = 0.25
#: a step so little damped promises what there is to gain
SMALL_DAMPING = 1e-3
#: and by how much, in parts of it, the SSE may fall
SSE_TOLERANCE = 1e-12
#: so many steps with a coefficient of the wrong sign lead to none of the right one
MAX_WRONG_SIGN_STEPS = 12

T = TypeVar("T", bound="Trial")


class Trial(Protocol):
    """Trial parameters with all linear ones solved.

    `theta` (p,) and `beta` (q,); the sum of squares `sse`, infinite where the model is not defined;
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
    def step_ahead(self, step: FloatArray) -> Self: ...  # noqa: D102


class Objective(NamedTuple, Generic[T]):
    """Interface of an objective to be minimised.

    Attributes
    ----------
    evaluate : callable
        ``evaluate(theta, last) -> trial``, `last` the trial that the descent stands at, None at
        first.
    low, high : array, shape (p,)
    floor : float
        Sum of squares that no theta lowers.
    rounding : float
        Sum of squares below which a residual is rounding.
    """

    evaluate: Callable[[FloatArray, T | None], T]
    low: FloatArray
    high: FloatArray
    floor: float = 0.0
    rounding: float = 0.0


class LocalOptimum(NamedTuple, Generic[T]):
    """Local optimum of a descent."""

    point: T
    evaluations: int
    converged: bool


def is_step_acceptable(new: Any, old: Any, change: Any, rounding: Any) -> Any:
    """Far away a step must lower the SSE; near the end, where it is flat, not raise it."""
    return (new < old) | ((change < TAIL_CHANGE) & (new <= old * (1 + 1e-8) + rounding))


def has_converged(change: Any, last: Any, expected_fall: Any, sse: Any) -> Any:
    """Return whether the last undamped steps leave next to no change of theta and of the SSE."""
    return (
        (change <= LINEAR_STEP)
        & (change * change <= THETA_TOLERANCE * last)
        & (expected_fall <= SSE_TOLERANCE * sse)
    )


def descend(  # noqa: C901 -- one loop, whose rules share all that it knows
    objective: Objective[T],
    start: FloatArray,
    *,
    expected_positive: BoolArray | None = None,
    is_known_optimum: Callable[[FloatArray], bool] | None = None,
    step_tolerance: float = FINAL_TOLERANCE,
    cost_tolerance: float = 0.0,
    damping: float = 1e-3,
    limit: int = 60,
) -> LocalOptimum[T] | None:
    r"""Levenberg-Marquardt with steps of at most 1.5 in every parameter, inside the bounds.

    Far away a step must lower the SSE; within 1e-5 the SSE is flat to its last digits, so the
    undamped step itself decides: the descent ends when it falls below `step_tolerance`, or when, at
    the rate of the last steps, next to nothing is left of it, or when a step that promised no more
    than rounding is refused. Where the residual is large J'J is
    a poor Hessian and such steps only creep; what the gradients say it lacks is then learned
    from step to step (as in J. E. Dennis, D. M. Gay, R. E. Welsch, *ACM Trans. Math. Softw.* 7,
    1981, with the symmetric rank-one update).

    A step that raises the SSE may only have left the floor of a valley that bends: it is taken if
    one more from where it ends leads below the start (the watchdog of R. M. Chamberlain and others,
    *Math. Programming Study* 16, 1982).

    With `cost_tolerance` it ends where a step promises to lower the SSE by less than that part of
    it. A descent on which coefficients that are `expected_positive` have long been negative, such
    as two arms that merge with ever larger coefficients of opposite sign, ends there.

    Returns None when it has `is_known_optimum` what is known already, or where the start cannot be
    evaluated.
    """
    evaluate, low, high, fixed_cost, rounding = objective
    bounds = low.tolist(), high.tolist()
    current = evaluate(np.minimum(np.maximum(start, low), high), None)
    if current.sse == np.inf:
        return None
    hessian_correction: FloatArray | None = None
    last, wrong_steps, refused_change, is_cautious = np.inf, 0, np.inf, False
    for count in range(2, limit + 2):
        trial = _compute_trial(current, hessian_correction, damping, bounds)
        step = trial - current.theta
        change = max(map(abs, step.tolist()), default=0.0)
        # much the step that was refused
        while TAIL_CHANGE < STEP_REDUCTION * refused_change < change:
            damping *= 10
            trial = _compute_trial(current, hessian_correction, damping, bounds)
            step = trial - current.theta
            change = max(map(abs, step.tolist()), default=0.0)
        refused_change = np.inf
        expected_fall, sse = abs(float(current.gradient @ step)), fixed_cost + current.sse
        if change <= step_tolerance or (
            expected_fall < cost_tolerance * sse and damping <= SMALL_DAMPING
        ):
            return LocalOptimum(current, count, True)
        if damping < LINEAR_STEP and has_converged(change, last, expected_fall, sse):
            return LocalOptimum(current.step_ahead(step), count, True)
        new = evaluate(trial, current)
        if current.sse < new.sse < np.inf and change >= TAIL_CHANGE:
            # along a valley that bends the step ends on its side: from there to its floor
            valley_trial = evaluate(_compute_trial(new, None, damping, bounds), new)
            if valley_trial.sse < current.sse:
                new, step = valley_trial, valley_trial.theta - current.theta
                change = max(map(abs, step.tolist()))
        if is_step_acceptable(new.sse, current.sse, change, rounding):
            promised = -float(step @ (2 * current.gradient + current.curvature @ step))
            is_short = is_cautious and current.sse - new.sse < MIN_GAIN_RATIO * promised
            is_reliable = change < TAIL_CHANGE or _is_predicted(
                hessian_correction, current, new, step
            )
            hessian_correction = (
                _update_hessian_correction(hessian_correction, current, new, change, last)
                if is_reliable
                else None
            )
            last, current = change, new
            wrong_steps = (
                wrong_steps + 1
                if expected_positive is not None and (current.beta[expected_positive] < 0).any()
                else 0
            )
            damping *= (1.0 if is_short else CAUTIOUS_DAMPING_FACTOR if is_cautious else 0.1) * (
                change >= TAIL_CHANGE
            )
        elif (change < TAIL_CHANGE and damping == 0.0) or expected_fall <= SSE_TOLERANCE * sse:
            return LocalOptimum(current, count, True)
        else:
            damping, refused_change, is_cautious = 10 * max(damping, 1e-6), change, True
        if current.sse <= rounding or damping > 1e9 or wrong_steps > MAX_WRONG_SIGN_STEPS:
            return LocalOptimum(current, count, current.sse <= rounding)
        if is_known_optimum is not None and is_known_optimum(current.theta):
            return None
    return LocalOptimum(current, limit, False)


def _is_predicted(
    hessian_correction: FloatArray | None, old: Trial, new: Trial, step: FloatArray
) -> bool:
    """Whether the learned Hessian predicts the decrease of the SSE by a step."""
    if hessian_correction is None:
        return True
    predicted_fall = -float(step @ (2 * old.gradient + (old.curvature + hessian_correction) @ step))
    return bool(abs(old.sse - new.sse - predicted_fall) <= MAX_PREDICTION_ERROR * predicted_fall)


def _update_hessian_correction(
    hessian_correction: FloatArray | None, old: Trial, new: Trial, length: float, last: float
) -> FloatArray | None:
    """Return the corrected part of the Hessian beyond J'J, which explains a slow step."""
    if not (ROUNDING < length < NEAR_OPTIMUM and length > SLOW_RATE * last):
        return hessian_correction
    change = new.theta - old.theta
    gradient_error = new.gradient - old.gradient - new.curvature @ change
    if hessian_correction is not None:
        gradient_error = gradient_error - hessian_correction @ change
    curvature_along = float(gradient_error @ change)
    if curvature_along * curvature_along <= 1e-16 * float(
        (gradient_error @ gradient_error) * (change @ change)
    ):
        return hessian_correction
    update = np.outer(gradient_error, gradient_error) / curvature_along
    return update if hessian_correction is None else hessian_correction + update


def _compute_trial(
    point: Trial,
    hessian_correction: FloatArray | None,
    damping: float,
    bounds: tuple[list[float], list[float]],
) -> FloatArray:
    """Return the end of the damped step; parameters at a bound or without effect are held."""
    gradient, curvature, theta = point.gradient, point.curvature, point.theta
    scale = curvature.diagonal()
    # an estimate that would turn the step uphill is no Hessian
    if hessian_correction is not None:
        hessian = curvature + hessian_correction
        if np.linalg.eigvalsh(hessian)[0] > 1e-3 * scale.min():
            curvature = hessian
    ridge = max(damping, 1e-15) * np.maximum(scale, MIN_CURVATURE_SHARE * scale.max(initial=0.0))
    if _is_within_bounds(theta, bounds, allow_ends=False) and all(scale.tolist()):
        step = _solve_damped_step(curvature, gradient, ridge)
    else:
        low, high = map(np.array, bounds)
        at_bounds = ((theta <= low) & (gradient > 0)) | ((theta >= high) & (gradient < 0))
        index = np.flatnonzero((scale > 0) & ~at_bounds)
        step = np.zeros(len(gradient))
        active_curvature = curvature[index[:, None], index]
        step[index] = _solve_damped_step(active_curvature, gradient[index], ridge[index])
    longest = max(map(abs, step.tolist()), default=0.0)
    step = step if longest <= LONGEST_STEP else np.clip(step, -LONGEST_STEP, LONGEST_STEP)
    trial = theta + step
    return trial if _is_within_bounds(trial, bounds, allow_ends=True) else np.clip(trial, *bounds)


def _is_within_bounds(
    theta: FloatArray, bounds: tuple[list[float], list[float]], *, allow_ends: bool
) -> bool:
    """Return whether no parameter sits at an end of its range or, at `allow_ends`, beyond one."""
    pairs = zip(bounds[0], theta.tolist(), bounds[1], strict=True)
    if allow_ends:
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
    """Return the upper triangular factor of a matrix given by its columns, shape (c, n)."""
    raw: FloatArray = np.linalg.qr(columns.T, mode="raw")[0]
    c = len(columns)
    return np.asarray(raw.T[:c] * _upper(c)[: raw.shape[1]])


@lru_cache(maxsize=64)
def _upper(size: int) -> FloatArray:
    return np.triu(np.ones((size, size)))


# Separable problems.
#
# .. math:: y(\theta) = A(\theta)\,\beta + \text{noise}, \qquad
#           l \le \theta \le h, \quad \beta_j \ge 0 \text{ where it must be}
#
# :math:`\beta` is solved at every trial and projected out of the slope (variable projection:
# G. H. Golub and V. Pereyra, *SIAM J. Numer. Anal.* 10, 1973; L. Kaufman, *BIT* 15, 1975). A model
# with nothing linear in it has no columns, one with nothing else no :math:`\theta`. What was known
# before the data is a row as any other; such rows come last.


#: relative sum of squares caused by rounding
_ROUNDING_POWER = 1e-22
#: a descent that is worse by this factor after its first steps is not followed
_WORSE_FACTOR = 2.0
#: step of a coefficient for a difference, in parts of it
_DIFFERENCE_STEP = 1e-5


class Rows(NamedTuple):
    """Model at one theta.

    Attributes
    ----------
    y : array, shape (n,)
        Target, including constant terms with opposite sign.
    A : array, shape (n, q)
        The columns of beta.
    slope : callable, optional
        ``slope(beta)``, the derivative of ``A beta - y`` by theta, shape (n, p); else it is found
        by differences.
    """

    y: FloatArray
    A: FloatArray
    slope: Callable[[FloatArray], FloatArray] | None = None


Model: TypeAlias = Callable[[FloatArray], Rows]
"""Rows at a theta; raises DataError where the model is not defined."""


class Parameter(NamedTuple):
    """Component of theta: its range, the size of a step, and of a finite difference."""

    low: float = -np.inf
    high: float = np.inf
    scale: float = 1.0
    step: float = 1e-5


@dataclass(frozen=True, eq=False)
class Problem:
    """Separable problem: a model, the range of theta, and which beta must not be negative.

    Attributes
    ----------
    model : callable
        See :data:`Model`.
    parameters : sequence of Parameter
    positive : bool or array, shape (q,)
    priors : int
        How many rows, the last, are no data.
    gauge : callable, optional
        Choice of gauge: of the thetas that are the same model, the one that is meant:
        ``gauge(theta) -> theta``.
    """

    model: Model
    parameters: Sequence[Parameter] = ()
    positive: bool | BoolArray = False
    priors: int = 0
    gauge: Callable[[FloatArray], FloatArray] | None = None

    @cached_property
    def bounds(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Low, high and scale of every theta."""
        low, high, scale, _ = np.array(self.parameters, dtype=float).reshape(-1, 4).T
        return low, high, scale

    def solve_linear(self, theta: FloatArray, likely_positive: BoolArray | None = None) -> Optimum:
        """Return the best beta at a theta; `likely_positive` marks those likely above zero."""
        rows = self.model(theta)
        beta, span = solve_linear(rows.A, rows.y, self.positive, likely_positive)
        return Optimum(self, np.asarray(theta, dtype=float), beta, rows, span)

    def solve(
        self,
        starts: Sequence[FloatArray] = (),
        *,
        max_steps: int = 100,
        screening_steps: int = 0,
        step_tolerance: float = FINAL_TOLERANCE,
        cost_tolerance: float = 0.0,
    ) -> Optimum | None:
        """Return the best of the descents from some starts; None if the model is nowhere there.

        Parameters
        ----------
        starts : sequence of array, shape (p,)
        max_steps : int
            Steps of a descent.
        screening_steps : int
            If given, those that are clearly worse after so many steps are not followed.
        step_tolerance : float
            Step, in sizes of a parameter, that ends a descent.
        cost_tolerance : float
            Part of the cost that a step promises to lower it by, and ends a descent.
        """
        if not self.parameters:
            return self.solve_linear(np.zeros(0))
        optima = self.find_optima(
            starts,
            max_steps=screening_steps or max_steps,
            step_tolerance=step_tolerance,
            cost_tolerance=cost_tolerance,
        )
        best = min(optima, key=lambda optimum: optimum.cost, default=None)
        if best is None or not screening_steps:
            return best
        close_starts = [
            optimum.theta for optimum in optima if optimum.cost <= _WORSE_FACTOR * best.cost
        ]
        return self.solve(
            close_starts,
            max_steps=max_steps,
            step_tolerance=step_tolerance,
            cost_tolerance=cost_tolerance,
        )

    def find_optima(
        self,
        starts: Sequence[FloatArray],
        *,
        same_distance: float = 0.0,
        max_steps: int = 100,
        step_tolerance: float = FINAL_TOLERANCE,
        cost_tolerance: float = 0.0,
    ) -> list[Optimum]:
        """Return the optima of descents from some starting points, for :meth:`solve`.

        One that comes nearer than `same_distance`, in sizes of the parameters, to the end of
        another is not followed.
        """
        optima: list[Optimum] = []
        scale = self.bounds[2]

        def is_repeat_optimum(theta: FloatArray) -> bool:
            return any(
                np.abs(theta - optimum.theta / scale).max() < same_distance for optimum in optima
            )

        for start in starts:
            if (
                local_optimum := self._run_descent(
                    start, is_repeat_optimum, max_steps, step_tolerance, cost_tolerance
                )
            ) is not None:
                optima.append(
                    replace(local_optimum.point.optimum, stationary=local_optimum.converged)
                )
        return optima

    def fix_parameter(self, index: int, value: float) -> Problem:
        """Return the problem with one theta held."""
        other_parameters = [parameter for i, parameter in enumerate(self.parameters) if i != index]

        def model(theta: FloatArray) -> Rows:
            rows = self.model(np.insert(theta, index, value))
            if (slope := rows.slope) is None:
                return rows
            return rows._replace(slope=lambda beta: np.delete(slope(beta), index, axis=1))

        return replace(self, model=model, parameters=other_parameters, gauge=None)

    def _run_descent(
        self,
        start: FloatArray,
        is_known_optimum: Callable[[FloatArray], bool],
        max_steps: int,
        step_tolerance: float,
        cost_tolerance: float,
    ) -> LocalOptimum[_ScaledTrial] | None:
        """Return the optimum of a descent from one start, in scaled parameters; None if known."""
        low, high, scale = self.bounds
        low, high = low / scale, high / scale
        first_trial = self._evaluate_trial(np.clip(np.asarray(start) / scale, low, high), None)
        objective = Objective(
            lambda theta, last: first_trial if last is None else self._evaluate_trial(theta, last),
            low, high, rounding=first_trial.rounding,
        )  # fmt: skip
        return descend(
            objective,
            first_trial.theta,
            is_known_optimum=is_known_optimum,
            limit=max_steps,
            step_tolerance=step_tolerance,
            cost_tolerance=cost_tolerance,
        )

    def _evaluate_trial(self, theta: FloatArray, last: _ScaledTrial | None) -> _ScaledTrial:
        """The best beta at a scaled theta; infinite SSE where the model is not defined."""
        scale = self.bounds[2]
        likely_positive = None if last is None else last.beta > 0
        unscaled = theta * scale
        try:
            optimum = self.solve_linear(
                unscaled if self.gauge is None else self.gauge(unscaled), likely_positive
            )
        except DataError:
            return _ScaledTrial(theta, scale, None)
        return _ScaledTrial(optimum.theta / scale, scale, optimum)


class _ScaledTrial:
    """An optimum at some theta, in sizes of the parameters, as a descent wants it."""

    def __init__(self, theta: FloatArray, scale: FloatArray, optimum: Optimum | None) -> None:
        self.theta, self.scale, self._optimum = theta, scale, optimum
        self.sse = np.inf if optimum is None else optimum.cost
        self.rounding = 0.0 if optimum is None else optimum.rounding_sse

    @property
    def optimum(self) -> Optimum:
        """Optimum; it must exist."""
        if self._optimum is None:
            raise FitError("the model says nothing of the record there")
        return self._optimum

    @property
    def beta(self) -> FloatArray:
        return self.optimum.beta

    @cached_property
    def gradient(self) -> FloatArray:
        return self.optimum.gradient * self.scale

    @cached_property
    def curvature(self) -> FloatArray:
        return self.optimum.curvature * np.outer(self.scale, self.scale)

    def step_ahead(self, step: FloatArray) -> _ScaledTrial:
        """Return the trial a short step away."""
        theta = self.optimum.problem._evaluate_trial(self.theta + step, self)
        return theta if theta.sse <= self.sse * (1 + 1e-8) + self.rounding else self


@dataclass(frozen=True, eq=False)
class Optimum:
    """Optimum: a theta with its best beta.

    Attributes
    ----------
    problem : Problem
    theta : array, shape (p,)
    beta : array, shape (q,)
    rows : Rows
    span : callable
        ``span()`` is `basis`.
    stationary : bool
        The descent ended for no want of steps.
    """

    problem: Problem
    theta: FloatArray
    beta: FloatArray
    rows: Rows
    span: Callable[[], FloatArray] = field(repr=False)
    stationary: bool = True

    @cached_property
    def all_residuals(self) -> FloatArray:
        """Residual of every row, priors included: y less the model."""
        return np.asarray(self.rows.y - self.rows.A @ self.beta)

    @property
    def residual(self) -> FloatArray:
        """Residual of the data, shape (n,)."""
        return self.all_residuals[: len(self.all_residuals) - self.problem.priors]

    @cached_property
    def cost(self) -> float:
        """Sum of squares of all rows, the objective."""
        return float(self.all_residuals @ self.all_residuals)

    @property
    def sse(self) -> float:
        """Sum of squares of the data alone."""
        return float(self.residual @ self.residual)

    @property
    def rounding_sse(self) -> float:
        """Sum of squares due to rounding."""
        return _ROUNDING_POWER * float(self.rows.y @ self.rows.y)

    @property
    def free(self) -> BoolArray:
        """Mask of theta and beta that may change: a coefficient at zero may not."""
        is_zero = (self.beta == 0) & self.problem.positive
        return np.concatenate((np.ones(len(self.theta), dtype=bool), ~is_zero))

    @property
    def values(self) -> FloatArray:
        """Theta, then beta."""
        return np.concatenate((self.theta, self.beta))

    def evaluate_model(self, values: FloatArray) -> FloatArray:
        """Return a beta less y at other values of theta and beta: what moves with them."""
        rows = self.problem.model(values[: len(self.theta)])
        return np.asarray(rows.A @ values[len(self.theta) :] - rows.y)

    @cached_property
    def jacobian(self) -> FloatArray:
        """Derivative of the model by theta, else by central differences, and by beta, (n, p+q)."""
        return np.column_stack((self._slopes(central=True), self.rows.A))

    @cached_property
    def basis(self) -> FloatArray:
        """Orthonormal, of the columns that carry weight, shape (n, r)."""
        return self.span()

    @cached_property
    def projected_jacobian(self) -> FloatArray:
        """Derivative of the residual by theta, less what beta takes over, shape (n, p)."""
        J = self._slopes(central=False)
        return np.asarray(self.basis @ (self.basis.T @ J) - J)

    @cached_property
    def gradient(self) -> FloatArray:
        """Half the slope of the cost by theta."""
        return np.asarray(self.projected_jacobian.T @ self.all_residuals)

    @cached_property
    def curvature(self) -> FloatArray:
        """Gauss-Newton curvature, shape (p, p)."""
        return np.asarray(self.projected_jacobian.T @ self.projected_jacobian)

    @property
    def steps(self) -> list[tuple[float, float]]:
        """Steps down and up of theta and beta for differences, within their range."""
        results = []
        for value, parameter in zip(self.theta.tolist(), self.problem.parameters, strict=True):
            h = parameter.step * parameter.scale
            results.append(
                (-min(h, max(value - parameter.low, 0.0)), min(h, max(parameter.high - value, 0.0)))
            )
        row = _DIFFERENCE_STEP * np.maximum(np.abs(self.beta), 1e-300)
        return results + [(-h, h) for h in row.tolist()]

    def _slopes(self, *, central: bool) -> FloatArray:
        if self.rows.slope is not None and len(self.theta):
            return np.asarray(self.rows.slope(self.beta))
        slopes = np.empty((len(self.all_residuals), len(self.theta)))
        for i, (step_down, step_up) in enumerate(self.steps[: len(self.theta)]):
            if central:
                slopes[:, i] = (
                    self._evaluate_shifted(i, step_up) - self._evaluate_shifted(i, step_down)
                ) / (step_up - step_down)
            else:
                change = step_up if step_up > -step_down else step_down
                slopes[:, i] = (self._evaluate_shifted(i, change) + self.all_residuals) / change
        return slopes

    def _evaluate_shifted(self, i: int, step: float) -> FloatArray:
        values = self.values
        values[i] += step
        return self.evaluate_model(values)


def require_optimum(
    problem: Problem,
    starts: Sequence[FloatArray] = (),
    *,
    max_steps: int = 100,
    screening_steps: int = 0,
    step_tolerance: float = FINAL_TOLERANCE,
    cost_tolerance: float = 0.0,
) -> Optimum:
    """Return the optimum, as :meth:`Problem.solve`; it must be there.

    Raises
    ------
    FitError
        If the model is not defined at any starting point.
    """
    optimum = problem.solve(
        starts,
        max_steps=max_steps,
        screening_steps=screening_steps,
        step_tolerance=step_tolerance,
        cost_tolerance=cost_tolerance,
    )
    if optimum is None:
        raise FitError("the model says nothing of the record from any start")
    return optimum


def solve_ordinary(y: FloatArray, A: FloatArray, *, positive: bool = False) -> Optimum:
    """Return ordinary least squares: the optimum of a model that is linear throughout."""
    return require_optimum(Problem(lambda _: Rows(y, A), positive=positive))


def stack_real_rows(values: FloatArray | ComplexArray) -> FloatArray:
    """Return complex rows as real ones: real parts, then imaginary."""
    return np.concatenate((values.real, values.imag))
