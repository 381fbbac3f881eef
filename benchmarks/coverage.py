"""How often 95 % intervals hold the truth, under noise that is not white.

    python benchmarks/coverage.py [--seeds 1000] [--noise white,10hz,2hz,ar20ms,ar500ms]

Table 1's seal, 8 mm in 1 s, held 40 s at 1 kHz; eq. 5 on the hold, the noise filtered forward
and backward as a bench engineer would, or autoregressive. The last table printed is kept in
docs/performance.md.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np
from noises import NOISES, Noise, record

from dashpot.datamodel.machine import Machine
from dashpot.fitting.data_blocks import NUISANCE_NAMES
from dashpot.fitting.relaxation import fit
from dashpot.solids.maxwell import GeneralizedMaxwell

SEAL = GeneralizedMaxwell(k_inf=196.5, k=(117.5, 17.8), tau=(59.0 / 117.5, 292.2 / 17.8))
KNOWN_CLOCKS = ("offset", "drift")
"""Of a hold: what is left of its intervals is noise alone."""
STILL = Machine(sync=0.0, drift=0.0, compliance=0.0, creep=0.0)
"""The rig of these records. Of one that is not named an interval bears the drift of any."""
NAMES = ("k_inf", "k1", "k2", "tau1", "tau2")


def check_intervals(
    noise: Noise, seed: int, *, method: str = "hold", rate: float = 1000.0
) -> np.ndarray:
    """Which of the five intervals of the noise alone hold the truth."""
    test = replace(record(SEAL, noise, seed, rate=rate), machine=STILL)
    nuisance = KNOWN_CLOCKS if method == "hold" else NUISANCE_NAMES
    result = fit(test, arms=2, method=method, nuisance=nuisance)  # type: ignore[arg-type]
    if result.model.arms != SEAL.arms:
        return np.zeros(5, dtype=bool)
    bounds = result.estimate.noise_only.intervals(result.model, 0.95)
    truth = (SEAL.k_inf, *SEAL.k, *SEAL.tau)
    ends = (bounds["k_inf"], *bounds["k"], *bounds["tau"])
    return np.array([low <= true <= high for true, (low, high) in zip(truth, ends, strict=True)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--noise", default=",".join(NOISES))
    parser.add_argument("--method", default="hold", choices=("hold", "full"))
    options = parser.parse_args()
    print(f"coverage of 95 % intervals, {options.seeds} seeds, method {options.method}")
    print(f"{'noise':10}" + "".join(f"{name:>8}" for name in NAMES) + f"{'ms/fit':>9}")
    for name in options.noise.split(","):
        start = time.process_time()
        hits = [
            check_intervals(NOISES[name], seed, method=options.method)
            for seed in range(options.seeds)
        ]
        cost = 1e3 * (time.process_time() - start) / options.seeds
        share = np.mean(hits, axis=0)
        print(f"{name:10}" + "".join(f"{value:8.3f}" for value in share) + f"{cost:9.1f}")


if __name__ == "__main__":
    main()
