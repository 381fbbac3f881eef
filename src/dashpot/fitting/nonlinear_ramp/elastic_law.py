"""Selection of the elastic law that the ramps support, with its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.base.option_fields import RampLawOption, require_choice
from dashpot.datamodel.parameter_estimate import ParameterEstimate, parameter_names
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.fit_construction import list_nuisances
from dashpot.fitting.nonlinear_ramp.hold_then_ramp import (
    MAX_ARMS,
    HoldEstimate,
    RampHoldOptimum,
    add_residual_statistics,
    build_nuisances,
    compute_independent_noise,
    compute_row_sd,
    delay_derivative,
    fit_hold_only,
    fit_ramp_and_hold,
    fit_recorded_hold,
)
from dashpot.fitting.nonlinear_ramp.linearity import (
    LinearFitQuality,
    assess_linear_fit,
    sample_noise,
)
from dashpot.fitting.nonlinear_ramp.quasi_linear import (
    DownsampledRows,
    QuasiLinear,
    Weighted,
    downsample_tests,
    tau_bounds,
)
from dashpot.fitting.order_selection import EXTRA_ARMS
from dashpot.fitting.parameter_errors import ParameterCovariance
from dashpot.numerics.design_matrices.recorded_motion import compute_arm_columns
from dashpot.numerics.inference.correlated_noise import estimate_noise
from dashpot.numerics.inference.model_order import ArmShortage, bic_of_deviance, deviance
from dashpot.preprocessing.denoising import denoise_displacement
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

# Elastic law as a value, with its uncertainty.


# Difference of BIC below which two laws are equivalent.
MIN_BIC_GAIN = 10.0


class KnotSpacing(NamedTuple):
    """Candidate elastic law: number of knots, and power of their spacing."""

    knots: int
    power: int = 1

    def place_knots(self, depth: float) -> FloatArray:
        """Return the knots down to a depth, m."""
        return np.asarray(depth * np.linspace(0.0, 1.0, self.knots) ** float(self.power))


@dataclass(frozen=True)
class ElasticLawScore:
    """Score of one candidate elastic law.

    Attributes
    ----------
    spacing : KnotSpacing
    elastic_law : ElasticLaw
    bic : float
        Differences count.
    ramp_rms, hold_rms : tuple of float
        Root mean square residual of each record, N.
    """

    spacing: KnotSpacing
    elastic_law: ElasticLaw
    bic: float
    ramp_rms: tuple[float, ...]
    hold_rms: tuple[float, ...]

    @property
    def path_deviation(self) -> float:
        """Largest distance between the law's path and the linear one, as a part of the depth."""
        x = np.linspace(0.0, self.elastic_law.depth, 101)
        return float(np.abs(self.elastic_law.path(x) - x).max()) / self.elastic_law.depth


@dataclass(frozen=True, eq=False)
class RampLaw:
    r"""Elastic law that ramps support, with its solid, and the uncertainty of both.

    Attributes
    ----------
    law : ElasticLaw
    model : GeneralizedMaxwell
        Secant at the depth of the law.
    estimate : ParameterEstimate
        Estimate of the parameters of `model`.
    law_covariance : array, shape (p + P, p + P)
        Covariance of the parameters of `model` and then of the law's shape at its knots.
    hold : HoldEstimate
        What the holds say without their ramps.
    linear_qualities : tuple of LinearFitQuality
        Qualities of each record under the linear law with the full weight of its ramp.
    optimum : RampHoldOptimum
        The optimum of the law, with its residuals.
    scores : tuple of ElasticLawScore
        The laws tried, the linear one first.
    residuals : tuple of array
        Residuals of every sample from contact to the end of the hold, N.
    """

    law: ElasticLaw
    model: GeneralizedMaxwell
    estimate: ParameterEstimate
    law_covariance: FloatArray
    hold: HoldEstimate
    linear_qualities: tuple[LinearFitQuality, ...]
    optimum: RampHoldOptimum
    scores: tuple[ElasticLawScore, ...]
    residuals: tuple[FloatArray, ...]

    @property
    def is_linear(self) -> bool:
        """True if the linear law explains every record to its noise."""
        return all(quality.is_adequate for quality in self.linear_qualities)

    @property
    def discrepancy(self) -> tuple[float, ...]:
        r"""Scatter of each ramp over that of its hold, :math:`s_r/(s_h \sqrt{\kappa_h})`: >= 1."""
        return tuple(
            float(ramp / hold_scatter)
            for ramp, hold_scatter in zip(
                self.optimum.ramp_scatter, compute_independent_noise(self.hold), strict=True
            )
        )

    @property
    def relative_residuals(self) -> tuple[float, ...]:
        """Residual on each ramp as a part of the largest force."""
        rows = self.optimum.weighted.solid.rows
        return tuple(value / rows.peak(i) for i, value in enumerate(self.optimum.ramp_rms))

    @property
    def rho(self) -> tuple[float, ...]:
        """Residual of each hold over that of a fit of the hold alone."""
        return tuple(a / b for a, b in zip(self.optimum.hold_rms, self.hold.rms, strict=True))


def build_ramp_law(
    tests: Sequence[RampHold],
    hold: HoldEstimate,
    linear_qualities: tuple[LinearFitQuality, ...],
    optimum: RampHoldOptimum,
    scores: tuple[ElasticLawScore, ...],
) -> RampLaw:
    """Return the value of an optimum, with its covariance and its residuals."""
    k, log_tau, solid = optimum.k[0], optimum.log_tau, optimum.weighted.solid
    order = np.argsort(log_tau)
    arm_order = order[k[1:][order] > 0]
    model = GeneralizedMaxwell(
        float(k[0]),
        tuple(k[1:][arm_order].tolist()),
        tuple(np.exp(log_tau[arm_order]).tolist()),
    )
    theta_count = len(optimum.optimum.theta)

    def seal(values: FloatArray) -> FloatArray:
        """Return the solid's parameters, then the law's shape, whose mean is 1."""
        log_tau, shape = solid.split_parameters(values[:theta_count])
        k = values[theta_count : theta_count + 1 + len(log_tau)]
        return np.concatenate(
            (k[:1], k[1 + arm_order], log_tau[arm_order], shape / (solid.weights @ shape))
        )

    # each encoder's step scales every stiffness of its test
    depth_error = float(np.sqrt(np.mean([test.depth_error**2 for test in tests]) / len(tests)))
    scale_vector = np.zeros(len(optimum.optimum.values))
    scale_vector[theta_count : theta_count + len(k)] = depth_error * k
    estimate = optimum.estimate(hold).add_parameter_error(scale_vector)
    covariance, names = (estimate.derive_quantity(seal).covariance, parameter_names(len(arm_order)))
    nuisance = optimum.nuisance
    errors = dict(zip(nuisance, estimate.standard_error[-len(nuisance) :].tolist(), strict=True))
    residuals = tuple(_residual(test, i, model, optimum) for i, test in enumerate(tests))
    parameter_covariance = ParameterCovariance(
        (), covariance, residuals, tuple(map(estimate_noise, residuals))
    )
    return RampLaw(
        law=get_elastic_law(optimum),
        model=model,
        estimate=ParameterEstimate(
            names,
            covariance[: len(names), : len(names)],
            dof=max(parameter_covariance.effective - len(scale_vector), 1.0),
            residual=parameter_covariance.statistics([1.0] * len(tests)),
            nuisance=list_nuisances([*nuisance], nuisance.__getitem__, errors.__getitem__),
        ),
        law_covariance=covariance,
        hold=hold,
        linear_qualities=linear_qualities,
        optimum=optimum,
        scores=scores,
        residuals=residuals,
    )


def _residual(
    test: RampHold, i: int, model: GeneralizedMaxwell, optimum: RampHoldOptimum
) -> FloatArray:
    """Return every sample less the model and the load cell."""
    priors = optimum.weighted.solid.rows.priors[i]
    path = get_elastic_law(optimum).path(denoise_displacement(test)[0])
    time = test.time[: len(path)] - test.time[0]
    arms = compute_arm_columns(time, path, np.asarray(model.tau), derivative=False)[0]
    values = optimum.nuisance
    force = model.k_inf * path + arms @ np.asarray(model.k)
    force += values[f"offset@{i}"] + values[f"drift@{i}"] * (time - priors.offset_time)
    if f"delay@{i}" in values:
        force -= values[f"delay@{i}"] * np.gradient(force, time)
    return np.asarray((test.force[: len(path)] - force)[priors.first_sample :])


def get_elastic_law(optimum: RampHoldOptimum) -> ElasticLaw:
    """Return the law of an optimum."""
    knots, shape, k_inf = optimum.weighted.solid.knots, optimum.shape, float(optimum.k[0, 0])
    if len(knots) == 2:
        return ElasticLaw.linear(k_inf, float(knots[-1]))
    return ElasticLaw(tuple(knots.tolist()), tuple(shape.tolist()), k_inf)


# Selection of the elastic law.
#
# A record that a linear solid explains to its noise, ramp and hold alike, is *sound*: it keeps the
# linear law and the full information of its ramp. Any other is fitted hold first
# (:mod:`~dashpot.fitting.nonlinear_ramp.hold_then_ramp`) with every law of a short ladder, and
# takes the one that BIC prefers if it also matters.


# Smallest relative deviation of the elastic path from a straight line at which a nonlinear law is
# used. A larger limit, of 0.1 to 1 %, rejected linear records.
MIN_GAP = 5e-4

# Smallest number of rows of the ramp for each knot of the law.
_ROWS_PER_KNOT = 2
# so many depths bear finer laws
_MIN_DEPTHS = 3

LINEAR_KNOTS = KnotSpacing(2)
KNOT_LADDER = (KnotSpacing(3), KnotSpacing(5), KnotSpacing(9), KnotSpacing(7, 2), KnotSpacing(9, 2))
# several depths show the law's integral at each, to the noise of a hold
DEPTHS_KNOT_LADDER = (KnotSpacing(17), KnotSpacing(17, 2))


def select_elastic_law(
    tests: Sequence[RampHold],
    *,
    law: RampLawOption = "auto",
    arms: int | None = None,
    max_arms: int = MAX_ARMS,
) -> RampLaw:
    r"""Return the elastic law that the ramps of tests of one part support.

    Parameters
    ----------
    tests : sequence of RampHold
        Tests of any depths and ramp rates; they share the law, the stiffnesses and the relaxation
        times, and each has its own offset and drift, bound by
        :func:`~dashpot.fitting.nuisance_priors.build_load_cell_priors`. The force is free of hum.
    law : "auto", "linear" or "nonlinear"
        ``"auto"`` keeps the linear law where it is sound, where no other lowers BIC by 10, or
        where none moves the path by .05 % of the depth.
    arms : int, optional
        By default the number supported by the holds by BIC, and a faster one if supported by the
        ramps.
    max_arms : int
        The most that are tried by default.

    Raises
    ------
    FitError
        If a record has too few samples on its ramp or in its hold.
    """
    require_choice("law", law, RampLawOption, FitError)
    rows = downsample_tests(tests)
    hold = fit_hold_only(rows, arms, max_arms)
    noise = [sample_noise(*pair) for pair in zip(rows.noise, hold.rms, strict=True)]
    linear_qualities, optimum = _assess_linear_law(rows, hold, noise, arms)
    if law != "nonlinear" and all(quality.is_adequate for quality in linear_qualities):
        score = ElasticLawScore(
            LINEAR_KNOTS, get_elastic_law(optimum), 0.0, optimum.ramp_rms, optimum.hold_rms
        )
        return build_ramp_law(tests, hold, linear_qualities, optimum, (score,))
    max_knots = int(rows.ramp.sum()) // _ROWS_PER_KNOT
    finer_laws = DEPTHS_KNOT_LADDER if len(set(rows.depths)) >= _MIN_DEPTHS else ()
    nonlinear_laws = [
        item
        for item in (*KNOT_LADDER, *finer_laws)
        if item.knots <= max(max_knots, KNOT_LADDER[0].knots)
    ]
    laws = {
        "linear": [LINEAR_KNOTS],
        "nonlinear": nonlinear_laws,
        "auto": [LINEAR_KNOTS, *nonlinear_laws],
    }[law]
    start = fit_recorded_hold(rows, hold)
    optima = {law: _solve_law(rows, law, hold, start) for law in laws}
    scores = _score_laws(optima, hold)
    selected = _select_law(scores) if law == "auto" else min(scores, key=lambda score: score.bic)
    ramp_optimum = _add_delay(optima[selected.spacing], hold)
    if arms is None and len(hold.log_tau) < max_arms:
        ramp_optimum = _add_faster_arm(ramp_optimum, hold)
    return build_ramp_law(tests, hold, linear_qualities, ramp_optimum, scores)


def find_arm_shortage(tests: Sequence[RampHold], hold: HoldEstimate) -> ArmShortage | None:
    """Return the arms supported by the holds of some tests, if their fit has fewer.

    More than a fit chooses by itself are tried, too.

    Parameters
    ----------
    tests : sequence of RampHold
    hold : HoldEstimate
        The holds by the number of arms that was requested, or by the most that a fit chooses.
    """
    arms = len(hold.log_tau)
    hold_only = fit_hold_only(downsample_tests(tests), max_arms=max(MAX_ARMS, arms + EXTRA_ARMS))
    supported = len(hold_only.log_tau)
    if supported <= arms:
        return None
    return ArmShortage(arms, supported, _rms(hold), _rms(hold_only))


def _rms(hold: HoldEstimate) -> float:
    return float(np.sqrt(np.mean(np.square(hold.rms))))


def _solve_law(
    rows: DownsampledRows, spacing: KnotSpacing, hold: HoldEstimate, start: RampHoldOptimum
) -> RampHoldOptimum:
    solid = QuasiLinear(rows, spacing.place_knots(rows.depth))
    return fit_ramp_and_hold(solid, hold, start, solid.theta(start.log_tau, np.ones(spacing.knots)))


def _score_laws(
    optima: dict[KnotSpacing, RampHoldOptimum], hold: HoldEstimate
) -> tuple[ElasticLawScore, ...]:
    """Return BIC of each law; ramp rows count as the closest of them leaves them correlated."""
    best_optimum = min(optima.values(), key=lambda optimum: float(np.sum(np.log(optimum.ramp_rms))))
    return tuple(
        ElasticLawScore(
            spacing,
            get_elastic_law(optimum),
            _compute_bic(optimum, hold, best_optimum.ramp_correlation),
            optimum.ramp_rms,
            optimum.hold_rms,
        )
        for spacing, optimum in optima.items()
    )


def _compute_bic(
    optimum: RampHoldOptimum, hold: HoldEstimate, correlation: Sequence[float]
) -> float:
    r"""Return :math:`\sum m_r \ln r_r^2 + m_h \ln r_h^2 + p \ln \sum m_r`, m = rows / kappa."""
    rows = optimum.weighted.solid.rows
    total, effective = 0.0, 0.0
    for i, kappa in enumerate(correlation):
        ramp_rows = float(np.sum(rows.ramp & (rows.record == i))) / kappa
        # a ramp followed closer than its noise is luck
        noise_level = min(rows.noise[i], optimum.hold_rms[i])
        effective_count = rows.select_hold(i).sum() / hold.correlation[i]
        total += deviance(max(optimum.ramp_rms[i], noise_level) ** 2, effective=ramp_rows)
        total += deviance(optimum.hold_rms[i] ** 2, effective=effective_count)
        effective += ramp_rows
    arms, knot_count = len(optimum.log_tau), optimum.weighted.solid.bends.stop
    delays = len(optimum.nuisance) - 2 * len(rows.depths)
    parameter_count = 2 * arms + max(knot_count - 1, 0) + delays
    return bic_of_deviance(total, effective=max(effective, 2.0), parameters=parameter_count)


def _select_law(scores: Sequence[ElasticLawScore]) -> ElasticLawScore:
    """Return the law of the least BIC if it gains and matters, else the linear one."""
    best_score = min(scores, key=lambda score: score.bic)
    linear = scores[0]
    is_better = linear.bic - best_score.bic > MIN_BIC_GAIN and best_score.path_deviation > MIN_GAP
    return best_score if is_better else linear


def _add_delay(optimum: RampHoldOptimum, hold: HoldEstimate) -> RampHoldOptimum:
    """Return the fit with a delay of each force if the ramps show one."""
    solid, best_optimum = optimum.weighted.solid, optimum.optimum
    resolved_nuisances = build_nuisances(
        solid.rows, delay_derivative(optimum.weighted, best_optimum)
    )
    delayed = fit_ramp_and_hold(solid, hold, optimum, best_optimum.theta, value=resolved_nuisances)
    gain = _compute_bic(optimum, hold, delayed.ramp_correlation) - _compute_bic(
        delayed, hold, delayed.ramp_correlation
    )
    return delayed if gain > MIN_BIC_GAIN else optimum


def _add_faster_arm(optimum: RampHoldOptimum, hold: HoldEstimate) -> RampHoldOptimum:
    """Return the fit with one more arm if the ramps show one that the holds hardly do."""
    solid, n = optimum.weighted.solid, len(hold.log_tau)
    rows = solid.rows
    first_ramp = rows.ramp & (rows.record == 0)
    ramp = np.log(rows.ramp_ends[0] - rows.time[first_ramp][0])
    fastest = float(hold.log_tau[0]) if n else float(ramp)
    if fastest - np.log(4.0) <= tau_bounds(rows).low:
        return optimum
    trial = optimum.weighted.descend(np.append(fastest - np.log(4.0), optimum.optimum.theta))
    cost_fall = optimum.optimum.cost - trial.cost
    if (
        solid.split_parameters(trial.theta)[0].min() > fastest - np.log(2.0)
        or cost_fall < MIN_BIC_GAIN
    ):
        return optimum
    refined = fit_ramp_and_hold(solid, hold, optimum, trial.theta, value=optimum.weighted.nuisances)
    is_faster = float(refined.log_tau.min()) < fastest - np.log(2.0)
    gain = _compute_bic(optimum, hold, refined.ramp_correlation) - _compute_bic(
        refined, hold, refined.ramp_correlation
    )
    return (
        refined
        if is_faster and bool((refined.k[0, 1:] > 0).all()) and gain > MIN_BIC_GAIN
        else optimum
    )


def _assess_linear_law(
    rows: DownsampledRows, hold: HoldEstimate, noise: Sequence[float], arms: int | None
) -> tuple[tuple[LinearFitQuality, ...], RampHoldOptimum]:
    """Return how sound the linear law is, the best of the numbers of arms tried."""
    count = len(hold.log_tau)
    candidates = []
    for index in (count, count - 1) if arms is None and count > 1 else (count,):
        start = hold if index == count else fit_hold_only(rows, index)
        optimum = _fit_jointly(rows, hold, start.log_tau, noise)
        qualities = tuple(
            assess_linear_fit(
                optimum.ramp_rms[i],
                optimum.hold_rms[i],
                hold.rms[i],
                noise=noise[i],
                discrepancy=optimum.ramp_scatter[i] / float(compute_independent_noise(hold)[i]),
                samples=float(np.sum(rows.ramp & (rows.record == i))) / hold.correlation[i],
                peak=rows.peak(i),
            )
            for i in range(len(noise))
        )
        candidates.append((qualities, optimum))
        if all(quality.is_adequate for quality in qualities):
            break
    reliable = [pair for pair in candidates if all(quality.is_adequate for quality in pair[0])]
    return (reliable or candidates)[0]


def _fit_jointly(
    rows: DownsampledRows, hold: HoldEstimate, log_tau: FloatArray, noise: Sequence[float]
) -> RampHoldOptimum:
    """Fit the linear law to ramp and hold at equal weight, first without, then with a delay."""
    equal_noise = np.array(noise) * np.sqrt(hold.correlation)
    solid = QuasiLinear(rows, np.array([0.0, rows.depth]))
    sd = compute_row_sd(rows, equal_noise, equal_noise)
    first_weights = Weighted(solid, sd, build_nuisances(rows))
    best_fit = first_weights.descend(log_tau)
    with_delay = Weighted(
        solid, sd, build_nuisances(rows, delay_derivative(first_weights, best_fit))
    )
    return add_residual_statistics(
        with_delay, with_delay.descend(best_fit.theta), compute_independent_noise(hold)
    )
