"""One side of one profile: the values to try, and when enough is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from dashpot.base.arrays import FloatArray

#: points of a walk, and how many of them may be too far: beyond there is a cliff
_POINTS, _LEAPS = 20, 5
#: an arm whose absence costs less deviance is one that the data do without
_SPARE = 2.0
#: the walk steps by a rise of the root of the deviance over which interpolation is good
_RISE, _RISES = 0.7, 5.0


class Coordinate(Enum):
    """What is held while everything else is fitted again."""

    LINEAR = "a linear parameter"
    LOG_TAU = "ln tau of an arm"
    LOG_B = "ln(k tau) of an arm"


@dataclass(frozen=True)
class ProfileTarget:
    """A parameter whose profile is asked for.

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


class ProfileTrace:
    """One side of one profile: where it stands and where it goes next."""

    def __init__(
        self,
        target: ProfileTarget,
        start: float,
        sign: float,
        limit: float,
        ends: tuple[float, float],
    ) -> None:
        self.asked, self.start, self.limit, self.ends = target, start, limit, ends
        self.sign = sign
        self.rise = max(_RISE, float(np.sqrt(limit)) / _RISES)
        self.step, self.root, self.at = sign * target.step, 0.0, start
        self.walked: list[tuple[float, float]] = []
        self.leapt: list[tuple[float, float]] = []
        self.trials = self.leaps = 0
        self.ended, self.without = False, np.inf
        self.goal = start
        self._aim()

    @property
    def points(self) -> list[tuple[float, float]]:
        """Values and deviances on the way out."""
        met = self.walked
        if self.leapt and self.root <= np.sqrt(self.limit):
            # a leap that the walk has passed says nothing of the way
            passed = met and (self.leapt[0][0] - met[-1][0]) * self.step <= 0
            met = met if passed else met + self.leapt
        if not np.isfinite(self.without):
            return met
        far = self.ends[int(self.sign > 0)]
        least = [(value, min(deviance, self.without)) for value, deviance in met]
        there = far in (self.start, met[-1][0] if met else self.start)
        return least if there else [*least, (far, self.without)]

    def update_without_arm(self, without: float) -> None:
        """Take note of the deviance without its arm, which no value of the arm's exceeds."""
        if without < self.limit:
            self.without = self.limit = without
            self.ended = self.ended or without < _SPARE

    def update_walk(self, deviance: float) -> bool:
        """Take note of the deviance at the goal; True if the walk goes on from there."""
        rise = float(np.sqrt(deviance)) - self.root
        self.step *= min(max(self.rise / max(rise, 1e-3), 0.1), 3.0)
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

    def _aim(self) -> None:
        self.goal = min(max(self.at + self.step, self.ends[0]), self.ends[1])
        self.step = self.goal - self.at
        self.ended = self.ended or self.trials >= _POINTS or self.step == 0.0
        self.trials += 1
