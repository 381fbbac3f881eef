r"""Fit of a solid to a creep test or compliance.

The recorded force is the input, and the displacement its answer,

.. math:: x(t) = D_g F(t) + \sum_i D_i \int_0^t \bigl(1 - e^{-(t-u)/\lambda_i}\bigr)\,dF(u)
          + D_f \int_0^t F\,du \; [+ x_0 + \dot x_0 t + \delta\,\dot x]

linear in the compliances as a relaxation test is in the stiffnesses: the same engine finds them.
The solid follows by interconversion, exactly, and its covariance by the derivative of that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError
from dashpot.base.plain_text import decapitalise_sentence
from dashpot.base.provenance import Step, list_sources
from dashpot.base.units import format_quantity
from dashpot.datamodel.bounds import BandError, EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.parameter_estimate import Nuisance
from dashpot.datamodel.relaxation import find_quantum
from dashpot.extensions.curves.checks import plateau_determined, values_enough
from dashpot.extensions.curves.creep import checks
from dashpot.extensions.curves.creep.load_noise import load_rows
from dashpot.extensions.curves.creep.preprocess import OF_A_COUNT, load_hold
from dashpot.extensions.curves.creep.retardation_spectrum import (
    FLOW,
    GLASS,
    SelectedCreepModel,
    get_spectrum,
    make_retardation_block,
)
from dashpot.extensions.curves.curve_uncertainty import (
    AT_REST,
    MIN_FITTED_SHARE,
    CurveData,
    find_admissible_spectra,
    is_limited,
    limit_end_of_curve,
    weight_curve,
)
from dashpot.extensions.curves.datamodel.creep import Creep, CreepCompliance, CreepTest, LoadHold
from dashpot.extensions.curves.datamodel.superposition import Superposition, UnshiftedCurve
from dashpot.extensions.curves.relaxation_spectrum import shared_spectrum_if_needed
from dashpot.extensions.curves.shift_uncertainty import find_band_with_shift_errors
from dashpot.extensions.curves.superposition.superpose import superpose
from dashpot.fitting.checks.relaxation import residuals_steady
from dashpot.fitting.checks.solid import (
    arms_distinct,
    arms_supported,
    loss_factor_determined,
    order_agreed,
    residuals_white,
    tau_inside_window,
    valid_band_exists,
)
from dashpot.fitting.data_blocks import (
    NUISANCE_NAMES,
    FitData,
    max_determinable_arms,
    regularise_clock,
)
from dashpot.fitting.fit_construction import build_fit
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.nonlinear_ramp.checks import clocks_agree
from dashpot.fitting.nuisance_priors import (
    ROUNDING,
    NuisanceTerms,
    Prior,
    build_delay_prior,
    estimate_channel_zero,
)
from dashpot.fitting.order_selection import SelectedModel, select_order, validate_arm_count
from dashpot.fitting.parameter_errors import SolutionEstimate, estimate_covariance, rounding_rms
from dashpot.fitting.relaxation_likelihood import estimate_noise_power
from dashpot.fitting.valid_band import find_informed_band
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block, build_recorded_block
from dashpot.numerics.exponential_fit import Solution, solve
from dashpot.numerics.inference.model_order import MIN_K_OVER_SE, bic, significant
from dashpot.preprocessing.checks import check_temperature
from dashpot.signals.segments import find_segments
from dashpot.solids.interconversion import CreepSpectrum
from dashpot.solids.maxwell import GeneralizedMaxwell

# Number of retardation times of the first solution, which gives the velocity.
_FIRST_ORDER = 2
_MIN_COUNT = 5
# smallest retardation time over the time resolution of the load
_RESOLUTION_RATIO = 4.0
# a load is in step to this part of a sample; it is moved so often, and by so many sd at most
_IN_STEP, _MAX_SHIFTS, _MAX_SHIFT_SD = 0.1, 4, 4.0
#: largest angle, omega times the step of the clock, at which a creep test shows the loss
MAX_SAMPLING_ANGLE = 0.1
# margin before the load, in sd of the delay, before which the displacement is at rest
_REST_SD = 2.0
# a drift is known from the samples before the load where its sd is below this part of the usual
_KNOWN_DRIFT = 0.7
# relative difference above which loads are different levels
_LEVEL_DISTANCE = 0.2


def fit_creep(
    test: Creep | Superposition,
    *,
    arms: int | Literal["auto"] = "auto",
    thorough: bool = False,
    max_arms: int = 6,
) -> Fit:
    r"""Fit a generalized Maxwell solid to a creep test, or to a creep compliance.

    The recorded force, freed of its noise, is the input, whatever it does: ramps, overshoot, a
    controller that hunts, several levels, a recovery. Offset (the position before the load), drift
    of the displacement and a delay are nuisance terms, bound by what the record shows before the
    load. BIC decides whether the part comes to rest or flows. No starting guess is needed.

    Parameters
    ----------
    test : CreepTest, LoadHold, CreepCompliance or Superposition
        A raw test is prepared (``dashpot.extensions.curves.creep.preprocess.load_hold``). A
        compliance at several temperatures is shifted to a master curve first, with the defaults of
        :func:`~dashpot.extensions.curves.superposition.superpose.superpose`; where few arms follow
        it less closely than the spectrum that all temperatures share, that stands in their place.
    arms : int or "auto"
        Number of Maxwell arms: as many retardations, or one fewer and a flow. ``"auto"`` takes
        the number that BIC and the significance of every retardation both support.
    thorough : bool
        Add quasi-random starts.
    max_arms : int
        The most that ``"auto"`` tries.

    Returns
    -------
    Fit
        `method` is ``"creep"``; `creep` holds compliances and retardation times with their
        covariance; `solid` is their exact interconversion. The residual is in m, of strain in 1,
        of a compliance relative.

    Raises
    ------
    DataError, FitError
        If no force is held, the compliance falls, or an option makes no sense.
    """
    validate_arm_count(arms, max_arms)
    options = FitOptions(arms, max_arms=max_arms, thorough=thorough)
    if isinstance(test, CreepCompliance) and test.temperature is not None:
        test = superpose(test)
    if isinstance(test, Superposition):
        return _fit_master_curve(test, options)
    if isinstance(test, CreepCompliance):
        origin = UnshiftedCurve(list_sources([test]))
        return _fit_curve(test, origin, options)
    record = load_hold(test) if isinstance(test, CreepTest) else test
    record, retardation = _align_load(record, options)
    return _fit_of_test(record, retardation, arms)


def _align_load(record: LoadHold, options: FitOptions) -> tuple[LoadHold, SelectedCreepModel]:
    r"""The record with its load shifted by the fitted delay, and the result of the fit.

    A delay is a tangent, :math:`\delta\dot x`: of a load that rises in a few samples that is off
    by half of the next power, which looks like a fast retardation. So the load is moved by what
    was found, until hardly any delay is left, by Gauss-Newton.
    """
    max_shift = _MAX_SHIFT_SD * build_delay_prior(record).sd
    retardation = _fit_recorded_load(record, options)
    for _ in range(_MAX_SHIFTS):
        delay = retardation.solution.coefficient("delay")
        if abs(delay) <= _IN_STEP * record.step or abs(record.lead + delay) > max_shift:
            break
        shifted_record = record.with_load_earlier(delay)
        if shifted_record is record:
            break
        record = shifted_record
        retardation = _fit_recorded_load(record, options)
    return record, retardation


def _fit_recorded_load(record: LoadHold, options: FitOptions) -> SelectedCreepModel:
    """Return the kind of part, and its retardations, with the load where the record has it."""
    selections = [
        select_order(_build_data(record, has_flow=flows), candidate_options)
        for flows, candidate_options in _list_candidates(options)
    ]
    return _choose_by_bic([_add_load_errors(record, selection) for selection in selections])


def _list_candidates(options: FitOptions) -> list[tuple[bool, FitOptions]]:
    """Without and with flow, and as many retardations as make that many arms."""
    arms = options.arms
    if arms == 0:
        return [(False, options)]
    return [(False, options), (True, replace(options, arms=arms if arms == "auto" else arms - 1))]


# -- Creep tests ----------------------------------------------------------------------------------


def _build_data(record: LoadHold, *, has_flow: bool) -> FitData:
    """The displacement as a response to the load, with priors from the samples before it."""
    baseline = estimate_preload_baseline(record)
    time = regularise_clock(record.time - record.time[0])
    window = slice(baseline.first_sample, None)
    block = make_retardation_block(
        build_recorded_block(
            time, record.load, record.displacement, window=window,
            offset="offset", drift="drift", k_inf=GLASS,
        ),
        GLASS,
    )  # fmt: skip
    if has_flow:
        block = block.with_column(FLOW, _integrate_load(time, record.load)[window])
    rough_solution = solve(
        [block, *_limit_parameters(block, baseline)],
        min(_FIRST_ORDER, max_determinable_arms([block])),
    )
    block = block.with_column("delay", _compute_delay_column(block, rough_solution, time[window]))
    # what is faster than the load is known answers its noise
    shortest, longest = block.window
    block = replace(block, window=(max(shortest, _RESOLUTION_RATIO * record.resolution), longest))
    return FitData(
        [block], [block.exact], in_time=True,
        build_priors=partial(_limit_parameters, block, baseline),
    )  # fmt: skip


class _PreloadBaseline(NamedTuple):
    """Samples before the load, SI units, and the first sample that the fit may use."""

    offset: Prior
    offset_time: float
    drift: Prior
    delay: Prior
    first_sample: int
    noise: float
    least_error: float
    default_drift: float

    @property
    def terms(self) -> NuisanceTerms:
        """Return the nuisance terms of the columns, which count from the first sample."""
        priors = {"offset": self.offset, "drift": self.drift, "delay": self.delay}
        return NuisanceTerms(priors, -self.offset_time, self.least_error)

    @property
    def has_measured_drift(self) -> bool:
        """Whether these samples determine the drift, and not the default prior."""
        return self.drift.sd < _KNOWN_DRIFT * self.default_drift


def estimate_preload_baseline(record: LoadHold, *, for_limits: bool = False) -> _PreloadBaseline:
    """Return the priors of zero, drift and delay from the samples before the load.

    `for_limits` for limits, which include every undetected drift of a rig.
    """
    time, x = record.time - record.time[0], record.displacement
    delay_prior = build_delay_prior(record)
    # the displacement may have moved before the force shows it
    first = int(np.searchsorted(record.time, record.onset - _REST_SD * delay_prior.sd))
    travel = float(np.ptp(x))
    count = find_quantum(x)
    noise = max(record.displacement_noise, OF_A_COUNT * count)
    # load cell and displacement both drift
    max_travel, duration = float(np.sqrt(2)) * travel, float(record.time[-1] - record.onset)
    limit_noise = noise if for_limits else None
    default_drift = Machine().drift_sd(max_travel, duration, limit_noise)
    slope = Prior(0.0, np.inf)
    if first >= _MIN_COUNT:
        offset, baseline_time, slope = estimate_channel_zero(
            time[:first], x[:first], record.displacement_noise
        )
        # a reading that stands on one count hides a part of the next
        offset = Prior(offset.mean, max(offset.sd, OF_A_COUNT * count))
        slope = Prior(slope.mean, max(slope.sd, count / float(time[first - 1])))
    else:
        # under load from the first sample on, the channel's own zero is all there is
        is_preloaded = abs(record.load[0]) > 0.5 * record.level
        offset, baseline_time, first = Prior(0.0 if is_preloaded else float(x[0]), noise), 0.0, 0
    drift = Prior(*Machine().combine_drift(slope, max_travel, duration, limit_noise))
    # of the load that was moved already, what is left
    delay = Prior(-record.lead, delay_prior.sd)
    return _PreloadBaseline(
        offset, baseline_time, drift, delay, first, noise, ROUNDING * travel, default_drift
    )


def _limit_parameters(
    block: DataBlock, baseline: _PreloadBaseline, spreads: Sequence[float] | None = None
) -> tuple[DataBlock, ...]:
    """Return rows that bind the nuisance terms of a block."""
    return (baseline.terms.build_rows(block, baseline.noise if spreads is None else spreads[0]),)


def _integrate_load(time: FloatArray, load: FloatArray) -> FloatArray:
    """Return the integral of the load over time, N s."""
    steps = 0.5 * (load[1:] + load[:-1]) * np.diff(time)
    return np.concatenate(([0.0], np.cumsum(steps)))


def _compute_response(block: DataBlock, solution: Solution) -> FloatArray:
    """Return the displacement that a solution gives at every sample, without its nuisance terms."""
    rows = block.exact.evaluate(solution.log_tau, False)
    fixed = [
        0.0 if name in NUISANCE_NAMES else solution.coefficient(name) for name in block.fixed_names
    ]
    return np.asarray(rows.fixed @ fixed + rows.arms @ solution.arms[0])


def _compute_delay_column(
    block: DataBlock, first_solution: Solution, time: FloatArray
) -> FloatArray:
    """Return the column of a force that is recorded late: the velocity of the answer, m/s."""
    return np.gradient(_compute_response(block, first_solution), time)


# -- Part with or without flow -------------------------------------------------------------------


def _choose_by_bic(selections: Sequence[SelectedModel]) -> SelectedCreepModel:
    """Return the kind of part that BIC supports, and by how much."""
    effective = min(selection.estimate.effective for selection in selections)
    scores = []
    for model in selections:
        rounding_sse = model.solution.samples * rounding_rms(model.data.peak) ** 2
        checked = bic(
            model.solution.sse,
            effective=effective,
            parameters=len(model.estimate.names),
            rounding_sse=rounding_sse,
        )
        scores.append(checked if _is_flow_significant(model) else np.inf)
    best_index = int(np.argmin(scores))
    other_scores = [score for i, score in enumerate(scores) if i != best_index]
    alternative = other_scores[0] - scores[best_index] if other_scores else None
    model = selections[best_index]
    choice = model.choice
    if choice is not None and FLOW in model.solution.fixed_names:  # a flow makes one more arm
        arm_numbers = (choice.arms + 1, choice.by_bic + 1, choice.by_significance + 1)
        choice = choice._replace(
            arms=arm_numbers[0], by_bic=arm_numbers[1], by_significance=arm_numbers[2]
        )
    return SelectedCreepModel(
        model.data, model.estimate, model.scores, choice, model.requested_arms, alternative
    )


def _is_flow_significant(selection: SelectedModel) -> bool:
    """False if there is an insignificant flow, regardless of BIC."""
    if FLOW not in selection.solution.fixed_names:
        return True
    error = selection.estimate.standard_error(FLOW)
    return selection.solution.coefficient(FLOW) > MIN_K_OVER_SE * error


def _fit_of_test(
    record: LoadHold, retardation: SelectedCreepModel, arms: int | Literal["auto"]
) -> Fit:
    residual = retardation.estimate.residuals[0]
    creep = retardation.spectrum
    final_compliance = creep.compliance(record.hold_time).item()
    band = find_informed_band(
        [record], retardation.data.rows, stiffness=final_compliance,
        noise=max(retardation.estimate.residual_sd, 1e-6 * retardation.data.peak, 1e-300),
    )  # fmt: skip
    window = (2 * float(np.diff(record.time).min()), record.hold_time)
    # between samples a delay and a fast retardation are one: nothing shows the loss there
    highest_frequency = MAX_SAMPLING_ANGLE / (2 * np.pi * float(np.median(np.diff(record.time))))
    band = (band[0], max(min(band[1], highest_frequency), band[0]))
    end, band, error = _limit_end_of_test(record, retardation, band)
    motion_unit = "m" if record.unit == "N/m" else "1"
    nuisance = _list_nuisances(record, retardation, motion_unit)
    all_checks = (
        retardation.convergence_check,
        *_run_checks(retardation, record.unit, window, "the record", motion_unit),
        *_run_flow_checks(creep, record.hold_time),
        checks.creep_finished(creep, record.hold_time),
        *_run_plateau_checks(creep, end, record.unit),
        *_run_drift_checks(record, retardation),
        checks.displacement_residual_small(record, residual),
        checks.levels_agree(*_measure_departure(record, retardation)),
        residuals_steady([residual], rounding=ROUNDING * retardation.data.peak),
        valid_band_exists(band),
        loss_factor_determined(error),
        clocks_agree([_find_delay(nuisance)]),
    )
    return build_fit(
        retardation.make_solid_estimate(replace(retardation.residual, unit=motion_unit), nuisance),
        Evidence(
            band,
            retardation.orders,
            retardation.certificate,
            checks=(*record.checks, *all_checks),
            end_of_hold=end,
            creep=retardation.creep,
            band_error=error,
        ),
        Provenance(
            "creep",
            list_sources([record]),
            (
                *record.steps,
                *_make_lead_steps(record),
                _make_step(retardation, f"{len(residual)} samples of a creep test", arms),
            ),
            record.specimen,
        ),
        unit=record.unit,
    )


def _list_nuisances(
    record: LoadHold, retardation: SelectedCreepModel, word: str
) -> tuple[Nuisance, ...]:
    """Offset, drift and delay: the shift of the load plus the fitted rest."""
    lead = {"delay": record.lead}
    return retardation.nuisances(
        lambda name: retardation.solution.coefficient(name) + lead.get(name, 0.0),
        unit=word,
        delays=[build_delay_prior(record).sd],
    )


def _find_delay(nuisance: Sequence[Nuisance]) -> tuple[float, float, float]:
    """Return the delay of the force, its standard error, and that before the fit, s."""
    term = next(term for term in nuisance if term.name == "delay")
    return term.value, term.standard_error, term.prior_sd or 0.0


def _make_lead_steps(record: LoadHold) -> tuple[Step, ...]:
    """Return the processing steps of the load."""
    if not record.lead:
        return ()
    direction = "earlier" if record.lead > 0 else "later"
    message = (
        f"took the load {format_quantity(abs(record.lead), 'ms', '.3g')} {direction}, as it "
        "is answered"
    )
    return (Step("lead", (("lead_s", f"{record.lead:.6g}"),), message),)


def _add_load_errors(record: LoadHold, selection: SelectedModel) -> SelectedModel:
    """Return the choice with the noise of the load included in its errors.

    Where the number was left to the rules, a retardation that is not significant beside that
    error, too, is not taken.
    """
    data, choice, order = selection.data, selection.choice, selection.solution.order
    while True:
        solution = selection.scores[order].solution
        rows = partial(load_rows, record=record, creep=get_spectrum(solution))
        estimate = estimate_covariance(
            solution, data.samples, peak=data.peak, priors=data.priors, error_rows=[rows]
        )
        if choice is None or order == 0 or _are_significant(selection, estimate):
            break
        order -= 1
    if choice is not None and order < choice.arms:
        choice = choice._replace(arms=order, by_significance=order, is_largest_tried=False)
    return replace(selection, estimate=estimate, choice=choice)


def _are_significant(selection: SelectedModel, estimate: SolutionEstimate) -> bool:
    """Return whether every retardation is significant, and every arm that they make."""
    numbers, function = range(1, estimate.solution.order + 1), estimate.standard_error
    if not significant(
        estimate.solution.arms[0],
        np.array([function(f"k_{i}") for i in numbers]),
        np.array([function(f"ln_tau_{i}") for i in numbers]),
    ):
        return False
    retarded_model = SelectedCreepModel(
        selection.data, estimate, selection.scores, selection.choice, selection.requested_arms
    )
    arms, error = retarded_model.model.arms, retarded_model.every_error[1:]
    return significant(np.array(retarded_model.model.k), error[:arms], error[arms:])


def _run_checks(
    retardation: SelectedCreepModel,
    unit: str,
    window: tuple[float, float],
    subject: str,
    left_in: str,
) -> tuple[Check, ...]:
    """The checks of the solid, whatever it was fitted to; its residual is `left_in` a unit."""
    model, estimate = retardation.model, retardation.estimate
    final_checks = []
    if retardation.alternative_bic_difference is not None:
        ratio = (
            retardation.creep.standard_error(FLOW) / retardation.spectrum.flow
            if retardation.flows
            else None
        )
        final_checks.append(
            checks.flow_distinguished(
                retardation.flows, retardation.alternative_bic_difference, ratio
            )
        )
    return (
        arms_distinct(model),
        arms_supported(model, retardation.every_error, unit=unit),
        tau_inside_window(model, window, subject),
        *final_checks,
        residuals_white(estimate.kappa, estimate.rms),
        *([] if retardation.choice is None else [order_agreed(retardation.choice)]),
        *retardation.check_arm_count(left_in),
    )


def _run_flow_checks(creep: CreepSpectrum, hold: float) -> list[Check]:
    """Return whether a flow that was taken may be slow creep."""
    return [checks.flow_exceeds_slow_retardation(creep, hold)] if creep.flow > 0 else []


def _run_drift_checks(record: LoadHold, retardation: SelectedCreepModel) -> list[Check]:
    """Return whether a drift may be a flow, if the solid has none."""
    if retardation.flows:
        return []
    baseline = estimate_preload_baseline(record)
    drift = retardation.solution.coefficient("drift")
    return [
        checks.drift_distinguished_from_flow(
            drift, baseline.default_drift, is_reported=baseline.has_measured_drift
        )
    ]


def _run_plateau_checks(creep: CreepSpectrum, end: EndOfHold | None, unit: str) -> list[Check]:
    """Return the check that a part without flow has come to rest; empty without limits."""
    return [] if end is None or creep.flow > 0 else [plateau_determined(end, unit)]


def _limit_end_of_test(
    record: LoadHold, retardation: SelectedCreepModel, band: tuple[float, float]
) -> tuple[EndOfHold | None, tuple[float, float], BandError | None]:
    """Return the limits at the end of the hold, and the valid band of the solid.

    Its rig has the default drift and compliance.
    """
    block, residual = retardation.data.blocks[0], retardation.estimate.residuals[0]
    if FLOW not in block.fixed_names:
        time = regularise_clock(record.time - record.time[0])
        span = slice(len(time) - len(residual), None)
        block = block.with_column(FLOW, _integrate_load(time, record.load)[span])
    terms = estimate_preload_baseline(record, for_limits=True).terms
    if record.unit == "N/m":
        give = Machine().give_sd(float(np.ptp(record.displacement)), record.level)
        terms = terms.add_terms(**{GLASS: Prior(0.0, give / record.level)})
    power = max(estimate_noise_power(residual), block.rounding_floor)
    effective_samples = len(residual) * float(np.mean(residual**2)) / power
    data = CurveData(
        block.scale_rows(1 / float(np.sqrt(power))), block.window,
        effective_samples - len(block.fixed_names),
        terms=terms,
    )  # fmt: skip
    lam = retardation.spectrum.lam
    return _limit_end_and_band(data, record.hold_time, retardation.model, lam, band)


def _limit_end_and_band(
    data: CurveData,
    time: float,
    model: GeneralizedMaxwell,
    lam: Sequence[float],
    band: tuple[float, float],
    *,
    origin: Superposition | UnshiftedCurve | None = None,
) -> tuple[EndOfHold | None, tuple[float, float], BandError | None]:
    """Return the limits at the end of some data, and the valid band of their retardations."""
    # what may still come is slow retardation or flow: to time T either may stand for the other
    shortest, longest = data.window
    data = replace(data, window=(shortest, max(longest, AT_REST * time)))
    spectra = find_admissible_spectra(data, time=time, extra=lam)
    end = limit_end_of_curve(data, "creep", time=time, model=model, extra=lam, spectra=spectra)
    return end, *find_band_with_shift_errors(spectra, model, band, origin=origin, creep=True)


def _measure_departure(
    record: LoadHold, retardation: SelectedCreepModel
) -> tuple[float | None, float | None]:
    """Return how far the answer departs from proportion at its largest, and the standard error."""
    hold_segments = [
        segment for segment in find_segments(record.time, record.load) if segment.kind == "hold"
    ]
    levels = np.array([hold.level for hold in hold_segments if hold.first > 0 or hold.level > 0])
    differences = levels[levels > _LEVEL_DISTANCE * record.level]
    if not len(differences) or float(np.ptp(differences)) < _LEVEL_DISTANCE * float(
        differences.max()
    ):
        return None, None
    block = retardation.data.blocks[0]
    response = _compute_response(block, retardation.solution)
    largest = float(np.abs(response).max())
    nonlinear_block = block.with_column("bend", response**2 / largest)
    solution = solve(
        [nonlinear_block, *retardation.data.priors],
        retardation.solution.order,
        log_tau_start=retardation.solution.log_tau,
    )
    estimate = estimate_covariance(
        solution,
        [nonlinear_block.exact],
        peak=retardation.data.peak,
        priors=retardation.data.priors,
    )
    return solution.coefficient("bend"), estimate.standard_error("bend")


def _make_step(result: SelectedCreepModel, limit_text: str, arms: int | Literal["auto"]) -> Step:
    count = len(result.spectrum.d)
    flow = " and a flow" if result.flows else ""
    message = (
        f"fitted {count} retardation{'s' * (count != 1)}{flow} to {limit_text}; the model, with "
        f"{result.model.arms} arm{'s' * (result.model.arms != 1)}, is their exact interconversion"
    )
    return Step("fit_creep", (("arms", str(arms)),), message)


# -- Creep compliance curves ----------------------------------------------------------------------


def _fit_curve(
    curve: CreepCompliance,
    origin: Superposition | UnshiftedCurve,
    options: FitOptions,
) -> Fit:
    """Return the fit of a compliance after a unit step, with relative residuals."""
    is_positive_time = curve.time > 0
    t, values = curve.time[is_positive_time], curve.compliance[is_positive_time]
    rise_check = checks.compliance_rises(values)
    if rise_check.failed:
        raise DataError(
            f"this is no creep compliance: {decapitalise_sentence(rise_check.message_with_remedy)}"
        )
    bad_indices = np.flatnonzero(values <= 0)
    if bad_indices.size:
        i = int(bad_indices[0])
        raise DataError(
            f"the compliance at {t[i]:g} s is {values[i]:g}; expected values > 0: leave out what "
            "came before the load was there"
        )
    max_arm_count = validate_arm_count(options.arms, options.max_arms)
    window = ((float(t[min(1, len(t) - 1)]) - float(t[0])) / 3, float(t[-1]))
    if not window[0] > 0:
        raise FitError(f"{len(t)} values of a compliance after the step; expected at least 4")
    weight = 1 / values
    first = solve(
        [_make_curve_block(t, values, weight, window, has_flow=True)],
        min(max_arm_count, len(t) // 3),
    )
    expected = get_spectrum(first).compliance(t)
    # the size of noisy data is a biased weight: low values would count most
    weight = 1 / np.maximum(expected, MIN_FITTED_SHARE * values)
    selections = []
    for flows, item in _list_candidates(options):
        block = _make_curve_block(t, values, weight, window, has_flow=flows)
        data = FitData([block], [block])
        selections.append(select_order(data, item))
    best = _choose_by_bic(selections)
    creep, unit = best.spectrum, curve.stiffness_unit
    band = 1 / (2 * np.pi * float(t[-1])), 1 / (2 * np.pi * float(t[0]))
    end, error = None, None
    flowing = _make_curve_block(t, values, weight, window, has_flow=True)
    curve_with_flow = weight_curve(flowing, t, window=(window[0], 10 * window[1]))
    if curve_with_flow is not None:
        end, band, error = _limit_end_and_band(
            curve_with_flow, float(t[-1]), best.model, creep.lam, band, origin=origin
        )
        if error is not None:
            line = 1 / (2 * np.pi * t)
            relative_misfit = np.abs(creep.compliance(t) / values - 1)
            in_band = (line >= band[0]) & (line <= band[1])
            error = replace(
                error, misfit=(float(np.max(relative_misfit[in_band], initial=0.0)), 0.0)
            )
    all_checks = (
        *origin.checks,
        best.convergence_check,
        *check_temperature(curve.specimen),
        *_run_checks(best, unit, window, "the curve", "1"),
        *_run_flow_checks(creep, float(t[-1])),
        checks.creep_finished(creep, float(t[-1])),
        *_run_plateau_checks(creep, end, unit),
        values_enough(len(t), "times", are_limited=is_limited(end, error, best.model, band)),
        checks.compliance_residual_small(best.estimate.rms, best.model.arms),
        loss_factor_determined(error),
    )
    step = _make_step(best, f"{len(t)} values of a creep compliance", options.arms)
    return build_fit(
        best.make_solid_estimate(replace(best.residual, unit="1")),
        Evidence(
            band,
            best.orders,
            best.certificate,
            checks=all_checks,
            end_of_hold=end,
            creep=best.creep,
            band_error=error,
        ),
        Provenance("creep", origin.sources, (*origin.steps, step), curve.specimen),
        unit=unit,
        temperatures=origin.temperatures,
    )


def _fit_master_curve(superposition: Superposition, options: FitOptions) -> Fit:
    """Return the fit of a compliance that was shifted together from several temperatures."""
    curve = superposition.curve
    if not isinstance(curve, CreepCompliance):
        raise FitError(
            "this master curve is no creep compliance: fit_dynamic or fit_modulus fits it"
        )
    fit_with_few_arms = _fit_curve(curve, superposition, options)
    if options.arms != "auto" or fit_with_few_arms.evidence.creep is None:
        return fit_with_few_arms
    error = fit_with_few_arms.evidence.creep.spectrum.compliance(curve.time) / curve.compliance - 1
    fit = shared_spectrum_if_needed(fit_with_few_arms, error, superposition, superposition.checks)
    if fit is fit_with_few_arms:
        return fit_with_few_arms
    return replace(fit, evidence=replace(fit.evidence, creep=None))


def _make_curve_block(
    t: FloatArray,
    values: FloatArray,
    weight: FloatArray,
    window: tuple[float, float],
    *,
    has_flow: bool,
) -> DataBlock:
    block = build_hold_block(t, values, k_inf=GLASS, weights=weight, compress=False)
    block = make_retardation_block(replace(block, window=(window[0], 10 * window[1])), GLASS)
    return block.with_column(FLOW, weight * t) if has_flow else block
