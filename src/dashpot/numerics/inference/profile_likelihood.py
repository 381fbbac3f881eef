"""Profile likelihood: best fit with one parameter held at a value."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.numerics.exponential_fit import Solution
from dashpot.numerics.log_tau_descent import Stack

# One side of one profile: trial values, and the end of the search.


#: points of a profile, and largest number of points beyond the limit before the search stops
_MAX_POINTS, _MAX_LEAPS = 20, 5
#: an arm whose absence costs less deviance is one that the data do without
_SPARE_DEVIANCE = 2.0
#: the walk steps by a rise of the root of the deviance over which interpolation is good
_RISE, _RISES = 0.7, 5.0


class Coordinate(Enum):
    """Coordinate that is fixed while all others are fitted again."""

    LINEAR = "a linear parameter"
    LOG_TAU = "ln tau of an arm"
    LOG_B = "ln(k tau) of an arm"


@dataclass(frozen=True)
class ProfileTarget:
    """Parameter whose profile is requested.

    Attributes
    ----------
    coordinate, index
        Which parameter: of the linear ones for ``LINEAR``, of the relaxation times for
        ``LOG_TAU``, of the arms' stiffnesses, group by group, for ``LOG_B``; from 0.
    step : float
        First distance from the optimum, about half a standard error.
    scale : float
        kappa s^2, the SSE of one unit of deviance.
    relative_gain : callable, optional
        How many times the noise at the optimum meets the way from there to linear parameters
        and ln tau; once, if omitted.
    """

    coordinate: Coordinate
    index: int
    step: float
    scale: float
    relative_gain: Callable[[FloatArray, FloatArray], float] | None = None


class ProfileTrace:
    """State of one side of one profile: its current point and its next."""

    def __init__(
        self,
        target: ProfileTarget,
        start: float,
        sign: float,
        limit: float,
        limits: tuple[float, float],
    ) -> None:
        self.profile_target, self.start, self.limit, self.ends = target, start, limit, limits
        self.sign = sign
        self.rise = max(_RISE, float(np.sqrt(limit)) / _RISES)
        self.step, self.root, self.at = sign * target.step, 0.0, start
        self.walked: list[tuple[float, float]] = []
        self.skipped_points: list[tuple[float, float]] = []
        self.trials = self.leaps = 0
        self.ended, self.without = False, np.inf
        self.goal = start
        self._clip_goal()

    @property
    def points(self) -> list[tuple[float, float]]:
        """Values and deviances on the way out."""
        visited = self.walked
        if self.skipped_points and self.root <= np.sqrt(self.limit):
            # a leap that the walk has passed says nothing of the way
            passed_start = visited and (self.skipped_points[0][0] - visited[-1][0]) * self.step <= 0
            visited = visited if passed_start else visited + self.skipped_points
        if not np.isfinite(self.without):
            return visited
        end_value = self.ends[int(self.sign > 0)]
        lowest_points = [(value, min(deviance, self.without)) for value, deviance in visited]
        has_reached_end = end_value in (self.start, visited[-1][0] if visited else self.start)
        return lowest_points if has_reached_end else [*lowest_points, (end_value, self.without)]

    def update_without_arm(self, deviance: float) -> None:
        """Take note of the deviance without its arm, which no value of the arm's exceeds."""
        if deviance < self.limit:
            self.without = self.limit = deviance
            self.ended = self.ended or deviance < _SPARE_DEVIANCE

    def update_walk(self, deviance: float) -> bool:
        """Take note of the deviance at the goal; True if the walk continues from there."""
        root_rise = float(np.sqrt(deviance)) - self.root
        self.step *= min(max(self.rise / max(root_rise, 1e-3), 0.1), 3.0)
        is_close = root_rise <= 2.0 * self.rise
        if is_close:
            self.walked.append((self.goal, deviance))
            self.at, self.root = self.goal, self.root + root_rise
        else:
            # too far to interpolate to: walk towards it in smaller steps
            self.skipped_points = [(self.goal, deviance)]
            self.leaps += 1
        self.ended = (is_close and deviance > self.limit) or self.leaps > _MAX_LEAPS
        self._clip_goal()
        return is_close

    def _clip_goal(self) -> None:
        self.goal = min(max(self.at + self.step, self.ends[0]), self.ends[1])
        self.step = self.goal - self.at
        self.ended = self.ended or self.trials >= _MAX_POINTS or self.step == 0.0
        self.trials += 1


# Simultaneous descents of many small least-squares problems.
#
# Each is of a few ln tau, everything linear solved. Gauss and Newton's curvature J'J leaves out
# what the residual adds, :math:`\sum_i r_i \nabla^2 r_i`, and descends slowly where the residual is
# no noise. With it the step is Newton's; it is believed where it is a moderate part of J'J, so that
# the sum is a parabola that opens upward.


_ITERATIONS = 8
#: the longest move, and after one that failed, as a part of that
_MAX_STEP, _STEP_REDUCTION = 1.5, 0.25
RIDGE = 1e-13
#: the curvature of the residual that is believed, as parts of J'J
_CURVATURE_LIMITS = -0.9, 4.0
#: an SSE whose fall is foretold to so many tolerances is taken as fallen: Newton is right to a few
#: hundredths of it
_MIN_PREDICTED_FALL = 50.0


class SolvedTrials(NamedTuple):
    """Trial values of ln tau with all linear parameters solved.

    SSE (A,), linear parameters (A, p), gradient J'r (A, N) and curvature J'J (A, N, N) of the
    reduced residual by the free ln tau, and what the residual adds to the curvature (A, N, N).
    """

    sse: FloatArray
    beta: FloatArray
    gradient: FloatArray
    curvature: FloatArray
    residual_curvature: FloatArray


class BatchedDescent:
    """State of A simultaneous descents: current points and next steps.

    Parameters
    ----------
    start : array, shape (A, N)
        ln tau.
    linear : int
        Linear parameters p.
    tolerance : array, shape (A,)
        A change of the SSE that does not matter.
    """

    def __init__(self, start: FloatArray, linear: int, tolerance: FloatArray) -> None:
        count, arms = start.shape
        self.positions, self.tolerance = start.copy(), tolerance
        self.known = SolvedTrials(
            np.full(count, np.inf),
            np.zeros((count, linear)),
            np.zeros((count, arms)),
            np.zeros((count, arms, arms)),
            np.zeros((count, arms, arms)),
        )
        self.steps = np.zeros_like(start)
        self.promised, self.damping = np.zeros(count), np.full(count, 1e-6)
        self.tried, self.reach = np.zeros(count, int), np.full(count, _MAX_STEP)

    def start(self, i: int, log_tau: FloatArray) -> None:
        """Begin another problem like the last, or the same elsewhere."""
        self.positions[i], self.steps[i], self.known.sse[i] = log_tau, 0.0, np.inf
        self.damping[i], self.tried[i], self.reach[i] = 1e-6, 0, _MAX_STEP

    def best(self, i: int) -> tuple[float, FloatArray]:
        """The least SSE of one descent and its ln tau, a last move foretold if that is little."""
        sse, promised = float(self.known.sse[i]), float(self.promised[i])
        if promised < _MIN_PREDICTED_FALL * self.tolerance[i]:
            return sse - promised, self.positions[i] + self.steps[i]
        return sse, self.positions[i]

    def take(self, trial: FloatArray, trials: SolvedTrials, indices: IndexArray) -> BoolArray:
        """Learn from one trial each of the descents `indices`; True where that is enough."""
        solved_trials = self.known
        gain = solved_trials.sse[indices] - trials.sse
        is_better = gain > 0
        kept_rows = indices[is_better]
        self.positions[kept_rows] = trial[is_better]
        for own_trial, new_trial in zip(solved_trials, trials, strict=True):
            own_trial[kept_rows] = new_trial[is_better]
        damping = self.damping[indices]
        self.damping[indices] = np.where(is_better, np.maximum(0.1 * damping, 1e-9), 10 * damping)
        # where the parabola has failed it is believed nearby only
        distance_moved = np.abs(self.steps[indices]).max(axis=1, initial=0.0)
        self.reach[indices] = np.where(
            is_better,
            np.minimum(2.0 * np.maximum(distance_moved, self.reach[indices]), _MAX_STEP),
            _STEP_REDUCTION * distance_moved,
        )
        self.tried[indices] += 1
        self.steps[indices], self.promised[indices] = self._compute_step(indices)
        return np.asarray(
            (np.abs(gain) < self.tolerance[indices])
            | (self.promised[indices] < _MIN_PREDICTED_FALL * self.tolerance[indices])
            | (self.damping[indices] > 1e6)
            | (self.tried[indices] >= _ITERATIONS)
        )

    def _compute_step(self, indices: IndexArray) -> tuple[FloatArray, FloatArray]:
        """Return the next move (A, N), and by how much the SSE would fall if it were parabolic."""
        curvature, gradient = self.known.curvature[indices], self.known.gradient[indices]
        if not curvature.shape[1]:
            return gradient, np.zeros(len(indices))
        arms = np.arange(curvature.shape[1])
        curvature_diagonal = curvature[:, arms, arms]
        column_scale = np.where(curvature_diagonal > 0, curvature_diagonal, 1.0)
        curvature[:, arms, arms] = (
            curvature_diagonal + column_scale * RIDGE + (curvature_diagonal <= 0)
        )
        right_sides = np.concatenate(
            (self.known.residual_curvature[indices], gradient[:, :, None]), axis=2
        )
        solutions = np.linalg.solve(curvature, right_sides)
        share, first = solutions[..., :-1], solutions[..., -1]
        # what the move takes off the residual bends nothing where it leads
        reduction = np.vecdot(first, gradient) / np.maximum(self.known.sse[indices], 1e-300)
        remainder = np.maximum(1.0 - reduction * reduction, 0.0)[:, None, None]
        is_moderate = _is_moderate(remainder * share)[:, None, None]
        curvature += np.where(is_moderate, remainder, 0.0) * self.known.residual_curvature[indices]
        curvature[:, arms, arms] += column_scale * self.damping[indices][:, None]
        step = np.linalg.solve(curvature, gradient[:, :, None])[..., 0]
        longest = np.abs(step).max(axis=1, keepdims=True)
        step = step * np.minimum(1.0, self.reach[indices][:, None] / np.maximum(longest, 1e-300))
        return step, np.vecdot(step, gradient)


def _is_moderate(share: FloatArray) -> BoolArray:
    """Return which of some curvatures of residuals, in parts of J'J, are moderate."""
    # the eigenvalues of the ratio are real, and none is larger than the root of their squares
    lowest, highest = _CURVATURE_LIMITS
    is_moderate = (share * share.swapaxes(1, 2)).sum(axis=(1, 2)) < min(-lowest, highest) ** 2
    if not is_moderate.all():
        doubtful_eigenvalues = np.linalg.eigvals(share[~is_moderate]).real
        is_moderate[~is_moderate] = (doubtful_eigenvalues.min(axis=1) > lowest) & (
            doubtful_eigenvalues.max(axis=1) < highest
        )
    return np.asarray(is_moderate)


# Profile likelihood.
#
# .. math:: D(v) = \frac{\min_{\theta:\,g(\theta)=v} \mathrm{SSE}(\theta) - \mathrm{SSE}_{\min}}
#                       {\kappa s^2}
#
# compared with the square of Student's t. Unlike a standard error it sees that a likelihood is
# skewed, or open on one side. Source: D. M. Bates and D. G. Watts, *Nonlinear Regression Analysis
# and Its Applications* (1988), ch. 6.
#
# The noise of a correlated record has its own gain for each change of the model, and a profile that
# bends walks from one kind of change to another: with :math:`d(v)` the change of the model on the
# way from the optimum to v, :math:`\kappa s^2` grows as :math:`d'\Gamma d / d'd`. In a linear model
# that is constant, and the deviance is the square of (v - optimum) / SE by the sandwich.
#
# Everything else is fitted by variable projection: the linear parameters are solved exactly at each
# trial of the relaxation times. Both sides of every profile asked for walk together, so that one
# trial of all of them costs about what one of one costs; their columns are interpolated from a
# table.
#
# An arm so fast that none of its stiffness shows, or so slow that none of its b does, is no arm at
# all, and one slower than the record is a plateau. So however far k, tau or b of an arm go, and
# however low a plateau falls, it costs no more than to do without that arm, the others in their
# places,
#
# .. math:: D(v) \le D_0 = D(k = 0)
#
# and a walk that has met :math:`D_0` is at its end: beyond, any value will do.


#: factor outside the window up to which a relaxation time is profiled
WINDOW_FACTOR = 20.0
#: a stiffness so many times that of the whole solid, or a b so many folds from the optimum, is open
_OPEN_STIFFNESS, _OPEN_FOLDS = 1e4, 16.0
#: ln tau between nodes of the table; cubics through columns and slopes are right to 1e-7
_NODE_SPACING = 0.08
#: a change of ln tau from one point of a walk to the next that may be foretold
_MAX_PREDICTED_CHANGE = 0.7
_POWERS = np.arange(4.0)
#: what each power of u gives to the powers of a cubic, of its slope and of its curve
_DERIVATIVE_POWERS = np.array(
    [np.eye(4), np.diag(_POWERS[1:], 1), np.diag([2.0, 6.0], 2)]
).swapaxes(0, 1)


def compute_profiles(
    stack: Stack, optimum: Solution, targets: Sequence[ProfileTarget], *, limit: float
) -> list[tuple[FloatArray, FloatArray]]:
    """Return of each profile the trial values, ascending, the optimum among them, and deviances.

    Parameters
    ----------
    stack : Stack
        The data of the fit, in rows that do not depend on tau.
    optimum : Solution
    targets : sequence of ProfileTarget
    limit : float
        A walk ends where the deviance exceeds this, or where the data say no more: at the edge
        of their window, or where a stiffness has grown out of all proportion.
    """
    simultaneous = _SimultaneousProfiles(stack, optimum)
    walks = [
        ProfileTrace(target, simultaneous.value(target), sign, limit, simultaneous.range(target))
        for target in targets
        for sign in (-1.0, 1.0)
    ]
    simultaneous.walk(walks)
    results = []
    for low, high in zip(walks[::2], walks[1::2], strict=True):
        points = [*reversed(low.points), (low.start, 0.0), *high.points]
        value, deviance = np.array(points).T
        results.append((value, deviance))
    return results


class _SimultaneousProfiles:
    """The least-squares problems of many profiles, each with one fixed coordinate."""

    def __init__(self, stack: Stack, optimum: Solution) -> None:
        self.optimum, self.fixed = optimum, len(stack.names)
        self.arms, self.groups = len(optimum.log_tau), len(stack.groups)
        window_margin = float(np.log(WINDOW_FACTOR))
        self.plateaus = [i for i, name in enumerate(stack.names) if name.startswith("k_inf")]
        self.window = stack.bounds
        self.restricted = stack.get_nonnegative_mask(self.arms, signed=False)
        self.reach = stack.bounds[0] - window_margin, stack.bounds[1] + window_margin
        count = int(np.ceil((self.reach[1] - self.reach[0]) / _NODE_SPACING)) + 1
        nodes, difference = np.linspace(*self.reach, count, retstep=True)
        rows = stack.evaluate(nodes)
        self.target, self.still = rows.target, rows.phi[:, : self.fixed].T

        def reshape_by_node(columns: FloatArray) -> FloatArray:
            shape = (len(self.target), self.groups, count)
            return np.ascontiguousarray(columns.reshape(shape).transpose(2, 1, 0))

        columns = reshape_by_node(rows.phi[:, self.fixed :])
        slopes = difference * reshape_by_node(rows.slope)
        change, slope_0, slope_1 = np.diff(columns, axis=0), slopes[:-1], slopes[1:]
        # node, group, power of the part of the way to the next node, row
        self.cubics = np.stack(
            (
                columns[:-1],
                slope_0,
                3 * change - 2 * slope_0 - slope_1,
                slope_0 + slope_1 - 2 * change,
            ),
            axis=2,
        )
        derivative_weights = _DERIVATIVE_POWERS / difference ** np.arange(3.0)[:, None]
        self.node_distance, self.turn = float(difference), derivative_weights.reshape(4, -1)
        start = self._evaluate_columns(optimum.log_tau[None])[0][0]
        self.best = float(np.square(self.target - optimum.beta @ start).sum())

    def value(self, target: ProfileTarget) -> float:
        """Return the held coordinate at the optimum."""
        beta, log_tau = self.optimum.beta, self.optimum.log_tau
        if target.coordinate is Coordinate.LINEAR:
            return float(beta[target.index])
        arm = target.index % self.arms
        if target.coordinate is Coordinate.LOG_TAU:
            return float(log_tau[arm])
        return float(log_tau[arm] + np.log(beta[self.fixed + target.index]))

    def range(self, target: ProfileTarget) -> tuple[float, float]:
        """Return the range of the fixed coordinate."""
        if target.coordinate is Coordinate.LOG_TAU:
            return self.window
        if target.coordinate is Coordinate.LINEAR:
            return 0.0, _OPEN_STIFFNESS * float(np.abs(self.optimum.beta).max())
        start = self.value(target)
        return start - _OPEN_FOLDS, start + _OPEN_FOLDS

    def walk(self, traces: Sequence[ProfileTrace]) -> None:
        """Walk every side to its end."""
        sides = _Sides([trace.profile_target for trace in traces], self.fixed, self.arms)
        self._add_spare_deviances(traces, sides)
        residual = np.tile(self.optimum.log_tau, (len(traces), 1))
        goals = np.array([trace.goal for trace in traces])
        descents = self._start_descents(residual, traces)
        trials = descents.known
        while active_walks := [i for i, trace in enumerate(traces) if not trace.ended]:
            for i in self._run_trials(descents, goals, sides, np.array(active_walks)):
                trace, position, predicted_steps = traces[i], traces[i].at, np.zeros(self.arms)
                sse, log_tau = descents.best(i)
                if trace.update_walk(self._deviance(trace, trials.beta[i], log_tau, sse)):
                    predicted_steps = (
                        (log_tau - residual[i]) * (trace.goal - trace.at) / (trace.at - position)
                    )
                    residual[i] = log_tau
                largest_change = max(map(abs, predicted_steps.tolist()), default=0.0)
                descents.start(
                    i,
                    residual[i]
                    + min(1.0, _MAX_PREDICTED_CHANGE / max(largest_change, _MAX_PREDICTED_CHANGE))
                    * predicted_steps,
                )
                goals[i] = trace.goal

    def _add_spare_deviances(self, traces: Sequence[ProfileTrace], sides: _Sides) -> None:
        """Add the deviance without each arm to the walks of that arm."""
        if self.groups > 1:  # without its part in one group an arm is still there
            return
        of_arm = {arm: i for i, arm in enumerate(sides.owner.tolist()) if arm >= 0}
        if not of_arm:
            return
        first_walks = [traces[i] for i in of_arm.values()]
        arm_sides = _Sides(
            [ProfileTarget(Coordinate.LINEAR, self.fixed + arm, 0.0, 0.0) for arm in of_arm],
            self.fixed,
            self.arms,
        )
        values = self.optimum.log_tau
        descents = self._start_descents(np.tile(values, (len(first_walks), 1)), first_walks)
        # the others keep their places: one that took the arm's would be the arm
        midpoints = (values[arm_sides.arm][:, None] + values) / 2.0
        low = np.where(values > values[arm_sides.arm][:, None], midpoints, self.reach[0])
        high = np.where(values < values[arm_sides.arm][:, None], midpoints, self.reach[1])
        indices = np.arange(len(first_walks))
        while indices.size:
            bounds = low[indices], high[indices]
            ended = self._run_trials(
                descents, np.zeros(len(first_walks)), arm_sides, indices, bounds
            )
            indices = indices[~np.isin(indices, ended)]  # `numpy.setdiff1d` imports masked arrays
        indices_by_arm = {arm: [i] for i, arm in enumerate(of_arm)}
        for trace, arm, column in zip(traces, sides.owner.tolist(), sides.column, strict=True):
            # a plateau that falls may have any of the arms, slower than all, in its place
            is_falling = trace.sign < 0 and column in self.plateaus
            for i in indices_by_arm[arm] if arm >= 0 else range(len(first_walks) * is_falling):
                sse, log_tau = descents.best(i)
                trace.update_without_arm(
                    self._deviance(trace, descents.known.beta[i], log_tau, sse)
                )

    def _start_descents(self, start: FloatArray, traces: Sequence[ProfileTrace]) -> BatchedDescent:
        tolerance = np.array([1e-3 * trace.profile_target.scale for trace in traces])
        return BatchedDescent(start, len(self.optimum.beta), tolerance)

    def _run_trials(
        self,
        descents: BatchedDescent,
        target_values: FloatArray,
        sides: _Sides,
        indices: IndexArray,
        bounds: tuple[FloatArray, FloatArray] | None = None,
    ) -> IndexArray:
        """Try each of the descents `indices` once, in reach; those that are at their end."""
        low, high = bounds or self.reach
        # `numpy.clip` takes as long as all of this
        trial = np.minimum(
            np.maximum(descents.positions[indices] + descents.steps[indices], low), high
        )
        trial = sides.set_fixed_times(trial, target_values, indices)
        return indices[
            descents.take(
                trial, self._solve_trials(trial, target_values[indices], sides, indices), indices
            )
        ]

    def _deviance(
        self, trace: ProfileTrace, beta: FloatArray, log_tau: FloatArray, sse: float
    ) -> float:
        gain = trace.profile_target.relative_gain
        times = 1.0 if gain is None else gain(beta, log_tau)
        return max(float(sse) - self.best, 0.0) / (trace.profile_target.scale * times)

    def _evaluate_columns(self, log_tau: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Design matrix (A, p, n), and columns, slopes and curves of arms (A, G, N, 3, n)."""
        grid_position = (log_tau.ravel() - self.reach[0]) / self.node_distance
        node = np.minimum(np.maximum(grid_position.astype(int), 0), len(self.cubics) - 1)
        weights = (grid_position - node)[:, None] ** _POWERS @ self.turn
        values = weights.reshape(-1, 1, 3, 4) @ self.cubics[node]
        trials, rows = len(log_tau), len(self.target)
        values = values.reshape(trials, self.arms, self.groups, 3, rows).swapaxes(1, 2)
        phi = np.empty((trials, self.fixed + self.groups * self.arms, rows))
        phi[:, : self.fixed] = self.still
        phi[:, self.fixed :] = values[..., 0, :].reshape(trials, -1, rows)
        return phi, values

    def _solve_trials(
        self, log_tau: FloatArray, target_values: FloatArray, sides: _Sides, indices: IndexArray
    ) -> SolvedTrials:
        phi, values = self._evaluate_columns(log_tau)
        row, arm, column = np.arange(len(indices)), sides.arm[indices], sides.column[indices]
        amount, base = sides.amount(log_tau, target_values, indices), phi[row, column]
        target = self.target - amount[:, None] * base
        # where a relaxation time is held no coefficient is
        linear = ~sides.log_tau[indices]
        normal = _Normal(phi)
        normal.leave_out(row[linear], column[linear])
        projected_target = phi @ target[:, :, None]
        beta = normal.solve_moments(projected_target)[..., 0]
        # what must not be negative rests at zero, the worst first
        while (signed := np.where(self.restricted, beta, 0.0)).min() < 0:
            worst, negative = signed.argmin(axis=1), signed.min(axis=1) < 0
            normal.leave_out(row[negative], worst[negative])
            beta = normal.solve_moments(projected_target)[..., 0]
        residual = target - (beta[:, None, :] @ phi)[:, 0]
        beta[row, column] += amount
        stiffness = beta[:, self.fixed :].reshape(len(indices), self.groups, self.arms)
        rotated = (values[..., 1, :] * stiffness[..., None]).sum(axis=1)
        # columns, slopes and curves meet the residual
        moments = (values @ residual[:, None, None, :, None])[..., 0]
        second_derivative = (stiffness * moments[..., 2]).sum(axis=1)
        # k = exp(ln b - ln tau): the stiffness of an arm whose b is held falls as its ln tau rises
        goal_slope = amount * sides.log_b[indices]
        at_zero, moment_slope, _ = moments.reshape(len(indices), -1, 3)[
            row, np.maximum(column - self.fixed, 0)
        ].T
        second_derivative[row, arm] -= goal_slope * (2.0 * moment_slope - at_zero)
        rotated[row, arm] -= goal_slope[:, None] * base
        # a coefficient and its own tau meet in the residual
        meets = np.zeros((*beta.shape, self.arms))
        diagonal = np.arange(self.groups * self.arms)
        meets[:, self.fixed + diagonal, diagonal % self.arms] = moments[..., 1].reshape(
            len(indices), -1
        )
        moment = phi @ rotated.swapaxes(1, 2)
        solutions = normal.solve_moments(np.concatenate((moment, meets), axis=2))
        arm_part, meet_part = solutions[..., : self.arms], solutions[..., self.arms :]
        orthogonal_part = rotated - arm_part.swapaxes(1, 2) @ phi
        crossed = meets.swapaxes(1, 2) @ (arm_part - 0.5 * meet_part)
        curvature_part = crossed + crossed.swapaxes(1, 2)
        index = np.arange(self.arms)
        curvature_part[:, index, index] -= second_derivative
        is_free = np.ones(log_tau.shape)
        is_free[row, arm] = linear
        pairs = is_free[:, :, None] * is_free[:, None, :]
        return SolvedTrials(
            np.vecdot(residual, residual),
            beta,
            np.vecdot(orthogonal_part, residual[:, None, :]) * is_free,
            orthogonal_part @ orthogonal_part.swapaxes(1, 2) * pairs,
            curvature_part * pairs,
        )


class _Normal:
    """Normal equations of many design matrices (A, p, n), some columns omitted from each."""

    def __init__(self, phi: FloatArray) -> None:
        gram = phi @ phi.swapaxes(1, 2)
        length = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
        self.length = np.where(length > 0, length, 1.0)[:, :, None]
        self.gram = gram / (self.length * self.length.swapaxes(1, 2))
        diagonal = np.arange(gram.shape[1])
        self.gram[:, diagonal, diagonal] = 1.0 + RIDGE
        self.free = np.ones_like(self.length)

    def leave_out(self, row: IndexArray, column: IndexArray) -> None:
        """Hold a further column of some of the matrices at zero."""
        self.free[row, column] = 0.0
        self.gram[row, column, :] = self.gram[row, :, column] = 0.0
        self.gram[row, column, column] = 1.0 + RIDGE

    def solve_moments(self, moment: FloatArray) -> FloatArray:
        """Coefficients (A, p, r) for moments of that shape; zero for excluded columns."""
        scaled_moment = self.free * moment / self.length
        return np.asarray(np.linalg.solve(self.gram, scaled_moment) / self.length)


class _Sides:
    """The sides of the profiles: which coordinate each holds."""

    def __init__(self, targets: Sequence[ProfileTarget], fixed_count: int, arms: int) -> None:
        kinds = [target.coordinate for target in targets]
        index = np.array([target.index for target in targets])
        self.log_tau = np.array([kind is Coordinate.LOG_TAU for kind in kinds])
        self.log_b = np.array([kind is Coordinate.LOG_B for kind in kinds])
        # where a relaxation time is held the column named stays free
        self.column: IndexArray = np.where(self.log_b | self.log_tau, fixed_count + index, index)
        self.arm: IndexArray = np.where(
            self.column >= fixed_count, (self.column - fixed_count) % arms, 0
        )
        #: the arm that each belongs to; -1 of a fixed column
        self.owner: IndexArray = np.where(self.column >= fixed_count, self.arm, -1)

    def set_fixed_times(
        self, log_tau: FloatArray, target_values: FloatArray, indices: IndexArray
    ) -> FloatArray:
        """Return the trials with a fixed relaxation time at its goal."""
        fixed_time_rows = np.flatnonzero(self.log_tau[indices])
        log_tau[fixed_time_rows, self.arm[indices][fixed_time_rows]] = target_values[indices][
            fixed_time_rows
        ]
        return log_tau

    def amount(
        self, log_tau: FloatArray, target_values: FloatArray, indices: IndexArray
    ) -> FloatArray:
        """Return the fixed coefficient, zero if there is none."""
        values = log_tau[np.arange(len(indices)), self.arm[indices]]
        of_b = np.exp(np.minimum(np.where(self.log_b[indices], target_values - values, 0.0), 600.0))
        return np.where(
            self.log_b[indices], of_b, np.where(self.log_tau[indices], 0.0, target_values)
        )
