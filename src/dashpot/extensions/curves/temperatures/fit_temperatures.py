"""Fit of one solid, its shifts and their law to tests at several temperatures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.base.option_fields import RampLawOption, Vertical, require_choice
from dashpot.base.units import celsius
from dashpot.datamodel.bounds import BandError, EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, OrderScore
from dashpot.datamodel.parameter_estimate import Nuisance, ParameterEstimate, parameter_names
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.extensions.curves.shift_law_fit import ShiftLawFit
from dashpot.extensions.curves.superposition.checks import collect_shift_checks, isotherms_overlap
from dashpot.extensions.curves.temperatures import checks
from dashpot.extensions.curves.temperatures.joint_covariance import (
    JointCovariance,
    compute_joint_covariance,
)
from dashpot.extensions.curves.temperatures.joint_optimum import ThermalOptimum, optimum
from dashpot.extensions.curves.temperatures.joint_problem import ShiftedSolid
from dashpot.extensions.curves.temperatures.marginalised_data import (
    SingleTemperatureTest,
    shift_block,
)
from dashpot.extensions.curves.temperatures.result import (
    build_point_fit,
    elastic_law,
    law_of,
    provenance,
    shifts_of,
)
from dashpot.fitting.admissible_spectra import compute_end_limits, spectra_of_holds
from dashpot.fitting.checks.relaxation import hold_long_enough, same_specimen
from dashpot.fitting.checks.solid import (
    arms_enough,
    loss_factor_determined,
    optimiser_converged,
    order_agreed,
    valid_band_exists,
)
from dashpot.fitting.data_blocks import (
    FitData,
    FitSetup,
    build_fit_data,
    build_prior_rows,
    build_record_block,
    fit_all_orders,
)
from dashpot.fitting.fit_construction import (
    RelaxationWindow,
    Residuals,
    SolidEstimate,
    build_fit,
    run_solid_checks,
)
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.input_tests import end_stiffnesses
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.nonlinear_ramp.linearity import HoldBlocks, assess_linearity
from dashpot.fitting.order_selection import EXTRA_ARMS, compute_certificate
from dashpot.fitting.relaxation_likelihood import build_relaxation_data
from dashpot.fitting.valid_band import (
    _find_widest_band,
    compute_posterior_spread,
    find_hold_band,
    find_informed_band,
)
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit import Solution, solve
from dashpot.numerics.inference.model_order import ArmShortage, chi2_sf, is_significant_fall
from dashpot.preprocessing.checks import check_records


def find_single_test_band(
    block: DataBlock, *, stiffness: float, noise: float
) -> tuple[float, float]:
    """Return the valid band of one test by its noise alone, Hz, without other rig errors."""
    frequency, residual = compute_posterior_spread([block], stiffness=stiffness, noise=noise)
    return _find_widest_band(frequency, residual, float(frequency[0]), float(frequency[-1]))


# fraction of the prior variance that data must remove to count as an estimate
_MIN_INFORMATION = 0.01


class MultiTemperatureFit(NamedTuple):
    """Solid fitted at several temperatures, with its uncertainty.

    Attributes
    ----------
    best : ThermalOptimum
    covariance : JointCovariance
    """

    best: ThermalOptimum
    covariance: JointCovariance


# Largest number of arms in the separate fit of each of the tests.
_MAX_TEST_ARMS = 6


def fit_records(records: Sequence[RampHold], options: FitOptions, reference: int) -> Fit:
    """Fit one temperature-dependent solid to ramps and holds, as :func:`fit_thermal`."""
    require_choice("vertical", options.vertical, Vertical, FitError)
    tests = [_fit_single_test(record, options.law, thorough=options.thorough) for record in records]
    return fit_thermal(tests, options, reference)


def _fit_single_test(
    record: RampHold, law: RampLawOption, *, thorough: bool
) -> SingleTemperatureTest:
    """Return one test of several temperatures with its own fit, and the law of a nonlinear ramp."""
    kelvin = record.specimen.temperature or 0.0
    data = build_fit_data([record], FitSetup("full"))
    linearity = assess_linearity(
        HoldBlocks([record]), data, FitOptions(max_arms=_MAX_TEST_ARMS, thorough=thorough)
    )
    is_nonlinear_requested = law == "nonlinear"
    if (
        law == "linear"
        or record.loading_start is not None
        or (linearity.is_linear and not is_nonlinear_requested)
    ):
        return SingleTemperatureTest.from_first_fit(record, kelvin, linearity.initial_fit, None)
    from dashpot.fitting.nonlinear_ramp.elastic_law import select_elastic_law

    ramp_law = select_elastic_law([record], law=law)
    if ramp_law.is_linear and not is_nonlinear_requested:
        return SingleTemperatureTest.from_first_fit(record, kelvin, linearity.initial_fit, None)
    block = build_record_block(
        record,
        terms=("offset", "drift"),
        index=0,
        start=record.settled_samples.start,
        law=ramp_law.law,
    )
    hold_data = FitData(
        [block],
        [block.exact],
        in_time=True,
        build_priors=partial(build_prior_rows, [record], [block], FitSetup("full")),
    )
    return SingleTemperatureTest.from_first_fit(
        record, kelvin, fit_all_orders(hold_data, _MAX_TEST_ARMS), ramp_law.law
    )


def fit_thermal(
    tests: Sequence[SingleTemperatureTest],
    options: FitOptions,
    reference: int,
) -> Fit:
    r"""Fit one solid to tests at several temperatures.

    .. math:: K^*(\omega; T) = b_T K^*(a_T \omega; T_r)

    Every shift factor is unknown along with the solid, through the exact response to each recorded
    motion. Nuisance parameters are a difference of shift between slow and fast arms, and the
    warming of a seal during its record.

    Parameters
    ----------
    tests : sequence of SingleTemperatureTest
    options : FitOptions
        Without intervals and with a given number of arms, only the optimum is returned, without
        errors, checks or bounds.
    reference : int
        Index of the reference temperature, at which the solid is returned.
    """
    arms = options.count
    best = optimum(tests, options, reference)
    if not options.intervals and arms is not None:
        return build_point_fit(best, options.vertical, options.shift_law, requested_arms=arms)
    fit = MultiTemperatureFit(best, compute_joint_covariance(best.joint, best.tests, best.point))
    result = _build_fit(fit, options)
    data = _build_test_data(fit, result)
    end = _end_of_hold(fit, result, data)
    band, error = _find_loss_factor_band(fit, result, data)
    checks = (*result.checks, hold_long_enough(end), loss_factor_determined(error))
    if arms is not None:
        further = replace(options, arms="auto", max_arms=arms + EXTRA_ARMS)
        larger_optimum = optimum(tests, further, reference)
        checks += (_arms_enough(best, larger_optimum),)
    if result.temperatures is not None:
        checks += (_compare_vertical_rules(tests, options, reference, best, result.temperatures),)
    evidence = replace(result.evidence, band=band, end_of_hold=end, checks=checks, band_error=error)
    return replace(result, evidence=evidence)


def _compare_vertical_rules(
    tests: Sequence[SingleTemperatureTest],
    options: FitOptions,
    reference: int,
    best: ThermalOptimum,
    shifts: TemperatureShifts,
) -> Check:
    """Return the check that rules of b_T which explain the tests as well give the same shifts.

    A rule does where its chi-square is no larger than chance allows for the factors that it fixes,
    however many arms it takes: a smooth spectrum has no number of arms that BIC could count.
    """
    alternatives: dict[float, str] = {}
    rules: tuple[Vertical, ...] = ("1", "T/T_r")
    for rule in rules:
        if rule == options.vertical:
            continue
        other = optimum(tests, replace(options, vertical=rule), reference)
        # more arms than BIC asks for may follow the tests with the rule as fewer do without
        other_point = next(
            (
                candidate.point
                for candidate in other.candidates
                if not is_significant_fall(
                    candidate.point.chi_square - best.point.chi_square, len(shifts.shifts) - 1
                )
            ),
            None,
        )
        if other_point is None:
            continue
        change = np.abs(other_point.log_a - best.point.log_a) / np.log(10.0)
        i = int(np.argmax(change))
        values = (float(point.log_a[i] / np.log(10.0)) for point in (other_point, best.point))
        text = "log10 a_T = {:.3g} in place of {:.3g}".format(*values)
        at_temperature = f"at {celsius(shifts.shifts[i].temperature)}"
        alternatives[float(change[i])] = f"with b_T = {rule} and {text} {at_temperature}"
    is_stated = options.vertical != "free"
    if not alternatives:
        return checks.shifts_independent_of_vertical_rule(None, is_stated=is_stated)
    difference, alternative = max(alternatives.items())
    se = max(shift.se for shift in shifts.shifts)
    return checks.shifts_independent_of_vertical_rule(
        difference, se, alternative=alternative, is_stated=is_stated
    )


def _arms_enough(best: ThermalOptimum, larger: ThermalOptimum) -> Check:
    """Return the check that the data support no more arms than requested."""
    smaller_point, larger_point = best.point, larger.point
    arm_shortage = None
    if larger_point.order > smaller_point.order:
        rows = sum(block.samples for block in best.joint.blocks)
        residuals = (
            float(np.sqrt(solid.chi_square / rows)) for solid in (smaller_point, larger_point)
        )
        arm_shortage = ArmShortage(smaller_point.order, larger_point.order, *residuals)
    return arms_enough(arm_shortage, smaller_point.order, unit="sd")


def _build_test_data(fit: MultiTemperatureFit, result: Fit) -> list[RelaxationData | None]:
    """Return the data of each test as limits need them; None for a ramp that is not linear.

    Where one ramp is not, those at the reference temperature alone are built.
    """
    tests, joint = fit.best.tests, fit.best.joint
    has_linear_ramps = all(test.law is None for test in tests)
    return [
        build_relaxation_data(test.record, result)
        if test.law is None and (has_linear_ramps or temperature_index == joint.reference)
        else None
        for test, temperature_index in zip(tests, joint.at, strict=True)
    ]


def _find_loss_factor_band(
    fit: MultiTemperatureFit, result: Fit, test_data: Sequence[RelaxationData | None]
) -> tuple[tuple[float, float], BandError | None]:
    """Return the valid band and the errors of stiffness and loss in it, for linear ramps."""
    data = [relaxation_data for relaxation_data in test_data if relaxation_data is not None]
    if result.temperatures is None or len(data) < len(test_data):
        return result.band, None
    spectra = spectra_of_holds(
        data,
        time=max(test.record.hold_time for test in fit.best.tests),
        model=result.model,
        dof=result.estimate.dof,
    )
    return find_hold_band(spectra, result.model, result.band)


def _end_of_hold(
    fit: MultiTemperatureFit, result: Fit, test_data: Sequence[RelaxationData | None]
) -> EndOfHold | None:
    """Return the limits at the end of the hold at the reference temperature, for linear ramps."""
    tests, joint = fit.best.tests, fit.best.joint
    reference_tests = [
        (test.record, relaxation_data)
        for test, relaxation_data, temperature_index in zip(tests, test_data, joint.at, strict=True)
        if relaxation_data is not None and temperature_index == joint.reference
    ]
    if not reference_tests:
        return None
    records, data = zip(*reference_tests, strict=True)
    return compute_end_limits(
        data,
        time=max(record.hold_time for record in records),
        model=result.model,
        dof=result.estimate.dof,
    )


# -- Fit ------------------------------------------------------------------------------------------


def _build_fit(fit: MultiTemperatureFit, options: FitOptions) -> Fit:
    best, covariance = fit
    tests, point = best.tests, best.point
    errors = covariance.shift_covariance
    law_fit = law_of(best, errors, options.shift_law)
    shifts = shifts_of(best, options.vertical, law_fit, errors, covariance.cross)
    records = [test.record for test in tests]
    model = point.solid
    solution = _solve_at_fixed_shifts(fit)
    shift_factors = [float(np.exp(point.log_a[i])) for i in best.joint.at]
    band = find_informed_band(
        records,
        _reduce_tests(fit),
        stiffness=max(model.k_0, 1e-300),
        noise=1.0,
        shift_factors=shift_factors,
    )
    estimate = ParameterEstimate(
        parameter_names(point.order),
        covariance.solid_covariance,
        covariance.dof,
        covariance.residual,
        nuisance=covariance.nuisances,
    ).with_rig(covariance.solid_rig_sensitivity)
    has_fewer_arms = options.count is not None and model.arms < options.count
    record_checks = [check for record in records for check in record.checks]
    return build_fit(
        SolidEstimate(model, estimate, has_fewer_arms, bool(solution.at_bound.any())),
        Evidence(
            band,
            orders=_score_orders(fit),
            certificate=compute_certificate(_reduce_tests(fit), solution),
            checks=(*record_checks, *_run_checks(fit, shifts, law_fit, band)),
        ),
        provenance(best, shifts),
        elastic_law=elastic_law(best),
        temperatures=shifts,
    )


def _reduce_tests(fit: MultiTemperatureFit) -> list[DataBlock]:
    """Return the data of every test in reduced time."""
    point = fit.best.point
    return [
        shift_block(block, float(point.log_a[i]), float(point.log_b[i]), point.slope)
        for block, i in zip(fit.best.joint.blocks, fit.best.joint.at, strict=True)
    ]


def _solve_at_fixed_shifts(fit: MultiTemperatureFit) -> Solution:
    """Return the optimum at fixed shifts as a `Solution`."""
    return solve(_reduce_tests(fit), fit.best.point.order, log_tau_start=fit.best.point.log_tau)


def _score_orders(fit: MultiTemperatureFit) -> tuple[OrderScore, ...]:
    """Return the scores of every number of arms, with the noise of the selected fit."""
    sse = fit.covariance.residual.sse / fit.best.point.chi_square
    return tuple(
        OrderScore(
            point.order,
            sse * point.chi_square,
            bic,
            fit.best.joint.has_significant_arms(point),
            point.solid,
        )
        for point, bic in fit.best.candidates
    )


def _run_checks(
    fit: MultiTemperatureFit,
    shifts: TemperatureShifts,
    law_fit: ShiftLawFit,
    band: tuple[float, float],
) -> tuple[Check, ...]:
    """Return every check of the records, of the solid and of its shifts."""
    point, covariance = fit.best.point, fit.covariance
    records, residual = [test.record for test in fit.best.tests], covariance.residual
    solids = [point.solid_at(int(i)) for i in fit.best.joint.at]
    low, high = zip(*(block.window for block in _reduce_tests(fit)), strict=True)
    all_checks = [
        optimiser_converged(stationary=True),
        *check_records(records, method="full", solids=solids),
        *run_solid_checks(
            records,
            point.solid,
            np.sqrt(np.diag(covariance.solid_covariance)),
            Residuals(covariance.residuals, residual.rms, residual.variance_inflation),
            RelaxationWindow((min(low), max(high)), "the tests together"),
            solids=solids,
            arms_selected=fit.best.choice is not None,
        ),
        *_collect_shift_checks(fit, shifts, law_fit),
        valid_band_exists(band),
    ]
    if fit.best.choice is not None:
        all_checks.append(order_agreed(fit.best.choice))
    if len(records) > len(shifts.shifts):
        all_checks.append(same_specimen(end_stiffnesses(records)))
    return tuple(all_checks)


def _collect_shift_checks(
    fit: MultiTemperatureFit, shifts: TemperatureShifts, law_fit: ShiftLawFit
) -> list[Check]:
    temperatures = [shift.temperature for shift in shifts.shifts]
    bands = [_find_band_at(fit, i) for i in range(len(temperatures))]
    # the colder of two neighbours covers the lower reduced times: the higher frequencies
    shared = [
        float(np.log10(min(cold[1], hotter[1]) / max(cold[0], hotter[0])))
        for cold, hotter in pairwise(bands)
    ]
    warming = [
        nuisance for nuisance in fit.covariance.nuisances if nuisance.name.startswith("warming")
    ]
    slope = next(
        (nuisance for nuisance in fit.covariance.nuisances if nuisance.name == "shift slope"), None
    )
    chance, excess = _compute_misfit(fit, fit.best.point)
    more_arms = (
        point.order
        for point, _ in fit.best.candidates
        if point.order > fit.best.point.order
        and _compute_misfit(fit, point)[0] >= checks.SIGNIFICANCE_LEVEL
    )
    return [
        isotherms_overlap(shared, temperatures, checks.MIN_SHARED_DECADES),
        *collect_shift_checks(
            fit.best.joint.temperatures,
            [shift.log10_a_t for shift in shifts.shifts],
            shifts.covariance,
            law_fit,
        ),
        checks.thermorheologically_simple(
            chance,
            excess,
            temperatures=len(temperatures),
            slope=None if slope is None else _compute_data_estimate(slope, fit.best.joint.slope_sd),
            enough_arms=min(more_arms, default=None),
        ),
        checks.vertical_shift_plausible(shifts),
        checks.temperature_steady(warming),
        checks.shifts_distinguished(len(temperatures)),
    ]


def _compute_data_estimate(nuisance: Nuisance, prior_sd: float) -> tuple[float, float] | None:
    r"""Return value and error of a nuisance by the data alone, without its prior about 0.

    None is returned where the data add little to the prior.

    .. math:: 1/s^2 = 1/s_d^2 + 1/s_0^2, \qquad v/s^2 = v_d/s_d^2
    """
    information = 1.0 - (nuisance.standard_error / prior_sd) ** 2
    if not information > _MIN_INFORMATION:
        return None
    return nuisance.value / information, nuisance.standard_error / float(np.sqrt(information))


def _find_band_at(fit: MultiTemperatureFit, i: int) -> tuple[float, float]:
    """Return the valid band of the tests at one temperature, Hz at the reference."""
    group = [
        find_single_test_band(block, stiffness=max(fit.best.point.solid.k_0, 1e-300), noise=1.0)
        for block, temperature_index in zip(_reduce_tests(fit), fit.best.joint.at, strict=True)
        if temperature_index == i
    ]
    return min(low for low, _ in group), max(high for _, high in group)


def _compute_misfit(fit: MultiTemperatureFit, point: ShiftedSolid) -> tuple[float, float]:
    r"""Return the p-value of a joint model, and its excess residual over the peak force.

    The p-value is twice the smaller of two: of the residual of the joint fit in units of the
    noise, and of its excess over the residuals of the separate fits.
    """
    tests, joint = fit.best.tests, fit.best.joint
    remainder_sse = sum(block.floor for block in joint.blocks)
    rows = sum(len(block.target) for block in joint.blocks)
    parameters = len(joint.names(point.order))
    joint_misfit, free_misfit = (
        point.chi_square - remainder_sse,
        sum(test.chi_square for test in tests) - remainder_sse,
    )
    extra_parameters = sum(test.parameters for test in tests) - parameters
    # the power of correlated noise is itself uncertain
    noise_factor = 1 + 2 * max(
        float(np.sqrt(2 * (2 * len(noise.autocovariance) - 1) / noise.samples))
        for noise in fit.covariance.noises
    )
    absolute = chi2_sf(joint_misfit / noise_factor, max(rows - parameters, 1))
    relative = chi2_sf((joint_misfit - free_misfit) / noise_factor, max(extra_parameters, 1))
    largest_sd = max(test.spread for test in tests)
    peak = max(float(np.abs(test.record.force).max()) for test in tests)
    samples = sum(test.effective for test in tests)
    ratio = max(joint_misfit - (rows - parameters), 0.0) / samples
    return min(1.0, 2 * min(absolute, relative)), largest_sd * float(np.sqrt(ratio)) / peak
