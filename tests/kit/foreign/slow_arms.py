"""Seals with an arm that is slower than their test: a hold, a hammer, or both; nothing of dashpot.

What such an arm carries is a spring to every record: no record tells it from k_inf.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .hammer_rigs import HammerRecord, Rig, strike_block
from .rigs import Protocol, Record, read
from .truths import Seal, Solid

SLOW = (60.0, 200.0, 600.0, 2000.0)
"""Relaxation times, s."""
HOLDS = (5.0, 8.0, 10.0, 20.0, 40.0)
"""s."""


@dataclass(frozen=True, eq=False)
class SlowPair:
    """A relaxation record and a hammer record of one seal."""

    name: str
    seal: Seal
    bench: Record
    hammer: HammerRecord


def slow_pairs(count: int, seed: int = 0) -> Iterator[SlowPair]:
    """Seals of one or two arms within the hold, and one that takes 60 to 2000 s."""
    for i in range(count):
        random = np.random.default_rng([seed, i, *b"slow arms"])
        hold, slow = HOLDS[i % len(HOLDS)], SLOW[i % len(SLOW)]
        k_inf = random.uniform(100.0, 300.0)
        n = 1 + i % 2
        tau = np.exp(random.uniform(np.log(0.01), np.log(min(hold / 4, 3.0)), n))
        k = k_inf * random.uniform(0.1, 0.35, n)
        slowest = k_inf * random.uniform(0.1, 0.4)
        name = f"{i:02d}: {n} arms and one of {slow:g} s, held {hold:g} s"
        seal = Seal(Solid.arms(name, k_inf, [*k, slowest], [*tau, slow]))
        protocol = Protocol(
            depth=round(float(random.uniform(5e-3, 9e-3)), 4),
            ramp=round(float(random.uniform(0.4, 1.5)), 2),
            hold=hold,
            rate=250.0,
        )
        bench = read(seal, protocol, seed=seed, name=name)
        hammer = strike_block(1000 * seed + i, Rig(length=1.0, hits=1), seal=seal)
        # blocks that are long enough for what rings: eight time constants of the decay
        length = float(np.clip(8 / -hammer.truth["pole"].real, 6.0, 60.0))
        hammer = strike_block(1000 * seed + i, Rig(length=round(length, 1)), seal=seal)
        yield SlowPair(name, seal, bench, hammer)
