"""Fits of records that dashpot's own rig did not make: what they cost, and whether bounds hold.

    python benchmarks/foreign.py [--records 30] [--seed 0] [--arms auto]

The sound records of `tests/kit/foreign`: 1 to 6 arms, fractional, power law and slower than the
hold, 250 Hz to 10 kHz, ramps of .05 to 5 s, noise white, slow or hum. CPU time of `fit` alone, its
least of three; a bound holds if the truth lies within it.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import dashpot as dp
from dashpot.fitting.relaxation import fit
from dashpot.preparation.prepare import prepare

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from kit.foreign.catalogue import relaxation_records
from kit.foreign.rigs import Record


def cost(record: dp.RampHold, **words) -> tuple[dp.Fit, float]:
    """The fit, and its CPU time, ms."""
    spent = []
    for _ in range(3):
        start = time.process_time()
        found = fit(record, **words)
        spent.append(1e3 * (time.process_time() - start))
    return found, min(spent)


def held(one: Record, found: dp.Fit, hold: float) -> dict[str, bool]:
    """Which 95 % limits hold the truth; those of single arms where it has as many.

    `hold`, s, is the T of k(T) as the record was understood: a rounded ramp ends where one says.
    """
    solid, inside = one.seal.solid, {}
    if found.left_open is not None:
        for name, times in (("k_end", 1), ("k_3end", 3), ("k_inf", np.inf)):
            low, high = found.left_open[name]
            inside[f"{name} left open"] = low <= one.seal.secant(times * hold) <= high
    bounds = found.intervals()
    inside["k_inf"] = bounds["k_inf"][0] <= solid.k_inf <= bounds["k_inf"][1]
    if found.model.arms == len(solid.k):
        for name in ("k", "tau"):
            pairs = zip(getattr(solid, name), bounds[name], strict=True)
            inside[f"{name} of as many arms"] = all(low <= v <= high for v, (low, high) in pairs)
    return inside


@dataclass
class Tally:
    """What a method cost and said."""

    spent: list[tuple[float, str]] = field(default_factory=list)
    by_noise: dict[str, list[float]] = field(default_factory=dict)
    bounds: dict[str, list[bool]] = field(default_factory=dict)
    uses: Counter[str] = field(default_factory=Counter)

    def add(self, one: Record, **words) -> None:
        test = dp.RelaxationTest(one.time, one.displacement, one.force, units="SI")
        try:
            record = prepare(test)
            found, ms = cost(record, **words)
        except dp.DashpotError as error:
            self.uses["refused"] += 1
            print(f"{one.name}, {words}: {error}")
            return
        self.spent.append((ms, f"{one.name}, {len(one.time)} rows"))
        self.by_noise.setdefault(one.name.split(" | ")[1], []).append(ms)
        self.uses[found.verdict.use] += 1
        for name, inside in held(one, found, record.hold_time).items():
            self.bounds.setdefault(name, []).append(inside)

    def lines(self) -> str:
        ms = [value for value, _ in self.spent]
        ends = zip(("min", "median", "p95", "max"), np.quantile(ms, [0, 0.5, 0.95, 1]), strict=True)
        parts = [
            f"{len(ms)} fits, ms: " + ", ".join(f"{name} {value:.0f}" for name, value in ends),
            f"dearest: {max(self.spent)[1]}",
            "medians: " + ", ".join(f"{k} {np.median(v):.0f}" for k, v in self.by_noise.items()),
            ", ".join(f"{use} {count}" for use, count in self.uses.most_common()),
            *(f"{name:24} holds {sum(h):3} of {len(h)}" for name, h in self.bounds.items()),
        ]
        return "\n  ".join(parts)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", type=int, default=30)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--arms", default="auto", help="auto, or how many")
    options = parser.parse_args()
    arms = options.arms if options.arms == "auto" else int(options.arms)
    tallies = {"hold": Tally(), "full": Tally()}
    for one in relaxation_records(options.records, options.seed):
        for method, tally in tallies.items():
            tally.add(one, method=method, arms=arms)
    for method, tally in tallies.items():
        print(f"\n{method}: {tally.lines()}")


if __name__ == "__main__":
    main()
