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
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.solver.descent import Stack

#: a relaxation time is walked so far, as a factor, out of the window
BEYOND = 20.0
_POINTS = 40
_ITERATIONS = 30
_RISE = 0.7


class Coordinate(Enum):
    """What is held while everything else is fitted again."""

    LINEAR = "a linear parameter"
    LOG_TAU = "ln tau of an arm"
    LOG_B = "ln(k tau) of an arm"


class Optimum(NamedTuple):
    """Where a profile starts: the linear parameters (p,) and ln tau (N,) of the best fit."""

    beta: FloatArray
    log_tau: FloatArray


def profile(
    stack: Stack,
    optimum: Optimum,
    coordinate: Coordinate,
    index: int,
    *,
    step: float,
    scale: float,
    limit: float,
    relative_gain: Callable[[FloatArray, FloatArray], float] | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return trial values, ascending, and the deviance of each; the optimum is among them.

    Parameters
    ----------
    stack : Stack
        The data of the fit.
    optimum : Optimum
    coordinate, index
        Which parameter: of the linear ones for ``LINEAR``, of the relaxation times for
        ``LOG_TAU``, of the arms' stiffnesses, group by group, for ``LOG_B``; from 0.
    step : float
        First distance from the optimum, about half a standard error.
    scale : float
        kappa s^2, what one unit of deviance costs in SSE.
    limit : float
        The walk ends where the deviance exceeds this, or where the window of the data ends.
    relative_gain : callable, optional
        How many times the noise at the optimum meets the way from there to linear parameters
        and ln tau; once, if left out.
    """
    held = _Held(stack, coordinate, index, len(optimum.beta))
    start = np.concatenate((optimum.beta, optimum.log_tau))
    best = held.sse(start)

    def deviance_at(point: FloatArray) -> float:
        times = (
            1.0
            if relative_gain is None
            else relative_gain(point[: held.linear], point[held.linear :])
        )
        return max(held.sse(point) - best, 0.0) / (scale * times)

    sides = [
        _walk(held, start, deviance_at, step=sign * step, tolerance=1e-4 * scale, limit=limit)
        for sign in (-1.0, 1.0)
    ]
    values = [*reversed(sides[0]), (held.value(start), 0.0), *sides[1]]
    value, deviance = np.array(values).T
    return value, deviance


def _walk(
    held: _Held,
    start: FloatArray,
    deviance_at: Callable[[FloatArray], float],
    *,
    step: float,
    tolerance: float,
    limit: float,
) -> list[tuple[float, float]]:
    low, high = held.range
    point, value, root = start.copy(), held.value(start), 0.0
    walked: list[tuple[float, float]] = []
    leapt: list[tuple[float, float]] = []
    for _ in range(_POINTS):
        nearest = min(max(value + step, low), high)
        if nearest == value:
            break
        step = nearest - value
        there = held.fitted(point, nearest, tolerance=tolerance)
        deviance = deviance_at(there)
        rise = float(np.sqrt(deviance)) - root
        # aim at a rise in the root of the deviance over which interpolation is good
        step *= float(np.clip(_RISE / max(rise, 1e-3), 0.1, 2.0))
        if rise > 2.0 * _RISE:
            # too far to interpolate to: walk towards it in smaller steps
            leapt = [(nearest, deviance)]
            continue
        walked.append((nearest, deviance))
        point, value, root = there, nearest, root + rise
        if deviance > limit:
            return walked
    passed = bool(walked) and bool(leapt) and (leapt[0][0] - walked[-1][0]) * step <= 0
    return walked if passed else walked + leapt


class _Held:
    """The least-squares problem with one coordinate held: p = (beta, ln tau), one number fixed."""

    def __init__(self, stack: Stack, coordinate: Coordinate, index: int, linear: int) -> None:
        self.stack = stack
        self.coordinate = coordinate
        self.index = index
        self.linear = linear
        self.first_arm = len(stack.names)
        arms = (linear - self.first_arm) // len(stack.groups)
        self.arm = index % arms if coordinate is Coordinate.LOG_B else index
        low, high = stack.bounds
        self.range = {
            Coordinate.LINEAR: (0.0, np.inf),
            Coordinate.LOG_TAU: (low, high),
            Coordinate.LOG_B: (-np.inf, np.inf),
        }[coordinate]

    def value(self, point: FloatArray) -> float:
        if self.coordinate is Coordinate.LINEAR:
            return float(point[self.index])
        log_tau = float(point[self.linear + self.arm])
        if self.coordinate is Coordinate.LOG_TAU:
            return log_tau
        return log_tau + float(np.log(point[self.first_arm + self.index]))

    def placed(self, point: FloatArray, value: float) -> FloatArray:
        """Return the point moved so that the held coordinate has `value`."""
        point = point.copy()
        if self.coordinate is Coordinate.LINEAR:
            point[self.index] = value
        elif self.coordinate is Coordinate.LOG_TAU:
            point[self.linear + self.index] = value
        else:
            log_tau = point[self.linear + self.arm]
            point[self.first_arm + self.index] = np.exp(min(value - log_tau, 600.0))
        return point

    def sse(self, point: FloatArray) -> float:
        residual, _ = self._evaluate(point, derivative=False)
        return float(residual @ residual)

    def fitted(self, point: FloatArray, value: float, *, tolerance: float) -> FloatArray:
        """Return the best point with the held coordinate at `value`, by Levenberg-Marquardt."""
        here = self.placed(point, value)
        residual, jacobian = self._evaluate(here)
        sse = float(residual @ residual)
        damping = 1e-6
        for _ in range(_ITERATIONS):
            norm = np.sqrt((jacobian * jacobian).sum(axis=0))
            norm = np.where(norm > 0, norm, 1.0)
            scaled = jacobian / norm
            normal = scaled.T @ scaled
            normal[np.diag_indices_from(normal)] += damping
            move = np.linalg.solve(normal, scaled.T @ residual) / norm
            trial = self._moved(here, move, value)
            new_residual, new_jacobian = self._evaluate(trial)
            new = float(new_residual @ new_residual)
            gain = sse - new
            if gain > 0:
                here, residual, jacobian, sse = trial, new_residual, new_jacobian, new
                damping = max(0.1 * damping, 1e-12)
            else:
                damping = 10.0 * damping
            if abs(gain) < tolerance or damping > 1e6:
                break
        return here

    def _moved(self, here: FloatArray, move: FloatArray, value: float) -> FloatArray:
        trial = here.copy()
        free = np.delete(np.arange(len(here)), self._dropped)
        trial[free] += move
        low, high = self.stack.bounds
        outside = float(np.log(BEYOND))
        trial[self.linear :] = np.clip(trial[self.linear :], low - outside, high + outside)
        return self.placed(trial, value)

    @property
    def _dropped(self) -> int:
        """The entry of the point that follows from the held value."""
        if self.coordinate is Coordinate.LINEAR:
            return self.index
        if self.coordinate is Coordinate.LOG_TAU:
            return self.linear + self.index
        return self.first_arm + self.index

    def _evaluate(
        self, point: FloatArray, *, derivative: bool = True
    ) -> tuple[FloatArray, FloatArray]:
        """Return the residual and the Jacobian of the model by the free entries."""
        beta, log_tau = point[: self.linear], point[self.linear :]
        rows = self.stack.evaluate(log_tau, derivative=derivative)
        residual = rows.target - rows.phi @ beta
        if not derivative:
            return residual, rows.phi
        arms = len(log_tau)
        bent = rows.slope * beta[self.first_arm :]
        by_tau = bent.reshape(len(residual), -1, arms).sum(axis=1)
        if self.coordinate is Coordinate.LOG_B:
            # k = exp(ln b - ln tau): the arm's stiffness falls as its ln tau rises
            column = self.first_arm + self.index
            by_tau[:, self.arm] -= rows.phi[:, column] * beta[column]
        jacobian = np.concatenate((rows.phi, by_tau), axis=1)
        return residual, np.delete(jacobian, self._dropped, axis=1)
