"""From data to a fit: every number of arms tried, one chosen, judged and assembled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, status_of
from dashpot.base.errors import FitError
from dashpot.base.status import Status
from dashpot.engine.blocks.block import Block
from dashpot.engine.inference.covariance import Noise, nearly_white, noise_gain_differs
from dashpot.engine.inference.order import DECISIVE, Choice, choose
from dashpot.engine.solver.certificate import certificate
from dashpot.engine.solver.variable_projection import (
    Jacobian,
    Solution,
    full_jacobian,
)
from dashpot.fitting.checks.solid import optimum_found
from dashpot.fitting.design import solid_of
from dashpot.fitting.fit_data import First, FitData, determinable_arms, weighed
from dashpot.fitting.uncertainty.estimate import (
    Estimate,
    Score,
    by_record,
    estimated,
    scored,
)
from dashpot.fitting.uncertainty.profile_intervals import profiles
from dashpot.records.alternative import Alternative
from dashpot.records.bounds import EndOfHold
from dashpot.records.estimate import (
    CreepEstimate,
    Nuisance,
    ParameterEstimate,
    Profile,
    Residual,
    parameter_names,
)
from dashpot.records.fit import (
    Certificate,
    Evidence,
    Fit,
    OrderScore,
    Provenance,
)
from dashpot.records.temperature import TemperatureShifts
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# a step that would remove less of the residual than this is rounding, whatever it does to tau
_STATIONARY = 1e-6
_NUISANCE_UNITS = {"offset": "N", "drift": "N/s", "delay": "s"}
_MISFIT = 0.5


@dataclass(frozen=True, eq=False)
class Chosen:
    """The optimum for the number of arms taken, its uncertainty, and every number tried.

    Attributes
    ----------
    data : FitData
    estimate : Estimate
        Of the number of arms taken.
    scores : tuple of Score
        Every number tried, from none up.
    choice : Choice or None
        How the rules chose; None if the number was asked for.
    asked : int or None
        The number asked for; None if the rules chose.
    """

    data: FitData
    estimate: Estimate
    scores: tuple[Score, ...]
    choice: Choice | None
    asked: int | None

    @property
    def solution(self) -> Solution:
        """The optimum."""
        return self.estimate.solution

    @cached_property
    def model(self) -> GeneralizedMaxwell:
        """The arms of the optimum."""
        return solid_of(self.solution)

    @property
    def solid(self) -> Solid:
        """The solid of the optimum."""
        return self.model

    @cached_property
    def _rows(self) -> dict[str, int]:
        """The model's parameters and their rows in the covariance."""
        return self.rows_named(
            "k_inf", "k", "ln_tau", "b" if "b" in self.solution.fixed_names else None
        )

    def rows_named(self, spring: str, arm: str, time: str, dashpot: str | None) -> dict[str, int]:
        """Rows of the covariance: spring, every arm that is there by its two names, and dashpot."""
        there = np.flatnonzero(self.solution.arms.ravel() > 0) + 1
        named = {spring: spring}
        named |= {f"{arm}_{j}": f"k_{row}" for j, row in enumerate(there, start=1)}
        named |= {f"{time}_{j}": f"ln_tau_{row}" for j, row in enumerate(there, start=1)}
        named |= {} if dashpot is None else {dashpot: dashpot}
        return {name: self.estimate.names.index(row) for name, row in named.items()}

    @cached_property
    def covariance(self) -> FloatArray:
        """Of the model's parameters: k_inf, every k, every ln tau, and b."""
        rows = list(self._rows.values())
        return self.estimate.covariance[np.ix_(rows, rows)]

    @cached_property
    def error(self) -> FloatArray:
        """Standard errors of the model's parameters."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the model's parameters."""
        return tuple(self._rows)

    @property
    def stiffnesses(self) -> dict[str, float]:
        """Those that an error of the depth scales, by their rows."""
        solution = self.solution
        arms = {f"k_{j}": k for j, k in enumerate(solution.arms.ravel().tolist(), start=1)}
        return {"k_inf": solution.coefficient("k_inf"), **arms}

    def with_depth_doubt(self, doubts: Sequence[float]) -> Chosen:
        """As found, with what the encoder's step leaves unknown of each depth."""
        return replace(self, estimate=self.estimate.with_depth_doubt(doubts, self.stiffnesses))

    @property
    def orders(self) -> tuple[OrderScore, ...]:
        """Every number of arms tried, as a fit holds it."""
        return tuple(
            OrderScore(
                score.solution.order, score.solution.sse, score.bic, score.significant,
                solid_of(score.solution),
            )
            for score in self.scores
        )  # fmt: skip

    def profiles(self, *, in_order_of_time: bool) -> tuple[Profile, ...]:
        """Profile likelihoods of the model's parameters; noise in order of time may be slow."""
        return profiles(
            self.data.rows,
            self.estimate,
            every_sample=self.data.samples if in_order_of_time else None,
        )


def asked_arms(arms: object, max_arms: object) -> int:
    """Return the most arms to try.

    Raises
    ------
    FitError
        If `arms` is neither ``"auto"`` nor a whole number >= 0.
    """
    if arms == "auto":
        if not _whole(max_arms):
            raise FitError(f"max_arms = {max_arms!r}; expected a whole number >= 0")
        return int(max_arms)  # type: ignore[call-overload,no-any-return]
    if not _whole(arms):
        raise FitError(
            f'arms = {arms!r}; expected "auto" or a whole number of arms, 0 for a spring alone'
        )
    return int(arms)  # type: ignore[call-overload,no-any-return]


def chosen_arms(
    data: FitData,
    arms: int | Literal["auto"],
    *,
    max_arms: int = 6,
    thorough: bool = False,
    first: First | None = None,
) -> Chosen:
    """Fit every number of arms; take the number that the data support, or that was asked for.

    Parameters
    ----------
    data : FitData
    arms : int or "auto"
        ``"auto"`` chooses by BIC and significance; of a number the data may bear fewer.
    max_arms : int
        The most that ``"auto"`` tries.
    thorough : bool
        Add quasi-random starts.
    first : First, optional
        What :func:`weighed` found, where it is known already.
    """
    auto, most = arms == "auto", asked_arms(arms, max_arms)
    if auto:
        most = min(most, determinable_arms(data.blocks))
    first = first or weighed(data, most, auto=auto, thorough=thorough)
    data, noises = first.data, first.noises
    samples, peak, in_time = data.samples, data.peak, data.in_time
    scores = _scored(first.solutions[: most + 1], data, noises)
    exhausted = len(scores) - 1 < most or not in_time
    choice = _choice(scores, exhausted=exhausted, decisive=DECISIVE if in_time else np.inf)

    @lru_cache(maxsize=1)  # the order that the rules support is, as a rule, the one chosen
    def whole(order: int) -> Jacobian:
        return full_jacobian([*samples, *data.priors], scores[order].solution)

    # least squares is a fair judge where the noise is even to the arms that a rule supports
    supported = min(max(choice.by_bic, choice.by_significance, 1), len(scores) - 1)
    if (
        auto
        and in_time
        and not nearly_white(noises)
        and noise_gain_differs(by_record(whole(supported), data.every)[1][: len(noises)], noises)
    ):
        from dashpot.fitting.order_selection import in_noise_metric

        largest = whole(len(scores) - 1)
        anew = in_noise_metric(
            scores, samples, largest, peak=peak, thorough=thorough, priors=data.priors
        )
        if anew is not None:
            scores = anew
            choice = _choice(scores, exhausted=exhausted, decisive=DECISIVE, in_noise_metric=True)
    taken = choice.arms if auto else min(most, len(scores) - 1)
    estimate = estimated(
        scores[taken].solution,
        samples,
        peak=peak,
        priors=data.priors,
        encoders=data.encoders,
        whole=whole(taken),
        left=first.left_by(scores[taken].solution),
    )
    return Chosen(data, estimate, scores, choice if auto else None, None if auto else most)


def assembled(
    found: Chosen,
    *,
    band: tuple[float, float],
    checks: Sequence[Check],
    provenance: Provenance,
    noticed: Sequence[Check] = (),
    tests: int = 0,
    unit: str = "N/m",
    elastic_law: ElasticLaw | None = None,
    temperatures: TemperatureShifts | None = None,
    end_of_hold: EndOfHold | None = None,
    creep: CreepEstimate | None = None,
    alternative: Alternative | None = None,
    delays: Sequence[float] = (),
) -> Fit:
    """Return the fit that a chosen number of arms makes.

    Parameters
    ----------
    found : Chosen
    band : (float, float)
        The frequencies that the data inform, Hz.
    checks, noticed : sequences of Check
        Of the fit, which decide its status, and of the preparation, which stand before them.
    provenance : Provenance
    tests : int
        How many relaxation tests have a tare and a drift of their own.
    unit : str
    elastic_law : ElasticLaw or None
    temperatures : TemperatureShifts or None
    end_of_hold : EndOfHold or None
    creep : CreepEstimate or None
    alternative : Alternative or None
    delays : sequence of float
        What was known of the delay of each test: its standard deviation, s.
    """
    data, estimate = found.data, found.estimate
    checks = (optimum_found(stationary=_stationary(found.solution)), *checks)
    best = certified(data.rows, found.solution)
    return Fit(
        solid=found.solid,
        status=_status(found.solution, found.asked, checks),
        estimate=ParameterEstimate(
            parameters=found.parameters,
            covariance=found.covariance,
            dof=estimate.dof,
            residual=_residual(estimate),
            # where another spectrum leaves half as much, what is left is no noise
            profiles=found.profiles(in_order_of_time=data.in_time and best.gap < _MISFIT),
            nuisance=_nuisance(estimate, tests=tests, delays=delays),
        ),
        evidence=Evidence(
            band=band,
            orders=found.orders,
            certificate=best,
            checks=(*noticed, *checks),
            end_of_hold=end_of_hold,
            creep=creep,
            alternative=alternative,
        ),
        provenance=provenance,
        unit=unit,
        elastic_law=elastic_law,
        temperatures=temperatures,
    )


def point_estimate(
    solution: Solution,
    asked: int,
    *,
    checks: Sequence[Check],
    provenance: Provenance,
    depth: float,
    tests: int,
) -> Fit:
    """Return an optimum as a fit, without errors and evidence."""
    model = solid_of(solution)
    names = parameter_names(model.arms)
    nuisance = tuple(
        Nuisance(_nuisance_name(name, tests), solution.coefficient(name), np.inf, unit)
        for name, unit in _nuisances(solution)
    )
    rms = float(np.sqrt(solution.sse / solution.samples))
    return Fit(
        solid=model,
        status=_status(solution, asked, checks),
        estimate=ParameterEstimate(
            parameters=names,
            covariance=np.diag(np.full(len(names), np.inf)),
            dof=0.0,
            residual=Residual(solution.samples, solution.sse, rms),
            nuisance=nuisance,
        ),
        evidence=Evidence((0.0, 0.0), checks=tuple(checks)),
        provenance=provenance,
        elastic_law=ElasticLaw.linear(model.k_inf, depth),
    )


# -- orders ---------------------------------------------------------------------------------------


def _scored(
    solutions: Sequence[Solution], data: FitData, noises: Sequence[Noise]
) -> tuple[Score, ...]:
    """Judge each number of arms by the residuals of the largest."""
    effective = sum(noise.effective for noise in noises)
    return tuple(
        scored(
            solution,
            data.blocks,
            data.samples,
            effective=effective,
            peak=data.peak,
            priors=data.priors,
        )
        for solution in solutions
    )


def _choice(
    scores: Sequence[Score], *, exhausted: bool, decisive: float, in_noise_metric: bool = False
) -> Choice:
    return choose(
        range(len(scores)),
        [score.bic for score in scores],
        [score.significant for score in scores],
        exhausted=exhausted,
        in_noise_metric=in_noise_metric,
        decisive=decisive,
    )


def _whole(number: object) -> bool:
    whole = isinstance(number, int | np.integer) and not isinstance(number, bool)
    return whole and number >= 0  # type: ignore[operator]


# -- parts of a fit -------------------------------------------------------------------------------


def _stationary(solution: Solution) -> bool:
    """True if no step from here would change more than rounding, or a bound holds the point."""
    near = solution.converged or solution.relative_offset < _STATIONARY
    return bool(near or solution.at_bound.any())


def _status(solution: Solution, asked: int | None, checks: Sequence[Check]) -> Status:
    fewer = asked is not None and solution.order < asked
    return status_of(
        checks,
        {Status.FEWER_ARMS: fewer, Status.TAU_AT_BOUND: bool(solution.at_bound.any())},
    )


def _residual(estimate: Estimate) -> Residual:
    """Return the statistics of the weighted residuals."""
    weights = [float(residual @ residual) for residual in estimate.residuals]
    watson = [noise.durbin_watson for noise in estimate.noises]
    return Residual(
        n=estimate.samples,
        sse=estimate.sse,
        rms=float(np.sqrt(estimate.sse / estimate.samples)),
        kappa=estimate.kappa,
        durbin_watson=float(np.average(watson, weights=weights)) if sum(weights) > 0 else 2.0,
    )


def measured_in(found: Fit, unit: str, error: FloatArray | None = None) -> Fit:
    """Return a fit whose residual says its unit, and is that of these errors if any are given."""
    residual = replace(found.residual, unit=unit)
    if error is not None:
        rms = float(np.sqrt(np.mean(error**2)))
        residual = replace(residual, n=len(error), sse=float(error @ error), rms=rms)
    return replace(found, estimate=replace(found.estimate, residual=residual))


def _nuisances(solution: Solution) -> list[tuple[str, str]]:
    """Offset, drift and delay of each relaxation test, and their units."""
    found = ((name, _NUISANCE_UNITS.get(name.partition("@")[0])) for name in solution.fixed_names)
    return [(name, unit) for name, unit in found if unit is not None]


def _nuisance_name(name: str, tests: int) -> str:
    kind, _, test = name.partition("@")
    return f"{kind} of test {int(test) + 1}" if tests > 1 else kind


def _nuisance(estimate: Estimate, *, tests: int, delays: Sequence[float]) -> tuple[Nuisance, ...]:
    """Return offset, drift and delay of each relaxation test."""
    known = {f"delay@{i}": sd for i, sd in enumerate(delays)}
    return tuple(
        Nuisance(
            name=_nuisance_name(name, tests),
            value=estimate.solution.coefficient(name),
            standard_error=estimate.standard_error(name),
            unit=unit,
            prior_sd=known.get(name),
        )
        for name, unit in _nuisances(estimate.solution)
    )


def certified(blocks: Sequence[Block], solution: Solution) -> Certificate:
    """Return how far the optimum can be from the best positive spectrum."""
    found = certificate(blocks, solution)
    if found.optimal:
        says = "no positive spectrum, with any number of arms, fits better"
    else:
        says = (
            f"the best positive spectrum with any number of arms would lower the sum of squares "
            f"by {100 * found.gap:.2g} %"
        )
    return Certificate(found.optimal, found.gap, found.tau, says)
