"""Machines that are not what their blank tests or their machine file say; imports no dashpot.

A plate with rounded corners presses a part through a machine that gives C(F), whose crosshead
presses on by s in a factor e of time after its stop. The force solves

    F(t) = k * (x - gap - C(F) F + s ln(1 + (t - t_e)/t_r)), at least 0

by iteration: k of a seal is a convolution by arms, straight between samples; of a spring a product.
A stop has F = (x - gap + s ln ...) / C. The reading is g F, late by a delay, with offset, drift,
hum and noise. SI units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

Channels = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True)
class TrueMachine:
    """What a machine is at the time of a record."""

    compliance: float = 35e-6
    toe: float = 0.0
    """Part by which it gives more under a small force; falls by e in 4 N."""
    creep: float = 4e-6
    gain: float = 1.005
    delay: float = 1e-3
    drift: float = 0.1e-3
    noise: float = 3e-3
    hum: float = 3e-3

    def give(self, force: np.ndarray) -> np.ndarray:
        """Return by how much it gives under a force, m."""
        return self.compliance * force * (1 + self.toe * np.exp(-np.maximum(force, 0) / 4.0))


@dataclass(frozen=True)
class TrueSeal:
    """Sum of arms: N/m and s."""

    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]

    def relaxation(self, at: float) -> float:
        arms = zip(self.k, self.tau, strict=True)
        return self.k_inf + sum(k * np.exp(-at / tau) for k, tau in arms)

    def force(self, x: np.ndarray, step: float) -> np.ndarray:
        """Return the force of a compression that is straight between samples."""
        force, rise = self.k_inf * x, np.diff(x, prepend=0.0)
        for k, tau in zip(self.k, self.tau, strict=True):
            remaining = np.exp(-step / tau)
            force = force + k * tau / step * (1 - remaining) * lfilter(
                [1.0], [1.0, -remaining], rise
            )
        return force


def draw_machine(seed: int) -> TrueMachine:
    random = np.random.default_rng([seed, 490])
    return TrueMachine(
        compliance=random.uniform(15e-6, 70e-6),
        creep=random.uniform(-8e-6, 8e-6),
        gain=random.uniform(0.985, 1.015),
        delay=random.uniform(-2e-3, 4e-3),
        drift=random.normal(0.0, 0.2e-3),
        noise=10 ** random.uniform(-3.0, -2.2),
        hum=random.uniform(0.5e-3, 6e-3),
    )


def draw_true_seal(seed: int) -> TrueSeal:
    random = np.random.default_rng([seed, 491])
    k_inf, count = random.uniform(100.0, 500.0), int(random.integers(1, 4))
    tau = np.sort(10 ** random.uniform(-0.7, 1.2, count))
    return TrueSeal(k_inf, tuple(k_inf * random.uniform(0.08, 0.4, count)), tuple(tau))


def press_plate(t: np.ndarray, legs: list[tuple[float, float, float]], corner: float) -> np.ndarray:
    """Return a displacement by legs (from, to, by), its corners rounded over a time `corner`."""
    fine = np.arange(t[0] - 1, t[-1] + 1, corner / 20)
    speed = np.zeros(len(fine))
    for begin, end, by in legs:
        speed[(fine >= begin) & (fine < end)] += by / (end - begin)
    width = 20
    speed = np.convolve(speed, np.ones(width) / width, "same")
    return np.interp(t, fine, np.cumsum(speed) * corner / 20)


Law = Callable[[np.ndarray], np.ndarray]


def solve_force(machine: TrueMachine, way: np.ndarray, law: Law | None) -> np.ndarray:
    """Return the force of a part, or of a rigid stop (None), behind a way of the crosshead, m."""
    force = np.zeros(len(way))
    for _ in range(60):
        new = (
            np.maximum(way, 0.0) / (machine.give(np.maximum(force, 1e-9)) / np.maximum(force, 1e-9))
            if law is None
            else law(np.maximum(way - machine.give(force), 0.0))
        )
        if np.max(np.abs(new - force)) < 1e-9:
            break
        force = new
    return force


def write_reading(
    machine: TrueMachine, t: np.ndarray, x: np.ndarray, force: np.ndarray, seed: int
) -> Channels:
    random = np.random.default_rng([seed, 492])
    late = np.interp(t - machine.delay, t, force)
    hum = machine.hum * np.sin(2 * np.pi * 33.31 * t + random.uniform(0, 6))
    read = machine.gain * late + random.normal(0, 0.1) + machine.drift * t + hum
    noise = machine.noise * random.standard_normal(len(t))
    return t, x + 0.3e-6 * random.standard_normal(len(t)), read + noise


def make_record(
    machine: TrueMachine, seed: int, law: Law | None, *, gap: float, depth: float, ramp: float,
    rest: float, hold: float, back: bool = True, rate: float = 200.0,
) -> Channels:  # fmt: skip
    """Return one press by `depth` beyond a gap, with or without its way back."""
    crossing = gap / depth * ramp
    stop = rest + crossing + ramp
    legs = [(rest, stop, gap + depth)]
    if back:
        legs.append((stop + hold, stop + hold + crossing + ramp, -gap - depth))
    last = stop + hold + (crossing + ramp + 3 if back else 0)
    t = np.arange(0.0, last, 1 / rate)
    x = press_plate(t, legs, 0.02)
    way = x - gap + machine.creep * np.log1p(np.maximum(t - stop, 0.0) / ramp)
    return write_reading(machine, t, x, solve_force(machine, way, law), seed)


def make_stop_record(machine: TrueMachine, seed: int, *, peak: float = 25.0) -> Channels:
    depth = peak * machine.compliance
    return make_record(
        machine, 3 * seed, None, gap=3e-4, depth=depth, ramp=2.0, rest=5.0, hold=30.0
    )


def make_spring_record(machine: TrueMachine, seed: int, stiffness: float) -> Channels:
    return make_record(machine, 3 * seed + 1, lambda x: stiffness * x, gap=8e-4, depth=8e-3,
                       ramp=1.0, rest=5.0, hold=30.0)  # fmt: skip


def make_empty_record(machine: TrueMachine, seed: int) -> Channels:
    return make_record(machine, 3 * seed + 2, np.zeros_like, gap=0.0, depth=9e-3, ramp=1.2,
                       rest=5.0, hold=50.0)  # fmt: skip


def make_seal_record(machine: TrueMachine, seal: TrueSeal, seed: int) -> Channels:
    rate = 200.0
    return make_record(
        machine, 7 * seed + 5, lambda x: seal.force(x, 1 / rate), gap=7e-4, depth=7e-3, ramp=0.8,
        rest=10.0, hold=50.0, back=False, rate=rate,
    )  # fmt: skip


# -- faults of a blank test ----------------------------------------------------------------------


def relax_force(record: Channels, part: float, tau: float) -> Channels:
    """Return a press of a part that relaxes by `part` with the time `tau`."""
    t, x, force = record
    since = np.maximum(t - t[np.argmax(x > 0.999 * x.max())], 0.0)
    rest = np.median(force[:200])
    return t, x, rest + (force - rest) * (1 - part * (1 - np.exp(-since / tau)))


def bump_force(record: Channels, size: float, at: float, length: float) -> Channels:
    """Return a record in which somebody leans on the machine for a while."""
    t, x, force = record
    return t, x, force + size * np.exp(-(((t - at) / length) ** 2))


def step_force(record: Channels, size: float, at: float) -> Channels:
    """Return a record whose zero jumps."""
    t, x, force = record
    return t, x, force + size * (t > at)


def turn_signs(record: Channels, displacement: float, force: float) -> Channels:
    """Return a record with other signs of its channels."""
    return record[0], displacement * record[1], force * record[2]


def rub_force(record: Channels, part: float) -> Channels:
    """Return a press whose part rubs: the force is `part` of itself more on the way in."""
    t, x, force = record
    rest = np.median(force[:200])
    return (
        t,
        x,
        rest
        + (force - rest) * (1 + part * np.sign(np.gradient(x)) * (np.abs(np.gradient(x)) > 1e-6)),
    )


def change_machine(machine: TrueMachine, **changes: float) -> TrueMachine:
    """Return a machine some of whose properties have changed."""
    return replace(machine, **changes)
