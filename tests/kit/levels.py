"""Loops, a sweep of strain and FRFs at levels, of one slider beside a solid, and their fits."""

from __future__ import annotations

from functools import cache

import numpy as np

from dashpot.base.provenance import Source
from dashpot.datamodel.frf import Kind
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep
from dashpot.extensions.amplitude.fit import fit_amplitude
from dashpot.extensions.amplitude.friction import Kraus
from dashpot.extensions.amplitude.level_results import LevelFit
from dashpot.extensions.amplitude.preprocess import compute_sweep
from dashpot.extensions.systems.level_response import response_at_level
from dashpot.extensions.systems.multibody import Mount, System, point_mass
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.networks import spring
from dashpot.solids.nonlinear_springs import Cubic

SEAL = GeneralizedMaxwell(393.0, (235.0, 35.6), (0.502, 0.012))
SLIDER = Jenkins(100.0, 0.05)
MASS = 0.104
LEVELS = (0.005, 0.05, 0.5)
SIZES = (1e-4, 3e-4, 1e-3, 3e-3)


@cache
def loops(sizes=SIZES, *, hz=5.0, cycles=5, rate=500, noise=2e-4, jitter=0.0, force=None):
    """Harmonic cycles at rising amplitudes about a preload, `cycles` of each."""
    rng = np.random.default_rng(2)
    t = np.arange(int(len(sizes) * cycles / hz * rate)) / rate
    size = np.asarray(sizes)[np.minimum((t * hz / cycles).astype(int), len(sizes) - 1)]
    x = size * np.sin(2 * np.pi * hz * t)
    F = (SEAL + SLIDER).path_force(t, x) if force is None else force(x)
    x, F = x + jitter * rng.normal(size=len(t)), F + noise * rng.normal(size=len(t))
    return RelaxationTest(t, x + 1e-3, F + 0.7, units="SI")


@cache
def sweep():
    """Two frequencies of a rubber that softens by Kraus's law."""
    X = np.tile(np.geomspace(1e-4, 0.05, 12), 2)
    K = 1e6 * (spring(2.0) + Kraus(3.0, 0.004)).equivalent(1.0, X)
    hz = np.repeat([10.0, 100.0], 12)
    K = K * np.where(hz > 50, 1.3 + 0.1j, 1)
    return AmplitudeSweep(hz, X, K.real, K.imag, units="SI")


@cache
def law_of_loops():
    """The law of those loops."""
    return fit_amplitude(compute_sweep(loops()))


@cache
def law_of_sweep():
    """The law of that sweep."""
    return fit_amplitude(sweep())


@cache
def frfs():
    """What a mass on both does at three levels."""
    system = System((point_mass("m", MASS),), (Mount(SEAL, ("m", "ground"), friction=SLIDER),))
    f = np.linspace(8, 20, 31)
    return [
        response_at_level(system, response="m.z", force="m.z", level=level, frequency=f).frf(
            Kind.ACCELERANCE
        )
        for level in LEVELS
    ]


def make_ideal_fit():
    """The fit of those FRFs as it would be, were it perfect but for one draw."""
    other = (1.01 * SEAL, (Jenkins(99.0, 0.05),))
    draws = ((SEAL, (SLIDER,)), other)
    return LevelFit(
        SEAL, (SLIDER,), (1e-5, 1.8e-2), (8.0, 20.0), 0.01, 0.4, draws, MASS, levels=LEVELS
    )


ARMS = GeneralizedMaxwell(393.0, (235.0, 35.6), (0.004, 16.4157303))
SLIDERS = (Jenkins(100.0, 0.05), Jenkins(60.0, 0.012), Jenkins(30.0, 0.003))
STIFFENS = Cubic(2e7)


def a_level_fit(solid=ARMS, neighbour=(*SLIDERS, STIFFENS), **others) -> LevelFit:
    """Arms, sliders and a cubic spring as FRFs at two levels tell them."""
    expected = {
        "source": (Source("low.csv", "0" * 64), Source("high.csv", "1" * 64)),
        "specimen": Specimen(length=0.1, temperature=296.15),
        "levels": (0.02, 0.5),
    } | others
    return LevelFit(
        solid, neighbour, (1e-4, 2e-3), (8.0, 20.0), 0.01, 0.1, (), MASS, 2.0, **expected
    )
