"""Data of a fit: prepared tests as weighted blocks of rows, and their noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.option_fields import Method
from dashpot.datamodel.relaxation import MAX_CREEP, RampHold
from dashpot.fitting.nuisance_priors import (
    build_load_cell_priors,
    build_nuisance_terms,
    estimate_hold_noise,
)
from dashpot.fitting.parameter_errors import Encoder, compute_residual, rounding_rms
from dashpot.numerics.design_matrices.block import DataBlock, DelayedForce
from dashpot.numerics.design_matrices.data_compression import uniform_step
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block, build_recorded_block
from dashpot.numerics.exponential_fit import Solution, solve, solve_orders
from dashpot.numerics.inference.correlated_noise import Noise, ResidualSeries, estimate_noise
from dashpot.numerics.log_tau_descent import Stack
from dashpot.preprocessing.denoising import denoise_displacement
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

# Blocks of prepared tests.


NUISANCE_NAMES = ("offset", "drift", "delay")

# Largest motion after the ramp, relative to the depth, for eq. (5).
_MAX_HOLD_MOTION = 0.05
# and beyond this it leads to another hold
_OTHER_DEPTH_MOTION = 0.25
_MIN_SAMPLES = 8
_ROUNDING_RATIO = 0.01
# arms of the first solution, which shows the slope of the force
_ROUGH_ARMS = 2


class FitSetup(NamedTuple):
    """Setup of the tests in a fit: method and nuisance terms."""

    method: Method
    nuisance: tuple[str, ...] = NUISANCE_NAMES

    @property
    def terms(self) -> tuple[str, ...]:
        """Return the terms that have a column from the beginning; eq. 5 has no delay."""
        return tuple(name for name in self.nuisance if name != "delay")


def build_record_block(
    test: RampHold,
    *,
    method: Method = "full",
    terms: Sequence[str] = (),
    index: int | None = None,
    start: int | None = None,
    law: ElasticLaw | None = None,
    tau_range: tuple[float, float] | None = None,
) -> DataBlock:
    """Return the block of one record: columns of the solid and its rig, and the force as target.

    A few hundred rows on which a fit is that to every sample.

    Parameters
    ----------
    test : RampHold
    method : "full" or "hold"
        Answers to the recorded motion, or to an ideal ramp in the hold alone (eq. 5).
    terms : sequence of str
        ``"offset"`` and ``"drift"`` have a column each, which counts from the first sample, or from
        the end of an ideal ramp.
    index : int, optional
        Index of the test: its terms are its own, ``"offset@0"``.
    start : int, optional
        The first sample that is fitted to the recorded motion, in place of that of contact.
    law : ElasticLaw, optional
        The solid answers the path of this law.
    tau_range : (float, float), optional
        Relaxation times of interest, s, if wider than the window of the record.
    """
    suffix = "" if index is None else f"@{index}"
    offset, drift = (f"{name}{suffix}" if name in terms else None for name in ("offset", "drift"))
    if method == "hold":
        return build_hold_block(
            np.maximum(test.time[test.settled_samples] - test.ramp_end, 0.0),
            test.force[test.settled_samples],
            depth=test.depth if law is None else float(law.path(test.depth)),
            ramp_time=test.ramp_time,
            offset=offset,
            drift=drift,
        )
    time, x, force = motion(test)
    window = slice(first_sample(test) if start is None else start, None)
    return build_recorded_block(
        time, x if law is None else law.path(x), force, window=window, offset=offset, drift=drift,
        tau_range=tau_range,
    )  # fmt: skip


def compress_tests(tests: Sequence[RampHold], design: FitSetup) -> tuple[DataBlock, ...]:
    """Return one block per test, a few hundred rows each, on which the fit is the full fit."""
    return tuple(
        build_record_block(test, method=design.method, terms=design.terms, index=i)
        for i, test in enumerate(tests)
    )


def build_delay_blocks(
    tests: Sequence[RampHold], design: FitSetup, log_tau_start: FloatArray | None = None
) -> tuple[DataBlock, ...]:
    r"""Return the blocks of :func:`compress_tests` with the column of a force that comes late.

    .. math:: -\dot F = \sum_j (k_j/\tau_j)\,q_j - k_g\,\dot x, \qquad k_g = k_\infty + \sum_j k_j

    The slope of the force needs no more than a first solution with two arms, or the one that is
    `log_tau_start` these ln tau.
    """
    blocks = compress_tests(tests, design)
    if design.method == "hold" or "delay" not in design.nuisance:
        return blocks
    stack = Stack(blocks)
    degrees_left = (stack.samples - len(stack.names) - 2) // (1 + len(stack.groups))
    rows = [*blocks, *build_prior_rows(tests, blocks, design)]
    rough_arms = _ROUGH_ARMS if log_tau_start is None else len(log_tau_start)
    rough_solution = solve(
        rows,
        max(min(rough_arms, degrees_left), 0),
        log_tau_start=log_tau_start,
        negligible=bic_penalty_per_arm(rows),
    )
    return tuple(
        block.with_delay(f"delay@{i}", _build_delayed_force(test, block, rough_solution))
        for i, (test, block) in enumerate(zip(tests, blocks, strict=True))
    )


def bic_penalty_per_arm(blocks: Sequence[DataBlock]) -> float:
    """Return the gain in noise variances by which BIC accepts one more arm."""
    stack = Stack(blocks)
    return (1 + len(stack.groups)) * float(np.log(stack.samples))


def build_prior_rows(
    tests: Sequence[RampHold],
    blocks: Sequence[DataBlock],
    design: FitSetup,
    spreads: Sequence[float] | None = None,
) -> tuple[DataBlock, ...]:
    """Return the priors of each load cell and its clock as rows, one block per test.

    `spreads` holds the standard deviation of one independent residual of each test, N; by default
    as its hold shows it (:func:`~dashpot.fitting.nuisance_priors.estimate_hold_noise`). Eq. 5 has
    no ramp that would distinguish slow arms from a drift, which is there as free as it may be; its
    clock begins at the end of the ramp.
    """
    hold = design.method == "hold"
    if not (design.terms if hold else design.nuisance):
        return ()
    noise_sds = spreads or [*map(estimate_hold_noise, tests)]
    terms = [build_nuisance_terms(test, for_limits=hold) for test in tests]
    if hold:
        terms = [
            replace(term, drift_start=term.drift_start + float(test.ramp_end - test.time[0]))
            for term, test in zip(terms, tests, strict=True)
        ]
    terms_and_blocks = zip(terms, blocks, noise_sds, strict=True)
    return tuple(
        nuisance_terms.build_rows(block, noise_sd)
        for nuisance_terms, block, noise_sd in terms_and_blocks
    )


def _build_delayed_force(test: RampHold, block: DataBlock, solution: Solution) -> DelayedForce:
    """Return the change of the force of the first solution by a delay, N/s."""
    time, x, _ = motion(test)
    k = solution.arms[solution.groups.index(block.arm_group)]
    k_g = solution.coefficient(block.fixed_names[0]) + float(k.sum())
    arms = block.exact.evaluate(solution.log_tau, False).arms
    speed = np.gradient(x, uniform_step(time) or time)
    return DelayedForce.from_arms(arms, k, solution.tau, k_g, speed[first_sample(test) :])


def first_sample(test: RampHold) -> int:
    """Return the first sample of a full fit; earlier ones determine priors."""
    return build_load_cell_priors(test).first_sample


def is_multi_step(test: RampHold) -> bool:
    """True if the plate moves on to another depth after the first ramp: no single hold."""
    return _compute_hold_travel(test) > _OTHER_DEPTH_MOTION


def _compute_hold_travel(test: RampHold) -> float:
    return float(np.ptp(test.displacement[test.hold])) / test.depth


def eq5_obstacle(test: RampHold) -> str | None:
    """Return why eq. 5 does not apply to this history, in a sentence; None if it does."""
    held_displacement = test.displacement[test.hold]
    if test.loading_start is not None:
        return (
            "the record has earlier loadings, which the seal remembers, so this is no single ramp "
            "and hold; eq. 5 does not apply: fit ramp and hold instead, or cut the record to the "
            "test of a seal that has rested"
        )
    if len(held_displacement) < _MIN_SAMPLES:
        return (
            f"the hold has {len(held_displacement)} samples, and eq. 5 needs at least "
            f"{_MIN_SAMPLES}: fit ramp and hold instead, or sample faster"
        )
    change = _compute_hold_travel(test)
    if change > _MAX_HOLD_MOTION:
        return (
            f"the displacement moves by {100 * change:.0f} % of the depth after the first ramp, so "
            "this is no single ramp and hold; eq. 5 does not apply: fit ramp and hold instead, or "
            "cut the record to one ramp and its hold"
        )
    creep = test.hold_creep
    if abs(creep) > MAX_CREEP:
        return (
            f"the displacement drifts by {100 * creep:.2g} % of the depth during the hold, more "
            f"than the {100 * MAX_CREEP:.0f} % that eq. 5 can bear: fit ramp and hold instead, "
            "which takes the recorded motion"
        )
    return None


def motion(test: RampHold) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time, displacement from the first sample on, and force, up to the end of the hold.

    A seal that the record finds in contact is at rest there: the force of that rest is offset.
    """
    samples = slice(0, test.hold.stop)
    x, _ = denoise_displacement(test)
    return (regularise_clock(test.time[samples] - test.time[0]), x - x[0], test.force[samples])


def regularise_clock(time: FloatArray) -> FloatArray:
    """Return an even clock if `time` is one but for rounding, else `time`.

    A text file rounds its times. Where every stamp is within a hundredth of a sample of a uniform
    grid, that grid is meant, and the fit need not treat the record as unevenly sampled.
    """
    grid = np.linspace(time[0], time[-1], len(time))
    step = (time[-1] - time[0]) / max(len(time) - 1, 1)
    return grid if float(np.abs(time - grid).max()) <= _ROUNDING_RATIO * step else time


def build_solid(solution: Solution) -> GeneralizedMaxwell:
    """Return the solid with the arms of k > 0 and, if any, its parallel dashpot."""
    k = solution.arms[solution.groups.index("k")] if solution.order else np.zeros(0)
    return GeneralizedMaxwell(
        max(solution.coefficient("k_inf"), 0.0),
        tuple(k[k > 0]),
        tuple(solution.tau[k > 0]),
        max(solution.coefficient("b"), 0.0) if "b" in solution.fixed_names else 0.0,
    )


# Data of a fit, and the weight of priors by its noise.


# Range of the ratio of the assumed to the estimated noise in which the priors keep their weights.
_PRIOR_WEIGHT_RANGE = (2 / 3, 3 / 2)


@dataclass(frozen=True, eq=False)
class FitData:
    """Data to which a solid is fitted.

    Attributes
    ----------
    blocks, samples : sequences of DataBlock
        The data to solve, and the same with a row per sample, one block per record.
    in_time : bool
        The samples are records in time: no more arms are tried than could gain what BIC asks for
        one, a decisive BIC overrules, and under noise as slow as the arms fits in its metric are
        judged.
    encoders : sequence of Encoder, optional
        Encoders of each record, where the recorded motion is fitted.
    build_priors : callable, optional
        Makes the priors of nuisance terms from the standard deviation of one independent residual
        of each record, N; from None by what the records show before a fit.
    priors : tuple of DataBlock
        Priors of fixed coefficients.
    """

    blocks: Sequence[DataBlock]
    samples: Sequence[DataBlock]
    in_time: bool = False
    encoders: Sequence[Encoder] | None = None
    build_priors: Callable[[Sequence[float] | None], tuple[DataBlock, ...]] | None = None
    priors: tuple[DataBlock, ...] = ()

    @property
    def rows(self) -> tuple[DataBlock, ...]:
        """The data blocks and the prior blocks."""
        return (*self.blocks, *self.priors)

    @property
    def full_rows(self) -> tuple[DataBlock, ...]:
        """One row per sample, and the priors."""
        return (*self.samples, *self.priors)

    @property
    def units(self) -> tuple[float, ...]:
        """The standard deviation of one independent residual that each prior assumes, N."""
        return tuple(float(np.sqrt(block.variance or 0.0)) for block in self.priors)

    def weight_priors(self, spreads: Sequence[float] | None = None) -> FitData:
        """Return the data with priors whose weight is that of residuals with these spreads, N."""
        return (
            self if self.build_priors is None else replace(self, priors=self.build_priors(spreads))
        )

    @cached_property
    def peak(self) -> float:
        """Largest target: it sets the level of rounding."""
        return max(find_largest_target(block) for block in self.samples)


def build_fit_data(
    records: Sequence[RampHold], design: FitSetup, log_tau_start: FloatArray | None = None
) -> FitData:
    """Return the tests as data, with the priors of load cells and clocks.

    Whose solid has relaxation times `log_tau_start` some is not searched for: they are given as ln
    tau.
    """
    blocks = build_delay_blocks(records, design, log_tau_start)
    return FitData(
        blocks,
        [block.exact for block in blocks],
        in_time=True,
        encoders=None if design.method == "hold" else [*map(Encoder.from_record, records)],
        build_priors=partial(build_prior_rows, records, blocks, design),
    )


class InitialFit(NamedTuple):
    """Data with priors weighted by the noise, and the solutions that determined it.

    Attributes
    ----------
    data : FitData
    solutions : sequence of Solution
        Every number of arms from none up, or the last alone.
    series : tuple of ResidualSeries
        Residual of the last one for each record, N, before its priors were weighted.
    noises : tuple of Noise
    noise_solution : Solution
        The solution that left the residuals of `series`.
    """

    data: FitData
    solutions: Sequence[Solution]
    series: tuple[ResidualSeries, ...]
    noises: tuple[Noise, ...]
    noise_solution: Solution

    @property
    def residuals(self) -> tuple[FloatArray, ...]:
        """The values of the series."""
        return tuple(series.values for series in self.series)

    def get_residuals(self, solution: Solution) -> tuple[ResidualSeries, ...]:
        """Return the residual of each record; empty if not available."""
        return self.series if solution is self.noise_solution else ()


def fit_all_orders(
    data: FitData,
    max_arms: int,
    *,
    is_automatic: bool = True,
    thorough: bool = False,
    only_max_arms: bool = False,
    log_tau_start: FloatArray | None = None,
) -> InitialFit:
    """Solve up to `max_arms` arms, with the weight of the priors set by the residual noise.

    Where ``is_automatic`` chooses the number, records in time need no more arms than one beyond
    those that could gain what BIC asks for one. ``only_max_arms`` leaves out all but the last,
    which with `log_tau_start` is the one next to these ln tau.
    """
    data = data.weight_priors()

    def solve_once() -> Sequence[Solution]:
        negligible = bic_penalty_per_arm(data.rows) if data.in_time else 0.0
        if only_max_arms:
            solution = solve(
                data.rows,
                max_arms,
                log_tau_start=log_tau_start,
                negligible=negligible,
                thorough=thorough,
            )
            return (solution,)
        return solve_orders(
            data.rows,
            max_arms,
            negligible=negligible,
            every_order=not is_automatic,
            thorough=thorough,
        )

    solutions = solve_once()
    series = tuple(ResidualSeries(compute_residual(solutions[-1], block)) for block in data.samples)
    noises = tuple(
        estimate_noise(residual_series, rounding=rounding_rms(data.peak))
        for residual_series in series
    )
    noise_sds = [float(np.sqrt(noise.autocovariance[0] * noise.kappa)) for noise in noises]
    if all(
        _PRIOR_WEIGHT_RANGE[0] < a / b < _PRIOR_WEIGHT_RANGE[1]
        for a, b in zip(noise_sds, data.units, strict=False)
    ):
        return InitialFit(data, solutions, series, noises, solutions[-1])
    data = data.weight_priors(noise_sds)
    return InitialFit(data, solve_once(), series, noises, solutions[-1])


def max_determinable_arms(blocks: Sequence[DataBlock]) -> int:
    """Return how many arms the samples could determine at all, with two to spare."""
    stack = Stack(blocks)
    return max(0, (stack.samples - len(stack.names) - 2) // (1 + len(stack.groups)))


def find_largest_target(block: DataBlock) -> float:
    """Return the largest absolute value of the target of a block."""
    return float(np.abs(block.target).max())
