r"""Latin hypercube samples of standard normal variables.

Each of n draws lies in another of n strata of equal probability, in every variable (M. D. McKay, R.
J. Beckman, W. J. Conover, *Technometrics* 21, 1979). Random correlations of the n draws are
removed, as R. L. Iman and W. J. Conover (*Commun. Stat. Simul.* 11, 1982) do it: a sum of the
variables then has its standard deviation in the draws to first order exactly.
"""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

from dashpot.base.arrays import FloatArray

_NORMAL = NormalDist()
_PER_VARIABLE = 2
"""Fewest draws of each variable for which their correlations are corrected."""


def draw_standard_normal(count: int, variables: int, seed: int) -> FloatArray:
    """Return stratified draws, shape (count, variables), of mean 0 and covariance 1.

    Of fewer draws than twice the variables only the strata are sure.
    """
    generator = np.random.default_rng(seed)
    strata = np.column_stack([generator.permutation(count) for _ in range(variables)])
    ratio = (strata + generator.random((count, variables))) / count
    normal = np.vectorize(_NORMAL.inv_cdf, otypes=[float])(np.clip(ratio, 1e-12, 1 - 1e-12))
    if count < _PER_VARIABLE * (variables + 1):
        return np.asarray(normal)
    normal = normal - normal.mean(axis=0)
    root = np.linalg.cholesky(normal.T @ normal / (count - 1))
    return np.asarray(np.linalg.solve(root, normal.T).T)


def convert_to_uniform(normal: FloatArray) -> FloatArray:
    """Return the probability of no more than each value, between 0 and 1."""
    return np.asarray(np.vectorize(_NORMAL.cdf, otypes=[float])(normal))


def truncated_normal(share: float, mean: float, sd: float) -> float:
    """Return the quantile at `share` of a normal variable that is not negative."""
    lower_probability = _NORMAL.cdf(-mean / sd)
    if 1 - lower_probability < 1e-9:  # far below zero the tail is exponential, of this mean
        return float(-np.log1p(-share) * sd**2 / -mean)
    return max(
        mean
        + sd * _NORMAL.inv_cdf(min(lower_probability + share * (1 - lower_probability), 1 - 1e-12)),
        0.0,
    )
