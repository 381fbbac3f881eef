r"""Least-squares fits of hyperelastic laws to elastic curves, every mode of equal weight.

Laws of the invariants are linear in their constants. Of power laws (Ogden, hyperfoam) every mu is
kept > 0, so that their tangent is a sum of positive parts and stable at any stretch, and given the
exponents they are linear, too: each set of exponents on a grid is a small nonnegative problem, and
the best of them are starts of a descent on alpha and Poisson's ratio alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.extensions.materials.hyperelastic.datamodel import ElasticCurve
from dashpot.extensions.materials.hyperelastic.law_choices import ElasticKind
from dashpot.extensions.materials.hyperelastic.strain_energy import (
    POWERS,
    Hyperelastic,
    Path,
    path,
    power_by_poisson,
    power_column,
    power_slope,
)
from dashpot.numerics.least_squares import (
    Optimum,
    Parameter,
    Problem,
    Rows,
    require_optimum,
    solve_ordinary,
    triangle,
)
from dashpot.numerics.nonnegative_least_squares import solve_linear

EXPONENTS = (-12.0, -6.0, -3.0, -1.5, 1.5, 3.0, 6.0, 12.0, 24.0)
"""Starts of a descent."""
SPECTRUM = np.array([-16, -12, -8, -6, -4, -3, -2, -1, 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24.0])
"""Exponents of the most flexible stable law that curves are held against."""
_MAX_EXPONENT = 30.0
_POISSONS = (0.05, 0.2, 0.35, 0.45)
_DESCENTS, _STEPS = 2, 40
EXACT = 1e-9
"""Part of the stress below which a residual is rounding."""


class WeightedCurves(NamedTuple):
    """Curves as rows of one least-squares problem.

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


class HyperelasticOptimum(NamedTuple):
    """Optimum of a hyperelastic law.

    Attributes
    ----------
    name : str
        With the number of terms of a power law.
    law : Hyperelastic
    optimum : Optimum
        Theta are exponents and, if fitted, Poisson's ratio; beta the constants, Pa. The residual is
        weighed: over the rms of the mode.
    """

    name: str
    law: Hyperelastic
    optimum: Optimum

    @property
    def rms(self) -> float:
        """Root mean square residual over the rms of the stress."""
        return float(np.sqrt(np.mean(self.optimum.residual**2)))

    def numbers(self, values: FloatArray) -> FloatArray:
        """Constants, exponents, Poisson's ratio if fitted, and the shear modulus."""
        result, mu = np.split(values, [len(self.optimum.theta)])
        return np.concatenate((mu, result, [replace(self.law, constants=tuple(mu)).shear_modulus]))


def weight_curves(curves: Sequence[ElasticCurve]) -> WeightedCurves:
    """Return curves with weights that make the modes equal."""
    modes = {curve.mode for curve in curves}
    total = sum(len(curve.stretch) for curve in curves)
    weight = {}
    for mode in modes:
        stress = np.concatenate([curve.stress for curve in curves if curve.mode == mode])
        weight[mode] = np.sqrt(total / len(modes) / float(stress @ stress))
    columns = tuple(np.full(len(curve.stretch), weight[curve.mode]) for curve in curves)
    target = np.concatenate([w * curve.stress for w, curve in zip(columns, curves, strict=True)])
    return WeightedCurves(tuple(curves), columns, target)


def fit_invariant_law(rows: WeightedCurves, kind: ElasticKind) -> HyperelasticOptimum:
    """Return the best law of the invariants, by linear least squares."""
    unit = Hyperelastic(kind, (1.0,) * len(POWERS[kind]))
    parts = zip(rows.weights, rows.curves, strict=True)
    A = np.concatenate([w[:, None] * unit.columns(curve.mode, curve.stretch) for w, curve in parts])
    optimum = solve_ordinary(rows.target, A)
    return HyperelasticOptimum(kind, Hyperelastic(kind, tuple(optimum.beta.tolist())), optimum)


def fit_power_law(
    rows: WeightedCurves, terms: int, kind: ElasticKind, poisson: float | None
) -> HyperelasticOptimum:
    """Return the law of at most this number of power terms, without useless ones.

    Poisson's ratio of a foam is fitted if it is None.
    """
    starts = _find_starting_points(rows, terms, poisson)
    best = require_optimum(build_power_problem(rows, terms, poisson), starts, max_steps=_STEPS)
    order = [i for i in np.argsort(-best.beta * np.abs(best.theta[:terms])) if best.beta[i] > 0]
    theta = np.concatenate((best.theta[order], best.theta[terms:]))
    optimum = build_power_problem(rows, len(order), poisson).solve_linear(theta)
    v = poisson if poisson is not None else float(theta[-1])
    law = Hyperelastic(
        kind,
        tuple(optimum.beta.tolist()),
        tuple(theta[: len(order)].tolist()),
        v if kind == "hyperfoam" else 0.5,
    )
    return HyperelasticOptimum(f"{kind}-{len(order)}", law, optimum)


def build_power_problem(rows: WeightedCurves, terms: int, poisson: float | None) -> Problem:
    """Return the problem of alpha and, where it is None, Poisson's ratio; mu is linear."""

    def model(theta: FloatArray) -> Rows:
        alpha, v = theta[:terms], float(theta[-1]) if poisson is None else poisson

        def slope(mu: FloatArray) -> FloatArray:
            results = []
            for w, strain_path in zip(rows.weights, _make_strain_paths(rows, v), strict=True):
                by = [m * power_slope(strain_path, a) for m, a in zip(mu, alpha, strict=True)]
                if poisson is None:
                    group = [
                        m * power_by_poisson(strain_path, a) for m, a in zip(mu, alpha, strict=True)
                    ]
                    by.append(np.sum(group, axis=0))
                results.append(w[:, None] * np.stack(by, axis=-1))
            return np.concatenate(results)

        return Rows(rows.target, _compute_columns(rows, alpha, v), slope)

    parameters = [Parameter(-_MAX_EXPONENT, _MAX_EXPONENT)] * terms
    return Problem(
        model, parameters + [Parameter(0.0, 0.49, 0.1)] * (poisson is None), positive=True
    )


def _find_starting_points(
    rows: WeightedCurves, terms: int, poisson: float | None
) -> list[FloatArray]:
    """The best sets of exponents of the grid, as alpha, nu; those with every term first."""
    pairs: list[tuple[bool, float, list[float]]] = []
    for v in _POISSONS if poisson is None else (poisson,):
        A = _compute_columns(rows, np.array(EXPONENTS), v)
        factor = triangle(np.concatenate((A.T, rows.target[None])))
        for indices in map(list, combinations(range(len(EXPONENTS)), terms)):
            mu, _ = solve_linear(factor[:, indices], factor[:, -1], positive=True)
            residual = factor[:, -1] - factor[:, indices] @ mu
            start = [*(EXPONENTS[i] for i in indices), *[v] * (poisson is None)]
            pairs.append((bool((mu <= 0).any()), float(residual @ residual), start))
    pairs.sort()
    return [np.array(values) for _, _, values in pairs[:_DESCENTS]]


def _make_strain_paths(rows: WeightedCurves, poisson: float) -> list[Path]:
    """Return the strain paths of every curve."""
    return [path(curve.mode, curve.stretch, poisson) for curve in rows.curves]


def _compute_columns(rows: WeightedCurves, exponents: FloatArray, poisson: float) -> FloatArray:
    """Return the weighted stress of a term of each exponent."""
    return np.concatenate(
        [
            w[:, None] * np.stack([power_column(strain_path, a) for a in exponents], axis=-1)
            for w, strain_path in zip(rows.weights, _make_strain_paths(rows, poisson), strict=True)
        ]
    )


def compute_best_stable_misfit(curves: Sequence[ElasticCurve], poisson: float) -> float:
    """Return the residual of the most flexible stable law, rms over the rms of the stress."""
    rows = weight_curves(curves)
    A = _compute_columns(rows, SPECTRUM, poisson)
    mu, _ = solve_linear(A, rows.target, positive=True)
    return float(np.sqrt(np.mean((rows.target - A @ mu) ** 2)))


def compute_best_signed_misfit(curves: Sequence[ElasticCurve], poisson: float) -> float:
    """Return the residual of the closest law of two power terms of any sign, as the stable one's.

    With a negative term a law need not be stable. None is fitted: here one shows what else than a
    fault of a specimen may separate the modes.
    """
    rows = weight_curves(curves)
    A = _compute_columns(rows, SPECTRUM, poisson)
    normal, projection = A.T @ A, A.T @ rows.target
    first, second = np.triu_indices(len(SPECTRUM), k=1)
    pairs = np.stack((first, second), axis=1)
    matrices = normal[pairs[:, :, None], pairs[:, None, :]]
    mu = np.linalg.solve(matrices, projection[pairs][..., None])[..., 0]
    best = int(np.argmax((mu * projection[pairs]).sum(axis=1)))
    return float(np.sqrt(np.mean((rows.target - A[:, pairs[best]] @ mu[best]) ** 2)))
