"""How often the right number of arms is chosen, under noise that is not white.

    python benchmarks/order.py [--seeds 100] [--noise white,10hz,2hz,ar20ms,ar500ms]

One, two or three arms, 8 mm in 1 s, held 40 s at 200 Hz; eq. 5 on the hold, arms="auto". The
last table printed is kept in docs/performance.md.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

from noises import NOISES, Noise, record

from dashpot.fitting.relaxation import fit
from dashpot.solids.maxwell import GeneralizedMaxwell

RATE = 200.0
SEALS = {
    1: GeneralizedMaxwell(196.5, (60.0,), (3.0,)),
    2: GeneralizedMaxwell(196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8)),
    3: GeneralizedMaxwell(196.5, (117.5, 40.0, 30.0), (0.25, 2.0, 18.0)),
}


def chosen(arms: int, noise: Noise, seed: int, *, method: str = "hold") -> int:
    test = record(SEALS[arms], noise, seed, rate=RATE)
    return fit(test, method=method).model.arms  # type: ignore[arg-type]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--noise", default=",".join(NOISES))
    parser.add_argument("--method", default="hold", choices=("hold", "full"))
    options = parser.parse_args()
    print(f"right number of arms, {options.seeds} seeds, method {options.method}")
    print(f"{'noise':10}{'N = 1':>8}{'N = 2':>8}{'N = 3':>8}{'ms/fit':>9}  wrong answers")
    for name in options.noise.split(","):
        start = time.process_time()
        shares, wrong = [], []
        for arms in SEALS:
            counter = Counter(
                chosen(arms, NOISES[name], seed, method=options.method)
                for seed in range(options.seeds)
            )
            shares.append(counter.pop(arms, 0) / options.seeds)
            wrong += [f"{arms} taken for {other} x{count}" for other, count in counter.items()]
        cost = 1e3 * (time.process_time() - start) / (len(SEALS) * options.seeds)
        print(
            f"{name:10}"
            + "".join(f"{share:8.2f}" for share in shares)
            + f"{cost:9.1f}  "
            + ", ".join(wrong)
        )


if __name__ == "__main__":
    main()
