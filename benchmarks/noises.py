"""Records of a ramp and hold under noise that is not white, for the statistical benchmarks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.datamodel.relaxation import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell

DEPTH, RAMP, HOLD = 8e-3, 1.0, 40.0
SPREAD = 0.005 * 2.1177
QUANTUM = 1 / 1280

Noise = Callable[[np.random.Generator, int, float], np.ndarray]


def white(rng: np.random.Generator, n: int, _rate: float) -> np.ndarray:
    return SPREAD * rng.standard_normal(n)


def make_filtered_noise(cutoff: float) -> Noise:
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
    "10hz": make_filtered_noise(10.0),
    "2hz": make_filtered_noise(2.0),
    "ar20ms": autoregressive(0.02),
    "ar500ms": autoregressive(0.5),
}


def record(
    seal: GeneralizedMaxwell, noise: Noise, seed: int, *, rate: float, quantum: float = QUANTUM
) -> RampHold:
    """8 mm in 1 s, held 40 s, the force with noise and in steps of the load cell."""
    rng = np.random.default_rng(seed)
    t = np.arange(round((RAMP + HOLD) * rate) + 1) / rate
    force = seal.ramp_hold_force(t, depth=DEPTH, ramp_time=RAMP) + noise(rng, len(t), rate)
    return RampHold(
        time=t,
        displacement=DEPTH * np.clip(t / RAMP, 0.0, 1.0),
        force=np.round(force / quantum) * quantum,
        onset=0.0,
        ramp_end=RAMP,
        hold_end=RAMP + HOLD,
        depth=DEPTH,
    )
