"""Selection of the number of arms, with the uncertainty of the chosen model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.datamodel.fit_diagnostics import Certificate, OrderScore
from dashpot.datamodel.parameter_estimate import Nuisance, ParameterEstimate, Profile, Residual
from dashpot.fitting.checks.solid import (
    MIN_CORRELATED_KAPPA,
    arms_enough,
    optimiser_converged,
    samples_independent,
)
from dashpot.fitting.data_blocks import (
    FitData,
    InitialFit,
    build_solid,
    fit_all_orders,
    max_determinable_arms,
)
from dashpot.fitting.fit_construction import SolidEstimate, list_nuisances
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.parameter_errors import (
    Score,
    SolutionEstimate,
    compute_profiles,
    estimate_covariance,
    estimate_noises,
    rounding_rms,
    score_solution,
    split_by_record,
)
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit import (
    Jacobian,
    Solution,
    certificate,
    compute_full_jacobian,
    solve_orders,
)
from dashpot.numerics.inference.correlated_noise import (
    Noise,
    make_directions,
    nearly_white,
    noise_gain_differs,
    noise_gain_ratio,
    whitened_block,
)
from dashpot.numerics.inference.model_order import (
    DECISIVE_BIC,
    ArmShortage,
    OrderChoice,
    bic_of_deviance,
    is_significant_fall,
    select_model_order,
)
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# Rules for the number of arms under noise as slow as the arms.


def score_in_noise_metric(
    scores: Sequence[Score],
    every_sample: Sequence[DataBlock],
    largest: Jacobian,
    *,
    peak: float,
    thorough: bool,
    priors: Sequence[DataBlock] = (),
) -> tuple[Score, ...] | None:
    """Return the scores of every number of arms in the metric of the noise.

    None is returned if a record has no noise.

    Parameters
    ----------
    scores : sequence of Score
        By plain least squares, no arm first.
    every_sample : sequence of DataBlock
        One per record, a row per sample.
    largest : Jacobian
        Residual and Jacobian of every sample for the most arms: they give the noise.
    peak : float
        The largest force, N: it sets the residual by rounding alone.
    thorough : bool
        Add quasi-random starts.
    priors : sequence of DataBlock
        Rows of the priors.
    """
    solutions = [score.solution for score in scores]
    residuals, jacobians = split_by_record(largest, [*every_sample, *priors])
    count = len(every_sample)
    noises = estimate_noises(residuals[:count], jacobians[:count], peak=peak)
    if any(noise.autocovariance[0] <= rounding_rms(peak) ** 2 for noise in noises):
        return None
    blocks = [
        whitened_block(block, noise) for block, noise in zip(every_sample, noises, strict=True)
    ]
    # in the metric of the noise a row has unit variance
    blocks += [block.scale_rows(1 / np.sqrt(block.variance)) for block in priors if block.variance]
    refitted = [*solve_orders(blocks, len(solutions) - 1, thorough=thorough)]
    # where a further arm with k > 0 does not help, the residual is that of the last number
    refitted += [refitted[-1]] * (len(solutions) - len(refitted))
    effective = sum(noise.effective for noise in noises)
    parameter_counts = [_parameters(solution) for solution in solutions]
    sse_falls = [previous.sse - with_arm.sse for previous, with_arm in pairwise(refitted)]
    significant = [
        True,
        *(
            is_significant_fall(f, b - a)
            for f, (a, b) in zip(sse_falls, pairwise(parameter_counts), strict=True)
        ),
    ]
    return tuple(
        Score(solution, bic_of_deviance(best.sse, effective=effective, parameters=count), is_clear)
        for solution, best, count, is_clear in zip(
            solutions, refitted, parameter_counts, significant, strict=True
        )
    )


def _parameters(solution: Solution) -> int:
    return len(solution.fixed) + solution.order * (1 + len(solution.groups))


# Fit of every number of arms, and selection.


# Relative change of the residual below which a step in tau is rounding.
_STATIONARY_SHARE = 1e-6
# fraction of the residual below which that of another spectrum shows a misfit
_MISFIT_SHARE = 0.5
#: arms beyond the requested number that are tried
EXTRA_ARMS = 2
#: largest fraction by which a sum of squares can fall
MAX_SSE_FALL = 1 - 1e-12


@dataclass(frozen=True, eq=False)
class SelectedModel:
    """Optimum of the selected number of arms, its uncertainty, and all candidates.

    Attributes
    ----------
    data : FitData
    estimate : SolutionEstimate
        Estimate of the number of arms taken.
    scores : tuple of Score
        Every number tried, from none up.
    choice : OrderChoice or None
        How the rules chose; None if a number was requested.
    requested_arms : int or None
        The requested number; None if the rules chose.
    """

    data: FitData
    estimate: SolutionEstimate
    scores: tuple[Score, ...]
    choice: OrderChoice | None
    requested_arms: int | None

    @property
    def solution(self) -> Solution:
        """The optimum."""
        return self.estimate.solution

    @cached_property
    def model(self) -> GeneralizedMaxwell:
        """The arms of the optimum."""
        return build_solid(self.solution)

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
        alive_rows = np.flatnonzero(self.solution.arms.ravel() > 0) + 1
        row_by_name = {spring: spring}
        row_by_name |= {f"{arm}_{j}": f"k_{row}" for j, row in enumerate(alive_rows, start=1)}
        row_by_name |= {f"{time}_{j}": f"ln_tau_{row}" for j, row in enumerate(alive_rows, start=1)}
        row_by_name |= {} if dashpot is None else {dashpot: dashpot}
        return {name: self.estimate.names.index(row) for name, row in row_by_name.items()}

    @cached_property
    def covariance(self) -> FloatArray:
        """Covariance of the model's parameters: k_inf, every k, every ln tau, and b."""
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
        """Stiffnesses, which an error of the depth scales, by the names of their rows."""
        solution = self.solution
        arms = {f"k_{j}": k for j, k in enumerate(solution.arms.ravel().tolist(), start=1)}
        return {"k_inf": solution.coefficient("k_inf"), **arms}

    def add_depth_error(self, depth_errors: Sequence[float]) -> SelectedModel:
        """Return the model with the error of each depth by the step of the encoder."""
        return replace(self, estimate=self.estimate.add_depth_error(depth_errors, self.stiffnesses))

    @property
    def orders(self) -> tuple[OrderScore, ...]:
        """Every number of arms tried, as a fit holds it."""
        return tuple(
            OrderScore(
                score.solution.order, score.solution.sse, score.bic, score.significant,
                build_solid(score.solution),
            )
            for score in self.scores
        )  # fmt: skip

    def profiles(self, *, in_order_of_time: bool) -> tuple[Profile, ...]:
        """Profile likelihoods of the model's parameters; noise in order of time may be slow."""
        return compute_profiles(
            self.data.rows,
            self.estimate,
            every_sample=self.data.samples if in_order_of_time else None,
        )

    @cached_property
    def certificate(self) -> Certificate:
        """Distance of the optimum from the best positive spectrum."""
        return compute_certificate(self.data.rows, self.solution)

    @cached_property
    def shortage(self) -> ArmShortage | None:
        """The arms that the rules take, where fewer were requested; None if these are enough.

        Of a number that the rules chose the same, where it is the most that they tried and the
        residual is still correlated: the spectrum is wider than those arms.

        More are tried only where a spectrum with any number of arms leaves less by what one arm
        must gain.
        """
        solution = self.solution
        rounding_sse = solution.samples * rounding_rms(self.data.peak) ** 2
        chosen = self.requested_arms is None
        if chosen and not self._is_wider_than_tried:
            return None
        if solution.order < (self.requested_arms or 0) or solution.sse <= rounding_sse:
            return None
        gain = -solution.samples * float(np.log1p(-min(self.certificate.gap, MAX_SSE_FALL)))
        if gain < 2 * float(np.log(solution.samples)):
            return None
        larger_selection = select_order(self.data, FitOptions(max_arms=solution.order + EXTRA_ARMS))
        supported = larger_selection.solution.order
        if supported <= solution.order:
            return None
        return ArmShortage(
            solution.order, supported, self.estimate.rms, larger_selection.estimate.rms
        )

    @property
    def _is_wider_than_tried(self) -> bool:
        """Whether the largest tried number of arms was selected and its residual is correlated."""
        choice, kappa = self.choice, self.estimate.kappa
        return choice is not None and choice.is_largest_tried and kappa > MIN_CORRELATED_KAPPA

    def check_arm_count(self, unit: str) -> tuple[Check, ...]:
        """Whether the arms that were requested are enough, residuals in `unit`; and the samples."""
        estimate = self.estimate
        all_checks = (samples_independent(estimate.effective, len(estimate.names), estimate.kappa),)
        if self.requested_arms is None and not self._is_wider_than_tried:
            return all_checks
        return (arms_enough(self.shortage, self.solution.order, unit=unit), *all_checks)

    @property
    def convergence_check(self) -> Check:
        """Whether no step would change more than rounding, or a bound holds the point."""
        solution = self.solution
        is_stationary = solution.converged or solution.relative_offset < _STATIONARY_SHARE
        return optimiser_converged(stationary=bool(is_stationary or solution.at_bound.any()))

    @property
    def residual(self) -> Residual:
        """Statistics of the weighted residuals."""
        return self.estimate.statistics([float(r @ r) for r in self.estimate.residuals])

    def nuisances(
        self,
        value: Callable[[str], float] | None = None,
        *,
        unit: str = "N",
        delays: Sequence[float] = (),
    ) -> tuple[Nuisance, ...]:
        """Return offset, drift and delay of each test, with the prior SD of `delays`, s.

        By their columns, or by the `value` of each.
        """
        entries = {f"delay@{i}": sd for i, sd in enumerate(delays)}
        if len(delays) == 1:  # a test alone may carry no number
            entries["delay"] = delays[0]
        value = value or self.solution.coefficient
        error = self.estimate.standard_error
        return list_nuisances(self.solution.fixed_names, value, error, unit=unit, prior_sds=entries)

    def make_solid_estimate(
        self,
        residual: Residual,
        nuisance: tuple[Nuisance, ...] = (),
        *,
        rig_sensitivity: FloatArray | None = None,
    ) -> SolidEstimate:
        """Return the solid, its covariance and its nuisances, from which a fit is built.

        `rig_sensitivity`, shape (p, d), is the change of the parameters by one standard deviation
        of each unknown of the rig. It widens intervals; checks against the noise do not use it.
        """
        is_adequate = self.data.in_time and self.certificate.gap < _MISFIT_SHARE
        estimate = ParameterEstimate(
            self.parameters,
            self.covariance,
            self.estimate.dof,
            residual,
            self.profiles(in_order_of_time=is_adequate),
            nuisance,
        )
        if rig_sensitivity is not None:
            estimate = estimate.with_rig(rig_sensitivity)
        lacks_arms = self.requested_arms is not None and self.solution.order < self.requested_arms
        return SolidEstimate(self.solid, estimate, lacks_arms, bool(self.solution.at_bound.any()))


def validate_arm_count(arms: object, max_arms: object) -> int:
    """Return the most arms to try.

    Raises
    ------
    FitError
        If `arms` is neither ``"auto"`` nor a whole number >= 0.
    """
    if arms == "auto":
        if not _is_whole_number(max_arms):
            raise FitError(f"max_arms = {max_arms!r}; expected a whole number >= 0")
        return int(max_arms)  # type: ignore[call-overload,no-any-return]
    if not _is_whole_number(arms):
        raise FitError(
            f'arms = {arms!r}; expected "auto" or a whole number of arms, 0 for a spring alone'
        )
    return int(arms)  # type: ignore[call-overload,no-any-return]


def select_order(
    data: FitData, options: FitOptions, *, first: InitialFit | None = None
) -> SelectedModel:
    """Fit every number of arms; take the number that the data support, or that was requested.

    Parameters
    ----------
    data : FitData
    options : FitOptions
        ``"auto"`` arms chooses by BIC and significance; of a number the data may support fewer.
    first : InitialFit, optional
        The result of :func:`fit_all_orders`, where it is known already.
    """
    auto, max_arms = options.arms == "auto", validate_arm_count(options.arms, options.max_arms)
    if auto:
        max_arms = min(max_arms, max_determinable_arms(data.blocks))
    first = first or fit_all_orders(data, max_arms, is_automatic=auto, thorough=options.thorough)
    data, noises = first.data, first.noises
    samples, peak, in_time = data.samples, data.peak, data.in_time
    scores = _score_orders(first.solutions[: max_arms + 1], data, noises)
    is_exhausted = len(scores) - 1 < max_arms or not in_time
    choice = _select_choice(
        scores, is_exhausted=is_exhausted, decisive=DECISIVE_BIC if in_time else np.inf
    )

    @lru_cache(maxsize=1)  # the order that the rules support is, as a rule, the one chosen
    def solve_whole_order(order: int) -> Jacobian:
        return compute_full_jacobian([*samples, *data.priors], scores[order].solution)

    # least squares is a fair judge where the noise is even to the arms that a rule supports
    supported = min(max(choice.by_bic, choice.by_significance, 1), len(scores) - 1)
    if (
        auto
        and in_time
        and not nearly_white(noises)
        and noise_gain_differs(
            _noise_gain(split_by_record(solve_whole_order(supported), data.full_rows)[1], noises)
        )
    ):
        largest = solve_whole_order(len(scores) - 1)
        anew = score_in_noise_metric(
            scores, samples, largest, peak=peak, thorough=options.thorough, priors=data.priors
        )
        if anew is not None:
            scores = anew
            choice = _select_choice(
                scores, is_exhausted=is_exhausted, decisive=DECISIVE_BIC, in_noise_metric=True
            )
    arm_count = choice.arms if auto else min(max_arms, len(scores) - 1)
    estimate = estimate_covariance(
        scores[arm_count].solution,
        samples,
        peak=peak,
        priors=data.priors,
        encoders=data.encoders,
        jacobian=solve_whole_order(arm_count),
        series=first.get_residuals(scores[arm_count].solution),
    )
    return SelectedModel(
        data, estimate, scores, choice if auto else None, None if auto else max_arms
    )


# -- orders ---------------------------------------------------------------------------------------


def _score_orders(
    solutions: Sequence[Solution], data: FitData, noises: Sequence[Noise]
) -> tuple[Score, ...]:
    """Judge each number of arms by the residuals of the largest."""
    effective = sum(noise.effective for noise in noises)
    return tuple(
        score_solution(
            solution,
            data.blocks,
            data.samples,
            effective=effective,
            peak=data.peak,
            priors=data.priors,
        )
        for solution in solutions
    )


def _noise_gain(jacobians: Sequence[FloatArray], noises: Sequence[Noise]) -> float:
    information = make_directions(jacobians[: len(noises)])
    return noise_gain_ratio(
        information, [*map(information.compute_record_gain, range(len(noises)), noises)]
    )


def _select_choice(
    scores: Sequence[Score], *, is_exhausted: bool, decisive: float, in_noise_metric: bool = False
) -> OrderChoice:
    return select_model_order(
        range(len(scores)),
        [score.bic for score in scores],
        [score.significant for score in scores],
        is_exhausted=is_exhausted,
        in_noise_metric=in_noise_metric,
        decisive=decisive,
    )


def _is_whole_number(number: object) -> bool:
    is_integer = isinstance(number, int | np.integer) and not isinstance(number, bool)
    return is_integer and number >= 0  # type: ignore[operator]


# -- Parts of a fit -------------------------------------------------------------------------------


def compute_certificate(blocks: Sequence[DataBlock], solution: Solution) -> Certificate:
    """Return how far the optimum can be from the best positive spectrum."""
    result = certificate(blocks, solution)
    if result.optimal:
        message = "no relaxation spectrum with any number of arms fits better"
    else:
        message = (
            f"no relaxation spectrum fits better by more than {100 * result.gap:.2g} % of the "
            "squared residual"
        )
    return Certificate(result.optimal, result.gap, result.tau, message)
