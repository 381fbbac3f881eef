"""Identification of a solid from vibration, alone or with relaxation tests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.base.option_fields import FamilyOption
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.fitting.checks.solid import arms_enough
from dashpot.fitting.fit_options import FitOptions, checked_family
from dashpot.fitting.fractional_model.family_selection import ArmColumns
from dashpot.fitting.identification.checks import dashpot_not_missed
from dashpot.fitting.identification.discrepancy_causes import (
    explain_discrepancy,
    refit_with_free_cause,
)
from dashpot.fitting.identification.fit_construction import (
    AlternativeCandidate,
    build_identified_fit,
    reselect_family,
    select_family_candidate,
)
from dashpot.fitting.identification.frf_data import MAX_TAU_REACH, select_frf_data
from dashpot.fitting.identification.likelihood import (
    Candidate,
    IdentificationProblem,
    Parameters,
    descend,
)
from dashpot.fitting.identification.parametrisation import (
    MIN_STIFFNESS_SHARE,
    Arms,
    FractionalElement,
    with_dashpot,
)
from dashpot.fitting.identification.prior_knowledge import HammerRig, SolidPrior
from dashpot.fitting.identification.problem_inputs import (
    PriorTests,
    find_operating_point,
    find_prior_tests,
    list_arm_counts,
    make_constraints,
    make_priors,
    require_seals,
)
from dashpot.fitting.input_tests import Tests, ramp_holds, refuse_copies
from dashpot.fitting.order_selection import EXTRA_ARMS
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit import iterate_orders
from dashpot.numerics.inference.model_order import DECISIVE_BIC, ArmShortage, select_model_order
from dashpot.registry import call_handler
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# Excess of the criterion over its best value that ends the search for more arms.
MAX_CRITERION_RISE = 6.0
# a fractional element lies in a narrow valley of slope and relaxation time: so many starts along it
ELEMENT_STARTS = 4
# steps after which the best of them are known, and how many are then taken to the end
ROUGH_STEPS, FINISHED_STARTS = 25, 2
# relative fall of chi-square that ends a search, and the last descent
COARSE_TOLERANCE, FINE_TOLERANCE = 1e-9, 1e-13
# fall of chi-square over a whole descent: along a valley so flat the optimum is no better known
SETTLED_FALL = 0.5
# a larger number of arms that leaves so many times what the last one leaves
FAILED_DESCENT_RATIO = 1.01


def identify(
    frf: FRF,
    *,
    tests: Tests = (),
    fit: Fit | None = None,
    mass: Quantity | None = None,
    seals: float = 1.0,
    compression: Quantity | None = None,
    temperature: Quantity | None = None,
    band: Range | None = None,
    arms: int | Literal["auto"] = "auto",
    family: FamilyOption = "maxwell",
    rig: HammerRig = HammerRig(),  # noqa: B008
    solid_prior: SolidPrior = SolidPrior(),  # noqa: B008
    bench: FitOptions = FitOptions(),  # noqa: B008
) -> Fit:
    r"""Find the solid of one seal from the FRF of a mass on `seals` of them.

    The model is held against the complex accelerance, line by line in units of its scatter, at
    :math:`s = j\omega + a` and cut where the record was, so neither an exponential window nor a
    short record needs a correction. With relaxation tests both kinds of test share one likelihood
    (:mod:`dashpot.fitting.identification.likelihood`); mass, gain and delay between the channels
    are nuisance parameters with priors.

    Parameters
    ----------
    frf : FRF
        Measured, any kind; a transmissibility with the mass, for it shows K/m alone.
    tests : RampHold, RelaxationTest or sequence of them
        Relaxation tests of the same seal, prepared.
    fit : Fit, optional
        An earlier fit. With `tests` it is what they were fitted to; without, its parameters and
        covariance are a prior.
    mass : float, optional
        kg; None leaves it free.
    seals : float
        How many such seals carry the mass.
    compression : float, optional
        Compression of the seals under the hammer, m; by default that of the mass's weight. Where
        the relaxation test's elastic law is not straight, they are there as stiff as its tangent,
        within its error.
    temperature : float, optional
        Temperature of the seals under the hammer, K, where the tests are of several temperatures;
        by default that of their solid. The solid found is that of the hammer.
    band : (float, float), optional
        Lines to explain, Hz; by default those within a factor of 3 of the peak.
    arms : int or "auto"
        Maxwell arms in all. ``"auto"`` takes the number that the data support.
    family : "maxwell", "fractional" or "auto"
        Arms, a fractional Zener model, or the one of the two that BIC prefers, as in
        :func:`~dashpot.fitting.relaxation.fit`; `Fit.evidence.alternative` is then the other. An
        earlier fit without its tests is a prior of its own family alone.
    rig : HammerRig
        How well mass and channels are known.
    solid_prior : SolidPrior
        What the solid must also obey, and whether it has a dashpot beside its arms.
    bench : FitOptions
        How the tests are fitted that no earlier fit is of.

    Returns
    -------
    Fit
        Of one seal, `method` ``"frf"`` or ``"joint"``; ``nuisance`` holds mass, gain and delay,
        ``moved`` what the hammer changed.

    Raises
    ------
    DataError
        If there are too few lines, or an option cannot be.
    FitError
        If there are fewer arms than the earlier fit has, or the family cannot be fitted.
    """
    checked_family(family, arms)
    mass, compression = convert_to_si(mass, "mass"), convert_to_si(compression, "length")
    records = ramp_holds(tests)
    refuse_copies(records)
    frf_data = select_frf_data(
        frf, seals=require_seals(seals), band=si_range(band, "frequency"), mass=mass
    )
    prior_tests = find_prior_tests(
        records, fit, convert_to_si(temperature, "temperature"), family, bench
    )
    point = find_operating_point(prior_tests.primary_fit, mass, seals, compression)
    priors, constraints = make_priors(mass, rig, point), make_constraints(solid_prior, prior_tests)
    full_problem = IdentificationProblem(prior_tests.relaxations, frf_data, priors, constraints)
    parallel_dashpot = solid_prior.parallel_dashpot
    dashpots = (False, True) if parallel_dashpot == "auto" else (bool(parallel_dashpot),)
    problems = [replace(full_problem, dashpot=dashpot) for dashpot in dashpots]
    numbers = list_arm_counts(arms, prior_tests.arms)
    problems = _extend_reach(problems, max(numbers))
    best, candidates, family_candidate = _select_best(problems, numbers, prior_tests, family)
    scale = best.line_scale
    final_optimum = _run_final_descent(replace(best.problem, scale=scale), best.theta)
    earlier_fit = prior_tests.primary_fit
    element = (
        prior_tests.fractional_fit
        if isinstance(best.problem.parametrisation, FractionalElement)
        else prior_tests.arms
    )
    discrepancy = explain_discrepancy(
        final_optimum,
        lambda problem: _solve_from_start(problem, final_optimum.point, numbers, element),
        law=None if earlier_fit is None else earlier_fit.elastic_law,
        compression=None if point is None else point.compression,
    )
    if discrepancy is not None and family_candidate is not None:
        family_candidate = reselect_family(
            family_candidate,
            lambda candidate: refit_with_free_cause(candidate, discrepancy.explanations[0].name),
        )
    orders = [candidate.copy_with_scale(scale) for candidate in candidates]
    if discrepancy is not None and discrepancy.candidate is not final_optimum:
        # what explains both tests chose its arms anew
        final_optimum, orders = discrepancy.candidate, [discrepancy.candidate]
    solid = build_identified_fit(
        final_optimum,
        orders,
        frf=frf,
        tests=records,
        earlier_fit=earlier_fit,
        fit=element,
        doubtful_tests=prior_tests.doubtful,
        request=arms,
        requested_arms=max(numbers),
        discrepancy=discrepancy,
        family_candidate=family_candidate,
        # where two tests disagree, a dashpot only hides it
        dashpot=()
        if discrepancy
        else (_check_dashpot(best, element), *_check_arm_count(best, arms, element)),
        rig=rig,
    )
    if records or fit is None:
        task, tests_with_rigs = "limits over spectra", prior_tests.doubtful
        solid = call_handler(task, "frf", solid, final_optimum, tests_with_rigs, default=solid)
    return _record_choices(solid, bench)


def _record_choices(fit: Fit, bench: FitOptions) -> Fit:
    """Return a fit whose last step names how its relaxation tests were fitted, if that was said."""
    if not bench.choices:
        return fit
    *earlier_steps, last_step = fit.steps
    stated_values = tuple((f"test {name}", str(value)) for name, value in bench.choices.items())
    step = replace(last_step, parameters=(*last_step.parameters, *stated_values))
    return replace(fit, provenance=replace(fit.provenance, steps=(*earlier_steps, step)))


def _run_final_descent(problem: IdentificationProblem, theta: FloatArray) -> Candidate:
    """The optimum from near it, to the last digit; or where a whole descent lowers nothing more.

    A slow arm and k_inf may trade along a valley without an end, which vibration cannot
    distinguish.
    """
    optimum = descend(problem, theta, tolerance=FINE_TOLERANCE)
    if optimum.optimum.stationary:
        return optimum
    candidate = descend(problem, optimum.theta, tolerance=FINE_TOLERANCE)
    is_settled = optimum.cost - candidate.cost <= SETTLED_FALL
    stationary = candidate.optimum.stationary or bool(is_settled)
    return replace(candidate, optimum=replace(candidate.optimum, stationary=stationary))


# -- Best model of each family ----------------------------------------------------------------


def _select_best(
    problems: Sequence[IdentificationProblem],
    numbers: Sequence[int],
    prior_tests: PriorTests,
    family: str,
) -> tuple[Candidate, list[Candidate], AlternativeCandidate | None]:
    """The candidate to take, every number of arms tried beside it, and the other family's."""
    candidate = None if family == "maxwell" else _fit_fractional(problems, prior_tests)
    if candidate is not None and prior_tests.primary_fit is not prior_tests.arms:
        # an earlier fit of four parameters is no prior of arms
        return candidate, [], None
    candidates = _solve_every_order(problems, numbers, prior_tests.arms)
    best = _select_candidate(candidates)
    if candidate is None:
        return best, candidates, None
    family_candidate = select_family_candidate(best, candidates, candidate, family)
    return (
        family_candidate.best,
        candidates if family_candidate.best is best else [],
        family_candidate,
    )


def _fit_fractional(
    problems: Sequence[IdentificationProblem], prior_tests: PriorTests
) -> Candidate:
    """Return the best fractional element, from the linear start of dynamic stiffness."""
    element, attempts = FractionalElement.from_relaxations(prior_tests.relaxations), []
    for problem in (
        replace(identification_problem, parametrisation=element)
        for identification_problem in problems
    ):
        starts = []
        columns = ArmColumns(_stiffness_blocks(problem))
        for grid_start in (columns.best(), *columns.starts(ELEMENT_STARTS)):
            *fixed_coefficients, k = grid_start.beta.tolist()
            fixed = dict(zip(columns.stack.names, fixed_coefficients, strict=True))
            k_inf, b = max(fixed["k_inf"], 0.0), max(fixed.get("b", 0.0), 0.0)
            tau, alpha = float(np.exp(grid_start.theta[0])), float(grid_start.theta[1])
            solid = FractionalZener(k_inf + k, k_inf, tau, alpha, b)
            starts.append((solid, _mass(problem, fixed)))
        if prior_tests.fractional_fit is not None and isinstance(
            prior_tests.fractional_fit.solid, FractionalZener
        ):
            starts.append((prior_tests.fractional_fit.solid, starts[0][1]))
        rough_optima = [
            descend(
                problem,
                problem.pack(_start(problem, *start)),
                tolerance=COARSE_TOLERANCE,
                max_steps=ROUGH_STEPS,
            )
            for start in starts
            if start[1] > 0 and start[0].k_0 > 0
        ]
        rough_optima.sort(key=lambda candidate: candidate.cost)
        attempts += [
            descend(problem, candidate.theta, tolerance=COARSE_TOLERANCE)
            for candidate in rough_optima[:FINISHED_STARTS]
        ]
    if not attempts:
        raise FitError("no fractional model explains the FRF; widen --band, or fit arms")
    return min(attempts, key=lambda candidate: candidate.bic)


# -- Best model for each number of arms -------------------------------------------------------


def _solve_every_order(
    problems: Sequence[IdentificationProblem], numbers: Sequence[int], earlier_fit: Fit | None
) -> list[Candidate]:
    """Return the optimum for every number of arms, or for fewer where the data reject so many."""
    candidates = [
        optimum
        for problem in problems
        for optimum in _fit_candidates(problem, numbers, earlier_fit)
    ]
    fewest_arms = 0 if problems[0].constraints.before is not None else min(numbers)
    while not candidates and fewest_arms > 0:
        fewest_arms -= 1
        candidates = [
            optimum
            for problem in problems
            for optimum in _fit_candidates(problem, [fewest_arms], earlier_fit)
        ]
    if not candidates:
        raise FitError("no model with arms of positive stiffness explains the FRF; widen --band")
    return candidates


def _fit_candidates(
    whole_problem: IdentificationProblem,
    numbers: Sequence[int],
    earlier_fit: Fit | None,
    *,
    start: Parameters | None = None,
) -> list[Candidate]:
    """Return the optimum for each number of arms that keeps all its arms.

    From a `start` in place of the linear ones, which know of no difference between the tests.
    """
    linear = (
        enumerate(_linear(whole_problem, max(numbers)))
        if start is None
        else [(start.model.maxwell.arms, [start])]
    )
    candidates: list[Candidate] = []
    for number in numbers:
        problem = replace(whole_problem, parametrisation=Arms(number))
        # found one after another, in the order of `numbers`: no more of them than are tried
        starts = next((points for arms, points in linear if arms == number), [])
        best = _find_lowest_optimum(problem, [*starts, *_spread_arms(problem, earlier_fit)])
        # more arms explain no less: where they do, their optimum was not found
        if best.problem.parametrisation.is_complete(best.point.model) and not (
            candidates and best.cost > FAILED_DESCENT_RATIO * candidates[-1].cost
        ):
            candidates.append(best)
        lowest_bic = min((candidate.bic for candidate in candidates), default=np.inf)
        if candidates and (candidates[-1].exact or best.bic > lowest_bic + MAX_CRITERION_RISE):
            break
    return candidates


def _find_lowest_optimum(problem: IdentificationProblem, starts: Sequence[Parameters]) -> Candidate:
    """Return the lowest optimum from several starts, or the first that fits exactly."""
    attempts: list[Candidate] = []
    for start in starts:
        attempts.append(descend(problem, problem.pack(start), tolerance=COARSE_TOLERANCE))
        if attempts[-1].exact:
            break
    return min(attempts, key=lambda candidate: candidate.cost)


def _solve_from_start(
    problem: IdentificationProblem,
    start: Parameters,
    numbers: Sequence[int],
    earlier_fit: Fit | None,
) -> Candidate:
    """Return the best of a problem with no more arms than a start has, from there."""
    if isinstance(problem.parametrisation, FractionalElement):
        return descend(problem, problem.pack(start), tolerance=COARSE_TOLERANCE)
    start_arms = start.model.maxwell.arms
    smaller_numbers = [number for number in numbers if number < start_arms]
    candidates = _fit_candidates(problem, [*smaller_numbers, start_arms], earlier_fit, start=start)
    # where an arm has left every candidate, as it is
    return (
        _select_candidate(candidates)
        if candidates
        else descend(problem, problem.pack(start), tolerance=COARSE_TOLERANCE)
    )


def _select_candidate(candidates: Sequence[Candidate]) -> Candidate:
    """Choose the arms by both rules, with and without a dashpot; then the better of the two.

    An arm that cannot be placed leads nevertheless where BIC is decisive. Were the smaller model to
    lead there, too, 83 FRFs of 20 g at 800 to 3200 Hz and 64 joint fits of truths that share no
    line with dashpot would fare worse. Of 36 FRFs that choose otherwise then, 15 lose their only
    arm, and their peak is too high by a factor of 3.6 or more; of the other 21 the peak lies within
    the limit of the loss factor in 17. Two joint fits err in k(T) by 3 %, where they erred by .2 %
    at most, and say "use". So it stays, as a correction of the others: `list_undetermined_times`
    shows it, and the check on the arms lets the verdict be no better than "use with care".
    """
    scale = min(candidates, key=lambda candidate: candidate.bic).line_scale
    best_candidates = []
    for dashpot in (False, True):
        ladder = {
            candidate.arms: candidate
            for candidate in candidates
            if candidate.problem.dashpot == dashpot
        }
        if ladder:
            are_significant = [
                candidate.copy_with_scale(scale).significant for candidate in ladder.values()
            ]
            bics = [candidate.bic for candidate in ladder.values()]
            best_candidates.append(
                ladder[
                    select_model_order([*ladder], bics, are_significant, decisive=DECISIVE_BIC).arms
                ]
            )
    return min(best_candidates, key=lambda candidate: candidate.bic)


def _check_arm_count(
    best: Candidate, request: int | Literal["auto"], earlier_fit: Fit | None
) -> tuple[Check, ...]:
    """Return whether the data support no further arm, where their number was requested."""
    parametrisation = best.problem.parametrisation
    if request == "auto" or not isinstance(parametrisation, Arms) or best.exact:
        return ()
    arm_count, shortage = parametrisation.count, None
    larger_numbers = [arm_count + index for index in range(1, EXTRA_ARMS + 1)]
    candidates = [best, *_fit_candidates(best.problem, larger_numbers, earlier_fit)]
    scale = min(candidates, key=lambda candidate: candidate.bic).line_scale
    are_significant = [candidate.copy_with_scale(scale).significant for candidate in candidates]
    numbers = [candidate.arms for candidate in candidates]
    bics = [candidate.bic for candidate in candidates]
    supported_count = select_model_order(numbers, bics, are_significant, decisive=DECISIVE_BIC).arms
    if supported_count > arm_count:
        lines = best.problem.frf_data.lines.s
        samples = 2 * len(lines) + sum(
            relaxation.samples for relaxation in best.problem.relaxations
        )
        supported_candidate = candidates[numbers.index(supported_count)]
        residuals = (
            float(np.sqrt(candidate.chi2 / samples)) for candidate in (best, supported_candidate)
        )
        shortage = ArmShortage(arm_count, supported_count, *residuals)
    return (arms_enough(shortage, arm_count, unit="sd"),)


def _check_dashpot(best: Candidate, earlier_fit: Fit | None) -> Check:
    """Whether a parallel dashpot, beside the arms or in place of one, lowers the criterion."""
    parametrisation = best.problem.parametrisation
    if best.problem.dashpot:
        return dashpot_not_missed(
            None, parametrisation.format_model_order(), best.point.model.maxwell.b
        )
    if best.exact:
        return dashpot_not_missed(0.0, parametrisation.format_model_order(), 0.0)
    attempts = []
    if isinstance(parametrisation, Arms):
        fewest_arms = 0 if earlier_fit is None else earlier_fit.model.arms
        for arms in range(max(parametrisation.count - 1, fewest_arms), parametrisation.count + 1):
            problem = replace(best.problem, dashpot=True, parametrisation=Arms(arms))
            attempts += [(problem, start) for start in _spread_arms(problem, earlier_fit)]
    else:
        problem, point = replace(best.problem, dashpot=True), best.point
        attempts = [(problem, replace(point, model=_add_parallel_dashpot(problem, point.model)))]
    candidates = [
        descend(problem, problem.pack(start), tolerance=COARSE_TOLERANCE)
        for problem, start in attempts
    ]
    lowest_candidate = min(candidates, key=lambda candidate: candidate.bic)
    is_significant = best.copy_with_scale(best.line_scale).significant
    b = lowest_candidate.point.model.maxwell.b
    return dashpot_not_missed(
        best.bic - lowest_candidate.bic,
        lowest_candidate.problem.parametrisation.format_model_order(),
        b,
        is_determined=is_significant,
    )


def _stiffness_blocks(problem: IdentificationProblem) -> list[DataBlock]:
    """Return every test as a linear problem in the stiffnesses of the solid."""
    blocks = [
        relaxation.build_weighted_block(i) for i, relaxation in enumerate(problem.relaxations)
    ]
    frf_data = replace(problem.frf_data, seals=problem.frf_data.seals * problem.priors.factor.mean)
    mean = None if problem.priors.mass is None else problem.priors.mass.mean
    return [*blocks, frf_data.stiffness_block(mean, dashpot=problem.dashpot)]


def _mass(problem: IdentificationProblem, fixed_values: Mapping[str, float]) -> float:
    """Return the mass that is known, or that a linear solution found."""
    prior = problem.priors.mass
    return fixed_values["mass@frf"] if prior is None else prior.mean


def _linear(problem: IdentificationProblem, max_arms: int) -> Iterator[list[Parameters]]:
    """Starts from the engine, of none, 1, 2, ... arms: none where it finds no mass.

    Dynamic stiffness is linear in the stiffnesses of the solid.
    """
    for solution in iterate_orders(_stiffness_blocks(problem), max_arms):
        k = solution.arms[0]
        model = GeneralizedMaxwell(
            max(solution.coefficient("k_inf"), 0.0),
            tuple(np.maximum(k, MIN_STIFFNESS_SHARE * k.max(initial=0.0))),
            tuple(solution.tau),
            max(solution.coefficient("b"), 0.0) if problem.dashpot else 0.0,
        )
        fixed = dict(zip(solution.fixed_names, solution.fixed.tolist(), strict=True))
        mass = _mass(problem, fixed)
        yield [_start(problem, model, mass)] if mass > 0 else []


def _spread_arms(problem: IdentificationProblem, earlier_fit: Fit | None) -> list[Parameters]:
    """Starts from the earlier fit, or from nothing, with arms spread over the lines."""
    omega = 2 * np.pi * problem.frf_data.peak_hz
    prior = problem.priors.mass
    mass = 1.0 if prior is None else prior.mean
    # at the peak the mass holds the storage stiffness in balance
    level = mass * omega**2 / (problem.frf_data.seals * problem.priors.factor.mean)
    base, fraction = GeneralizedMaxwell(level * 0.8), 0.2
    if earlier_fit is not None:
        level = level if prior is None else earlier_fit.model.k_0
        base, fraction = earlier_fit.model, 0.1
    assert isinstance(problem.parametrisation, Arms)  # noqa: S101  # an element has a start of its own
    arms = problem.parametrisation.count
    new_arms = arms - base.arms
    if new_arms < 0:
        return []
    starts = []
    for span in (1.0, 6.0) if new_arms > 1 else (1.0,):
        tau = (
            np.geomspace(1 / (span * omega), span / omega, new_arms)
            if new_arms > 1
            else [1 / omega] * new_arms
        )
        model = base + GeneralizedMaxwell(
            0.0, (fraction * level / max(new_arms, 1),) * new_arms, tuple(tau)
        )
        if model.arms == arms:
            starts.append(_start(problem, model, mass))
    return starts


def _extend_reach(
    problems: list[IdentificationProblem], max_arms: int
) -> list[IdentificationProblem]:
    """Return the problems, of computed lines with slower arms: these have no scatter."""
    identification_problem = problems[-1]
    if (
        identification_problem.frf_data.has_absolute_sd
        or identification_problem.relaxations
        or identification_problem.constraints.before is not None
    ):
        return problems
    far_reaching = replace(
        identification_problem,
        frf_data=replace(identification_problem.frf_data, reach=MAX_TAU_REACH),
    )
    lowest_sse = min(
        solution.sse for solution in iterate_orders(_stiffness_blocks(far_reaching), max_arms)
    )
    data = identification_problem.frf_data.extend_reach(
        float(np.sqrt(lowest_sse / (2 * len(identification_problem.frf_data.lines.s))))
    )
    return [replace(problem, frf_data=data) for problem in problems]


def _start(problem: IdentificationProblem, model: Solid, mass: float) -> Parameters:
    return Parameters(
        _add_parallel_dashpot(problem, model), mass, 1.0, 0.0, problem.priors.factor.mean
    )


def _add_parallel_dashpot(problem: IdentificationProblem, model: Solid) -> Solid:
    """Return the solid with a dashpot beside it, where one is sought."""
    if not problem.dashpot or model.maxwell.b > 0:
        return model
    # two percent of the stiffness at the peak
    return with_dashpot(model, 0.02 * model.k_0 / (2 * np.pi * problem.frf_data.peak_hz))
