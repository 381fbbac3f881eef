"""How often 95 % intervals hold the truth, under noise that is not white.

    python benchmarks/coverage.py [--seeds 1000] [--noise white,10hz,2hz,ar20ms,ar500ms]

Table 1's seal, 8 mm in 1 s, held 40 s at 1 kHz; eq. 5 on the hold, the noise filtered forward
and backward as a bench engineer would, or autoregressive. The last table printed is kept in
docs/performance.md.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from dashpot.relaxation.fitting import fit
from dashpot.relaxation.records import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell

SEAL = GeneralizedMaxwell(k_inf=196.5, k=(117.5, 17.8), tau=(59.0 / 117.5, 292.2 / 17.8))
DEPTH, RAMP, HOLD = 8e-3, 1.0, 40.0
SPREAD = 0.005 * 2.1177
QUANTUM = 1 / 1280
NAMES = ("k_inf", "k1", "k2", "tau1", "tau2")

Noise = Callable[[np.random.Generator, int, float], np.ndarray]


def white(rng: np.random.Generator, n: int, _rate: float) -> np.ndarray:
    return SPREAD * rng.standard_normal(n)


def filtered(cutoff: float) -> Noise:
    def noise(rng: np.random.Generator, n: int, rate: float) -> np.ndarray:
        """White noise under a second-order Butterworth magnitude, twice (zero phase)."""
        size = 2 * n
        frequency = np.fft.rfftfreq(size, 1 / rate)
        gain = 1.0 / (1.0 + (frequency / cutoff) ** 4)
        spectrum = np.fft.rfft(rng.standard_normal(size)) * gain
        return SPREAD * np.fft.irfft(spectrum, size)[:n]

    return noise


def autoregressive(correlation_time: float) -> Noise:
    def noise(rng: np.random.Generator, n: int, rate: float) -> np.ndarray:
        from scipy.signal import lfilter

        rho = np.exp(-1.0 / (rate * correlation_time))
        steps = np.sqrt(1 - rho**2) * rng.standard_normal(n)
        steps[0] = rng.standard_normal()
        return SPREAD * np.asarray(lfilter([1.0], [1.0, -rho], steps))

    return noise


NOISES: dict[str, Noise] = {
    "white": white,
    "10hz": filtered(10.0),
    "2hz": filtered(2.0),
    "ar20ms": autoregressive(0.02),
    "ar500ms": autoregressive(0.5),
}


def record(noise: Noise, seed: int, *, rate: float = 1000.0, quantum: float = QUANTUM) -> RampHold:
    rng = np.random.default_rng(seed)
    t = np.arange(round((RAMP + HOLD) * rate) + 1) / rate
    force = SEAL.ramp_hold_force(t, depth=DEPTH, ramp_time=RAMP) + noise(rng, len(t), rate)
    if quantum:
        force = np.round(force / quantum) * quantum
    return RampHold(
        time=t,
        displacement=DEPTH * np.clip(t / RAMP, 0.0, 1.0),
        force=force,
        onset=0.0,
        ramp_end=RAMP,
        hold_end=RAMP + HOLD,
        depth=DEPTH,
    )


def covered(noise: Noise, seed: int, *, method: str = "hold", rate: float = 1000.0) -> np.ndarray:
    """Which of the five intervals hold the truth."""
    found = fit(record(noise, seed, rate=rate), arms=2, method=method)  # type: ignore[arg-type]
    if found.model.arms != SEAL.arms:
        return np.zeros(5, dtype=bool)
    bounds = found.intervals(0.95)
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
        hits = [covered(NOISES[name], seed, method=options.method) for seed in range(options.seeds)]
        cost = 1e3 * (time.process_time() - start) / options.seeds
        share = np.mean(hits, axis=0)
        print(f"{name:10}" + "".join(f"{value:8.3f}" for value in share) + f"{cost:9.1f}")


if __name__ == "__main__":
    main()
