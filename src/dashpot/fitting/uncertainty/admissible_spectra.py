r"""All the spectra that a relaxation test cannot reject.

On a grid of relaxation times, a spectrum is :math:`k_\infty, b, k_i \ge 0`. The test rejects it if
its chi-square lies more than a quantile above that of the best of them. The reach of a stiffness
:math:`v \cdot k` over all that are left is where

.. math:: h(t) = \min_{k \ge 0,\; v \cdot k = t} |y - R k|^2

rises to that limit: non-negative least squares with one heavy row, and a root in t.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.relaxation_data import RelaxationData

PER_DECADE = 16
# the grid ends this far, as a factor, beyond what frequencies and tests could tell apart
BEYOND = 10.0
HEAVY = 1e4
STEPS = 40
CLOSE = 1e-3


class Spectra:
    """The non-negative spectra of some relaxation tests, at a deviance limit.

    Columns are k_inf, b, then arms on a grid of relaxation times.
    """

    def __init__(
        self, relaxations: Sequence[RelaxationData], *, fastest: float, limit: float
    ) -> None:
        shortest = min(relaxation.block.window[0] for relaxation in relaxations)
        longest = max(relaxation.block.window[1] for relaxation in relaxations)
        low = np.log(min(shortest, 1 / (BEYOND * fastest)))
        high = np.log(longest)
        count = int(np.ceil((high - low) / np.log(10) * PER_DECADE)) + 1
        log_tau = np.linspace(low, high, count)
        self.tau = np.exp(log_tau)
        self.limit = limit
        parts = [relaxation.rows(log_tau, slopes=False) for relaxation in relaxations]
        rows = np.vstack([np.column_stack([p.spring, p.dashpot, p.arms]) for p in parts])
        target = np.concatenate([part.target for part in parts])
        self.scale = np.linalg.norm(rows, axis=0)
        # what is orthogonal to every column is the same for all spectra
        basis = np.linalg.qr(rows / self.scale)[0]
        self.rows, self.target = basis.T @ (rows / self.scale), basis.T @ target
        self.best, self.least = self._nnls(self.rows, self.target)

    def columns_at(self, omega: float) -> tuple[FloatArray, FloatArray]:
        """Storage and loss of unit columns at omega, rad/s: shapes (m,)."""
        x = omega * self.tau
        storage = np.concatenate(([1.0, 0.0], x * x / (1 + x * x)))
        loss = np.concatenate(([0.0, omega], x / (1 + x * x)))
        return storage, loss

    def value(self, v: FloatArray) -> float:
        """V . k of the best spectrum."""
        return float(v @ (self.best / self.scale))

    def reach(self, v: FloatArray) -> tuple[float, float]:
        """Smallest and largest v . k that the tests cannot reject; v >= 0 or of any sign."""
        start = self.value(v)
        step = max(abs(start), 1e-12) * 0.01
        # a quantity that cannot be negative has its lowest value at zero
        bottom = 0.0 if (v >= 0).all() else -np.inf
        return (
            self._edge(lambda t: self._deviance(v, t), start, -step, bottom),
            self._edge(lambda t: self._deviance(v, t), start, step, -np.inf),
        )

    def ratio_reach(self, above: FloatArray, below: FloatArray) -> tuple[float, float]:
        """Smallest and largest (above . k) / (below . k)."""
        start = self.value(above) / self.value(below)
        step = max(start * 0.02, 1e-6)

        def deviance(ratio: float) -> float:
            return self._deviance(above - ratio * below, 0.0)

        return (
            self._edge(deviance, start, -step, 0.0),
            self._edge(deviance, start, step, -np.inf),
        )

    def _deviance(self, v: FloatArray, t: float) -> float:
        """How much the best chi-square rises if v . k must be t."""
        row = v / self.scale
        # heavy against what the best spectrum puts into the row, so that t is met to 1e-6
        size = max(abs(t), float(np.abs(row) @ self.best))
        weight = HEAVY * np.sqrt(self.limit) / size
        k, _ = self._nnls(np.vstack((self.rows, weight * row)), np.append(self.target, weight * t))
        misfit = self.rows @ k - self.target
        return float(misfit @ misfit) - self.least

    def _edge(
        self, deviance: Callable[[float], float], start: float, step: float, bottom: float
    ) -> float:
        """Walk from the best spectrum until the deviance is at its limit, then close in."""
        goal = float(np.sqrt(self.limit))
        inside, root_inside = start, 0.0
        outside, root_outside = np.nan, np.inf
        for _ in range(STEPS):
            at = (
                inside + step
                if np.isnan(outside)
                else _between(inside, root_inside, outside, root_outside, goal)
            )
            at = max(at, bottom)
            root = float(np.sqrt(max(deviance(at), 0.0)))
            if root <= goal:
                inside, root_inside = at, root
                if at == bottom:
                    return bottom
                step *= 4 if root < goal / 4 else 2
            else:
                outside, root_outside = at, root
            width = abs(outside - inside)
            if goal - root_inside < CLOSE * goal or width < CLOSE * abs(inside - start):
                break
        return inside

    def _nnls(self, rows: FloatArray, target: FloatArray) -> tuple[FloatArray, float]:
        from scipy.optimize import nnls

        k, norm = nnls(rows, target, maxiter=30 * rows.shape[1])
        return k, float(norm) ** 2


def _between(inside: float, low: float, outside: float, high: float, goal: float) -> float:
    """Where a straight line between both would meet the goal, kept away from the ends."""
    part = (goal - low) / (high - low) if np.isfinite(high) else 0.5
    return inside + float(np.clip(part, 0.05, 0.95)) * (outside - inside)
