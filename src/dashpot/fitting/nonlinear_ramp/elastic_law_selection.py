r"""Which elastic law the ramps of prepared tests support.

A record that a linear solid explains to its noise, ramp and hold alike, is *sound*: it keeps the
linear law and the full information of its ramp. Any other is fitted hold first
(:mod:`~dashpot.fitting.nonlinear_ramp.hold_then_ramp`) with every law of a short ladder, and takes
the one that BIC prefers if it also matters.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.choices import RampLawAsked, require_choice
from dashpot.base.errors import FitError
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.nonlinear_ramp.downsampling import DownsampledRows, downsample
from dashpot.fitting.nonlinear_ramp.elastic_law_estimate import (
    LEAST_GAIN,
    ElasticLawScore,
    KnotSpacing,
    RampLaw,
    build_ramp_law,
    elastic_law_of,
)
from dashpot.fitting.nonlinear_ramp.goodness_of_fit import LinearFitQuality, sample_noise, soundness
from dashpot.fitting.nonlinear_ramp.hold_then_ramp import (
    MAX_ARMS,
    HoldEstimate,
    RampHoldOptimum,
    delay_derivative,
    fit_hold_only,
    fit_ramp_and_hold,
    independent,
    nuisances,
    recorded_hold,
    spread,
    with_residual_statistics,
)
from dashpot.fitting.nonlinear_ramp.quasi_linear import QuasiLinear
from dashpot.fitting.nonlinear_ramp.weighted_least_squares import Weighted, tau_bounds
from dashpot.numerics.inference.model_order import Shortage, bic_of_deviance, deviance

# a law that moves the path by less than this part of the depth is not worth having: behind one of
# .1 to 1 % that is not taken, what a linear solid leaves on the ramp doubts sound records
LEAST_GAP = 5e-4

# a knot of the law needs so many rows of the ramp
_ROWS_PER_KNOT = 2
# so many depths bear finer laws
_SEVERAL = 3

LINEAR = KnotSpacing(2)
LADDER = (KnotSpacing(3), KnotSpacing(5), KnotSpacing(9), KnotSpacing(7, 2), KnotSpacing(9, 2))
# several depths show the law's integral at each, to the noise of a hold
DEPTHS_LADDER = (KnotSpacing(17), KnotSpacing(17, 2))


def select_elastic_law(
    tests: Sequence[RampHold],
    *,
    law: RampLawAsked = "auto",
    arms: int | None = None,
    max_arms: int = MAX_ARMS,
) -> RampLaw:
    r"""Return the elastic law that the ramps of tests of one part support.

    Parameters
    ----------
    tests : sequence of RampHold
        Of any depths and ramp rates; they share the law, the stiffnesses and the relaxation
        times, and each has its own offset and drift, bound by
        :func:`~dashpot.fitting.nuisance_priors.priors`. The force is free of hum.
    law : "auto", "linear" or "nonlinear"
        ``"auto"`` keeps the linear law where it is sound, where no other lowers BIC by 10, or
        where none moves the path by .05 % of the depth.
    arms : int, optional
        By default as many as the holds support by BIC, and one faster one if the ramps do.
    max_arms : int
        The most that are tried by default.

    Raises
    ------
    FitError
        If a record has no samples on its ramp or in its hold to speak of.
    """
    require_choice("law", law, RampLawAsked, FitError)
    rows = downsample(tests)
    hold = fit_hold_only(rows, arms, max_arms)
    noise = [sample_noise(*pair) for pair in zip(rows.noise, hold.rms, strict=True)]
    soundness, optimum = assess_linear_fit(rows, hold, noise, arms)
    if law != "nonlinear" and all(quality.sound for quality in soundness):
        score = ElasticLawScore(LINEAR, elastic_law_of(optimum), 0.0, optimum.ramp, optimum.hold)
        return build_ramp_law(tests, hold, soundness, optimum, (score,))
    shown = int(rows.ramp.sum()) // _ROWS_PER_KNOT
    finer = DEPTHS_LADDER if len(set(rows.depths)) >= _SEVERAL else ()
    bent = [item for item in (*LADDER, *finer) if item.knots <= max(shown, LADDER[0].knots)]
    laws = {"linear": [LINEAR], "nonlinear": bent, "auto": [LINEAR, *bent]}[law]
    start = recorded_hold(rows, hold)
    tried = {law: _solve_law(rows, law, hold, start) for law in laws}
    scores = _scores(tried, hold)
    taken = _select_law(scores) if law == "auto" else min(scores, key=lambda score: score.bic)
    ramp_optimum = _with_delay(tried[taken.spacing], hold)
    if arms is None and len(hold.log_tau) < max_arms:
        ramp_optimum = _with_faster_arm(ramp_optimum, hold)
    return build_ramp_law(tests, hold, soundness, ramp_optimum, scores)


def supported_by_holds(tests: Sequence[RampHold], hold: HoldEstimate) -> Shortage | None:
    """Return the arms that the holds of some tests support, where a fit to them has fewer.

    Parameters
    ----------
    tests : sequence of RampHold
    hold : Hold
        The holds by the number of arms that was asked for.
    """
    arms = len(hold.log_tau)
    more = fit_hold_only(downsample(tests))
    supported = len(more.log_tau)
    if supported <= arms:
        return None
    return Shortage(arms, supported, _rms(hold), _rms(more))


def _rms(hold: HoldEstimate) -> float:
    return float(np.sqrt(np.mean(np.square(hold.rms))))


def _solve_law(
    rows: DownsampledRows, spacing: KnotSpacing, hold: HoldEstimate, start: RampHoldOptimum
) -> RampHoldOptimum:
    solid = QuasiLinear(rows, spacing.at(rows.depth))
    return fit_ramp_and_hold(solid, hold, start, solid.theta(start.log_tau, np.ones(spacing.knots)))


def _scores(
    tried: dict[KnotSpacing, RampHoldOptimum], hold: HoldEstimate
) -> tuple[ElasticLawScore, ...]:
    """Return BIC of each law; ramp rows count as the closest of them leaves them correlated."""
    best = min(tried.values(), key=lambda optimum: float(np.sum(np.log(optimum.ramp))))
    return tuple(
        ElasticLawScore(
            spacing,
            elastic_law_of(optimum),
            _bic(optimum, hold, best.ramp_correlation),
            optimum.ramp,
            optimum.hold,
        )
        for spacing, optimum in tried.items()
    )


def _bic(optimum: RampHoldOptimum, hold: HoldEstimate, correlation: Sequence[float]) -> float:
    r"""Return :math:`\sum m_r \ln r_r^2 + m_h \ln r_h^2 + p \ln \sum m_r`, m = rows / kappa."""
    rows = optimum.weighted.solid.rows
    total, effective = 0.0, 0.0
    for i, kappa in enumerate(correlation):
        on = float(np.sum(rows.ramp & (rows.record == i))) / kappa
        # a ramp followed closer than its noise is luck
        least = min(rows.noise[i], optimum.hold[i])
        held = rows.held(i).sum() / hold.correlation[i]
        total += deviance(max(optimum.ramp[i], least) ** 2, effective=on)
        total += deviance(optimum.hold[i] ** 2, effective=held)
        effective += on
    arms, bends = len(optimum.log_tau), optimum.weighted.solid.bends.stop
    delays = len(optimum.nuisance) - 2 * len(rows.depths)
    free = 2 * arms + max(bends - 1, 0) + delays
    return bic_of_deviance(total, effective=max(effective, 2.0), parameters=free)


def _select_law(scores: Sequence[ElasticLawScore]) -> ElasticLawScore:
    """Return the law of the least BIC if it gains and matters, else the linear one."""
    best = min(scores, key=lambda score: score.bic)
    linear = scores[0]
    worth = linear.bic - best.bic > LEAST_GAIN and best.gap > LEAST_GAP
    return best if worth else linear


def _with_delay(optimum: RampHoldOptimum, hold: HoldEstimate) -> RampHoldOptimum:
    """Return the fit with a delay of each force if the ramps show one."""
    solid, best = optimum.weighted.solid, optimum.optimum
    resolved_nuisances = nuisances(solid.rows, delay_derivative(optimum.weighted, best))
    late = fit_ramp_and_hold(solid, hold, optimum, best.theta, value=resolved_nuisances)
    gain = _bic(optimum, hold, late.ramp_correlation) - _bic(late, hold, late.ramp_correlation)
    return late if gain > LEAST_GAIN else optimum


def _with_faster_arm(optimum: RampHoldOptimum, hold: HoldEstimate) -> RampHoldOptimum:
    """Return the fit with one more arm if the ramps show one that the holds hardly do."""
    solid, n = optimum.weighted.solid, len(hold.log_tau)
    rows = solid.rows
    first = rows.ramp & (rows.record == 0)
    ramp = np.log(rows.ends[0] - rows.time[first][0])
    fastest = float(hold.log_tau[0]) if n else float(ramp)
    if fastest - np.log(4.0) <= tau_bounds(rows).low:
        return optimum
    tried = optimum.weighted.descend(np.append(fastest - np.log(4.0), optimum.optimum.theta))
    fall = optimum.optimum.cost - tried.cost
    if solid.split_parameters(tried.theta)[0].min() > fastest - np.log(2.0) or fall < LEAST_GAIN:
        return optimum
    more = fit_ramp_and_hold(solid, hold, optimum, tried.theta, value=optimum.weighted.nuisances)
    faster = float(more.log_tau.min()) < fastest - np.log(2.0)
    gain = _bic(optimum, hold, more.ramp_correlation) - _bic(more, hold, more.ramp_correlation)
    return more if faster and bool((more.k[0, 1:] > 0).all()) and gain > LEAST_GAIN else optimum


def assess_linear_fit(
    rows: DownsampledRows, hold: HoldEstimate, noise: Sequence[float], arms: int | None
) -> tuple[tuple[LinearFitQuality, ...], RampHoldOptimum]:
    """Return how sound the linear law is, the best of the numbers of arms tried."""
    count = len(hold.log_tau)
    tried = []
    for index in (count, count - 1) if arms is None and count > 1 else (count,):
        start = hold if index == count else fit_hold_only(rows, index)
        optimum = _joint(rows, hold, start.log_tau, noise)
        qualities = tuple(
            soundness(
                optimum.ramp[i],
                optimum.hold[i],
                hold.rms[i],
                noise=noise[i],
                discrepancy=optimum.ramp_scatter[i] / float(independent(hold)[i]),
                samples=float(np.sum(rows.ramp & (rows.record == i))) / hold.correlation[i],
                peak=rows.peak(i),
            )
            for i in range(len(noise))
        )
        tried.append((qualities, optimum))
        if all(at.sound for at in qualities):
            break
    reliable = [pair for pair in tried if all(at.sound for at in pair[0])]
    return (reliable or tried)[0]


def _joint(
    rows: DownsampledRows, hold: HoldEstimate, log_tau: FloatArray, noise: Sequence[float]
) -> RampHoldOptimum:
    """Fit the linear law to ramp and hold at equal weight, first without, then with a delay."""
    even = np.array(noise) * np.sqrt(hold.correlation)
    solid = QuasiLinear(rows, np.array([0.0, rows.depth]))
    sd = spread(rows, even, even)
    first = Weighted(solid, sd, nuisances(rows))
    best = first.descend(log_tau)
    late = Weighted(solid, sd, nuisances(rows, delay_derivative(first, best)))
    return with_residual_statistics(late, late.descend(best.theta), independent(hold))
