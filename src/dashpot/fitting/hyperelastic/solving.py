r"""Laws through elastic curves by least squares, every mode with one say however many its rows.

Laws of the invariants are linear in their constants. Of power laws (Ogden, hyperfoam) every mu is
kept > 0, so that their tangent is a sum of positive parts and stable at any stretch, and given the
exponents they are linear, too: each set of exponents on a grid is a small nonnegative problem, and
the best of them are starts of a descent on alpha and Poisson's ratio alone, mu taken at its optimum
(variable projection: G. H. Golub, V. Pereyra, 1973; with the Jacobian of L. Kaufman, 1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.least_squares.nnls import nonnegative
from dashpot.records.hyperelastic import ElasticCurve
from dashpot.solids.hyperelastic import (
    POWERS,
    Hyperelastic,
    Kind,
    path,
    power_by_poisson,
    power_column,
    power_slope,
)

EXPONENTS = (-12.0, -6.0, -3.0, -1.5, 1.5, 3.0, 6.0, 12.0, 24.0)
"""Starts of a descent."""
SPECTRUM = np.array([-16, -12, -8, -6, -4, -3, -2, -1, 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24.0])
"""Exponents of the most flexible stable law that curves are held against."""
_LARGEST = 30.0
_POISSONS = (0.05, 0.2, 0.35, 0.45)
_DESCENTS = 2
EXACT = 1e-9
"""Part of the stress below which a residual is rounding."""


class Weighed(NamedTuple):
    """Curves as rows of one problem.

    Attributes
    ----------
    curves : tuple of ElasticCurve
    weights : tuple of array
        A row's, 1/Pa: modes weigh alike, and the sum of squares of the stress is the rows' number.
    target : array, shape (n,)
    """

    curves: tuple[ElasticCurve, ...]
    weights: tuple[FloatArray, ...]
    target: FloatArray


class Solution(NamedTuple):
    """A law through curves.

    Attributes
    ----------
    name : str
        With the number of terms of a power law.
    law : Hyperelastic
    jacobian : array, shape (n, p)
        Of the weighed stress by constants, exponents and, where it was sought, Poisson's ratio.
    residual : array, shape (n,)
        Measured less modelled, weighed: over the rms of the mode.
    """

    name: str
    law: Hyperelastic
    jacobian: FloatArray
    residual: FloatArray

    @property
    def rms(self) -> float:
        """Of the residual, over the rms of the stress."""
        return float(np.sqrt(np.mean(self.residual**2)))


def weighed(curves: Sequence[ElasticCurve]) -> Weighed:
    """Return curves with the weights that give every mode the same say."""
    modes = {one.mode for one in curves}
    total = sum(len(one.stretch) for one in curves)
    weight = {}
    for mode in modes:
        stress = np.concatenate([one.stress for one in curves if one.mode == mode])
        weight[mode] = np.sqrt(total / len(modes) / float(stress @ stress))
    each = tuple(np.full(len(one.stretch), weight[one.mode]) for one in curves)
    target = np.concatenate([w * one.stress for w, one in zip(each, curves, strict=True)])
    return Weighed(tuple(curves), each, target)


def invariant_law(rows: Weighed, kind: Kind) -> Solution:
    """Return the law of the invariants that follows the curves best: linear least squares."""
    unit = Hyperelastic(kind, (1.0,) * len(POWERS[kind]))
    parts = zip(rows.weights, rows.curves, strict=True)
    A = np.concatenate([w[:, None] * unit.columns(one.mode, one.stretch) for w, one in parts])
    size = np.linalg.norm(A, axis=0)
    found = np.linalg.lstsq(A / size, rows.target, rcond=1e-12)[0] / size
    law = Hyperelastic(kind, tuple(found.tolist()))
    return Solution(kind, law, A, rows.target - A @ found)


def power_law(rows: Weighed, terms: int, kind: Kind, poisson: float | None) -> Solution:
    """Return the law of so many power terms, or fewer if a further one is worth nothing.

    Poisson's ratio of a foam is sought where it is None.
    """
    free = poisson is None
    runs = [_descended(rows, start, free=free) for start in _starts(rows, terms, poisson)]
    x = min(runs, key=lambda run: run[0])[1]
    mu = _optimum(_columns(rows, x[:-1], float(x[-1])), rows.target)
    order = [i for i in np.argsort(-mu * np.abs(x[:-1])) if mu[i] > 0]
    mu, alpha, v = mu[order], x[:-1][order], float(x[-1])
    unit = 1 / float(rows.weights[0][0])
    A, slopes, by_poisson = _derivatives(rows, mu, alpha, v)
    J = np.concatenate((A / unit, slopes, by_poisson[:, None]), axis=1)
    law = Hyperelastic(
        kind,
        tuple((unit * mu).tolist()),
        tuple(alpha.tolist()),
        v if kind == "hyperfoam" else 0.5,
    )
    return Solution(f"{kind}-{len(mu)}", law, J if free else J[:, :-1], rows.target - A @ mu)


def _descended(rows: Weighed, start: FloatArray, *, free: bool) -> tuple[float, FloatArray]:
    """The sum of squares and alpha, nu where a descent ends; nu stays unless `free`."""
    from scipy.optimize import least_squares  # few need it, and it costs time to import

    moving = len(start) - (not free)

    def whole(x: FloatArray) -> FloatArray:
        return np.concatenate((x, start[moving:]))

    def left(x: FloatArray) -> FloatArray:
        at = whole(x)
        A = _columns(rows, at[:-1], float(at[-1]))
        return np.asarray(A @ _optimum(A, rows.target) - rows.target)

    def slope(x: FloatArray) -> FloatArray:
        at = whole(x)
        A = _columns(rows, at[:-1], float(at[-1]))
        mu = _optimum(A, rows.target)
        _, slopes, by_poisson = _derivatives(rows, mu, at[:-1], float(at[-1]))
        J = np.concatenate((slopes, by_poisson[:, None]), axis=1)[:, :moving]
        base = np.linalg.qr(A[:, mu > 0])[0]
        return np.asarray(J - base @ (base.T @ J))

    low = [-_LARGEST] * (len(start) - 1) + [0.0] * free
    high = [_LARGEST] * (len(start) - 1) + [0.49] * free
    run = least_squares(
        left, start[:moving], jac=slope, bounds=(low, high), x_scale="jac",
        xtol=1e-11, ftol=1e-12, gtol=1e-15, max_nfev=40,
    )  # fmt: skip
    return float(run.cost), whole(run.x)


def _optimum(A: FloatArray, target: FloatArray) -> FloatArray:
    """The mu >= 0 of least squares."""
    size = np.linalg.norm(A, axis=0)
    size[size == 0] = 1.0
    mu = np.linalg.lstsq(A / size, target, rcond=1e-13)[0]
    if mu.min() < 0:
        some = nonnegative((A / size).T @ (A / size), (A / size).T @ target) > 0
        mu = np.zeros(len(size))
        if some.any():
            mu[some] = np.linalg.lstsq((A / size)[:, some], target, rcond=1e-13)[0]
    return np.asarray(np.maximum(mu, 0.0) / size)


def _derivatives(
    rows: Weighed, mu: FloatArray, alpha: FloatArray, poisson: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Weighed columns of each term, and the stress by each alpha and by Poisson's ratio."""
    unit = 1 / rows.weights[0][0]
    slopes, by_poisson = [], []
    terms = list(zip(mu.tolist(), alpha.tolist(), strict=True))
    for w, one in zip(rows.weights, rows.curves, strict=True):
        along = path(one.mode, one.stretch, poisson)
        slopes.append(
            unit * w[:, None] * np.stack([m * power_slope(along, a) for m, a in terms], -1)
        )
        by_poisson.append(unit * w * np.sum([m * power_by_poisson(along, a) for m, a in terms], 0))
    return _columns(rows, alpha, poisson), np.concatenate(slopes), np.concatenate(by_poisson)


def _starts(rows: Weighed, terms: int, poisson: float | None) -> list[FloatArray]:
    """The best sets of exponents of the grid, as alpha, nu; those that use every term first."""
    found: list[tuple[bool, float, list[float]]] = []
    for v in _POISSONS if poisson is None else (poisson,):
        A = _columns(rows, np.array(EXPONENTS), v)
        gram, moment = A.T @ A, A.T @ rows.target
        for chosen in combinations(range(len(EXPONENTS)), terms):
            index = list(chosen)
            size = np.sqrt(np.diag(gram)[index])
            inner = gram[np.ix_(index, index)]
            mu = nonnegative(inner / np.outer(size, size), moment[index] / size) / size
            cost = float(mu @ inner @ mu - 2 * mu @ moment[index])
            found.append((bool((mu <= 0).any()), cost, [*(EXPONENTS[i] for i in index), v]))
    found.sort()
    return [np.array(one) for _, _, one in found[:_DESCENTS]]


def _columns(rows: Weighed, exponents: FloatArray, poisson: float) -> FloatArray:
    """Weighed stress of a term of each exponent, its mu one over the first weight."""
    unit = 1 / rows.weights[0][0]
    parts = []
    for w, one in zip(rows.weights, rows.curves, strict=True):
        along = path(one.mode, one.stretch, poisson)
        parts.append(unit * w[:, None] * np.stack([power_column(along, a) for a in exponents], -1))
    return np.concatenate(parts)


def closest(curves: Sequence[ElasticCurve], poisson: float) -> float:
    """Return what the most flexible stable law leaves of curves, rms over the rms of the stress."""
    rows = weighed(curves)
    A = _columns(rows, SPECTRUM, poisson)
    size = np.linalg.norm(A, axis=0)
    mu = nonnegative((A / size).T @ (A / size), (A / size).T @ rows.target) / size
    return float(np.sqrt(np.mean((rows.target - A @ mu) ** 2)))
