"""From vibration, alone or with relaxation, to a solid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError
from dashpot.base.units import Dimension, Quantity, Range, si, si_range
from dashpot.engine.inference.order import DECISIVE, choose
from dashpot.engine.solver.variable_projection import solve_orders
from dashpot.fitting.identification.checks import dashpot_not_missed
from dashpot.fitting.identification.explanations import disagreement
from dashpot.fitting.identification.fit_assembly import assembled
from dashpot.fitting.identification.frf_data import frf_data_of
from dashpot.fitting.identification.likelihood import (
    UNCHANGED,
    Candidate,
    Constraints,
    NuisancePriors,
    Parameters,
    Prior,
    Problem,
    descend,
)
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.fitting.relaxation_data import RelaxationData, relaxation_data
from dashpot.fitting.repeats import refuse_copies
from dashpot.preparation.ramp_holds import Tests, ramp_holds
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.relaxation import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.systems.operating_point import OperatingPoint, operating_point

Given: TypeAlias = Quantity | tuple[Quantity, Quantity] | None

# a block on a workshop balance: 0.1 g of 100 g
USUAL_MASS_SD = 0.001
USUAL_GAIN_SD = 0.01
USUAL_DELAY_SD = 1e-4
MOST_ARMS = 3
# an arm with less than this part of the stiffness has left
GONE = 1e-6
# a criterion this much above the best ends the search for more arms
WORSE = 6.0
# relative fall of chi-square that ends a search, and the last descent
LOOSE, TIGHT = 1e-9, 1e-13


def identify(
    frf: FRF,
    *,
    tests: Tests = (),
    fit: Fit | None = None,
    mass: Quantity | None = None,
    seals: float = 1.0,
    arms: int | Literal["auto"] = "auto",
    parallel_dashpot: bool | Literal["auto"] = False,
    static_stiffness: Given = None,
    natural_frequency: Given = None,
    damping_ratio: Given = None,
    mass_sd: Quantity | None = None,
    gain_sd: float = USUAL_GAIN_SD,
    delay_sd: Quantity = USUAL_DELAY_SD,
    band: Range | None = None,
    compression: Quantity | None = None,
    temperature: Quantity | None = None,
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
        Measured, any kind.
    tests : RampHold, RelaxationTest or sequence of them
        Relaxation tests of the same seal, prepared.
    fit : Fit, optional
        An earlier fit. With `tests` it is what they were fitted to; without, its parameters and
        covariance are a prior.
    mass : float, optional
        kg; None leaves it free.
    seals : float
        How many such seals carry the mass.
    arms : int or "auto"
        Maxwell arms in all. ``"auto"`` takes the number that the data support.
    parallel_dashpot : bool or "auto"
        Add a dashpot: with no arm a Voigt solid, with one a Maxwell-Voigt solid.
    static_stiffness, natural_frequency, damping_ratio : float or (float, float), optional
        What the solid must also obey: k_inf of one seal, N/m; natural frequency :math:`|p|/2\pi`,
        Hz, and damping ratio of the mass on the seals. A pair is a value and its standard
        deviation, a number is exact (Zhang and Richards 2007).
    mass_sd : float, optional
        Standard deviation of the mass, kg; 0.1 % by default, 0 if exact.
    gain_sd, delay_sd : float
        What acceleration over force may be off by, relative, and late by, s; 0 if exact.
    band : (float, float), optional
        Lines to explain, Hz; by default those within a factor of 3 of the peak.
    compression : float, optional
        Of the seals under the hammer, m; by default that of the mass's weight. Where the relaxation
        test's elastic law is not straight, they are there as stiff as its tangent, within its
        error.
    temperature : float, optional
        Of the seals under the hammer, K, where the tests are of several temperatures; by default
        that of their solid. The solid found is that of the hammer.

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
        If there are fewer arms than the earlier fit has.
    """
    mass, mass_sd, delay_sd = si(mass, "mass"), si(mass_sd, "mass"), si(delay_sd, "time")
    band, compression = si_range(band, "frequency"), si(compression, "length")
    records = ramp_holds(tests)
    refuse_copies(records)
    frf_data = frf_data_of(frf, seals=_seals(seals), band=band)
    before, relaxations = _relaxations(records, fit, si(temperature, "temperature"))
    point = _point(before, mass, seals, compression)
    priors = NuisancePriors(
        _mass(mass, mass_sd),
        _sd("gain_sd", gain_sd),
        _sd("delay_sd", delay_sd),
        factor=UNCHANGED if point is None else Prior(point.factor, point.factor_se),
    )
    constraints = Constraints(
        _known("static_stiffness", static_stiffness, "stiffness"),
        _known("natural_frequency", natural_frequency, "frequency"),
        _known("damping_ratio", damping_ratio, "strain"),
        before if before is not None and not relaxations else None,
    )
    whole = Problem(relaxations, frf_data, priors, constraints)
    numbers = _numbers(arms, before)
    dashpots = (False, True) if parallel_dashpot == "auto" else (bool(parallel_dashpot),)
    found = _every([replace(whole, dashpot=dashpot) for dashpot in dashpots], numbers, before)
    best = _chosen(found)
    scale = best.line_scale
    final = descend(replace(best.problem, scale=scale), best.theta, tolerance=TIGHT)
    apart = disagreement(
        final,
        lambda problem: _again(problem, final.point, numbers, before),
        law=None if before is None else before.elastic_law,
        compression=None if point is None else point.compression,
    )
    return assembled(
        final,
        [candidate.scaled(scale) for candidate in found],
        frf=frf,
        tests=records,
        before=before,
        asked=arms,
        most=max(numbers),
        apart=apart,
        # where two tests disagree, a dashpot only hides it
        dashpot=() if apart else (_dashpot_missed(best, before),),
    )


# -- the best solid for each number of arms ---------------------------------------------------


def _every(
    problems: Sequence[Problem], numbers: Sequence[int], before: Fit | None
) -> list[Candidate]:
    """The optimum for every number of arms, or for fewer where the data reject so many."""
    found = [best for problem in problems for best in _candidates(problem, numbers, before)]
    fewer = 0 if problems[0].constraints.before is not None else min(numbers)
    while not found and fewer > 0:
        fewer -= 1
        found = [best for problem in problems for best in _candidates(problem, [fewer], before)]
    if not found:
        raise FitError("no solid with arms of positive stiffness explains the FRF; widen --band")
    return found


def _candidates(
    whole: Problem,
    numbers: Sequence[int],
    before: Fit | None,
    *,
    start: Parameters | None = None,
) -> list[Candidate]:
    """The optimum for each number of arms that keeps all its arms.

    From a `start` in place of the linear ones, which know of no difference between the tests.
    """
    given = _linear(whole, max(numbers)) if start is None else [start]
    found: list[Candidate] = []
    for number in numbers:
        problem = replace(whole, arms=number)
        starts = [one for one in given if one.model.arms == number]
        starts += _spread(problem, before)
        tries = [descend(problem, problem.pack(one), tolerance=LOOSE) for one in starts]
        best = min(tries, key=lambda candidate: candidate.cost)
        model = best.point.model
        if all(k > GONE * model.k_0 for k in model.k):
            found.append(best)
        if found and best.bic > min(candidate.bic for candidate in found) + WORSE:
            break
    return found


def _again(
    problem: Problem, start: Parameters, numbers: Sequence[int], before: Fit | None
) -> Candidate:
    """The best of a problem with no more arms than a start has, from there."""
    fewer = [number for number in numbers if number < problem.arms]
    found = _candidates(problem, [*fewer, problem.arms], before, start=start)
    # where an arm has left every candidate, as it is
    return _chosen(found) if found else descend(problem, problem.pack(start), tolerance=LOOSE)


def _chosen(found: Sequence[Candidate]) -> Candidate:
    """Choose the arms by both rules, with and without a dashpot; then the better of the two."""
    scale = min(found, key=lambda candidate: candidate.bic).line_scale
    best = []
    for dashpot in (False, True):
        family = {one.problem.arms: one for one in found if one.problem.dashpot == dashpot}
        if family:
            sure = [one.scaled(scale).significant for one in family.values()]
            bics = [one.bic for one in family.values()]
            best.append(family[choose([*family], bics, sure, decisive=DECISIVE).arms])
    return min(best, key=lambda candidate: candidate.bic)


def _dashpot_missed(best: Candidate, before: Fit | None) -> Check:
    """Whether a parallel dashpot, beside the arms or in place of one, lowers the criterion."""
    if best.problem.dashpot:
        return dashpot_not_missed(None, best.problem.arms, best.point.model.b)
    least = 0 if before is None else before.model.arms
    tries = []
    for arms in range(max(best.problem.arms - 1, least), best.problem.arms + 1):
        problem = replace(best.problem, dashpot=True, arms=arms)
        tries += [
            descend(problem, problem.pack(start), tolerance=LOOSE)
            for start in _spread(problem, before)
        ]
    other = min(tries, key=lambda candidate: candidate.bic)
    sure = best.scaled(best.line_scale).significant
    fall = best.bic - other.bic
    return dashpot_not_missed(fall, other.problem.arms, other.point.model.b, sure=sure)


def _linear(problem: Problem, most: int) -> list[Parameters]:
    """Starts from the engine: dynamic stiffness is linear in the stiffnesses of the solid."""
    known = None if problem.priors.mass is None else problem.priors.mass.value
    blocks = [relaxation.weighted(i) for i, relaxation in enumerate(problem.relaxations)]
    felt = replace(problem.frf_data, seals=problem.frf_data.seals * problem.priors.factor.value)
    blocks.append(felt.stiffness_block(known, dashpot=problem.dashpot))
    starts = []
    for solution in solve_orders(blocks, most):
        k = solution.arms[0]
        model = GeneralizedMaxwell(
            max(solution.coefficient("k_inf"), 0.0),
            tuple(np.maximum(k, GONE * k.max(initial=0.0))),
            tuple(solution.tau),
            max(solution.coefficient("b"), 0.0) if problem.dashpot else 0.0,
        )
        mass = known if known is not None else solution.coefficient("mass@frf")
        if mass > 0:
            starts.append(_start(problem, model, mass))
    return starts


def _spread(problem: Problem, before: Fit | None) -> list[Parameters]:
    """Starts from the earlier fit, or from nothing, with arms spread over the lines."""
    omega = 2 * np.pi * problem.frf_data.peak_hz
    prior = problem.priors.mass
    mass = 1.0 if prior is None else prior.value
    # at the peak the mass holds the storage stiffness in balance
    level = mass * omega**2 / (problem.frf_data.seals * problem.priors.factor.value)
    base, part = GeneralizedMaxwell(level * 0.8), 0.2
    if before is not None:
        level = level if prior is None else before.model.k_0
        base, part = before.model, 0.1
    new = problem.arms - base.arms
    if new < 0:
        return []
    starts = []
    for reach in (1.0, 6.0) if new > 1 else (1.0,):
        tau = (
            np.geomspace(1 / (reach * omega), reach / omega, new) if new > 1 else [1 / omega] * new
        )
        model = base + GeneralizedMaxwell(0.0, (part * level / max(new, 1),) * new, tuple(tau))
        if model.arms == problem.arms:
            starts.append(_start(problem, model, mass))
    return starts


def _start(problem: Problem, model: GeneralizedMaxwell, mass: float) -> Parameters:
    if problem.dashpot and model.b <= 0:
        # two percent of the stiffness at the peak
        model = replace(model, b=0.02 * model.k_0 / (2 * np.pi * problem.frf_data.peak_hz))
    return Parameters(model, mass, 1.0, 0.0, problem.priors.factor.value)


# -- what was given ---------------------------------------------------------------------------


def _relaxations(
    records: Sequence[RampHold], fit: Fit | None, temperature: float | None
) -> tuple[Fit | None, tuple[RelaxationData, ...]]:
    """The earlier fit, at the temperature of the hammer, and the tests that it was of."""
    if not records:
        if fit is not None and fit.family != "maxwell":
            raise FitError(
                "the earlier fit is of a fractional solid, and what the hammer adds is an arm: "
                "give its relaxation tests with it, or a fit of family maxwell"
            )
        return fit if fit is None or temperature is None else fit.at_temperature(temperature), ()
    # arms are matched to arms: of a fractional solid, those of the same tests
    before = fit if fit is not None and fit.family == "maxwell" else fit_tests(list(records))
    if temperature is not None:
        before = before.at_temperature(temperature)
    same = len(records) == 1 and before.method in {"full", "hold"}
    alone = [before] if same else [fit_tests(record) for record in records]
    return before, tuple(
        relaxation_data(record, before, alone=own)
        for record, own in zip(records, alone, strict=True)
    )


def _point(
    before: Fit | None, mass: float | None, seals: float, compression: float | None
) -> OperatingPoint | None:
    """Where the seals are under the hammer; None if that makes no difference, or nothing tells."""
    law = None if before is None else before.elastic_law
    if before is None or law is None or law.kind == "linear":
        return None
    if mass is None and compression is None:
        raise DataError(
            "the stiffness of the seals depends on their compression: give --mass, or --compression"
        )
    return operating_point(before, mass=mass or 1.0, seals=seals, compression=compression)


def _numbers(arms: int | str, before: Fit | None) -> list[int]:
    least = 0 if before is None else before.model.arms
    if arms == "auto":
        return list(range(least, least + MOST_ARMS + 1))
    if not isinstance(arms, int | np.integer) or arms < 0:
        raise FitError(f'arms = {arms!r}; expected a number >= 0 or "auto"')
    if arms < least:
        raise FitError(
            f"arms = {arms}, but the relaxation test alone has {least}: ask for at least as many, "
            "one more for what only the hammer sees"
        )
    return [int(arms)]


def _seals(seals: float) -> float:
    if not (np.isfinite(seals) and seals > 0):
        raise DataError(f"seals = {seals!r}; expected a number > 0")
    return seals


def _mass(mass: float | None, sd: float | None) -> Prior | None:
    if mass is None:
        return None
    if not (np.isfinite(mass) and mass > 0):
        raise DataError(f"mass = {mass!r} kg; expected a number > 0")
    if sd is not None and sd >= mass:
        raise DataError(
            f"mass_sd = {sd:g} kg of a mass of {mass:g} kg; expected less: check its unit"
        )
    return Prior(mass, _sd("mass_sd", USUAL_MASS_SD * mass if sd is None else sd))


def _sd(name: str, value: float) -> float:
    if not (np.isfinite(value) and value >= 0):
        raise DataError(f"{name} = {value!r}; expected a standard deviation >= 0")
    return float(value)


def _known(name: str, given: Given, dimension: Dimension) -> Prior | None:
    if given is None:
        return None
    value, sd = si_range(given if isinstance(given, tuple) else (given, 0.0), dimension)
    if not (np.isfinite(value) and value > 0):
        raise DataError(f"{name} = {value!r}; expected a number > 0")
    if name == "damping_ratio" and value >= 1:
        raise DataError(
            f"damping_ratio = {value:g}; expected a part of the critical damping, < 1: if it is "
            f"in per cent, give {value / 100:g}"
        )
    return Prior(float(value), _sd(name, sd))
