r"""Profile likelihood: how bad the best fit becomes when one parameter is held at a value.

.. math:: D(v) = \frac{\min_{\theta:\,g(\theta)=v} \mathrm{SSE}(\theta) - \mathrm{SSE}_{\min}}
                      {\kappa s^2}

compared with the square of Student's t. Unlike a standard error it sees that a likelihood is
skewed, or open on one side. Source: D. M. Bates and D. G. Watts, *Nonlinear Regression Analysis
and Its Applications* (1988), ch. 6.

The noise of a correlated record has its own gain for each change of the model, and a profile that
bends walks from one kind of change to another: with :math:`d(v)` the change of the model on
the way from the optimum to v, :math:`\kappa s^2` grows as :math:`d'\Gamma d / d'd`. In a linear
model that is constant, and the deviance is the square of (v - optimum) / SE by the sandwich.

Everything else is fitted by variable projection: the linear parameters are solved exactly at each
trial of the relaxation times. Both sides of every profile asked for walk together, so that one
trial of all of them costs about what one of one costs; their columns are interpolated from a table.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.engine.inference.descents import Descents, Solved
from dashpot.engine.solver.descent import Stack

#: a relaxation time is walked so far, as a factor, out of the window
BEYOND = 20.0
#: a stiffness so many times that of the whole solid, or a b so many folds from the optimum, is open
_OPEN_STIFFNESS, _OPEN_FOLDS = 1e4, 16.0
#: ln tau between nodes of the table; cubics through columns and slopes are right to 1e-7
_NODES_APART = 0.08
#: points of a walk, and how many of them may be too far: beyond there is a cliff
_POINTS, _LEAPS = 20, 5
#: an arm whose absence costs less deviance is one that the data do without
_SPARE = 2.0
#: first step of an arm in the place of another, as a part of the way to it
_KNOWN = 1e-3
#: the walk steps by a rise of the root of the deviance over which interpolation is good
_RISE, _RISES = 0.7, 5.0
#: a change of ln tau from one point of a walk to the next that may be foretold
_FORETOLD = 0.1
_RIDGE = 1e-13


class Coordinate(Enum):
    """What is held while everything else is fitted again."""

    LINEAR = "a linear parameter"
    LOG_TAU = "ln tau of an arm"
    LOG_B = "ln(k tau) of an arm"


class Optimum(NamedTuple):
    """Where a profile starts: the linear parameters (p,) and ln tau (N,) of the best fit."""

    beta: FloatArray
    log_tau: FloatArray


@dataclass(frozen=True)
class Asked:
    """Whose profile is asked for.

    Attributes
    ----------
    coordinate, index
        Which parameter: of the linear ones for ``LINEAR``, of the relaxation times for
        ``LOG_TAU``, of the arms' stiffnesses, group by group, for ``LOG_B``; from 0.
    step : float
        First distance from the optimum, about half a standard error.
    scale : float
        kappa s^2, what one unit of deviance costs in SSE.
    relative_gain : callable, optional
        How many times the noise at the optimum meets the way from there to linear parameters
        and ln tau; once, if left out.
    """

    coordinate: Coordinate
    index: int
    step: float
    scale: float
    relative_gain: Callable[[FloatArray, FloatArray], float] | None = None


def profiles(
    stack: Stack, optimum: Optimum, asked: Sequence[Asked], *, limit: float
) -> list[tuple[FloatArray, FloatArray]]:
    """Return of each profile the trial values, ascending, the optimum among them, and deviances.

    Parameters
    ----------
    stack : Stack
        The data of the fit, in rows that do not depend on tau.
    optimum : Optimum
    asked : sequence of Asked
    limit : float
        A walk ends where the deviance exceeds this, or where the data say no more: at the edge
        of their window, or where a stiffness has grown out of all proportion.
    """
    together = _Together(stack, optimum)
    walks = [
        _Walk(one, together.value(one), sign, limit, together.range(one))
        for one in asked
        for sign in (-1.0, 1.0)
    ]
    together.walk(walks)
    found = []
    for low, high in zip(walks[::2], walks[1::2], strict=True):
        points = [*reversed(low.points), (low.start, 0.0), *high.points]
        value, deviance = np.array(points).T
        found.append((value, deviance))
    return found


class _Walk:
    """One side of one profile: where it stands and where it goes next."""

    def __init__(
        self, asked: Asked, start: float, sign: float, limit: float, ends: tuple[float, float]
    ) -> None:
        self.asked, self.start, self.limit, self.ends = asked, start, limit, ends
        self.rise = max(_RISE, float(np.sqrt(limit)) / _RISES)
        self.step, self.root, self.at = sign * asked.step, 0.0, start
        self.walked: list[tuple[float, float]] = []
        self.leapt: list[tuple[float, float]] = []
        self.trials = self.leaps = 0
        self.ended = self.exchanged = False
        self.goal = start
        self._aim()

    @property
    def points(self) -> list[tuple[float, float]]:
        """Values and deviances on the way out."""
        if not self.leapt or self.root > np.sqrt(self.limit):
            return self.walked
        # a leap that the walk has passed says nothing of the way
        passed = self.walked and (self.leapt[0][0] - self.walked[-1][0]) * self.step <= 0
        return self.walked if passed else self.walked + self.leapt

    def arrived(self, deviance: float) -> bool:
        """Take note of the deviance at the goal; True if the walk goes on from there."""
        rise = float(np.sqrt(deviance)) - self.root
        self.step *= float(np.clip(self.rise / max(rise, 1e-3), 0.1, 3.0))
        near = rise <= 2.0 * self.rise
        if near:
            self.walked.append((self.goal, deviance))
            self.at, self.root = self.goal, self.root + rise
        else:
            # too far to interpolate to: walk towards it in smaller steps
            self.leapt = [(self.goal, deviance)]
            self.leaps += 1
        self.ended = (near and deviance > self.limit) or self.leaps > _LEAPS
        self._aim()
        return near

    @property
    def without(self) -> bool:
        """True if the stiffness walked has arrived at zero, at no cost to speak of."""
        last = self.walked[-1] if self.walked else (self.start, np.inf)
        return self.asked.coordinate is Coordinate.LINEAR and last[0] == 0.0 and last[1] < _SPARE

    def exchange(self, value: float) -> None:
        """Go on from a value at which its arm and another have changed places."""
        self.exchanged, self.leapt, self.leaps = True, [], 0
        # the other arm is far better known than this one
        self.goal, self.step = value, _KNOWN * (value - self.start)

    def _aim(self) -> None:
        self.goal = min(max(self.at + self.step, self.ends[0]), self.ends[1])
        self.step = self.goal - self.at
        self.ended = self.ended or self.trials >= _POINTS or self.step == 0.0
        self.trials += 1


class _Together:
    """The least-squares problems of many profiles, each with one coordinate held."""

    def __init__(self, stack: Stack, optimum: Optimum) -> None:
        self.optimum, self.fixed = optimum, len(stack.names)
        self.arms, self.groups = len(optimum.log_tau), len(stack.groups)
        outside = float(np.log(BEYOND))
        self.window = stack.bounds
        self.restricted = stack.restricted(self.arms, signed=False)
        self.reach = stack.bounds[0] - outside, stack.bounds[1] + outside
        count = int(np.ceil((self.reach[1] - self.reach[0]) / _NODES_APART)) + 1
        self.nodes, self.apart = np.linspace(*self.reach, count, retstep=True)
        rows = stack.evaluate(self.nodes)
        self.target, self.still = rows.target, rows.phi[:, : self.fixed].T

        def by_node(columns: FloatArray) -> FloatArray:
            shape = (len(self.target), self.groups, count)
            return np.ascontiguousarray(columns.reshape(shape).transpose(2, 1, 0))

        # node, group, row
        self.columns = by_node(rows.phi[:, self.fixed :])
        self.slopes = by_node(rows.slope)
        start = self._phi(optimum.log_tau[None])[0][0]
        self.best = float(np.square(self.target - optimum.beta @ start).sum())

    def value(self, asked: Asked) -> float:
        """The held coordinate at the optimum."""
        beta, log_tau = self.optimum
        if asked.coordinate is Coordinate.LINEAR:
            return float(beta[asked.index])
        arm = asked.index % self.arms
        if asked.coordinate is Coordinate.LOG_TAU:
            return float(log_tau[arm])
        return float(log_tau[arm] + np.log(beta[self.fixed + asked.index]))

    def range(self, asked: Asked) -> tuple[float, float]:
        """How far the held coordinate goes."""
        if asked.coordinate is Coordinate.LOG_TAU:
            return self.window
        if asked.coordinate is Coordinate.LINEAR:
            return 0.0, _OPEN_STIFFNESS * float(np.abs(self.optimum.beta).max())
        start = self.value(asked)
        return start - _OPEN_FOLDS, start + _OPEN_FOLDS

    def walk(self, walks: Sequence[_Walk]) -> None:
        """Walk every side to its end.

        An arm that the data do without may have any relaxation time: those sides stay open. Where
        its stiffness or b meets a cliff it goes on in the place of the largest other arm, which
        then is the one that the data do without.
        """
        spare = set[int]()
        held = _Held(walks, self.fixed, self.arms, len(self.optimum.beta))
        left = np.tile(self.optimum.log_tau, (len(walks), 1))
        goal = np.array([walk.goal for walk in walks])
        tolerance = np.array([1e-3 * walk.asked.scale for walk in walks])
        descents = Descents(left, len(self.optimum.beta), tolerance)
        here, known = descents.here, descents.known
        while (on := np.flatnonzero([not walk.ended for walk in walks])).size:
            trial = np.clip(here[on] + descents.move[on], *self.reach)
            trial = held.placed(trial, goal, on)
            done = descents.take(trial, self._solved(trial, goal[on], held, on), on)
            for i in on[done]:
                walk, at, foretold = walks[i], walks[i].at, np.zeros(self.arms)
                if walk.arrived(self._deviance(walk, known.beta[i], here[i], descents.least(i))):
                    foretold = (here[i] - left[i]) * (walk.goal - walk.at) / (walk.at - at)
                    left[i] = here[i]
                if np.abs(foretold).max(initial=0.0) > _FORETOLD:
                    foretold[:] = 0.0
                descents.start(i, left[i] + foretold)
                goal[i] = walk.goal
                if walk.without:
                    spare |= held.arm_of(i)
            for i in on.tolist():
                if not held.arm_of(i) & spare:
                    continue
                walk = walks[i]
                walk.ended = walk.ended or bool(held.log_tau[i])
                if walk.leaps and not walk.exchanged:
                    left[i] = self._exchanged(walk, left[i])
                    descents.start(i, left[i])
                    goal[i] = walk.goal

    def _exchanged(self, walk: _Walk, log_tau: FloatArray) -> FloatArray:
        """Where a walk goes on if its arm takes the place of the largest other arm, if it can."""
        index = walk.asked.index - (self.fixed if walk.asked.coordinate is Coordinate.LINEAR else 0)
        first, arm = index - index % self.arms, index % self.arms
        k = self.optimum.beta[self.fixed + first :][: self.arms]
        value = (
            k if walk.asked.coordinate is Coordinate.LINEAR else self.optimum.log_tau + np.log(k)
        )
        value = np.where(np.arange(self.arms) == arm, -np.inf, value)
        other = int(np.argmax(value))
        if not walk.at < value[other]:
            walk.exchanged = True
            return log_tau
        walk.exchange(float(value[other]))
        turned = self.optimum.log_tau.copy()
        turned[[arm, other]] = turned[[other, arm]]
        return turned

    def _deviance(self, walk: _Walk, beta: FloatArray, log_tau: FloatArray, sse: float) -> float:
        gain = walk.asked.relative_gain
        times = 1.0 if gain is None else gain(beta, log_tau)
        return max(float(sse) - self.best, 0.0) / (walk.asked.scale * times)

    def _phi(self, log_tau: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Design matrix (A, p, n) and its slopes by ln tau (A, G, N, n), from the table."""
        place = (log_tau.ravel() - self.reach[0]) / self.apart
        node = np.clip(place.astype(int), 0, len(self.nodes) - 2)
        u = (place - node)[:, None, None]
        below, above = self.columns[node], self.columns[node + 1]
        rise, fall = self.apart * self.slopes[node], self.apart * self.slopes[node + 1]
        change = above - below
        bend, twist = 3 * change - 2 * rise - fall, rise + fall - 2 * change
        column = below + u * (rise + u * (bend + u * twist))
        slope = (rise + u * (2 * bend + 3 * u * twist)) / self.apart
        shape = (*log_tau.shape, self.groups, len(self.target))
        arms, slopes = (part.reshape(shape).swapaxes(1, 2) for part in (column, slope))
        trials = len(log_tau)
        still = np.broadcast_to(self.still, (trials, *self.still.shape))
        return np.concatenate((still, arms.reshape(trials, -1, len(self.target))), axis=1), slopes

    def _solved(self, log_tau: FloatArray, goal: FloatArray, held: _Held, on: IndexArray) -> Solved:
        phi, slopes = self._phi(log_tau)
        each, arm, column = np.arange(len(on)), held.arm[on], held.column[on]
        amount = held.amount(log_tau, goal, on)
        target = self.target - amount[:, None] * phi[each, column]
        normal = _Normal(phi, held.free[on])
        beta = normal.solved(phi @ target[:, :, None])[..., 0]
        # what must not be negative rests at zero, the worst first
        while (beta[:, self.restricted] < 0).any():
            worst = np.where(self.restricted, beta, 0.0).argmin(axis=1)
            negative = np.where(self.restricted, beta, 0.0).min(axis=1) < 0
            normal.free[each[negative], worst[negative]] = False
            beta = normal.solved(phi @ target[:, :, None])[..., 0]
        residual = target - (beta[:, None, :] @ phi)[:, 0]
        beta[each, column] += amount
        stiffness = beta[:, self.fixed :].reshape(len(on), self.groups, self.arms)
        turned = (slopes * stiffness[..., None]).sum(axis=1)
        # k = exp(ln b - ln tau): the stiffness of an arm whose b is held falls as its ln tau rises
        turned[each, arm] -= (amount * held.log_b[on])[:, None] * phi[each, column]
        bent = turned - normal.solved(phi @ turned.swapaxes(1, 2)).swapaxes(1, 2) @ phi
        gradient = np.vecdot(bent, residual[:, None, :])
        curvature = bent @ bent.swapaxes(1, 2)
        moves = np.ones(log_tau.shape)
        moves[each, arm] = ~held.log_tau[on]
        return Solved(
            np.vecdot(residual, residual),
            beta,
            gradient * moves,
            curvature * moves[:, :, None] * moves[:, None, :],
        )


class _Normal:
    """Normal equations of many design matrices (A, p, n), some columns left out of each."""

    def __init__(self, phi: FloatArray, free: BoolArray) -> None:
        gram = phi @ phi.swapaxes(1, 2)
        length = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
        self.length = np.where(length > 0, length, 1.0)
        self.gram = gram / (self.length[:, :, None] * self.length[:, None, :])
        self.free = free.copy()

    def solved(self, moment: FloatArray) -> FloatArray:
        """Coefficients (A, p, r) that answer moments of that shape; zero of what is left out."""
        free = self.free[:, :, None]
        gram = np.where(free & self.free[:, None, :], self.gram, 0.0)
        place = np.arange(gram.shape[1])
        gram[:, place, place] = 1.0 + _RIDGE
        scaled = np.where(free, moment / self.length[:, :, None], 0.0)
        return np.asarray(np.linalg.solve(gram, scaled) / self.length[:, :, None])


class _Held:
    """Which coordinate each side holds."""

    def __init__(self, walks: Sequence[_Walk], fixed: int, arms: int, linear: int) -> None:
        kinds = [walk.asked.coordinate for walk in walks]
        index = np.array([walk.asked.index for walk in walks])
        self.fixed = fixed
        self.log_tau = np.array([kind is Coordinate.LOG_TAU for kind in kinds])
        self.log_b = np.array([kind is Coordinate.LOG_B for kind in kinds])
        # where a relaxation time is held no coefficient is, and the column named stays free
        self.column: IndexArray = np.where(self.log_b | self.log_tau, fixed + index, index)
        self.arm: IndexArray = np.where(self.column >= fixed, (self.column - fixed) % arms, 0)
        self.free: BoolArray = np.ones((len(walks), linear), dtype=bool)
        self.free[np.arange(len(walks)), self.column] = self.log_tau

    def arm_of(self, walk: int) -> set[int]:
        """The arm that a side belongs to; none of a fixed column."""
        return {int(self.arm[walk])} if self.column[walk] >= self.fixed else set()

    def placed(self, log_tau: FloatArray, goal: FloatArray, on: IndexArray) -> FloatArray:
        """The trials with a held relaxation time at its goal."""
        there = np.flatnonzero(self.log_tau[on])
        log_tau[there, self.arm[on][there]] = goal[on][there]
        return log_tau

    def amount(self, log_tau: FloatArray, goal: FloatArray, on: IndexArray) -> FloatArray:
        """The coefficient that is held, zero where none is."""
        own = log_tau[np.arange(len(on)), self.arm[on]]
        of_b = np.exp(np.minimum(np.where(self.log_b[on], goal - own, 0.0), 600.0))
        return np.where(self.log_b[on], of_b, np.where(self.log_tau[on], 0.0, goal))
