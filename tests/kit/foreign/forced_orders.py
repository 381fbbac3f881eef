"""Tests of arms that stand out, of which a lab may ask for too few: with noise, of every kind.

`forced(kind, count)`: two to four arms about a decade apart. A ramp and hold is pressed by the
ideal machine of `rigs`; a modulus, a compliance and a sweep are curves without a gap.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .curves import Curve
from .gaps import measure_curve
from .rigs import Protocol, Record, noisy, press_seal, sample_record
from .truths import Seal, Solid

KINDS = ("ramp and hold", "curve", "creep", "sweep")
NOISE = (1e-3, 3e-3, 5e-3)


class ForcedOrder(NamedTuple):
    """A test, how many arms its truth has, and the truth, N/m or Pa."""

    test: Record | Curve
    arms: int
    solid: Solid


def generate_forced_orders(kind: str, count: int, seed: int = 0) -> Iterator[ForcedOrder]:
    """Tests of a kind, of two, three and four arms by turns."""
    for i in range(count):
        random = np.random.default_rng([seed, i, KINDS.index(kind), 44])
        arms = 2 + i % 3
        if kind == "ramp and hold":
            # what a ramp of a second shows, and a hold of 40 s
            lg_tau = np.linspace(-0.5, 1.1, arms) + random.uniform(-0.1, 0.1, arms)
            k_inf = random.uniform(100, 400)
            k = k_inf * random.uniform(0.1, 0.4, arms)
            solid = Solid.arms(f"{arms} arms", k_inf, k, 10**lg_tau)
            record = press_seal(Seal(solid), Protocol(rate=250.0), name=f"{i} {solid.name}")
            noise = NOISE[int(random.integers(len(NOISE)))]
            yield ForcedOrder(noisy(sample_record(record, random), random, sd=noise), arms, solid)
            continue
        lg_tau = np.linspace(-1.5, 1.0, arms) + random.uniform(-0.15, 0.15, arms)
        E = 10 ** random.uniform(6, 8)
        k = E * random.uniform(0.15, 0.5, arms)
        solid = Solid.arms(f"{arms} arms", E * random.uniform(0.2, 0.6), k, 10**lg_tau)
        t = np.geomspace(2e-3, 300.0, 90)
        yield ForcedOrder(measure_curve(kind, f"{i} {solid.name}", solid, t, random), arms, solid)
