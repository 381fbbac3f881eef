"""What a solid is fitted to, and how its noise weighs what was known before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.design_matrix import (
    FitSetup,
    bic_penalty_per_arm,
    bound,
    build_delay_blocks,
    solid_of,
)
from dashpot.fitting.nuisance_priors import ROUNDING
from dashpot.fitting.uncertainty.encoder_resolution import Encoder
from dashpot.fitting.uncertainty.solution_covariance import (
    estimate_covariance,
    residual_of,
    rounding,
)
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.log_tau_descent import Stack
from dashpot.numerics.exponential_fit.variable_projection import Solution, solve, solve_orders
from dashpot.numerics.inference.covariance import Noise, ResidualSeries, noise_of
from dashpot.solids.maxwell import GeneralizedMaxwell

# a prior whose assumed noise is within this factor of what the fit shows weighs what it should
_WEIGHED = (2 / 3, 3 / 2)
# a fit that expects less than this part of a value does not follow it: no ground for a weight
DOUBTED = 0.1


@dataclass(frozen=True, eq=False)
class FitData:
    """What a solid is fitted to.

    Attributes
    ----------
    blocks, samples : sequences of DataBlock
        The data to solve, and the same with a row per sample, one block per record.
    in_time : bool
        The samples are records in time: no more arms are tried than could gain what BIC asks for
        one, a decisive BIC overrules, and under noise as slow as the arms fits in its metric are
        judged.
    encoders : sequence of Encoder, optional
        Of each record, where the recorded motion is fitted.
    bind : callable, optional
        Makes the priors of nuisance terms from the standard deviation of one independent residual
        of each record, N; from None by what the records show before a fit.
    priors : tuple of DataBlock
        What was known of fixed coefficients before the data.
    """

    blocks: Sequence[DataBlock]
    samples: Sequence[DataBlock]
    in_time: bool = False
    encoders: Sequence[Encoder] | None = None
    bind: Callable[[Sequence[float] | None], tuple[DataBlock, ...]] | None = None
    priors: tuple[DataBlock, ...] = ()

    @property
    def rows(self) -> tuple[DataBlock, ...]:
        """The data to solve, and what was known before them."""
        return (*self.blocks, *self.priors)

    @property
    def full_rows(self) -> tuple[DataBlock, ...]:
        """A row per sample, and what was known before them."""
        return (*self.samples, *self.priors)

    @property
    def units(self) -> tuple[float, ...]:
        """The standard deviation of one independent residual that each prior assumes, N."""
        return tuple(float(np.sqrt(block.variance or 0.0)) for block in self.priors)

    def bound(self, spreads: Sequence[float] | None = None) -> FitData:
        """The data with priors whose weight is that of residuals with these spreads, N."""
        return self if self.bind is None else replace(self, priors=self.bind(spreads))

    @cached_property
    def peak(self) -> float:
        """Largest target: it sets what rounding alone leaves."""
        return max(_find_largest_target(block) for block in self.samples)


def data_of(
    records: Sequence[RampHold], design: FitSetup, near: FloatArray | None = None
) -> FitData:
    """Return the tests as data, with what is known of load cell and clocks.

    Whose solid has relaxation times `near` some is not searched for: they are given as ln tau.
    """
    blocks = build_delay_blocks(records, design, near)
    return FitData(
        blocks,
        [block.exact for block in blocks],
        in_time=True,
        encoders=None if design.method == "hold" else [*map(Encoder.from_record, records)],
        bind=partial(bound, records, blocks, design),
    )


class InitialFit(NamedTuple):
    """Data whose priors weigh as the noise does, and the solutions that showed the noise.

    Attributes
    ----------
    data : FitData
    solutions : sequence of Solution
        Every number of arms from none up, or the last alone.
    series : tuple of Series
        What the last of them leaves of each record, N: as it was before its priors were weighed.
    noises : tuple of Noise
    showed : Solution
        The one that left the series.
    """

    data: FitData
    solutions: Sequence[Solution]
    series: tuple[ResidualSeries, ...]
    noises: tuple[Noise, ...]
    showed: Solution

    @property
    def residuals(self) -> tuple[FloatArray, ...]:
        """The values of the series."""
        return tuple(series.values for series in self.series)

    def get_residual_series(self, solution: Solution) -> tuple[ResidualSeries, ...]:
        """What a solution leaves of each record, where that is at hand; else nothing."""
        return self.series if solution is self.showed else ()


def weighed(
    data: FitData,
    most: int,
    *,
    auto: bool = True,
    thorough: bool = False,
    only: bool = False,
    near: FloatArray | None = None,
) -> InitialFit:
    """Solve up to `most` arms, with priors that weigh as the noise does that is left.

    Where ``auto`` chooses the number, records in time need no more arms than one beyond those
    that could gain what BIC asks for one. ``only`` leaves out all but the last, which with `near`
    is the one next to these ln tau.
    """
    data = data.bound()

    def solve_once() -> Sequence[Solution]:
        least = bic_penalty_per_arm(data.rows) if data.in_time else 0.0
        if only:
            solution = solve(
                data.rows, most, log_tau_start=near, negligible=least, thorough=thorough
            )
            return (solution,)
        return solve_orders(data.rows, most, negligible=least, every=not auto, thorough=thorough)

    solutions = solve_once()
    series = tuple(ResidualSeries(residual_of(solutions[-1], block)) for block in data.samples)
    noises = tuple(
        noise_of(residual_series, rounding=rounding(data.peak)) for residual_series in series
    )
    spreads = [float(np.sqrt(noise.autocovariance[0] * noise.kappa)) for noise in noises]
    if all(_WEIGHED[0] < a / b < _WEIGHED[1] for a, b in zip(spreads, data.units, strict=False)):
        return InitialFit(data, solutions, series, noises, solutions[-1])
    data = data.bound(spreads)
    return InitialFit(data, solve_once(), series, noises, solutions[-1])


def max_determinable_arms(blocks: Sequence[DataBlock]) -> int:
    """Return how many arms the samples could determine at all, with two to spare."""
    stack = Stack(blocks)
    return max(0, (stack.samples - len(stack.names) - 2) // (1 + len(stack.groups)))


# -- data weighted by their own scatter -----------------------------------------------------------


class SingleTestFit(NamedTuple):
    """The best that one test allows: its solid, and the scatter that each of its records leaves.

    Attributes
    ----------
    model : GeneralizedMaxwell
    scatter : tuple of float
        Spread of one independent residual (rms times root kappa) of each record, for the freedom
        that the fit took; never below the rounding of the data.
    freedom : tuple of float
        Degrees of freedom that the fit left of each record.
    """

    model: GeneralizedMaxwell
    scatter: tuple[float, ...]
    freedom: tuple[float, ...]


def fit_single_test(
    blocks: Sequence[DataBlock], samples: Sequence[DataBlock], most: int
) -> SingleTestFit:
    """Fit one test with as many arms as it bears, up to `most`."""
    most = min(most, max_determinable_arms(blocks))
    best = solve_orders(blocks, most)[-1]
    peaks = [_find_largest_target(block) for block in samples]
    estimate = estimate_covariance(best, samples, peak=max(peaks))
    # thirteen parameters of 32 values leave a third less than their scatter
    model = solid_of(best)
    count = sum(len(residual) for residual in estimate.residuals)
    taken = len(Stack(blocks).names) + 2 * int(np.count_nonzero(model.k))
    ratio = max(count - taken, 1) / count
    spreads = [
        float(np.sqrt(np.mean(residual**2) * noise.kappa / ratio))
        for residual, noise in zip(estimate.residuals, estimate.noises, strict=True)
    ]
    return SingleTestFit(
        model,
        tuple(
            max(spread, ROUNDING * (peak or 1.0))
            for spread, peak in zip(spreads, peaks, strict=True)
        ),
        tuple(ratio * len(residual) for residual in estimate.residuals),
    )


def _find_largest_target(block: DataBlock) -> float:
    return float(np.abs(block.target).max())
