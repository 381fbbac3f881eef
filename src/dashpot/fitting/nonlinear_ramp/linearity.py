"""Test of linearity: whether a linear solid fits ramp and hold to their noise."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.provenance import Step
from dashpot.base.units import format_quantity
from dashpot.datamodel.relaxation import MAX_CREEP, RampHold
from dashpot.fitting.checks.relaxation import estimate_slow_noise
from dashpot.fitting.data_blocks import (
    FitData,
    FitSetup,
    InitialFit,
    bic_penalty_per_arm,
    build_fit_data,
    build_record_block,
    build_solid,
    compress_tests,
    eq5_obstacle,
    fit_all_orders,
    is_multi_step,
    max_determinable_arms,
)
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.fractional_model.family_selection import FractionalFit, fit_fractional
from dashpot.fitting.nonlinear_ramp.quasi_linear import explain_missing_ramp, find_relaxation_start
from dashpot.fitting.nuisance_priors import LINEAR_DELAY
from dashpot.fitting.parameter_errors import compute_residual
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit import solve
from dashpot.numerics.inference.correlated_noise import estimate_noise
from dashpot.preprocessing.denoising import denoise_displacement
from dashpot.signals.clock import is_evenly_sampled
from dashpot.solids.maxwell import GeneralizedMaxwell

# Test of linearity on one record.


# Limits of the residuals of a linear law: on the ramp over the noise, of one sample and of one
# independent residual; in the hold over those of a fit of the hold.
MAX_RAMP_RATIO, MAX_SHAPE_RATIO, MAX_HOLD_RATIO = 1.2, 1.5, 1.1
# residual relative to the peak with a negligible effect on the stiffnesses
NEGLIGIBLE_RESIDUAL = 1e-4
# and more than this part is not what an encoder leaves
MAX_ENCODER_RESIDUAL = 1e-3


class LinearFitQuality(NamedTuple):
    """Residual of a linear fit to a record, relative to its noise.

    Attributes
    ----------
    ramp_ratio : float
        Residual on the ramp over the noise of one sample.
    hold_ratio : float
        Residual in the hold over that of a fit of the hold alone.
    is_adequate : bool
    """

    ramp_ratio: float
    hold_ratio: float
    is_adequate: bool


def assess_linear_fit(
    ramp: float,
    hold: float,
    single: float,
    *,
    noise: float,
    discrepancy: float,
    samples: float,
    peak: float,
    quantisation_force: float = 0.0,
) -> LinearFitQuality:
    r"""Judge a linear fit by its residuals.

    Parameters
    ----------
    ramp, hold : float
        Root mean square residual of the fit to the whole record, on the ramp and in the hold, N.
    single : float
        That of a fit to the hold alone, N.
    noise : float
        Standard deviation of the noise of one sample, N.
    discrepancy : float
        :math:`r_r \sqrt{\kappa_r}/(r_h \sqrt{\kappa_h})`, scatter of one independent residual
        of the ramp over one of the hold: a curve below the noise shows in :math:`\kappa_r`.
    samples : float
        Effective number of residuals on the ramp: of few, more is chance.
    peak : float
        Largest force, N.
    quantisation_force : float
        Force on the ramp that corresponds to the encoder error of the motion, N.
    """
    negligible = NEGLIGIBLE_RESIDUAL * peak
    by_chance = 1.0 + 3.0 / np.sqrt(2.0 * max(samples, 1.0))
    is_small = ramp <= max(MAX_RAMP_RATIO, by_chance) * noise
    is_structureless = discrepancy <= MAX_SHAPE_RATIO * by_chance
    quantisation_force = min(MAX_SHAPE_RATIO * quantisation_force, MAX_ENCODER_RESIDUAL * peak)
    is_followed = (is_small and is_structureless) or ramp <= max(negligible, quantisation_force)
    valid = bool(is_followed and (hold <= MAX_HOLD_RATIO * single or hold <= negligible))
    return LinearFitQuality(ramp / max(noise, 1e-300), hold / max(single, 1e-300), valid)


def assess_residuals(
    test: RampHold, residuals: FloatArray, hold_residuals: FloatArray
) -> LinearFitQuality:
    """Judge a linear fit that was made elsewhere, by the residuals of every sample.

    Parameters
    ----------
    test : RampHold
    residuals : array, shape (n,)
        Residual of the fit to ramp and hold, up to the last sample of the hold, N.
    hold_residuals : array, shape (m,)
        Residual of a fit to the hold alone, N.
    """
    corner, onset = find_relaxation_start(test), int(np.searchsorted(test.time, test.onset))
    hold_part = residuals[corner - test.hold.stop :]
    ramp = residuals[: -len(hold_part)][onset - corner :]
    # the colour of the noise shows in a stretch of it
    noises = estimate_noise(ramp), estimate_noise(hold_residuals[: 4 * len(ramp)])
    rms, hold_rms = (float(np.sqrt(np.mean(part**2))) for part in (ramp, hold_residuals))
    peak = float(np.abs(test.force[: test.hold.stop]).max())
    return assess_linear_fit(
        rms,
        float(np.sqrt(np.mean(hold_part**2))),
        hold_rms,
        noise=max(
            sample_noise(test.force_noise, hold_rms), estimate_slow_noise(hold_residuals, peak)
        ),
        discrepancy=rms / max(hold_rms, 1e-300) * float(np.sqrt(noises[0].kappa / noises[1].kappa)),
        samples=len(ramp) / noises[1].kappa,
        peak=peak,
        quantisation_force=peak / test.depth * _compute_motion_residual(test, slice(onset, corner)),
    )


def _compute_motion_residual(test: RampHold, ramp: slice) -> float:
    """Return the standard deviation of the encoder's error on the ramp, m."""
    _, residual = denoise_displacement(test)
    return float(np.sqrt(np.mean(residual[ramp] ** 2)))


def sample_noise(scatter: float, rms: float) -> float:
    """Standard deviation of the noise of one sample, N: scatter, or residual of its hold.

    What a hold leaves may be a solid that does not fit: it is noise up to twice the scatter.
    """
    return max(scatter, min(rms, 2.0 * scatter)) if scatter > 0 else rms


# Test of linearity on several tests.


# Smallest number of arms in the fit of a hold, so that its residual is noise.
_MIN_HOLD_ARMS = 2
# ratio of sums of squares below which an arm is not needed for the hold alone
_MIN_SSE_RATIO = 1.01
# arms nearer than this in ln tau are one
_SAME_ARM_DISTANCE = 1e-6


class LinearityResult(NamedTuple):
    """Linear solids fitted to tests, and whether one is adequate.

    Attributes
    ----------
    initial_fit : InitialFit
        Arms, up to the number requested.
    fractional_fit : FractionalFit or None
        A fractional solid, where arms are not sound and another family may be.
    quality : LinearFitQuality or None
        Quality of the record that a linear solid explains worst; None where no ramp is judged.
    """

    initial_fit: InitialFit
    fractional_fit: FractionalFit | None
    quality: LinearFitQuality | None

    @property
    def is_linear(self) -> bool:
        """Whether a linear solid explains every record."""
        return self.quality is None or self.quality.is_adequate


class HoldBlocks:
    """Holds of some records, compressed once for all uses."""

    def __init__(self, records: Sequence[RampHold]) -> None:
        self.records = records

    @cached_property
    def blocks(self) -> tuple[DataBlock, ...]:
        """Blocks of eq. 5 or, where the plate creeps, of the response to the recorded motion."""
        return tuple(
            compress_tests([record], FitSetup("hold", ()))[0]
            if eq5_obstacle(record) is None
            else build_record_block(
                record, terms=_terms_of_hold(record), start=record.settled_samples.start
            )
            for record in self.records
        )

    def compute_hold_residual(self, i: int, start: FloatArray) -> FloatArray:
        """Return the residual of one hold alone, with at most as many arms as it supports."""
        block = self.blocks[i]
        arms = min(max(len(start), _MIN_HOLD_ARMS), max_determinable_arms([block]))
        # a start with two arms in one place, as at the edge of its shorter window, leads nowhere
        initial = start if len(start) == arms and _has_distinct_times(start, block.window) else None
        negligible = bic_penalty_per_arm([block])
        solution = solve([block], arms, log_tau_start=initial, negligible=negligible)
        return compute_residual(solution, block.exact)

    def fit_hold_equation(self, model: GeneralizedMaxwell) -> GeneralizedMaxwell | None:
        """Return the solid of eq. 5 on all holds with as many arms as a model, if it applies."""
        sample_count = sum(len(record.time[record.hold]) for record in self.records)
        if sample_count <= 1 + 2 * model.arms or any(
            eq5_obstacle(record) for record in self.records
        ):
            return None
        log_tau_start = np.log(model.tau)
        solution = solve(
            self.blocks,
            model.arms,
            near_log_tau=log_tau_start,
            negligible=bic_penalty_per_arm(self.blocks),
        )
        return build_solid(solution)


def _terms_of_hold(record: RampHold) -> tuple[str, ...]:
    """Return the nuisance terms of a hold: no offset at rest, where it equals the spring."""
    return ("offset",) if abs(record.hold_creep) > MAX_CREEP else ()


def _has_distinct_times(log_tau: FloatArray, window: tuple[float, float]) -> bool:
    clipped = np.clip(np.sort(log_tau), *np.log(window))
    return bool(np.all(np.diff(clipped) > _SAME_ARM_DISTANCE))


def assess_linearity(holds: HoldBlocks, data: FitData, options: FitOptions) -> LinearityResult:
    """Return the requested linear solid, and whether any linear solid is adequate."""
    determinable_arms = min(options.max_arms, max_determinable_arms(data.blocks))
    arm_count = determinable_arms if options.count is None else options.count
    auto, point = options.count is None, options.point is not None
    order_fits = fit_all_orders(
        data, arm_count, is_automatic=auto, thorough=options.thorough, only_max_arms=point
    )
    linearity = LinearityResult(order_fits, None, _evaluate_holds(holds, order_fits))
    if not linearity.is_linear and arm_count < determinable_arms:
        # too few arms are no reason to bend the law
        order_fits = fit_all_orders(data, determinable_arms, thorough=options.thorough)
        linearity = LinearityResult(order_fits, None, _evaluate_holds(holds, order_fits))
    if linearity.is_linear or options.family == "maxwell":
        return linearity
    fit = fit_fractional(order_fits.data)
    if options.family == "fractional":
        return LinearityResult(order_fits, fit, None)
    fractional_quality = _find_worst_record(
        holds, fit.estimate.residuals, order_fits.solutions[-1].log_tau
    )
    valid = fractional_quality is None or fractional_quality.is_adequate
    return LinearityResult(order_fits, fit, fractional_quality if valid else linearity.quality)


def _evaluate_holds(holds: HoldBlocks, first: InitialFit) -> LinearFitQuality | None:
    """Return how well the best arms explain every record to its noise, ramp and hold alike."""
    sse_limit = _MIN_SSE_RATIO * first.solutions[-1].sse
    smallest = next(solution for solution in first.solutions if solution.sse <= sse_limit)
    return _find_worst_record(holds, first.residuals, smallest.log_tau)


def _find_worst_record(
    holds: HoldBlocks, residuals: Sequence[FloatArray], log_tau: FloatArray
) -> LinearFitQuality | None:
    """Return the first record that is not explained, or the ramp that is left with most.

    A record without one ramp and one hold to speak of shows no elastic law.
    """
    worst_record = None
    for i, (record, residual) in enumerate(zip(holds.records, residuals, strict=True)):
        if is_multi_step(record) or explain_missing_ramp(record) is not None:
            continue
        quality = assess_residuals(record, residual, holds.compute_hold_residual(i, log_tau))
        if not quality.is_adequate:
            return quality
        worst_record = (
            quality
            if worst_record is None or quality.ramp_ratio > worst_record.ramp_ratio
            else worst_record
        )
    return worst_record


# Large delay of the force: the motion is delayed alike.
#
# To first order a delay adds :math:`-\delta\dot F`. Of 10 ms at a corner of the ramp that is off by
# :math:`\delta^2\ddot F/2`, which looks like a bent law. So where no linear solid is sound and the
# force lags, the solid is asked again of a motion that is late by whole samples, and of one behind
# a low-pass of that time constant. What is left of the delay stays a nuisance term.


class DelayedMotion(NamedTuple):
    """Tests whose motion is delayed like their force.

    Attributes
    ----------
    hold_blocks : HoldBlocks
    data : FitData
    delays : tuple of float
        Delay applied to each motion, s: 0 as recorded.
    is_filtered : bool
        Whether by low-passes of those time constants.
    """

    hold_blocks: HoldBlocks
    data: FitData
    delays: tuple[float, ...]
    is_filtered: bool = False

    @classmethod
    def from_records(
        cls,
        records: Sequence[RampHold],
        design: FitSetup,
        lags: tuple[float, ...] = (),
        *,
        filtered: bool = False,
    ) -> DelayedMotion:
        """Return the data of records, with delays if given."""
        no_lags = (0.0,) * len(records)
        return cls(HoldBlocks(records), build_fit_data(records, design), lags or no_lags, filtered)

    def coefficients(self, function: Callable[[str], float]) -> Callable[[str], float]:
        """The value of a column by its name; a delay includes the delay applied to the motion."""
        delays = {f"delay@{i}": lag for i, lag in enumerate(self.delays)}
        return lambda name: function(name) + delays.get(name, 0.0)

    @property
    def steps(self) -> tuple[Step, ...]:
        """Steps that were applied to the motion."""
        if not any(self.delays):
            return ()
        delay_text = " and ".join(format_quantity(lag, "ms", ".3g") for lag in self.delays)
        parameters = (("lag_s", ", ".join(f"{lag:.6g}" for lag in self.delays)),)
        description = f"put the motion behind a low-pass of {delay_text}"
        if not self.is_filtered:
            description = f"took the motion {delay_text} later"
        return (Step("lag", parameters, f"{description}, as the force comes"),)


def select_delayed_motion(
    recorded_motion: DelayedMotion, options: FitOptions
) -> tuple[DelayedMotion, LinearityResult]:
    """Return the motion under which a linear solid is sound, and how sound it is.

    The motion as recorded if a linear solid is adequate, or if no delay makes one adequate; else
    the delayed motion with the smallest residual.
    """
    linearity = assess_linearity(recorded_motion.hold_blocks, recorded_motion.data, options)
    if linearity.is_linear:
        return recorded_motion, linearity
    candidates = [
        (motion, assess_linearity(motion.hold_blocks, motion.data, options))
        for motion in _generate_delayed_motions(recorded_motion, linearity)
    ]
    reliable = [pair for pair in candidates if pair[1].is_linear]
    return min(
        reliable,
        key=lambda pair: pair[1].initial_fit.solutions[-1].sse,
        default=(recorded_motion, linearity),
    )


def _generate_delayed_motions(
    recorded_motion: DelayedMotion, linearity: LinearityResult
) -> Iterator[DelayedMotion]:
    """The motions that may be as late as the force of the best linear solid."""
    records, best_solution = (
        recorded_motion.hold_blocks.records,
        linearity.initial_fit.solutions[-1],
    )
    values = [best_solution.coefficient(f"delay@{i}") for i in range(len(records))]
    large_delays = tuple(lag if lag > LINEAR_DELAY else 0.0 for lag in values)
    delayed_records, lags = zip(*map(_shift_motion, records, large_delays), strict=True)
    if any(lags):
        yield DelayedMotion.from_records(delayed_records, FitSetup("full"), lags)
    if any(large_delays) and not any(record.machine.force_filter for record in records):
        filtered_records = [*map(_set_force_filter, records, large_delays)]
        yield DelayedMotion.from_records(
            filtered_records, FitSetup("full"), large_delays, filtered=True
        )


def _shift_motion(record: RampHold, lag: float) -> tuple[RampHold, float]:
    """The record with its motion late by whole samples, whose counts are as they were read."""
    step = record.step
    sample_count = round(lag / step) if is_evenly_sampled(record.time) else 0
    if not sample_count:
        return record, 0.0

    def delay_values(values: FloatArray) -> FloatArray:
        return np.concatenate((np.full(sample_count, values[0]), values[:-sample_count]))

    machine_deflection = (
        None if record.machine_deflection is None else delay_values(record.machine_deflection)
    )
    return replace(
        record,
        displacement=delay_values(record.displacement),
        machine_deflection=machine_deflection,
    ), sample_count * step


def _set_force_filter(record: RampHold, lag: float) -> RampHold:
    """The record with a low-pass of this time constant stated for its force channel."""
    if not lag:
        return record
    return replace(record, machine=replace(record.machine, force_filter=1 / (2 * np.pi * lag)))
