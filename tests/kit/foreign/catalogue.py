"""Named sets of records: what speed and verdicts are judged on, one at a time.

for record in relaxation_records(): ...     # 200: kinds of solids, rates, ramps, noises
for record in verdict_records(): ...        # 42 truths by 40 rigs, named "truth | rig"
sheets("creep")                             # of `kinds`: twenty of each other kind
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial

import numpy as np

from .rigs import FAULTLESS, RIGS, Protocol, Record, Rig, hums, noisy, read
from .truths import FAMILIES, TABLE_1, TRUTHS, Seal, Solid, draw_truth

RATES = (250.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0)
"""Hz."""
NOISES: dict[str, Rig] = {
    "white": Rig(noise=4e-3),
    "AR 20 ms": Rig(reading=(partial(noisy, sd=4e-3, tau=0.02),)),
    "AR .5 s": Rig(reading=(partial(noisy, sd=4e-3, tau=0.5),)),
    "hum": Rig(reading=(partial(hums, size=4e-3),)),
}
_ROWS = 120_000


def relaxation_records(count: int = 200, seed: int = 0) -> Iterator[Record]:
    """Sound records of every family, rate and noise, about evenly.

    Ramps of .05 to 5 s and holds of 10 to 300 s, even in their logarithm, of at most 120,000 rows.
    """
    for i in range(count):
        random = np.random.default_rng([seed, i])
        turn, which = divmod(i, len(FAMILIES))
        family, rate = FAMILIES[which], RATES[(which + turn) % len(RATES)]
        noise = list(NOISES)[(which + turn + turn // 12) % len(NOISES)]
        most = min(300.0, max(10.0, _ROWS / rate - 7))
        hold = round(float(np.exp(random.uniform(np.log(10.0), np.log(most)))), 1)
        ramp = round(float(np.exp(random.uniform(np.log(0.05), np.log(5.0)))), 3)
        solid = draw_truth(family, 1000 * seed + turn, hold=hold)
        protocol = Protocol(round(float(random.uniform(3e-3, 10e-3)), 4), ramp, hold, 1.0, rate)
        name = f"{i:03d} {solid.name} | {noise} | {rate:g} Hz, {ramp:g} s, {hold:g} s"
        yield read(Seal(solid), protocol, NOISES[noise], seed=seed, name=name)


def protocol_of(truth: Solid, seed: int = 0) -> Protocol:
    """How a truth is pressed for its verdict: 250 Hz, ramps of .3 to 2 s, holds of 10 to 80 s."""
    if truth is TABLE_1:
        return Protocol(rate=250.0)
    random = np.random.default_rng([seed, *truth.name.encode()])
    depth, ramp, hold = (
        random.uniform(5e-3, 9e-3),
        random.uniform(-1.2, 0.7),
        random.uniform(2.3, 4.38),
    )
    return Protocol(
        round(float(depth), 4), round(float(np.exp(ramp)), 2), round(float(np.exp(hold)), 1),
        rate=250.0,
    )  # fmt: skip


def verdict_records(
    truths: Iterable[Solid] = TRUTHS, rigs: Iterable[str] = tuple(RIGS), seed: int = 0
) -> Iterator[Record]:
    """Every truth on every rig; a truth meets each rig in the same protocol."""
    rigs = tuple(rigs)
    for truth in truths:
        for rig in rigs:
            name = f"{truth.name} | {rig}"
            yield read(Seal(truth), protocol_of(truth, seed), RIGS[rig], seed=seed, name=name)


__all__ = ["FAULTLESS", "NOISES", "RATES", "protocol_of", "relaxation_records", "verdict_records"]
