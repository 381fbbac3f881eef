"""Tests of one seal at several temperatures: one solid, its shifts, and their law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, worst
from dashpot.base.errors import FitError
from dashpot.base.provenance import Step
from dashpot.engine.blocks.block import Block
from dashpot.engine.inference.order import DECISIVE, Choice, chance_beyond, choose, significant
from dashpot.engine.solver.variable_projection import Solution, solve
from dashpot.fitting.checks import relaxation as solid_questions
from dashpot.fitting.checks.relaxation import hold_long_enough
from dashpot.fitting.checks.solid import (
    arms_distinct,
    arms_supported,
    frequencies_informed,
    optimum_found,
    order_agreed,
    residuals_random,
    tau_inside_window,
)
from dashpot.fitting.checks.temperature import (
    law_follows_shifts,
    shift_monotone,
    shifts_determined,
)
from dashpot.fitting.pipeline import certified, ended
from dashpot.fitting.relaxation_data import relaxation_data
from dashpot.fitting.repeats import end_stiffnesses
from dashpot.fitting.shift_law import LawThroughShifts, ShiftLaw, law_through
from dashpot.fitting.temperature import checks
from dashpot.fitting.temperature.joint import Joint, Point, Vertical
from dashpot.fitting.temperature.knowledge import Knowledge, known
from dashpot.fitting.temperature.reduced import Own, moved
from dashpot.fitting.temperature.search import Candidate, again, candidates, first_shifts
from dashpot.fitting.uncertainty.informed_band import informed_alone, informed_band
from dashpot.fitting.uncertainty.left_open import end_of_hold
from dashpot.preparation.checks import of_records
from dashpot.records.bounds import EndOfHold
from dashpot.records.estimate import ParameterEstimate, parameter_names
from dashpot.records.fit import Evidence, Fit, OrderScore, Provenance
from dashpot.records.relaxation import RampHold
from dashpot.records.temperature import SAME_TEMPERATURE, Shift, TemperatureShifts, celsius
from dashpot.solids.elastic import ElasticLaw

# the standard temperature of rubber laboratories, K: the solid is that of the test nearest to it
STANDARD = 296.15
# what is known of how arms shift apart: two temperatures hardly tell, three do
_SLOPE_OF_TWO, _SLOPE = 0.03, 0.3
_ROUNDING = 1e-9


def temperatures_of(records: Sequence[RampHold]) -> FloatArray:
    """Return the temperatures of tests, K, rising; those of one temperature as their mean.

    Empty unless every test has one.
    """
    found = sorted(
        record.specimen.temperature for record in records if record.specimen.temperature is not None
    )
    if len(found) < len(records):
        return np.zeros(0)
    groups: list[list[float]] = []
    for one in found:
        if groups and one - groups[-1][0] <= SAME_TEMPERATURE:
            groups[-1].append(one)
        else:
            groups.append([one])
    return np.array([float(np.mean(group)) for group in groups])


def reference_of(temperatures: FloatArray, asked: float | None) -> int:
    """Return which temperature, K, is the reference: the one asked for, or nearest to 23 degC.

    Raises
    ------
    FitError
        If no test is of the temperature asked for.
    """
    apart = np.abs(temperatures - (STANDARD if asked is None else asked))
    if asked is not None and apart.min() > SAME_TEMPERATURE:
        listed = ", ".join(celsius(float(one)) for one in temperatures)
        raise FitError(
            f"no test is of the reference temperature {celsius(asked)}; expected one of {listed}"
        )
    return int(np.argmin(apart))


class Thermal(NamedTuple):
    """One solid at several temperatures, found and judged.

    Attributes
    ----------
    tests : tuple of Own
        With the columns of a seal that warms.
    joint : Joint
    tried : tuple of Candidate
    choice : Choice or None
        None if the number of arms was asked for.
    knowledge : Knowledge
    """

    tests: tuple[Own, ...]
    joint: Joint
    tried: tuple[Candidate, ...]
    choice: Choice | None
    knowledge: Knowledge

    @property
    def point(self) -> Point:
        """The optimum."""
        return self.knowledge.point


def fit_thermal(
    tests: Sequence[Own],
    *,
    arms: int | None,
    max_arms: int,
    vertical: Vertical = "free",
    shift_law: ShiftLaw = "auto",
    reference: int = 0,
) -> Fit:
    r"""Fit one solid to tests at several temperatures.

    .. math:: K^*(\omega; T) = b_T K^*(a_T \omega; T_r)

    Every shift factor is unknown along with the solid, through the exact answer to each recorded
    motion. How slow and fast arms shift apart, and a seal that warms while it is recorded, are
    nuisances always.

    Parameters
    ----------
    tests : sequence of Own
    arms : int or None
        None to choose.
    max_arms : int
    vertical : "free", "T/T_r" or "1"
        What b_T may be.
    shift_law : str
        As in :func:`~dashpot.fitting.shift_law.law_through`.
    reference : int
        Which of the temperatures the solid is that of.
    """
    found = _found(tests, reference, arms=arms, max_arms=max_arms, vertical=vertical)
    made = _assembled(found, vertical, shift_law, asked=arms)
    end = _end_of_hold(found, made)
    checks = (*made.checks, hold_long_enough(end))
    return replace(made, evidence=replace(made.evidence, end_of_hold=end, checks=checks))


def _end_of_hold(found: Thermal, made: Fit) -> EndOfHold | None:
    """What the tests at the reference leave open of the end of their hold; their ramps linear."""
    records = [
        test.record
        for test, at in zip(found.tests, found.joint.at, strict=True)
        if at == found.joint.reference and test.law is None
    ]
    if not records:
        return None
    return end_of_hold(
        [relaxation_data(record, made) for record in records],
        time=max(record.hold_time for record in records),
        tau=made.model.tau,
        dof=max(made.dof, 1.0),
    )


def _found(
    tests: Sequence[Own], reference: int, *, arms: int | None, max_arms: int, vertical: Vertical
) -> Thermal:
    temperatures = temperatures_of([test.record for test in tests])
    at = np.array([int(np.argmin(np.abs(temperatures - test.temperature))) for test in tests])
    slope = _SLOPE_OF_TWO if len(temperatures) == 2 else _SLOPE

    def joint_of(every: Sequence[Own]) -> Joint:
        blocks = [test.marginal for test in every]
        return Joint(blocks, at, temperatures, reference, vertical, slope)

    effective = sum(test.effective for test in tests)
    joint = joint_of(tests)
    most = max_arms if arms is None else arms
    tried = candidates(joint, first_shifts(joint), most, effective=effective)
    choice = _choice(joint, tried, exhausted=len(tried) - 1 < most)
    # the columns of a warming seal are those of the solid found without them, then with them
    for _ in range(2):
        point = _taken(tried, choice, arms).point
        tests = tuple(
            _warmed(test, point, int(i), temperatures) for test, i in zip(tests, at, strict=True)
        )
        joint = joint_of(tests)
        tried = again(joint, tried, effective)
        choice = _choice(joint, tried, exhausted=len(tried) - 1 < most)
    best = _ascending(_taken(tried, choice, arms).point)
    return Thermal(
        tuple(tests), joint, tried, choice if arms is None else None, known(joint, tests, best)
    )


def _warmed(test: Own, point: Point, i: int, temperatures: FloatArray) -> Own:
    by_a, by_b = (np.gradient(one, temperatures)[i] for one in (point.log_a, point.log_b))
    return test.warmed(point.solid_at(i), by_a=float(by_a), by_b=float(by_b))


def _ascending(point: Point) -> Point:
    order = np.argsort(point.log_tau)
    return replace(point, log_k=point.log_k[order], log_tau=point.log_tau[order])


def _choice(joint: Joint, tried: Sequence[Candidate], *, exhausted: bool) -> Choice:
    numbers = [one.point.order for one in tried]
    clear = []
    for one in tried:
        n, error = one.point.order, joint.errors(one.point)
        clear.append(significant(np.ones(n), error[1 : 1 + n], error[1 + n : 1 + 2 * n]))
    bics = [one.bic for one in tried]
    return choose(numbers, bics, clear, exhausted=exhausted, decisive=DECISIVE)


def _taken(tried: Sequence[Candidate], choice: Choice, asked: int | None) -> Candidate:
    most = choice.arms if asked is None else asked
    return [one for one in tried if one.point.order <= most][-1]


# -- the shifts -----------------------------------------------------------------------------------


def _law(found: Thermal, law: ShiftLaw) -> LawThroughShifts:
    temperatures, covariance = found.joint.temperatures, found.knowledge.shift_covariance
    count = len(temperatures)
    return law_through(
        temperatures,
        found.point.log_a / np.log(10.0),
        covariance[:count, :count],
        reference=float(temperatures[found.joint.reference]),
        law=law,
    )


def _shifts(found: Thermal, vertical: Vertical, laid: LawThroughShifts) -> TemperatureShifts:
    covariance, count = found.knowledge.shift_covariance, len(found.joint.temperatures)
    error = np.sqrt(np.diag(covariance))
    b = np.exp(found.point.log_b)
    rows = zip(
        found.joint.temperatures,
        found.point.log_a / np.log(10.0),
        error[:count],
        b,
        b * error[count:],
        strict=True,
    )
    shifts = tuple(Shift(*(float(one) for one in row)) for row in rows)
    return TemperatureShifts(
        laid.law,
        shifts,
        covariance,
        laid.parameters,
        laid.covariance,
        vertical,
        slope=found.point.slope,
        cross=found.knowledge.cross,
    )


# -- the fit --------------------------------------------------------------------------------------


def _assembled(
    found: Thermal, vertical: Vertical, shift_law: ShiftLaw, *, asked: int | None
) -> Fit:
    laid = _law(found, shift_law)
    shifts = _shifts(found, vertical, laid)
    tests, point, knowledge = found.tests, found.point, found.knowledge
    records = [test.record for test in tests]
    model = point.solid
    solution = _solution(found)
    slower = [float(np.exp(point.log_a[i])) for i in found.joint.at]
    band = informed_band(
        records, _reduced(found), stiffness=max(model.k_0, 1e-300), noise=1.0, slower=slower
    )
    answers = _checks(found, shifts, laid, band)
    failed = {check.name for check in answers if check.failed}
    at_reference = [
        test for test, i in zip(tests, found.joint.at, strict=True) if i == found.joint.reference
    ]
    deepest = max(at_reference, key=lambda test: test.record.depth)
    law = ElasticLaw.linear(model.k_inf, deepest.record.depth)
    if deepest.law is not None:
        law = replace(deepest.law, stiffness=model.k_inf)
    return Fit(
        solid=model,
        status=ended(
            stationary="optimum_found" not in failed,
            fewer=asked is not None and model.arms < asked,
            at_bound=bool(solution.at_bound.any()) or "tau_inside_window" in failed,
            identified=not failed & {"arms_supported", "k_inf_positive"},
            agreed="thermorheologically_simple" not in failed,
        ),
        estimate=ParameterEstimate(
            parameters=parameter_names(point.order),
            covariance=knowledge.of_solid,
            dof=knowledge.dof,
            residual=knowledge.residual,
            nuisance=knowledge.nuisances,
        ),
        evidence=Evidence(
            band=band,
            orders=_orders(found),
            certificate=certified(_reduced(found), solution),
            checks=(*(check for record in records for check in record.checks), *answers),
        ),
        provenance=Provenance(
            "full",
            tuple(record.source for record in records if record.source is not None),
            (*(step for record in records for step in record.steps), _step(found, shifts)),
            replace(deepest.record.specimen, temperature=shifts.reference),
        ),
        elastic_law=law,
        temperatures=shifts,
    )


def _reduced(found: Thermal) -> list[Block]:
    """Every test in the time of the reference."""
    point = found.point
    return [
        moved(block, float(point.log_a[i]), float(point.log_b[i]), point.slope)
        for block, i in zip(found.joint.blocks, found.joint.at, strict=True)
    ]


def _solution(found: Thermal) -> Solution:
    """The optimum as the engine's, the shifts held."""
    return solve(_reduced(found), found.point.order, log_tau_start=found.point.log_tau)


def _orders(found: Thermal) -> tuple[OrderScore, ...]:
    """Every number tried; sums of squares in the noise of the fit taken."""
    sse = found.knowledge.residual.sse / found.point.chi_square
    scores = []
    for one in found.tried:
        n, error = one.point.order, found.joint.errors(one.point)
        clear = significant(np.ones(n), error[1 : 1 + n], error[1 + n : 1 + 2 * n])
        scores.append(OrderScore(n, sse * one.point.chi_square, one.bic, clear, one.point.solid))
    return tuple(scores)


def _checks(
    found: Thermal,
    shifts: TemperatureShifts,
    laid: LawThroughShifts,
    band: tuple[float, float],
) -> tuple[Check, ...]:
    """Return every check of the records, of the solid and of its shifts."""
    tests, point, knowledge = found.tests, found.point, found.knowledge
    records, model = [test.record for test in tests], point.solid
    error = np.sqrt(np.diag(knowledge.of_solid))
    solids = [point.solid_at(int(i)) for i in found.joint.at]
    residual, each = knowledge.residual, list(zip(records, solids, strict=True))
    left = list(zip(records, knowledge.residuals, strict=True))
    k_inf = float(error[0])
    low, high = zip(*(block.window for block in _reduced(found)), strict=True)
    peak = max(float(np.abs(record.force).max()) for record in records)
    answers = [
        optimum_found(stationary=True),
        *of_records(records, method="full"),
        arms_distinct(model),
        arms_supported(model, error, needed=found.choice is not None),
        tau_inside_window(
            model,
            (min(low), max(high)),
            "the tests together",
            within=True,
            advice="; do not use this arm: fit fewer arms, hold longer or sample faster",
        ),
        solid_questions.k_inf_positive(model, k_inf),
        solid_questions.k_inf_known(model, k_inf, records),
        worst(solid_questions.arms_where_force_relaxes(one, record) for record, one in each),
        worst(solid_questions.force_followed(record, rest) for record, rest in left),
        residuals_random(residual.kappa, residual.rms, max(one.force_noise for one in records)),
        solid_questions.residuals_steady(knowledge.residuals, rounding=_ROUNDING * peak),
        *_of_shifts(found, shifts, laid),
        frequencies_informed(band),
    ]
    if found.choice is not None:
        answers.append(order_agreed(found.choice))
    if len(records) > len(shifts.shifts):
        answers.append(solid_questions.same_specimen(end_stiffnesses(records)))
    return tuple(answers)


def _of_shifts(found: Thermal, shifts: TemperatureShifts, laid: LawThroughShifts) -> list[Check]:
    temperatures = [shift.temperature for shift in shifts.shifts]
    bands = [_informed_at(found, i) for i in range(len(temperatures))]
    # the colder of two neighbours informs the lower reduced times: the higher frequencies
    shared = [
        float(np.log10(min(cold[1], warm[1]) / max(cold[0], warm[0])))
        for cold, warm in pairwise(bands)
    ]
    warming = [one for one in found.knowledge.nuisances if one.name.startswith("warming")]
    slope = next((one for one in found.knowledge.nuisances if one.name == "shift slope"), None)
    chance, excess = _misfit(found)
    return [
        checks.overlap(shared, temperatures),
        *_of_law(found, shifts, laid),
        checks.thermorheologically_simple(
            chance,
            excess,
            temperatures=len(temperatures),
            slope=None if slope is None else (slope.value, slope.standard_error),
        ),
        checks.stiffness_of_one_seal(shifts),
        checks.temperature_steady(warming),
        checks.shifts_told_apart(len(temperatures)),
    ]


def _of_law(found: Thermal, shifts: TemperatureShifts, laid: LawThroughShifts) -> tuple[Check, ...]:
    """How each shift lies against that of the next temperature, and the law against all."""
    t, count = found.joint.temperatures, len(shifts.shifts)
    between = np.diff(np.eye(count), axis=0)
    step = between @ [shift.log10_a_t for shift in shifts.shifts]
    error = np.sqrt(np.diag(between @ shifts.covariance[:count, :count] @ between.T))
    return (
        shifts_determined(error, t),
        shift_monotone(step, error, t),
        law_follows_shifts(laid.score, laid.scores),
    )


def _informed_at(found: Thermal, i: int) -> tuple[float, float]:
    """The band that the tests of one temperature inform, Hz at the reference."""
    each = [
        informed_alone(block, stiffness=max(found.point.solid.k_0, 1e-300), noise=1.0)
        for block, at in zip(_reduced(found), found.joint.at, strict=True)
        if at == i
    ]
    return min(low for low, _ in each), max(high for _, high in each)


def _misfit(found: Thermal) -> tuple[float, float]:
    r"""Return how likely chance makes the joint fit as bad, and its excess over the peak force.

    The smaller probability, doubled, of two: what the joint fit leaves in the rows that a solid can
    reach, in units of the noise, and how much more that is than the free fits of each test leave.
    """
    tests, point, joint = found.tests, found.point, found.joint
    floor = sum(block.floor for block in joint.blocks)
    rows = sum(len(block.target) for block in joint.blocks)
    parameters = len(joint.names(point.order))
    left, own = point.chi_square - floor, sum(test.chi_square for test in tests) - floor
    freed = sum(test.parameters for test in tests) - parameters
    # noise that remembers is itself known to so much only
    doubt = 1 + 2 * max(
        float(np.sqrt(2 * (2 * len(noise.autocovariance) - 1) / noise.samples))
        for noise in found.knowledge.noises
    )
    absolute = chance_beyond(left / doubt, max(rows - parameters, 1))
    relative = chance_beyond((left - own) / doubt, max(freed, 1))
    spread = max(test.spread for test in tests)
    peak = max(float(np.abs(test.record.force).max()) for test in tests)
    samples = sum(test.effective for test in tests)
    beyond = max(left - (rows - parameters), 0.0) / samples
    return min(1.0, 2 * min(absolute, relative)), spread * float(np.sqrt(beyond)) / peak


def _step(found: Thermal, shifts: TemperatureShifts) -> Step:
    model = found.point.solid
    listed = ", ".join(celsius(shift.temperature) for shift in shifts.shifts)
    says = (
        f"fitted a generalized Maxwell solid with {model.arms} arm{'s' * (model.arms != 1)} to "
        f"{len(found.tests)} tests at {listed}; the solid is that of {celsius(shifts.reference)}, "
        f"its shifts follow the {shifts.law.kind} law"
    )
    asked = "auto" if found.choice is not None else str(model.arms)
    parameters = (
        ("arms", asked),
        ("vertical", shifts.vertical),
        ("temperatures_K", ", ".join(repr(float(test.temperature)) for test in found.tests)),
        ("reference_K", repr(shifts.reference)),
        ("law", shifts.law.kind),
    )
    return Step("fit", parameters, says)
