r"""Load deflection at several speeds: a spring and a dashpot that depend on compression, and arms.

.. math:: F = F_e(x) + c(x)\,\dot x + \sum_j k_j \int_0^t e^{-(t-u)/\tau_j}\,dx(u)

The arms are those of a linear solid, which one memory under a bent law
(:mod:`~dashpot.fitting.cld.speeds`) are not; which of the two the speeds prefer BIC says. At given
relaxation times all is linear: tangents of :math:`F_e` on hats, c on hats, k, each >= 0.
Source: E. Dikmen and I. Basdogan, ESDA2006-95402.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.engine.blocks.recorded import arm_columns
from dashpot.engine.least_squares.nnls import nonnegative
from dashpot.fitting.cld import checks
from dashpot.fitting.cld.speeds import KNOTS, Thinned, correlation, mean_slope, thinned_alike
from dashpot.fitting.nonlinear_ramp.quasi_linear import hat_integrals
from dashpot.records.cld import CLD, RateLaw
from dashpot.records.fit import Fit
from dashpot.solids.elastic import ElasticLaw

DAMPING_KNOTS = 7
MOST_ARMS = 2
_DECISIVE = 10.0
_CONTACT = 0.01
"""Standard deviation of first contact, as a part of the depth: a dashpot's force jumps there."""


class _Data(NamedTuple):
    """Records, the knots of c and of the law, the depth, m, and the noise, N."""

    records: Sequence[Thinned]
    knots: FloatArray
    fine: FloatArray
    depth: float
    noise: float


class _Solved(NamedTuple):
    """All coefficients at some ln tau and contacts, and what they leave, N, record after record."""

    theta: FloatArray
    found: FloatArray
    residual: FloatArray
    columns: FloatArray
    slopes: FloatArray
    shifts: FloatArray

    @property
    def arms(self) -> FloatArray:
        """K of the arms."""
        return self.found[KNOTS + DAMPING_KNOTS :]

    @property
    def parameters(self) -> int:
        """Of the law."""
        return int(self.columns.shape[1]) + len(self.theta)


def fit_rate(pieces: Sequence[CLD], beside: Fit) -> RateLaw:
    """Fit a rate-dependent spring and dashpot to load deflection tests of one seal at some speeds.

    Parameters
    ----------
    pieces : sequence of CLD
        With clocks, at two speeds or more.
    beside : Fit
        One law with one memory, as :func:`~dashpot.fitting.cld.speeds.fit_speeds` fits it to the
        same tests.
    """
    depth, records = thinned_alike(pieces)
    strokes = [one.cycle.depth / one.cycle.speed for one in pieces if one.cycle.speed]
    window = np.log([min(strokes) / 20, 3 * max(strokes)])
    of = _Data(
        records, np.linspace(0.0, depth, DAMPING_KNOTS), np.linspace(0.0, depth, KNOTS), depth,
        max(one.noise for one in pieces),
    )  # fmt: skip
    tried = [_descended(of, np.zeros(len(records)), None)]
    for _ in range(MOST_ARMS):
        tried.append(_descended(of, tried[-1].theta, window))
    kappa = correlation(tried[-1].residual)
    scores = [_bic(_power(one), one.parameters, len(one.residual) / kappa) for one in tried]
    best = 0
    while best + 1 < len(tried) and scores[best] - scores[best + 1] >= _DECISIVE:
        best += 1
    return _assembled(pieces, beside, of, tried[best])


def _power(one: _Solved) -> float:
    return float(one.residual @ one.residual)


def _bic(power: float, parameters: int, effective: float) -> float:
    return effective * float(np.log(max(power, 1e-300))) + parameters * float(np.log(effective))


def _hats(x: FloatArray, knots: FloatArray) -> FloatArray:
    """A straight line between knots as weights of its values there, shape (n, knots)."""
    return np.stack([np.interp(x, knots, one) for one in np.eye(len(knots))], axis=1)


def _solve(of: _Data, theta: FloatArray) -> _Solved:
    """The law at relaxation times and at places of first contact, by variable projection."""
    ln_tau, off = theta[: -len(of.records)], theta[-len(of.records) :]
    parts, slopes, moves, targets = [], [], [], []
    for one, by in zip(of.records, off, strict=True):
        inside = _moving(one)
        x, v = one.compression[inside] + by, one.velocity[inside]
        weights = _hats(x, of.knots)
        q, slope = np.empty((len(one.time), 0)), np.empty((len(one.time), 0))
        if len(ln_tau):
            q, slope = arm_columns(one.time, np.maximum(one.compression + by, 0.0), np.exp(ln_tau))
        parts.append(
            np.concatenate((hat_integrals(x, of.fine), weights * v[:, None], q[inside]), 1)
        )
        slopes.append(slope[inside])
        moves.append((x, v))
        targets.append(one.force[inside])
    A, y = np.concatenate(parts), np.concatenate(targets)
    size = np.maximum(np.linalg.norm(A, axis=0), 1e-300)
    found = nonnegative((A / size).T @ (A / size), (A / size).T @ y) / size
    tangent, c = found[:KNOTS], found[KNOTS : KNOTS + DAMPING_KNOTS]
    bend = np.gradient(c, of.knots)
    shifts = np.zeros((len(y), len(off)))
    first = 0
    for number, (x, v) in enumerate(moves):
        rows = slice(first, first + len(x))
        shifts[rows, number] = np.interp(x, of.fine, tangent) + v * np.interp(x, of.knots, bend)
        first = rows.stop
    return _Solved(theta, found, y - A @ found, A, np.concatenate(slopes), shifts)


def _moving(one: Thinned) -> BoolArray:
    """The samples of the chosen cycle that are felt, but for those beside a turn."""
    way = np.sign(one.velocity)
    steady = (way == np.roll(way, 1)) & (way == np.roll(way, -1))
    found = np.asarray(one.felt & steady)
    found[: one.first] = False
    return found


def _descended(of: _Data, before: FloatArray, window: FloatArray | None) -> _Solved:
    """The best from what was found, with one arm more at the best of some places in a window."""
    from scipy.optimize import least_squares  # few need it, and it costs time to import

    def left(theta: FloatArray) -> FloatArray:
        off = theta[-len(of.records) :] * _CONTACT * of.depth
        solved = _solve(of, np.append(theta[: -len(of.records)], off))
        return np.append(solved.residual, of.noise * theta[-len(of.records) :])

    here = before.copy()
    here[-len(of.records) :] /= _CONTACT * of.depth
    starts = [here]
    if window is not None:
        starts = [np.insert(here, 0, place) for place in np.linspace(window[0], window[1], 7)[1:-1]]
    first = min(starts, key=lambda one: float(np.sum(left(one) ** 2)))
    solved = least_squares(left, first, x_scale=1.0, xtol=1e-6, ftol=1e-8, max_nfev=40)
    found = np.asarray(solved.x)
    found[-len(of.records) :] *= _CONTACT * of.depth
    return _solve(of, found)


def _assembled(pieces: Sequence[CLD], beside: Fit, of: _Data, solved: _Solved) -> RateLaw:
    error = np.sqrt(np.maximum(np.diag(_covariance(of, solved)), 0.0))
    slope, c = solved.found[:KNOTS], solved.found[KNOTS : KNOTS + DAMPING_KNOTS]
    tau = np.exp(solved.theta[: len(solved.arms)])
    kept = [int(i) for i in np.argsort(tau) if solved.arms[i] > 0]
    k_e = mean_slope(slope)
    n = len(solved.residual)
    rms = float(np.sqrt(_power(solved) / n))
    kappa = min(
        (_power(solved), correlation(solved.residual)), (beside.residual.sse, beside.residual.kappa)
    )[1]
    own = _bic(_power(solved), solved.parameters, n / kappa)
    other = _bic(beside.residual.sse, KNOTS + 2 * beside.model.arms, n / kappa)
    law = ElasticLaw(
        tuple(of.fine.tolist()),
        tuple((slope / k_e).tolist()),
        k_e,
        tuple((error[:KNOTS] / k_e).tolist()),
    )
    count, arms = KNOTS + DAMPING_KNOTS, len(solved.arms)
    return RateLaw(
        law,
        tuple(of.knots.tolist()),
        tuple(c.tolist()),
        tuple(error[KNOTS:count].tolist()),
        tuple(float(solved.arms[i]) for i in kept),
        tuple(float(tau[i]) for i in kept),
        tuple(float(error[count + i]) for i in kept),
        tuple(float(error[count + arms + i]) for i in kept),
        rms,
        own - other,
        (
            checks.memory_suffices(other - own),
            checks.speeds_followed(rms, of.noise, max(one.cycle.peak for one in pieces)),
        ),
    )


def _covariance(of: _Data, solved: _Solved) -> FloatArray:
    """Of every coefficient, of ln tau, and of the places of first contact."""
    J = np.concatenate((solved.columns, solved.arms * solved.slopes, solved.shifts), axis=1)
    every = np.ones(len(of.records), dtype=bool)
    used = np.concatenate((solved.found > 0, solved.arms > 0, every))
    used[KNOTS : KNOTS + DAMPING_KNOTS] = True  # of a damping of 0 the error is its bound
    noise = correlation(solved.residual) * float(np.mean(solved.residual**2))
    prior = np.zeros(J.shape[1])
    prior[-len(of.records) :] = np.sqrt(noise) / (_CONTACT * of.depth)
    size = np.maximum(np.sqrt(np.sum(J**2, axis=0) + prior**2), 1e-300)
    A = np.concatenate((J, np.diag(prior)))[:, used] / size[used]
    whole = np.zeros((len(used), len(used)))
    whole[np.ix_(used, used)] = noise * np.linalg.pinv(A.T @ A, rcond=1e-12, hermitian=True)
    return np.asarray(whole / np.outer(size, size))
