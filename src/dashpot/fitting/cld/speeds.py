r"""Load deflection at several speeds: one elastic law and one memory under all of them.

The quasi-linear seal of :mod:`~dashpot.fitting.cld.relaxed` is fitted to the chosen cycle of each
record, its law on hats with tangents >= 0. Within the cycle the plate drives the seal,
:math:`e = F_e(x)`; before it, and in air, the relaxed force that drives is the exact inverse of the
force recorded so far, so that neither the softening of earlier cycles nor a seal that the plate has
left is taken for memory. The law is linear at each trial of g and tau (variable projection).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, block_means
from dashpot.base.errors import FitError
from dashpot.base.provenance import Step, sources_of
from dashpot.engine.blocks.recorded import arm_columns, recursion
from dashpot.engine.least_squares.nnls import nonnegative
from dashpot.fitting.cld import checks
from dashpot.fitting.cld.relaxed import clock_of, felt
from dashpot.fitting.nonlinear_ramp.quasi_linear import hat_integrals
from dashpot.fitting.pipeline import ended
from dashpot.records.cld import CLD
from dashpot.records.estimate import ParameterEstimate, Residual, parameter_names
from dashpot.records.fit import Evidence, Fit, OrderScore, Provenance
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

KNOTS = 13
MOST_ARMS = 3
SAME_SPEED = 1.5
"""Factor within which two speeds are one."""
_PER_STROKE = 120
_FALLS = 0.98
"""Part of the residual above which a further arm, and any after it, is not worth trying."""
_DECISIVE = 10.0
"""By so much a further arm lowers BIC."""
_DESCENTS = 1
"""From the best of the starts."""
_SMALLEST, _LARGEST = 1e-3, 20.0
"""Of g."""


class Thinned(NamedTuple):
    """A record thinned, to the end of the chosen cycle; hats of the samples where it is felt."""

    time: FloatArray
    compression: FloatArray
    velocity: FloatArray
    force: FloatArray
    felt: BoolArray
    first: int
    hats: FloatArray


class _Solved(NamedTuple):
    """The law at some memory, and what it leaves, N, record after record."""

    slope: FloatArray
    residual: FloatArray
    columns: FloatArray


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
            "one speed alone tells no memory from an elastic law; expected tests at two or more, "
            "a decade apart or farther"
        )
    depth, records = thinned_alike(pieces)
    strokes = [one.cycle.depth / speed for one, speed in zip(pieces, speeds, strict=True)]
    window = min(strokes) / 20, 3 * max(strokes)
    tried = _tried(records, window, range(MOST_ARMS + 1) if arms == "auto" else [arms])
    # what is left of too few arms is no noise: all are weighed by that of the most
    kappa = correlation(tried[-1][1].residual)
    scores = [_bic(left, len(theta) + KNOTS, kappa) for theta, left in tried]
    best = _supported(records, tried, scores)
    theta, solved = tried[best]
    orders = tuple(
        OrderScore(len(one) // 2, float(left.residual @ left.residual), bic, number <= best,
                   _model(one, left))
        for number, (bic, (one, left)) in enumerate(zip(scores, tried, strict=True))
    )  # fmt: skip
    return _assembled(pieces, records, theta, solved, depth=depth, strokes=strokes, orders=orders)


def _tried(
    records: Sequence[Thinned], window: tuple[float, float], counts: Sequence[int]
) -> list[tuple[FloatArray, _Solved]]:
    """The best memory of each number of arms, up to the first that is not worth trying."""
    tried: list[tuple[FloatArray, _Solved]] = []
    for count in counts:
        theta = _descended(records, count, window, tried[-1][0] if tried else None)
        tried.append((theta, _solve(records, theta)))
        if len(tried) > 1 and _rms(tried[-1][1]) > _FALLS * _rms(tried[-2][1]):
            break
    return tried


def _supported(
    records: Sequence[Thinned],
    tried: Sequence[tuple[FloatArray, _Solved]],
    scores: Sequence[float],
) -> int:
    """The last memory that lowers BIC decisively and whose arms are all known; else the first."""
    for i in range(len(tried) - 1, 0, -1):
        if scores[i - 1] - scores[i] >= _DECISIVE and _told(records, *tried[i]):
            return i
    return 0


def thinned_alike(pieces: Sequence[CLD]) -> tuple[float, list[Thinned]]:
    """Return the least depth of tests, m, and their records to it."""
    depth = min(one.cycle.depth for one in pieces)
    return depth, [thinned(one, depth) for one in pieces]


def _told(records: Sequence[Thinned], theta: FloatArray, solved: _Solved) -> bool:
    """Whether every arm is worth three of its errors, and its time is known to a half."""
    arms = len(theta) // 2
    covariance, _ = _covariance(records, theta, solved)
    error = np.sqrt(np.diag(covariance))[1:]
    k = np.exp(theta[:arms]) * mean_slope(solved.slope)
    return bool((k > 3 * error[:arms]).all() and (error[arms:] < checks.TOLD).all())


def thinned(one: CLD, depth: float, *, off: float = 0.0) -> Thinned:
    """Means of neighbours, so that a stroke of the chosen cycle has some hundred rows."""
    last = one.unloading or one.loading
    stop = last.samples.stop
    rows = np.zeros(len(one.force), dtype=bool)
    rows[felt(one)] = True
    rows &= one.compression <= 1.005 * depth
    block = max(1, len(one.loading.force) // _PER_STROKE)
    clock = clock_of(one)
    time, x, velocity, force, share = (
        block_means(np.asarray(each[:stop], dtype=float), block)
        for each in (clock, one.compression, np.gradient(one.compression, clock), one.force, rows)
    )
    pressed = share == 1.0  # a block that holds a turning point is not taken
    first = min(int(np.flatnonzero(pressed)[0]), one.loading.samples.start // block)
    hats = np.where(pressed[:, None], hat_integrals(x + off, np.linspace(0.0, depth, KNOTS)), 0.0)
    return Thinned(time, x, velocity, force, pressed, first, hats[first:])


def _memory(theta: FloatArray) -> GeneralizedMaxwell:
    g, tau = np.exp(theta).reshape(2, -1)
    return GeneralizedMaxwell(1.0, tuple(g.tolist()), tuple(tau.tolist()))


def _solve(records: Sequence[Thinned], theta: FloatArray) -> _Solved:
    """Return the law for a memory: g, then tau, by their logarithms."""
    memory = _memory(theta)
    columns, targets = [], []
    for one in records:
        # where the plate does not drive it, the seal is where the recorded force has brought it
        known = np.where(one.felt, 0.0, memory.displacement(one.time, one.force))
        answer, hats = known.copy(), one.hats.copy()
        moved = np.diff(one.hats, axis=0)
        step = np.diff(one.time[one.first :])[:, None]
        g, tau = np.asarray(memory.k), np.asarray(memory.tau)
        if len(tau):
            answer += arm_columns(one.time, known, tau, derivative=False)[0] @ g
            # every hat under every arm side by side
            z = step / np.repeat(tau, KNOTS)
            lost, every = np.expm1(-z), np.tile(moved, len(tau))
            arms = recursion(1 + lost, -lost / z * every, np.tile(one.hats[0], len(tau)))
            hats += np.einsum("nap,a->np", arms.reshape(len(hats), len(tau), KNOTS), g)
        inside = one.felt[one.first :]
        columns.append(hats[inside])
        targets.append((one.force - answer)[one.first :][inside])
    A, y = np.concatenate(columns), np.concatenate(targets)
    size = np.maximum(np.linalg.norm(A, axis=0), 1e-300)
    slope = nonnegative((A / size).T @ (A / size), (A / size).T @ y) / size
    return _Solved(slope, y - A @ slope, A)


def _descended(
    records: Sequence[Thinned],
    arms: int,
    window: tuple[float, float],
    before: FloatArray | None,
) -> FloatArray:
    """Return the best memory of so many arms, from that of one fewer and one at three places."""
    if arms == 0:
        return np.empty(0)
    from scipy.optimize import least_squares  # few need it, and it costs time to import

    known = np.empty((2, 0)) if before is None else before.reshape(2, -1)
    low, high = np.log(window)
    places = np.linspace(low, high, 5)[1:-1]
    if known.shape[1] + 1 < arms:  # a number that was asked for
        known = np.array([np.full(arms - 1, np.log(0.2)), np.linspace(low, high, arms + 1)[1:-1]])
    ends = (
        np.repeat([np.log(_SMALLEST), low - 1], arms),
        np.repeat([np.log(_LARGEST), high + 1], arms),
    )

    def left(theta: FloatArray) -> FloatArray:
        return _solve(records, theta).residual

    starts = [np.column_stack((known, [np.log(0.15), place])).ravel() for place in places.tolist()]
    costs = [float(np.sum(left(start) ** 2)) for start in starts]
    found = [
        least_squares(
            left,
            np.clip(starts[i], ends[0] + 1e-6, ends[1] - 1e-6),
            bounds=ends, xtol=1e-5, ftol=1e-6, max_nfev=40,
        )
        for i in np.argsort(costs)[:_DESCENTS]
    ]  # fmt: skip
    best = min(found, key=lambda one: float(one.cost))
    g, tau = best.x.reshape(2, -1)
    order = np.argsort(tau)
    return np.concatenate((g[order], tau[order]))


def _rms(solved: _Solved) -> float:
    return float(np.sqrt(np.mean(solved.residual**2)))


def correlation(residual: FloatArray) -> float:
    """Return how many neighbours of a residual say the same."""
    power = float(residual @ residual)
    rho = float(residual[1:] @ residual[:-1]) / power if power > 0 else 0.0
    rho = min(max(rho, 0.0), 0.98)
    return (1 + rho) / (1 - rho)


def _bic(solved: _Solved, parameters: int, kappa: float) -> float:
    n = len(solved.residual) / kappa
    return n * float(np.log(np.mean(solved.residual**2))) + parameters * float(np.log(n))


def mean_slope(slope: FloatArray) -> float:
    """Return the mean slope of a law on even knots, N/m."""
    return float(np.trapezoid(slope) / (len(slope) - 1))


def _model(theta: FloatArray, solved: _Solved) -> GeneralizedMaxwell:
    return _memory(theta) * mean_slope(solved.slope)


def _assembled(
    pieces: Sequence[CLD],
    records: Sequence[Thinned],
    theta: FloatArray,
    solved: _Solved,
    *,
    depth: float,
    strokes: Sequence[float],
    orders: tuple[OrderScore, ...],
) -> Fit:
    model, k_inf = _model(theta, solved), mean_slope(solved.slope)
    kappa, n = correlation(solved.residual), len(solved.residual)
    shifted = [
        [*records[:i], thinned(one, depth, off=one.contact_se), *records[i + 1 :]]
        for i, one in enumerate(pieces)
    ]
    covariance, shape_se = _covariance(records, theta, solved, shifted)
    rms = _rms(solved)
    peak = max(one.cycle.peak for one in pieces)
    law = ElasticLaw(
        tuple(np.linspace(0.0, depth, KNOTS).tolist()),
        tuple((solved.slope / k_inf).tolist()),
        k_inf,
        tuple((shape_se / k_inf).tolist()),
    )
    error = np.sqrt(np.diag(covariance))[1 + model.arms :]
    speeds = [one.cycle.speed or np.nan for one in pieces]
    asked = (
        checks.speeds_spread(max(speeds) / min(speeds)),
        checks.speeds_followed(rms, max(one.noise for one in pieces), peak),
        checks.slowest_relaxed(max(model.tau, default=None), max(strokes)),
        checks.memory_told(float(error.max()) if model.arms else None),
    )
    failed = {check.name for check in asked if check.failed}
    step = Step(
        "fit",
        (("arms", str(model.arms)), ("knots", str(KNOTS))),
        f"fitted an elastic law and {model.arms} arms to load deflection at {len(pieces)} speeds",
    )
    dof = max(n / kappa - len(theta) - KNOTS, 1.0)
    return Fit(
        solid=model,
        status=ended(stationary=True, fewer=False, at_bound=False,
                     identified="memory_told" not in failed, agreed=True),
        estimate=ParameterEstimate(
            parameter_names(model.arms), covariance, dof,
            Residual(n, float(solved.residual @ solved.residual), rms, kappa),
        ),
        evidence=Evidence(
            (1 / (2 * np.pi * max(strokes)), 1 / (np.pi * min(strokes))), orders, checks=asked
        ),
        provenance=Provenance("cld", sources_of(pieces), (step,), pieces[0].specimen),
        elastic_law=law,
    )  # fmt: skip


def _covariance(
    records: Sequence[Thinned],
    theta: FloatArray,
    solved: _Solved,
    shifted: Sequence[Sequence[Thinned]] = (),
) -> tuple[FloatArray, FloatArray]:
    r"""Covariance of k_inf, k and ln tau, and standard errors of the law's tangents, N/m.

    Of the memory by the projected residual's derivatives, taken by differences; of the law at a
    given memory by its columns; :math:`k_j = g_j k_\infty`. Beside the noise, what each first
    contact leaves unknown: `shifted` are the records with one of them a standard error off.
    """
    kappa = correlation(solved.residual)
    noise = kappa * float(np.mean(solved.residual**2))
    used = solved.slope > 0
    inner = np.zeros((KNOTS, KNOTS))
    A = solved.columns[:, used]
    inner[np.ix_(used, used)] = noise * np.linalg.pinv(A.T @ A)
    count = len(theta)
    moved = [_solve(records, theta + 1e-4 * np.eye(count)[i]) for i in range(count)]
    left = [(one.residual - solved.residual) / 1e-4 for one in moved]
    jacobian = np.array(left).reshape(count, len(solved.residual))
    slopes = np.array([(one.slope - solved.slope) / 1e-4 for one in moved]).reshape(count, KNOTS)
    outer = noise * np.linalg.pinv(jacobian @ jacobian.T) if count else np.zeros((0, 0))
    tangents = inner + slopes.T @ outer @ slopes
    weight = np.ones(KNOTS) / (KNOTS - 1)
    weight[[0, -1]] /= 2
    whole = np.zeros((1 + count, 1 + count))
    whole[0, 0] = weight @ tangents @ weight
    whole[0, 1:] = whole[1:, 0] = (slopes @ weight) @ outer
    whole[1:, 1:] = outer
    for each in shifted:
        other = _solve(each, theta)
        by = -outer @ jacobian @ (other.residual - solved.residual) / noise
        bent = other.slope - solved.slope + by @ slopes
        tangents += np.outer(bent, bent)
        change = np.concatenate(([weight @ bent], by))
        whole += np.outer(change, change)
    g, arms, k_inf = np.exp(theta[: count // 2]), count // 2, mean_slope(solved.slope)
    turn = np.eye(1 + count)
    turn[1 : 1 + arms, 0] = g
    turn[np.arange(1, 1 + arms), np.arange(1, 1 + arms)] = g * k_inf
    return turn @ whole @ turn.T, np.sqrt(np.maximum(np.diag(tangents), 0.0))
