"""From weighted curves to a Fit: what modulus and dynamic data share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import Block, Evaluation
from dashpot.engine.order import Choice, choose
from dashpot.engine.separable import Solution, solve, solve_orders
from dashpot.relaxation.estimate import (
    Estimate,
    Score,
    effective_samples,
    estimated,
    scored,
)
from dashpot.relaxation.fit import OrderScore
from dashpot.relaxation.verdict import solid_of
from dashpot.solids.maxwell import GeneralizedMaxwell

# a scatter below this part of the largest value is rounding
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Weighted:
    """A block whose every row is multiplied by one factor, 1/sd."""

    block: Block
    factor: float

    @property
    def floor(self) -> float:  # noqa: D102
        return self.factor**2 * self.block.floor

    @property
    def grain(self) -> float:  # noqa: D102
        return self.factor**2 * self.block.grain

    @property
    def energy(self) -> float:  # noqa: D102
        return self.factor**2 * self.block.energy

    @property
    def sampling(self) -> None:  # noqa: D102
        return None

    @property
    def turning(self) -> bool:  # noqa: D102
        return self.block.turning

    @property
    def samples(self) -> int:  # noqa: D102
        return self.block.samples

    @property
    def fixed_names(self) -> tuple[str, ...]:  # noqa: D102
        return self.block.fixed_names

    @property
    def arm_group(self) -> str:  # noqa: D102
        return self.block.arm_group

    @property
    def exact(self) -> Weighted:  # noqa: D102
        return Weighted(self.block.exact, self.factor)

    @property
    def window(self) -> tuple[float, float]:  # noqa: D102
        return self.block.window

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """Return target and design matrix, weighted."""
        return Evaluation(
            *(self.factor * part for part in self.block.evaluate(log_tau, derivative))
        )


class Chosen(NamedTuple):
    """The optimum for the number of arms taken, its uncertainty, and every number tried."""

    estimate: Estimate
    scores: tuple[Score, ...]
    choice: Choice | None

    @property
    def solution(self) -> Solution:
        """The optimum."""
        return self.estimate.solution

    @property
    def orders(self) -> tuple[OrderScore, ...]:
        """Every number of arms tried, as the fit tells it."""
        return tuple(
            OrderScore(
                score.solution.order, score.solution.sse, score.bic, score.significant,
                model_of(score.solution),
            )
            for score in self.scores
        )  # fmt: skip


def chosen_arms(
    blocks: Sequence[Block],
    samples: Sequence[Block],
    most: int,
    *,
    auto: bool,
    peak: float,
    thorough: bool = False,
) -> Chosen:
    """Fit every number of arms up to `most`; take the number that the data support, or `most`.

    Parameters
    ----------
    blocks, samples : sequences of Block
        The data to solve, and the same with a row per sample, one block per record.
    most : int
    auto : bool
        Choose by BIC and significance; otherwise take `most`, or as many as the data bear.
    peak : float
        Largest target: it sets what rounding alone leaves.
    thorough : bool
        Add quasi-random starts.
    """
    if auto:
        most = bearable(blocks, most)
    solutions = [solve(blocks, 0)]
    if most:
        solutions += [s for s in solve_orders(blocks, most, thorough=thorough) if s.order]
    effective = effective_samples(solutions[-1], samples, peak=peak)
    scores = tuple(
        scored(one, blocks, samples, effective=effective, peak=peak) for one in solutions
    )
    choice = choose(
        range(len(scores)),
        [score.bic for score in scores],
        [score.significant for score in scores],
    )
    taken = choice.arms if auto else min(most, len(scores) - 1)
    estimate = estimated(scores[taken].solution, samples, peak=peak)
    return Chosen(estimate, scores, choice if auto else None)


class Alone(NamedTuple):
    """The best that one test allows: its solid, and the scatter that each of its records leaves.

    Attributes
    ----------
    model : GeneralizedMaxwell
    scatter : tuple of float
        Spread of one independent residual (rms times root kappa) of each record, never below
        the rounding of the data.
    """

    model: GeneralizedMaxwell
    scatter: tuple[float, ...]


def alone(blocks: Sequence[Block], samples: Sequence[Block], most: int) -> Alone:
    """Fit one test with as many arms as it bears, up to `most`."""
    most = bearable(blocks, most)
    best = solve_orders(blocks, most)[-1] if most else solve(blocks, 0)
    peaks = [_largest(block, best) for block in samples]
    estimate = estimated(best, samples, peak=max(peaks))
    spreads = [
        float(np.sqrt(np.mean(residual**2) * noise.kappa))
        for residual, noise in zip(estimate.residuals, estimate.noises, strict=True)
    ]
    return Alone(
        model_of(best),
        tuple(max(one, ROUNDING * (peak or 1.0)) for one, peak in zip(spreads, peaks, strict=True)),
    )


def bearable(blocks: Sequence[Block], most: int) -> int:
    """Return how many of `most` arms the data have samples enough for, with two to spare."""
    names = {name for block in blocks for name in block.fixed_names}
    spare = sum(block.samples for block in blocks) - len(names) - 2
    return max(min(most, spare // 2), 0)


def _largest(block: Block, solution: Solution) -> float:
    return float(np.abs(block.evaluate(solution.log_tau, derivative=False).target).max())


def model_of(solution: Solution) -> GeneralizedMaxwell:
    """Return the solid of a solution with one group of arms, and its parallel dashpot."""
    solid = solid_of(solution, "")
    if "b" not in solution.fixed_names:
        return solid
    return replace(solid, b=max(solution.coefficient("b"), 0.0))


def rows_of(estimate: Estimate) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of the model's parameters and their covariance."""
    solution = estimate.solution
    there = np.flatnonzero(solution.arms[0] > 0) + 1
    numbers = range(1, len(there) + 1)
    names = ["k_inf", *(f"k_{j}" for j in numbers), *(f"ln_tau_{j}" for j in numbers)]
    rows = ["k_inf", *(f"k_{j}" for j in there), *(f"ln_tau_{j}" for j in there)]
    if "b" in solution.fixed_names:
        names.append("b")
        rows.append("b")
    index = [estimate.names.index(row) for row in rows]
    return tuple(names), estimate.covariance[np.ix_(index, index)]
