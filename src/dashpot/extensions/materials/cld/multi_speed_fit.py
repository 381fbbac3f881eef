r"""Load deflection at several speeds: one elastic law and one memory under all of them.

The quasi-linear seal of :mod:`~dashpot.extensions.materials.cld.equilibrium_curve` is fitted to the
chosen cycle of each record, its law on hats with tangents >= 0. Within the cycle the plate drives
the seal, :math:`e = F_e(x)`; before it, and in air, the relaxed force that drives is the exact
inverse of the force recorded so far, so that neither the softening of earlier cycles nor a seal
that the plate has left is taken for memory. The law is linear at each trial of g and tau (variable
projection).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, block_means
from dashpot.base.errors import FitError
from dashpot.base.provenance import Step, sources_of
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, OrderScore, Provenance
from dashpot.datamodel.parameter_estimate import ParameterEstimate, Residual, parameter_names
from dashpot.extensions.materials.cld import checks
from dashpot.extensions.materials.cld.datamodel import CLD, SAME_SPEED
from dashpot.extensions.materials.cld.equilibrium_curve import (
    clock_of,
    find_loaded_samples,
    knots_over,
    law_of,
    mean_slope,
)
from dashpot.fitting.fit_construction import SolidEstimate, build_fit
from dashpot.fitting.nonlinear_ramp.quasi_linear import hat_integrals
from dashpot.fitting.nuisance_priors import Prior, taken_later
from dashpot.numerics.design_matrices.recorded_motion import arm_columns, recursion
from dashpot.numerics.inference.covariance_estimate import estimate, score
from dashpot.numerics.least_squares.problem import (
    Optimum,
    Parameter,
    Problem,
    Rows,
    require_optimum,
)
from dashpot.solids.maxwell import GeneralizedMaxwell

KNOTS = 13
MOST_ARMS = 3
_PER_STROKE = 120
_FALLS = 0.98
"""Part of the residual above which a further arm, and any after it, is not worth trying."""
DECISIVE = 10.0
"""By so much a further arm lowers BIC."""
_TELLS = 3.0
"""Standard errors of a delay from which on a record is taken to have one."""
_SMALLEST, _LARGEST = 1e-3, 20.0
"""Of g."""


class DownsampledRecord(NamedTuple):
    """A record thinned, to the end of the chosen cycle; hats of the samples where it is felt."""

    time: FloatArray
    compression: FloatArray
    velocity: FloatArray
    force: FloatArray
    felt: BoolArray
    first: int
    hats: FloatArray


def fit_speeds(pieces: Sequence[CLD], *, arms: int | Literal["auto"] = "auto") -> Fit:
    """Fit elastic law and memory to load deflection tests of one seal at two or more speeds.

    Parameters
    ----------
    pieces : sequence of CLD
        With clocks; of one piece, or of pieces that are one.
    arms : int or "auto"
        ``"auto"`` takes as many, up to three, as lower BIC by ten each.

    Returns
    -------
    Fit
        Its solid is the secant one at the least depth of the chosen cycles.

    Raises
    ------
    FitError
        If there is no clock, or one speed alone.
    """
    speeds = [one.cycle.speed for one in pieces if clock_of(one).size and one.cycle.speed]
    if len(speeds) < 2 or max(speeds) < SAME_SPEED * min(speeds):
        raise FitError(
            "one speed alone cannot separate memory from an elastic law; expected tests at two or "
            "more, a decade apart or farther"
        )
    knots, records = thinned_alike(pieces)
    strokes = [one.cycle.depth / speed for one, speed in zip(pieces, speeds, strict=True)]
    window = min(strokes) / 20, 3 * max(strokes)
    counts = range(MOST_ARMS + 1) if arms == "auto" else [arms]
    tried = _fit_arm_counts(records, window, counts)
    delays = _delays(pieces, records, knots, tried[-1])
    if any(abs(one.mean) > _TELLS * one.sd for one in delays):
        records = [
            _taken_later(record, one, knots, delay.mean)
            for record, one, delay in zip(records, pieces, delays, strict=True)
        ]
        tried = _fit_arm_counts(records, window, counts)
    # what is left of too few arms is no noise: all are weighed by that of the most
    effective = estimate(tried[-1], parts=_parts(records)).effective
    scores = [score(one, effective) for one in tried]
    best = _select_supported_memory(records, knots, tried, scores)
    orders = tuple(
        OrderScore(len(one.theta) // 2, one.sse, bic, number <= best, _model(knots, one))
        for number, (bic, one) in enumerate(zip(scores, tried, strict=True))
    )
    return _build_fit(
        pieces, records, tried[best], knots=knots, strokes=strokes, orders=orders, delays=delays
    )


def _taken_later(
    record: DownsampledRecord, one: CLD, knots: FloatArray, by: float
) -> DownsampledRecord:
    """A record whose force comes so much later, s, and shows its first contact so much deeper."""
    hats = downsample_record(one, knots, off=-by * (one.cycle.speed or 0.0)).hats
    return record._replace(force=taken_later(record.time, record.force, by), hats=hats)


def _change(
    records: Sequence[DownsampledRecord], index: int, other: DownsampledRecord, best: Optimum
) -> FloatArray:
    """What another record in the place of one makes of the rows."""
    rows = _rows([*records[:index], other, *records[index + 1 :]], best.theta)
    return rows.A @ best.beta - rows.y + best.all_residuals


def _delays(
    pieces: Sequence[CLD], records: Sequence[DownsampledRecord], knots: FloatArray, best: Optimum
) -> list[Prior]:
    r"""By how much each force must come later for one memory, s, as the records tell it.

    Of a delay with prior standard deviation s, whose change of the rows beyond all parameters is d,
    the mean is :math:`s\,d \cdot r/(d \cdot d + \gamma)` and the variance
    :math:`s^2 \gamma/(d \cdot d + \gamma)`, with the residual r and its power.
    """
    power = best.sse / len(best.residual) * estimate(best, parts=_parts(records)).kappa
    J = best.jacobian[:, best.free]
    found = []
    for i, one in enumerate(pieces):
        change = _change(records, i, _taken_later(records[i], one, knots, one.delay_sd), best)
        own = change - J @ np.linalg.lstsq(J, change, rcond=1e-12)[0]
        gain = float(own @ own) + power
        mean, part = float(own @ best.all_residuals) / gain, float(np.sqrt(power / gain))
        found.append(Prior(one.delay_sd * mean, one.delay_sd * part))
    return found


def _fit_arm_counts(
    records: Sequence[DownsampledRecord], window: tuple[float, float], counts: Sequence[int]
) -> list[Optimum]:
    """The best memory of each number of arms, up to the first that is not worth trying."""
    tried: list[Optimum] = []
    for count in counts:
        tried.append(_best(records, count, window, tried[-1].theta if tried else None))
        if len(tried) > 1 and tried[-1].sse > _FALLS**2 * tried[-2].sse:
            break
    return tried


def _select_supported_memory(
    records: Sequence[DownsampledRecord],
    knots: FloatArray,
    tried: Sequence[Optimum],
    scores: Sequence[float],
) -> int:
    """The last memory that lowers BIC decisively and whose arms are all known; else the first."""
    for i in range(len(tried) - 1, 0, -1):
        if scores[i - 1] - scores[i] >= DECISIVE and _has_determined_arms(records, knots, tried[i]):
            return i
    return 0


def thinned_alike(pieces: Sequence[CLD]) -> tuple[FloatArray, list[DownsampledRecord]]:
    """Return the knots of a law to the least depth of tests, m, and their records to it."""
    pressed = np.concatenate([one.compression[find_loaded_samples(one)] for one in pieces])
    knots = knots_over(pressed, min(one.cycle.depth for one in pieces), KNOTS)
    return knots, [downsample_record(one, knots) for one in pieces]


def _has_determined_arms(
    records: Sequence[DownsampledRecord], knots: FloatArray, best: Optimum
) -> bool:
    """Whether every arm is worth three of its errors, and its time is known to a half."""
    arms = len(best.theta) // 2
    found = estimate(best, parts=_parts(records)).derive_quantity(partial(_seal, knots))
    k, error = found.values[1 : 1 + arms], found.standard_error[1:]
    return bool((k > 3 * error[:arms]).all() and (error[arms : 2 * arms] < checks.TOLD).all())


def downsample_record(one: CLD, knots: FloatArray, *, off: float = 0.0) -> DownsampledRecord:
    """Means of neighbours, so that a stroke of the chosen cycle has some hundred rows."""
    last = one.unloading or one.loading
    stop = last.samples.stop
    rows = np.zeros(len(one.force), dtype=bool)
    rows[find_loaded_samples(one)] = True
    rows &= one.compression <= 1.005 * knots[-1]
    block = max(1, len(one.loading.force) // _PER_STROKE)
    clock = clock_of(one)
    time, x, velocity, force, share = (
        block_means(np.asarray(each[:stop], dtype=float), block)
        for each in (clock, one.compression, np.gradient(one.compression, clock), one.force, rows)
    )
    pressed = share == 1.0  # a block that holds a turning point is not taken
    first = min(int(np.flatnonzero(pressed)[0]), one.loading.samples.start // block)
    hats = np.where(pressed[:, None], hat_integrals(x + off, knots), 0.0)
    return DownsampledRecord(time, x, velocity, force, pressed, first, hats[first:])


def _memory(theta: FloatArray) -> GeneralizedMaxwell:
    g, tau = np.exp(theta).reshape(2, -1)
    return GeneralizedMaxwell(1.0, tuple(g.tolist()), tuple(tau.tolist()))


def _parts(records: Sequence[DownsampledRecord]) -> list[int]:
    """Rows of each record."""
    return [int(one.felt[one.first :].sum()) for one in records]


def _rows(records: Sequence[DownsampledRecord], theta: FloatArray) -> Rows:
    """The records for a memory, g, then tau, by their logarithms; tangents are linear."""
    memory = _memory(theta)
    columns, targets = [], []
    for one in records:
        # where the plate does not drive it, the seal is where the recorded force has brought it
        known = np.where(one.felt, 0.0, memory.displacement(one.time, one.force))
        answer, hats = known.copy(), one.hats.copy()
        moved = np.diff(one.hats, axis=0)
        step = np.diff(one.time[one.first :])[:, None, None]
        g, tau = np.asarray(memory.k), np.asarray(memory.tau)
        if len(tau):
            answer += arm_columns(one.time, known, tau, derivative=False)[0] @ g
            # every hat under every arm side by side
            z = step / tau[:, None]
            lost = np.expm1(-z)
            first = np.tile(one.hats[0], (len(tau), 1))
            arms = recursion(1 + lost, -lost / z * moved[:, None], first)
            hats += np.einsum("nap,a->np", arms, g)
        inside = one.felt[one.first :]
        columns.append(hats[inside])
        targets.append((one.force - answer)[one.first :][inside])
    return Rows(np.concatenate(targets), np.concatenate(columns))


def _best(
    records: Sequence[DownsampledRecord],
    arms: int,
    window: tuple[float, float],
    before: FloatArray | None,
) -> Optimum:
    """Return the best memory of so many arms, from that of one fewer and one at three places."""
    low, high = np.log(window).tolist()
    problem = Problem(
        partial(_rows, records),
        [Parameter(float(np.log(_SMALLEST)), float(np.log(_LARGEST)))] * arms
        + [Parameter(low - 1, high + 1)] * arms,
        positive=True,
    )
    if arms == 0:
        return require_optimum(problem)
    known = np.empty((2, 0)) if before is None else before.reshape(2, -1)
    places = np.linspace(low, high, 5)[1:-1]
    if known.shape[1] + 1 < arms:  # a number that was asked for
        known = np.array([np.full(arms - 1, np.log(0.2)), np.linspace(low, high, arms + 1)[1:-1]])
    starts = [np.column_stack((known, [np.log(0.15), place])).ravel() for place in places.tolist()]
    start = min(starts, key=lambda one: problem.at(one).cost)
    best = require_optimum(problem, [start], most=40, finished=1e-5, flat=1e-6)
    g, tau = best.theta.reshape(2, -1)
    order = np.argsort(tau)
    return replace(problem.at(np.concatenate((g[order], tau[order]))), stationary=best.stationary)


def _seal(knots: FloatArray, values: FloatArray) -> FloatArray:
    """K_inf, k, N/m, and ln tau of a memory and tangents."""
    theta, slope = np.split(values, [-len(knots)])
    k_inf = mean_slope(slope, knots)
    g, ln_tau = np.split(theta, 2)
    return np.concatenate(([k_inf], np.exp(g) * k_inf, ln_tau))


def _model(knots: FloatArray, best: Optimum) -> GeneralizedMaxwell:
    return _memory(best.theta) * mean_slope(best.beta, knots)


def _build_fit(
    pieces: Sequence[CLD],
    records: Sequence[DownsampledRecord],
    best: Optimum,
    *,
    knots: FloatArray,
    strokes: Sequence[float],
    orders: tuple[OrderScore, ...],
    delays: Sequence[Prior],
) -> Fit:
    model, n = _model(knots, best), len(best.residual)
    known = estimate(best, parts=_parts(records))
    # beside the noise, what both zeros and the clock leave unknown: a record with one of them an
    # error off
    for i, one in enumerate(pieces):
        by = downsample_record(one, knots, off=one.contact_se)
        weighed = records[i]._replace(force=records[i].force + one.zero_se)
        late = _taken_later(records[i], one, knots, delays[i].sd)
        for off in (by, weighed, late):
            known = known.add_parameter_error(
                known.estimate_parameter_shift(_change(records, i, off, best))
            )
    covariance = known.derive_quantity(partial(_seal, knots)).covariance
    rms = float(np.sqrt(best.sse / n))
    peak = max(one.cycle.peak for one in pieces)
    law = law_of(known, knots, slice(-len(knots), None))
    error = np.sqrt(np.diag(covariance))[1 + model.arms :]
    speeds = [one.cycle.speed or np.nan for one in pieces]
    asked = (
        checks.speeds_spread(max(speeds) / min(speeds)),
        checks.speeds_followed(rms, max(one.noise for one in pieces), peak),
        checks.slowest_relaxed(max(model.tau, default=None), max(strokes)),
        checks.memory_told(float(error.max()) if model.arms else None),
    )
    step = Step(
        "fit",
        (("arms", str(model.arms)), ("knots", str(len(knots)))),
        f"fitted an elastic law and {model.arms} arms to load deflection at {len(pieces)} speeds",
    )
    told = ParameterEstimate(
        parameter_names(model.arms), covariance, known.dof, Residual(n, best.sse, rms, known.kappa)
    )
    band = 1 / (2 * np.pi * max(strokes)), 1 / (np.pi * min(strokes))
    return build_fit(
        SolidEstimate(model, told),
        Evidence(band, orders, checks=asked),
        Provenance("cld", sources_of(pieces), (step,), pieces[0].specimen),
        elastic_law=law,
    )
