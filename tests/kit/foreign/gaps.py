"""Curves that leave decades out: moduli, compliances and sweeps of arms that stand in a gap, too.

`gapped(kind, count)`: arms half a decade to a decade apart over the whole curve, so that one or
more stand where nothing was measured. A curve has one gap or two, decades of few values, or is made
of pieces as of several temperatures, which meet here, overlap there and leave the rest out. SI
units; stiffness as Pa, frequency as Hz.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .curves import Curve, crept
from .truths import Solid

KINDS = ("curve", "creep", "sweep")
WAYS = ("one gap", "two gaps", "sparse decades", "pieces")
SCATTER = 3e-3
PER_DECADE = 18
DECADES = 5.0


def draw_solid(random: np.random.Generator, *, arms: int | None = None) -> Solid:
    """Arms over the decades from 10 ms on, and a plateau that the curve ends on."""
    count = int(random.integers(3, 6)) if arms is None else arms
    lg_tau = np.linspace(-2.0, DECADES - 4.0, count) + random.uniform(-0.25, 0.25, count)
    E = 10 ** random.uniform(6, 8)
    k = E * random.uniform(0.15, 0.5, count)
    return Solid.arms(f"{count} arms", E * random.uniform(0.1, 0.6), k, 10**lg_tau)


def place_times(way: str, random: np.random.Generator) -> np.ndarray:
    """Decimal logarithms of the times at which such a curve is measured, s."""
    low, high = -2.7, DECADES - 2.7
    every = np.linspace(low, high, int(PER_DECADE * DECADES))
    if way == "sparse decades":
        first = random.uniform(low + 0.7, high - 2.7)
        few = np.linspace(first, first + 2.0, 3)
        return np.sort(np.concatenate((every[(every < first) | (every > first + 2)], few[1:-1])))
    if way == "pieces":
        starts = low + np.cumsum(random.uniform(0.6, 1.9, 5)) - 0.6
        held = [np.linspace(start, start + 0.7, 12) for start in starts if start < high]
        return np.unique(np.round(np.concatenate(held), 4))
    retained = np.ones(len(every), dtype=bool)
    for _ in range(2 if way == "two gaps" else 1):
        wide = random.uniform(0.9, 1.4) if way == "two gaps" else random.uniform(1.2, 2.4)
        first = random.uniform(low + 0.6, high - 0.6 - wide)
        retained &= (every < first) | (every > first + wide)
    return every[retained]


def generate_gapped_curves(
    kind: str, count: int, seed: int = 0, *, whole: bool = False
) -> Iterator[Curve]:
    """Curves of a kind, each way in turn; the same arms at `whole` curves."""
    for i in range(count):
        random = np.random.default_rng([seed, i, KINDS.index(kind), 43])
        way = WAYS[i % len(WAYS)]
        solid, lg_t = draw_solid(random), place_times(way, random)
        if whole:
            way, lg_t = "whole", np.linspace(-2.7, DECADES - 2.7, int(PER_DECADE * DECADES))
        t = 10**lg_t
        yield measure_curve(kind, f"{i} {way}, {solid.name}", solid, t, random)


def measure_curve(
    kind: str, name: str, solid: Solid, t: np.ndarray, random: np.random.Generator
) -> Curve:
    """A curve of a solid at some times, s, or at the lines 1/(2 pi t), with scatter."""
    slowest = float(max(solid.tau))
    if kind == "sweep":
        f = np.sort(1 / (2 * np.pi * t))
        value = solid.stiffness(2 * np.pi * f)
        error = 1 + SCATTER * random.standard_normal((2, len(f)))
        return Curve(name, kind, f, np.array([value.real, value.imag]) * error, solid, slowest)
    pure = crept(solid, t) if kind == "creep" else solid.relaxation(t)
    values = pure * (1 + SCATTER * random.standard_normal(len(t)))
    return Curve(name, kind, t, values, solid, slowest)


def off(solid: Solid, frequency: np.ndarray, stiffness: np.ndarray) -> tuple[float, float]:
    """By how much |K*| and the loss factor at some lines are off, relative to the truth."""
    truth = solid.stiffness(2 * np.pi * np.asarray(frequency))
    size = np.abs(np.abs(stiffness) / np.abs(truth) - 1)
    eta = np.asarray(stiffness.imag / stiffness.real)
    return float(size.max()), float(np.abs(eta / (truth.imag / truth.real) - 1).max())
