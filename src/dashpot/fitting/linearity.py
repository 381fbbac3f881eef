"""Whether any linear solid explains relaxation tests to their noise, ramp and hold alike."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.relaxation import MAX_CREEP, RampHold
from dashpot.fitting.design_matrix import (
    FitSetup,
    bic_penalty_per_arm,
    block_of,
    compress_tests,
    eq5_obstacle,
    is_multi_step,
    solid_of,
)
from dashpot.fitting.fit_data import FitData, InitialFit, max_determinable_arms, weighed
from dashpot.fitting.fractional_model.family_selection import FractionalFit, element
from dashpot.fitting.nonlinear_ramp.downsampling import ramp_obstacle
from dashpot.fitting.nonlinear_ramp.goodness_of_fit import LinearFitQuality, linear_soundness
from dashpot.fitting.pipeline import FitOptions
from dashpot.fitting.uncertainty.solution_covariance import residual_of
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.variable_projection import solve
from dashpot.solids.maxwell import GeneralizedMaxwell

# arms that a hold alone is given at least: what it leaves is noise
_FEW = 2
# an arm that lowers the sum of squares by less than this is none that the hold alone needs
_AS_GOOD = 1.01
# arms nearer than this in ln tau are one
_SAME_ARM = 1e-6


class LinearityResult(NamedTuple):
    """The linear solids that tests were offered, and whether one is sound.

    Attributes
    ----------
    first : First
        Arms, up to the number asked for.
    element : ChosenElement or None
        A fractional solid, where arms are not sound and another family may be.
    judged : Soundness or None
        Of the record that a linear solid explains worst; None where no ramp is judged.
    """

    first: InitialFit
    element: FractionalFit | None
    judged: LinearFitQuality | None

    @property
    def sound(self) -> bool:
        """Whether a linear solid explains every record."""
        return self.judged is None or self.judged.sound


class HoldBlocks:
    """The holds of some records alone, compressed once for all that asks them."""

    def __init__(self, records: Sequence[RampHold]) -> None:
        self.records = records

    @cached_property
    def blocks(self) -> tuple[DataBlock, ...]:
        """By eq. 5, or, where the plate creeps, as the answer to the recorded motion."""
        return tuple(
            compress_tests([record], FitSetup("hold", ()))[0]
            if eq5_obstacle(record) is None
            else block_of(record, terms=_terms_of_hold(record), start=record.settled.start)
            for record in self.records
        )

    def compute_hold_residual(self, i: int, start: FloatArray) -> FloatArray:
        """What as many arms as `start` has, or as many as it bears, leave of one hold alone."""
        block = self.blocks[i]
        arms = min(max(len(start), _FEW), max_determinable_arms([block]))
        # a start with two arms in one place, as at the edge of its shorter window, leads nowhere
        near = start if len(start) == arms and _has_distinct_times(start, block.window) else None
        least = bic_penalty_per_arm([block])
        solution = solve([block], arms, log_tau_start=near, negligible=least)
        return residual_of(solution, block.exact)

    def fit_hold_equation(self, model: GeneralizedMaxwell) -> GeneralizedMaxwell | None:
        """What eq. 5 on all holds says with as many arms as another solid, where it applies."""
        held = sum(len(record.time[record.hold]) for record in self.records)
        if held <= 1 + 2 * model.arms or any(eq5_obstacle(record) for record in self.records):
            return None
        near = np.log(model.tau)
        solution = solve(
            self.blocks, model.arms, near=near, negligible=bic_penalty_per_arm(self.blocks)
        )
        return solid_of(solution)


def _terms_of_hold(record: RampHold) -> tuple[str, ...]:
    """What a hold is given beside arms: of one that stands, an offset is as its spring."""
    return ("offset",) if abs(record.hold_creep) > MAX_CREEP else ()


def _has_distinct_times(log_tau: FloatArray, window: tuple[float, float]) -> bool:
    inside = np.clip(np.sort(log_tau), *np.log(window))
    return bool(np.all(np.diff(inside) > _SAME_ARM))


def assess_linearity(holds: HoldBlocks, data: FitData, options: FitOptions) -> LinearityResult:
    """Return the linear solid that is asked for, and whether any is sound."""
    enough = min(options.max_arms, max_determinable_arms(data.blocks))
    most = enough if options.count is None else options.count
    auto, point = options.count is None, options.point is not None
    first = weighed(data, most, auto=auto, thorough=options.thorough, only=point)
    gate = LinearityResult(first, None, _evaluate_holds(holds, first))
    if not gate.sound and most < enough:
        # too few arms are no reason to bend the law
        first = weighed(data, enough, thorough=options.thorough)
        gate = LinearityResult(first, None, _evaluate_holds(holds, first))
    if gate.sound or options.family == "maxwell":
        return gate
    fit = element(first.data)
    if options.family == "fractional":
        return LinearityResult(first, fit, None)
    by_element = _find_worst_record(holds, fit.estimate.residuals, first.solutions[-1].log_tau)
    valid = by_element is None or by_element.sound
    return LinearityResult(first, fit, by_element if valid else gate.judged)


def _evaluate_holds(holds: HoldBlocks, first: InitialFit) -> LinearFitQuality | None:
    """How well the best arms explain every record to its noise, ramp and hold alike."""
    least = _AS_GOOD * first.solutions[-1].sse
    near = next(solution for solution in first.solutions if solution.sse <= least)
    return _find_worst_record(holds, first.residuals, near.log_tau)


def _find_worst_record(
    holds: HoldBlocks, residuals: Sequence[FloatArray], log_tau: FloatArray
) -> LinearFitQuality | None:
    """The first record that is not explained, or the ramp that is left with most.

    A record without one ramp and one hold to speak of shows no elastic law.
    """
    worst = None
    for i, (record, residual) in enumerate(zip(holds.records, residuals, strict=True)):
        if is_multi_step(record) or ramp_obstacle(record) is not None:
            continue
        quality = linear_soundness(record, residual, holds.compute_hold_residual(i, log_tau))
        if not quality.sound:
            return quality
        worst = quality if worst is None or quality.ramp > worst.ramp else worst
    return worst
