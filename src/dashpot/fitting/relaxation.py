"""Fit of a model to prepared relaxation tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal, TypedDict

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.errors import DashpotError, FitError
from dashpot.base.option_fields import (
    FamilyOption,
    Method,
    RampLawOption,
    ShiftLaw,
    Vertical,
    require_choice,
)
from dashpot.base.provenance import Step
from dashpot.base.units import Quantity, convert_to_si, format_quantity
from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.admissible_spectra import (
    compute_end_limits,
    spectra_of_holds,
)
from dashpot.fitting.checks import relaxation as checks
from dashpot.fitting.checks.solid import (
    arms_enough,
    loss_factor_determined,
    order_agreed,
    valid_band_exists,
)
from dashpot.fitting.data_blocks import (
    NUISANCE_NAMES,
    FitSetup,
    build_fit_data,
    build_solid,
    compress_tests,
    eq5_obstacle,
    fit_all_orders,
)
from dashpot.fitting.fit_construction import (
    NO_EVIDENCE,
    Residuals,
    SolidEstimate,
    build_fit,
    collect_provenance,
    estimate_without_errors,
    list_nuisances,
    run_relaxation_checks,
)
from dashpot.fitting.fit_options import (
    FitOptions,
    refuse_family,
    refuse_law,
    refuse_shifts,
    require_maxwell_family,
)
from dashpot.fitting.fractional_model.family_selection import (
    FamilySelection,
    FractionalFit,
    add_linear_alternative,
    describe_fit,
    select_family,
)
from dashpot.fitting.input_tests import (
    Tests,
    checked_temperatures,
    find_reference_index,
    ramp_holds,
    refuse_copies,
)
from dashpot.fitting.nonlinear_ramp import checks as ramp_checks
from dashpot.fitting.nonlinear_ramp.linearity import (
    DelayedMotion,
    LinearityResult,
    select_delayed_motion,
)
from dashpot.fitting.nuisance_priors import (
    build_delay_prior,
    build_load_cell_priors,
    compute_significant_drift,
)
from dashpot.fitting.order_selection import SelectedModel, select_order, validate_arm_count
from dashpot.fitting.parameter_errors import (
    SolutionEstimate,
    compute_clock_sensitivity,
    compute_rig_sensitivity,
)
from dashpot.fitting.relaxation_likelihood import (
    build_fitted_data,
    build_relaxation_data,
)
from dashpot.fitting.valid_band import find_hold_band, find_informed_band
from dashpot.numerics.exponential_fit import Solution, solve
from dashpot.preprocessing.signal_conditioning import Filter, filter_record, get_record_filter
from dashpot.registry import require_handler
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

if TYPE_CHECKING:
    from dashpot.fitting.nonlinear_ramp.elastic_law import RampLaw


# Effect of a filter on the parameters.


def check_filter_bias(test: RampHold) -> Check:
    """Return the check of the filter's bias of each parameter, from a noise-free response.

    The solid is fitted to the unfiltered record; its exact answer to the recorded motion is
    fitted again, before and behind the filter, by eq. 5 and by the full history.

    Parameters
    ----------
    test : RampHold
        Filtered, with the record before the filter in ``unfiltered``.
    """
    unfiltered, filter_ = test.unfiltered, get_record_filter(test)
    if unfiltered is None or filter_ is None:
        return checks.filter_bias(None)
    try:
        model = select_order(build_fit_data([unfiltered], FitSetup("full")), FitOptions()).model
        noise_free = replace(
            unfiltered,
            force=model.force(unfiltered.time, unfiltered.displacement),
            machine=Machine(),
            machine_deflection=None,
            checks=(),
        )
        changes = {
            "hold": _compute_filter_changes(noise_free, filter_, model.arms, "hold"),
            "full": _compute_filter_changes(noise_free, filter_, model.arms, "full"),
        }
    except DashpotError as error:
        return checks.filter_bias(filter_, str(error))
    return checks.filter_bias(filter_, changes, min(model.tau, default=np.inf))


def _compute_filter_changes(
    noise_free: RampHold, filter_: Filter, arms: int, method: Method
) -> dict[str, float]:
    """Return the relative change of each parameter by the filter; -1 where an arm is lost."""
    filtered = filter_record(noise_free, filter_)
    if method == "hold":
        # eq. 5 takes the ramp from its corners, which were found before the filter
        filtered = replace(filtered, displacement=noise_free.displacement)
    parameters, filtered_parameters = (
        _solve_parameters(record, arms, method) for record in (noise_free, filtered)
    )
    return {
        name: filtered_parameters[name] / value - 1 if name in filtered_parameters else -1.0
        for name, value in parameters.items()
        if value > 0
    }


def _solve_parameters(record: RampHold, arms: int, method: Method) -> dict[str, float]:
    """Return every parameter of the model with a number of arms by its name."""
    refusal = eq5_obstacle(record) if method == "hold" else None
    if refusal is not None:
        raise FitError(refusal)
    model = build_solid(
        solve(
            compress_tests([record], FitSetup(method, NUISANCE_NAMES if method == "full" else ())),
            arms,
        )
    )
    parameters = {"k_inf": model.k_inf}
    for j, (k, tau) in enumerate(zip(model.k, model.tau, strict=True), start=1):
        parameters |= {f"k_{j}": k, f"tau_{j}": tau}
    return parameters


class _HoldArguments(TypedDict):
    """Arguments of the limits: longest hold, s, fitted model, degrees of freedom of the noise."""

    time: float
    model: GeneralizedMaxwell
    dof: float


def fit(
    tests: Tests,
    *,
    arms: int | Literal["auto"] = "auto",
    method: Method = "full",
    thorough: bool = False,
    nuisance: Sequence[str] = NUISANCE_NAMES,
    max_arms: int = 6,
    law: RampLawOption = "auto",
    family: FamilyOption = "maxwell",
    intervals: bool = True,
    vertical: Vertical = "free",
    shift_law: ShiftLaw = "auto",
    reference: Quantity | None = None,
) -> Fit:
    r"""Return the fit of a generalized Maxwell model to one prepared test, or to several at once.

    ``method="full"`` fits the response to the *recorded* motion x(t) from contact to the end of
    the hold, without the encoder's counts and noise where it shows any
    (:func:`~dashpot.preprocessing.denoising.denoise_displacement`). Offset and drift of the load
    cell and the delay of the force are nuisance terms, each with a prior from the record and its
    machine (:mod:`dashpot.fitting.nuisance_priors`); the force is never filtered,

    .. math:: F(t) = S(t) - \delta\,\dot S(t) + F_0 + \dot F t, \qquad
              S(t) = k_\infty x(t) + \sum_j k_j \int_0^t e^{-(t-u)/\tau_j} \dot x(u)\,du

    If the force lags by more than this first-order term can represent, the motion is delayed by as
    much, where a linear solid then fits (:mod:`dashpot.fitting.nonlinear_ramp.linearity`).

    ``method="hold"`` is the paper's eq. (5) on the hold after an ideal ramp of rate A = x_h/c,

    .. math:: F(t) = A \Bigl[k_\infty c + \sum_j b_j e^{-(t-c)/\tau_j}
              (1 - e^{-c/\tau_j})\Bigr], \qquad b_j = k_j \tau_j

    No starting guess is needed.

    Parameters
    ----------
    tests : RampHold, RelaxationTest or sequence of them
        What :func:`~dashpot.preprocessing.prepare.prepare` returns. Several tests share one solid;
        each has its own tare and drift.
    arms : int or "auto"
        Number of Maxwell arms; 0 is a spring. ``"auto"`` takes the number that BIC with the
        effective sample size and the significance of every arm both support; under noise as slow
        as the arms, by fits in the metric of that noise
        (:mod:`dashpot.numerics.inference.model_order`).
    method : "full" or "hold"
    thorough : bool
        Add quasi-random starting points; the fit of a nonlinear ramp has its own.
    nuisance : sequence of str
        Which terms are fitted along with the solid: ``"offset"``, ``"drift"`` and, of the recorded
        motion, ``"delay"``.
    max_arms : int
        The most that ``"auto"`` tries; at several temperatures three more a decade of shift.
    law : "auto", "linear" or "nonlinear"
        Elastic law of the seal, F_e(x) in place of x. A linear solid that explains ramp and hold
        to their noise is kept. Any other record is fitted hold first
        (:mod:`dashpot.fitting.nonlinear_ramp.elastic_law`): the hold decides on the
        arms, the ramp on the law, which ``"auto"`` makes nonlinear only if that matters.
    family : "maxwell", "fractional" or "auto"
        Arms; a fractional Zener model, whose four parameters are a spectrum that is broad and
        smooth (:class:`~dashpot.solids.fractional.FractionalZener`); or the one of the two that
        BIC prefers. Beside the solid that is taken, `Fit.evidence.alternative` is then the other,
        and says where the two differ. A ramp that is not linear is explained by arms alone.
    intervals : bool
        False returns the optimum of the same model alone, without errors, checks or bounds: for a
        first look, or for computations with many fits. A number of arms left to choose, another
        family than arms, and a bent elastic law need their errors all the same.
    vertical : "free", "T/T_r" or "1"
        What the factor b_T of the stiffnesses may be, where the tests are of several temperatures.
    shift_law : "auto", "wlf", "arrhenius" or "free"
        The law laid through their shift factors a_T: by default by BIC, from three temperatures
        on.
    reference : float, optional
        The tested temperature whose solid is returned, K; by default that nearest to 23 degC.

    Returns
    -------
    Fit

    Raises
    ------
    FitError
        If an option makes no sense, a test is not prepared, or eq. (5) does not apply to the
        recorded history.
    """
    records = ramp_holds(tests)
    if not records:
        raise FitError("there is no test to fit; expected at least one prepared test")
    refuse_copies(records)
    count = validate_arm_count(arms, max_arms)
    options = FitOptions(
        "auto" if arms == "auto" else count, method, law, family, intervals, thorough, max_arms,
        shift_law, vertical, reference,
    )  # fmt: skip
    setup = build_setup(records, options, nuisance)
    temperatures = checked_temperatures(records, shared=method == "full")
    reference = convert_to_si(reference, "temperature")
    if len(temperatures) > 1:
        reference_index = find_reference_index(temperatures, reference)
        require_maxwell_family(family)
        fit_shifted = require_handler("fit at several temperatures", records[0])
        return _record_law_option(fit_shifted(records, options, reference_index), law)
    is_reference_tested = len(temperatures) == 1 and reference in {None, *temperatures.tolist()}
    refuse_shifts(
        "the tests are", replace(options, reference=None) if is_reference_tested else options
    )
    if law == "nonlinear":
        _refuse_history(records)
        nonlinear_fit = _fit_hold_then_ramp(
            records, _select_elastic_law(records, law, options.count), options.count
        )
        return _record_law_option(nonlinear_fit, law)
    try:
        return _record_law_option(_fit_one_temperature(records, setup, options), law)
    except FitError as error:
        failed_checks = (check for record in records for check in record.checks if check.failed)
        cause = next(
            (check.message_with_option for check in failed_checks if check.grade == "stop"), ""
        )
        if not cause:
            raise
        raise FitError(f"{cause} As it is, {error}") from None


def build_setup(
    records: Sequence[RampHold], options: FitOptions, nuisance: Sequence[str] = NUISANCE_NAMES
) -> FitSetup:
    """Return the setup of the fit; its options are checked.

    Raises
    ------
    FitError
        If an option is none, contradicts another, or does not apply to the records.
    """
    _refuse_method(records, options.method)
    refuse_law(options)
    refuse_family(options)
    unknown = [name for name in nuisance if name not in NUISANCE_NAMES]
    if isinstance(nuisance, str) or unknown:
        raise FitError(
            f"nuisance = {nuisance!r}; expected a tuple of names out of {', '.join(NUISANCE_NAMES)}"
        )
    return FitSetup(options.method, tuple(name for name in NUISANCE_NAMES if name in nuisance))


def _refuse_method(records: Sequence[RampHold], method: str) -> None:
    require_choice("method", method, Method, FitError)
    if method == "full":
        return
    for number, record in enumerate(records, start=1):
        refusal = eq5_obstacle(record)
        if refusal is not None:
            test_label = f"test {number} of {len(records)}: " if len(records) > 1 else ""
            raise FitError(test_label + refusal)


def _refuse_history(records: Sequence[RampHold]) -> None:
    """Raise FitError for a nonlinear law of a ramp after earlier loadings."""
    if any(record.loading_start is not None for record in records):
        raise FitError(
            "an elastic law from the ramp was requested, and a record has earlier loadings, which "
            "affect its ramp as well: use a linear law, or cut the record to the test of a "
            "seal that has rested"
        )


def _record_law_option(fit: Fit, law: RampLawOption) -> Fit:
    """Return a fit whose last step names the requested elastic law, if any."""
    if law == "auto" or not fit.steps or fit.steps[-1].name != "fit":
        return fit
    *earlier_steps, last_step = fit.steps
    step = replace(last_step, parameters=(*last_step.parameters, ("elastic", law)))
    return replace(fit, provenance=replace(fit.provenance, steps=(*earlier_steps, step)))


def _fit_one_temperature(records: Sequence[RampHold], setup: FitSetup, options: FitOptions) -> Fit:
    """Return the fit of a linear model, or of a nonlinear ramp if no linear model fits."""
    motion = DelayedMotion.from_records(records, setup)
    initial_fit = None
    fractional_fit = None
    linearity = None
    if setup == FitSetup("full"):
        motion, linearity = select_delayed_motion(motion, options)
        initial_fit, fractional_fit = linearity.initial_fit, linearity.fractional_fit
        # a ramp after earlier loadings responds to those as well: it determines no nonlinear law
        is_linear = linearity.is_linear or any(
            record.loading_start is not None for record in records
        )
        ramp_law = None if is_linear else _select_elastic_law(records, options.law, options.count)
        if ramp_law is not None and not ramp_law.is_linear:
            fit = _fit_hold_then_ramp(records, ramp_law, options.count)
            return (
                fit
                if fractional_fit is None
                else add_linear_alternative(fit, ramp_law.residuals, fractional_fit)
            )
    if options.point is not None:
        initial_fit = initial_fit or fit_all_orders(motion.data, options.point, only_max_arms=True)
        solution = initial_fit.solutions[: options.point + 1][-1]
        return build_point_fit(motion, solution, setup, options.point)
    selected = select_order(motion.data, options, first=initial_fit)
    family_selection = select_family(selected, options.family, fractional_fit)
    if setup.method == "hold":
        depth_errors = [record.depth_error for record in records]
        family_selection = replace(
            family_selection, best=family_selection.best.add_depth_error(depth_errors)
        )
    return _build_linear_fit(motion, family_selection, setup, linearity, options, tests=records)


def _select_elastic_law(
    records: Sequence[RampHold], law: RampLawOption, arms: int | None = None
) -> RampLaw:
    """Return the elastic law that the ramps support."""
    from dashpot.fitting.nonlinear_ramp.elastic_law import select_elastic_law

    return select_elastic_law(records, law=law, arms=arms)


def build_point_fit(
    motion: DelayedMotion, solution: Solution, setup: FitSetup, requested_arms: int = 0
) -> Fit:
    """Return a fit with the optimum alone, without errors or checks."""
    records = motion.hold_blocks.records
    model = build_solid(solution)
    terms = list_nuisances(
        solution.fixed_names, motion.coefficients(solution.coefficient), lambda _: np.inf
    )
    return build_fit(
        SolidEstimate(
            model,
            estimate_without_errors(model, solution.samples, solution.sse, terms),
            has_fewer_arms=solution.order < requested_arms,
            at_bound=bool(solution.at_bound.any()),
        ),
        NO_EVIDENCE,
        collect_provenance(setup.method, records, *motion.steps),
        elastic_law=ElasticLaw.linear(model.k_inf, max(record.depth for record in records)),
    )


def _build_linear_fit(
    motion: DelayedMotion,
    family_selection: FamilySelection,
    setup: FitSetup,
    linearity: LinearityResult | None,
    options: FitOptions,
    *,
    tests: Sequence[RampHold],
) -> Fit:
    """Return the fit of a linear model, with errors, limits, band and checks."""
    records, selection = motion.hold_blocks.records, family_selection.best
    band = find_informed_band(
        records,
        selection.data.rows,
        stiffness=max(selection.model.k_0, 1e-300),
        noise=max(selection.estimate.residual_sd, 1e-6 * selection.data.peak, 1e-300),
    )
    # the limits hold for any spectrum, so the few arms of the fit suffice for the weights
    arms = family_selection.arms
    arms_fit = build_point_fit(motion, arms.solution, setup)
    relaxations = [build_relaxation_data(test, arms_fit) for test in tests]
    data = relaxations
    if setup.method == "full":
        models = [arms.model] * len(records)
        data = [*map(build_fitted_data, records, arms.data.blocks, models, arms.estimate.residuals)]
    hold = _collect_hold_arguments(records, arms)
    end_of_hold = compute_end_limits(data, **hold).widen_to_contain(selection.model)
    # the loss factor depends on fast arms, and so on all errors of the motion
    band, band_error = find_hold_band(spectra_of_holds(relaxations, **hold), selection.solid, band)
    sensitivity = compute_rig_sensitivity(data, selection.solid)
    if setup.method == "hold" and "delay" in setup.nuisance and selection.solid is selection.model:
        sensitivity = np.hstack((sensitivity, compute_clock_sensitivity(records, selection.model)))
    alternative = family_selection.alternative(band)
    steps = (*_make_motion_steps(records, setup), *motion.steps)
    return build_fit(
        selection.make_solid_estimate(
            selection.residual,
            selection.nuisances(
                motion.coefficients(selection.solution.coefficient),
                delays=[build_delay_prior(record).sd for record in records],
            ),
            rig_sensitivity=sensitivity,
        ),
        Evidence(
            band,
            selection.orders,
            selection.certificate,
            checks=(
                *(check for record in records for check in record.checks),
                selection.convergence_check,
                *_run_checks(motion, selection, setup, end_of_hold),
                *([] if linearity is None else [ramp_checks.ramp_explained(linearity.quality)]),
                *family_selection.checks(alternative),
                valid_band_exists(band),
                loss_factor_determined(band_error),
            ),
            end_of_hold=end_of_hold,
            alternative=alternative,
            band_error=band_error,
        ),
        collect_provenance(
            setup.method, records, *steps, _make_fit_step(records, selection, setup, options)
        ),
        elastic_law=ElasticLaw.linear(
            selection.model.k_inf, max(record.depth for record in records)
        ),
    )


def _fit_hold_then_ramp(records: Sequence[RampHold], ramp_law: RampLaw, arms: int | None) -> Fit:
    """Return the fit hold first, with the elastic law that the ramps support."""
    from dashpot.fitting.nonlinear_ramp.elastic_law import find_arm_shortage
    from dashpot.fitting.nonlinear_ramp.fit_construction import build_ramp_data, build_ramp_fit
    from dashpot.fitting.nonlinear_ramp.hold_then_ramp import MAX_ARMS

    data = build_ramp_data(records, ramp_law)
    hold_arguments = _collect_hold_arguments(records, ramp_law)
    spectra = spectra_of_holds(data, **hold_arguments)
    end_of_hold = compute_end_limits(data, **hold_arguments, spectra=spectra)
    sensitivity = compute_rig_sensitivity(data, ramp_law.model)
    arm_checks: tuple[Check, ...] = ()
    if arms is not None or len(ramp_law.hold.log_tau) >= MAX_ARMS:
        supported = find_arm_shortage(records, ramp_law.hold)
        arm_checks = (arms_enough(supported, ramp_law.model.arms, unit="N"),)
    return build_ramp_fit(
        records,
        ramp_law,
        requested_arms=arms,
        checks=arm_checks,
        end=end_of_hold,
        unmeasured=sensitivity,
        spectra=spectra,
    )


def _collect_hold_arguments(
    records: Sequence[RampHold], result: SelectedModel | RampLaw
) -> _HoldArguments:
    """Return the arguments of the limits: hold time, model, degrees of freedom."""
    return {
        "time": max(record.hold_time for record in records),
        "model": result.model,
        "dof": result.estimate.dof,
    }


def _run_checks(
    motion: DelayedMotion, selection: SelectedModel, setup: FitSetup, end_of_hold: EndOfHold | None
) -> tuple[Check, ...]:
    """Return every check of the records and of the fit."""
    records, model, estimate = motion.hold_blocks.records, selection.model, selection.estimate
    choice, error = selection.choice, selection.error
    has_arms_only = not isinstance(selection, FractionalFit)
    all_checks = [
        *(check_filter_bias(record) for record in records if record.unfiltered is not None),
        *run_relaxation_checks(
            records,
            model,
            error,
            Residuals(estimate.residuals, estimate.rms, estimate.kappa),
            end_of_hold,
            method=setup.method,
            arms_selected=choice is not None,
            in_arms=has_arms_only,
        ),
    ]
    if has_arms_only:
        correlation = _compute_drift_correlation(estimate)
        all_checks.append(checks.drift_distinguished_from_arm(model, correlation, float(error[-1])))
    all_checks += _check_load_cells(motion, selection, end_of_hold)
    if choice is not None:
        all_checks.append(order_agreed(choice))
    all_checks += selection.check_arm_count("N")
    if setup.method == "full" and has_arms_only:
        all_checks.append(
            checks.hold_and_full_agree(
                model, motion.hold_blocks.fit_hold_equation(model), error, end=end_of_hold
            )
        )
    return tuple(all_checks)


def _check_load_cells(
    motion: DelayedMotion, selection: SelectedModel, end_of_hold: EndOfHold | None
) -> list[Check]:
    """Return the checks of offset, drift and delay against their priors."""
    estimate, records = selection.estimate, motion.hold_blocks.records
    get_coefficient = motion.coefficients(estimate.solution.coefficient)
    names = estimate.solution.fixed_names

    def list_departures(kind: str) -> list[tuple[float, float, float, float]]:
        results = []
        for i, record in enumerate(records):
            if f"{kind}@{i}" in names:
                cell_priors = build_load_cell_priors(record)
                deviation = get_coefficient(f"{kind}@{i}")
                if kind == "offset" and f"drift@{i}" in names:
                    # at the time at which it is known: the fit states that at the first sample
                    deviation += cell_priors.offset_time * get_coefficient(f"drift@{i}")
                results.append(
                    (
                        deviation,
                        *getattr(cell_priors, kind),
                        getattr(compute_significant_drift(record), kind),
                    )
                )
        return results

    beyond_hold = np.inf if end_of_hold is None else end_of_hold.distance_outside
    all_checks = [
        ramp_checks.offset_plausible(list_departures("offset")),
        ramp_checks.drift_plausible(list_departures("drift"), beyond_hold),
    ]
    delays = [
        (
            get_coefficient(name),
            estimate.standard_error(name),
            build_load_cell_priors(record).delay.sd,
        )
        for name, record in ((f"delay@{i}", record) for i, record in enumerate(records))
        if name in names
    ]
    resolved_priors = [build_load_cell_priors(record) for record in records]
    all_checks.append(
        ramp_checks.baseline_agrees(
            [(prior.baseline_drift.mean, prior.conflict) for prior in resolved_priors]
        )
    )
    return [*all_checks, ramp_checks.clocks_agree(delays)]


def _compute_drift_correlation(estimate: SolutionEstimate) -> float | None:
    """Return the largest correlation between the slowest arm and a drift, None without either."""
    drift_indices = [i for i, name in enumerate(estimate.names) if name.startswith("drift@")]
    if not drift_indices or not estimate.solution.order:
        return None
    slowest_arm = estimate.names.index(f"ln_tau_{estimate.solution.order}")
    standard_errors = np.sqrt(np.diag(estimate.covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.abs(
            estimate.covariance[slowest_arm, drift_indices]
            / (standard_errors[slowest_arm] * standard_errors[drift_indices])
        )
    return float(np.nan_to_num(correlation, nan=1.0).max())


def _make_fit_step(
    records: Sequence[RampHold], selection: SelectedModel, setup: FitSetup, options: FitOptions
) -> Step:
    requested = selection.requested_arms
    parameters = (
        ("arms", "auto" if requested is None else str(requested)),
        ("method", setup.method),
        ("thorough", str(options.thorough).lower()),
        ("nuisance", ", ".join(setup.nuisance) or "none"),
    )
    tests = f"{len(records)} tests" if len(records) > 1 else "one test"
    message = f"fitted {describe_fit(selection)} to {tests} by method {setup.method!r}"
    return Step("fit", parameters, message)


def _make_motion_steps(records: Sequence[RampHold], setup: FitSetup) -> tuple[Step, ...]:
    """Return the steps that denoised each recorded displacement before the fit."""
    if setup.method == "hold":
        return ()
    steps = []
    for record in records:
        step, noise = record.encoder_step, record.displacement_noise
        if step > 0 or noise > 0:
            message = (
                f"read the displacement between counts of {format_quantity(step, 'um', '.3g')} and "
                f"averaged its scatter of {format_quantity(noise, 'um', '.3g')} where the motion "
                "allows; the force is as recorded"
            )
            parameters = (("count", f"{step:.6g} m"), ("noise", f"{noise:.6g} m"))
            steps.append(Step("motion", parameters, message))
    return tuple(steps)
