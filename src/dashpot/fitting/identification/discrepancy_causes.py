r"""Causes of a discrepancy between hammer and relaxation tests, each freed in turn.

Where the joint fit has to push the mass, the gain or the lines beyond what is known of them, it is
made again with one quantity free at a time:

* the stiffness of the seals under the hammer, :math:`\lambda K(s)`: another compression,
  temperature or length;
* their :math:`k_\infty` alone: another preload of a seal whose arms stay as they are;
* the mass;
* the gain of acceleration over force;
* a high-pass of the accelerometer that the channel of the hammer does not have;

and where none of these alone explains both tests, mass or gain together with a stiffness: held
exactly, the one takes what belongs to the other. The solid is then that of the best cause that
explains both, and its value alone is reported: others that explain as much are named.

The lines count alike in all of them, by the scatter that the best one leaves. A cause is ranked by
:math:`\chi^2 + p \ln n`; it explains both tests if nothing else is then beyond what is known.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check
from dashpot.base.number_format import with_error
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.fit_diagnostics import Explanation
from dashpot.fitting.identification import checks
from dashpot.fitting.identification.likelihood import (
    LINEAR_UNITS,
    UNCHANGED,
    Candidate,
    IdentificationProblem,
    NuisancePriors,
    Parameters,
    descend,
)
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.numerics.inference.model_order import DECISIVE_BIC
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import Solid

#: relative error of the explained deviance, from the imperfect model
MODEL_ERROR_SHARE = 0.02
TOLERANCE = 1e-11
# standard errors beyond which a stiffness is said to be another
_MAX_STANDARD_ERRORS = 2.0
# stiffnesses within this part of a whole multiple look like another number of seals
_COUNT_TOLERANCE = 0.1


class DiscrepancyCause(NamedTuple):
    """Quantity that may differ between two tests.

    Attributes
    ----------
    name : str
    phrase : str
        As a sentence names it where its value is not stated.
    quantity : str
        What it is called among the priors, at a point, and in the vector, a logarithm there.
    unit : str
    paired_stiffness : str
        The stiffness that is free with it; empty of one that is free alone.
    """

    name: str
    phrase: str
    quantity: str
    unit: str = "1"
    paired_stiffness: str = ""


CAUSES = (
    DiscrepancyCause("stiffness", "another stiffness of the seals", "factor"),
    DiscrepancyCause("k_inf", "another stiffness of the seals at rest", "spring"),
    DiscrepancyCause("mass", "another mass", "mass", "kg"),
    DiscrepancyCause("gain", "another gain of the channels", "gain"),
    DiscrepancyCause("high-pass", "a high-pass of one channel", "high_pass", "Hz"),
)
PAIRS = (
    DiscrepancyCause(
        "mass and stiffness", "another mass and stiffness of the seals", "mass", "kg", "factor"
    ),
    DiscrepancyCause(
        "gain and stiffness", "another gain and stiffness of the seals", "gain", "1", "factor"
    ),
    DiscrepancyCause(
        "mass and k_inf", "another mass and stiffness at rest", "mass", "kg", "spring"
    ),
)


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """Discrepancy of two tests that no seal explains under the priors of the rig.

    Attributes
    ----------
    explanations : tuple of Explanation
        The best first.
    candidate : Candidate
        The optimum of the best where it explains both tests; else that under what is known.
    other : Solid
        What the same arms, or the element, are without it, or else with it.
    priors : NuisancePriors
        What is known of the rig.
    """

    explanations: tuple[Explanation, ...]
    candidate: Candidate
    other: Solid
    priors: NuisancePriors


def explain_discrepancy(
    best_candidate: Candidate,
    refit: Callable[[IdentificationProblem], Candidate],
    *,
    law: ElasticLaw | None = None,
    compression: float | None = None,
) -> Discrepancy | None:
    """Find the cause that explains the difference of both tests; None if they agree.

    Parameters
    ----------
    best_candidate : Candidate
        The joint optimum under what is known of the rig.
    refit : callable
        The best candidate, over numbers of arms, of a problem.
    law : ElasticLaw, optional
        Elastic law of the relaxation test: a stiffness it has somewhere is that of another
        compression.
    compression : float, optional
        Where the seals under the hammer were supposed to be, m.
    """
    problem = best_candidate.problem
    if problem.is_hammer_alone or not is_contradicted(best_candidate):
        return None
    refit_candidate, threshold, ranked = _rank_causes(best_candidate, refit)
    explanations = [
        _build_explanation(cause, candidate, refit_candidate, law, compression, is_leading=not rank)
        for rank, (cause, candidate) in enumerate(ranked)
    ]
    if not explanations[0].is_sufficient and _find_failed_checks(best_candidate) == {
        "lines_explained"
    }:
        # lines that no cause explains contradict no other test: the FRF holds something else
        return None
    rivals = [
        explanation.message
        for explanation, (_, candidate) in zip(explanations[1:], ranked[1:], strict=True)
        if explanation.is_sufficient and candidate.criterion <= threshold
    ]
    if not explanations[0].is_sufficient:
        return Discrepancy(
            tuple(explanations),
            best_candidate,
            refit_with_free_cause(refit_candidate, explanations[0].name).point.model,
            problem.priors,
        )
    if rivals:
        message = f"{explanations[0].message}. It is as well explained by {', or by '.join(rivals)}"
        explanations[0] = replace(explanations[0], message=message)
    leading_cause = ranked[0][1]
    fixed_problem = replace(leading_cause.problem, priors=problem.priors)
    return Discrepancy(
        tuple(explanations),
        leading_cause,
        _solve_from(fixed_problem, leading_cause).point.model,
        problem.priors,
    )


def _rank_causes(
    best_candidate: Candidate, refit: Callable[[IdentificationProblem], Candidate]
) -> tuple[Candidate, float, list[tuple[DiscrepancyCause, Candidate]]]:
    """Return the plain optimum, up to which criterion two causes are alike, and the causes by rank.

    All are by the line scale of the closest; two causes at once are tried where none alone does.
    """
    problem = best_candidate.problem
    free_causes: list[DiscrepancyCause] = []
    candidates: list[Candidate] = []
    for causes in (CAUSES, PAIRS):
        if all(map(is_contradicted, candidates)):
            new_candidates = [
                cause
                for cause in causes
                if problem.priors.priors_by_name[cause.quantity] is not None
            ]
            free_causes += new_candidates
            candidates += [refit(_free_quantity(problem, cause)) for cause in new_candidates]
    scale = min(candidate.line_scale for candidate in candidates)
    candidates = [_refit_at_scale(candidate, scale) for candidate in candidates]
    refit_candidate = _refit_at_scale(best_candidate, scale)
    lowest_criterion = min(candidate.criterion for candidate in candidates)
    # an arm that the model lacks also distinguishes causes: only a decisive lead counts
    threshold = lowest_criterion + max(
        DECISIVE_BIC, MODEL_ERROR_SHARE * (refit_candidate.criterion - lowest_criterion)
    )
    by = sorted(
        zip(free_causes, candidates, strict=True),
        key=lambda pair: (is_contradicted(pair[1]), max(pair[1].criterion, threshold)),
    )
    return refit_candidate, threshold, by


def refit_with_free_cause(candidate: Candidate, name: str) -> Candidate:
    """The optimum of the same arms, or of the element, where the cause of that name is free."""
    cause = next(cause for cause in (*CAUSES, *PAIRS) if cause.name == name)
    return _solve_from(_free_quantity(candidate.problem, cause), candidate)


def _solve_from(problem: IdentificationProblem, candidate: Candidate) -> Candidate:
    """Return the optimum of a problem from that of another."""
    return descend(problem, problem.pack(candidate.point), tolerance=TOLERANCE)


def is_contradicted(candidate: Candidate) -> bool:
    """Return True if lines, a relaxation test, mass, gain or stiffness are beyond belief."""
    return bool(_find_failed_checks(candidate))


def _find_failed_checks(candidate: Candidate) -> set[str]:
    return {check.name for check in agreement(candidate) if check.failed}


def agreement(candidate: Candidate, priors: NuisancePriors | None = None) -> list[Check]:
    """Return the checks of whether one seal explains all tests, given the priors of the rig.

    `priors` is that, where the candidate was found with a cause free.
    """
    problem, frf_data = candidate.problem, candidate.problem.frf_data
    all_checks = [
        checks.lines_explained(
            candidate.line_scale,
            has_absolute_sd=frf_data.has_absolute_sd,
            coherent=frf_data.lines.coherence is not None,
        )
    ]
    all_checks += [
        checks.hammer_agrees_with_relaxation_test(
            i, chi2 / relaxation.samples, residual_ratio=_compute_excess_force(relaxation, chi2)
        )
        for i, (relaxation, chi2) in enumerate(
            zip(problem.relaxations, candidate.relaxation_chi2, strict=True), 1
        )
    ]
    earlier_residuals = candidate.model_prediction.earlier[0]
    if len(earlier_residuals):
        rms_deviation = float(np.sqrt(np.mean(earlier_residuals**2)))
        all_checks.append(checks.hammer_agrees_with_earlier_fit(rms_deviation))
    return all_checks + _check_rig_nuisances(candidate.point, priors or problem.priors)


def _compute_excess_force(relaxation: RelaxationData, chi2: float) -> float:
    """Return the rms force that a joint fit adds to a test's residual, over the largest force."""
    excess_chi2 = max(chi2 - relaxation.samples, 0.0) / relaxation.block.samples
    peak = float(np.abs(relaxation.block.exact.target).max())
    return float(np.sqrt(excess_chi2)) / (relaxation.weight * peak) if peak > 0 else np.inf


def _check_rig_nuisances(point: Parameters, priors: NuisancePriors) -> list[Check]:
    """Return the deviation of each nuisance parameter from its prior."""
    mass = priors.mass
    pairs = [
        (checks.gain_plausible, float(np.log(point.gain)), priors.gain.sd),
        (checks.delay_plausible, point.delay, priors.delay.sd),
        (checks.stiffness_plausible, point.factor - priors.factor.mean, priors.factor.sd),
    ]
    if mass is not None:
        pairs.insert(0, (checks.mass_plausible, point.mass - mass.mean, mass.sd))
    return [judge(deviation, sd) for judge, deviation, sd in pairs if 0 < sd < np.inf]


def _free_quantity(
    problem: IdentificationProblem, cause: DiscrepancyCause
) -> IdentificationProblem:
    free_quantities = {
        name: (problem.priors.priors_by_name[name] or UNCHANGED)._replace(sd=np.inf)
        for name in (cause.quantity, cause.paired_stiffness)
        if name
    }
    return replace(problem, priors=replace(problem.priors, **free_quantities))


def _refit_at_scale(candidate: Candidate, scale: float) -> Candidate:
    """Return the same optimum, its lines weighted alike."""
    return descend(replace(candidate.problem, scale=scale), candidate.theta, tolerance=TOLERANCE)


def _build_explanation(
    cause: DiscrepancyCause,
    candidate: Candidate,
    original: Candidate,
    law: ElasticLaw | None,
    compression: float | None,
    *,
    is_leading: bool,
) -> Explanation:
    explains = not is_contradicted(candidate)
    value, error = _read_free_quantity(candidate, cause.quantity)
    supposed = float(getattr(original.problem.priors, cause.quantity).mean)
    message = cause.phrase
    if explains and is_leading:
        message = _SENTENCES[cause.quantity](value, error)
        message += (
            f", not {format_quantity(supposed, 'g', '.5g')}" if cause.quantity == "mass" else ""
        )
        message += _format_added_stiffness(candidate) + _format_compensating_quantity(
            cause, candidate
        )
        message += _format_other_compression(cause, value, law, compression)
    return Explanation(
        name=cause.name,
        value=value,
        standard_error=error,
        unit=cause.unit,
        relative_deviation=(value - supposed) / (supposed or original.problem.frf_data.peak_hz),
        deviance_fall=original.cost - candidate.cost,
        is_sufficient=explains,
        message=message,
    )


def _read_free_quantity(candidate: Candidate, quantity: str) -> tuple[float, float]:
    """Return what a free quantity came to, and its standard error."""
    parameter_index = candidate.problem.index[quantity]
    value = float(getattr(candidate.point, quantity))
    error = float(np.sqrt(candidate.covariance[parameter_index, parameter_index]))
    return value, error * LINEAR_UNITS.get(quantity, value)


def _format_added_stiffness(candidate: Candidate) -> str:
    """Return what cables beside stiffer seals, or a table under softer ones, would have to be.

    An arm that is too fast for the relaxation test takes part of either.
    """
    data, point = candidate.problem.frf_data, candidate.point
    at_peak, measured = (
        complex((data.seals * solid).stiffness_at(2j * np.pi * data.peak_hz)).real
        for solid in (point.model, point.seal_under_hammer)
    )
    if measured == at_peak:
        return ""
    if measured > at_peak:
        added = format_quantity(measured - at_peak, "N/mm", ".2g")
        return f", or cables beside them add at least {added}"
    series = at_peak * measured / (at_peak - measured)
    return f", or the table under them has at most {format_quantity(series, 'N/mm', '.2g')}"


def _format_compensating_quantity(cause: DiscrepancyCause, candidate: Candidate) -> str:
    """Return the stiffness that goes with a mass or a gain, where it is another one at all."""
    if not cause.paired_stiffness:
        return ""
    value, error = _read_free_quantity(candidate, cause.paired_stiffness)
    if abs(value - 1) < _MAX_STANDARD_ERRORS * error:
        return ""
    return f". Then {_SENTENCES[cause.paired_stiffness](value, error)}"


def _format_stiffness_change(value: float, error: float) -> str:
    comparative = "stiffer" if value > 1 else "softer"
    return f"{with_error(100 * abs(value - 1), 100 * error)} % {comparative}"


def format_seal_count_hint(value: float) -> str:
    """Return a hint if the stiffness would fit another number of seals."""
    times = max(value, 1 / value)
    if round(times) < 2 or abs(times / round(times) - 1) > _COUNT_TOLERANCE:
        return ""
    remedy = f"{round(times)} times as many seals" if value > 1 else f"one seal in {round(times)}"
    return f". So would be {remedy}"


_SENTENCES: dict[str, Callable[[float, float], str]] = {
    "factor": lambda value, error: (
        f"the seals are {_format_stiffness_change(value, error)} under the hammer"
        f"{format_seal_count_hint(value)}"
    ),
    "spring": lambda value, error: (
        f"k_inf alone is {_format_stiffness_change(value, error)} under the hammer"
    ),
    "mass": lambda value, error: (
        f"the mass is {with_error(convert_to_unit(value, 'g'), convert_to_unit(error, 'g'))} g"
    ),
    "gain": lambda value, error: (
        f"acceleration over force reads {with_error(value, error)} times what it is"
    ),
    "high_pass": lambda value, error: (
        f"the {'accelerometer' if value > 0 else 'hammer'} alone has a high-pass of "
        f"{with_error(abs(value), error)} Hz"
    ),
}


def _format_other_compression(
    cause: DiscrepancyCause, value: float, law: ElasticLaw | None, compression: float | None
) -> str:
    """Return the compression at which the law has this stiffness, in words."""
    if cause.name != "stiffness" or law is None or law.kind == "linear":
        return ""
    shape = np.asarray(law.ratio)
    if not shape.min() <= value <= shape.max():
        return ". Their elastic law gives this at no compression tested"
    x = np.linspace(0.0, law.depth, 2001)
    at = float(x[np.argmin(np.abs(law.factor(x) - value))])
    supposed = "" if compression is None else f", not {format_quantity(compression, 'mm', '.3g')}"
    return f". Their elastic law gives this at {format_quantity(at, 'mm', '.3g')}{supposed}"
