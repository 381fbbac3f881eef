"""The relaxation and elastic law of a specimen under impact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from dashpot.datamodel.fit import Fit
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

from .fits import a_fit
from .foreign.drop_tests import Specimen

SLOW = 0.1
"""s: a relaxation test shows no arm that is faster."""


def cubic(c: np.ndarray, depth: float) -> ElasticLaw:
    x = np.linspace(0.0, depth, 401)
    slope = c[0] + 2 * c[1] * x + 3 * c[2] * x**2
    secant = float(np.trapezoid(slope, x)) / depth
    return ElasticLaw(tuple(x.tolist()), tuple((slope / secant).tolist()), secant)


def make_relaxation_fit(specimen: Specimen, random: np.random.Generator) -> Fit:
    """A relaxation test that knows the slow arms to 1 %, and is off by as much."""
    g, tau = np.array(specimen.solid.k), np.array(specimen.solid.tau)
    if len(g) > 3:  # a broad spectrum, of which a test shows five
        t, tau = np.geomspace(0.02, 60, 300), np.geomspace(0.03, 12, 5)
        k = nnls(np.exp(-t[:, None] / np.append(np.inf, tau)), specimen.solid.relaxation(t))[0]
        g = k[1:] / k[0]
    seen = (tau > SLOW) & (g > 0) if len(g) <= 3 else g > 0
    g, tau = g[seen], tau[seen]
    law, n = cubic(np.array(specimen.c), specimen.depth), len(g)
    k = law.stiffness * g * (1 + 0.01 * random.standard_normal(n))
    tau = tau * np.exp(0.01 * random.standard_normal(n))
    covariance = np.diag([0.0, *(0.01 * k) ** 2, *np.full(n, 1e-4)])
    model = GeneralizedMaxwell(law.stiffness, tuple(k.tolist()), tuple(tau.tolist()))
    return replace(a_fit(model, covariance=covariance), elastic_law=law)
