"""Ramps of seals that are not linear, made apart from the library: every arm by its own recursion.

Table 1's memory on an elastic law of the user's, a trapezoidal ramp, white noise; and look-alikes
of a polymer tape and an open-cell foam.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dashpot.datamodel.relaxation import RampHold

PAPER_K, PAPER_TAU = (117.5 / 196.5, 17.8 / 196.5), (59.0 / 117.5, 292.2 / 17.8)
DEPTH = 8e-3

Law = Callable[[np.ndarray], np.ndarray]


def cubic(x: np.ndarray) -> np.ndarray:
    """F_e = 0.15 x + 7.2656e-4 x^3, N and mm."""
    mm = 1e3 * x
    return 0.15 * mm + 7.2656e-4 * mm**3


def linear(x: np.ndarray) -> np.ndarray:
    return 196.5 * x


def stiffening(x: np.ndarray) -> np.ndarray:
    """Exponential, 196.5 N/m secant at 8 mm."""
    return 1.572 * np.expm1(1.5 * x / DEPTH) / np.expm1(1.5)


def softening(x: np.ndarray) -> np.ndarray:
    return 1.572 * -np.expm1(-1.2 * x / DEPTH) / -np.expm1(-1.2)


def foam(x: np.ndarray) -> np.ndarray:
    """Steep, plateau, densification."""
    u = x / DEPTH
    return 1.572 * (0.45 * np.tanh(6 * u) + 0.25 * u + 0.3 * u**6) / (0.45 * np.tanh(6.0) + 0.55)


def rubber(x: np.ndarray) -> np.ndarray:
    """lambda - lambda^-2 in compression of a 20 mm body."""
    stretch = 1 - x / 20e-3
    full = (1 - DEPTH / 20e-3) ** -2 - (1 - DEPTH / 20e-3)
    return 1.572 * (stretch**-2 - stretch) / full


LAWS: dict[str, Law] = {
    "cubic": cubic, "stiffening": stiffening, "softening": softening, "foam": foam,
    "rubber": rubber,
}  # fmt: skip


@dataclass(frozen=True)
class Bench:
    """A rig: ramp and hold, s; rate, Hz; noise, hum, N; delay, s; baseline, s."""

    ramp: float = 1.0
    hold: float = 40.0
    rate: float = 1000.0
    noise: float = 4e-3
    hum: float = 0.0
    delay: float = 0.0
    baseline: float = 0.5
    drift: float = 0.0
    offset: float = 0.0


def memory(time: np.ndarray, path: np.ndarray, tau: float) -> np.ndarray:
    """Force of a unit arm under a path straight between samples, sample by sample."""
    out = np.zeros(len(time))
    for i in range(1, len(time)):
        step = time[i] - time[i - 1]
        z = step / tau
        out[i] = out[i - 1] * np.exp(-z) + (path[i] - path[i - 1]) * -np.expm1(-z) / z
    return out


def motion(bench: Bench, depth: float = DEPTH) -> tuple[np.ndarray, np.ndarray]:
    before = round(bench.baseline * bench.rate)
    after = round((bench.ramp + bench.hold) * bench.rate)
    time = np.arange(-before, after + 1) / bench.rate
    return time, depth * np.clip(time / bench.ramp, 0.0, 1.0)


def qlv(law: Law, bench: Bench, *, depth: float = DEPTH, seed: int = 0,
        k: Sequence[float] = PAPER_K, tau: Sequence[float] = PAPER_TAU,
        arm_laws: Sequence[Law] | None = None) -> RampHold:  # fmt: skip
    """A record of a seal whose every arm answers the elastic law, or a law of its own."""
    time, x = motion(bench, depth)
    laws = arm_laws or [law] * len(k)
    force = law(x)
    for function, weight, t in zip(laws, k, tau, strict=True):
        force = force + weight * memory(time, function(x), t)
    return record_force(time, x, force, bench, depth=depth, seed=seed)


def record_force(
    time: np.ndarray, x: np.ndarray, force: np.ndarray, bench: Bench, *, depth: float, seed: int
) -> RampHold:
    """What the bench makes of a force: late, humming, drifting, noisy."""
    random = np.random.default_rng(seed)
    late = np.interp(time - bench.delay, time, force)
    late = late + bench.hum * np.sin(2 * np.pi * 50.0 * time + random.uniform(0, 6))
    late = late + bench.offset + bench.drift * (time - time[0])
    late = late + bench.noise * random.standard_normal(len(time))
    scatter = float(np.diff(late[-2000:]).std() / np.sqrt(2))
    return RampHold(time, x, late, 0.0, bench.ramp, float(time[-1]), depth, force_noise=scatter)


def tape(stretch: float = 0.16, *, seed: int = 0) -> RampHold:
    """A polymer tape, 160 mm long ramp and 1800 s: bends early, overshoots, a broad spectrum.

    One sample before the pull, 2 N at the peak, a third of it left.
    """
    bench = Bench(ramp=16.0, hold=1800.0, rate=10.0, noise=0.7e-3, baseline=0.1)
    time, x = motion(bench, stretch)
    x = x * (1 + 0.018 * np.where(time > bench.ramp, np.exp(-(time - bench.ramp) / 0.4), 0.0))

    def law(v: np.ndarray) -> np.ndarray:
        return 4.2 * (0.4 * v + 0.6 * 0.16 * -np.expm1(-v / 0.012))

    tau = np.geomspace(1.0, 600.0, 5)
    force = law(x)
    for value, k in zip(tau, 0.8 * tau**-0.12, strict=True):
        force = force + k * memory(time, law(x), float(value))
    return record_force(time, x, force, bench, depth=float(x[time > 20].mean()), seed=seed)


def foam_block(*, seed: int = 0) -> RampHold:
    """An open-cell foam pressed to its densification: 30 N at the peak, 124 mN of noise."""
    bench = Bench(ramp=2.0, hold=120.0, rate=200.0, noise=0.124, baseline=0.25)
    return qlv(
        lambda v: 11.0 * foam(v), bench, seed=seed, k=(0.35, 0.25, 0.2), tau=(0.3, 3.0, 30.0)
    )
