"""Records of a testing machine without a specimen, from closed forms; imports nothing of dashpot.

The plate is driven along trapezoids of time. A part of stiffness k carries
``F = (x - x_c + s L) / (1/k + C)`` while that is above zero: the machine gives C F, its crosshead
settles by s in a factor e of time after its stop. The force is read as g F, later by a delay, with
offset, drift, hum and noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Rig:
    """True values of a machine, in SI."""

    compliance: float = 40e-6
    creep: float = 6e-6
    gain: float = 1.012
    delay: float = 1.3e-3
    noise: float = 4e-3
    displacement_noise: float = 0.5e-6
    drift: float = 0.2e-3
    hum: float = 5e-3
    hum_frequency: float = 50.03
    hum_phase: float = 0.7
    rate: float = 1000.0


def draw_rig(seed: int) -> Rig:
    """Return a machine at random."""
    random = np.random.default_rng([seed, 91])
    return Rig(
        compliance=random.uniform(10e-6, 80e-6),
        creep=random.choice([-1.0, 1.0]) * random.uniform(0.5e-6, 12e-6),
        gain=random.uniform(0.97, 1.03),
        delay=random.uniform(-3e-3, 5e-3),
        noise=random.uniform(1e-3, 8e-3),
        displacement_noise=random.uniform(0.1e-6, 2e-6),
        drift=random.normal(0.0, 0.5e-3),
        hum=random.uniform(1e-3, 10e-3),
        hum_frequency=random.uniform(49.8, 50.2),
        hum_phase=random.uniform(0, 6.28),
        rate=random.choice([500.0, 1000.0, 2000.0]),
    )


def move_plate(t: np.ndarray, corners: list[tuple[float, float]]) -> np.ndarray:
    """Return the displacement along straight lines between (time, displacement)."""
    times, values = zip(*corners, strict=True)
    return np.interp(t, times, values)


def settle(t: np.ndarray, stop: float, ramp_time: float) -> np.ndarray:
    """Return the logarithm of time since the stop of the plate."""
    return np.log1p(np.maximum(t - stop, 0.0) / ramp_time)


def read_channels(
    rig: Rig, t: np.ndarray, x: np.ndarray, force: np.ndarray, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, displacement and force as the machine writes them."""
    late = force if callable(force) else None
    value = late(t - rig.delay) if late else force
    turn = 2 * np.pi * rig.hum_frequency * t + rig.hum_phase
    read = rig.gain * value + 0.03 + rig.drift * t + rig.hum * np.sin(turn)
    read = read + rig.noise * random.standard_normal(len(t))
    return t, x + rig.displacement_noise * random.standard_normal(len(t)), read


def make_press(
    rig: Rig,
    seed: int,
    stiffness: float | None,
    *,
    gap: float,
    depth: float,
    ramp: float,
    rest: float = 5.0,
    hold: float = 30.0,
    back: bool = True,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a press of a stop (None) or a spring, N/m, by `depth` beyond a gap, at one speed."""
    random = np.random.default_rng([seed, 1 if stiffness is None else 2])
    speed = depth / ramp
    stop = rest + (gap + depth) / speed
    end = stop + hold
    corners = [(0.0, 0.0), (rest, 0.0), (stop, gap + depth), (end, gap + depth)]
    if back:
        corners += [(end + (gap + depth) / speed, 0.0), (end + (gap + depth) / speed + 3.0, 0.0)]
    t = np.arange(0.0, corners[-1][0], 1 / rig.rate)
    soft = rig.compliance + (0.0 if stiffness is None else 1 / stiffness)

    def carry(at: np.ndarray) -> np.ndarray:
        way = move_plate(at, corners) - gap + rig.creep * settle(at, stop, ramp)
        return np.maximum(way, 0.0) / soft

    return read_channels(rig, t, move_plate(t, corners), carry, random)


def make_stop(rig: Rig, seed: int, peak: float = 25.0, **how: float) -> tuple[np.ndarray, ...]:
    """Return a press on a rigid stop up to about `peak`, N."""
    return make_press(rig, seed, None, gap=0.4e-3, depth=peak * rig.compliance, ramp=2.0, **how)


def make_spring(
    rig: Rig, seed: int, stiffness: float = 1000.0, **how: float
) -> tuple[np.ndarray, ...]:
    """Return a press on a steel spring by 8 mm in 1 s."""
    return make_press(rig, seed, stiffness, **{"gap": 1e-3, "depth": 8e-3, "ramp": 1.0, **how})


def make_empty(rig: Rig, seed: int, length: float = 60.0) -> tuple[np.ndarray, ...]:
    """Return a run without a specimen: the plate goes down by 9 mm and back."""
    random = np.random.default_rng([seed, 3])
    t = np.arange(0.0, length, 1 / rig.rate)
    corners = [(0.0, 0.0), (5.0, 0.0), (6.2, 9e-3), (length - 8, 9e-3), (length - 6.8, 0.0),
               (length, 0.0)]  # fmt: skip
    return read_channels(rig, t, move_plate(t, corners), np.zeros(len(t)), random)


@dataclass(frozen=True)
class Seal:
    """Generalized Maxwell solid: N/m and s."""

    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]

    def relaxed(self, at: float) -> float:
        """Return the relaxation function, N/m."""
        return self.k_inf + sum(
            k * np.exp(-at / tau) for k, tau in zip(self.k, self.tau, strict=True)
        )


def draw_seal(seed: int) -> Seal:
    """Return a seal of two or three arms at random."""
    random = np.random.default_rng([seed, 92])
    k_inf = random.uniform(100.0, 600.0)
    count = random.integers(2, 4)
    tau = 10 ** np.sort(random.uniform(-1.0, 1.3, count))
    return Seal(k_inf, tuple(k_inf * random.uniform(0.05, 0.5, count)), tuple(tau))


def carry_seal(seal: Seal, t: np.ndarray, way: np.ndarray, compliance: float) -> np.ndarray:
    """Return the force of a seal in a machine that gives; straight between samples."""
    k, tau = np.array(seal.k), np.array(seal.tau)
    h = t[1] - t[0]
    decay = np.exp(-h / tau)
    gain = k * tau / h * (1 - decay)
    stiff = seal.k_inf + gain.sum()
    q, before, force = np.zeros(len(k)), 0.0, np.zeros(len(t))
    for i in range(1, len(t)):
        rest = (decay * q).sum() - gain.sum() * before
        x = (way[i] - compliance * rest) / (1 + compliance * stiff)
        x = max(x, 0.0)
        q = decay * q + gain * (x - before)
        force[i] = seal.k_inf * x + q.sum()
        before = x
    return force


def make_seal_test(
    rig: Rig, seal: Seal, seed: int, *, depth: float = 8e-3, ramp: float = 1.0, hold: float = 60.0,
    gap: float = 1e-3,
) -> tuple[np.ndarray, ...]:  # fmt: skip
    """Return a ramp and hold of a seal that was never pressed before, on the machine."""
    random = np.random.default_rng([seed, 4])
    rest, speed = 10.0, depth / ramp
    stop = rest + (gap + depth) / speed
    t = np.arange(0.0, stop + hold, 1 / rig.rate)
    x = move_plate(t, [(0.0, 0.0), (rest, 0.0), (stop, gap + depth), (stop + hold, gap + depth)])
    way = np.maximum(x - gap, 0.0) + rig.creep * settle(t, stop, ramp)
    force = carry_seal(seal, t, way, rig.compliance)
    return read_channels(rig, t, x, lambda at: np.interp(at, t, force), random)
