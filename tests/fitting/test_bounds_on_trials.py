"""The bounds on seals and motions that were made without dashpot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.trials import FAULTLESS, KINDS, Bench, Kind, relaxation_test, trial

from dashpot.fitting.prediction_bounds import frf_band
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare

pytestmark = pytest.mark.once

DISTURBED = replace(FAULTLESS, late=1e-3, hum=5e-3, drift=0.2e-3)


def answers(kind: Kind, *, seed: int, bench: Bench) -> tuple[bool, bool, bool, bool]:
    """Whether the peak's line, its height, k(T) and k(3 T) are within their limits."""
    item = trial(kind, seed=seed, bench=bench)
    natural = np.random.default_rng([seed, KINDS.index(kind), 7]).uniform(8, 20)
    mass = 2 * item.seal.stiffness(2 * np.pi * natural).real / (2 * np.pi * natural) ** 2
    f = np.linspace(0.5 * natural, 2 * natural, 6001)
    inertia = mass * (2 * np.pi * f) ** 2
    magnitude = (2 * np.pi * f) ** 2 / np.abs(2 * item.seal.stiffness(2 * np.pi * f) - inertia)
    peak = int(np.argmax(magnitude))

    test = prepare(relaxation_test(item))
    result = fit(test)
    band = frf_band(result, test, mass=mass, seals=2, frequency=f[peak : peak + 1])
    (low,), (high,) = band.unmeasured
    least, most = band.peak_height or (0.0, np.inf)
    stiffness_limits, T = result.stiffness_limits, test.hold_time
    assert stiffness_limits is not None
    return (
        low <= magnitude[peak] <= high,
        least <= magnitude[peak] <= most,
        stiffness_limits["k_end"][0] <= item.seal.relaxation(T) <= stiffness_limits["k_end"][1],
        stiffness_limits["k_3end"][0]
        <= item.seal.relaxation(3 * T)
        <= stiffness_limits["k_3end"][1],
    )


@pytest.mark.parametrize("bench", [FAULTLESS, DISTURBED])
def test_the_bounds_hold_on_a_few_kinds(bench: Bench) -> None:
    every = [answers(kind, seed=3, bench=bench) for kind in KINDS[::26]]
    assert np.mean(every) > 0.9


@pytest.mark.slow
@pytest.mark.parametrize("bench", [FAULTLESS, DISTURBED])
def test_the_bounds_hold_on_every_kind(bench: Bench) -> None:
    every = [answers(kind, seed=seed, bench=bench) for kind in KINDS for seed in range(4)]
    assert (np.mean(every, axis=0) >= 0.93).all()
