"""Tests of a known law, made without the reader or the fit."""

from __future__ import annotations

import numpy as np

from dashpot.extensions.materials.hyperelastic.datamodel import StressStrainTest
from dashpot.extensions.materials.hyperelastic.strain_energy import Hyperelastic
from dashpot.solids.demo_seals import PAPER

RUBBER = Hyperelastic("mooney-rivlin", (0.15e6, 0.05e6))
FOAM = Hyperelastic("hyperfoam", (0.2e6,), (8.0,), 0.0)
RELAXATION = PAPER * (1 / PAPER.k_inf)


def simulate_loading(law, mode, span=(1.0, 2.0), *, rows=40, noise=0.0, seed=0, **words):
    """One loading of a law, its noise a part of the largest stress."""
    x = np.linspace(*span, rows)
    stress = law.nominal(mode, x)
    error = noise * np.abs(stress).max() * np.random.default_rng(seed).standard_normal(rows)
    return StressStrainTest(mode, x, stress + error, **words, units="SI")


def simulate_loading_at_rate(law, mode, rate, *, high=2.0, rows=2000, noise=0.0, seed=0):
    """The same at an engineering rate, 1/s: its true stress with the relaxation, by quadrature.

    sigma = s_e + sum g_j int e^{-(t-u)/tau_j} ds_e(u), Simpson within each sample, exact in e^-t.
    """
    x = np.linspace(1.0, high, rows)
    t = (x - 1) / rate
    elastic = law.nominal(mode, x) * x
    total, h = elastic.copy(), t[1]
    middle = 0.5 * (x[1:] + x[:-1])
    at_middle = law.nominal(mode, middle) * middle
    for g, tau in zip(RELAXATION.k, RELAXATION.tau, strict=True):
        q = 0.0
        first, second = at_middle - elastic[:-1], elastic[1:] - at_middle
        # two straight halves of each sample
        z = 0.5 * h / tau
        a, G = np.exp(-z), -np.expm1(-z) / z
        for i in range(1, rows):
            q = a * (a * q + G * first[i - 1]) + G * second[i - 1]
            total[i] += g * q
    stress = total / x
    stress = stress + noise * stress.max() * np.random.default_rng(seed).standard_normal(rows)
    return StressStrainTest(mode, x, stress, t, units="SI")
