"""Ramp-and-hold tests at several temperatures, made apart from `src`.

The solid of the reference answers at T with every relaxation time times a_T and every stiffness
times T/T_r, exactly: F = b [k_inf x + sum_j k_j q_j], q_j in closed form on ramp and hold.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

import dashpot as dp

REFERENCE = 296.15
C1, C2 = 6.943703704, 129.6
RESONANCE = 12.71
#: k_inf, k and tau of one seal, N/m and s
HIDDEN = (196.5, (117.5, 17.8, 50.0), (59 / 117.5, 292.2 / 17.8, 0.0125))
BROAD = (
    196.5, (117.5, 17.8, 20.0, 20.0, 20.0), (59 / 117.5, 292.2 / 17.8, 0.08, 0.016, 0.0032)
)  # fmt: skip
SEALS = {"hidden": HIDDEN, "broad": BROAD}


def log10_a(temperature: float) -> float:
    """The shift of both seals."""
    above = temperature - REFERENCE
    return -C1 * above / (C2 + above)


def shift_uniformly(tau: float) -> float:
    """Every arm shifts as the law says."""
    return 1.0


def fast_arms_less(tau: float) -> float:
    """Arms faster than 0.1 s shift 0.8 times as far."""
    return 0.8 if tau < 0.1 else 1.0


def make_growing_shift(slope: float) -> Callable[[float], float]:
    """Every decade of tau shifts by so much more."""
    return lambda tau: 1 + slope * np.log10(tau / 0.5)


@dataclass(frozen=True)
class Bench:
    """How a seal is tested; SI units."""

    depth: float = 8e-3
    ramp: float = 1.0
    hold: float = 40.0
    rate: float = 1000.0
    baseline: float = 1.5
    noise: float = 4e-3
    hum: float = 3e-3
    shake: float = 1e-3
    offset: float = 0.05
    drift: float = 0.2e-3
    late: float = 1e-3
    count: float = 1 / 1280
    encoder: float = 0.0
    shift_factor: Callable[[float], float] = shift_uniformly
    stiffer: float = 1.0  # b over T/T_r
    warms: float = 0.0  # K over the record


def arm(t: np.ndarray, tau: float, bench: Bench) -> np.ndarray:
    """Elongation of a unit arm, in closed form."""
    v, c = bench.depth / bench.ramp, bench.ramp
    on = v * tau * -np.expm1(-np.clip(t, 0.0, c) / tau)
    return on * np.exp(-np.clip(t - c, 0.0, None) / tau)


def a_test(seal: str, celsius: float, seed: int, bench: Bench | None = None) -> dp.RelaxationTest:
    """One record at one temperature."""
    bench = bench or Bench()
    random = np.random.default_rng((seed, round(10 * (celsius + 300))))
    t = np.arange(round((bench.baseline + bench.ramp + bench.hold) * bench.rate) + 1) / bench.rate
    delay = bench.late * random.standard_normal()
    temperature = celsius + 273.15
    since = t - bench.baseline
    x = np.clip(since, 0.0, bench.ramp) * bench.depth / bench.ramp
    force = _force(seal, temperature, since - delay, bench)
    if bench.warms:
        # the force of a slowly warming seal, by its slope in T and reduced time
        force = _warming(seal, temperature, since - delay, bench)
    phases = random.uniform(0, 2 * np.pi, 2)
    read = force + bench.offset + bench.drift * t + bench.noise * random.standard_normal(len(t))
    read += bench.hum * np.sin(2 * np.pi * 50 * t + phases[0])
    read += bench.shake * np.sin(2 * np.pi * 37 * t + phases[1])
    if bench.count:
        read = bench.count * np.round(read / bench.count)
    if bench.encoder:
        x = bench.encoder * np.round(x / bench.encoder)
    return dp.RelaxationTest(
        time=t,
        displacement=x,
        force=read,
        specimen=dp.Specimen(temperature=temperature),
        units="SI",
    )


def _force(seal: str, temperature: float, t: np.ndarray, bench: Bench) -> np.ndarray:
    k_inf, k, tau = SEALS[seal]
    b = bench.stiffer if temperature != REFERENCE else 1.0
    force = k_inf * np.clip(t, 0.0, bench.ramp) * bench.depth / bench.ramp
    for value, time in zip(k, tau, strict=True):
        force = force + value * arm(
            t, time * 10 ** (log10_a(temperature) * bench.shift_factor(time)), bench
        )
    return b * temperature / REFERENCE * force


def _warming(seal: str, temperature: float, t: np.ndarray, bench: Bench) -> np.ndarray:
    """Arms by steps of the clock in reduced time: decays change as the seal warms."""
    k_inf, k, tau = SEALS[seal]
    at = temperature + bench.warms * np.clip(t - t[0], 0, None) / (t[-1] - t[0])
    a = 10 ** np.array([log10_a(item) for item in at])
    x = np.clip(t, 0.0, bench.ramp) * bench.depth / bench.ramp
    increment, step = np.diff(x), np.diff(t)
    force = k_inf * x
    for value, time in zip(k, tau, strict=True):
        z = step / (time * 0.5 * (a[1:] + a[:-1]))
        decay, mean, q = np.exp(-z), -np.expm1(-z) / z, np.zeros(len(t))
        for i in range(len(step)):
            q[i + 1] = decay[i] * q[i] + mean[i] * increment[i]
        force = force + value * q
    return at / REFERENCE * force


def records(seal: str, celsius: Sequence[float], seed: int, **changes: object):
    """Records at several temperatures, of the usual bench but for some changes."""
    bench = replace(Bench(), **changes)
    return [a_test(seal, item, seed, bench) for item in celsius]


def loss_factor(seal: str, frequency: float = RESONANCE, celsius: float = 23.0) -> float:
    """Of the truth."""
    stiffness = complex_stiffness(seal, frequency, celsius)
    return stiffness.imag / stiffness.real


def complex_stiffness(seal: str, frequency: float = RESONANCE, celsius: float = 23.0) -> complex:
    """Of the truth, N/m."""
    k_inf, k, tau = SEALS[seal]
    temperature = celsius + 273.15
    s = 2j * np.pi * frequency * 10 ** log10_a(temperature)
    sums = sum(value * s * time / (1 + s * time) for value, time in zip(k, tau, strict=True))
    return temperature / REFERENCE * (k_inf + sums)
