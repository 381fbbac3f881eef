r"""Which elastic law the ramps of prepared tests support, and how well it is known.

A record that a linear solid explains to its noise, ramp and hold alike, is *sound*: it keeps the
linear law and the full information of its ramp. Any other is fitted hold first
(:mod:`~dashpot.fitting.nonlinear_ramp.hold_first`) with every law of a short ladder, and takes
the one that BIC prefers if it also matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.engine.blocks.recorded import arm_columns
from dashpot.engine.inference.covariance import noise_of, white
from dashpot.fitting.nonlinear_ramp.hold_first import (
    Followed,
    Hold,
    follow,
    hold_alone,
    independent,
    measured,
    nuisances,
    recorded_hold,
    spread,
    tau_bounds,
)
from dashpot.fitting.nonlinear_ramp.projection import Weighted
from dashpot.fitting.nonlinear_ramp.quasi_linear import QuasiLinear
from dashpot.fitting.nonlinear_ramp.thinning import Rows, relaxes_from, thinned
from dashpot.preparation.denoising import true_motion
from dashpot.records.estimate import Nuisance, ParameterEstimate, Residual, parameter_names
from dashpot.records.relaxation import RampHold
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

LawName: TypeAlias = Literal["auto", "linear", "nonlinear"]

# a linear law is wrong if it leaves so much more than the noise on the ramp, in one sample or in
# one independent residual, and than the hold alone in the hold
SOUND_RAMP, SOUND_SHAPE, SOUND_HOLD = 1.2, 1.5, 1.1
# a law that moves the path by less than this part of the depth, or BIC by less, is not worth it
LEAST_GAP, LEAST_GAIN = 0.01, 10.0
# what a residual of this part of the peak stands for moves no stiffness that anyone would notice
NEGLIGIBLE = 1e-4

# a knot of the law needs so many rows of the ramp
_ROWS_PER_KNOT = 2
# so many depths bear finer laws
_SEVERAL = 3

_UNITS = {"offset": "N", "drift": "N/s", "delay": "s"}


class Law(NamedTuple):
    """A step of the ladder: how many knots, and the power of their spacing."""

    knots: int
    power: int = 1

    def at(self, depth: float) -> FloatArray:
        """The knots down to a depth, m."""
        return np.asarray(depth * np.linspace(0.0, 1.0, self.knots) ** float(self.power))


LINEAR = Law(2)
LADDER = (Law(3), Law(5), Law(9), Law(7, 2), Law(9, 2))
# several depths show the law's integral at each, to the noise of a hold
DEPTHS_LADDER = (Law(17), Law(17, 2))


class Soundness(NamedTuple):
    """What a linear fit leaves of a record, against its noise.

    Attributes
    ----------
    ramp : float
        Residual on the ramp over the noise of one sample.
    hold : float
        Residual in the hold over what the hold alone leaves.
    sound : bool
    """

    ramp: float
    hold: float
    sound: bool


@dataclass(frozen=True)
class LawScore:
    """One law of the ladder, fitted.

    Attributes
    ----------
    law : Law
    elastic_law : ElasticLaw
    bic : float
        Differences count.
    ramp, hold : tuple of float
        Root mean square residual of each record, N.
    """

    law: Law
    elastic_law: ElasticLaw
    bic: float
    ramp: tuple[float, ...]
    hold: tuple[float, ...]

    @property
    def gap(self) -> float:
        """Largest distance between the law's path and the linear one, as a part of the depth."""
        x = np.linspace(0.0, self.elastic_law.depth, 101)
        return float(np.abs(self.elastic_law.path(x) - x).max()) / self.elastic_law.depth


@dataclass(frozen=True, eq=False)
class RampLaw:
    r"""The elastic law that ramps support, the solid that answers it, and how well both are known.

    Attributes
    ----------
    law : ElasticLaw
    model : GeneralizedMaxwell
        Secant at the depth of the law.
    estimate : ParameterEstimate
        Of the parameters of `model`.
    law_covariance : array, shape (p + P, p + P)
        Of the parameters of `model` and then of the law's shape at its knots.
    hold : Hold
        What the holds say without their ramps.
    soundness : tuple of Soundness
        Of each record under the linear law with the full weight of its ramp.
    followed : Followed
        The optimum of the law, and what it leaves.
    scores : tuple of LawScore
        The laws tried, the linear one first.
    residuals : tuple of array
        Of every sample from contact to the end of the hold, N.
    """

    law: ElasticLaw
    model: GeneralizedMaxwell
    estimate: ParameterEstimate
    law_covariance: FloatArray
    hold: Hold
    soundness: tuple[Soundness, ...]
    followed: Followed
    scores: tuple[LawScore, ...]
    residuals: tuple[FloatArray, ...]

    @property
    def sound(self) -> bool:
        """True if the linear law explains every record to its noise."""
        return all(one.sound for one in self.soundness)

    @property
    def discrepancy(self) -> tuple[float, ...]:
        r"""Scatter of each ramp over that of its hold, :math:`s_r/(s_h \sqrt{\kappa_h})`: >= 1."""
        return tuple(
            float(ramp / held)
            for ramp, held in zip(self.followed.ramp_scatter, independent(self.hold), strict=True)
        )

    @property
    def missed(self) -> tuple[float, ...]:
        """Residual on each ramp as a part of the largest force."""
        rows = self.followed.weighted.solid.rows
        return tuple(one / rows.peak(i) for i, one in enumerate(self.followed.ramp))

    @property
    def rho(self) -> tuple[float, ...]:
        """Residual of each hold over what the hold alone leaves."""
        return tuple(a / b for a, b in zip(self.followed.hold, self.hold.rms, strict=True))

    def tangent_error(self, x: float) -> float:
        """Standard error of the tangent stiffness at a compression x, m, N/m.

        To that of the law's own stiffness and shape are added how far other laws lie that the
        ramps support almost as well, and what a straight tangent between knots leaves of a bent
        one: a sixth of its second difference there, by simulation.
        """
        shape, knots = np.asarray(self.law.shape), np.asarray(self.law.knots)
        parts = np.array([np.interp(x, knots, unit) for unit in np.eye(len(knots))])
        gradient = np.zeros(len(self.law_covariance))
        gradient[0] = parts @ shape
        gradient[-len(knots) :] = self.model.k_inf * parts
        own = next(score for score in self.scores if score.elastic_law.knots == self.law.knots)
        apart = [
            float(score.elastic_law.tangent(x) - own.elastic_law.tangent(x))
            for score in self.scores
            if score.bic < own.bic + LEAST_GAIN
        ]
        variance = gradient @ self.law_covariance @ gradient
        left = self.model.k_inf * float(np.interp(x, knots, _bends(knots, shape))) / 6.0
        return float(np.sqrt(variance + np.max(np.square(apart)) + left**2))


def _bends(knots: FloatArray, shape: FloatArray) -> FloatArray:
    """Second difference of a shape at its knots, that of the nearest at both ends."""
    if len(knots) == 2:
        return np.zeros(2)
    width = np.diff(knots)
    inner = np.abs(np.diff(np.diff(shape) / width)) * 0.5 * (width[1:] + width[:-1])
    return np.concatenate((inner[:1], inner, inner[-1:]))


def ramp_law(
    tests: Sequence[RampHold], *, law: LawName = "auto", arms: int | None = None
) -> RampLaw:
    r"""Return the elastic law that the ramps of tests of one part support.

    Parameters
    ----------
    tests : sequence of RampHold
        Of any depths and ramp rates; they share the law, the stiffnesses and the relaxation
        times, and each has its own offset and drift, bound by
        :func:`~dashpot.fitting.nuisance.priors`. The force is free of hum.
    law : "auto", "linear" or "nonlinear"
        ``"auto"`` keeps the linear law where it is sound, where no other lowers BIC by 10, or
        where none moves the path by 1 % of the depth.
    arms : int, optional
        By default as many as the holds support by BIC, and one faster one if the ramps do.

    Raises
    ------
    FitError
        If a record has no samples on its ramp or in its hold to speak of.
    """
    if law not in ("auto", "linear", "nonlinear"):
        raise FitError(f'law = {law!r}; expected "auto", "linear" or "nonlinear"')
    rows = thinned(tests)
    hold = hold_alone(rows, arms)
    noise = [_noise_of(*pair) for pair in zip(rows.noise, hold.rms, strict=True)]
    soundness, sound = _gate(rows, hold, noise, arms)
    if law != "nonlinear" and all(one.sound for one in soundness):
        score = LawScore(LINEAR, _elastic_law(sound), 0.0, sound.ramp, sound.hold)
        return _described(tests, hold, soundness, sound, (score,))
    shown = int(rows.ramp.sum()) // _ROWS_PER_KNOT
    finer = DEPTHS_LADDER if len(set(rows.depths)) >= _SEVERAL else ()
    bent = [one for one in (*LADDER, *finer) if one.knots <= max(shown, LADDER[0].knots)]
    laws = {"linear": [LINEAR], "nonlinear": bent, "auto": [LINEAR, *bent]}[law]
    start = recorded_hold(rows, hold)
    tried = {one: _followed(rows, one, hold, start) for one in laws}
    scores = _scores(tried, hold)
    taken = _taken(scores) if law == "auto" else min(scores, key=lambda score: score.bic)
    found = _with_delay(tried[taken.law], hold)
    if arms is None:
        found = _with_faster_arm(found, hold)
    return _described(tests, hold, soundness, found, scores)


# -- the gate -------------------------------------------------------------------------------------


def soundness(
    ramp: float,
    hold: float,
    alone: float,
    *,
    noise: float,
    discrepancy: float,
    samples: float,
    peak: float,
) -> Soundness:
    r"""Judge a linear fit by its residuals.

    Parameters
    ----------
    ramp, hold : float
        Root mean square residual of the fit to the whole record, on the ramp and in the hold, N.
    alone : float
        That of a fit to the hold alone, N.
    noise : float
        Standard deviation of the noise of one sample, N.
    discrepancy : float
        :math:`r_r \sqrt{\kappa_r}/(r_h \sqrt{\kappa_h})`, scatter of one independent residual
        of the ramp over one of the hold: a curve below the noise shows in :math:`\kappa_r`.
    samples : float
        Effective number of residuals on the ramp: of few, more is chance.
    peak : float
        Largest force, N.
    """
    floor = NEGLIGIBLE * peak
    by_chance = 1.0 + 3.0 / np.sqrt(2.0 * max(samples, 1.0))
    quiet = ramp <= max(SOUND_RAMP, by_chance) * noise
    straight = discrepancy <= SOUND_SHAPE * by_chance
    followed = (quiet and straight) or ramp <= floor
    sound = bool(followed and (hold <= SOUND_HOLD * alone or hold <= floor))
    return Soundness(ramp / max(noise, 1e-300), hold / max(alone, 1e-300), sound)


def linear_soundness(test: RampHold, whole: FloatArray, alone: FloatArray) -> Soundness:
    """Judge a linear fit that was made elsewhere, by the residuals of every sample.

    Parameters
    ----------
    test : RampHold
    whole : array, shape (n,)
        Residual of the fit to ramp and hold, up to the last sample of the hold, N.
    alone : array, shape (m,)
        Residual of a fit to the hold alone, N.
    """
    corner, onset = relaxes_from(test), int(np.searchsorted(test.time, test.onset))
    held = whole[corner - test.hold.stop :]
    ramp = whole[: -len(held)][onset - corner :]
    # the colour of the noise shows in a stretch of it
    noises = noise_of(ramp), noise_of(alone[: 4 * len(ramp)])
    rms, least = (float(np.sqrt(np.mean(part**2))) for part in (ramp, alone))
    peak = float(np.abs(test.force[: test.hold.stop]).max())
    return soundness(
        rms,
        float(np.sqrt(np.mean(held**2))),
        least,
        noise=_noise_of(test.force_noise, least),
        discrepancy=rms / max(least, 1e-300) * float(np.sqrt(noises[0].kappa / noises[1].kappa)),
        samples=len(ramp) / noises[1].kappa,
        peak=peak,
    )


def _noise_of(scatter: float, rms: float) -> float:
    """Standard deviation of the noise of one sample, N: its scatter, or what its hold leaves.

    What a hold leaves may be a solid that does not fit: it is noise up to twice the scatter.
    """
    return max(scatter, min(rms, 2.0 * scatter)) if scatter > 0 else rms


def _gate(
    rows: Rows, hold: Hold, noise: Sequence[float], arms: int | None
) -> tuple[tuple[Soundness, ...], Followed]:
    """Return how sound the linear law is, the best of the numbers of arms tried."""
    count = len(hold.log_tau)
    tried = []
    for one in (count, count - 1) if arms is None and count > 1 else (count,):
        start = hold if one == count else hold_alone(rows, one)
        found = _joint(rows, hold, start.log_tau, noise)
        judged = tuple(
            soundness(
                found.ramp[i],
                found.hold[i],
                hold.rms[i],
                noise=noise[i],
                discrepancy=found.ramp_scatter[i] / float(independent(hold)[i]),
                samples=float(np.sum(rows.ramp & (rows.record == i))) / hold.correlation[i],
                peak=rows.peak(i),
            )
            for i in range(len(noise))
        )
        tried.append((judged, found))
        if all(at.sound for at in judged):
            break
    sound = [pair for pair in tried if all(at.sound for at in pair[0])]
    return (sound or tried)[0]


def _joint(rows: Rows, hold: Hold, log_tau: FloatArray, noise: Sequence[float]) -> Followed:
    """Fit the linear law to ramp and hold at equal weight, first without, then with a delay."""
    even = np.array(noise) * np.sqrt(hold.correlation)
    solid, bounds = QuasiLinear(rows, LINEAR.at(rows.depth)), tau_bounds(rows)
    sd = spread(rows, even, even)
    first = Weighted(solid, sd, nuisances(rows))
    point = first.descend(log_tau, np.ones(2), bounds)
    late = Weighted(solid, sd, nuisances(rows, -_slope(rows, first.force(point))))
    return measured(late, late.descend(point.log_tau, point.shape, bounds), independent(hold))


def _slope(rows: Rows, force: FloatArray) -> FloatArray:
    """Rate of a force, N/s, record by record."""
    found = np.empty(len(force))
    for i in range(len(rows.depths)):
        here = np.flatnonzero(rows.record == i)
        found[here] = np.gradient(force[here], rows.time[here])
    return found


# -- the ladder -----------------------------------------------------------------------------------


def _followed(rows: Rows, law: Law, hold: Hold, start: Followed) -> Followed:
    solid = QuasiLinear(rows, law.at(rows.depth))
    return follow(solid, hold, start, start.point.log_tau, np.ones(law.knots))


def _scores(tried: dict[Law, Followed], hold: Hold) -> tuple[LawScore, ...]:
    """Return BIC of each law; ramp rows count as the closest of them leaves them correlated."""
    best = min(tried.values(), key=lambda found: float(np.sum(np.log(found.ramp))))
    return tuple(
        LawScore(
            law,
            _elastic_law(found),
            _bic(found, hold, best.ramp_correlation),
            found.ramp,
            found.hold,
        )
        for law, found in tried.items()
    )


def _bic(found: Followed, hold: Hold, correlation: Sequence[float]) -> float:
    r"""Return :math:`\sum m_r \ln r_r^2 + m_h \ln r_h^2 + p \ln \sum m_r`, m = rows / kappa."""
    rows = found.weighted.solid.rows
    total, effective = 0.0, 0.0
    for i, kappa in enumerate(correlation):
        on = float(np.sum(rows.ramp & (rows.record == i))) / kappa
        # a ramp followed closer than its noise is luck
        least = min(rows.noise[i], found.hold[i])
        total += 2.0 * on * float(np.log(max(found.ramp[i], least)))
        total += 2.0 * rows.held(i).sum() / hold.correlation[i] * float(np.log(found.hold[i]))
        effective += on
    knots, arms = len(found.weighted.solid.knots), len(found.point.log_tau)
    delays = len(found.weighted.nuisances.names) - 2 * len(rows.depths)
    free = 2 * arms + (knots - 1 if knots > 2 else 0) + delays
    return float(total + free * np.log(max(effective, 2.0)))


def _elastic_law(found: Followed) -> ElasticLaw:
    knots, shape = found.weighted.solid.knots, found.point.shape
    if len(knots) == 2:
        return ElasticLaw.linear(float(found.point.k[0]), float(knots[-1]))
    return ElasticLaw(tuple(knots.tolist()), tuple(shape.tolist()), float(found.point.k[0]))


def _taken(scores: Sequence[LawScore]) -> LawScore:
    """Return the law of the least BIC if it gains and matters, else the linear one."""
    best = min(scores, key=lambda score: score.bic)
    linear = scores[0]
    worth = linear.bic - best.bic > LEAST_GAIN and best.gap > LEAST_GAP
    return best if worth else linear


def _with_delay(found: Followed, hold: Hold) -> Followed:
    """Return the fit with a delay of each force if the ramps show one."""
    solid, point = found.weighted.solid, found.point
    late = follow(
        solid, hold, found, point.log_tau, point.shape, known=nuisances(solid.rows, _lag(found))
    )
    gain = _bic(found, hold, late.ramp_correlation) - _bic(late, hold, late.ramp_correlation)
    return late if gain > LEAST_GAIN else found


def _lag(found: Followed) -> FloatArray:
    r"""What a delay of one second would do, :math:`-\dot F` of the solid, N/s."""
    solid, point = found.weighted.solid, found.point
    return -_slope(solid.rows, found.weighted.force(point))


def _with_faster_arm(found: Followed, hold: Hold) -> Followed:
    """Return the fit with one more arm if the ramps show one that the holds hardly do."""
    solid, n = found.weighted.solid, len(hold.log_tau)
    rows = solid.rows
    first = rows.ramp & (rows.record == 0)
    ramp = np.log(rows.ends[0] - rows.time[first][0])
    fastest = float(hold.log_tau[0]) if n else float(ramp)
    if fastest - np.log(4.0) <= tau_bounds(rows).low:
        return found
    start = np.concatenate(([fastest - np.log(4.0)], found.point.log_tau))
    tried = found.weighted.descend(start, found.point.shape, tau_bounds(rows))
    fall = found.point.cost - tried.cost
    if tried.log_tau.min() > fastest - np.log(2.0) or fall < LEAST_GAIN:
        return found
    known = found.weighted.nuisances
    more = follow(solid, hold, found, tried.log_tau, tried.shape, known=known)
    faster = float(more.point.log_tau.min()) < fastest - np.log(2.0)
    gain = _bic(found, hold, more.ramp_correlation) - _bic(more, hold, more.ramp_correlation)
    return more if faster and bool((more.point.k[1:] > 0).all()) and gain > LEAST_GAIN else found


# -- the result -----------------------------------------------------------------------------------


def _described(
    tests: Sequence[RampHold],
    hold: Hold,
    soundness: tuple[Soundness, ...],
    found: Followed,
    scores: tuple[LawScore, ...],
) -> RampLaw:
    point, solid = found.point, found.weighted.solid
    order = np.argsort(point.log_tau)
    there = order[point.k[1:][order] > 0]
    model = GeneralizedMaxwell(
        float(point.k[0]),
        tuple(point.k[1:][there].tolist()),
        tuple(np.exp(point.log_tau[there]).tolist()),
    )
    worse = max(1.0, *(a / b for a, b in zip(found.hold, hold.rms, strict=True)))
    covariance = covariance_of(found) * worse**2
    n = len(point.log_tau)
    # each encoder's step scales every stiffness of its test
    doubt = float(np.sqrt(np.mean([test.depth_doubt**2 for test in tests]) / len(tests)))
    covariance[: 1 + n, : 1 + n] += doubt**2 * np.outer(point.k, point.k)
    solid_rows = [0, *(1 + there), *(1 + n + there)]
    own = [*solid_rows, *range(1 + 2 * n, 1 + 2 * n + len(solid.knots))]
    residuals = tuple(_residual(test, i, model, found) for i, test in enumerate(tests))
    noises = [noise_of(one) for one in residuals]
    effective = sum(one.effective for one in noises)
    sse, count = sum(float(one @ one) for one in residuals), sum(len(one) for one in residuals)
    return RampLaw(
        law=_elastic_law(found),
        model=model,
        estimate=ParameterEstimate(
            parameter_names(len(there)),
            covariance[np.ix_(solid_rows, solid_rows)],
            dof=max(effective - len(covariance), 1.0),
            residual=Residual(
                count,
                sse,
                float(np.sqrt(sse / count)),
                count / effective,
                float(np.mean([one.durbin_watson for one in noises])),
            ),
            nuisance=_nuisances(found, covariance, len(tests)),
        ),
        law_covariance=covariance[np.ix_(own, own)],
        hold=hold,
        soundness=soundness,
        followed=found,
        scores=scores,
        residuals=residuals,
    )


def covariance_of(found: Followed) -> FloatArray:
    """Of every stiffness, ln tau, shape and nuisance; zero for what rests at 0, k_inf excepted."""
    solid, point = found.weighted.solid, found.point
    stiff, n, knots = len(point.k), len(point.log_tau), len(solid.knots)
    jacobian = found.weighted.jacobian(point)
    first, bent = stiff + n, knots > 2
    if not bent:
        jacobian = np.insert(jacobian, [first] * 2, 0.0, axis=1)
    free = np.ones(jacobian.shape[1], dtype=bool)
    free[:stiff] = point.k > 0
    free[stiff:first] = (point.k.reshape(-1, 1 + n)[:, 1:] > 0).any(axis=0)
    free[first : first + knots] = bent & (point.shape > 0)
    free[np.arange(0, stiff, 1 + n)] = True
    # the mean of the shape is 1
    gauge = np.zeros((1, jacobian.shape[1]))
    bends = slice(first, first + knots)
    gauge[0, bends] = solid.weights * np.linalg.norm(jacobian[:, bends])
    rows = np.concatenate((jacobian, gauge))[:, free]
    covariance = np.zeros((jacobian.shape[1],) * 2)
    covariance[np.ix_(free, free)] = white(rows, 1.0)
    return covariance


def _residual(test: RampHold, i: int, model: GeneralizedMaxwell, found: Followed) -> FloatArray:
    """Every sample less the model and the load cell."""
    known = found.weighted.solid.rows.known[i]
    path = _elastic_law(found).path(true_motion(test)[0])
    time = test.time[: len(path)] - test.time[0]
    arms = arm_columns(time, path, np.asarray(model.tau), derivative=False)[0]
    values = dict(zip(found.weighted.nuisances.names, found.point.nuisance, strict=True))
    force = model.k_inf * path + arms @ np.asarray(model.k)
    force += values[f"offset@{i}"] + values[f"drift@{i}"] * (time - known.at)
    if f"delay@{i}" in values:
        force -= values[f"delay@{i}"] * np.gradient(force, time)
    return np.asarray((test.force[: len(path)] - force)[known.first :])


def _nuisances(found: Followed, covariance: FloatArray, tests: int) -> tuple[Nuisance, ...]:
    names = found.weighted.nuisances.names
    error = np.sqrt(np.diag(covariance))[-len(names) :]
    listed = []
    for name, value, se in zip(names, found.point.nuisance, error, strict=True):
        kind, _, test = name.partition("@")
        of = f"{kind} of test {int(test) + 1}" if tests > 1 else kind
        listed.append(Nuisance(of, float(value), float(se), _UNITS[kind]))
    return tuple(listed)
